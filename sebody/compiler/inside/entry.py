"""The fast way to compile, with the functions of `sebody.compiler.plain`."""

from collections.abc import Callable, Iterable

import numpy as np
from numba import from_dtype, types
from numba.extending import infer_getattr, intrinsic, lower_getattr_generic

from sebody.compiler.code import Code, bitcode
from sebody.compiler.inside.cache import FunctionCache, is_kept
from sebody.compiler.inside.callees import Callee, Function
from sebody.compiler.inside.names import (
    AttributeTemplate,
    CFunc,
    NullCache,
    cpu_target,
    normalize_signature,
)
from sebody.compiler.inside.pipeline import KernelPasses, PartPasses

__all__ = ["SLOWER", "address", "code_of", "compile_for", "function", "function_code",
           "guarded", "is_compiled", "is_kept", "kernel", "kernel_code", "part_of_callers",
           "processor", "show_members",
           "type_of"]

SLOWER = 1.0        # compilation, compared with this way
_shown = set()      # types whose members are shown


def function(function: Callable, options: dict, made_from: str) -> Function:
    """See `sebody.compiler.plain.function`."""
    return Function(function, {"nopython": True, **options}, made_from)


def kernel(function: Callable, signature, options: dict, made_from: str) -> CFunc:
    """See `sebody.compiler.plain.kernel`."""
    made = CFunc(function, normalize_signature(signature), {}, options, KernelPasses)
    made._cache = FunctionCache(function, made_from)
    made.compile()
    return made


def compile_for(function: Function | Callee, kinds: tuple[types.Type, ...]) -> None:
    """See `sebody.compiler.plain.compile_for`."""
    function.compile(kinds)


def is_compiled(function: Function | Callee) -> bool:
    """See `sebody.compiler.plain.is_compiled`."""
    return function._cache.holds_any()


def part_of_callers(function: Function) -> Callee:
    """The code that is compiled of a function for its callers."""
    return function.callee


def address(function: Function, returns: types.Type, kinds: tuple[types.Type, ...]) -> int:
    """See `sebody.compiler.plain.address`."""
    function.compile(kinds)
    made = function.overloads[kinds]
    return made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name)


def function_code(function: Function, kinds: tuple[types.Type, ...]) -> Code:
    """See `sebody.compiler.plain.function_code`; callees come from the cache."""
    fresh = Function(function.py_func, function.targetoptions, "")
    fresh._cache, fresh.callee = NullCache(), function.callee
    fresh.compile(kinds)
    made = fresh.overloads[kinds]
    return Code(made.fndesc.llvm_func_name, bitcode(made.library.get_llvm_str()))


def kernel_code(function: Callable, signature, options: dict) -> Code:
    """See `sebody.compiler.plain.kernel_code`."""
    made = CFunc(function, normalize_signature(signature), {}, options, PartPasses)
    made.compile()
    return code_of(made)


def code_of(made: CFunc) -> Code:
    """See `sebody.compiler.plain.code_of`."""
    return Code(made.native_name.removeprefix("cfunc."), bitcode(made.inspect_llvm()))


def type_of(kind: np.dtype) -> types.Type:
    """See `sebody.compiler.plain.type_of`; here numbers may be lanes, those of a record, too."""
    if kind.fields is None or not any(own.subdtype for own, _ in kind.fields.values()):
        return from_dtype(kind)
    from sebody.compiler.inside.lanes import NUMPY_KIND, RecordOfLanes, lanes

    return lanes if kind == NUMPY_KIND else RecordOfLanes(kind)


def processor() -> tuple[str, str]:
    """See `sebody.compiler.plain.processor`."""
    _, name, features = cpu_target.target_context.codegen().magic_tuple()
    return name, features


def guarded(function: Callable) -> Callable:
    """See `sebody.compiler.plain.guarded`, which takes half as long again to compile."""
    overload, = function.overloads.values()
    results = types.Tuple((types.boolean, types.float64))

    @intrinsic
    def returned(typingctx, arguments):
        def codegen(context, builder, sig, args):
            context.active_code_library.add_linking_library(overload.library)
            status, value = context.call_internal_no_propagate(
                builder, overload.fndesc, overload.signature,
                [builder.extract_value(args[0], k) for k in range(len(sig.args[0]))])
            if overload.signature.return_type == types.none:
                value = context.get_constant(types.float64, 0.0)
            return context.make_tuple(builder, results, [status.is_error, value])
        return results(arguments), codegen
    return returned


def show_members(kind: type[types.Type], names: Iterable[str], resolve: Callable,
                 lower: Callable) -> None:
    """See `sebody.compiler.plain.show_members`; here names need not be known."""
    if kind in _shown:
        return
    _shown.add(kind)

    @infer_getattr
    class Members(AttributeTemplate):
        key = kind

        def generic_resolve(self, group, name):
            return resolve(group, name)

    lower_getattr_generic(kind)(lower)
