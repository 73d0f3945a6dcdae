"""The maps of SO(3) for compiled code against closed forms in 50 digits and SciPy."""

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody.kernels import rotations

mpmath.mp.dps = 50
# Bounds are multiples of EPS, 2.2e-16. Entries of a rotation matrix are up to one, each a sum of
# three rounded products: 1e-15; where SciPy's own or a second product is compared with, 2e-15 and
# 4e-15. Logarithms and T^-1 divide by sines of up to 2.9 rad, 0.24: 1e-14. Coefficients of closed
# forms cancel: each power of s up to the third loses a factor of four at the switch, s = 0.25,
# which with the factorials makes some hundred EPS.
TOLERANCE = 1e-13
# squares of angles: up to 3 rad, both sides of the switch to closed forms at 0.25
SQUARES = [1e-16, 1e-12, 1e-8, 1e-4, 1e-2, 0.1, 0.2, np.nextafter(0.25, 0), 0.25,
           np.nextafter(0.25, 1), 0.3, 0.5, 1.0, 2.0, 4.0, 6.25, 8.0, 9.0]
ANGLES = [1e-200, 1e-12, 1e-8, 1e-5, 1e-3, 0.1, 0.3, 0.3047, 0.5, 1.0, np.pi / 2, 2.0, 2.5, 2.9]
AXES = np.array([[1.0, 0, 0], [0, 0, -1.0], [2 / 3, -1 / 3, 2 / 3], [-0.6, 0.64, 0.48]])


def relative(value: float, exact) -> float:
    return float(abs((mpmath.mpf(float(value)) - exact) / exact))


def c(k: int, s) -> mpmath.mpf:
    """``c_k(s)`` from its closed form, by the recurrence ``c_k = 1/k! - s c_{k+2}``."""
    s = mpmath.mpf(s)
    with mpmath.workdps(250):       # the recurrence divides by s: digits to lose for s = 1e-16
        t = mpmath.sqrt(s)
        value = mpmath.cos(t) if k % 2 == 0 else mpmath.sin(t) / t
        for j in range(k % 2, k, 2):
            value = (1 / mpmath.factorial(j) - value) / s
    return +value


def e(s) -> mpmath.mpf:
    """Coefficient of the square in ``T^-1``: ``(1 - (t/2) cot(t/2)) / t^2``."""
    with mpmath.workdps(200):
        t = mpmath.sqrt(mpmath.mpf(s))
        return (1 - t / 2 * mpmath.cot(t / 2)) / t**2


def e_rate(s) -> mpmath.mpf:
    """``de/ds``, by the chain rule through t."""
    with mpmath.workdps(200):
        t = mpmath.sqrt(mpmath.mpf(s))
        half = t / 2
        by_t = (half / mpmath.sin(half)**2 - mpmath.cot(half)) / (2 * t**2) - 2 * e(s) / t
        return by_t / (2 * t)


def skew(a):
    x, y, z = a
    return mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def series(psi, first: int, second: int):
    """``I + c_first skew + c_second skew^2`` in 50 digits; the sign of first is that of skew."""
    S = skew([mpmath.mpf(float(x)) for x in psi])
    s = sum(mpmath.mpf(float(x))**2 for x in psi)
    sign = 1 if first > 0 else -1
    return mpmath.eye(3) + sign * c(abs(first), s) * S + c(second, s) * S * S


def array(matrix) -> np.ndarray:
    return np.array([[float(x) for x in row] for row in matrix.tolist()])


@pytest.mark.parametrize("s", SQUARES)
@pytest.mark.parametrize("k", range(1, 8))
def test_stumpff(k, s):
    assert relative(rotations.stumpff(k, s), c(k, s)) <= TOLERANCE


