"""Products with packed matrices in lanes: what `packed_strips` writes.

The whole numbers of a row are the same in all lanes.
"""

from contextlib import contextmanager

from llvmlite import ir

from sebody.compiler.inside.lanes import VECTOR
from sebody.contract.counts import LANES
from sebody.kernels import packed_strips, packed_sums
from sebody.kernels.instructions import WORD, call, in_lanes, short_loop, whole_vectors
from sebody.kernels.lanes.products import NOTHING, across, behind, fused, read, write
from sebody.kernels.lanes.straight import AT_ADDRESS, AT_LANES, AT_MORE, MOST_GROUPS
from sebody.kernels.packed import BEHIND, PRODUCTS
from sebody.kernels.packed_groups import BOTH, COUPLED, DIAGONAL, MIRRORED, MULTIPLE, ONCE
from sebody.kernels.packed_strips import Groups


class _Groups(Groups):
    """The groups of a row, in the bits of the first lane.

    Where all members share a row, its first number may point to its straight code.
    """

    def __init__(self, builder, matrices):
        super().__init__(builder, matrices, across(matrices))
        self._shared = across(matrices) == 1

    def count(self, kind):
        """Number of groups of a kind; the first one stands apart where there is straight code."""
        if kind > 0 or not self._shared:
            return super().count(kind)
        return self.builder.load(self._apart)

    @property
    def _apart(self):
        builder, own = self.builder, self.builder.load(self._words)
        apart = builder.inttoptr(own, WORD.as_pointer())
        return builder.select(self._points(own), apart, self._words)

    @contextmanager
    def vectors(self):
        """Number by number."""
        builder, own = self.builder, self.entries(WORD(0))
        with short_loop(builder, WORD(0), builder.mul(self.strips, WORD(LANES))) as k:
            yield (read(builder, own, k), builder.add(self.first, k),
                   builder.add(self.vector, k))

    def straight(self):
        """Tell if there is straight code."""
        builder, own = self.builder, self.builder.load(self._words)
        return self._points(own) if self._shared else builder.icmp_signed(
            "!=", self._word(AT_ADDRESS), own)

    def of_straight(self, code):
        """Address of straight code, and of the entries it reads."""
        if not self._shared:
            return self._word(code), self._words
        return self._word(code), self.builder.inttoptr(self._word(AT_LANES),
                                                             VECTOR.as_pointer())

    def _word(self, place):
        """A word of the row, or of the array it points to."""
        return self.builder.load(self.builder.gep(self._apart if self._shared else self._words,
                                                  [WORD(place)]))

    def _points(self, own):
        return self.builder.icmp_signed(">", own, WORD(MOST_GROUPS))


@in_lanes(packed_strips.write_times)
def packed(builder, matrices, x, out, count):
    """`packed_times` in lanes."""
    _times(builder, matrices, x, x, out, count)


@in_lanes(packed_strips.write_times_both)
def packed_both(builder, matrices, x, y, of_x, of_y, count):
    """`packed_times_both` in lanes."""
    for vector, out in ((x, of_x), (y, of_y)):
        call(builder, packed, (matrices, vector, out, count))


@in_lanes(packed_strips.write_more_times)
def add_packed(builder, matrices, x, out):
    """`add_packed_times` in lanes."""
    _straight_or(builder, AT_MORE, (matrices, x, x, out, WORD(0)),
                 lambda: _add_strips(builder, matrices, x, x, out))


@in_lanes(packed_strips.write_couplings)
def couplings(builder, matrices, x, y, out, count):
    """`couplings_times` in lanes."""
    _times(builder, matrices, x, y, out, count)


def _times(builder, matrices, x, y, out, count):
    """Products in whole vectors, as strips have whole ones."""
    count = whole_vectors(builder, count)

    def by_strips():
        with short_loop(builder, WORD(0), count) as place:
            write(builder, NOTHING, out, place)
        _add_strips(builder, matrices, x, y, out)
    _straight_or(builder, AT_ADDRESS, (matrices, x, y, out, count), by_strips)


def _straight_or(builder, code, given, by_strips):
    """Straight code if there is some, see `straight`."""
    groups = _Groups(builder, given[0])
    with builder.if_else(groups.straight()) as (straight, others):
        with straight:
            kind = ir.FunctionType(ir.VoidType(), [*[VECTOR.as_pointer()] * 4, WORD])
            address, own = groups.of_straight(code)
            own = builder.bitcast(own, VECTOR.as_pointer())
            builder.call(builder.inttoptr(address, kind.as_pointer()), (own, *given[1:]))
        with others:
            by_strips()


def _add_strips(builder, matrices, x, y, out):
    """Strip by strip, row by row."""
    def once(groups):
        vector = groups.chosen(x, y)
        with short_loop(builder, WORD(0), groups.strips) as strip:
            _add_rows(groups, strip, [(vector, groups.head(0, strip))], out)

    def both(groups):
        behind_x = groups.head(0)
        with short_loop(builder, WORD(0), groups.strips) as strip:
            place = groups.head(BEHIND, strip)
            _add_rows(groups, strip, [(x, place), (y, builder.add(place, behind_x))], out)

    def twice(forward):
        return lambda groups: _add_twice(groups, forward, out)

    def multiple(groups):
        with groups.vectors() as (factor, place, other):
            write(builder, builder.fmul(factor, read(builder, out, other)), out, place)

    def diagonal(groups):
        with groups.vectors() as (factor, place, other):
            total = fused(builder, read(builder, out, place), factor, read(builder, x, other))
            write(builder, total, out, place)
    _Groups(builder, matrices).each({
        ONCE: once, BOTH: both, MIRRORED: twice([x]), COUPLED: twice([x, y]), MULTIPLE: multiple,
        DIAGONAL: diagonal})


