"""Small dense products the kernels and the loop call."""

from numba.extending import intrinsic

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.kernels.abi import at, padded
from sebody.kernels.instructions import (
    WORD,
    add_product,
    added_up,
    called,
    inlined,
    load_broadcast,
    load_vector,
    no_sum,
    short_loop,
    store_vector,
    sums_of_lanes,
    totals,
    whole_vectors,
)

_UNROLLED = 2       # sums over alternate columns: hides the latency of additions
_VECTORS = 4, 2, 1      # vectors of rows at a time: every factor serves for all of them
_FEW = 3        # the same of three products at once


@intrinsic
def columns_times(typingctx, A, x, out, rows, columns):
    """``out = A x`` of a matrix in padded columns; `out` is written to its padding.

    Written in vector operations, because LLVM does not vectorize the loop if sums stay in
    registers: without them this product takes a third of a kernel's time. Written wherever it is
    used, since sizes may be constants there.
    """
    return inlined(write_columns, A, x, out, rows, columns)


@intrinsic
def columns_times_all(typingctx, A, x, y, z, of_x, of_y, of_z, rows, columns):
    """`columns_times` of three vectors, for matrices of few rows.

    Every entry is read once, and no sum waits for its own last product.
    """
    return inlined(write_columns_of_all, A, x, y, z, of_x, of_y, of_z, rows, columns)


@intrinsic
def block_times(typingctx, A, x, out, rows, columns, height):
    """``out = A x`` of the first `rows` of some columns that are `height` numbers apart.

    Eight vectors of rows at a time, so that a factor is read once for all of them: tall matrices
    take half the time of `columns_times`.
    """
    return called(write_block, A, x, out, rows, columns, height)


@intrinsic
def add_blocks_times(typingctx, A, x, B, y, out, rows, columns, of_B, height):
    """``out += A x + B y``: see `add_block_times`."""
    return called(write_more_blocks, A, x, B, y, out, rows, columns, of_B, height)


@intrinsic
def add_block_times(typingctx, A, x, out, rows, columns, height):
    """``out += A x`` of the first `rows` of some columns that are `height` numbers apart."""
    return called(write_more_block, A, x, out, rows, columns, height)


@compiled
def arrow_times(A, x, out, n, filled):
    """``out = A x`` of a square matrix that is diagonal beyond its first `filled` rows and columns.

    Reduced matrices are such arrows if the internal modes are normal modes: with many modes most
    entries are zeros. Columns are padded; `filled` is n or a multiple of whole vectors. Not
    inlined: half a dozen copies would take a quarter of a kernel's compilation.
    """
    columns_times(A, x, out, n, filled)
    if filled < n:
        height = padded(n)
        _add_columns_times(at(A, filled * height), at(x, filled), out, filled, n - filled, height)
        for k in range(filled, n):
            out[k] += A[k * height + k] * x[k]


@intrinsic
def rows_times(typingctx, A, x, out, rows, columns, height):
    """``out_k = a_k . x`` with columns a_k that are `height` numbers apart.

    Vectors are read to their padding, where those of A are zero and `x` is finite.
    """
    return called(write_dots, A, x, out, rows, columns, height)


@intrinsic
def add_rows_times(typingctx, A, x, out, rows, columns, height):
    """``out_k += a_k . x``; see `rows_times`."""
    return called(write_more_dots, A, x, out, rows, columns, height)


@intrinsic
def _add_columns_times(typingctx, A, x, out, rows, columns, height):
    return called(write_more_columns, A, x, out, rows, columns, height)


def _dot(builder, A, x, out, rows, columns, height, add):
    """Vector operations for products of columns with a vector, some columns at a time."""
    last, done = whole_vectors(builder, rows), WORD(0)
    for count in (LANES, 1):
        sums = totals(builder, count)
        end = builder.sub(columns, builder.srem(builder.sub(columns, done), WORD(count)))
        with short_loop(builder, done, end, count) as column:
            for total in sums:
                builder.store(no_sum(), total)
            firsts = [builder.mul(builder.add(column, WORD(k)), height) for k in range(count)]
            with short_loop(builder, WORD(0), last, LANES) as row:
                factor = load_vector(builder, x, row)
                for first, total in zip(firsts, sums, strict=True):
                    add_product(builder, total, load_vector(builder, A, builder.add(first, row)),
                                factor)
            parts = [builder.load(total) for total in sums]
            if count == LANES:
                result = sums_of_lanes(builder, parts)
                if add:
                    result = builder.fadd(load_vector(builder, out, column), result)
                store_vector(builder, result, out, column)
            else:
                place = builder.gep(out, [column])
                result = added_up(builder, parts[0])
                builder.store(builder.fadd(builder.load(place), result) if add else result, place)
        done = end


def write_dots(builder, A, x, out, rows, columns, height):
    _dot(builder, A, x, out, rows, columns, height, False)


def write_more_dots(builder, A, x, out, rows, columns, height):
    _dot(builder, A, x, out, rows, columns, height, True)


def _wide(builder, given, out, rows, height, add):
    """Vector operations for ``out = A x``, or ``out += A x``, some vectors of rows at a time.

    Of some matrices, vectors and numbers of columns.
    """
    last, done = whole_vectors(builder, rows), WORD(0)
    for count in (8, 4, 3, 2, 1):
        rest = builder.srem(builder.sub(last, done), WORD(count * LANES))
        end = builder.sub(last, rest)
        with short_loop(builder, done, end, count * LANES) as row:
            places = [builder.add(row, WORD(k * LANES)) for k in range(count)]
            sums = _sums_of_rows(builder, given, out, places, height, add)
            for place, total in zip(places, sums, strict=True):
                store_vector(builder, total, out, place)
        done = end


