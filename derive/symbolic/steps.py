"""Named quantities and the stages that compute one from another: what a kernel is made of.

A kernel is a list of stages in the order of computation. Its linearization is the differential
of each stage, by the chain rule over the *named* quantities, in the same order.
"""

from typing import NamedTuple

import sympy as sp

from sebody.derive.symbolic.rotations import skew, stumpff, tangent_inverse
from sebody.derive.symbolic.spaces import Quantity, Space
from sebody.derive.symbolic.variation import Rules, along, check_same, differential


class Stage(NamedTuple):
    """Explicit formulas: quantities set, or summed over the nodes."""

    title: str
    over: str                                   # element | position | rotation | mode
    sets: tuple[tuple[Quantity, sp.Matrix], ...] = ()
    adds: tuple[tuple[Quantity, sp.Matrix], ...] = ()
    short: tuple[sp.Matrix, ...] = ()           # hand-shortened differentials of `sets`, proved
    continues: bool = False                     # `adds` goes on with the sum of an earlier stage


class Product(NamedTuple):
    """``out = matrix vector`` with a matrix of the body's constants, by padded columns."""

    title: str
    matrix: str
    vector: str
    out: str
    shape: tuple[str, str] = ("n", "n")

    def differential(self) -> "Product":
        """The same product of the vector's differential: the matrix is constant."""
        return self._replace(title="differential: " + self.title, vector="d" + self.vector,
                             out="d" + self.out)


class Solve(NamedTuple):
    """A linear 3-vector equation ``sum_j summand_j(unknown) + constant = 0`` over `over` nodes.

    The inverse of its matrix is kept in `inverse`, made where `invert` says so.
    """

    title: str
    unknown: Quantity
    over: str
    summand: sp.Matrix
    constant: sp.Matrix
    inverse: str
    transposed: bool = False
    invert: bool = False


class Text(NamedTuple):
    """Kernel text that calls an algorithm of the runtime (a root search, a logarithm)."""

    title: str
    lines: tuple[str, ...]
    calls: tuple[str, ...] = ()
    over: str = "element"
    operations: int = 0         # arithmetic of one pass, for the operation count


class Damping(NamedTuple):
    """Steps that only layouts with structural damping have."""

    title: str
    steps: tuple


Step = Stage | Product | Solve | Text | Damping


class Linearizer:
    """Differentiates stages by the chain rule over named quantities.

    Parameters
    ----------
    space : Space
    rules : dict
        Differentials of the quantities the stages start from.
    """

    def __init__(self, space: Space, rules: Rules):
        self.space = space
        self.rules = dict(rules)

    def move(self, quantity: Quantity) -> None:
        """Let a quantity vary from here on, along its own differential."""
        self.rules |= along_own(self.space, quantity)

    def stage(self, step: Stage) -> Stage:
        """The differential of a stage; a short form is proved against the chain rule first."""
        chains = [differential(expression, self.rules) for _, expression in step.sets]
        results = self._proved(step, chains) if step.short else chains
        d = self.space.d
        sets = tuple((d(q), e) for (q, _), e in zip(step.sets, results, strict=True))
        adds = tuple((d(q), differential(e, self.rules)) for q, e in step.adds)
        for quantity, _ in (*step.sets, *step.adds):
            self.move(quantity)
        return Stage("differential: " + step.title, step.over, sets, adds,
                     continues=step.continues)

    def _proved(self, step, chains):
        frames = [q.symbols for q in self.space.known.values() if q.kind == "rotation"]
        meaning = {s: e for q, value in step.sets
                   for s, e in zip(q.symbols, value, strict=True) if isinstance(s, sp.Symbol)}
        for (quantity, _), short, chain in zip(step.sets, step.short, chains, strict=True):
            check_same(f"differential of {quantity.name}", short.subs(meaning), chain, frames)
        return step.short

    def solve(self, step: Solve) -> Solve:
        """``B du = - d(equation) at fixed u``: the same matrix, a new right-hand side."""
        d_unknown = self.space.d(step.unknown)
        summand = solve_matrix(step) * d_unknown.symbols + differential(step.summand, self.rules)
        constant = differential(step.constant, self.rules)
        self.move(step.unknown)
        return Solve("differential: " + step.title, d_unknown, step.over, summand, constant,
                     step.inverse, step.transposed)


def along_own(space: Space, quantity: Quantity) -> Rules:
    """Rules that move a quantity along its own differential."""
    return along(quantity.symbols, space.d(quantity).symbols)


def solve_matrix(step: Solve) -> sp.Matrix:
    """Matrix of one summand of a linear equation in its unknown."""
    columns = [step.summand.diff(u) if isinstance(u, sp.Symbol) else sp.zeros(3, 1)
               for u in step.unknown.symbols]
    return sp.Matrix.hstack(*columns)


def name_functions(expression: sp.Expr, names: dict[sp.Expr, sp.Symbol]) -> sp.Expr:
    """Replace evaluated opaque functions by the quantities that hold their values."""
    found = {f: names[f] for f in expression.atoms(stumpff, tangent_inverse) if f in names}
    return expression.xreplace(found)


def cross(a: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    """``a x b`` of two columns."""
    return skew(a) * b
