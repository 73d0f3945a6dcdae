"""Products with constant matrices that all members share, as straight code: see `straight`.

The first number of such a matrix is the address of an array of the addresses of its code.
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sebody.compiler.inside.lanes import VECTOR
from sebody.kernels.instructions import WORD


@intrinsic
def straight_times(typingctx, matrix, x, out, count):
    """``out = A x``, `count` numbers in all."""
    return types.none(matrix, x, out, count), _calling(0)


@intrinsic
def add_straight_times(typingctx, matrix, x, out):
    """``out += A x``."""
    return types.none(matrix, x, out), _calling(1)


def _calling(which):
    def codegen(context, builder, sig, args):
        matrix, x, out = args[:3]
        count = context.cast(builder, args[3], sig.args[3], types.int64) if args[3:] else WORD(0)
        table = builder.load(builder.bitcast(matrix, WORD.as_pointer()))
        address = builder.load(builder.gep(builder.inttoptr(table, WORD.as_pointer()),
                                           [WORD(which)]))
        kind = ir.FunctionType(ir.VoidType(), [*[VECTOR.as_pointer()] * 4, WORD])
        builder.call(builder.inttoptr(address, kind.as_pointer()), (x, x, x, out, count))
        return context.get_dummy_value()
    return codegen
