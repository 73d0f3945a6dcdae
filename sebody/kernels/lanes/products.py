"""Products whose numbers are lanes: what `dense` and `coordinates` write.

An operand is a vector of members, so there is nothing to add up across a vector, and padding is
neither read nor written. Matrices are lanes as well, since members have constants of their own.
"""

from functools import reduce

from llvmlite import ir

from sebody.compiler.inside.lanes import VECTOR, same
from sebody.kernels import coordinates, dense
from sebody.kernels.instructions import (
    WORD,
    in_lanes,
    short_loop,
    stack_vectors,
    whole_vectors,
)

_SUMS = 8, 4, 2, 1      # of a product at a time: they stay in registers
_BITS = ir.IntType(VECTOR.count)
NOTHING = ir.Constant(VECTOR, [0.0] * VECTOR.count)


def read(builder, pointer, place):
    """The numbers at a place: lanes, or a number that all members share."""
    number = builder.load(builder.gep(pointer, [place]))
    return number if number.type == VECTOR else same(builder, number)


def across(pointer):
    """Numbers from one place to the next."""
    return VECTOR.count if pointer.type.pointee == VECTOR else 1


def write(builder, value, pointer, place):
    builder.store(value, builder.gep(pointer, [place]))


def fused(builder, total, a, b):
    return builder.fadd(total, builder.fmul(a, b, flags=("contract",)), flags=("contract",))


def behind(builder, index, k):
    return builder.add(index, WORD(k)) if k else index


def _sums(builder, count):
    """Places of sums that stay in registers."""
    return [stack_vectors(builder, 1, VECTOR) for _ in range(count)]


def _add_to(builder, total, a, b):
    builder.store(fused(builder, builder.load(total), a, b), total)


def _each_block(builder, size, write_block):
    """Instructions for as many sums at a time as there are: the last ones overlap those before.

    One sum after the other, or few at a time, would wait for each other's products.

    Parameters
    ----------
    size : value
        How many sums there are.
    write_block : callable
        Writes the instructions, of how many sums, the first one, and the first one that was not
        written before.
    """
    for k, count in enumerate(_SUMS):
        fits = builder.icmp_signed(">=", size, WORD(count))
        if k:
            fits = builder.and_(fits, builder.icmp_signed("<", size, WORD(_SUMS[k - 1])))
        with builder.if_then(fits):
            last = builder.sub(size, WORD(count))
            with short_loop(builder, WORD(0), size, count) as new:
                first = builder.select(builder.icmp_signed("<", new, last), new, last)
                write_block(count, first, new)


def _begin(builder, sums, out, first, add):
    for k, total in enumerate(sums):
        begin = read(builder, out, behind(builder, first, k)) if add else NOTHING
        builder.store(begin, total)


def _end(builder, sums, out, first, new, add):
    """Write sums; those that add, and were written before, stay."""
    for k, total in enumerate(sums):
        place, value = behind(builder, first, k), builder.load(total)
        if add:
            is_new = builder.icmp_signed(">=", place, new)
            value = builder.select(is_new, value, read(builder, out, place))
        write(builder, value, out, place)


def _by_rows(builder, given, out, rows, height, add):
    """``out = A x``, or ``out += A x``, of some matrices, vectors and numbers of columns."""
    def write_block(count, first, new):
        sums = _sums(builder, count)
        _begin(builder, sums, out, first, add)
        for A, x, columns in given:
            with short_loop(builder, WORD(0), columns) as column:
                factor = read(builder, x, column)
                own = builder.gep(A, [builder.add(builder.mul(column, height), first)])
                for k, total in enumerate(sums):
                    _add_to(builder, total, read(builder, own, WORD(k)), factor)
        _end(builder, sums, out, first, new, add)
    _each_block(builder, rows, write_block)


def _by_columns(builder, A, x, out, rows, columns, height, add):
    """``out_k = a_k . x``, or added to that, of columns a_k."""
    def write_block(count, first, new):
        sums = _sums(builder, count)
        own = [builder.gep(A, [builder.mul(behind(builder, first, k), height)])
               for k in range(count)]
        _begin(builder, sums, out, first, add)
        with short_loop(builder, WORD(0), rows) as row:
            factor = read(builder, x, row)
            for a, total in zip(own, sums, strict=True):
                _add_to(builder, total, read(builder, a, row), factor)
        _end(builder, sums, out, first, new, add)
    _each_block(builder, columns, write_block)


@in_lanes(dense.write_columns)
def multiply(builder, A, x, out, rows, columns):
    """`columns_times` in lanes: columns of whole vectors of `LANES` numbers."""
    _by_rows(builder, [(A, x, columns)], out, rows, whole_vectors(builder, rows), False)


@in_lanes(dense.write_columns_of_all)
def multiply_all(builder, A, x, y, z, of_x, of_y, of_z, rows, columns):
    """`columns_times_all` in lanes."""
    for given, out in ((x, of_x), (y, of_y), (z, of_z)):
        multiply(builder, A, given, out, rows, columns)


@in_lanes(dense.write_block)
def block(builder, A, x, out, rows, columns, height):
    """`block_times` in lanes."""
    _by_rows(builder, [(A, x, columns)], out, rows, height, False)


