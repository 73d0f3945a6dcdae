"""Functions that the loop calls through their addresses, as it calls kernels.

What a compiled function calls by name is compiled again as a part of it. Factorizations are called
seldom and are long: by address the loop is compiled without them, and beside them.
"""

from collections.abc import Callable
from functools import cache

from llvmlite import ir
from numba import typeof, types
from numba.extending import intrinsic

from sebody.compiler.choice import way
from sebody.engine.matrix import refactorize


@intrinsic
def call_refactorize(typingctx, address, system, state, wanted, dense):
    """Call `sebody.engine.matrix.refactorize` at its address."""
    def codegen(context, builder, sig, args):
        kinds = [context.get_value_type(kind) for kind in sig.args[1:]]
        function = ir.FunctionType(context.get_value_type(sig.return_type), kinds)
        return builder.call(builder.inttoptr(args[0], function.as_pointer()), args[1:])

    return types.boolean(types.int64, system, state, types.int64, types.boolean), codegen


def refactorize_address(system, state) -> int:
    """The address, for a system and a state of these types: the function is compiled if needed."""
    return _address(typeof(system), typeof(state), types.int64, types.boolean)


def compile_refactorize(function: Callable, kinds: tuple[types.Type, ...]) -> None:
    """Compile it for some types as the loop calls it."""
    way().address(function, types.boolean, kinds)


@cache
def _address(*kinds: types.Type) -> int:
    return way().address(refactorize, types.boolean, kinds)
