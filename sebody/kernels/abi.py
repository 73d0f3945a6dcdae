"""The one signature of every compiled kernel, and how the time loop calls it.

A kernel is called through its address: a call costs a few nanoseconds, and the loop is compiled
once for all kernels. The contents of the arguments are described in `sebody.contract.layout`.

===============  =================================================================================
argument         meaning
===============  =================================================================================
task             RESIDUAL, TANGENT (residual and matrix), ENERGY, or VELOCITY and ACCELERATION:
                 constraints differentiated in time. With ENERGY an element with a power port leaves
                 the forces that have the power of this port
count            number of elements in the batch
stride           length of an index row
width            number n of unknowns of an element (coordinates, then multipliers)
===============  =================================================================================
"""

from collections import namedtuple

from llvmlite import ir
from numba import TypingError, types
from numba.extending import intrinsic

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.contract.layout import ARGUMENTS


@compiled
def padded(n):
    """Length of a column of n numbers in a kernel's matrices: whole vectors."""
    return (n + LANES - 1) // LANES * LANES


@intrinsic
def at(typingctx, pointer, first):
    """Pointer to the element `first` of a pointer: no bounds checks, no negative indices."""
    def codegen(context, builder, sig, args):
        return builder.gep(args[0], [args[1]])

    return pointer(pointer, types.int64), codegen


@intrinsic
def opaque(typingctx, number):
    """The same number, which the compiler knows nothing of: no instructions."""
    def codegen(context, builder, sig, args):
        kind = args[0].type
        same = ir.InlineAsm(ir.FunctionType(kind, [kind]), "", "=r,0", side_effect=True)
        return builder.call(same, args)

    return number(number), codegen


@intrinsic
def pointer_to(typingctx, array):
    """Pointer to the data of an array."""
    def codegen(context, builder, sig, args):
        return context.make_array(sig.args[0])(context, builder, args[0]).data

    return types.CPointer(array.dtype)(array), codegen


def called(context, builder, sig, args):
    """Code that calls the function at an address, the first argument, with the other arguments."""
    kinds = [context.get_value_type(kind) for kind in sig.args[1:]]
    function = ir.FunctionType(context.get_value_type(sig.return_type), kinds)
    return builder.call(builder.inttoptr(args[0], function.as_pointer()), args[1:])


@intrinsic
def call_law(typingctx, address, t, y, x, results, parameters):
    """Call a function of a controller at its address; it returns 0, or 1 after a fault."""
    return types.int64(types.int64, types.float64, y, x, results, parameters), called


# arguments of a kernel after its task and sizes, by name: arrays or pointers
Arguments = namedtuple("Arguments", [name for name, _, _ in ARGUMENTS])


@intrinsic
def call_kernel(typingctx, address, task, count, stride, width, arguments):
    """Call the kernel at an address with `Arguments`; other types do not compile."""
    if getattr(arguments, "instance_class", None) is not Arguments:
        raise TypingError(f"a kernel is called with Arguments of arrays by name, not {arguments}")
    for (name, kind, _), given in zip(ARGUMENTS, arguments, strict=True):
        if str(given.dtype) != kind and not (kind == "float64" and str(given.dtype) == "lanes"):
            raise TypingError(f"a kernel's argument {name} has numbers of type {kind}, not {given}")
    signature = types.int64(address, task, count, stride, width, arguments)

    def codegen(context, builder, sig, args):
        word = ir.IntType(64)
        scalars = list(args[1:5])
        values = [builder.extract_value(args[5], k) for k in range(len(sig.args[5]))]
        pointers = [context.make_array(kind)(context, builder, value).data
                    if isinstance(kind, types.Array) else value
                    for kind, value in zip(sig.args[5], values, strict=True)]
        function = ir.FunctionType(word, [word] * 4 + [p.type for p in pointers])
        return builder.call(builder.inttoptr(args[0], function.as_pointer()),
                            scalars + pointers)

    return signature, codegen
