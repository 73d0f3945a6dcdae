"""Products with the packed matrices of `sebody.kernels.packed`, and their sums."""

from contextlib import contextmanager

from numba.extending import intrinsic

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.kernels.abi import padded
from sebody.kernels.dense import columns_times
from sebody.kernels.instructions import (
    WORD,
    call,
    called,
    load_broadcast,
    load_vector,
    no_sum,
    short_loop,
    store_vector,
)
from sebody.kernels.packed import GROUP, HEAD, WIDTHS


@compiled
def packed_room(count, rows, columns):
    """Numbers that a row of packed matrices takes, see `sebody.contract.counts.packed_size`."""
    width = padded(columns)
    return count * padded(rows) * (width + width // 4) + 2 * width + 1


@compiled
def to_free(y, axes, order, moved, z, bound, bound_free, free, end):
    """Coordinates that determine the others, in axes of the body and in their order, then zeros."""
    columns_times(axes, y, moved, bound_free, bound)
    for k in range(free - bound_free):
        moved[bound_free + k] = y[bound + k]
    for k in range(free):
        z[k] = moved[int(order[k])]
    for k in range(free, end):
        z[k] = 0.0


@compiled
def from_free(z, back, order, moved, y, bound, bound_free, free):
    """The transpose: forces conjugate to all coordinates from those that determine the others."""
    for k in range(free):
        moved[int(order[k])] = z[k]
    columns_times(back, moved, y, bound, bound_free)
    for k in range(free - bound_free):
        y[bound + k] = moved[bound_free + k]


@intrinsic
def packed_times(typingctx, matrices, x, out, count):
    """``out = A_k x`` of all matrices, one product after the other, `count` numbers in all.

    Of `x` whole vectors are read, whose numbers beyond the columns only have to be finite.
    """
    return called(write_packed, matrices, x, out, count)


@intrinsic
def add_packed_times(typingctx, matrices, x, out):
    """``out += A_k x`` of all matrices, one product after the other."""
    return called(write_more_packed, matrices, x, out)


@intrinsic
def add_packed(typingctx, matrices, factors, out, height):
    """``out += sum_k factors_k A_k``, in columns that are `height` numbers apart.

    Zeros are added to columns of `out` up to a multiple of `LANES`.
    """
    return called(write_sum_packed, matrices, factors, out, height)


def write_packed(builder, matrices, x, out, count):
    """Clear what the products are added to: whole vectors."""
    with short_loop(builder, WORD(0), count, LANES) as place:
        store_vector(builder, no_sum(), out, place)
    call(builder, write_more_packed, (matrices, x, out))


def write_more_packed(builder, matrices, x, out):
    """Group by group; the numbers of `x` stay in registers while its strips follow."""
    words = builder.bitcast(matrices, WORD.as_pointer())
    with short_loop(builder, WORD(0), builder.load(words)) as group:
        first, columns, strips, heads, at = _group(builder, words, group)
        with by_width(builder, columns) as widths:
            for width in widths:
                factors = [load_broadcast(builder, x, builder.add(first, WORD(k)))
                           for k in range(width)]
                with short_loop(builder, WORD(0), strips) as strip:
                    place = _whole(builder, words, _head(builder, heads, strip, 0))
                    own = entries(builder, matrices, at, strip, width)
                    total = load_vector(builder, out, place)
                    for k, factor in enumerate(factors):
                        total = _added(builder, total,
                                       load_vector(builder, own, WORD(LANES * k)), factor)
                    store_vector(builder, total, out, place)


@contextmanager
def by_width(builder, columns):
    """Goes through the widths of strips; instructions stand where a group has this width."""
    end = builder.append_basic_block("end")
    by_width = builder.switch(columns, end)

    def each():
        for width in WIDTHS:
            block = builder.append_basic_block(f"width {width}")
            by_width.add_case(WORD(width), block)
            builder.position_at_end(block)
            yield width
            builder.branch(end)
    yield each()
    builder.position_at_end(end)


def _group(builder, words, group):
    """What a group says of itself."""
    place = builder.add(builder.mul(group, WORD(GROUP)), WORD(1))
    return [_whole(builder, words, builder.add(place, WORD(k))) for k in range(GROUP)]


def _whole(builder, words, place):
    return builder.load(builder.gep(words, [place]))


def _head(builder, heads, strip, k):
    """Place of a whole number in the head of a strip."""
    return builder.add(heads, builder.add(builder.mul(strip, WORD(HEAD)), WORD(k)))


def entries(builder, matrices, at, strip, width):
    """Pointer to the entries of a strip."""
    return builder.gep(matrices, [builder.add(at, builder.mul(strip, WORD(LANES * width)))])


def _added(builder, total, a, b):
    return builder.fadd(total, builder.fmul(a, b, flags=("contract",)), flags=("contract",))


def write_sum_packed(builder, matrices, factors, out, height):
    """Strip by strip."""
    words = builder.bitcast(matrices, WORD.as_pointer())
    with short_loop(builder, WORD(0), builder.load(words)) as group:
        first, columns, strips, heads, at = _group(builder, words, group)
        with by_width(builder, columns) as widths:
            for width in widths:
                with short_loop(builder, WORD(0), strips) as strip:
                    matrix, row = (_whole(builder, words, _head(builder, heads, strip, k))
                                   for k in (1, 2))
                    scale = load_broadcast(builder, factors, matrix)
                    own = entries(builder, matrices, at, strip, width)
                    for k in range(width):
                        place = builder.add(builder.mul(builder.add(first, WORD(k)), height), row)
                        total = _added(builder, load_vector(builder, out, place),
                                       load_vector(builder, own, WORD(LANES * k)), scale)
                        store_vector(builder, total, out, place)
