"""The statements of the kernel of a joint, rigid body or force: everything in components."""

from collections.abc import Iterable, Sequence

import sympy as sp

from sebody.contract.names import element_name
from sebody.derive.form import counts
from sebody.derive.form.arrays import pointed, scratch
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel, Operations
from sebody.derive.form.statements import (
    Change,
    For,
    If,
    Let,
    Point,
    Return,
    Set,
    Statement,
    Target,
    Update,
    compared,
)
from sebody.derive.form.whole import Number, Quotient, Whole, whole
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elements import AMPLITUDE, Block, Element, Stage, kept, whole_turns
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import MATRIX, port
from sebody.derive.passes.unused import without_unused

SUMS = {"kinetic": ("KINETIC", 0), "strain": ("STRAIN", 0), "potential": ("POTENTIAL", 0),
        "P_x": ("MOMENTUM", 0), "P_y": ("MOMENTUM", 1), "P_z": ("MOMENTUM", 2),
        "H_x": ("MOMENT", 0), "H_y": ("MOMENT", 1), "H_z": ("MOMENT", 2)}     # among the energies
COEFFICIENTS = {sp.Symbol(name): agreed(place) for name, place in (
    ("c_mass", "C_MASS"), ("c_damping", "C_DAMPING"), ("c_stiffness", "C_STIFFNESS"),
    ("c_constraint", "C_CONSTRAINT"))}
C_CONSTRAINT = sp.Symbol("c_constraint")
CONSTANT = pointed("constant")
DIRECTION, UNIT = scratch("dq"), scratch("du")      # of a column: of states, and of their rates
ONE, ZERO = sp.Float(1.0), sp.S.Zero
# numbers of the first temporaries of tasks and of the multipliers' columns: names used once
OF_TASKS, OF_MULTIPLIERS = 900, 700


