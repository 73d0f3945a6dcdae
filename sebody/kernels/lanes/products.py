"""Products whose numbers are lanes: what `dense`, `packed_strips` and `coordinates` write.

An operand is a vector of members, so there is nothing to add up across a vector, and padding is
neither read nor written. Matrices are lanes as well, since members have constants of their own.
"""

from llvmlite import ir

from sebody.compiler.inside.lanes import VECTOR
from sebody.contract.counts import LANES
from sebody.kernels import coordinates, dense, packed_strips
from sebody.kernels.instructions import (
    WORD,
    call,
    in_lanes,
    short_loop,
    stack_vectors,
    whole_vectors,
)
from sebody.kernels.lanes.straight import AT_ADDRESS
from sebody.kernels.packed import COUPLED, MIRRORED, NARROW, PRODUCTS, WIDE, WIDTHS
from sebody.kernels.packed_strips import Groups

_ROWS = 8, 4, 2, 1      # of a product at a time: their sums stay in registers
_COLUMNS = 8, 4, 2, 1   # likewise of a product of columns with a vector
_BITS = ir.IntType(VECTOR.count)
_NOTHING = ir.Constant(VECTOR, [0.0] * VECTOR.count)


def _load(builder, pointer, place):
    return builder.load(builder.gep(pointer, [place]))


def _store(builder, value, pointer, place):
    builder.store(value, builder.gep(pointer, [place]))


def _fused(builder, total, a, b):
    return builder.fadd(total, builder.fmul(a, b, flags=("contract",)), flags=("contract",))


def _next(builder, index, k):
    return builder.add(index, WORD(k)) if k else index


def _sums(builder, count):
    """Places of sums that stay in registers."""
    return [stack_vectors(builder, 1, VECTOR) for _ in range(count)]


def _add_to(builder, total, a, b):
    builder.store(_fused(builder, builder.load(total), a, b), total)


def _by_rows(builder, given, out, rows, height, add):
    """``out = A x``, or ``out += A x``, of some matrices, vectors and numbers of columns."""
    done = WORD(0)
    for count in _ROWS:
        end = builder.sub(rows, builder.srem(builder.sub(rows, done), WORD(count)))
        with short_loop(builder, done, end, count) as row:
            sums = _sums(builder, count)
            for k, total in enumerate(sums):
                begin = _load(builder, out, _next(builder, row, k)) if add else _NOTHING
                builder.store(begin, total)
            for A, x, columns in given:
                with short_loop(builder, WORD(0), columns) as column:
                    factor = _load(builder, x, column)
                    own = builder.gep(A, [builder.add(builder.mul(column, height), row)])
                    for k, total in enumerate(sums):
                        _add_to(builder, total, _load(builder, own, WORD(k)), factor)
            for k, total in enumerate(sums):
                _store(builder, builder.load(total), out, _next(builder, row, k))
        done = end


def _by_columns(builder, A, x, out, rows, columns, height, add):
    """``out_k = a_k . x``, or added to that, of columns a_k."""
    done = WORD(0)
    for count in _COLUMNS:
        end = builder.sub(columns, builder.srem(builder.sub(columns, done), WORD(count)))
        with short_loop(builder, done, end, count) as column:
            sums = _sums(builder, count)
            own = [builder.gep(A, [builder.mul(_next(builder, column, k), height)])
                   for k in range(count)]
            for k, total in enumerate(sums):
                begin = _load(builder, out, _next(builder, column, k)) if add else _NOTHING
                builder.store(begin, total)
            with short_loop(builder, WORD(0), rows) as row:
                factor = _load(builder, x, row)
                for a, total in zip(own, sums, strict=True):
                    _add_to(builder, total, _load(builder, a, row), factor)
            for k, total in enumerate(sums):
                _store(builder, builder.load(total), out, _next(builder, column, k))
        done = end


@in_lanes(dense.write_columns)
def multiply(builder, A, x, out, rows, columns):
    """Of `columns_times`: columns of whole vectors of `LANES` numbers."""
    _by_rows(builder, [(A, x, columns)], out, rows, whole_vectors(builder, rows), False)


@in_lanes(dense.write_block)
def block(builder, A, x, out, rows, columns, height):
    """Of `block_times`."""
    _by_rows(builder, [(A, x, columns)], out, rows, height, False)


