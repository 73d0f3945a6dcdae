"""Compiled maps of SO(3) against 50-digit arithmetic and SciPy."""

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import rotations

SMALL_TO_LARGE = [0.0, 1e-16, 1e-8, 1e-4, 0.01, 0.2, 0.2499999, 0.25, 0.2500001, 1.0, 4.0, 9.0]


def stumpff(k, s):
    """The defining series at 50 digits."""
    s = mpmath.mpf(s)
    return sum((-s)**j / mpmath.factorial(k + 2 * j) for j in range(60))


def coefficient(s):
    """``(1 - (t/2) cot(t/2)) / t^2``, the coefficient of skew^2 in the inverse of T."""
    t = mpmath.sqrt(s)
    return (1 - t / 2 * mpmath.cot(t / 2)) / s if s else mpmath.mpf(1) / 12


@pytest.mark.parametrize("s", SMALL_TO_LARGE)
def test_stumpff_functions(s):
    with mpmath.workdps(50):
        exact = [stumpff(k, s) for k in range(8)]
    for k in range(1, 8):
        assert rotations.stumpff(k, s) == pytest.approx(float(exact[k]), rel=1e-13)
    assert rotations.stumpff_23(s) == pytest.approx([float(e) for e in exact[2:4]], rel=1e-13)
    assert rotations.stumpff_2345(s) == pytest.approx([float(e) for e in exact[2:6]], rel=1e-13)


@pytest.mark.parametrize("s", SMALL_TO_LARGE)
def test_inverse_tangent_coefficients(s):
    with mpmath.workdps(50):
        e = coefficient(mpmath.mpf(s))
        d = (mpmath.diff(coefficient, mpmath.mpf(s)) if s > 1e-6
             else mpmath.mpf(1) / 720 + mpmath.mpf(s) / 15120)
    assert rotations.inverse_tangent_coefficients(s) == pytest.approx(
        (float(e), float(d)), rel=1e-12)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.29, 0.31, 1.0, 2.0, 2.9])
def test_exp_and_log(angle):
    axis = np.array([2.0, -1.0, 0.5]) / np.sqrt(5.25)
    psi = angle * axis
    R = np.reshape(rotations.exp_map(*psi), (3, 3))
    assert np.abs(R - Rotation.from_rotvec(psi).as_matrix()).max() < 1e-15 * 4
    *back, cosine = rotations.log_map(*R.ravel())
    assert np.abs(np.array(back) - psi).max() <= 1e-14 * max(angle, 1e-3)
    assert cosine == pytest.approx(np.cos(angle), abs=1e-15)


def test_tangent_operator_maps_rates_to_angular_velocity():
    """``T psidot = vee(R^T Rdot)`` by sixth-order differences of SciPy's rotations."""
    psi, rate, h = np.array([0.7, -0.9, 0.4]), np.array([0.3, 0.5, -1.1]), 0.01
    R = Rotation.from_rotvec(psi).as_matrix()

    def at(t):
        return Rotation.from_rotvec(psi + t * rate).as_matrix()
    slope = sum(w * (at(k * h) - at(-k * h)) for k, w in ((1, 0.75), (2, -0.15), (3, 1 / 60))) / h
    spin = R.T @ slope
    T = np.reshape(rotations.tangent_operator(*psi), (3, 3))
    assert T @ rate == pytest.approx([spin[2, 1], spin[0, 2], spin[1, 0]], abs=1e-12)


def test_near_half_turn_is_refused():
    R = Rotation.from_rotvec([[0, 0, 3.0]]).as_matrix().ravel()
    psi = np.zeros(3)
    nodes = np.zeros(1, dtype=np.int64)
    assert rotations.relative_rotations(1, nodes, R, np.eye(3).ravel(), psi) == 1
    R = Rotation.from_rotvec([[0, 0, 2.9]]).as_matrix().ravel()
    assert rotations.relative_rotations(1, nodes, R, np.eye(3).ravel(), psi) == 0
    assert psi == pytest.approx([0, 0, 2.9], rel=1e-13)