def element_form(element: Element) -> Kernel:
    """The kernel as statements."""
    stages, count = staged(element.stages, 0)
    memory = [value for _, value in element.memory]
    residual, count = stored(
        [*element.residual, *memory],
        [*(arrays.g[k] for k in range(len(element.residual))),
         *(ARGUMENTS["frames"][memory_place(k)] for k in range(len(memory)))], count)
    of_element = (
        *places(element), Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.WIDTH)),
        *loads(element), *stages, *residual, *_tasks(element),
        If(compared(counts.task, "==", agreed("TANGENT")), _matrix(element, count)))
    body = (For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(element_name(element.name), body, known_counts(element), 2, 0,
                  counted(element.residual), counted(element.linear))


def places(element: Element) -> tuple[Statement, ...]:
    """The places of an element's nodes, unknowns and constants."""
    index, first = ARGUMENTS["index"], counts.first
    constants = ARGUMENTS["constants"].at(index[first + agreed("AT_CONSTANTS")])
    return (Let((first,), (counts.element * counts.stride,)),
            Point(arrays.nodes, index.at(first + agreed("HEADER"))),
            Point(arrays.unknowns, arrays.nodes.at(counts.ROTATIONS)),
            *([Point(CONSTANT, constants)] if element.constants else ()))


def known_counts(element: Element) -> dict[counts.Count, int]:
    """Counts of a joint are known."""
    positions = [block for block in element.blocks if not block.rotational]
    return {counts.POSITIONS: len(positions), counts.ROTATIONS: _matrices(element),
            counts.FIRST_ROTATION: sum(len(block.direction.kept) for block in positions),
            counts.WIDTH: len(element.residual)}


def _matrices(element: Element) -> int:
    """Rotation matrices it reads; in a plane there are angles instead."""
    return 0 if element.space.planar else sum(b.rotational for b in element.blocks)


def counted(expressions: Iterable[sp.Expr]) -> Operations:
    """Arithmetic of some expressions."""
    temporaries, reduced = sp.cse(list(expressions), order="canonical")
    return Operations(sum(int(sp.count_ops(e)) for e in [v for _, v in temporaries]
                          + list(reduced)), 0, 0, 0)


def memory_place(k: int) -> Whole:
    """Place of a number that an element keeps from step to step."""
    return ARGUMENTS["index"][counts.first + agreed("AT_FRAME")] + k


def staged(stages: Iterable[Stage], start: int) -> tuple[list[Statement], int]:
    """Stages one after the other, and the number of the next temporary."""
    statements: list[Statement] = []
    for stage in stages:
        lines, start = stored([value for _, value in stage], [name for name, _ in stage], start)
        statements += lines
    return statements, start


def stored(expressions: Iterable[sp.Expr], targets: Sequence[Target], start: int,
           change: Change | None = None) -> tuple[list[Statement], int]:
    """Values in targets, and the number of the next temporary."""
    temporaries, reduced = sp.cse(map(whole_turns, expressions),
                                  sp.numbered_symbols("t", start=start),
                                  order="canonical")
    statements: list[Statement] = [Set((name,), (value,)) for name, value in _used(temporaries,
                                                                                   reduced)]
    statements += [Update(target, change, value) if change else Set((target,), (value,))
                   for target, value in zip(targets, reduced, strict=True)]
    return statements, start + len(temporaries)


def _used(temporaries: Sequence[tuple[sp.Symbol, sp.Expr]], reduced: Sequence[sp.Expr]
          ) -> list[tuple[sp.Symbol, sp.Expr]]:
    """Common subexpressions without those that nothing reads: terms that use them may cancel."""
    read, kept = used_symbols(reduced), []
    for name, value in reversed(temporaries):
        if name in read:
            read |= value.free_symbols
            kept.append((name, value))
    return kept[::-1]


def _task(name: str, expressions: Sequence[sp.Expr], targets: Sequence[Target],
          change: Change | None = None) -> list[If]:
    """Statements of a task, with temporaries of their own."""
    if not expressions:
        return []
    body, _ = stored(expressions, targets, OF_TASKS, change)
    return [If(compared(counts.task, "==", agreed(name)), without_unused(body))]


def _tasks(element: Element) -> list[If]:
    """Constraints differentiated in time; energies, power, and the forces that have this power."""
    energies = ARGUMENTS["energies"]
    constraints = [arrays.g[element.coordinates + k] for k in range(len(element.multipliers))]
    sums = [energies[agreed(place) + k] for place, k in (SUMS[name] for name in element.sums)]
    power = [] if element.power is None else [element.power]
    return [*_task("VELOCITY", element.velocity, constraints),
            *_task("ACCELERATION", element.second, constraints),
            *_task("ENERGY", list(element.sums.values()), sums, Change.ADD),
            *_task("ENERGY", power, [energies[port()]]),
            *_task("ENERGY", element.losses, [arrays.g[k] for k in range(len(element.losses))])]


def used_symbols(expressions: Iterable[sp.Expr]) -> set[sp.Symbol]:
    """Scalars in some expressions."""
    return set().union(*(sp.sympify(e).free_symbols for e in expressions))


def loads(element: Element) -> list[Statement]:
    """Local variables of the constants, the state and the multipliers."""
    used, q = used_symbols(element.printed), ARGUMENTS["q"]
    row = [s for quantity, _ in element.constants for s in quantity.kept]
    gravity = element.space.known.get("field")
    field = gravity.kept if gravity else []
    pairs = [(s, CONSTANT[k]) for k, s in enumerate(row) if s in used]
    pairs += [(s, ARGUMENTS["coefficients"][agreed("FIELD") + k]) for k, s in enumerate(field)
              if s in used]
    at, matrix = 0, 0
    for block in element.blocks:
        pairs += _state(block, at, matrix, used)
        for array, quantity in (("v", block.rate), ("a", block.acceleration),
                                *[("q", block.increment)] * block.rotational):
            pairs += [(s, ARGUMENTS[array][arrays.unknowns[at + k]])
                      for k, s in enumerate(quantity.kept) if s in used]
        at += len(block.direction.kept)
        matrix += block.rotational
    pairs += [(s, q[arrays.unknowns[element.coordinates + k]])
              for k, s in enumerate((*element.reads, *element.multipliers))]
    pairs += [(kept(name), ARGUMENTS["references"][memory_place(k)])
              for k, (name, _) in enumerate(element.memory) if kept(name) in used]
    # where another element keeps numbers stands behind the unknowns
    seen = arrays.unknowns[len(element.residual)]
    pairs += [(s, ARGUMENTS["frames"][seen + k]) for k, s in enumerate(element.sees)]
    amplitudes = 3 * ARGUMENTS["index"][counts.first + agreed("AT_PORT")]
    pairs += [(s, ARGUMENTS["loads"][amplitudes + k]) for k, s in enumerate(AMPLITUDE) if s in used]
    return [Set((s,), (value,)) for s, value in pairs]


def _state(block: Block, at: int, matrix: int, used: set) -> list[tuple[sp.Symbol, sp.Expr]]:
    kept, unknown = block.state.kept, ARGUMENTS["q"][arrays.unknowns[at]]
    if not block.rotational:
        places = [ARGUMENTS["q"][arrays.unknowns[at + k]] for k in range(len(kept))]
    elif block.angle is None:
        places = [ARGUMENTS["R"][9 * arrays.nodes[matrix] + k] for k in range(len(kept))]
    else:
        kept, places = [*kept, block.angle], [sp.cos(unknown), sp.sin(unknown), unknown]
    return [(s, place) for s, place in zip(kept, places, strict=True) if s in used]


def _matrix(element: Element, start: int) -> tuple[Statement, ...]:
    """Columns of the coordinates, then those of the multipliers."""
    width = len(element.residual)
    used = used_symbols([*element.linear, *(v for stage in element.moves for _, v in stage)])
    varied = bool(used & {s for block in element.blocks for s in block.unit.kept})
    rows = (DIRECTION, UNIT) if varied else (DIRECTION,)
    slopes, start = staged(element.slopes, start)
    moves, start = staged(element.moves, start)
    column, _ = stored(element.linear, [MATRIX[i * width + counts.column] for i in range(width)],
                        start)
    work, i = ARGUMENTS["work"], counts.i
    clear = For(i, Number(0), whole(element.coordinates),
                tuple(Set((row[i],), (ZERO,)) for row in rows))
    return (
        *tangent_coefficients(element),
        Point(MATRIX, ARGUMENTS["matrices"].at(counts.element * counts.WIDTH * counts.WIDTH)),
        *(Point(row, work.at(k * counts.WIDTH)) for k, row in enumerate(rows)), *slopes,
        For(counts.column, Number(0), whole(element.coordinates), (
            clear, *(Set((row[counts.column],), (ONE,)) for row in rows[1:]),
            *_seeds(element), *_directions(element, used), *moves, *column)),
        *_multiplier_columns(element))


def tangent_coefficients(element: Element) -> list[Set]:
    """Factors of the derivatives, those that a column uses."""
    used = used_symbols([*element.linear, *element.on_multipliers])
    used |= {C_CONSTRAINT} if element.multipliers or element.reads else set()
    return [Set((c,), (ARGUMENTS["coefficients"][place],)) for c, place in COEFFICIENTS.items()
            if c in used]


def _seeds(element: Element) -> tuple[Statement, ...]:
    """The direction of a column: of a rotation its variation goes through T."""
    first = known_counts(element)[counts.FIRST_ROTATION]
    column, j, r = counts.column, counts.j, counts.r
    plain = Set((DIRECTION[column],), (ONE,))
    if not _matrices(element):
        return (plain,)
    tangent = ARGUMENTS["T"][9 * arrays.nodes[j] + 3 * r + column - first - 3 * j]
    turned = (
        Let((j,), (Quotient(column - first, whole(3)),)),
        For(r, Number(0), Number(3), (
            Set((DIRECTION[whole(first) + 3 * j + r],), (tangent,)),)))
    return (If(compared(column, ">=", first), turned, (plain,)),) if first else turned


def _directions(element: Element, used: set) -> list[Set]:
    rows = []
    for array, quantities in ((DIRECTION, [block.direction for block in element.blocks]),
                              (UNIT, [block.unit for block in element.blocks])):
        kept = [s for quantity in quantities for s in quantity.kept]
        rows += [Set((s,), (array[k],)) for k, s in enumerate(kept) if s in used]
    return rows


def _multiplier_columns(element: Element) -> tuple[Statement, ...]:
    """Columns of the multipliers: the constraint gradient, or slopes, and zero below."""
    count, coordinates, width = (len(element.multipliers) + len(element.reads),
                                 element.coordinates, len(element.residual))
    entries = [(i * width + coordinates + k, C_CONSTRAINT * element.on_multipliers[i, k])
               for k in range(count) for i in range(coordinates)]
    statements, _ = stored([e for _, e in entries], [MATRIX[at] for at, _ in entries],
                           OF_MULTIPLIERS)
    return (*statements, *(Set((MATRIX[(coordinates + i) * width + coordinates + k],), (ZERO,))
                           for i in range(count) for k in range(count)))
