"""Packed matrices: their zeros, products with them, sums of them."""

import numpy as np
import pytest

from sebody.compiler.decorators import compiled
from sebody.contract.counts import packed_size, whole_vectors
from sebody.kernels.abi import pointer_to
from sebody.kernels.packed import pack, pack_couplings, strips, unpack
from sebody.kernels.packed_products import (
    add_couplings,
    add_packed,
    add_packed_times,
    couplings_times,
    from_free,
    packed_room,
    packed_times,
    packed_times_both,
    to_free,
)


@compiled
def times(row, x, out, count, add):
    if add:
        add_packed_times(pointer_to(row), pointer_to(x), pointer_to(out))
    else:
        packed_times(pointer_to(row), pointer_to(x), pointer_to(out), count)


@compiled
def summed(row, factors, out, height):
    add_packed(pointer_to(row), pointer_to(factors), pointer_to(out), height)


@compiled
def of_two(row, couplings, x, y, of_x, of_y, out, count, size, factors, sum_x, sum_y, height):
    packed_times_both(pointer_to(row), pointer_to(x), pointer_to(y), pointer_to(of_x),
                      pointer_to(of_y), count)
    couplings_times(pointer_to(couplings), pointer_to(x), pointer_to(y), pointer_to(out), size)
    add_couplings(pointer_to(couplings), pointer_to(factors), pointer_to(sum_x),
                  pointer_to(sum_y), height)


@compiled
def there_and_back(y, axes, back, order, z, forces, bound_free, end):
    moved = np.empty(32)
    to_free(pointer_to(y), pointer_to(axes), pointer_to(order), pointer_to(moved), pointer_to(z),
            y.size - order.size + bound_free, bound_free, order.size, end)
    from_free(pointer_to(z), pointer_to(back), pointer_to(order), pointer_to(moved),
              pointer_to(forces), y.size - order.size + bound_free, bound_free, order.size)