@in_lanes(dense.write_more_block)
def add_block(builder, A, x, out, rows, columns, height):
    """Of `add_block_times`."""
    _by_rows(builder, [(A, x, columns)], out, rows, height, True)


@in_lanes(dense.write_more_blocks)
def add_blocks(builder, A, x, B, y, out, rows, columns, of_B, height):
    """Of `add_blocks_times`."""
    _by_rows(builder, [(A, x, columns), (B, y, of_B)], out, rows, height, True)


@in_lanes(dense.write_dots)
def dots(builder, A, x, out, rows, columns, height):
    """Of `rows_times`."""
    _by_columns(builder, A, x, out, rows, columns, height, False)


@in_lanes(dense.write_more_dots)
def add_dots(builder, A, x, out, rows, columns, height):
    """Of `add_rows_times`."""
    _by_columns(builder, A, x, out, rows, columns, height, True)


def _subtracted(builder, total, a, b):
    return builder.fsub(total, builder.fmul(a, b, flags=("contract",)), flags=("contract",))


@in_lanes(dense.write_subtract_product)
def subtract_product(builder, C, A, B):
    """Of `subtract_product`."""
    with short_loop(builder, WORD(0), WORD(LANES * LANES), LANES) as column:
        factors = [_load(builder, B, _next(builder, column, k)) for k in range(LANES)]
        for i in range(LANES):
            total = _load(builder, C, _next(builder, column, i))
            for k, factor in enumerate(factors):
                total = _subtracted(builder, total, _load(builder, A, WORD(LANES * k + i)), factor)
            _store(builder, total, C, _next(builder, column, i))


@in_lanes(dense.write_subtract_block_times)
def subtract_block_times(builder, y, A, x):
    """Of `subtract_block_times`."""
    factors = [_load(builder, x, WORD(k)) for k in range(LANES)]
    for i in range(LANES):
        total = _load(builder, y, WORD(i))
        for k, factor in enumerate(factors):
            total = _subtracted(builder, total, _load(builder, A, WORD(LANES * k + i)), factor)
        _store(builder, total, y, WORD(i))


@in_lanes(dense.write_more_columns)
def more_columns(builder, A, x, out, rows, columns, height):
    """Of the second part of `arrow_times`."""
    _by_rows(builder, [(A, x, columns)], out, rows, height, True)


# packed matrices: the whole numbers of a row are the same in all lanes


@in_lanes(packed_strips.write_times)
def packed(builder, matrices, x, out, count):
    """Of `packed_times`."""
    _clear(builder, out, count)
    call(builder, add_packed, (matrices, x, out))


@in_lanes(packed_strips.write_times_both)
def packed_both(builder, matrices, x, y, of_x, of_y, count):
    """Of `packed_times_both`."""
    for vector, out in ((x, of_x), (y, of_y)):
        call(builder, packed, (matrices, vector, out, count))


@in_lanes(packed_strips.write_more_times)
def add_packed(builder, matrices, x, out):
    """Of `add_packed_times`."""
    _straight_or(builder, matrices, x, x, out, lambda: _add_strips(builder, matrices, x, x, out))


@in_lanes(packed_strips.write_couplings)
def couplings(builder, matrices, x, y, out, count):
    """Of `couplings_times`."""
    _clear(builder, out, count)
    _straight_or(builder, matrices, x, y, out, lambda: _add_strips(builder, matrices, x, y, out))


def _clear(builder, out, count):
    """Whole vectors, as strips have whole ones."""
    with short_loop(builder, WORD(0), whole_vectors(builder, count)) as place:
        _store(builder, _NOTHING, out, place)


def _straight_or(builder, matrices, x, y, out, write):
    """Straight code if there is some, see `straight`."""
    words = builder.bitcast(matrices, WORD.as_pointer())
    groups, address = builder.load(words), builder.load(builder.gep(words, [WORD(AT_ADDRESS)]))
    with builder.if_else(builder.icmp_signed("!=", address, groups)) as (straight, by_strips):
        with straight:
            kind = ir.FunctionType(ir.VoidType(), [VECTOR.as_pointer()] * 4)
            builder.call(builder.inttoptr(address, kind.as_pointer()), (matrices, x, y, out))
        with by_strips:
            write()


