"""Coordinates that determine the others, and those that follow them, with their rates.

All of a kind at once: each entry of a matrix is read once for values, rates and second rates.
"""

from llvmlite import ir
from numba.extending import intrinsic

from sebody.contract.counts import LANES, MOST_SLAVED
from sebody.kernels.instructions import (
    WORD,
    add_product,
    called,
    load_broadcast,
    load_vector,
    no_sum,
    short_loop,
    stack_vectors,
    store_vector,
    sums_of_lanes,
    totals,
    whole_vectors,
)


@intrinsic
def all_to_free(typingctx, y, yd, ydd, axes, order, moved, z, zd, zdd, bound, bound_free, free,
                end):
    """`to_free` of coordinates, of their rates and of their second rates."""
    return called(write_all_to_free, y, yd, ydd, axes, order, moved, z, zd, zdd, bound, bound_free,
                  free, end)


@intrinsic
def follow(typingctx, Zq, Zd, z, zd, zdd, free, slaved, height):
    """Slaved coordinates behind z, and their rates: ``z . Q z / 2``, once and twice derived.

    `Zq` and `Zd` are the products ``Q_b z`` and ``Q_b zd``, `height` numbers apart.
    """
    return called(write_follow, Zq, Zd, z, zd, zdd, free, slaved, height)


@intrinsic
def follow_changes(typingctx, Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height):
    """Changes of the rates of slaved coordinates by those of z, zd and zdd; see `follow`."""
    return called(write_follow_changes, Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height)


def write_all_to_free(builder, *args):
    rows, (axes, order, moved), to = args[:3], args[3:6], args[6:9]
    bound, bound_free, free, end = args[9:]
    height = whole_vectors(builder, bound_free)
    length = builder.add(height, builder.sub(free, bound_free))
    targets = [builder.gep(moved, [builder.mul(length, WORD(k))]) for k in range(3)]
    with short_loop(builder, WORD(0), height, LANES) as row:
        sums = totals(builder, 3)
        for total in sums:
            builder.store(no_sum(), total)
        with short_loop(builder, WORD(0), bound) as column:
            entries = load_vector(builder, axes, builder.add(builder.mul(column, height), row))
            for given, total in zip(rows, sums, strict=True):
                add_product(builder, total, entries, load_broadcast(builder, given, column))
        for total, place in zip(sums, targets, strict=True):
            store_vector(builder, builder.load(total), place, row)
    for given, place in zip(rows, targets, strict=True):
        _copy(builder, builder.gep(given, [bound]), builder.gep(place, [bound_free]),
              builder.sub(free, bound_free))
    _in_order(builder, targets, order, to, free, end)


def _in_order(builder, rows, order, to, count, end):
    """Numbers of some rows in an order, as whole vectors: what reads them next reads vectors."""
    nothing = ir.Constant(ir.DoubleType(), 0.0)
    whole = builder.and_(count, WORD(-LANES))

    def vectors(first, end, number):
        with short_loop(builder, first, end, LANES) as begin:
            totals = [no_sum()] * len(rows)
            for lane in range(LANES):
                k = builder.add(begin, WORD(lane))
                for i, entry in enumerate(number(k)):
                    totals[i] = builder.insert_element(totals[i], entry, ir.IntType(32)(lane))
            for vector, out in zip(totals, to, strict=True):
                store_vector(builder, vector, out, begin)

    def ordered(k):
        at = builder.fptosi(builder.load(builder.gep(order, [k])), WORD)
        return [builder.load(builder.gep(row, [at])) for row in rows]

    def ordered_or_zero(k):
        given = builder.icmp_signed("<", k, count)
        return [builder.select(given, number, nothing)
                for number in ordered(builder.select(given, k, WORD(0)))]
    vectors(WORD(0), whole, ordered)
    vectors(whole, end, ordered_or_zero)


def _copy(builder, given, out, count):
    """Some numbers, whole vectors of them first."""
    whole = builder.and_(count, WORD(-LANES))
    with short_loop(builder, WORD(0), whole, LANES) as k:
        store_vector(builder, load_vector(builder, given, k), out, k)
    with short_loop(builder, whole, count) as k:
        builder.store(builder.load(builder.gep(given, [k])), builder.gep(out, [k]))


def write_follow(builder, Zq, Zd, z, zd, zdd, free, slaved, height):
    half = ir.Constant(ir.DoubleType(), 0.5)
    kept = _room(builder)
    with short_loop(builder, WORD(0), slaved) as b:
        Zq_b, Zd_b = _of_one((Zq, Zd), builder, b, height)
        sums = _dots(builder, height, (
            ((Zq_b, z),), ((Zq_b, zd),), ((Zq_b, zdd),), ((Zd_b, zd),)))    # none waits for two
        store_vector(builder, sums, kept, builder.mul(b, WORD(LANES)))
    with short_loop(builder, WORD(0), slaved) as b:
        value, rate, second, beside = _kept(builder, kept, b, LANES)
        place = builder.add(free, b)
        for out, number in ((z, builder.fmul(value, half)), (zd, rate),
                            (zdd, builder.fadd(second, beside))):
            builder.store(number, builder.gep(out, [place]))


def write_follow_changes(builder, Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height):
    kept = _room(builder)
    with short_loop(builder, WORD(0), slaved) as b:
        Zq_b, Zd_b, Za_b = _of_one((Zq, Zd, Za), builder, b, height)
        sums = _dots(builder, height, (
            ((Zq_b, dzd), (Zd_b, dz)),
            ((Zq_b, dzdd), (Zd_b, dzd), (Zd_b, dzd), (Za_b, dz))))
        store_vector(builder, sums, kept, builder.mul(b, WORD(LANES)))
    with short_loop(builder, WORD(0), slaved) as b:
        rate, second = _kept(builder, kept, b, 2)
        place = builder.add(free, b)
        for out, number in ((dzd, rate), (dzdd, second)):
            builder.store(number, builder.gep(out, [place]))


def _of_one(rows, builder, b, height):
    """The row of one slaved coordinate in each of some products."""
    return [builder.gep(row, [builder.mul(b, height)]) for row in rows]


def _room(builder):
    """Place of a vector for each slaved coordinate: a number that is written just before a vector
    with it is read keeps the processor waiting, so all are read before the first is written."""
    return builder.bitcast(stack_vectors(builder, MOST_SLAVED),
                           ir.DoubleType().as_pointer())


def _kept(builder, kept, b, count):
    first = builder.mul(b, WORD(LANES))
    return [builder.load(builder.gep(kept, [builder.add(first, WORD(k))])) for k in range(count)]


def _dots(builder, count, pairs):
    """Sums of dot products, each of some pairs of vectors of `count` numbers, as a vector."""
    sums = totals(builder, LANES)
    for total in sums:
        builder.store(no_sum(), total)
    with short_loop(builder, WORD(0), count, LANES) as row:
        for total, both in zip(sums, pairs, strict=False):
            for a, b in both:
                add_product(builder, total, load_vector(builder, a, row),
                            load_vector(builder, b, row))
    return sums_of_lanes(builder, [builder.load(total) for total in sums])
