"""Instructions of sums of packed matrices, group by group."""

from llvmlite import ir

from sebody.contract.counts import LANES
from sebody.kernels.instructions import (
    WORD,
    load_broadcast,
    load_vector,
    short_loop,
    store_vector,
)
from sebody.kernels.packed import BEHIND, PRODUCTS
from sebody.kernels.packed_groups import BOTH, COUPLED, DIAGONAL, MIRRORED, MULTIPLE, ONCE
from sebody.kernels.packed_strips import Groups, columns_of, fused


def write_sum(builder, matrices, factors, out, height):
    def scale(_, matrix):
        return load_broadcast(builder, factors, matrix)
    Groups(builder, matrices).each({
        ONCE: lambda groups: _sum_once(groups, scale, [out], height),
        MIRRORED: lambda groups: _sum_twice(groups, scale, [out], out, height),
        DIAGONAL: lambda groups: _sum_diagonal(groups, factors, out, height)})


def write_sum_of_couplings(builder, matrices, factors, scales, of_x, of_y, products, size, height):
    _write_scales(builder, matrices, factors, scales, products, size)

    def scale(place, _):
        return load_vector(builder, scales, place)
    Groups(builder, matrices).each({
        ONCE: lambda groups: _sum_once(groups, scale, [groups.chosen(of_x, of_y)], height),
        BOTH: lambda groups: _sum_once(groups, scale, [of_x, of_y], height),
        MIRRORED: lambda groups: _sum_twice(groups, scale, [of_x], of_x, height),
        COUPLED: lambda groups: _sum_twice(groups, scale, [of_x, of_y], of_y, height)})


def _write_scales(builder, matrices, factors, scales, products, size):
    """The factor of every row of every product, with those of what is made from it."""
    with short_loop(builder, WORD(0), products) as k:
        factor, first = load_broadcast(builder, factors, k), builder.mul(k, size)
        with short_loop(builder, WORD(0), size, LANES) as row:
            store_vector(builder, factor, scales, builder.add(first, row))

    def of_multiple(groups):
        with groups.vectors() as (multiples, place, other):
            total = fused(builder, load_vector(builder, scales, other), multiples,
                           load_vector(builder, scales, place))
            store_vector(builder, total, scales, other)
    Groups(builder, matrices).each({MULTIPLE: of_multiple})


def _sum_once(groups, scale, outs, height):
    """Strip by strip; of both vectors those of the second one are behind."""
    builder = groups.builder
    begin, behind = ((BEHIND, [groups.head(k) for k in range(2)]) if len(outs) > 1
                     else (0, [WORD(0)] * 2))
    with short_loop(builder, WORD(0), groups.strips) as strip:
        place, (matrix, row) = groups.head(begin, strip), groups.matrix_and_row(begin, strip)
        columns = columns_of(groups, strip)
        for out in outs:
            _add_columns(builder, columns, scale(place, matrix), out, groups.first, height, row)
            place, matrix = (builder.add(one, more) for one, more in
                             zip((place, matrix), behind, strict=True))


def _sum_twice(groups, scale, outs, across, height):
    """The same of strips of one matrix, and of their transposes."""
    builder = groups.builder
    places, matrices = ([groups.head(first + k) for k in range(PRODUCTS)]
                        for first in (0, PRODUCTS))
    with short_loop(builder, WORD(0), groups.strips) as strip:
        row, columns = groups.row(strip), columns_of(groups, strip)
        for k, out in enumerate(outs):
            by = scale(builder.add(places[k], row), matrices[k])
            _add_columns(builder, columns, by, out, groups.first, height, row)
        for k in range(0, groups.width, LANES):
            first = builder.add(groups.first, WORD(k))
            by = scale(builder.add(places[-1], first), matrices[-1])
            _add_columns(builder, _transposed(builder, columns[k:k + LANES]), by, across, row,
                         height, first)


def _sum_diagonal(groups, factors, out, height):
    """Number by number."""
    builder, numbers = groups.builder, groups.entries(WORD(0))
    scale = builder.load(builder.gep(factors, [groups.head(0)]))
    with short_loop(builder, WORD(0), builder.mul(groups.strips, WORD(LANES))) as k:
        place = builder.gep(out, [builder.mul(k, builder.add(height, WORD(1)))])
        number = builder.load(builder.gep(numbers, [k]))
        builder.store(fused(builder, builder.load(place), number, scale), place)


def _add_columns(builder, columns, scale, out, first, height, row):
    """Add some columns to those of a matrix, from a column and a row on."""
    for k, column in enumerate(columns):
        place = builder.add(builder.mul(builder.add(first, WORD(k)), height), row)
        store_vector(builder, fused(builder, load_vector(builder, out, place), column, scale),
                     out, place)


def _transposed(builder, columns):
    """Rows of a square block."""
    def joined(a, b, lanes):
        return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(ir.IntType(32), LANES),
                                                        lanes))
    a, b, c, d = columns
    low = [joined(*two, [0, LANES, 2, LANES + 2]) for two in ((a, b), (c, d))]
    high = [joined(*two, [1, LANES + 1, 3, LANES + 3]) for two in ((a, b), (c, d))]
    halves = [0, 1, LANES, LANES + 1], [2, 3, LANES + 2, LANES + 3]
    return [joined(*two, lanes) for lanes in halves for two in (low, high)]
