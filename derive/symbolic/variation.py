"""The differential on the manifold of the unknowns, and the proof of a shortened form.

A *rule set* maps component symbols to their differentials. Vectors move along their own
differential; a rotation matrix moves by ``dR = R skew(dTheta)`` (material variation).
The same function differentiates in time when the rules hold rates.
"""

import random
from collections.abc import Iterable, Mapping
from functools import cache

import mpmath
import sympy as sp

from sebody.derive.symbolic import rotations

Rules = dict[sp.Symbol, sp.Expr]


class DerivationError(AssertionError):
    """A hand-shortened formula differs from the chain rule."""


def along(vector: sp.Matrix, differential: sp.Matrix) -> Rules:
    """Rules for a vector (or any array of symbols): each component along its differential."""
    return {v: d for v, d in zip(vector, differential, strict=True) if isinstance(v, sp.Symbol)}


def rotating(R: sp.Matrix, dTheta: sp.Matrix) -> Rules:
    """Rules for a rotation matrix: ``dR = R skew(dTheta)``."""
    return {r: d for r, d in zip(R, R * rotations.skew(dTheta), strict=True)
            if isinstance(r, sp.Symbol)}


def differential(expression: sp.Expr | sp.Matrix, rules: Mapping[sp.Symbol, sp.Expr]):
    """Chain rule: the derivative in the direction of the differentials of ``rules``."""
    if isinstance(expression, sp.MatrixBase):
        return expression.applyfunc(lambda entry: differential(entry, rules))
    entry = sp.sympify(expression)
    # one directional derivative keeps products factored where partial derivatives multiply out
    step = sp.Dummy("step")
    moved = {s: s + step * rules[s] for s in entry.free_symbols if s in rules and rules[s] != 0}
    return derivative(entry.xreplace(moved), step).subs(step, 0) if moved else sp.S.Zero


def derivative(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """Derivative by a symbol, in the form that `sympy.diff` gives, once for each subexpression.

    `diff` takes those that occur several times as often as they occur, and asks each time again for
    its free symbols: minutes where bodies are coupled.
    """
    known: dict[sp.Expr, sp.Expr] = {}

    def of(node: sp.Expr) -> sp.Expr:
        if node not in known:
            known[node] = taken(node)
        return known[node]

    def taken(node: sp.Expr) -> sp.Expr:
        if not node.args:
            return sp.S.One if node == symbol else sp.S.Zero
        if isinstance(node, sp.Add):
            return sp.Add(*map(of, node.args))
        if isinstance(node, sp.Mul):
            args = node.args
            return sp.Add(*(sp.Mul(*args[:k], by, *args[k + 1:])
                            for k, arg in enumerate(args) if (by := of(arg)) != 0))
        if isinstance(node, sp.Pow):
            base, exponent = node.args
            return node * (of(exponent) * sp.log(base) + of(base) * exponent / base)
        return node.diff(symbol)
    return of(sp.sympify(expression))


def coefficients(form: sp.Expr, variables: sp.Matrix) -> sp.Matrix:
    """Coefficients of a linear form, as a column: ``form = coefficients . variables + rest``."""
    return sp.Matrix([derivative(form, v) for v in variables])


def check_same(name: str, short: sp.Matrix, chain: sp.Matrix,
               frames: Iterable[sp.Matrix] = ()) -> sp.Matrix:
    """Prove that ``short`` equals ``chain``: zero at 50 digits in three random points.

    Parameters
    ----------
    name : str
        What is claimed, for the error message.
    short, chain : sympy.Matrix
        The hand-shortened form and the one the chain rule gives; same shape.
    frames : iterable of sympy.Matrix
        Matrices of symbols that stand for rotations (orthogonality is used).

    Returns
    -------
    sympy.Matrix
        ``short``, to be used from here on.

    Raises
    ------
    DerivationError
        If the two differ by more than 1e-40 of their size.
    """
    _prove(name, sp.ImmutableMatrix(short), sp.ImmutableMatrix(chain),
           tuple(sp.ImmutableMatrix(R) for R in frames))
    return sp.Matrix(short)


@cache
def _prove(name, short, chain, frames) -> None:
    pairs = list(short) + list(chain)
    symbols = sorted(set().union(*(sp.sympify(p).free_symbols for p in pairs)), key=str)
    f = sp.lambdify(symbols, pairs, [rotations.NUMERIC, "mpmath"], cse=True)
    generator = random.Random(name)
    with mpmath.workdps(50):
        for _ in range(3):
            values = _random_point(symbols, frames, generator)
            out = [mpmath.mpmathify(v) for v in f(*values)]     # roots may be of negative numbers
            a, b = out[: len(short)], out[len(short):]
            size = max(abs(v) for v in out) or mpmath.mpf(1)
            worst = max(abs(p - q) for p, q in zip(a, b, strict=True)) / size
            if worst > mpmath.mpf(10) ** -40:
                raise DerivationError(f"{name}: the short form differs from the chain rule by "
                                      f"{mpmath.nstr(worst, 3)} of its size; correct the formula")


def _random_point(symbols, frames, generator) -> list:
    values = {s: mpmath.mpf(generator.randint(-10**6, 10**6)) / 10**6 for s in symbols}
    for R in frames:
        psi = sp.Matrix(3, 1, lambda *_: sp.Rational(generator.randint(-10**6, 10**6), 10**6))
        if any(entry == 0 for entry in R):                    # a rotation in the plane
            psi[0] = psi[1] = 0
        matrix = sp.lambdify([], list(rotations.exp(psi)), [rotations.NUMERIC, "mpmath"])()
        for symbol, value in zip(R, matrix, strict=True):
            if isinstance(symbol, sp.Symbol) and symbol in values:
                values[symbol] = value
    return [values[s] for s in symbols]
