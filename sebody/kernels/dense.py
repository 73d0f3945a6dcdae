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


@intrinsic
def _add_columns_times(typingctx, A, x, out, rows, columns, height):
    """``out += A x`` of the first `rows` of some columns that are `height` numbers apart."""
    floats = types.CPointer(types.float64)

    def codegen(context, builder, sig, args):
        _multiply(builder, *args, True)
        return context.get_dummy_value()

    return types.void(floats, floats, floats, *[types.int64] * 3), codegen


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
        factor = _broadcast(builder, builder.load(builder.gep(x, [column])), vector)
        start = builder.gep(A, [builder.mul(column, height)])
        for total, place in zip(totals, places, strict=True):
            product = builder.fmul(_load(builder, start, place, vector), factor,
                                   flags=("contract",))
            builder.store(builder.fadd(builder.load(total), product, flags=("contract",)), total)

    for totals in sums:
        for total in totals:
            builder.store(ir.Constant(vector, [0.0] * LANES), total)
    if add:
        for total, place in zip(sums[0], places, strict=True):
            builder.store(_load(builder, out, place, vector), total)
    with cgutils.for_range_slice(builder, word(0), paired, word(_UNROLLED)) as (column, _):
        for k, totals in enumerate(sums):
            add_column(totals, builder.add(column, word(k)))
    with cgutils.for_range_slice(builder, paired, columns, word(1)) as (column, _):
        add_column(sums[0], column)
    for place, parts in zip(places, zip(*sums, strict=True), strict=True):
        result = builder.load(parts[0])
        for total in parts[1:]:
            result = builder.fadd(result, builder.load(total))
        _store(builder, result, out, place)


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
    columns = [_load(builder, A, word(LANES * k), vector) for k in range(LANES)]
    for j in range(LANES):
        total = _load(builder, C, word(LANES * j), vector)
        for k, column in enumerate(columns):
            number = builder.load(builder.gep(B, [word(LANES * j + k)]))
            product = builder.fmul(column, _broadcast(builder, number, vector),
                                   flags=("contract",))
            total = builder.fsub(total, product, flags=("contract",))
        _store(builder, total, C, word(LANES * j))
    return context.get_dummy_value()


@intrinsic
def subtract_block_times(typingctx, y, A, x):
    """``y -= A x`` of a square block of `LANES` rows, stored by columns."""
    floats = types.CPointer(types.float64)
    return types.void(floats, floats, floats), _subtract_block_times


def _subtract_block_times(context, builder, sig, args):
    y, A, x = args
    word, vector = ir.IntType(64), ir.VectorType(ir.DoubleType(), LANES)
    total = _load(builder, y, word(0), vector)
    for k in range(LANES):
        number = builder.load(builder.gep(x, [word(k)]))
        product = builder.fmul(_load(builder, A, word(LANES * k), vector),
                               _broadcast(builder, number, vector), flags=("contract",))
        total = builder.fsub(total, product, flags=("contract",))
    _store(builder, total, y, word(0))
    return context.get_dummy_value()


def _load(builder, pointer, first, vector):
    place = builder.bitcast(builder.gep(pointer, [first]), vector.as_pointer())
    value = builder.load(place)
    value.align = 8
    return value


def _store(builder, value, pointer, first):
    place = builder.bitcast(builder.gep(pointer, [first]), value.type.as_pointer())
    builder.store(value, place).align = 8


def _broadcast(builder, number, vector):
    undefined = ir.Constant(vector, ir.Undefined)
    lane = builder.insert_element(undefined, number, ir.IntType(32)(0))
    lanes = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(lane, undefined, lanes)


@compiled
def inverse_3(a, b, c, d, e, f, g, h, i):
    """Inverse of a 3x3 matrix, row by row, by cofactors."""
    A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
    r = 1.0 / (a * A + b * B + c * C)
    return (A * r, (c * h - b * i) * r, (b * f - c * e) * r,
            B * r, (a * i - c * g) * r, (c * d - a * f) * r,
            C * r, (b * g - a * h) * r, (a * e - b * d) * r)
