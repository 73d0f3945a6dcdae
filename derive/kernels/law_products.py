"""Products with the derivatives of the forces of laws: friction, contacts, stops and gears.

These elements keep numbers from step to step, so what a step does to them is differentiated, too:
forces g and numbers m' depend on the motion, on the numbers m of the step before and, where a body
rolls or turns on a ball, on the increments psi of rotations in the step.

=============  ===================================================================================
PREPARE        forces g, and the numbers m'
ALONG          changes of g and m' by those of the motion, of m, psi and the constants
TRANSPOSED     with weights of g and m': what they give to motion, m and psi
=============  ===================================================================================

Vectors of the unknowns are those of `products`. At the begin of the scratch memory are changes, or
bars, of m; changes, or weights, of m'; changes, or bars, of psi, three numbers for each rotation in
space; changes of the constants. Derivatives are those of the branch that a law has taken.

A law is a chain of stages. Changes follow the chain; bars go back along it, from the forces.
"""

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp

from sebody.contract.names import element_name, products_name
from sebody.derive.form import counts
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.statements import For, If, Point, Return, Set, Statement, compared
from sebody.derive.form.whole import Number
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elements import Element, Stage, choose, configuration, kept
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.element_form import (
    counted,
    known_counts,
    loads,
    memory_place,
    places,
    staged,
    stored,
)
from sebody.derive.kernels.products import KEPT, ROWS, VECTORS
from sebody.derive.passes.reverse import transposed_forms
from sebody.derive.passes.unused import without_unused
from sebody.derive.symbolic.variation import Rules, along, differential


class Changes(NamedTuple):
    """Linear forms: what a chain of stages, forces and kept numbers change by."""

    inputs: tuple[tuple[sp.Symbol, sp.Expr], ...]   # and where each is read, in ALONG
    bars: tuple[tuple[sp.Symbol, sp.Expr], ...]     # where bars are written, in TRANSPOSED
    stages: tuple[Stage, ...]       # of each symbol its change
    forces: tuple[sp.Expr, ...]
    memory: tuple[sp.Expr, ...]


