"""Coordinates that determine the others and those that follow them, against NumPy."""

import numpy as np
import pytest

from sebody.compiler.decorators import compiled
from sebody.contract.counts import whole_vectors
from sebody.contract.layout import padded_columns
from sebody.kernels.abi import opaque, pointer_to
from sebody.kernels.coordinates import all_to_free, follow, follow_changes


@compiled
def chosen(rows, axes, order, moved, to, bound, bound_free, free, end):
    all_to_free(pointer_to(rows[0]), pointer_to(rows[1]), pointer_to(rows[2]), pointer_to(axes),
                pointer_to(order), pointer_to(moved), pointer_to(to[0]), pointer_to(to[1]),
                pointer_to(to[2]), bound, bound_free, free, end)


@compiled
def following(Zq, Zd, Za, z, dz, free, slaved, height):
    follow(pointer_to(Zq), pointer_to(Zd), pointer_to(z[0]), pointer_to(z[1]), pointer_to(z[2]),
           free, slaved, height)
    follow_changes(pointer_to(Zq), pointer_to(Zd), pointer_to(Za), pointer_to(dz[0]),
                   pointer_to(dz[1]), pointer_to(dz[2]), free, slaved, height)


@pytest.mark.parametrize("bound, bound_free, modes", [(12, 6, 4), (5, 3, 2), (6, 0, 3), (9, 8, 0)])
def test_coordinates_that_determine_the_others(bound, bound_free, modes):
    """Boundary coordinates by a matrix, modes as they are, in some order, then zeros."""
    random = np.random.default_rng(bound)
    free, end = bound_free + modes, whole_vectors(bound_free + modes) + 4
    A, order = random.normal(size=(bound_free, bound)), random.permutation(free)
    rows = random.normal(size=(3, bound + modes))
    moved = np.full(3 * (whole_vectors(bound_free) + modes) + 1, 7.0)
    to = np.full((3, end + 1), 7.0)
    chosen(rows, padded_columns(A), order.astype(float), moved, to, bound, bound_free, free, end)
    whole = np.zeros((free, bound + modes))
    whole[:bound_free, :bound], whole[bound_free:, bound:] = A, np.eye(modes)
    assert np.abs(to[:, :free] - rows @ whole[order].T).max() < 1e-14      # sums of 12 products
    assert not to[:, free:end].any() and np.all(to[:, end] == 7.0) and moved[-1] == 7.0


@pytest.mark.parametrize("free, slaved", [(10, 2), (5, 1), (8, 3), (3, 0)])
def test_slaved_coordinates_follow(free, slaved):
    """``z . Q z / 2``, its rates, and the changes of these by complex steps."""
    random = np.random.default_rng(free)
    height = whole_vectors(free)
    Q = random.normal(size=(slaved, free, free))
    Q += Q.transpose(0, 2, 1)
    z, dz = random.normal(size=(2, 3, free))

    def values(z):
        return np.array([np.einsum("i,bij,j->b", z[0], Q, z[0]) / 2,
                         np.einsum("i,bij,j->b", z[0], Q, z[1]),
                         np.einsum("i,bij,j->b", z[0], Q, z[2])
                         + np.einsum("i,bij,j->b", z[1], Q, z[1])])
    products = np.zeros((3, slaved, height))
    products[..., :free] = np.einsum("bij,kj->kbi", Q, z)
    size = max(height, free + slaved) + 1       # whole vectors are read
    rows, changes = np.zeros((2, 3, size))
    rows[:, :free], changes[:, :free] = z, dz
    following(*products, rows, changes, free, slaved, height)
    # sums of 100 products of numbers of size one
    assert np.abs(rows[:, free:free + slaved] - values(z)).max(initial=0.0) < 1e-12
    step = 1e-30
    expected = values(z + 1j * step * dz).imag[1:] / step
    assert np.abs(changes[1:, free:free + slaved] - expected).max(initial=0.0) < 1e-12
    assert not rows[:, free + slaved:].any()


@compiled
def unchanged(number):
    return opaque(number)


def test_a_hidden_number_is_the_same():
    assert [unchanged(k) for k in (0, -3, 2**62)] == [0, -3, 2**62]