@pytest.mark.parametrize("s", SQUARES)
def test_stumpff_groups(s):
    for k, value in enumerate(rotations.stumpff_23(s), 2):
        assert relative(value, c(k, s)) <= TOLERANCE
    for k, value in enumerate(rotations.stumpff_2345(s), 2):
        assert relative(value, c(k, s)) <= TOLERANCE
    for k, value in enumerate(rotations.stumpff_1_to_7(s), 1):
        assert relative(value, c(k, s)) <= TOLERANCE


@pytest.mark.parametrize("s", SQUARES)
def test_inverse_tangent_coefficients(s):
    value, rate = rotations.inverse_tangent_coefficients(s)
    assert relative(value, e(s)) <= TOLERANCE
    assert relative(rate, e_rate(s)) <= TOLERANCE


def test_values_at_zero():
    assert rotations.stumpff_23(0.0) == (1 / 2, 1 / 6)
    assert rotations.stumpff_2345(0.0) == (1 / 2, 1 / 6, 1 / 24, 1 / 120)
    assert rotations.inverse_tangent_coefficients(0.0) == (1 / 12, 1 / 720)
    assert rotations.exp_map(0.0, 0.0, 0.0) == (1, 0, 0, 0, 1, 0, 0, 0, 1)
    assert rotations.tangent_operator(0.0, 0.0, 0.0) == (1, 0, 0, 0, 1, 0, 0, 0, 1)
    assert rotations.log_map(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0) == (0, 0, 0, 1)


def test_rate_is_the_derivative_of_the_coefficient():
    for s in (0.1, 0.24, 0.26, 1.0, 5.0):
        rate = mpmath.diff(e, s)
        assert relative(rotations.inverse_tangent_coefficients(s)[1], rate) <= TOLERANCE


@pytest.mark.parametrize("s", [0.1, 0.24, np.nextafter(0.25, 0), 0.25, 0.26, 1.0, 5.0, 9.0])
def test_second_derivative_of_the_coefficient(s):
    """By differences in 50 digits; closed forms of c_8 lose one power of s more."""
    assert relative(rotations.inverse_tangent_second(s), mpmath.diff(e, s, 2)) <= TOLERANCE


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("angle", ANGLES[1:])
def test_exp_and_tangent_operator(angle, axis):
    psi = angle * axis
    turn = np.reshape(rotations.exp_map(*psi), (3, 3))
    assert np.abs(turn - array(series(psi, 1, 2))).max() <= 1e-15
    assert np.abs(turn - Rotation.from_rotvec(psi).as_matrix()).max() <= 4e-15
    assert np.abs(turn.T @ turn - np.eye(3)).max() <= 2e-15
    operator = np.reshape(rotations.tangent_operator(*psi), (3, 3))
    assert np.abs(operator - array(series(psi, -2, 3))).max() <= 1e-15


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("angle", ANGLES[1:])
def test_inverse_tangent_operator(angle, axis):
    """``I + skew/2 + e skew^2`` undoes T."""
    psi = angle * axis
    S = array(skew(psi))
    inverse = np.eye(3) + S / 2 + rotations.inverse_tangent_coefficients(psi @ psi)[0] * S @ S
    operator = np.reshape(rotations.tangent_operator(*psi), (3, 3))
    assert np.abs(inverse @ operator - np.eye(3)).max() <= 1e-14


def test_tangent_operator_gives_the_angular_velocity():
    """``R^T dR/dt = skew(T(psi) psidot)``, the rate by differences in 50 digits."""
    random = np.random.default_rng(1)
    psi, rate = random.normal(size=(2, 3))
    h = mpmath.mpf(10)**-15

    def turn(t):
        moved = mpmath.matrix(psi) + t * mpmath.matrix(rate)
        s = sum(x * x for x in moved)
        S = skew(list(moved))
        return mpmath.eye(3) + c(1, s) * S + c(2, s) * S * S
    spin = array(turn(0).T * (turn(h) - turn(-h)) / (2 * h))
    omega = np.reshape(rotations.tangent_operator(*psi), (3, 3)) @ rate
    assert np.abs([spin[2, 1], spin[0, 2], spin[1, 0]] - omega).max() <= 1e-14


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("angle", ANGLES)
def test_log_of_a_rounded_rotation(angle, axis):
    """The logarithm of a rotation correct to the last digit, relative to its size."""
    psi = angle * axis
    turn = array(series(psi, 1, 2)) if angle > 1e-100 else np.eye(3) + array(skew(psi))
    *found, cosine = rotations.log_map(*turn.ravel())
    assert np.abs(found - psi).max() <= TOLERANCE * angle
    assert cosine == pytest.approx(np.cos(angle), abs=1e-15)


