"""Differentials of steps, by the chain rule over the named quantities."""

from collections.abc import Callable

import sympy as sp

from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.steps import Solve, Stage, Sum, solve_matrix
from sebody.derive.symbolic.variation import Rules, along, check_same, differential


class Linearizer:
    """Differentiates stages by the chain rule over named quantities.

    Parameters
    ----------
    space : Space
    rules : dict
        Differentials of the quantities the stages start from.
    named : callable, optional
        The quantity that holds the differential of another one; `space.d` by default.
    """

    def __init__(self, space: Space, rules: Rules,
                 named: Callable[[Quantity], Quantity] | None = None):
        self.space = space
        self.rules = dict(rules)
        self.d, self.title = named or space.d, "rate: " if named else "differential: "

    def move(self, quantity: Quantity) -> None:
        """Let a quantity vary from here on, along its own differential."""
        self.rules |= along(quantity.symbols, self.d(quantity).symbols)

    def step(self, step: Stage | Solve) -> Stage | Solve:
        """The differential of a stage or of an equation."""
        return self.solve(step) if isinstance(step, Solve) else self.stage(step)

    def stage(self, step: Stage) -> Stage:
        """The differential of a stage; a short form is proved against the chain rule first."""
        chains = [differential(expression, self.rules) for _, expression in step.sets]
        results = self._proved(step, chains) if step.short else chains
        d = self.d
        sets = tuple((d(q), e) for (q, _), e in zip(step.sets, results, strict=True))
        adds = tuple((d(q), differential(e, self.rules)) for q, e in step.adds)
        for quantity, _ in (*step.sets, *step.adds):
            self.move(quantity)
        return Stage(self.title + step.title, step.over, sets, adds,
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
        d_unknown = self.d(step.unknown)
        sums = tuple(Sum(part.over, solve_matrix(step, part) * d_unknown.symbols
                         + differential(part.summand, self.rules)) for part in step.sums)
        constant = differential(step.constant, self.rules)
        self.move(step.unknown)
        return Solve(self.title + step.title, d_unknown, sums, constant, step.inverse,
                     step.transposed)


def along_own(space: Space, quantity: Quantity) -> Rules:
    """Rules that move a quantity along its own differential."""
    return along(quantity.symbols, space.d(quantity).symbols)
