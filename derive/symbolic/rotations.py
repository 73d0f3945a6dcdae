"""Rotations: the maps of SO(3) in functions that SymPy keeps whole, and how rotations vary.

`exp`, the tangent operator `T` and its inverse are written in the Stumpff functions
``c_k(s) = sum_j (-s)^j / (k + 2j)!``, ``s = psi . psi``, which are closed under differentiation.
Expanded into sines and divided by powers of the angle they would lose all digits near zero.
"""

from functools import cache

import mpmath
import sympy as sp


def skew(a: sp.Matrix) -> sp.Matrix:
    """Matrix of the cross product: ``skew(a) b = a x b``."""
    return sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def cross(a: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    """``a x b`` of two columns."""
    return skew(a) * b


class stumpff(sp.Function):
    """``stumpff(k, s) = c_k(s)``, opaque, with ``c_k' = (k c_{k+2} - c_{k+1}) / 2``."""

    nargs = 2

    def fdiff(self, argindex: int = 2) -> sp.Expr:
        k, s = self.args
        return (k * stumpff(k + 2, s) - stumpff(k + 1, s)) / 2


class tangent_inverse(sp.Function):
    """``tangent_inverse(k, s)``: k-th derivative of the coefficient ``e(s)`` of skew^2 in T^-1.

    ``e = (c_3 - 2 c_4) / (2 c_2)``, so that ``T^-1 = I + skew / 2 + e skew^2``.
    """

    nargs = 2

    def fdiff(self, argindex: int = 2) -> sp.Expr:
        k, s = self.args
        return tangent_inverse(k + 1, s)


def tangent_inverse_in_stumpff(order: int, s: sp.Symbol) -> sp.Expr:
    """The k-th derivative of ``e(s)`` written in Stumpff functions."""
    e = (stumpff(3, s) - 2 * stumpff(4, s)) / (2 * stumpff(2, s))
    return sp.diff(e, s, order) if order else e


@cache
def stumpff_value(k: int, s: mpmath.mpf) -> mpmath.mpf:
    """``c_k(s)`` at the working precision of mpmath."""
    term = mpmath.mpf(1) / mpmath.factorial(int(k))
    total, j = term, 0
    while abs(term) > mpmath.eps * abs(total):
        term *= -s / ((k + 2 * j + 1) * (k + 2 * j + 2))
        total += term
        j += 1
    return total


@cache
def tangent_inverse_value(k: int, s: mpmath.mpf) -> mpmath.mpf:
    """``e^(k)(s)`` at the working precision of mpmath."""
    return _tangent_inverse_function(int(k))(s)


@cache
def _tangent_inverse_function(k: int):
    symbol = sp.Symbol("s")
    return sp.lambdify(symbol, tangent_inverse_in_stumpff(k, symbol), [NUMERIC, "mpmath"])


NUMERIC = {"stumpff": stumpff_value, "tangent_inverse": tangent_inverse_value}


def exp(psi: sp.Matrix) -> sp.Matrix:
    """Rotation matrix of the rotation vector ``psi``."""
    s, a = psi.dot(psi), skew(psi)
    return sp.eye(3) + stumpff(1, s) * a + stumpff(2, s) * a * a


def tangent(psi: sp.Matrix) -> sp.Matrix:
    """Material tangent operator ``T``: ``Omega = T(psi) psidot``."""
    s, a = psi.dot(psi), skew(psi)
    return sp.eye(3) - stumpff(2, s) * a + stumpff(3, s) * a * a


def inverse_tangent(psi: sp.Matrix) -> sp.Matrix:
    """``T(psi)^-1``: ``dpsi = T^-1(psi) dTheta`` differentiates the logarithm."""
    s, a = psi.dot(psi), skew(psi)
    return sp.eye(3) + a / 2 + tangent_inverse(0, s) * a * a


def inverse_tangent_times(psi: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    """``T^-1(psi) b`` by cross products, which takes less arithmetic than the matrix."""
    once = skew(psi) * b
    return b + once / 2 + tangent_inverse(0, psi.dot(psi)) * skew(psi) * once


def inverse_tangent_transposed_times(psi: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    """``T^-T(psi) b``: the skew part changes sign."""
    once = skew(psi) * b
    return b - once / 2 + tangent_inverse(0, psi.dot(psi)) * skew(psi) * once
