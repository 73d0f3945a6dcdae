"""Where a floating frame is: the compiled searches against solvers of another kind."""

import numpy as np
import pytest
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from sebody.kernels import frame_search as locate, rotations

SEEDS = range(6)
# Searches end at rounding, Newton's last step being squared, so bounds are multiples of EPS,
# 2.2e-16: 4e-15 for a product of rotations and SciPy's; 1e-14 for logarithms and sums of them;
# 1e-13 for the solvers compared with, MINPACK and an SVD, both of conditions below a hundred.
EPS = np.finfo(float).eps


def rotated_nodes(random, count, spread):
    """Rotations about a common one, their weights (not alike, sum one) and that common one."""
    base = Rotation.from_rotvec(random.normal(size=3))
    psi = random.normal(size=(count, 3))
    psi *= spread / np.linalg.norm(psi, axis=1, keepdims=True)
    alpha = random.uniform(0.2, 1.0, size=count)
    return base * Rotation.from_rotvec(psi), alpha / alpha.sum(), base


def start(random, base, angle):
    """A frame turned from another by an angle."""
    axis = random.normal(size=3)
    return (base * Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))).as_matrix().ravel()


def karcher_by_root(nodes, alpha, base):
    """Zero of ``sum alpha_j log(R0^T R_j)`` by MINPACK, R0 as a rotation vector from base."""
    def mean(x):
        return alpha @ ((base * Rotation.from_rotvec(x)).inv() * nodes).as_rotvec()
    solution = root(mean, np.zeros(3), tol=1e-15)
    assert np.abs(solution.fun).max() < 1e-13
    return (base * Rotation.from_rotvec(solution.x)).as_matrix()


def svd_fit(w, X, arms):
    """Rotation of best fit, ``max tr(R^T sum w_j r_j X_j^T)``, with determinant correction."""
    U, _, Vt = np.linalg.svd((w[:, None] * arms).T @ X)
    flip = np.diag([1.0, 1.0, np.linalg.det(U @ Vt)])
    return U @ flip @ Vt


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("count, spread, away", [(1, 1.0, 0.5), (2, 0.3, 0.3), (2, 1.0, 1.0),
                                                 (3, 0.8, 0.5), (8, 0.6, 1.0), (5, 1e-9, 0.3)])
def test_converged_mean(count, spread, away, seed):
    random = np.random.default_rng(seed)
    nodes, alpha, base = rotated_nodes(random, count, spread)
    frame, psi = start(random, base, away), np.zeros(3 * count)
    stored = nodes.as_matrix().ravel()
    assert locate.converged_mean(count, np.arange(count), alpha, stored, frame, psi) == 0
    assert np.abs(alpha @ psi.reshape(-1, 3)).max() <= 1e-14
    R0 = frame.reshape(3, 3)
    assert np.abs(R0 - karcher_by_root(nodes, alpha, base)).max() <= 1e-13
    assert np.abs(R0.T @ R0 - np.eye(3)).max() <= 1e-14
    exact = (Rotation.from_matrix(R0).inv() * nodes).as_rotvec()
    assert np.abs(psi - exact.ravel()).max() <= 1e-14


def test_converged_mean_of_equal_rotations_is_theirs():
    base = Rotation.from_rotvec([0.4, -1.0, 0.7])
    frame, psi = start(np.random.default_rng(0), base, 2.0), np.ones(6)
    stored = np.tile(base.as_matrix().ravel(), 2)
    assert locate.converged_mean(2, np.arange(2), np.array([0.5, 0.5]), stored, frame, psi) == 0
    assert np.abs(frame - stored[:9]).max() <= 4e-15 and np.abs(psi).max() <= 4e-15


def test_converged_mean_is_the_same_from_any_start():
    random = np.random.default_rng(7)
    nodes, alpha, base = rotated_nodes(random, 3, 0.6)
    found = []
    for away in (0.0, 0.1, 0.5, 1.0, 1.5):
        frame, psi = start(random, base, away), np.zeros(9)
        assert locate.converged_mean(3, np.arange(3), alpha, nodes.as_matrix().ravel(), frame,
                                     psi) == 0
        found.append(frame)
    assert np.ptp(found, axis=0).max() <= 4e-15


@pytest.mark.parametrize("twist", [0.6, 2.4])
def test_mean_of_two_stays_near_the_last_frame_where_a_body_is_twisted_far(twist):
    """Twisted by more than half a turn in all, the other mean lies half a turn away."""
    base = Rotation.from_rotvec([0.4, -1.0, 0.7])
    turns = np.array([[0, -twist, 0], [0, twist, 0]])
    nodes, frame, psi = base * Rotation.from_rotvec(turns), base.as_matrix().ravel(), np.zeros(6)
    assert locate.converged_mean(2, np.arange(2), np.array([0.5, 0.5]),
                                 nodes.as_matrix().ravel(), frame, psi) == 0
    assert np.abs(frame - base.as_matrix().ravel()).max() <= 4e-15
    assert np.abs(psi - turns.ravel()).max() <= 1e-14


