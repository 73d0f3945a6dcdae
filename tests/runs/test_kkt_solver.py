"""Least squares of singular sparse systems, against dense algebra."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csc_matrix

from sebody.runs.kkt_solver import SMALL, Relaxed, Scaled


@pytest.mark.parametrize("consistent", [True, False])
@pytest.mark.parametrize("seed", [0, 1])
def test_least_squares_of_least_norm(seed, consistent):
    """Symmetric, 30 of 3 * SMALL motions without stiffness, loads on them or not; any units."""
    random, n = np.random.default_rng(seed), 3 * SMALL
    sparse = np.where(random.random((n, n - 30)) < 0.02, random.random((n, n - 30)), 0.0)
    sparse += np.eye(n, n - 30) + np.eye(n, n - 30, -30)        # no empty rows
    units = 10.0 ** random.uniform(-3.0, 3.0, n)
    matrix = units[:, None] * (sparse @ sparse.T) * units
    right = matrix @ (random.normal(size=n) / units)
    if not consistent:
        right = right + units * random.normal(size=n)
    solver = Scaled(csc_matrix(matrix))
    found, left = solver.least(right)
    scale = solver.scale
    scaled = scale[:, None] * matrix * scale
    exact = np.linalg.lstsq(scaled, scale * right, rcond=1e-11)[0]
    assert found / scale == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    assert left == pytest.approx(np.abs(scaled @ exact - scale * right), abs=1e-7 * np.abs(
        scale * right).max())


def test_a_pivot_that_is_exactly_zero_is_one_of_rounding():
    """Of a body of MacNeal's method in a plane three lengths of 40 had one: a raw RuntimeError.

    Rounding of pivots is that of entries over the regularization: 1e-15 over 1e-8.
    """
    system = SimpleNamespace(part=np.arange(2), is_multiplier=np.zeros(2),
                             massless_axes=np.zeros(2))
    pivots = Relaxed(csc_matrix(np.ones((2, 2))), np.ones(2), system).pivots
    assert pivots[0] == pytest.approx(1.0) and 0.0 < pivots[1] < 1e-6
