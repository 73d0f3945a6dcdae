"""Packed matrices: their zeros, products with them, sums of them."""

import numpy as np
import pytest

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES, packed_size, whole_vectors
from sebody.kernels.abi import pointer_to
from sebody.kernels.packed import diagonals_of, multiples, pack, strips, unpack
from sebody.kernels.packed_couplings import pack_couplings
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
def of_couplings(couplings, x, y, out, factors, scales, sum_x, sum_y, products, size, height):
    couplings_times(pointer_to(couplings), pointer_to(x), pointer_to(y), pointer_to(out),
                    products * size)
    add_couplings(pointer_to(couplings), pointer_to(factors), pointer_to(scales),
                  pointer_to(sum_x), pointer_to(sum_y), products, size, height)


@compiled
def of_both(row, x, y, of_x, of_y, count):
    packed_times_both(pointer_to(row), pointer_to(x), pointer_to(y), pointer_to(of_x),
                      pointer_to(of_y), count)


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


def test_no_symmetric_matrices():
    """Bodies without slaved coordinates have none."""
    none = np.zeros((0, 9, 9))
    assert unpack(pack(none, none.shape, symmetric=True), none.shape).shape == none.shape


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


@pytest.mark.parametrize("N, apart", [(9, False), (22, True), (61, True)])
@pytest.mark.parametrize("symmetric", [False, True])
def test_diagonals(N, apart, symmetric):
    """As of normal modes behind two boundary coordinates; the first matrix is full.

    Strips hold them where there are few; else nothing but the coordinates' rows and columns.
    """
    random, height = np.random.default_rng(N), whole_vectors(N)
    matrices = random.normal(size=(2, N, N))
    matrices += matrices.transpose(0, 2, 1)
    matrices[1, 2:, 2:] = np.diag(random.normal(size=N - 2))
    row = pack(matrices, matrices.shape, symmetric)
    assert np.array_equal(unpack(row, matrices.shape), matrices)
    found = list(diagonals_of(row))
    assert [(one.matrix, one.place) for one in found] == [(1, height)] * apart
    if apart:
        assert np.array_equal(found[0].numbers[:N], np.diag(matrices[1]))
        assert not any(use.matrix == 1 and strip.row >= LANES and use.place >= height + LANES
                       and strip.first >= LANES for strip in strips(row) for use in strip.uses)
    x, y, of_x, of_y = random.normal(size=(4, 2 * height))
    of_both(row, x, y, of_x, of_y, 2 * height)
    for given, out in ((x, of_x), (y, of_y)):
        assert np.abs(out.reshape(2, -1)[:, :N] - matrices @ given[:N]).max() < 1e-13 * N
    sums, factors = np.zeros((height, height)), random.normal(size=2)
    summed(row, factors, sums.ravel(), height)
    assert np.abs(sums[:N, :N].T - np.tensordot(factors, matrices, 1)).max() < 1e-13


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
    check_couplings(couplings, every, len(S), len(C), 1e-13 * N)  # sums of N products of size one
    width, height = whole_vectors(N) + 4, whole_vectors(N)
    x, y = random.normal(size=(2, width))
    of_x, of_y = np.full((2, len(S), height), np.nan)
    of_both(row, x, y, of_x.ravel(), of_y.ravel(), len(S) * height)
    np.testing.assert_allclose(of_x[:, :N], S @ x[:N], atol=1e-13 * N, rtol=0)
    np.testing.assert_allclose(of_y[:, :N], S @ y[:N], atol=1e-13 * N, rtol=0)


def check_couplings(couplings, every, squares, count, bound):
    """Products of a row, and the sums of its matrices."""
    random, N = np.random.default_rng(len(couplings)), every.shape[-1]
    size, products, deep = whole_vectors(N), len(every) + count, whole_vectors(N) + 8
    x, y = random.normal(size=(2, size + 4))
    out, scales = np.full((2, products * size), np.nan)
    factors, sums = random.normal(size=products), np.zeros((2, size + 4, deep))
    factors[len(every):] = 0.0
    of_couplings(couplings, x, y, out, factors, scales, sums[0].ravel(), sums[1].ravel(), products,
                 size, deep)
    first = squares + count
    expected = [*every[:first] @ x[:N], *every[first:] @ y[:N]]
    found = out.reshape(products, size)[:len(every), :N]
    np.testing.assert_allclose(found, expected, atol=bound, rtol=0)
    for found, of in zip(sums, (slice(None, first), slice(first, len(every))), strict=True):
        expected = np.einsum("k,kij->ji", factors[of], every[of])
        np.testing.assert_allclose(found[:N, :N], expected, atol=bound, rtol=0)


@pytest.mark.parametrize("N", [13, 40])
def test_rows_that_are_multiples(N):
    """As in beams: rows of C and of its transpose are multiples of rows of S; C is antisymmetric.

    Coordinates have units of their own, in which sums are compared.
    """
    random, kind = np.random.default_rng(N), np.arange(N) % 4
    S, C = random.normal(size=(5, N, N)), random.normal(size=(3, N, N))
    S += S.transpose(0, 2, 1)
    S[3, kind[:, np.newaxis] // 2 != kind // 2] = 0.0       # the first kind moves with the second,
    S[3, kind[:, np.newaxis] == kind] = 0.0                 # the third with the last
    C[0] = np.array([2.0, -6.0, 0.4, 1.5])[kind][:, np.newaxis] * S[3]
    C[0] *= 1.0 + 1e-14 * random.normal(size=(N, N))
    C[1] -= C[1].T
    every = np.concatenate([S, C, C, C.transpose(0, 2, 1)])
    row, size = pack_couplings(S, C), whole_vectors(N)
    made = {(one.place // size, one.other // size) for one in multiples(row)}
    assert made == {(5, 3), (8, 15), (11, 15), (12, 9)}     # C x of S x; both others of S y; C^T y
    np.testing.assert_allclose(unpack(row, every.shape), every, rtol=1e-12)
    check_couplings(row, every, len(S), len(C), 1e-11)
    units = 10.0**random.uniform(-6, 6, N)
    scaled = [stack * np.outer(units, units) for stack in (S, C)]
    assert len(list(multiples(pack_couplings(*scaled)))) == 4
    C[0, 0, 1] *= 1.0 + 1e-9
    assert [one.place // size for one in multiples(pack_couplings(S, C))] == [12]


def test_blocks_anywhere():
    """Blocks of matrices begin at any row and column: hardly a zero is packed beside them."""
    N, blocks = 27, [(3, 11), (11, 15), (15, 22), (22, 26)]
    random = np.random.default_rng(0)
    C = np.zeros((3, N, N))
    for k, pairs in enumerate(([(0, 1), (1, 0)], [(2, 3)], [(1, 1), (3, 0)])):
        for i, j in pairs:
            block = C[k, slice(*blocks[i]), slice(*blocks[j])]
            block[:] = random.uniform(1.0, 2.0, block.shape)
    S = C + C.transpose(0, 2, 1)
    every = np.concatenate([S, C, C, C.transpose(0, 2, 1)])
    couplings = pack_couplings(S, C)
    assert np.array_equal(unpack(couplings, every.shape), every)
    taken = list(strips(couplings))
    assert {len(strip.uses) for strip in taken} == {1, 2}       # C multiplies both vectors
    packed = sum(strip.entries.size for strip in taken)     # C is packed once for both vectors
    assert packed < 1.1 * (np.count_nonzero(every) - np.count_nonzero(C))
    check_couplings(couplings, every, len(S), len(C), 1e-13 * N)


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