def products_law(element: Element) -> Kernel:
    """Products of an element of laws."""
    changes, width = _changes(element), len(element.residual)
    element = element._replace(slopes=(), moves=(), linear=())
    stages, count = staged(element.stages, 0)
    memory = range(len(element.memory))
    after = [*(VECTORS[k] for k in range(width)), *(KEPT[len(memory) + k] for k in memory)]
    residual, _ = stored(
        [*element.residual, *(value for _, value in element.memory)],
        [*(arrays.g[k] for k in range(width)),
         *(ARGUMENTS["frames"][memory_place(k)] for k in memory)], count)
    of_element = without_unused((
        *places(element), Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.WIDTH)),
        Point(VECTORS, ARGUMENTS["matrices"].at(ROWS * (counts.element * counts.WIDTH))),
        Point(KEPT, ARGUMENTS["work"]), *loads(element), *stages,
        If(compared(counts.task, "==", agreed("PREPARE")), tuple(residual)),
        If(compared(counts.task, "==", agreed("ALONG")), _along(changes, after, count)),
        If(compared(counts.task, "==", agreed("TRANSPOSED")), _back(changes, after, count))))
    body = (For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(products_name(element_name(element.name)), body, known_counts(element), 0, 0,
                  counted(element.residual), counted(changes.forces), room(element))


def room(element: Element) -> int:
    """Numbers at the begin of the scratch memory."""
    turns = sum(block.rotational for block in element.blocks) * (not element.space.planar)
    constants = sum(len(quantity.kept) for quantity, _ in element.constants)
    return 2 * len(element.memory) + 3 * turns + constants


def _changes(element: Element) -> Changes:
    """Forms of all stages, one after the other."""
    inputs, bars, rules = _inputs(element)
    stages = []
    for stage in element.stages:
        forms = tuple((symbol, form) for symbol, value in stage
                      if (form := _form(value, rules)) != 0)
        rules |= {symbol: _delta(symbol) for symbol, _ in forms}
        stages.append(forms)
    forces = tuple(_form(value, rules) for value in element.residual)
    memory = tuple(_form(value, rules) for _, value in element.memory)
    return Changes(tuple(inputs), tuple(bars), tuple(stages), forces, memory)


def _form(value: sp.Expr, rules: Rules) -> sp.Expr:
    """The differential, linear as it stands: a choice is one of slopes."""
    value = sp.sympify(value)
    if not value.has(choose):
        return differential(value, rules)
    moved = sorted(value.free_symbols & rules.keys(), key=str)
    return sum((value.diff(s) * rules[s] for s in moved), sp.S.Zero)


def _delta(symbol: sp.Symbol) -> sp.Symbol:
    """The change of a symbol."""
    return sp.Symbol(f"delta_{symbol}")


def _inputs(element: Element) -> tuple[list, list, Rules]:
    """Symbols of what may change, their places, and the rules of the differential."""
    rules = configuration(element.blocks, "direction")
    inputs, bars, at, turns = [], [], 0, 0
    width, memory = len(element.residual), len(element.memory)
    for block in element.blocks:
        rules |= along(block.rate.symbols, block.unit.symbols)
        for row, quantity in ((1, block.direction), (2, block.unit)):
            own = [(s, VECTORS[row * width + at + k]) for k, s in enumerate(quantity.kept)]
            inputs, bars = inputs + own, bars + own
        at += len(block.direction.kept)
        if block.rotational and not element.space.planar:
            psi = [_delta(s) for s in block.increment.symbols]
            rules |= along(block.increment.symbols, sp.Matrix(psi))
            own = [(s, KEPT[2 * memory + 3 * turns + k]) for k, s in enumerate(psi)]
            inputs, bars, turns = inputs + own, bars + own, turns + 1
    more = [(s, VECTORS[width + at + k]) for k, s in enumerate(element.reads)]
    more += [(kept(name), KEPT[k]) for k, (name, _) in enumerate(element.memory)]
    constants = [s for quantity, _ in element.constants for s in quantity.kept]
    given = [(s, KEPT[2 * memory + 3 * turns + k]) for k, s in enumerate(constants)]
    rules |= {s: _delta(s) for s, _ in (*more, *given)}
    inputs += [(rules[s], place) for s, place in (*more, *given)]
    bars += [(rules[s], place) for s, place in more]
    return inputs, bars, rules


def _along(changes: Changes, after: Sequence[sp.Expr], count: int) -> tuple[Statement, ...]:
    """Changes along the chain."""
    stages, count = staged([[(_delta(s), form) for s, form in stage] for stage in changes.stages],
                           count)
    results, _ = stored([*changes.forces, *changes.memory], after, count)
    return (*(Set((s,), (place,)) for s, place in changes.inputs), *stages, *results)


def _back(changes: Changes, after: Sequence[sp.Expr], count: int) -> tuple[Statement, ...]:
    """Bars back along the chain, each complete before it is given on; no others depend on a law."""
    moved = [s for s, _ in changes.inputs]
    moved += [_delta(s) for stage in changes.stages for s, _ in stage]
    bars = transposed_forms([*changes.forces, *changes.memory], after, moved)
    back: list[Stage] = []
    for stage in reversed(changes.stages):
        own = [(sp.Symbol(f"bar_{s}"), form, bars[_delta(s)]) for s, form in stage
               if _delta(s) in bars]
        back.append(tuple((name, bar) for name, _, bar in own))
        more = transposed_forms([form for _, form, _ in own], [name for name, _, _ in own], moved)
        for s, bar in more.items():
            bars[s] = bars.get(s, sp.S.Zero) + bar
    stages, count = staged(back, count)
    results, _ = stored([bars.get(s, sp.S.Zero) for s, _ in changes.bars],
                        [place for _, place in changes.bars], count)
    width, given = len(changes.forces), {place for _, place in changes.bars}
    others = [VECTORS[k] for k in range(width, ROWS * width) if VECTORS[k] not in given]
    return (*stages, *results, *(Set((place,), (sp.S.Zero,)) for place in others))
