"""The symbolic maps of SO(3): derivative rules against differences, identities in 50 digits."""

import mpmath
import pytest
import sympy as sp

from sebody.derive.symbolic import rotations
from sebody.derive.symbolic.rotations import (
    NUMERIC,
    exp,
    inverse_tangent,
    inverse_tangent_times,
    inverse_tangent_transposed_times,
    skew,
    stumpff,
    tangent,
    tangent_inverse,
)
from sebody.derive.symbolic.variation import along, check_same, differential

S = sp.Symbol("s")
PSI = sp.Matrix(sp.symbols("p_x p_y p_z"))
B = sp.Matrix(sp.symbols("b_x b_y b_z"))
RATE = sp.Matrix(sp.symbols("r_x r_y r_z"))
SQUARES = ["0", "1e-20", "1e-8", "0.01", "0.7", "4", "9"]


@pytest.fixture(autouse=True)
def digits():
    """Fifty digits; values remembered at another precision would spoil differences."""
    rotations.stumpff_value.cache_clear()
    rotations.tangent_inverse_value.cache_clear()
    with mpmath.workdps(50):
        yield


def value(expression, s):
    return sp.lambdify(S, expression, [NUMERIC, "mpmath"])(mpmath.mpf(s))


def difference(f, s):
    """Sixth-order central derivative; in 50 digits good to about 35."""
    s, h = mpmath.mpf(s), mpmath.mpf("1e-6")
    return sum((f(s + k * h) - f(s - k * h)) * w / h for k, w in (
        (1, mpmath.mpf(3) / 4), (2, mpmath.mpf(-3) / 20), (3, mpmath.mpf(1) / 60)))


def close(a, b, tolerance="1e-30"):
    return abs(a - b) <= mpmath.mpf(tolerance) * max(1, abs(b))


@pytest.mark.parametrize("k, closed", [
    (0, mpmath.cos), (1, lambda t: mpmath.sin(t) / t), (2, lambda t: (1 - mpmath.cos(t)) / t**2),
    (3, lambda t: (t - mpmath.sin(t)) / t**3)])
@pytest.mark.parametrize("s", SQUARES[2:])
def test_stumpff_values(k, closed, s):
    assert close(value(stumpff(k, S), s), closed(mpmath.sqrt(mpmath.mpf(s))))


@pytest.mark.parametrize("k", range(7))
@pytest.mark.parametrize("s", SQUARES)
def test_stumpff_derivative_rule(k, s):
    """``c_k' = (k c_{k+2} - c_{k+1}) / 2``, at zero and for k = 0 too."""
    rule = value(sp.diff(stumpff(k, S), S), s)
    assert close(rule, difference(lambda x: rotations.stumpff_value(k, x), s))


@pytest.mark.parametrize("s", SQUARES)
def test_stumpff_second_derivative(s):
    rule = value(sp.diff(stumpff(2, S), S, 2), s)
    first = sp.lambdify(S, sp.diff(stumpff(2, S), S), [NUMERIC, "mpmath"])
    assert close(rule, difference(first, s))


def test_stumpff_recurrence():
    """``c_k = 1/k! - s c_{k+2}``."""
    for k in range(6):
        assert close(value(stumpff(k, S) + S * stumpff(k + 2, S), "0.7"),
                     1 / mpmath.factorial(k))


def test_stumpff_stays_closed():
    """Differentiation brings in no other function and no division by s."""
    second = sp.diff(sp.sin(S) * stumpff(3, S), S, 2)
    assert {f.func for f in second.atoms(sp.Function)} == {stumpff, sp.sin, sp.cos}
    assert not [p for p in second.atoms(sp.Pow) if p.exp.is_negative]


@pytest.mark.parametrize("s", SQUARES[2:])
def test_tangent_inverse_value(s):
    t = mpmath.sqrt(mpmath.mpf(s))
    exact = (1 - t / 2 * mpmath.cot(t / 2)) / t**2
    assert close(value(tangent_inverse(0, S), s), exact)


@pytest.mark.parametrize("order, exact", [(0, (1, 12)), (1, (1, 720)), (2, (1, 15120))])
def test_tangent_inverse_at_zero(order, exact):
    """Bernoulli numbers: ``e = 1/12 + s/720 + s^2/30240 + ...``."""
    found = value(tangent_inverse(order, S), "0")
    assert close(found, mpmath.mpf(exact[0]) / exact[1], "1e-45")


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("s", SQUARES)
def test_tangent_inverse_derivative_rule(order, s):
    rule = value(sp.diff(tangent_inverse(order, S), S), s)
    assert close(rule, difference(lambda x: rotations.tangent_inverse_value(order, x), s))


@pytest.mark.parametrize("maps", [
    ("skew", skew(PSI) * B, PSI.cross(B)), ("orthogonal", exp(PSI).T * exp(PSI), sp.eye(3)),
    ("half turns", exp(PSI / 2) * exp(PSI / 2), exp(PSI)), ("inverse", exp(-PSI), exp(PSI).T),
    ("axis", exp(PSI) * PSI, PSI), ("axis of T", tangent(PSI) * PSI, PSI),
    ("T^-1", inverse_tangent(PSI) * tangent(PSI), sp.eye(3)),
    ("T exp", exp(PSI) * tangent(PSI), tangent(PSI).T),
    ("T^-1 exp(-psi) = T^-T", inverse_tangent(PSI) * exp(PSI).T, inverse_tangent(PSI).T),
    ("T^-1 b", inverse_tangent_times(PSI, B), inverse_tangent(PSI) * B),
    ("T^-T b", inverse_tangent_transposed_times(PSI, B), inverse_tangent(PSI).T * B)],
    ids=lambda maps: maps[0])
def test_identities(maps):
    name, left, right = maps
    check_same(name, left, right)


def test_tangent_from_exp():
    """T is what the chain rule finds: ``exp(psi)^T d exp(psi) = skew(T(psi) dpsi)``."""
    spin = exp(PSI).T * differential(exp(PSI), along(PSI, RATE))
    check_same("T from exp", spin, skew(tangent(PSI) * RATE))


def test_derivative_of_tangent():
    """Mixed derivatives of a rotation, (56): ``dT(a) b - dT(b) a = (T b) x (T a)``."""
    one = differential(tangent(PSI) * B, along(PSI, RATE))
    other = differential(tangent(PSI) * RATE, along(PSI, B))
    check_same("structure equation", one - other,
               (tangent(PSI) * B).cross(tangent(PSI) * RATE))


def test_derivative_of_inverse_tangent():
    """``d(T^-1) = -T^-1 dT T^-1``."""
    rules = along(PSI, RATE)
    expected = -inverse_tangent(PSI) * differential(tangent(PSI), rules) * inverse_tangent(PSI)
    check_same("derivative of T^-1", differential(inverse_tangent(PSI), rules), expected)


def test_maps_at_zero():
    """No division by the angle: the maps and their derivatives have values at zero."""
    zero = dict.fromkeys(PSI, 0)
    slope = differential(inverse_tangent(PSI) * B, along(PSI, RATE)).subs(zero)
    numeric = sp.lambdify([*B, *RATE], list(slope), [NUMERIC, "mpmath"])(1, 2, 3, 4, 5, 6)
    cross = sp.Matrix([4, 5, 6]).cross(sp.Matrix([1, 2, 3])) / 2
    assert [float(x) for x in numeric] == [float(x) for x in cross]
    for matrix in (exp(PSI), tangent(PSI), inverse_tangent(PSI)):
        assert matrix.subs(zero) == sp.eye(3)