@in_lanes(dense.write_more_block)
def add_block(builder, A, x, out, rows, columns, height):
    """`add_block_times` in lanes."""
    _by_rows(builder, [(A, x, columns)], out, rows, height, True)


@in_lanes(dense.write_more_blocks)
def add_blocks(builder, A, x, B, y, out, rows, columns, of_B, height):
    """`add_blocks_times` in lanes."""
    _by_rows(builder, [(A, x, columns), (B, y, of_B)], out, rows, height, True)


@in_lanes(dense.write_dots)
def dots(builder, A, x, out, rows, columns, height):
    """`rows_times` in lanes."""
    _by_columns(builder, A, x, out, rows, columns, height, False)


@in_lanes(dense.write_more_dots)
def add_dots(builder, A, x, out, rows, columns, height):
    """`add_rows_times` in lanes."""
    _by_columns(builder, A, x, out, rows, columns, height, True)


@in_lanes(dense.write_more_columns)
def more_columns(builder, A, x, out, rows, columns, height):
    """The second part of `arrow_times` in lanes."""
    _by_rows(builder, [(A, x, columns)], out, rows, height, True)


# coordinates that determine the others


@in_lanes(coordinates.write_all_to_free)
def all_to_free(builder, *args):
    """`all_to_free` in lanes; numbers beyond the last are zeros, as strips read whole vectors.

    Axes of a body are often those of its frame: entries that are zero in all lanes are left out.
    """
    rows, (axes, order, moved), to = args[:3], args[3:6], args[6:9]
    bound, bound_free, free, end = args[9:]
    height = whole_vectors(builder, bound_free)
    length = builder.add(height, builder.sub(free, bound_free))
    own = [builder.gep(moved, [builder.mul(length, WORD(k))]) for k in range(len(rows))]
    with short_loop(builder, WORD(0), bound_free) as k:
        for place in own:
            write(builder, NOTHING, place, k)
    with short_loop(builder, WORD(0), bound) as column, \
            short_loop(builder, WORD(0), bound_free) as k:
        entry = read(builder, axes, builder.add(builder.mul(column, height), k))
        is_entry = builder.bitcast(builder.fcmp_unordered("!=", entry, NOTHING), _BITS)
        with builder.if_then(builder.icmp_unsigned("!=", is_entry, _BITS(0))):
            for given, place in zip(rows, own, strict=True):
                write(builder, fused(builder, read(builder, place, k), entry,
                                       read(builder, given, column)), place, k)
    for given, place in zip(rows, own, strict=True):
        with short_loop(builder, WORD(0), builder.sub(free, bound_free)) as mode:
            write(builder, read(builder, given, builder.add(bound, mode)), place,
                   builder.add(bound_free, mode))
    words = builder.bitcast(order, ir.DoubleType().as_pointer())
    with short_loop(builder, WORD(0), free) as k:
        at = builder.fptosi(builder.load(builder.gep(words, [
            builder.mul(k, WORD(across(order)))])), WORD)
        for given, out in zip(own, to, strict=True):
            write(builder, read(builder, given, at), out, k)
    with short_loop(builder, free, whole_vectors(builder, end)) as k:
        for out in to:
            write(builder, NOTHING, out, k)


def _dots(builder, sums_of_pairs, count):
    """Sums of the dot products of some pairs of vectors, all in one loop.

    Each pair has a sum of its own: one after the other they would wait for each other.
    """
    sums = [_sums(builder, len(pairs)) for pairs in sums_of_pairs]
    for own in sums:
        for total in own:
            builder.store(NOTHING, total)
    with short_loop(builder, WORD(0), count) as k:
        for own, pairs in zip(sums, sums_of_pairs, strict=True):
            for total, (a, b) in zip(own, pairs, strict=True):
                _add_to(builder, total, read(builder, a, k), read(builder, b, k))
    return [reduce(builder.fadd, map(builder.load, own)) for own in sums]


@in_lanes(coordinates.write_follow)
def follow(builder, Zq, Zd, z, zd, zdd, free, slaved, height):
    """`follow` in lanes: a row of z is read to its free numbers, so those behind may change."""
    half = ir.Constant(VECTOR, [0.5] * VECTOR.count)
    with short_loop(builder, WORD(0), slaved) as b:
        Zq_b, Zd_b = (builder.gep(row, [builder.mul(b, height)]) for row in (Zq, Zd))
        place = builder.add(free, b)
        value, rate, second = _dots(builder, [
            [(Zq_b, z)], [(Zq_b, zd)], [(Zq_b, zdd), (Zd_b, zd)]], free)
        write(builder, builder.fmul(value, half), z, place)
        write(builder, rate, zd, place)
        write(builder, second, zdd, place)


@in_lanes(coordinates.write_follow_changes)
def follow_changes(builder, Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height):
    """`follow_changes` in lanes."""
    with short_loop(builder, WORD(0), slaved) as b:
        Zq_b, Zd_b, Za_b = (builder.gep(row, [builder.mul(b, height)]) for row in (Zq, Zd, Za))
        place = builder.add(free, b)
        rate, second = _dots(builder, [
            [(Zq_b, dzd), (Zd_b, dz)],
            [(Zq_b, dzdd), (Zd_b, dzd), (Zd_b, dzd), (Za_b, dz)]], free)
        write(builder, rate, dzd, place)
        write(builder, second, dzdd, place)
