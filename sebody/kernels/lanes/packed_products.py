"""Products with packed matrices in lanes: what `packed_products` writes.

The whole numbers of a row are the same in all lanes.
"""

from llvmlite import ir

from sebody.compiler.inside.lanes import VECTOR
from sebody.contract.counts import LANES
from sebody.kernels import packed_products
from sebody.kernels.instructions import WORD, call, in_lanes, short_loop, whole_vectors
from sebody.kernels.lanes.products import NOTHING, across, behind, fused, read, write
from sebody.kernels.lanes.straight import AT_ADDRESS, MOST_GROUPS


class _Words:
    """The whole numbers of a row of packed matrices, in the bits of the first lane.

    Where all members share a row, its first number may point to its straight code.
    """

    def __init__(self, builder, matrices):
        self._builder = builder
        self._words = builder.bitcast(matrices, WORD.as_pointer())
        self._apart = WORD(across(matrices))
        self._shared = across(matrices) == 1

    @property
    def first(self):
        """Where the number of groups stands, and behind it the address of straight code."""
        if not self._shared:
            return self._words
        builder, own = self._builder, self._builder.load(self._words)
        apart = builder.inttoptr(own, WORD.as_pointer())
        return builder.select(self._points(own), apart, self._words)

    def straight(self):
        """Address of straight code, and whether there is some."""
        builder, own = self._builder, self._builder.load(self._words)
        if self._shared:
            address = builder.load(builder.gep(self.first, [builder.select(
                self._points(own), WORD(AT_ADDRESS), WORD(0))]))
            return address, self._points(own)
        address = builder.load(builder.gep(self._words, [WORD(AT_ADDRESS)]))
        return address, builder.icmp_signed("!=", address, own)

    def _points(self, own):
        return self._builder.icmp_signed(">", own, WORD(MOST_GROUPS))

    def at(self, place):
        """The whole number at a place of the row."""
        builder = self._builder
        return builder.load(builder.gep(self._words, [builder.mul(place, self._apart)]))

    def of_group(self, group):
        """What a group says of itself."""
        builder = self._builder
        place = builder.add(builder.mul(group, WORD(packed_products.GROUP)), WORD(1))
        return [self.at(behind(builder, place, k)) for k in range(packed_products.GROUP)]

    def of_strip(self, heads, strip, k):
        """A whole number in the head of a strip."""
        builder = self._builder
        first = builder.add(heads, builder.mul(strip, WORD(packed_products.HEAD)))
        return self.at(behind(builder, first, k))


@in_lanes(packed_products.write_packed)
def packed(builder, matrices, x, out, count):
    """Of `packed_times`: whole vectors are cleared, as strips have whole ones."""
    with short_loop(builder, WORD(0), whole_vectors(builder, count)) as place:
        write(builder, NOTHING, out, place)
    call(builder, add_packed, (matrices, x, out))


@in_lanes(packed_products.write_more_packed)
def add_packed(builder, matrices, x, out):
    """Of `add_packed_times`: straight code if there is some, see `straight`."""
    address, is_straight = _Words(builder, matrices).straight()
    with builder.if_else(is_straight) as (straight, by_strips):
        with straight:
            kind = ir.FunctionType(ir.VoidType(), [VECTOR.as_pointer()] * 3)
            own = builder.bitcast(matrices, VECTOR.as_pointer())
            builder.call(builder.inttoptr(address, kind.as_pointer()), (own, x, out))
        with by_strips:
            _add_strips(builder, matrices, x, out)


def _add_strips(builder, matrices, x, out):
    """The numbers of `x` stay in registers while strips follow."""
    words = _Words(builder, matrices)
    with short_loop(builder, WORD(0), builder.load(words.first)) as group:
        first, columns, strips, heads, at = words.of_group(group)
        with packed_products.by_width(builder, columns) as widths:
            for width in widths:
                factors = [read(builder, x, behind(builder, first, k)) for k in range(width)]
                with short_loop(builder, WORD(0), strips) as strip:
                    place = words.of_strip(heads, strip, 0)
                    own = packed_products.entries(builder, matrices, at, strip, width)
                    for row in range(LANES):
                        total = read(builder, out, behind(builder, place, row))
                        for k, factor in enumerate(factors):
                            total = fused(builder, total,
                                          read(builder, own, WORD(LANES * k + row)), factor)
                        write(builder, total, out, behind(builder, place, row))


@in_lanes(packed_products.write_sum_packed)
def sum_packed(builder, matrices, factors, out, height):
    """Of `add_packed`."""
    words = _Words(builder, matrices)
    with short_loop(builder, WORD(0), builder.load(words.first)) as group:
        first, columns, strips, heads, at = words.of_group(group)
        with short_loop(builder, WORD(0), strips) as strip:
            matrix, row = (words.of_strip(heads, strip, k) for k in (1, 2))
            scale = read(builder, factors, matrix)
            size = builder.mul(columns, WORD(LANES))
            own = builder.gep(matrices, [builder.add(at, builder.mul(strip, size))])
            with short_loop(builder, WORD(0), columns) as column:
                to = builder.add(builder.mul(builder.add(first, column), height), row)
                from_column = builder.mul(column, WORD(LANES))
                for k in range(LANES):
                    place = behind(builder, to, k)
                    write(builder, fused(builder, read(builder, out, place), read(
                        builder, own, behind(builder, from_column, k)), scale), out, place)