def _add_rows(groups, strip, given, out):
    """Add products of a strip with some vectors to what is kept at some places."""
    builder, own = groups.builder, groups.entries(strip)
    with short_loop(builder, WORD(0), WORD(LANES)) as lane:
        entries = _row(groups, own, lane)
        for vector, place in given:
            _add_row(groups, entries, vector, out, builder.add(place, lane))


def _row(groups, own, lane):
    """The entries of a row of a strip."""
    builder = groups.builder
    return [read(builder, own, behind(builder, lane, LANES * k)) for k in range(groups.width)]


def _add_row(groups, entries, vector, out, place):
    builder, total = groups.builder, read(groups.builder, out, place)
    for k, entry in enumerate(entries):
        total = fused(builder, total, entry,
                      read(builder, vector, behind(builder, groups.first, k)))
    write(builder, total, out, place)


def _add_twice(groups, forward, out):
    """Strips of one matrix that multiply some vectors; the transpose multiplies the last one."""
    builder = groups.builder
    with short_loop(builder, WORD(0), groups.strips) as strip, \
            short_loop(builder, WORD(0), WORD(LANES)) as lane:
        row, entries = builder.add(groups.row(strip), lane), _row(groups, groups.entries(strip),
                                                                  lane)
        for product, vector in enumerate(forward):
            _add_row(groups, entries, vector, out, builder.add(groups.head(product), row))
        factor = read(builder, forward[-1], row)
        first = builder.add(groups.head(PRODUCTS - 1), groups.first)
        for k, entry in enumerate(entries):
            place = behind(builder, first, k)
            write(builder, fused(builder, read(builder, out, place), entry, factor), out, place)


@in_lanes(packed_sums.write_sum)
def sum_packed(builder, matrices, factors, out, height):
    """`add_packed` in lanes."""
    _sum_strips(builder, matrices, lambda _, matrix, lane: read(builder, factors, matrix), out, out,
                height)


@in_lanes(packed_sums.write_sum_of_couplings)
def sum_couplings(builder, matrices, factors, scales, of_x, of_y, products, size, height):
    """`add_couplings` in lanes."""
    with short_loop(builder, WORD(0), products) as k:
        factor, first = read(builder, factors, k), builder.mul(k, size)
        with short_loop(builder, WORD(0), size) as row:
            write(builder, factor, scales, builder.add(first, row))

    def of_multiple(groups):
        with groups.vectors() as (multiple, place, other):
            total = fused(builder, read(builder, scales, other), multiple,
                          read(builder, scales, place))
            write(builder, total, scales, other)
    _Groups(builder, matrices).each({MULTIPLE: of_multiple})
    _sum_strips(builder, matrices,
                lambda place, _, lane: read(builder, scales, builder.add(place, lane)), of_x, of_y,
                height)


def _sum_strips(builder, matrices, scale, of_x, of_y, height):
    """The sum of strips, or of their mirrors; `scale` knows the place, the matrix and the lane."""
    def once(groups):
        with short_loop(builder, WORD(0), groups.strips) as strip:
            place, (matrix, row) = groups.head(0, strip), groups.matrix_and_row(0, strip)
            _sum_entries(groups, strip, row, [(scale, place, matrix, groups.chosen(of_x, of_y))],
                         [], height)

    def both(groups):
        behind = [groups.head(k) for k in range(2)]
        with short_loop(builder, WORD(0), groups.strips) as strip:
            place = groups.head(BEHIND, strip)
            matrix, row = groups.matrix_and_row(BEHIND, strip)
            _sum_entries(groups, strip, row, [
                (scale, place, matrix, of_x),
                (scale, builder.add(place, behind[0]), builder.add(matrix, behind[1]), of_y)],
                [], height)

    def twice(forward):
        def add(groups):
            places, numbers = ([groups.head(first + k) for k in range(PRODUCTS)]
                               for first in (0, PRODUCTS))
            across = [(scale, builder.add(places[-1], groups.first), numbers[-1], forward[-1])]
            with short_loop(builder, WORD(0), groups.strips) as strip:
                row = groups.row(strip)
                given = [(scale, builder.add(places[k], row), numbers[k], out)
                         for k, out in enumerate(forward)]
                _sum_entries(groups, strip, row, given, across, height)
        return add

    def diagonal(groups):
        number, step = groups.head(0), builder.add(height, WORD(1))
        with groups.vectors() as (entry, place, k):
            factor, to = scale(place, number, WORD(0)), builder.mul(k, step)
            write(builder, fused(builder, read(builder, of_x, to), entry, factor), of_x, to)
    _Groups(builder, matrices).each({
        ONCE: once, BOTH: both, MIRRORED: twice([of_x]), COUPLED: twice([of_x, of_y]),
        DIAGONAL: diagonal})


def _sum_entries(groups, strip, row, given, across, height):
    """Add a strip to some matrices, times a factor, and its transpose to others."""
    builder, own = groups.builder, groups.entries(strip)
    with short_loop(builder, WORD(0), WORD(groups.width)) as k:
        column, begin = builder.add(groups.first, k), builder.mul(k, WORD(LANES))
        for lane in range(LANES):
            entry, at = read(builder, own, behind(builder, begin, lane)), behind(builder, row, lane)
            for one, transposed in [*((one, False) for one in given),
                                    *((one, True) for one in across)]:
                scale, place, matrix, out = one
                i, j = (column, at) if transposed else (at, column)
                factor = scale(place, matrix, k if transposed else WORD(lane))
                to = builder.add(builder.mul(j, height), i)
                write(builder, fused(builder, read(builder, out, to), entry, factor), out, to)
