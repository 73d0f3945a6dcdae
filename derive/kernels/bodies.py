"""Surroundings of the steps of bodies: counts, pointers, gathering, columns of the matrix.
"""

import sympy as sp

from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, pointed
from sebody.derive.form.counts import agreed
from sebody.derive.form.functions import OPAQUE
from sebody.derive.form.loops import size_of
from sebody.derive.form.statements import (
    Change,
    For,
    If,
    Let,
    Point,
    Remark,
    Set,
    Statement,
    Update,
    compared,
)
from sebody.derive.form.whole import Applied, Number, Quotient, Whole, whole
from sebody.derive.formulas import arrays
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.layouts import Layout

STATE = arrays.qe, arrays.ve, arrays.ae             # gathered before the steps
DIRECTIONS = arrays.qe.d, arrays.ve.d, arrays.ae.d  # of a column of the matrix
FACTORS = sp.symbols("c_stiffness c_damping c_mass")    # of these directions
MATRIX = pointed("J")


def read_counts(layout: Layout) -> tuple[Let, ...]:
    """Counts that are not known beforehand: those of the first element, as all of a batch have."""
    index, planar = ARGUMENTS["index"], layout.planar
    values = {
        counts.POSITIONS: index[agreed("AT_POSITIONS")],
        counts.ROTATIONS: index[agreed("AT_ROTATIONS")],
        counts.FIRST_ROTATION: size_of("position", planar) * counts.POSITIONS,
        counts.FIRST_MODE: counts.FIRST_ROTATION + size_of("rotation", planar) * counts.ROTATIONS}
    return tuple(Let((name,), (value,)) for name, value in values.items()
                 if known_counts(layout)[name] is None)


def known_counts(layout: Layout) -> dict:
    """Counts that a layout knows beforehand; None for those that are read."""
    return {counts.POSITIONS: layout.positions, counts.ROTATIONS: layout.rotations,
            counts.FIRST_ROTATION: layout.first_rotation, counts.FIRST_MODE: layout.first_mode}


def opaque(number: counts.Count) -> Applied:
    """A number that the compiler is to know nothing of."""
    return Applied(OPAQUE, (number,))


def pointers(reference: bool) -> tuple[Statement, ...]:
    """Places of an element's frame, nodes and unknowns; of the frame of the last step if asked."""
    index = ARGUMENTS["index"]
    frame = 9 * index[counts.first + agreed("AT_FRAME")]
    statements = [Let((counts.first,), (counts.element * counts.stride,)),
                  Point(arrays.frame, ARGUMENTS["frames"].at(frame))]
    if reference:
        statements.append(Point(arrays.reference, ARGUMENTS["references"].at(frame)))
    return (*statements, Point(arrays.nodes, index.at(counts.first + agreed("HEADER"))),
            Point(arrays.unknowns, arrays.nodes.at(counts.ROTATIONS)))


def gathered(rows: tuple[Array, ...], size: Whole = counts.n) -> For:
    """The state of the element in rows of its own."""
    given = (ARGUMENTS[name] for name in ("q", "v", "a"))
    return For(counts.i, Number(0), size, tuple(
        Set((row[counts.i],), (of[arrays.unknowns[counts.i]],))
        for row, of in zip(rows, given, strict=False)))


def columns(planar: bool, directions: tuple[Array, ...], steps: tuple[Statement, ...],
            size: Whole = counts.n) -> For:
    """Columns of the matrix: directions set, the steps, and what they leave in `dg` kept."""
    i, column = counts.i, counts.column
    clear = For(i, Number(0), size, tuple(
        Set((row[i],), (sp.Float(0.0),)) for row in directions))
    keep = For(i, Number(0), size, (
        Set((MATRIX[i * size + column],), (arrays.g.d[i],)),))
    return For(column, Number(0), size,
               (clear, *_seeds(planar, directions), *steps, keep))


def _seeds(planar: bool, directions: tuple[Array, ...]) -> tuple[Statement, ...]:
    """Directions of a column; positions in axes of the frame, where the matrix hardly changes."""
    column, begin, j, k, r = (counts.column, counts.FIRST_ROTATION, counts.j, counts.k, counts.r)
    of_state, *others = directions
    factor, *factors = FACTORS
    rest = tuple(Set((row[column],), (c,)) for row, c in zip(others, factors, strict=False))
    plain = Set((of_state[column],), (factor,))
    if planar:
        return (plain, *rest)
    tangent = ARGUMENTS["T"][9 * arrays.nodes[j] + 3 * r + k]
    turned = (
        Remark("the unknown of a rotation is the increment of the step, varied through T"),
        Let((j,), (Quotient(column - begin, whole(3)),)),
        Let((k,), (column - begin - 3 * j,)),
        For(r, Number(0), Number(3), (Set((of_state[begin + 3 * j + r],), (factor * tangent,)),)))
    return (If(compared(begin, "<=", column, "<", counts.FIRST_MODE), turned, (plain,)), *rest)


def port() -> Whole:
    """The place of an element's power among the energies."""
    return agreed("POWERS") + ARGUMENTS["index"][counts.first + agreed("AT_PORT")]


def power_of_forces() -> tuple[Statement, ...]:
    """Power of the forces on the system."""
    power, i = sp.Symbol("power"), counts.i
    return (Set((power,), (sp.S.Zero,)),
            For(i, Number(0), counts.n, (
                Update(power, Change.SUBTRACT, arrays.g[i] * arrays.ve[i]),)),
            Set((ARGUMENTS["energies"][port()],), (power,)))