def _add_strips(builder, matrices, x, y, out):
    """The numbers of a vector stay in registers while strips follow."""
    def once(kind):
        def write(groups):
            vector = groups.chosen(x, y)
            factors = [_load(builder, vector, _next(builder, groups.first, k))
                       for k in range(WIDTHS[kind])]
            with short_loop(builder, WORD(0), groups.strips) as strip:
                place, own = groups.head(0, strip), groups.entries(strip, kind)
                for row in range(LANES):
                    total = _load(builder, out, _next(builder, place, row))
                    for k, factor in enumerate(factors):
                        total = _fused(builder, total,
                                       _load(builder, own, WORD(LANES * k + row)), factor)
                    _store(builder, total, out, _next(builder, place, row))
        return write

    def twice(forward):
        return lambda groups: _add_twice(groups, forward, out)
    Groups(builder, matrices, VECTOR.count).each({
        NARROW: once(NARROW), WIDE: once(WIDE), MIRRORED: twice([x]), COUPLED: twice([x, y])})


def _add_twice(groups, forward, out):
    """Strips of one matrix that multiply some vectors; the transpose multiplies the last one."""
    builder = groups.builder
    with short_loop(builder, WORD(0), groups.strips) as strip, \
            short_loop(builder, WORD(0), WORD(LANES)) as lane:
        row, own = builder.add(groups.row(strip), lane), groups.entries(strip, MIRRORED)
        entries = [_load(builder, own, builder.add(lane, WORD(LANES * k)))
                   for k in range(WIDTHS[MIRRORED])]
        for product, vector in enumerate(forward):
            place = builder.add(groups.head(product), row)
            total = _load(builder, out, place)
            for k, entry in enumerate(entries):
                total = _fused(builder, total, entry,
                               _load(builder, vector, _next(builder, groups.first, k)))
            _store(builder, total, out, place)
        factor = _load(builder, forward[-1], row)
        first = builder.add(groups.head(PRODUCTS - 1), groups.first)
        for k, entry in enumerate(entries):
            place = _next(builder, first, k)
            _store(builder, _fused(builder, _load(builder, out, place), entry, factor), out, place)


@in_lanes(packed_strips.write_sum)
def sum_packed(builder, matrices, factors, out, height):
    """Of `add_packed`."""
    _sum_strips(builder, matrices, factors, out, out, height)


@in_lanes(packed_strips.write_sum_of_couplings)
def sum_couplings(builder, matrices, factors, of_x, of_y, height):
    """Of `add_couplings`."""
    _sum_strips(builder, matrices, factors, of_x, of_y, height)


def _sum_strips(builder, matrices, factors, of_x, of_y, height):
    def once(kind):
        def write(groups):
            out = groups.chosen(of_x, of_y)
            with short_loop(builder, WORD(0), groups.strips) as strip:
                scale = _load(builder, factors, groups.head(1, strip))
                _sum_entries(groups, kind, groups.entries(strip, kind), groups.head(2, strip),
                             [(scale, out, False)], height)
        return write

    def twice(forward):
        def write(groups):
            scales = [_load(builder, factors, groups.head(PRODUCTS + k)) for k in range(PRODUCTS)]
            given = [(scales[k], out, False) for k, out in enumerate(forward)]
            across = scales[-1], forward[-1], True
            with short_loop(builder, WORD(0), groups.strips) as strip:
                _sum_entries(groups, MIRRORED, groups.entries(strip, MIRRORED), groups.row(strip),
                             [*given, across], height)
        return write
    Groups(builder, matrices, VECTOR.count).each({
        NARROW: once(NARROW), WIDE: once(WIDE), MIRRORED: twice([of_x]),
        COUPLED: twice([of_x, of_y])})


def _sum_entries(groups, kind, own, row, given, height):
    """Add a strip to some matrices, times a factor, or its transpose."""
    builder = groups.builder
    with short_loop(builder, WORD(0), WORD(WIDTHS[kind])) as k:
        column, read = builder.add(groups.first, k), builder.mul(k, WORD(LANES))
        for lane in range(LANES):
            entry, at = _load(builder, own, _next(builder, read, lane)), _next(builder, row, lane)
            for scale, out, transposed in given:
                i, j = (column, at) if transposed else (at, column)
                place = builder.add(builder.mul(j, height), i)
                _store(builder, _fused(builder, _load(builder, out, place), entry, scale), out,
                       place)


