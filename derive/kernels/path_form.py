"""The statements of the kernel of a point on a path of a body, and of a node that turns with it.

The unknowns are those of the body, then the position of the point, or the angle of the node, and
the way, which the loops of the body do not see, and the multipliers.
"""

import sympy as sp

from sebody.derive.form import counts
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.loops import size_of
from sebody.derive.form.statements import (
    For,
    If,
    Let,
    Point,
    Return,
    Set,
    Statement,
    compared,
)
from sebody.derive.form.whole import Number, largest
from sebody.derive.formulas import arrays
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import (
    DIRECTIONS,
    FACTORS,
    MATRIX,
    STATE,
    columns,
    gathered,
    power_of_forces,
    read_counts,
)
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.memory import Memory, chain
from sebody.derive.kernels.path import BodyPath
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses

FORCE, CONSTRAINT = sp.symbols("c_force c_constraint")      # factors of forces, of equations


def path_form(kernel: BodyPath) -> Kernel:
    """The kernel as statements."""
    steps, planar = kernel.steps, kernel.layout.planar
    lowering = Lowering(steps.q.space, kernel.names)
    located, forces, rate, second, moved, turned = map(lowering.statements, steps[1:])
    own = _Own(kernel)
    tangent = (*own.directions(), *moved, *turned, *own.column())
    used = uses((*located, *forces, *rate, *second, *tangent)).arrays
    memory = Memory.of((*STATE, *used, DIRECTIONS[0]))
    matrix = If(compared(counts.task, "==", agreed("TANGENT")), (
        # directions are those of a unit: forces and equations have factors of their own
        Set(FACTORS[:1], (sp.Float(1.0),)),
        Set((FORCE, CONSTRAINT), tuple(ARGUMENTS["coefficients"][agreed(name)]
                                       for name in ("C_STIFFNESS", "C_CONSTRAINT"))),
        Point(MATRIX, ARGUMENTS["matrices"].at(counts.element * counts.width * counts.width)),
        columns(planar, DIRECTIONS[:1], tangent, counts.width)))
    of_element = (
        *_pointers(), *chain(kernel.constants, planar, {}),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.width)),
        gathered(STATE, counts.width), *own.loads(), *located, *forces, *own.stored(),
        If(compared(counts.task, ">=", agreed("VELOCITY")), (
            *rate, *own.equations("phid"), If(compared(counts.task, "==", agreed("ACCELERATION")), (
                *second, *own.equations("phidd"))))), matrix)
    body = (*_counts(planar, len(own.point)), *memory.points,
            For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(kernel.name, body, {}, memory.rows, memory.squares,
                  operations((*located, *forces)), operations(tangent))


def path_load_form(kernel: BodyPath) -> Kernel:
    """The kernel of forces that move along a path, whose unknowns are those of the body alone."""
    steps, planar, n = kernel.steps, kernel.layout.planar, counts.n
    lowering = Lowering(steps.q.space, kernel.names)
    residual, prepared, tangent = map(lowering.statements, steps[1:])
    used = uses((*residual, *prepared, *tangent)).arrays
    memory = Memory.of((*STATE[:2], *used, DIRECTIONS[0]))
    matrix = If(compared(counts.task, "==", agreed("TANGENT")), (
        Set((FACTORS[0],), (ARGUMENTS["coefficients"][agreed("C_STIFFNESS")],)),
        Point(MATRIX, ARGUMENTS["matrices"].at(counts.element * n * n)),
        *prepared, columns(planar, DIRECTIONS[:1], tangent)))
    of_element = (
        *_pointers(), *chain(kernel.constants, planar, {}),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * n)), gathered(STATE[:2]),
        *residual, If(compared(counts.task, "==", agreed("ENERGY")), power_of_forces()), matrix)
    body = (Let((n,), (counts.width,)), *read_counts(kernel.layout),
            Let((counts.row,), (counts.padded(largest(n, 9 * counts.ROTATIONS)),)),
            *memory.points,
            For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(kernel.name, body, {}, memory.rows, memory.squares, operations(residual),
                  operations(tangent))


def _counts(planar: bool, size: int) -> tuple[Let, ...]:
    """Counts of the body: point or angle, way and multipliers come behind its coordinates."""
    behind = 2 * size + 1
    return (Let((counts.n,), (counts.width - behind,)), *read_counts(Layout(None, planar)),
            Let((counts.row,), (counts.padded(largest(counts.width, 9 * counts.ROTATIONS)),)))


def _pointers() -> tuple[Statement, ...]:
    """Places of nodes, unknowns and frame, whose number stands behind the unknowns.

    ``AT_FRAME`` tells where the numbers are that the element keeps.
    """
    index = ARGUMENTS["index"]
    return (Let((counts.first,), (counts.element * counts.stride,)),
            Point(arrays.nodes, index.at(counts.first + agreed("HEADER"))),
            Point(arrays.unknowns, arrays.nodes.at(counts.ROTATIONS)),
            Point(arrays.frame, ARGUMENTS["frames"].at(9 * arrays.unknowns[counts.width])))


class _Own:
    """What comes behind the coordinates of the body, in components."""

    def __init__(self, kernel: BodyPath) -> None:
        self.axes = [f"_{axis}" for axis in "xyz"[:size_of("position", kernel.layout.planar)]]
        self.node, self.force, self.kept = ("xp", "vp", "ap"), "lam", ["tangent"]
        if kernel.turns:
            self.axes, self.force, self.kept = [""], "mu", []
            self.node = "theta", "thetad", "thetadd"
        size = len(self.axes)
        self.point = [counts.n + k for k in range(size)]
        self.way = counts.n + size
        self.multipliers = [counts.n + size + 1 + k for k in range(size)]

    def _vector(self, name: str) -> list[sp.Symbol]:
        return [sp.Symbol(name + axis) for axis in self.axes]

    def loads(self) -> tuple[Statement, ...]:
        """Position of the point or angle, the way, their rates, and the multipliers."""
        listed: list[Statement] = []
        for row, point, way in zip(STATE, self.node, ("way", "wayd", "waydd"),
                                   strict=True):
            listed += [Set((s,), (row[at],)) for s, at in zip(self._vector(point), self.point,
                                                              strict=True)]
            listed.append(Set((sp.Symbol(way),), (row[self.way],)))
        listed += [Set((s,), (arrays.qe[at],)) for s, at in zip(
            self._vector(self.force), self.multipliers, strict=True)]
        return tuple(listed)

    def stored(self) -> tuple[Statement, ...]:
        """Forces, the equations, and the tangent, which is kept."""
        kept = ARGUMENTS["index"][counts.first + agreed("AT_FRAME")]
        return (*self._forces(""), *self.equations("phi"),
                *(Set((ARGUMENTS["frames"][kept + k],), (s,))
                  for name in self.kept for k, s in enumerate(self._vector(name))))

    def equations(self, name: str) -> tuple[Statement, ...]:
        """The equations, or their rates."""
        return tuple(Set((arrays.g[at],), (s,)) for s, at in zip(
            self._vector(name), self.multipliers, strict=True))

    def directions(self) -> tuple[Statement, ...]:
        """Directions of a column in variables."""
        dqe = DIRECTIONS[0]
        return (*(Set((s,), (dqe[at],)) for s, at in zip(
                    self._vector(f"d{self.node[0]}"), self.point, strict=True)),
                Set((sp.Symbol("dway"),), (dqe[self.way],)),
                *(Set((s,), (dqe[at],)) for s, at in zip(
                    self._vector(f"d{self.force}"), self.multipliers, strict=True)))

    def column(self) -> tuple[Statement, ...]:
        """The column: forces and equations with their factors; columns of multipliers have that of
        the equations."""
        i, dg = counts.i, arrays.g.d
        last = self.multipliers[0]
        scaled = (For(i, Number(0), last, (Set((dg[i],), (FORCE * dg[i],)),)),)
        constrained = (For(i, Number(0), last, (Set((dg[i],), (CONSTRAINT * dg[i],)),)),)
        return (*self._forces("d"),
                If(compared(counts.column, "<", last), scaled, constrained),
                *(Set((dg[at],), (CONSTRAINT * s,)) for s, at in zip(
                    self._vector("dphi"), self.multipliers, strict=True)))

    def _forces(self, prefix: str) -> tuple[Statement, ...]:
        """Forces on the point and along the way."""
        g = arrays.g.d if prefix else arrays.g
        return (*(Set((g[at],), (s,)) for s, at in zip(self._vector(f"{prefix}gp"), self.point,
                                                      strict=True)),
                Set((g[self.way],), (sp.Symbol(f"{prefix}gs"),)))