def stack(shape, filled, seed=0):
    """Matrices with a part of their entries, in blocks and alone."""
    random = np.random.default_rng(seed)
    count, rows, columns = shape
    matrices = random.normal(size=shape) * (random.uniform(size=shape) < filled)
    matrices[:, :rows // 2, columns // 2:] = 0.0
    return matrices


SHAPES = [(0, 5, 5), (1, 1, 1), (3, 4, 9), (2, 13, 13), (9, 18, 18), (5, 61, 61)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("filled", [0.0, 0.1, 1.0])
def test_packed_and_unpacked(shape, filled):
    matrices = stack(shape, filled)
    row = pack(matrices, shape)
    assert np.array_equal(unpack(row, shape), matrices)
    assert len(row) == packed_size(*shape) == packed_room.py_func(*shape)


def test_no_matrices_at_all():
    """Of a body without stiffening: symmetric matrices of second order, none of them."""
    assert len(pack(np.zeros((0, 6, 6)), (0, 6, 6), symmetric=True)) == packed_size(0, 6, 6)


def test_matrices_whose_strips_would_not_fit_are_packed_with_zeros():
    """A run for every other entry would need more whole numbers than there are zeros."""
    A = np.zeros((4, 4, 41))
    A[np.arange(4), 0, :] = np.arange(41) % 5 == 0
    assert np.array_equal(unpack(pack(A, A.shape), A.shape), A)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("filled", [0.1, 1.0])
def test_products_and_sums(shape, filled):
    count, rows, columns = shape
    matrices, height = stack(shape, filled, 1), whole_vectors(rows)
    row, random = pack(matrices, shape), np.random.default_rng(2)
    x, factors = np.ones(whole_vectors(columns)), random.normal(size=count)
    x[:columns] = random.normal(size=columns)
    size = count * height
    before = np.r_[random.normal(size=size), 7.0]
    for add in (False, True):
        out = before.copy()
        times(row, x, out, size, add)
        found = (out[:size] - add * before[:size]).reshape(count, height)
        # sums of up to 61 products of numbers of size one
        assert np.abs(found[:, :rows] - matrices @ x[:columns]).max(initial=0.0) < 1e-13
        assert out[size] == 7.0
    deep = height + 8
    sums = np.zeros((whole_vectors(columns), deep))
    summed(row, factors, sums.ravel(), deep)
    expected = np.einsum("k,kij->ij", factors, matrices)
    assert np.abs(sums[:columns, :rows].T - expected).max() < 1e-13
    assert not sums[:, height:].any()


@pytest.mark.parametrize("N, filled, zeros, many", [
    (5, 1.0, 0, False), (18, 0.3, 0, True), (42, 0.05, 0, True), (61, 0.9, 0, True),
    (42, 0.9, 3, True), (35, 1.0, 6, True)])
def test_symmetric_matrices_and_couplings(N, filled, zeros, many):
    """Of large matrices strips are used twice; of small ones, and where few have entries, once."""
    random = np.random.default_rng(N)
    S, C = stack((3, N, N), filled, 3), stack((2, N, N), filled, 4)
    S += S.transpose(0, 2, 1)
    for matrices in (S, C):
        matrices[:, :zeros] = matrices[:, :, :zeros] = 0.0
    row, couplings = pack(S, S.shape, symmetric=True), pack_couplings(S, C)
    every = np.concatenate([S, C, C, C.transpose(0, 2, 1)])
    for packed, stored in ((row, S), (couplings, every)):
        assert len(packed) == packed_size(*stored.shape)
        assert np.array_equal(unpack(packed, stored.shape), stored)
    uses = {(len(strip.uses), strip.uses[-1].transposed) for strip in strips(couplings)}
    assert ({(2, True), (3, True)} <= uses) == many
    height, width = whole_vectors(N), whole_vectors(N) + 4
    x, y = random.normal(size=(2, width))
    of_x, of_y, out = np.full((3, len(every), height), np.nan)
    factors, sums = random.normal(size=len(every)), np.zeros((2, width, height))
    of_two(row, couplings, x, y, of_x.ravel(), of_y.ravel(), out.ravel(), len(S) * height,
           len(every) * height, factors, sums[0].ravel(), sums[1].ravel(), height)
    first, bound = len(S) + len(C), 1e-13 * N   # sums of N products of numbers of size one
    expected = [*every[:first] @ x[:N], *every[first:] @ y[:N]]
    np.testing.assert_allclose(of_x[:3, :N], S @ x[:N], atol=bound, rtol=0)
    np.testing.assert_allclose(of_y[:3, :N], S @ y[:N], atol=bound, rtol=0)
    np.testing.assert_allclose(out[:, :N], expected, atol=bound, rtol=0)
    for found, of in zip(sums, (slice(None, first), slice(first, None)), strict=True):
        expected = np.einsum("k,kij->ji", factors[of], every[of])
        np.testing.assert_allclose(found[:N, :N], expected, atol=bound, rtol=0)


def test_blocks_anywhere():
    """Blocks of matrices begin at any row and column: hardly a zero is packed beside them."""
    N, blocks = 27, [(3, 11), (11, 15), (15, 22), (22, 26)]
    C = np.zeros((3, N, N))
    for k, pairs in enumerate(([(0, 1), (1, 0)], [(2, 3)], [(1, 1), (3, 0)])):
        for i, j in pairs:
            C[k, slice(*blocks[i]), slice(*blocks[j])] = 1.0 + k
    S = C + C.transpose(0, 2, 1)
    every = np.concatenate([S, C, C, C.transpose(0, 2, 1)])
    couplings = pack_couplings(S, C)
    assert np.array_equal(unpack(couplings, every.shape), every)
    taken = list(strips(couplings))
    assert {len(strip.uses) for strip in taken} == {1, 2}       # C multiplies both vectors
    packed = sum(strip.entries.size for strip in taken)     # C is packed once for both vectors
    assert packed < 1.1 * (np.count_nonzero(every) - np.count_nonzero(C))
    x, y, out = np.ones(32), np.full(32, 2.0), np.full((len(every), 28), np.nan)
    sums = np.zeros((2, 32, 28))
    of_two(pack(S, S.shape), couplings, x, y, np.zeros(84), np.zeros(84), out.ravel(), 84,
           out.size, np.ones(len(every)), sums[0].ravel(), sums[1].ravel(), 28)
    first = len(S) + len(C)
    expected = [*every[:first] @ x[:N], *every[first:] @ y[:N]]
    np.testing.assert_allclose(out[:, :N], expected, atol=1e-13, rtol=0)
    for found, of in zip(sums, (every[:first], every[first:]), strict=True):
        np.testing.assert_allclose(found[:N, :N].T, of.sum(axis=0), atol=1e-13, rtol=0)


def test_coordinates_that_determine_the_others():
    """Three of five boundary coordinates and two modes; the way back is the transpose."""
    random = np.random.default_rng(3)
    A, order, y = random.normal(size=(3, 5)), np.array([3, 0, 4, 2, 1]), random.normal(size=7)
    columns, back = np.zeros((5, 4)), np.zeros((3, 8))
    columns[:, :3], back[:, :5] = A.T, A
    z, forces = np.full(9, 5.0), np.zeros(12)
    there_and_back(y, columns.ravel(), back.ravel(), order.astype(float), z, forces, 3, 8)
    whole = np.zeros((5, 7))
    whole[:3, :5], whole[3:, 5:] = A, np.eye(2)
    whole = whole[order]
    assert np.allclose(z[:5], whole @ y, rtol=1e-14)
    assert z[5:].tolist() == [0.0, 0.0, 0.0, 5.0]
    assert np.allclose(forces[:7], whole.T @ z[:5], rtol=1e-14)
