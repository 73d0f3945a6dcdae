"""Small dense products the kernels and the loop call."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from sebody.kernels.abi import at, padded
from sebody.kernels.layout import LANES
from sebody.kernels.pipeline import compiled

_UNROLLED = 2       # sums over alternate columns: hides the latency of additions
_VECTORS = 4, 2, 1      # vectors of rows at a time: every factor serves for all of them


@intrinsic
def columns_times(typingctx, A, x, out, rows, columns):
    """``out = A x`` of a matrix in padded columns; `out` is written to its padding.

    Written in vector operations, because LLVM does not vectorize the loop if sums stay in
    registers: without them this product takes a third of a kernel's time.
    """
    floats = types.CPointer(types.float64)

    def codegen(context, builder, sig, args):
        _multiply(builder, *args, _whole_vectors(builder, args[3]), False)
        return context.get_dummy_value()

    return types.void(floats, floats, floats, types.int64, types.int64), codegen


@compiled
def block_times(A, x, out, rows, columns, height):
    """``out = A x`` of the first `rows` of some columns that are `height` numbers apart.

    Eight vectors of rows at a time, so that a factor is read once for all of them: tall matrices
    take half the time of `columns_times`.
    """
    _block(A, x, out, rows, columns, height)


@compiled
def add_block_times(A, x, out, rows, columns, height):
    """``out += A x`` of the first `rows` of some columns that are `height` numbers apart."""
    _add_block(A, x, out, rows, columns, height)


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


@compiled
def rows_times(A, x, out, rows, columns, height):
    """``out_k = a_k . x`` with columns a_k that are `height` numbers apart.

    Vectors are read to their padding, where those of A are zero and `x` is finite.
    """
    _dots(A, x, out, rows, columns, height)


@compiled
def add_rows_times(A, x, out, rows, columns, height):
    """``out_k += a_k . x``; see `rows_times`."""
    _add_dots(A, x, out, rows, columns, height)


def _dot(builder, A, x, out, rows, columns, height, add):
    """Vector operations for products of columns with a vector, some columns at a time."""
    word, vector = ir.IntType(64), ir.VectorType(ir.DoubleType(), LANES)
    last = _whole_vectors(builder, rows)
    done = word(0)
    for count in (4, 1):
        totals = [cgutils.alloca_once(builder, vector) for _ in range(count)]
        end = builder.sub(columns, builder.srem(builder.sub(columns, done), word(count)))
        with cgutils.for_range_slice(builder, done, end, word(count)) as (column, _):
            for total in totals:
                builder.store(ir.Constant(vector, [0.0] * LANES), total)
            with cgutils.for_range_slice(builder, word(0), last, word(LANES)) as (row, _):
                factor = load_vector(builder, x, row, vector)
                for k, total in enumerate(totals):
                    place = builder.mul(builder.add(column, word(k)), height)
                    entries = load_vector(builder, A, builder.add(place, row), vector)
                    product = builder.fmul(entries, factor, flags=("contract",))
                    builder.store(builder.fadd(builder.load(total), product,
                                               flags=("contract",)), total)
            for k, total in enumerate(totals):
                result = _added_up(builder, builder.load(total))
                place = builder.gep(out, [builder.add(column, word(k))])
                builder.store(builder.fadd(builder.load(place), result) if add else result, place)
        done = end


def _added_up(builder, numbers):
    """Sum of the lanes of a vector."""
    parts = [builder.extract_element(numbers, ir.IntType(32)(lane)) for lane in range(LANES)]
    while len(parts) > 1:
        parts = [builder.fadd(a, b) for a, b in zip(parts[::2], parts[1::2], strict=True)]
    return parts[0]


def _multiply_wide(builder, A, x, out, rows, columns, height, add):
    """Vector operations for ``out = A x``, or ``out += A x``, some vectors of rows at a time."""
    word, vector = ir.IntType(64), ir.VectorType(ir.DoubleType(), LANES)
    last = _whole_vectors(builder, rows)
    done = word(0)
    for count in (8, 4, 2, 1):
        totals = [cgutils.alloca_once(builder, vector) for _ in range(count)]
        rest = builder.srem(builder.sub(last, done), word(count * LANES))
        end = builder.sub(last, rest)
        with cgutils.for_range_slice(builder, done, end, word(count * LANES)) as (row, _):
            places = [builder.add(row, word(k * LANES)) for k in range(count)]
            for place, total in zip(places, totals, strict=True):
                builder.store(load_vector(builder, out, place, vector) if add else
                              ir.Constant(vector, [0.0] * LANES), total)
            with cgutils.for_range_slice(builder, word(0), columns, word(1)) as (column, _):
                factor = broadcast(builder, builder.load(builder.gep(x, [column])), vector)
                first = builder.mul(column, height)
                for place, total in zip(places, totals, strict=True):
                    entries = load_vector(builder, A, builder.add(first, place), vector)
                    product = builder.fmul(entries, factor, flags=("contract",))
                    builder.store(builder.fadd(builder.load(total), product,
                                               flags=("contract",)), total)
            for place, total in zip(places, totals, strict=True):
                store_vector(builder, builder.load(total), out, place)
        done = end


def _multiply(builder, A, x, out, rows, columns, height, add):
    """Vector operations for ``out = A x``, or ``out += A x``."""
    word = ir.IntType(64)
    first, last = word(0), _whole_vectors(builder, rows)
    for vectors in _VECTORS:
        whole = builder.and_(last, word(-LANES * vectors))
        with cgutils.for_range_slice(builder, first, whole, word(LANES * vectors)) as (row, _):
            _multiply_rows(builder, A, x, out, row, vectors, columns, height, add)
        first = whole


def _multiply_rows(builder, A, x, out, row, vectors, columns, height, add):
    """The same for a few vectors of rows, whose sums stay in registers."""
    word = ir.IntType(64)
    vector = ir.VectorType(ir.DoubleType(), LANES)
    places = [builder.add(row, word(LANES * k)) for k in range(vectors)]
    sums = [[cgutils.alloca_once(builder, vector) for _ in places] for _ in range(_UNROLLED)]
    paired = builder.sub(columns, builder.srem(columns, word(_UNROLLED)))

    def add_column(totals, column):
        factor = broadcast(builder, builder.load(builder.gep(x, [column])), vector)
        start = builder.gep(A, [builder.mul(column, height)])
        for total, place in zip(totals, places, strict=True):
            product = builder.fmul(load_vector(builder, start, place, vector), factor,
                                   flags=("contract",))
            builder.store(builder.fadd(builder.load(total), product, flags=("contract",)), total)

    for totals in sums:
        for total in totals:
            builder.store(ir.Constant(vector, [0.0] * LANES), total)
    if add:
        for total, place in zip(sums[0], places, strict=True):
            builder.store(load_vector(builder, out, place, vector), total)
    with cgutils.for_range_slice(builder, word(0), paired, word(_UNROLLED)) as (column, _):
        for k, totals in enumerate(sums):
            add_column(totals, builder.add(column, word(k)))
    with cgutils.for_range_slice(builder, paired, columns, word(1)) as (column, _):
        add_column(sums[0], column)
    for place, parts in zip(places, zip(*sums, strict=True), strict=True):
        result = builder.load(parts[0])
        for total in parts[1:]:
            result = builder.fadd(result, builder.load(total))
        store_vector(builder, result, out, place)


def _whole_vectors(builder, rows):
    """Rows rounded up to whole vectors."""
    word = ir.IntType(64)
    return builder.and_(builder.add(rows, word(LANES - 1)), word(-LANES))


@intrinsic
def subtract_product(typingctx, C, A, B):
    """``C -= A B`` of square blocks of `LANES` rows, stored by columns."""
    floats = types.CPointer(types.float64)
    return types.void(floats, floats, floats), _subtract_product


def _subtract_product(context, builder, sig, args):
    C, A, B = args
    word, vector = ir.IntType(64), ir.VectorType(ir.DoubleType(), LANES)
    columns = [load_vector(builder, A, word(LANES * k), vector) for k in range(LANES)]
    for j in range(LANES):
        total = load_vector(builder, C, word(LANES * j), vector)
        for k, column in enumerate(columns):
            number = builder.load(builder.gep(B, [word(LANES * j + k)]))
            product = builder.fmul(column, broadcast(builder, number, vector),
                                   flags=("contract",))
            total = builder.fsub(total, product, flags=("contract",))
        store_vector(builder, total, C, word(LANES * j))
    return context.get_dummy_value()


@intrinsic
def subtract_block_times(typingctx, y, A, x):
    """``y -= A x`` of a square block of `LANES` rows, stored by columns."""
    floats = types.CPointer(types.float64)
    return types.void(floats, floats, floats), _subtract_block_times


def _subtract_block_times(context, builder, sig, args):
    y, A, x = args
    word, vector = ir.IntType(64), ir.VectorType(ir.DoubleType(), LANES)
    total = load_vector(builder, y, word(0), vector)
    for k in range(LANES):
        number = builder.load(builder.gep(x, [word(k)]))
        product = builder.fmul(load_vector(builder, A, word(LANES * k), vector),
                               broadcast(builder, number, vector), flags=("contract",))
        total = builder.fsub(total, product, flags=("contract",))
    store_vector(builder, total, y, word(0))
    return context.get_dummy_value()


def load_vector(builder, pointer, first, vector):
    """Instructions that read `LANES` numbers of a pointer from the place `first` on."""
    place = builder.bitcast(builder.gep(pointer, [first]), vector.as_pointer())
    value = builder.load(place)
    value.align = 8
    return value


def store_vector(builder, value, pointer, first):
    """Instructions that write a vector to a pointer from the place `first` on."""
    place = builder.bitcast(builder.gep(pointer, [first]), value.type.as_pointer())
    builder.store(value, place).align = 8


def broadcast(builder, number, vector):
    """Instructions that set every number of a vector to one value."""
    undefined = ir.Constant(vector, ir.Undefined)
    lane = builder.insert_element(undefined, number, ir.IntType(32)(0))
    lanes = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(lane, undefined, lanes)


def _product(write, add):
    """The operation with a block that `write` writes in vector operations."""
    @intrinsic
    def product(typingctx, A, x, out, rows, columns, height):
        floats = types.CPointer(types.float64)

        def codegen(context, builder, sig, args):
            write(builder, *args, add)
            return context.get_dummy_value()

        return types.void(floats, floats, floats, *[types.int64] * 3), codegen
    return product


_block, _add_block = (_product(_multiply_wide, add) for add in (False, True))
_dots, _add_dots = (_product(_dot, add) for add in (False, True))
_add_columns_times = _product(_multiply, True)


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
