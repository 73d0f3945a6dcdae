"""Products of square blocks of `LANES` rows, stored by columns, which eliminations are made of."""

from llvmlite import ir
from numba.extending import intrinsic

from sebody.contract.counts import LANES
from sebody.kernels.instructions import (
    VECTOR,
    WORD,
    broadcast,
    inlined,
    load_broadcast,
    load_vector,
    short_loop,
    store_vector,
)


@intrinsic
def subtract_product(typingctx, C, A, B):
    """``C -= A B``."""
    return inlined(write_subtract_product, C, A, B)


@intrinsic
def subtract_blocks_times(typingctx, y, rows, A, x, first, end):
    """``y_r -= A_p x`` of some blocks, p from `first` up to `end`.

    `rows` has the block r of y for each p. The numbers of x stay in registers, as y does not
    overlap x.
    """
    return inlined(write_subtract_blocks_times, y, rows, A, x, first, end)


@intrinsic
def multiply_and_subtract(typingctx, y, rows, A, x, first, end):
    """``x = A_end x``, then ``y_r -= A_p x``, p from `end` - 1 down to `first`.

    What is solved for next comes first, and the numbers of x do not go through memory: the
    solution with U waits for one block after the other.
    """
    return inlined(write_multiply_and_subtract, y, rows, A, x, first, end)


def write_subtract_product(builder, C, A, B):
    """Instructions of `subtract_product`."""
    columns = _columns(builder, A, WORD(0))
    for j in range(LANES):
        total = load_vector(builder, C, WORD(LANES * j))
        numbers = [broadcast(builder, builder.load(builder.gep(B, [WORD(LANES * j + k)])))
                   for k in range(LANES)]
        total = _less(builder, total, columns, numbers)
        store_vector(builder, total, C, WORD(LANES * j))


def write_subtract_blocks_times(builder, y, rows, A, x, first, end):
    """Instructions of `subtract_blocks_times`."""
    numbers = [load_broadcast(builder, x, WORD(k)) for k in range(LANES)]
    with short_loop(builder, first, end) as p:
        _subtract_block_times(builder, y, rows, A, p, numbers)


def write_multiply_and_subtract(builder, y, rows, A, x, first, end):
    """Instructions of `multiply_and_subtract`."""
    numbers = _lanes(builder, load_vector(builder, x, WORD(0)))
    a, b, c, d = (builder.fmul(column, number) for column, number in
                  zip(_columns(builder, A, end), numbers, strict=True))
    result = builder.fadd(builder.fadd(builder.fadd(a, b), c), d)
    store_vector(builder, result, x, WORD(0))
    numbers, last = _lanes(builder, result), builder.sub(builder.add(first, end), WORD(1))
    with short_loop(builder, first, end) as k:
        _subtract_block_times(builder, y, rows, A, builder.sub(last, k), numbers)


def _subtract_block_times(builder, y, rows, A, p, numbers):
    place = builder.mul(builder.load(builder.gep(rows, [p])), WORD(LANES))
    total = load_vector(builder, y, place)
    store_vector(builder, _less(builder, total, _columns(builder, A, p), numbers), y, place)


def _columns(builder, A, p):
    """The columns of a block."""
    begin = builder.mul(p, WORD(LANES * LANES))
    return [load_vector(builder, A, builder.add(begin, WORD(LANES * k))) for k in range(LANES)]


def _less(builder, total, columns, numbers):
    """A vector without the products of some columns."""
    for column, number in zip(columns, numbers, strict=True):
        product = builder.fmul(column, number, flags=("contract",))
        total = builder.fsub(total, product, flags=("contract",))
    return total


def _lanes(builder, vector):
    """Vectors of one number, for each number of a vector."""
    undefined = ir.Constant(VECTOR, ir.Undefined)
    return [builder.shuffle_vector(vector, undefined, ir.Constant(
        ir.VectorType(ir.IntType(32), LANES), [lane] * LANES)) for lane in range(LANES)]
