"""The statements of the kernel of a point on a path of a body, and of a node that turns with it.

The unknowns are those of the body, then the position of the point, or the rotation of the node, and
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
        columns(planar, DIRECTIONS[:1], (*own.turned(), *tangent), counts.width)))
    of_element = (
        *_pointers(own.carriers), *chain(kernel.constants, planar, {}),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.width)),
        gathered(STATE, counts.width), *own.loads(), *located, *forces, *own.stored(),
        If(compared(counts.task, ">=", agreed("VELOCITY")), (
            *rate, *own.equations("phid"), If(compared(counts.task, "==", agreed("ACCELERATION")), (
                *second, *own.equations("phidd"))))), matrix)
    body = (*_counts(planar, len(own.point) + 1 + len(own.multipliers)), *memory.points,
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


def _counts(planar: bool, behind: int) -> tuple[Let, ...]:
    """Counts of the body: point or rotation, way and multipliers come behind its coordinates."""
    return (Let((counts.n,), (counts.width - behind,)), *read_counts(Layout(None, planar)),
            Let((counts.row,), (counts.padded(largest(counts.width, 9 * counts.ROTATIONS)),)))


def _pointers(carriers: int = 0) -> tuple[Statement, ...]:
    """Places of nodes, unknowns and frame, whose number stands behind the unknowns.

    ``AT_FRAME`` tells where the numbers are that the element keeps. Behind the nodes of the body is
    one that turns with the path in space.
    """
    index = ARGUMENTS["index"]
    return (Let((counts.first,), (counts.element * counts.stride,)),
            Point(arrays.nodes, index.at(counts.first + agreed("HEADER"))),
            Point(arrays.unknowns, arrays.nodes.at(counts.ROTATIONS + carriers)),
            Point(arrays.frame, ARGUMENTS["frames"].at(9 * arrays.unknowns[counts.width])))


class _Own:
    """Numbers behind the coordinates of the body, in components."""

    def __init__(self, kernel: BodyPath) -> None:
        planar = kernel.layout.planar
        self.axes = [f"_{axis}" for axis in "xyz"[:size_of("position", planar)]]
        self.node, self.force, self.kept = ("xp", "vp", "ap"), "lam", ["tangent"]
        self.moved, equations = "dxp", self.axes
        if kernel.across:
            self.force, equations = "mu", [""]
        if kernel.turns:
            self.force, self.kept, equations = "mu", [], [""]
            self.node, self.moved = ("", "Omp", "Ap"), "dthp"
            if planar:
                self.axes, self.moved = [""], "dtheta"
                self.node = "theta", "thetad", "thetadd"
        self.carriers = 1 if kernel.turns and not planar else 0
        self.equations_in = equations
        self.point = [counts.n + k for k in range(len(self.axes))]
        self.way = counts.n + len(self.axes)
        self.multipliers = [self.way + 1 + k for k in range(len(equations))]

    def _vector(self, name: str) -> list[sp.Symbol]:
        return [sp.Symbol(name + axis) for axis in self.axes]

    def _of_equations(self, name: str) -> list[sp.Symbol]:
        return [sp.Symbol(name + axis) for axis in self.equations_in]

    def turned(self) -> tuple[Statement, ...]:
        """Directions of the columns of a node's rotation, in space."""
        if not self.carriers:
            return ()
        column, r = counts.column, counts.r
        tangent = ARGUMENTS["T"][9 * arrays.nodes[counts.ROTATIONS] + 3 * r + column - counts.n]
        return (If(compared(counts.n, "<=", column, "<", self.way), (
            For(r, Number(0), Number(3), (
                Set((DIRECTIONS[0][counts.n + r],), (FACTORS[0] * tangent,)),)),)),)

    def loads(self) -> tuple[Statement, ...]:
        """Position of the point or angle, the way, their rates, and the multipliers."""
        listed: list[Statement] = []
        for row, point, way in zip(STATE, self.node, ("way", "wayd", "waydd"),
                                   strict=True):
            listed += [Set((s,), (row[at],)) for s, at in zip(
                self._vector(point) if point else (), self.point, strict=bool(point))]
            listed.append(Set((sp.Symbol(way),), (row[self.way],)))
        if self.carriers:
            listed += [Set((sp.Symbol(f"Rp_{i}{j}"),), (
                ARGUMENTS["R"][9 * arrays.nodes[counts.ROTATIONS] + 3 * a + b],))
                for a, i in enumerate("xyz") for b, j in enumerate("xyz")]
        listed += [Set((s,), (arrays.qe[at],)) for s, at in zip(
            self._of_equations(self.force), self.multipliers, strict=True)]
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
            self._of_equations(name), self.multipliers, strict=True))

    def directions(self) -> tuple[Statement, ...]:
        """Directions of a column in variables."""
        dqe = DIRECTIONS[0]
        return (*(Set((s,), (dqe[at],)) for s, at in zip(
                    self._vector(self.moved), self.point, strict=True)),
                Set((sp.Symbol("dway"),), (dqe[self.way],)),
                *(Set((s,), (dqe[at],)) for s, at in zip(
                    self._of_equations(f"d{self.force}"), self.multipliers, strict=True)))

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
                    self._of_equations("dphi"), self.multipliers, strict=True)))

    def _forces(self, prefix: str) -> tuple[Statement, ...]:
        """Forces on the point and along the way."""
        g = arrays.g.d if prefix else arrays.g
        return (*(Set((g[at],), (s,)) for s, at in zip(self._vector(f"{prefix}gp"), self.point,
                                                      strict=True)),
                Set((g[self.way],), (sp.Symbol(f"{prefix}gs"),)))
