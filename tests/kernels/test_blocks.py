"""Products of square blocks against NumPy's."""

import numpy as np
import pytest

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.blocks import multiply_and_subtract, subtract_blocks_times, subtract_product

EPS = np.finfo(float).eps


@compiled
def subtracted(C, A, B):
    subtract_product(pointer_to(C), pointer_to(A), pointer_to(B))


@compiled
def column(y, rows, A, own, first, end, multiplied):
    x = at(pointer_to(y), LANES * own)
    if multiplied:
        multiply_and_subtract(pointer_to(y), pointer_to(rows), pointer_to(A), x, first, end)
    else:
        subtract_blocks_times(pointer_to(y), pointer_to(rows), pointer_to(A), x, first, end)


def test_a_product_of_blocks():
    A, B, C = np.random.default_rng(0).normal(size=(3, LANES, LANES))
    expected = C - A @ B
    found, a, b = (one.T.copy() for one in (C, A, B))       # by columns
    subtracted(found.ravel(), a.ravel(), b.ravel())
    assert np.abs(found.T - expected).max() < LANES * EPS * 10


@pytest.mark.parametrize("multiplied", [False, True])
@pytest.mark.parametrize("first, end", [(0, 3), (1, 2), (2, 2)])
def test_a_column_of_blocks(first, end, multiplied):
    """The block at `end` replaces x, where it is asked to; no other block of y changes."""
    random, rows = np.random.default_rng(1), np.array([4, 0, 3, 2])
    A, y = random.normal(size=(4, LANES, LANES)), random.normal(size=(5, LANES))
    expected, found = y.copy(), y.copy()
    if multiplied:
        expected[1] = A[end] @ y[1]
    for p in range(first, end):
        expected[rows[p]] -= A[p] @ expected[1]
    column(found.ravel(), rows, A.transpose(0, 2, 1).ravel(), 1, first, end, multiplied)
    assert np.abs(found - expected).max() < LANES**2 * EPS * 10