# coordinates that determine the others


@in_lanes(coordinates.write_all_to_free)
def all_to_free(builder, *args):
    """Of `all_to_free`; numbers beyond the last are zeros, as strips read whole vectors.

    Axes of a body are often those of its frame: entries that are zero in all lanes are left out.
    """
    rows, (axes, order, moved), to = args[:3], args[3:6], args[6:9]
    bound, bound_free, free, end = args[9:]
    height = whole_vectors(builder, bound_free)
    length = builder.add(height, builder.sub(free, bound_free))
    own = [builder.gep(moved, [builder.mul(length, WORD(k))]) for k in range(len(rows))]
    with short_loop(builder, WORD(0), bound_free) as k:
        for place in own:
            _store(builder, _NOTHING, place, k)
    with short_loop(builder, WORD(0), bound) as column, \
            short_loop(builder, WORD(0), bound_free) as k:
        entry = _load(builder, axes, builder.add(builder.mul(column, height), k))
        is_entry = builder.bitcast(builder.fcmp_unordered("!=", entry, _NOTHING), _BITS)
        with builder.if_then(builder.icmp_unsigned("!=", is_entry, _BITS(0))):
            for given, place in zip(rows, own, strict=True):
                _store(builder, _fused(builder, _load(builder, place, k), entry,
                                       _load(builder, given, column)), place, k)
    for given, place in zip(rows, own, strict=True):
        with short_loop(builder, WORD(0), builder.sub(free, bound_free)) as mode:
            _store(builder, _load(builder, given, builder.add(bound, mode)), place,
                   builder.add(bound_free, mode))
    words = builder.bitcast(order, ir.DoubleType().as_pointer())
    with short_loop(builder, WORD(0), free) as k:
        at = builder.fptosi(builder.load(builder.gep(words, [
            builder.mul(k, WORD(VECTOR.count))])), WORD)
        for given, out in zip(own, to, strict=True):
            _store(builder, _load(builder, given, at), out, k)
    with short_loop(builder, free, whole_vectors(builder, end)) as k:
        for out in to:
            _store(builder, _NOTHING, out, k)


def _dot(builder, pairs, count):
    """Sum of the dot products of some pairs of vectors."""
    total, = _sums(builder, 1)
    builder.store(_NOTHING, total)
    with short_loop(builder, WORD(0), count) as k:
        for a, b in pairs:
            _add_to(builder, total, _load(builder, a, k), _load(builder, b, k))
    return builder.load(total)


@in_lanes(coordinates.write_follow)
def follow(builder, Zq, Zd, z, zd, zdd, free, slaved, height):
    """Of `follow`: a row of z is read to its free numbers alone, so those behind may be written."""
    half = ir.Constant(VECTOR, [0.5] * VECTOR.count)
    with short_loop(builder, WORD(0), slaved) as b:
        Zq_b, Zd_b = (builder.gep(row, [builder.mul(b, height)]) for row in (Zq, Zd))
        place = builder.add(free, b)
        _store(builder, builder.fmul(_dot(builder, [(Zq_b, z)], free), half), z, place)
        second = _dot(builder, [(Zq_b, zdd), (Zd_b, zd)], free)
        _store(builder, _dot(builder, [(Zq_b, zd)], free), zd, place)
        _store(builder, second, zdd, place)


@in_lanes(coordinates.write_follow_changes)
def follow_changes(builder, Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height):
    """Of `follow_changes`."""
    with short_loop(builder, WORD(0), slaved) as b:
        Zq_b, Zd_b, Za_b = (builder.gep(row, [builder.mul(b, height)]) for row in (Zq, Zd, Za))
        place = builder.add(free, b)
        rate = _dot(builder, [(Zq_b, dzd), (Zd_b, dz)], free)
        second = _dot(builder, [(Zq_b, dzdd), (Zd_b, dzd), (Zd_b, dzd), (Za_b, dz)], free)
        _store(builder, rate, dzd, place)
        _store(builder, second, dzdd, place)
