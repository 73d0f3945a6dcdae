"""Products of square blocks whose numbers are lanes: what `sebody.kernels.blocks` writes."""

from sebody.contract.counts import LANES
from sebody.kernels import blocks
from sebody.kernels.instructions import WORD, in_lanes, short_loop
from sebody.kernels.lanes.products import behind, read, write


def _subtracted(builder, total, a, b):
    return builder.fsub(total, builder.fmul(a, b, flags=("contract",)), flags=("contract",))


@in_lanes(blocks.write_subtract_product)
def subtract_product(builder, C, A, B):
    """`subtract_product` in lanes."""
    with short_loop(builder, WORD(0), WORD(LANES * LANES), LANES) as column:
        factors = [read(builder, B, behind(builder, column, k)) for k in range(LANES)]
        for i in range(LANES):
            total = read(builder, C, behind(builder, column, i))
            for k, factor in enumerate(factors):
                total = _subtracted(builder, total, read(builder, A, WORD(LANES * k + i)), factor)
            write(builder, total, C, behind(builder, column, i))


@in_lanes(blocks.write_subtract_blocks_times)
def subtract_blocks_times(builder, y, rows, A, x, first, end):
    """`subtract_blocks_times` in lanes."""
    factors = [read(builder, x, WORD(k)) for k in range(LANES)]
    with short_loop(builder, first, end) as p:
        _subtract_block_times(builder, y, rows, A, p, factors)


@in_lanes(blocks.write_multiply_and_subtract)
def multiply_and_subtract(builder, y, rows, A, x, first, end):
    """`multiply_and_subtract` in lanes."""
    given, begin = [read(builder, x, WORD(k)) for k in range(LANES)], builder.mul(
        end, WORD(LANES * LANES))
    factors = []
    for i in range(LANES):
        a, b, c, d = (builder.fmul(read(builder, A, behind(builder, begin, LANES * k + i)), number)
                      for k, number in enumerate(given))
        factors.append(builder.fadd(builder.fadd(builder.fadd(a, b), c), d))
        write(builder, factors[i], x, WORD(i))
    last = builder.sub(builder.add(first, end), WORD(1))
    with short_loop(builder, first, end) as k:
        _subtract_block_times(builder, y, rows, A, builder.sub(last, k), factors)


def _subtract_block_times(builder, y, rows, A, p, factors):
    place = builder.mul(builder.load(builder.gep(rows, [p])), WORD(LANES))
    begin = builder.mul(p, WORD(LANES * LANES))
    for i in range(LANES):
        total = read(builder, y, behind(builder, place, i))
        for k, factor in enumerate(factors):
            entry = read(builder, A, behind(builder, begin, LANES * k + i))
            total = _subtracted(builder, total, entry, factor)
        write(builder, total, y, behind(builder, place, i))
