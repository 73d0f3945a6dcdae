"""Scratch rows and functions that kernels use, as their steps and expressions report them."""

from collections.abc import Iterable
from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.elements import Element
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.symbolic.steps import Step, Uses, united
from sebody.kernels.layout import DAMPING_CONSTANTS, SUPERELEMENT_CONSTANTS

STATE = "qe", "ve", "ae"                # gathered before the steps
DIRECTIONS = "dqe", "dve", "dae"        # of a column of the matrix, set before its steps
GIVEN = {"R", "field", "frame", "g", "nodes", "reference", "N_POSITIONS", "N_ROTATIONS"}


class Resources(NamedTuple):
    """What the file of a kernel provides for its steps."""

    rows: tuple[str, ...]       # scratch memory, in the order of first use
    calls: tuple[str, ...]
    pointers: tuple[str, ...] = ()      # into the arguments


def resources(kernel: Superelement) -> Resources:
    """Collect what the steps report."""
    def used(steps: Iterable[Step]) -> Uses:
        return united(step.uses(kernel.space, kernel.names) for step in steps)
    forces, column = used((*kernel.residual, *kernel.energy)), used(kernel.tangent)
    provided = GIVEN | {part.name for part in (*SUPERELEMENT_CONSTANTS, *DAMPING_CONSTANTS,
                                               *kernel.declared)}
    rows = dict.fromkeys((*STATE, *forces.arrays, *DIRECTIONS, *column.arrays))
    return Resources(tuple(row for row in rows if row not in provided),
                     tuple(dict.fromkeys((*forces.calls, *column.calls))),
                     tuple(row for row in rows if row in GIVEN))


def element_resources(element: Element) -> Resources:
    """Directions of a column, and functions of the standard library."""
    symbols = set().union(*(sp.sympify(e).free_symbols for e in element.linear))
    varied = {s for block in element.blocks for s in block.unit.kept} & symbols
    functions = set().union(*map(_functions, (*element.printed, *element.on_multipliers)))
    if element.space.planar:    # entries of a rotation are made of its angle
        used = set().union(*(sp.sympify(e).free_symbols for e in element.printed))
        entries = [block.state.kept for block in element.blocks if block.rotational]
        functions |= {f for kept in entries for f, s in zip(("cos", "sin"), kept, strict=True)
                      if s in used}
    return Resources(("dq", "du") if varied else ("dq",), tuple(sorted(functions)))


def _functions(expression: sp.Expr) -> set[str]:
    expression = sp.sympify(expression)
    roots = any(abs(p.exp) == sp.Rational(1, 2) for p in expression.atoms(sp.Pow))
    functions = {type(f).__name__ for f in expression.atoms(sp.Function)}
    return functions | ({"sqrt"} if roots else set())
