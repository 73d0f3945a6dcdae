"""Transposed products: the steps of a linear program, read backwards.

A column of a matrix is a linear program: from directions of the unknowns to changes of the forces,
``dg = J dq``, with everything else of the kernel as coefficients. For the *bar* of a number, by
which something else changes with it, the same steps give ``bar(dq) += J^T bar(dg)``: each step adds
to the bars of what it read, in the reverse order, what it has from those of what it wrote.

==============================================  ===================================================
step                                            its transpose
==============================================  ===================================================
``o = sum c_i i``, also summed over nodes       ``bar(i) += c_i bar(o)`` in the same loop
``sum_j (B_j u + r_j) = 0``                     ``B^T m = bar(u)``, then r_j as in a sum, times -m
products with a matrix                          products with its transpose
``to += what``, factors                         ``bar(what) += bar(to)``, the same factors
==============================================  ===================================================

A number that is written twice loses its bar where it is overwritten.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from math import inf
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, View, array_of
from sebody.derive.form.counts import padded, row
from sebody.derive.form.functions import (
    ADD_ROWS_TIMES,
    CLEAR,
    Use,
)
from sebody.derive.form.loops import ELEMENT
from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.steps import (
    Call,
    Damping,
    Product,
    Scaling,
    Shift,
    Solve,
    Stage,
    Step,
    Sum,
    call,
)
from sebody.derive.form.whole import Whole
from sebody.derive.passes.transposes import TRANSPOSES, bar_array
from sebody.derive.symbolic.variation import DerivationError

TITLE = "transposed: "


class Reversed(NamedTuple):
    """A program read backwards."""

    clear: tuple[Step, ...]     # of all bars, before anything is added to them
    steps: tuple[Step, ...]


def transposed_forms(values: Iterable[sp.Expr], bars: Iterable[sp.Expr],
                     inputs: Iterable[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    """The bars that linear forms give to their inputs; inputs without any are left out.

    Raises
    ------
    DerivationError
        A value that is not linear in the inputs.
    """
    inputs, given = tuple(inputs), {}
    for value, bar in zip(map(sp.sympify, values), bars, strict=True):
        read = [s for s in inputs if s in value.free_symbols]
        if read and _degree(value, frozenset(read)) != 1:
            raise DerivationError(f"{value} is not linear in {', '.join(map(str, read))}, so it "
                                  "has no transpose")
        nothing = dict.fromkeys(read, sp.S.Zero)
        for s in read:      # a linear form's slope is its value at one: far quicker than by diff
            slope = value.xreplace(nothing | {s: sp.S.One})
            given[s] = given.get(s, sp.S.Zero) + slope * bar
    return given


@cache
def _degree(value: sp.Expr, inputs: frozenset[sp.Symbol]) -> float:
    """Degree of a polynomial in some symbols; infinite if it is none, or has terms of others."""
    if not value.free_symbols & inputs:
        return 0
    if value in inputs:
        return 1
    degrees = [_degree(part, inputs) for part in value.args]
    if value.is_Add:
        return degrees[0] if len(set(degrees)) == 1 else inf
    return sum(degrees) if value.is_Mul else inf


class Reversal:
    """Reads the steps of a column backwards.

    Parameters
    ----------
    space : Space
        Of the kernel; the bars are declared in it.
    steps : iterable of Step
        A linear program.
    inputs : iterable of Array
        Arrays of the directions.
    transposes : dict
        Constants that are stored beside their transpose, by each other.
    """

    def __init__(self, space: Space, steps: Iterable[Step], inputs: Iterable[Array],
                 transposes: Mapping[Array, Array]):
        self.space, self.steps, self.transposes = space, tuple(steps), transposes
        written = list(_written(self.steps))
        self.overwritten = Counter(key for key, whole in written if whole)
        names = {key for key, _ in written if isinstance(key, str)}
        self.arrays = list(dict.fromkeys((
            *inputs, *(key for key, _ in written if isinstance(key, Array)))))
        self.varied = {s: quantity for quantity in space.known.values()
                       if quantity.array in self.arrays or quantity.name in names
                       for s in quantity.kept}

    def reversed(self) -> Reversed:
        """The transposed program.

        Raises
        ------
        DerivationError
            A step without a transpose.
        """
        steps = tuple(self._all(self.steps))
        local = dict.fromkeys(q.name for q in self.varied.values() if not q.array)
        bars = [self.bar(self.space.known[name]) for name in local]
        return Reversed((
            *(call("bars", CLEAR, bar_array(array), _length(array)) for array in self.arrays),
            Stage("bars", ELEMENT, sets=tuple((q, sp.zeros(*q.symbols.shape)) for q in bars))),
            steps)

    def _all(self, steps: Iterable[Step]) -> Iterator[Step]:
        kinds = {Stage: self._stage, Solve: self._solve, Product: self._product,
                 Shift: self._shift, Scaling: self._scaling, Damping: self._damping,
                 Call: self._call}
        for step in reversed(tuple(steps)):
            if type(step) not in kinds:
                raise DerivationError(f"step {step.title!r} has no transpose")
            yield from kinds[type(step)](step)

    def bar(self, quantity: Quantity) -> Quantity:
        """The bar of a quantity."""
        array = quantity.array and bar_array(quantity.array)
        return self.space.quantity("b" + quantity.name, quantity.kind, quantity.home, array,
                                   quantity.place)

    def bar_of(self, symbol: sp.Symbol) -> sp.Symbol:
        """The bar of a component."""
        quantity = self.varied[symbol]
        return self.bar(quantity).kept[quantity.kept.index(symbol)]

    def _stage(self, step: Stage) -> Iterator[Step]:
        entries = step.entries(self.space)
        bars = transposed_forms([e.value for e in entries],
                                [self.bar_of(e.symbol) for e in entries], self.varied)
        for s in (e.symbol for e in entries if not e.adds and e.symbol in bars):
            if sp.expand(bars.pop(s) - self.bar_of(s)) != 0:
                raise DerivationError(f"step {step.title!r} changes {s} by itself other than by "
                                      "adding to it, so it has no transpose")
        yield from self._added(step.title, step.over, bars)
        in_place = {s for e in entries if not e.adds for s in sp.sympify(e.value).free_symbols}
        if not step.continues:
            yield from self._consumed(step, [q for q, _ in (*step.sets, *step.adds)
                                             if not in_place & set(q.kept)])

    def _added(self, title: str, over: str, found: Mapping[sp.Symbol, sp.Expr]) -> Iterator[Stage]:
        """Numbers added to bars of quantities, component by component."""
        quantities = {self.varied[s].name: self.varied[s] for s in found}
        adds = tuple((self.bar(q), q.symbols.applyfunc(lambda s: found.get(s, sp.S.Zero)))
                     for q in quantities.values())
        if adds:
            yield Stage(TITLE + title, over, adds=adds, continues=True)

    def _consumed(self, step: Step, quantities: Iterable[Quantity]) -> Iterator[Stage]:
        """Bars of what was written before the step, too, begin anew there."""
        again = [q for q in quantities if self.overwritten[q.name] > 1
                 or self.overwritten[q.array]]
        for home in dict.fromkeys(q.home for q in again):
            yield Stage("overwritten: " + step.title, home, sets=tuple(
                (self.bar(q), sp.zeros(*q.symbols.shape)) for q in again if q.home == home))

    def _solve(self, step: Solve) -> Iterator[Step]:
        bar = self.bar(step.unknown)
        pulled = self.space.quantity("m" + step.unknown.name, bar.kind, ELEMENT)
        none, m = sp.zeros(3, 1), [-s for s in pulled.kept]
        yield Solve(TITLE + step.title, pulled, (Sum(ELEMENT, none),), -bar.symbols, step.inverse,
                    not step.transposed)
        constant = self.space.components("axial", step.constant)
        nodes = [(part.over, [-e for e in step.right_side(part, self.space)])
                 for part in step.sums]
        for over, values in (*nodes, (ELEMENT, constant)):
            yield from self._added(step.title, over, transposed_forms(values, m, self.varied))
        yield from self._consumed(step, [step.unknown])

    def _product(self, step: Product) -> Iterator[Step]:
        yield call(TITLE + step.title, ADD_ROWS_TIMES, step.matrix, bar_array(step.out),
                   bar_array(step.vector), step.rows, step.columns, padded(step.rows), products=1)
        yield from self._cleared(step.title, step.out, step.rows)

    def _shift(self, step: Shift) -> Iterator[Step]:
        yield Shift(TITLE + step.title, bar_array(step.what), bar_array(step.to), step.adds)

    def _scaling(self, step: Scaling) -> Iterator[Step]:
        yield Scaling(TITLE + step.title, tuple(map(bar_array, step.rows)),
                      tuple(map(self.bar, step.quantities)), step.factor)

    def _damping(self, step: Damping) -> Iterator[Step]:
        yield Damping(TITLE + step.title, tuple(self._all(step.steps)))

    def _call(self, step: Call) -> Iterator[Step]:
        if step.function not in TRANSPOSES:
            raise DerivationError(f"step {step.title!r} calls {step.function.name}, of which no "
                                  "transpose is known: add it to TRANSPOSES")
        known = TRANSPOSES[step.function]
        for transposed in known.steps(*step.operands, self.transposes):
            yield transposed._replace(title=TITLE + step.title)
        for (_, use), operand in zip(step.function.operands, step.operands, strict=True):
            if use is Use.WRITE:
                yield from self._cleared(step.title, operand, known.length(*step.operands))

    def _cleared(self, title: str, out: Array | View, length: Whole) -> Iterator[Step]:
        """Bars of numbers that were written before, too, begin anew."""
        if self.overwritten[array_of(out)] > 1:
            yield call("overwritten: " + title, CLEAR, bar_array(out), length)


def _length(array: Array) -> Whole:
    """Numbers of an array of scratch memory."""
    return row if len(array.shape) == 1 else array.shape[0] * row


def _written(steps: Iterable[Step]) -> Iterator[tuple[str | Array, bool]]:
    """Arrays and names of quantities that steps write, and whether nothing is left of them."""
    for step in steps:
        match step:
            case Stage():
                for q, _ in (*step.sets, *step.adds):
                    yield q.name, not step.continues
                    if q.array:
                        yield q.array, False
            case Solve():
                yield step.unknown.name, True
            case Product():
                yield step.out, True
            case Shift():
                yield step.to, False
            case Damping():
                yield from _written(step.steps)
            case Call():
                for (_, use), operand in zip(step.function.operands, step.operands, strict=True):
                    if use in (Use.WRITE, Use.ADD):
                        yield array_of(operand), use is Use.WRITE