def test_converged_mean_refuses_half_turns():
    base = Rotation.from_rotvec([0.4, -1.0, 0.7])
    nodes = base * Rotation.from_rotvec([[0, 0, 0], [0, 3.05, 0]])
    frame, psi = base.as_matrix().ravel(), np.zeros(6)
    assert locate.converged_mean(2, np.arange(2), np.array([0.5, 0.5]),
                                 nodes.as_matrix().ravel(), frame, psi) == locate.HALF_TURN


@pytest.mark.parametrize("seed", SEEDS)
def test_weighted_mean(seed):
    """(15), (16) as they stand."""
    random = np.random.default_rng(seed)
    nodes, alpha, base = rotated_nodes(random, 3, 0.5)
    reference = start(random, base, 0.4)
    frame, beta, psi = np.zeros(9), np.zeros(9), np.zeros(9)
    assert locate.weighted_mean(3, np.arange(3), alpha, nodes.as_matrix().ravel(), reference,
                                frame, beta, psi) == 0
    last = Rotation.from_matrix(reference.reshape(3, 3))
    increments = (last.inv() * nodes).as_rotvec()
    exact = last * Rotation.from_rotvec(alpha @ increments)
    assert np.abs(beta - increments.ravel()).max() <= 1e-14
    assert np.abs(frame - exact.as_matrix().ravel()).max() <= 4e-15
    assert np.abs(psi - (exact.inv() * nodes).as_rotvec().ravel()).max() <= 1e-14


def fitted(random, X, size, away):
    """A deformed, turned and shifted copy of nodes, their weights, and a frame some way off."""
    count = len(X)
    alpha, w = random.uniform(0.3, 1.0, size=(2, count))
    alpha /= alpha.sum()
    X = X - alpha @ X
    base = Rotation.from_rotvec(random.normal(size=3))
    x = base.apply(X + size * random.normal(size=X.shape)) + 10.0 * random.normal(size=3)
    return X, alpha, w, x, start(random, base, away)


SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
SHAPES = {"three": np.array([[0.0, 0, 0], [2, 0, 0], [0.5, 1, 0]]), "coplanar": SQUARE,
          "tetrahedron": np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]),
          "brick": np.concatenate([SQUARE, SQUARE + [0, 0, 4.0]])}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("away", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("shape", SHAPES)
def test_best_fit(shape, away, seed):
    random = np.random.default_rng(seed)
    X, alpha, w, x, frame = fitted(random, SHAPES[shape], 0.05, away)
    assert locate.best_fit(len(X), w, X.ravel(), alpha, x.ravel(), frame) == 0
    R0, arms = frame.reshape(3, 3), x - alpha @ x
    assert np.abs(R0 - svd_fit(w, X, arms)).max() <= 1e-13
    assert np.abs(w @ np.cross(X, arms @ R0)).max() <= 1e-14 * np.abs(arms).max()**2 * len(X)
    assert np.abs(R0.T @ R0 - np.eye(3)).max() <= 1e-14


@pytest.mark.parametrize("shape", ["three", "brick"])
def test_best_fit_is_right_or_refused(shape):
    """From far away, beyond the saddles of the fit: never a wrong frame."""
    for seed in range(100):
        random = np.random.default_rng(seed)
        X, alpha, w, x, frame = fitted(random, SHAPES[shape], 0.05, 1.5)
        status = locate.best_fit(len(X), w, X.ravel(), alpha, x.ravel(), frame)
        # a wrong frame is one of another stationary turn, far away
        assert status or np.abs(frame.reshape(3, 3) - svd_fit(w, X, x - alpha @ x)).max() < 1e-10


def test_best_fit_does_not_mirror():
    """Nodes pushed through their plane: the SVD alone would give a reflection."""
    random = np.random.default_rng(3)
    X, alpha, w, x, frame = fitted(random, SHAPES["three"], 0.0, 0.2)
    X[:, 2] = 1e-3 * random.normal(size=3)
    X -= alpha @ X
    assert locate.best_fit(3, w, X.ravel(), alpha, x.ravel(), frame) == 0
    R0 = frame.reshape(3, 3)
    assert np.linalg.det(R0) == pytest.approx(1.0, abs=1e-14)
    # the turn depends on sums of two singular values, of which only one is small: as above
    assert np.abs(R0 - svd_fit(w, X, x - alpha @ x)).max() <= 1e-12


def test_best_fit_refuses_nodes_on_a_line():
    X = np.array([[-1.0, 0, 0], [0, 0, 0], [1, 0, 0]])
    third = np.full(3, 1 / 3)
    assert locate.best_fit(3, third, X.ravel(), third, X.ravel(), np.eye(3).ravel()
                           ) == locate.NO_FRAME


def test_best_fit_refuses_nodes_in_one_point():
    X, third = SHAPES["three"] - SHAPES["three"].mean(axis=0), np.full(3, 1 / 3)
    assert locate.best_fit(3, third, X.ravel(), third, np.ones(9), np.eye(3).ravel()
                           ) == locate.NO_FRAME


@pytest.mark.parametrize("seed", SEEDS)
def test_planar_mean(seed):
    random = np.random.default_rng(seed)
    alpha = random.dirichlet(np.ones(3))
    angles, frame, psi = 3.0 * random.normal(size=3), np.eye(3).ravel(), np.zeros(3)
    assert locate.planar_mean(3, alpha, angles, frame, psi) == 0
    assert abs(alpha @ psi) <= 1e-14
    exact = Rotation.from_rotvec([0, 0, alpha @ angles]).as_matrix()
    # sums of three products, in any order: three roundings of angles of several rad
    rounding = 3 * EPS * max(np.abs(angles).max(), 1.0)
    assert np.abs(frame.reshape(3, 3) - exact).max() <= rounding
    assert np.abs(psi - (angles - alpha @ angles)).max() <= rounding


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("shape", [*SHAPES, "two"])
def test_planar_fit(shape, seed):
    """In closed form, from any start: the spatial fit turns about the normal alone."""
    random = np.random.default_rng(seed)
    X = np.array([[0.0, 0], [1, 1]]) if shape == "two" else SHAPES[shape][:, :2]
    alpha, w = random.uniform(0.3, 1.0, size=(2, len(X)))
    alpha /= alpha.sum()
    X = X - alpha @ X
    angle = random.uniform(-np.pi, np.pi)
    turn = Rotation.from_rotvec([0, 0, angle]).as_matrix()[:2, :2]
    x = (X + 0.05 * random.normal(size=X.shape)) @ turn.T + random.normal(size=2)
    frame = np.eye(3).ravel()
    assert locate.planar_fit(len(X), w, X.ravel(), alpha, x.ravel(), frame) == 0
    arms = x - alpha @ x
    U, _, Vt = np.linalg.svd((w[:, None] * arms).T @ X)
    exact = U @ np.diag([1.0, np.linalg.det(U @ Vt)]) @ Vt
    assert np.abs(frame.reshape(3, 3)[:2, :2] - exact).max() <= 1e-14
    assert np.abs(frame[[2, 5, 6, 7]]).max() == 0.0 and frame[8] == 1.0


def test_planar_fit_refuses_nodes_in_one_point():
    X, half = np.array([-1.0, 0, 1, 0]), np.array([0.5, 0.5])
    assert locate.planar_fit(2, half, X, half, np.ones(4), np.eye(3).ravel()) == locate.NO_FRAME


@pytest.mark.parametrize("turns", [-3, 0, 1, 20])
def test_planar_relative_angles(turns):
    """Between -pi and pi whatever full turns the angles have made."""
    frame = Rotation.from_rotvec([0, 0, 3.0]).as_matrix().ravel()
    exact, psi = np.array([0.4, -2.9, 2.9]), np.zeros(3)
    angles = exact + 3.0 + 2 * np.pi * turns * np.array([1, 0, -1])
    assert locate.planar_relative_angles(3, angles, frame, psi) == 0
    # 40 pi and 3 rad more, taken off again: EPS of 130 rad
    assert np.abs(psi - exact).max() <= 1e-13


@pytest.mark.parametrize("angle, status", [(2.941, 0), (2.942, 1), (np.pi, 1), (-3.0, 1),
                                           (np.nan, 1)])
def test_planar_relative_angles_refuses_half_turns(angle, status):
    assert np.cos(2.941) > rotations.NEAR_PI > np.cos(2.942)
    assert locate.planar_relative_angles(1, np.array([angle]), np.eye(3).ravel(), np.zeros(1)
                                         ) == status


def test_step_of_the_converged_mean_is_newtons():
    """``B^-1 x`` with ``B = sum alpha_j T^-T(psi_j)``, T by its closed form.

    Another matrix would lead to the same frame, only in more steps.
    """
    random = np.random.default_rng(4)
    psi, alpha, x = random.normal(size=(3, 3)), random.dirichlet(np.ones(3)), random.normal(size=3)
    B = np.zeros((3, 3))
    for a, p in zip(alpha, psi, strict=True):
        t, S = np.linalg.norm(p), np.cross(np.eye(3), p)        # skew(p)
        T = np.eye(3) - (1 - np.cos(t)) / t**2 * S + (t - np.sin(t)) / t**3 * S @ S
        B += a * np.linalg.inv(T).T
    found = locate.mean_step(3, alpha, psi.ravel(), *x)
    assert np.abs(found - np.linalg.solve(B, x)).max() <= 1e-13      # B is of order one
