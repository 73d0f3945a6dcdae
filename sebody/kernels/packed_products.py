"""Products with the packed matrices of `sebody.kernels.packed`, and their sums."""

from numba.extending import intrinsic

from sebody.compiler.decorators import compiled
from sebody.kernels import packed_strips, packed_sums
from sebody.kernels.abi import padded
from sebody.kernels.dense import columns_times
from sebody.kernels.instructions import called


@compiled
def packed_room(count, rows, columns):
    """Numbers that a row of packed matrices takes, see `sebody.contract.counts.packed_size`."""
    width = padded(columns)
    return count * padded(rows) * (width + width // 4) + 5 * width + 40


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

    Of vectors whole strips are read, whose numbers beyond the columns only have to be finite.
    """
    return called(packed_strips.write_times, matrices, x, out, count)


@intrinsic
def add_packed_times(typingctx, matrices, x, out):
    """``out += A_k x`` of all matrices, one product after the other."""
    return called(packed_strips.write_more_times, matrices, x, out)


@intrinsic
def packed_times_both(typingctx, matrices, x, y, of_x, of_y, count):
    """``of_x = A_k x`` and ``of_y = A_k y``, in one pass through the matrices."""
    return called(packed_strips.write_times_both, matrices, x, y, of_x, of_y, count)


@intrinsic
def couplings_times(typingctx, matrices, x, y, out, count):
    """The products of `packed_couplings.pack_couplings`, `count` numbers in all."""
    return called(packed_strips.write_couplings, matrices, x, y, out, count)


@intrinsic
def add_packed(typingctx, matrices, factors, out, height):
    """``out += sum_k factors_k A_k``, in columns that are `height` numbers apart.

    Zeros are added to columns of `out` up to a multiple of `LANES`.
    """
    return called(packed_sums.write_sum, matrices, factors, out, height)


@intrinsic
def add_couplings(typingctx, matrices, factors, scales, of_x, of_y, products, size, height):
    """Sums of the matrices that multiply x, and of those that multiply y; see `add_packed`.

    Factors are those of the products, of `size` numbers each; `scales` has room for all of them.
    """
    return called(packed_sums.write_sum_of_couplings, matrices, factors, scales, of_x, of_y,
                  products, size, height)
