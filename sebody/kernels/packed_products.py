"""Products with the packed matrices of `sebody.kernels.packed`, and their sums."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from sebody.kernels.abi import at, padded
from sebody.kernels.dense import broadcast, clear, columns_times, load_vector, store_vector
from sebody.kernels.layout import LANES
from sebody.kernels.packed import GROUP, GROUPS, HEAD
from sebody.kernels.pipeline import compiled

_FLOATS, _VECTOR = types.CPointer(types.float64), ir.VectorType(ir.DoubleType(), LANES)


@compiled
def packed_room(count, rows, columns):
    """Numbers that a row of packed matrices takes, see `sebody.kernels.layout.packed_size`."""
    return count * padded(rows) * (columns + 2) + 4


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


@compiled
def packed_times(matrices, x, out, count):
    """``out = A_k x`` of all matrices, one product after the other, `count` numbers in all."""
    clear(out, count)
    add_packed_times(matrices, x, out)


@compiled
def add_packed_times(matrices, x, out):
    """``out += A_k x`` of all matrices, one product after the other."""
    for g in range(_whole(matrices, 0)):
        group = at(matrices, 1 + GROUP * g)
        _strips_times(at(matrices, _whole(group, 4)), at(x, _whole(group, 0)), _whole(group, 1),
                      at(matrices, _whole(group, 3)), out, _whole(group, 2))


@compiled
def add_packed(matrices, factors, out, height):
    """``out += sum_k factors_k A_k``, in columns that are `height` numbers apart."""
    for g in range(_whole(matrices, 0)):
        group = at(matrices, 1 + GROUP * g)
        first, columns, strips = _whole(group, 0), _whole(group, 1), _whole(group, 2)
        entries = at(matrices, _whole(group, 4))
        for strip in range(strips):
            head = at(matrices, _whole(group, 3) + HEAD * strip)
            _add_strip(at(entries, LANES * strip), LANES * strips, columns,
                       factors[_whole(head, 1)], at(out, first * height + _whole(head, 2)), height)


@intrinsic
def _whole(typingctx, row, k):
    """A whole number among the bits of floats."""
    def codegen(context, builder, sig, args):
        words = builder.bitcast(args[0], ir.IntType(64).as_pointer())
        return builder.load(builder.gep(words, [args[1]]))

    return types.int64(_FLOATS, types.int64), codegen


@intrinsic
def _strips_times(typingctx, entries, x, columns, heads, out, strips):
    """Add the products of some strips that share their columns."""
    def codegen(context, builder, sig, args):
        *given, strips = args
        for count in GROUPS:
            with builder.if_then(builder.icmp_signed("==", strips, strips.type(count))):
                _add_products(builder, *given, count)
        return context.get_dummy_value()

    return types.void(_FLOATS, _FLOATS, types.int64, _FLOATS, _FLOATS, types.int64), codegen


def _add_products(builder, entries, x, columns, heads, out, count):
    """The same of a number of strips, whose sums stay in registers."""
    word = ir.IntType(64)
    words = builder.bitcast(heads, word.as_pointer())
    totals = [cgutils.alloca_once(builder, _VECTOR) for _ in range(count)]
    places = [builder.load(builder.gep(words, [word(HEAD * k)])) for k in range(count)]
    for total, place in zip(totals, places, strict=True):
        builder.store(load_vector(builder, out, place, _VECTOR), total)
    with cgutils.for_range_slice(builder, word(0), columns, word(1)) as (column, _):
        factor = broadcast(builder, builder.load(builder.gep(x, [column])), _VECTOR)
        own = builder.gep(entries, [builder.mul(column, word(LANES * count))])
        for k, total in enumerate(totals):
            product = builder.fmul(load_vector(builder, own, word(LANES * k), _VECTOR), factor,
                                   flags=("contract",))
            builder.store(builder.fadd(builder.load(total), product, flags=("contract",)), total)
    for total, place in zip(totals, places, strict=True):
        store_vector(builder, builder.load(total), out, place)


@intrinsic
def _add_strip(typingctx, entries, stride, columns, factor, out, height):
    """Add a strip times a factor."""
    def codegen(context, builder, sig, args):
        entries, stride, columns, factor, out, height = args
        word = ir.IntType(64)
        scale = broadcast(builder, factor, _VECTOR)
        with cgutils.for_range_slice(builder, word(0), columns, word(1)) as (column, _):
            to = builder.mul(column, height)
            product = builder.fmul(
                load_vector(builder, entries, builder.mul(column, stride), _VECTOR), scale,
                flags=("contract",))
            store_vector(builder, builder.fadd(load_vector(builder, out, to, _VECTOR), product,
                                               flags=("contract",)), out, to)
        return context.get_dummy_value()

    return types.void(_FLOATS, types.int64, types.int64, types.float64, _FLOATS,
                      types.int64), codegen
