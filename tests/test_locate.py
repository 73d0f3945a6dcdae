"""Searches for a body's frame against SciPy and the singular value decomposition."""

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from sebody import locate


def some_nodes(count, size=0.6):
    random = np.random.default_rng(count)
    base = Rotation.from_rotvec([0.5, -1.0, 0.8])
    return base * Rotation.from_rotvec(size * random.uniform(-1, 1, (count, 3))), base


@pytest.mark.parametrize("count", [1, 2, 3, 8])
def test_converged_mean(count):
    nodes, base = some_nodes(count)
    weights = np.linspace(1.0, 2.0, count) / np.linspace(1.0, 2.0, count).sum()
    frame, psi = base.as_matrix().ravel(), np.zeros(3 * count)
    assert locate.converged_mean(count, np.arange(count), weights, nodes.as_matrix().ravel(),
                                 frame, psi) == 0
    assert np.abs(weights @ psi.reshape(-1, 3)).max() < 1e-14
    root = fsolve(lambda r: weights @ ((base * Rotation.from_rotvec(r)).inv() * nodes).as_rotvec(),
                  np.zeros(3), xtol=1e-12)
    expected = (base * Rotation.from_rotvec(root)).as_matrix()
    assert np.abs(frame.reshape(3, 3) - expected).max() < 1e-10


def test_weighted_mean_is_the_papers():
    nodes, reference = some_nodes(3)
    weights, frame = np.array([0.2, 0.5, 0.3]), np.zeros(9)
    beta, psi = np.zeros(9), np.zeros(9)
    assert locate.weighted_mean(3, np.arange(3), weights, nodes.as_matrix().ravel(),
                                reference.as_matrix().ravel(), frame, beta, psi) == 0
    mean = weights @ (reference.inv() * nodes).as_rotvec()
    expected = (reference * Rotation.from_rotvec(mean)).as_matrix()
    assert np.abs(frame.reshape(3, 3) - expected).max() < 1e-14


@pytest.mark.parametrize("points", [
    np.array([[0.0, 0, 0], [10, 0, 0], [0, 7, 0]]),
    np.array([[0.0, 0, 0], [10, 0, 0], [0, 7, 0], [9, 8, 0]]),
    np.random.default_rng(4).normal(size=(8, 3)) * 10])
def test_best_fit_against_singular_values(points):
    """Three, coplanar and general nodes; the determinant is corrected where the rank is two."""
    random, n = np.random.default_rng(0), len(points)
    X = points - points.mean(axis=0)
    turn = Rotation.from_rotvec([0.6, -0.2, 1.0])
    x = turn.apply(X + 0.3 * random.normal(size=X.shape)) + [1000.0, -300.0, 50.0]
    frame, weights = turn.as_matrix().ravel(), np.full(n, 1.0 / n)
    assert locate.best_fit(n, weights, X.ravel(), weights, x.ravel(), frame) == 0
    U, _, Vt = np.linalg.svd((x - x.mean(axis=0)).T @ X)
    expected = U @ np.diag([1, 1, np.linalg.det(U @ Vt)]) @ Vt
    assert np.abs(frame.reshape(3, 3) - expected).max() < 1e-12


def test_best_fit_refuses_a_line():
    X = np.array([[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]])
    frame, weights = Rotation.from_rotvec([0, 0, 0.1]).as_matrix().ravel(), np.full(3, 1 / 3)
    assert locate.best_fit(3, weights, X.ravel(), weights, X.ravel(), frame) == locate.NO_FRAME


def test_planar_frames():
    angles, weights, psi, frame = np.array([0.9, 1.3]), np.array([0.25, 0.75]), np.zeros(2), \
        np.eye(3).ravel()
    assert locate.planar_mean(2, weights, angles, frame, psi) == 0
    assert psi == pytest.approx(angles - 1.2, abs=1e-15)
    assert frame[[0, 3]] == pytest.approx([np.cos(1.2), np.sin(1.2)], abs=1e-15)
    X = np.array([[-2.0, 0.5], [1.0, 1.0], [1.0, -1.5]])
    c, s = np.cos(2.0), np.sin(2.0)
    x = X @ np.array([[c, s], [-s, c]]) + [5.0, 6.0]
    thirds = np.full(3, 1 / 3)
    assert locate.planar_fit(3, thirds, X.ravel(), thirds, x.ravel(), frame) == 0
    assert frame[[0, 3]] == pytest.approx([c, s], abs=1e-14)
    assert locate.planar_relative_angles(2, np.array([2.1, 2.0 - 4 * np.pi]), frame, psi) == 0
    assert psi == pytest.approx([0.1, 0.0], abs=1e-13)