def _sums_of_rows(builder, given, out, places, height, add):
    """The sums of some vectors of rows; every matrix has its own if they are few.

    A sum of many products waits for each of them.
    """
    own = len(places) <= 4
    sums = [totals(builder, len(places)) for _ in (given if own else given[:1])]
    for kept in sums:
        for place, total in zip(places, kept, strict=True):
            begin = add and kept is sums[0]
            builder.store(load_vector(builder, out, place) if begin else no_sum(), total)
    for k, (A, x, columns) in enumerate(given):
        with short_loop(builder, WORD(0), columns) as column:
            factor = load_broadcast(builder, x, column)
            begin = builder.gep(A, [builder.mul(column, height)])
            for place, total in zip(places, sums[k * own], strict=True):
                add_product(builder, total, load_vector(builder, begin, place), factor)
    return [_added(builder, parts) for parts in zip(*sums, strict=True)]


def write_block(builder, A, x, out, rows, columns, height):
    _wide(builder, [(A, x, columns)], out, rows, height, False)


def write_more_block(builder, A, x, out, rows, columns, height):
    _wide(builder, [(A, x, columns)], out, rows, height, True)


def write_more_blocks(builder, A, x, B, y, out, rows, columns, of_B, height):
    _wide(builder, [(A, x, columns), (B, y, of_B)], out, rows, height, True)


def write_more_columns(builder, A, x, out, rows, columns, height):
    _multiply(builder, A, x, out, rows, columns, height, True)


def write_columns(builder, A, x, out, rows, columns):
    """Instructions of `columns_times`."""
    _multiply(builder, A, x, out, rows, columns, whole_vectors(builder, rows), False)


def write_columns_of_all(builder, A, x, y, z, of_x, of_y, of_z, rows, columns):
    """Instructions of `columns_times_all`."""
    first, last = WORD(0), whole_vectors(builder, rows)
    for vectors in (_FEW, 1):
        end = builder.sub(last, builder.srem(builder.sub(last, first), WORD(LANES * vectors)))
        with short_loop(builder, first, end, LANES * vectors) as row:
            places = [builder.add(row, WORD(LANES * k)) for k in range(vectors)]
            sums = [totals(builder, vectors) for _ in range(3)]
            for total in (total for kept in sums for total in kept):
                builder.store(no_sum(), total)
            with short_loop(builder, WORD(0), columns) as column:
                start = builder.gep(A, [builder.mul(column, last)])
                entries = [load_vector(builder, start, place) for place in places]
                for given, kept in zip((x, y, z), sums, strict=True):
                    factor = load_broadcast(builder, given, column)
                    for total, entry in zip(kept, entries, strict=True):
                        add_product(builder, total, entry, factor)
            for out, kept in zip((of_x, of_y, of_z), sums, strict=True):
                for place, total in zip(places, kept, strict=True):
                    store_vector(builder, builder.load(total), out, place)
        first = end


def _multiply(builder, A, x, out, rows, columns, height, add):
    """Vector operations for ``out = A x``, or ``out += A x``."""
    first, last = WORD(0), whole_vectors(builder, rows)
    for vectors in _VECTORS:
        whole = builder.and_(last, WORD(-LANES * vectors))
        with short_loop(builder, first, whole, LANES * vectors) as row:
            _multiply_rows(builder, A, x, out, row, vectors, columns, height, add)
        first = whole


def _multiply_rows(builder, A, x, out, row, vectors, columns, height, add):
    """The same for a few vectors of rows, whose sums stay in registers."""
    places = [builder.add(row, WORD(LANES * k)) for k in range(vectors)]
    sums = [totals(builder, vectors) for _ in range(_UNROLLED)]
    paired = builder.sub(columns, builder.srem(columns, WORD(_UNROLLED)))

    def add_column(kept, column):
        factor = load_broadcast(builder, x, column)
        start = builder.gep(A, [builder.mul(column, height)])
        for total, place in zip(kept, places, strict=True):
            add_product(builder, total, load_vector(builder, start, place), factor)

    for kept in sums:
        for total in kept:
            builder.store(no_sum(), total)
    if add:
        for total, place in zip(sums[0], places, strict=True):
            builder.store(load_vector(builder, out, place), total)
    with short_loop(builder, WORD(0), paired, _UNROLLED) as column:
        for k, kept in enumerate(sums):
            add_column(kept, builder.add(column, WORD(k)))
    with short_loop(builder, paired, columns) as column:
        add_column(sums[0], column)
    for place, parts in zip(places, zip(*sums, strict=True), strict=True):
        store_vector(builder, _added(builder, parts), out, place)


def _added(builder, parts):
    """Sum of the vectors at some places."""
    result = builder.load(parts[0])
    for total in parts[1:]:
        result = builder.fadd(result, builder.load(total))
    return result


@compiled
def clear(row, count):
    """Zeros in place of numbers."""
    for k in range(count):
        row[k] = 0.0


@compiled
def scale(row, factor, count):
    """Numbers times a factor."""
    for k in range(count):
        row[k] *= factor


@compiled
def inverse_3(a, b, c, d, e, f, g, h, i):
    """Inverse of a 3x3 matrix, row by row, by cofactors."""
    A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
    r = 1.0 / (a * A + b * B + c * C)
    return (A * r, (c * h - b * i) * r, (b * f - c * e) * r,
            B * r, (a * i - c * g) * r, (c * d - a * f) * r,
            C * r, (b * g - a * h) * r, (a * e - b * d) * r)