def test_log_on_both_sides_of_its_switch():
    """The series in sin^2 serves up to sin^2 = 0.09 within a quarter turn."""
    for angle in np.arcsin(0.3) + np.array([-1e-3, -1e-12, 1e-12, 1e-3]):
        for sense in (angle, np.pi - angle):
            if np.cos(sense) > rotations.NEAR_PI:
                psi = sense * AXES[3]
                found = rotations.log_map(*array(series(psi, 1, 2)).ravel())[:3]
                assert np.abs(found - psi).max() <= TOLERANCE


def test_log_inverts_exp():
    random = np.random.default_rng(2)
    for psi in random.normal(size=(200, 3)):
        psi *= random.uniform(0, 2.9) / np.linalg.norm(psi)
        assert np.abs(rotations.log_map(*rotations.exp_map(*psi))[:3] - psi).max() <= TOLERANCE


def test_turn_and_relative_log():
    """Products of stored rotations, also in place, against SciPy."""
    random = np.random.default_rng(3)
    first, second = Rotation.from_rotvec(random.normal(size=(2, 3)))
    psi = 0.7 * random.normal(size=3)
    stored = np.concatenate([first.as_matrix().ravel(), second.as_matrix().ravel()])
    out = np.zeros(18)
    rotations.rotate(stored, 9, *psi, out, 9)
    exact = (second * Rotation.from_rotvec(psi)).as_matrix().ravel()
    assert np.abs(out[9:] - exact).max() <= 2e-15 and not out[:9].any()
    rotations.rotate(stored, 0, *psi, stored, 0)
    assert np.abs(stored[:9] - (first * Rotation.from_rotvec(psi)).as_matrix().ravel()
                  ).max() <= 2e-15
    *found, cosine = rotations.relative_log(stored, 9, out, 9)
    assert np.abs(found - psi).max() <= 1e-14
    assert cosine == pytest.approx(np.cos(np.linalg.norm(psi)), abs=1e-15)


@pytest.mark.parametrize("angle, status", [(0.0, 0), (2.9, 0), (2.941, 0), (2.942, 1), (3.1, 1),
                                           (np.pi, 1), (3.3, 1), (3.4, 0)])
def test_relative_rotations_refuses_half_turns(angle, status):
    """Up to an angle whose cosine is NEAR_PI; the order of the nodes is that of the list."""
    assert np.cos(2.941) > rotations.NEAR_PI > np.cos(2.942)
    frame = Rotation.from_rotvec([0.3, -0.5, 0.8])
    angles = np.array([[0.1, 0.2, 0.3], AXES[3] * angle])
    R = (frame * Rotation.from_rotvec(angles)).as_matrix()
    psi, nodes = np.zeros(6), np.array([1, 0])
    assert rotations.relative_rotations(2, nodes, R.ravel(), frame.as_matrix().ravel(),
                                        psi) == status
    if status == 0:
        exact = angles[nodes]
        exact[0] = Rotation.from_rotvec(exact[0]).as_rotvec()
        assert np.abs(psi - exact.ravel()).max() <= TOLERANCE


def test_relative_rotations_refuses_what_is_not_a_number():
    psi, R = np.zeros(3), np.full(9, np.nan)
    assert rotations.relative_rotations(1, np.array([0]), R, np.eye(3).ravel(), psi) == 1
