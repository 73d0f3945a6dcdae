"""Scratch rows and functions that kernels use, as their steps and expressions report them."""

from collections.abc import Iterable
from typing import NamedTuple

import sympy as sp

from sebody.derive.formulas.elements import Element
from sebody.derive.kernels.body_load import BodyLoad
from sebody.derive.kernels.superelement import Superelement
from sebody.derive.symbolic.steps import Step, Uses, united
from sebody.kernels.layout import DAMPING_CONSTANTS, MOST_SLAVED, SUPERELEMENT_CONSTANTS

STATE = "qe", "ve", "ae"                # gathered before the steps
DIRECTIONS = "dqe", "dve", "dae"        # of a column of the matrix, set before its steps
GIVEN = {"R", "field", "frame", "g", "nodes", "reference", "N_POSITIONS", "N_ROTATIONS"}


# arrays of option C: a row for each slaved coordinate, or component of a product with z
TALL = {"Zq": MOST_SLAVED, "Zd": MOST_SLAVED, "Za": MOST_SLAVED, "products": 15, "more": 12,
        "unordered": 3}
SQUARES = "Lz", "Lv", "La", "Gy"


class Resources(NamedTuple):
    """What the file of a kernel provides for its steps."""

    rows: tuple[str, ...]       # scratch memory, in the order of first use
    calls: tuple[str, ...]
    pointers: tuple[str, ...] = ()      # into the arguments
    tall: tuple[str, ...] = ()          # of many rows each, see `TALL`
    squares: tuple[str, ...] = ()       # of as many rows as coordinates
    of_matrix: frozenset[str] = frozenset()     # scratch memory that the matrix alone needs


def resources(kernel: Superelement) -> Resources:
    """Collect what the steps report."""
    def used(steps: Iterable[Step]) -> Uses:
        return united(step.uses(kernel.space, kernel.names) for step in steps)
    forces = used((*kernel.residual, *kernel.energy))
    column = used((*kernel.prepared, *kernel.tangent))
    provided = GIVEN | {part.name for part in (*SUPERELEMENT_CONSTANTS, *DAMPING_CONSTANTS,
                                               *kernel.declared)}
    rows = dict.fromkeys((*STATE, *forces.arrays, *DIRECTIONS, *column.arrays))
    scratch = [row for row in rows if row not in provided]
    return Resources(tuple(row for row in scratch if row not in (*TALL, *SQUARES)),
                     tuple(dict.fromkeys((*forces.calls, *column.calls))),
                     tuple(row for row in rows if row in GIVEN),
                     tuple(row for row in scratch if row in TALL),
                     tuple(row for row in scratch if row in SQUARES),
                     frozenset(scratch) - {*STATE, *forces.arrays})


def body_load_resources(kernel: BodyLoad) -> Resources:
    """The same of a load on a body, whose forces know no accelerations."""
    used = united(step.uses(kernel.space, kernel.names)
                  for step in (*kernel.residual, *kernel.prepared, *kernel.tangent))
    provided = GIVEN | {part.name for part in kernel.constants} | {"loads"}
    rows = dict.fromkeys((*STATE[:2], *used.arrays, DIRECTIONS[0]))
    return Resources(tuple(row for row in rows if row not in provided), used.calls,
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
