"""Instructions of products with packed matrices: group by group.

Vectors have four numbers: with those of eight everything else became a twentieth slower, probably
since the processor lowers its clock.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from llvmlite import ir

from sebody.contract.counts import LANES
from sebody.kernels.instructions import (
    WORD,
    add_product,
    call,
    load_broadcast,
    load_vector,
    no_sum,
    short_loop,
    store_vector,
    sums_of_lanes,
    totals,
)
from sebody.kernels.packed import BEGIN, BEHIND, GROUP, KINDS, PRODUCTS
from sebody.kernels.packed_groups import BOTH, COUPLED, DIAGONAL, MIRRORED, MULTIPLE, ONCE

_CLEARED = 8        # vectors at a time


class Groups:
    """The groups of a row, whose whole numbers are `member` numbers apart."""

    def __init__(self, builder: ir.IRBuilder, matrices: ir.Value, member: int = 1):
        self.builder, self.matrices, self._member = builder, matrices, member
        self._words = builder.bitcast(matrices, WORD.as_pointer())

    def at(self, place: ir.Value) -> ir.Value:
        """The whole number at a place of the row."""
        builder = self.builder
        if self._member > 1:
            place = builder.mul(place, WORD(self._member))
        return builder.load(builder.gep(self._words, [place]))

    def count(self, kind: int) -> ir.Value:
        """Number of groups of a kind."""
        return self.at(WORD(kind))

    def each(self, writers: dict[int, Callable[["Groups"], None]]) -> None:
        """Go through the groups; in their order, writers of instructions for each use."""
        builder, done = self.builder, WORD(0)
        for kind, (use, self.width) in enumerate(KINDS):
            end = builder.add(done, self.count(kind))
            if use in writers:
                with short_loop(builder, done, end) as group:
                    place = builder.add(builder.mul(group, WORD(GROUP)), WORD(BEGIN))
                    self.first, self.vector, self.strips, self.heads, self.begin = (
                        self.at(builder.add(place, WORD(k))) for k in range(GROUP))
                    writers[use](self)
            done = end

    @contextmanager
    def vectors(self) -> Iterator[tuple[ir.Value, ir.Value, ir.Value]]:
        """Vectors of a multiple, or of a diagonal: factors, and places of their products.

        Then the places of what they multiply.
        """
        builder = self.builder
        with short_loop(builder, WORD(0), self.strips) as k:
            at = builder.mul(k, WORD(LANES))
            yield (load_vector(builder, self.matrices, builder.add(self.begin, at)),
                   builder.add(self.first, at), builder.add(self.vector, at))

    def head(self, k: int, strip: ir.Value | None = None) -> ir.Value:
        """A whole number of the heads: number k, or that of a strip of those from there on."""
        builder, place = self.builder, self.heads
        if strip is not None:
            place = builder.add(place, strip)
        return self.at(builder.add(place, WORD(k)))

    def matrix_and_row(self, k: int, strip: ir.Value) -> list[ir.Value]:
        """Matrix and first row of a strip whose place is among those from number k on."""
        builder = self.builder
        place = builder.add(self.heads, builder.add(self.strips, builder.mul(strip, WORD(2))))
        return [self.at(builder.add(place, WORD(k + i))) for i in range(2)]

    def row(self, strip: ir.Value) -> ir.Value:
        """First row of a strip of a group that is used twice."""
        return self.head(2 * PRODUCTS, strip)

    def entries(self, strip: ir.Value) -> ir.Value:
        """Pointer to the entries of a strip."""
        builder = self.builder
        place = builder.add(self.begin, builder.mul(strip, WORD(LANES * self.width)))
        return builder.gep(self.matrices, [place])

    def chosen(self, first: ir.Value, second: ir.Value) -> ir.Value:
        """The first or the second value, by the vector of the group."""
        is_first = self.builder.icmp_signed("==", self.vector, WORD(0))
        return self.builder.select(is_first, first, second)


def write_times(builder, matrices, x, out, count):
    _clear(builder, out, count)
    call(builder, write_more_times, (matrices, x, out))


def write_more_times(builder, matrices, x, out):
    Groups(builder, matrices).each(_of_vectors([(x, out)]))


def write_times_both(builder, matrices, x, y, of_x, of_y, count):
    for out in (of_x, of_y):
        _clear(builder, out, count)
    Groups(builder, matrices).each(_of_vectors([(x, of_x), (y, of_y)]))


def write_couplings(builder, matrices, x, y, out, count):
    _clear_sums(builder, matrices, out, count)
    Groups(builder, matrices).each({
        ONCE: lambda groups: _once(groups, [(groups.chosen(x, y), out)]),
        BOTH: lambda groups: _both(groups, x, y, out),
        MIRRORED: lambda groups: _twice(groups, [(0, x, out)], [(x, out)]),
        COUPLED: lambda groups: _twice(groups, [(0, x, out), (1, y, out)], [(y, out)]),
        MULTIPLE: lambda groups: _multiple(groups, out)})


def _of_vectors(given):
    """Uses of groups that multiply every one of some vectors."""
    forward = [(0, x, out) for x, out in given]
    return {ONCE: lambda groups: _once(groups, given),
            MIRRORED: lambda groups: _twice(groups, forward, given),
            DIAGONAL: lambda groups: _diagonal(groups, given)}


def _clear_sums(builder, matrices, out, count):
    """Zeros where products are sums: those that are multiples are only written.

    Multiples stand in the order of their products.
    """
    with builder.goto_entry_block():
        done = builder.alloca(WORD)
    builder.store(WORD(0), done)

    def clear_until(end):
        first = builder.load(done)
        _clear(builder, builder.gep(out, [first]), builder.sub(end, first))

    def before_multiple(groups):
        clear_until(groups.first)
        builder.store(builder.add(groups.first, builder.mul(groups.strips, WORD(LANES))), done)
    Groups(builder, matrices).each({MULTIPLE: before_multiple})
    clear_until(count)


def _clear(builder, out, count):
    """Zeros in whole vectors, some at a time."""
    done = WORD(0)
    for vectors in (_CLEARED, 1):
        step = LANES * vectors
        end = builder.sub(count, builder.srem(builder.sub(count, done), WORD(step)))
        with short_loop(builder, done, end, step) as place:
            for k in range(vectors):
                store_vector(builder, no_sum(), out, builder.add(place, WORD(LANES * k)))
        done = end


def _once(groups, given):
    """The numbers of the vectors stay in registers while strips follow."""
    builder = groups.builder
    factors = [_factors(groups, x) for x, _ in given]
    with short_loop(builder, WORD(0), groups.strips) as strip:
        place, columns = groups.head(0, strip), columns_of(groups, strip)
        for (_, out), numbers in zip(given, factors, strict=True):
            _add_times(builder, out, place, columns, numbers)


def _both(groups, x, y, out):
    """Strips of matrices that multiply both vectors."""
    builder = groups.builder
    factors = [_factors(groups, vector) for vector in (x, y)]
    behind = groups.head(0)
    with short_loop(builder, WORD(0), groups.strips) as strip:
        place, columns = groups.head(BEHIND, strip), columns_of(groups, strip)
        for numbers in factors:
            _add_times(builder, out, place, columns, numbers)
            place = builder.add(place, behind)


def _twice(groups, forward, across):
    """Strips of one matrix; sums of the transposed products stay in registers.

    `forward` are the products of the strips: which one, the vector, what it is added to; `across`
    the same of the transpose, which is always the last product.
    """
    builder, width = groups.builder, groups.width
    places = [groups.head(k) for k in range(PRODUCTS)]
    factors = [_factors(groups, x) for _, x, _ in forward]
    sums = [totals(builder, width) for _ in across]
    for total in (total for of_one in sums for total in of_one):
        builder.store(no_sum(), total)
    with short_loop(builder, WORD(0), groups.strips) as strip:
        row, columns = groups.row(strip), columns_of(groups, strip)
        for (product, _, out), numbers in zip(forward, factors, strict=True):
            _add_times(builder, out, builder.add(places[product], row), columns, numbers)
        for (x, _), of_one in zip(across, sums, strict=True):
            numbers = load_vector(builder, x, row)
            for total, column in zip(of_one, columns, strict=True):
                add_product(builder, total, column, numbers)
    for (_, out), of_one in zip(across, sums, strict=True):
        found = [builder.load(total) for total in of_one]
        for k in range(0, width, LANES):
            place = builder.add(places[-1], builder.add(groups.first, WORD(k)))
            _add_to(builder, out, place, sums_of_lanes(builder, found[k:k + LANES]))


def _multiple(groups, out):
    """A product from another one, number by number."""
    builder = groups.builder
    with groups.vectors() as (factors, place, other):
        store_vector(builder, builder.fmul(factors, load_vector(builder, out, other)), out, place)


def _diagonal(groups, given):
    """Vectors of a diagonal, times those of some vectors."""
    builder = groups.builder
    with groups.vectors() as (factors, place, other):
        for x, out in given:
            total = fused(builder, load_vector(builder, out, place), factors,
                          load_vector(builder, x, other))
            store_vector(builder, total, out, place)


def columns_of(groups, strip):
    """The columns of a strip."""
    own = groups.entries(strip)
    return [load_vector(groups.builder, own, WORD(LANES * k)) for k in range(groups.width)]


def _factors(groups, x):
    """Factors of the columns of the strips of a group."""
    builder = groups.builder
    return [load_broadcast(builder, x, builder.add(groups.first, WORD(k)))
            for k in range(groups.width)]


def _add_times(builder, out, place, columns, factors):
    """Add the product of a strip to what is kept at a place.

    That number is added last: strips that are added to the same place wait for each other.
    """
    product = builder.fmul(columns[0], factors[0])
    for column, factor in zip(columns[1:], factors[1:], strict=True):
        product = fused(builder, product, column, factor)
    _add_to(builder, out, place, product)


def _add_to(builder, out, place, vector):
    store_vector(builder, builder.fadd(load_vector(builder, out, place), vector), out, place)


def fused(builder, total, a, b):
    return builder.fadd(total, builder.fmul(a, b, flags=("contract",)), flags=("contract",))
