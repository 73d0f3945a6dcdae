"""The statements of the kernel of a contact of a point inside a body.

The unknowns are those of the body, then position and rotation of the node that carries the surface,
which the loops of the body do not see.
"""

import sympy as sp

from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, View, pointed
from sebody.derive.form.counts import agreed
from sebody.derive.form.kernel import Kernel
from sebody.derive.form.loops import size_of
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
    compared,
)
from sebody.derive.form.whole import Number, Whole, largest
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elements import Element, kept
from sebody.derive.kernels.arguments import ARGUMENTS
from sebody.derive.kernels.bodies import (
    DIRECTIONS,
    FACTORS,
    MATRIX,
    STATE,
    columns,
    gathered,
    port,
    read_counts,
)
from sebody.derive.kernels.body_contact import BodyContact
from sebody.derive.kernels.element_form import SUMS, staged, stored, used_symbols
from sebody.derive.kernels.layouts import Layout
from sebody.derive.kernels.memory import Memory, chain
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses

LAW = pointed("law")        # its constants


def body_contact_form(kernel: BodyContact) -> Kernel:
    """The kernel as statements."""
    steps, planar = kernel.steps, kernel.layout.planar
    lowering = Lowering(steps.q.space, kernel.names, arrows=False)
    own = _Law(steps.law, planar)
    point, prepared = lowering.statements(steps.point), lowering.statements(steps.prepared)
    law, start = own.forces(lowering.temporaries)
    slopes, start = staged(steps.law.slopes, start)
    lowering.temporaries = start
    forces, moved = lowering.statements(steps.forces), lowering.statements(steps.moved)
    column, lowering.temporaries = own.column(lowering.temporaries)
    tangent = (*moved, *column, *lowering.statements(steps.turned))
    used = uses((*point, *law, *forces, *prepared, *tangent)).arrays
    memory = Memory.of((*STATE[:2], *used, *DIRECTIONS[:2]))
    matrix = If(compared(counts.task, "==", agreed("TANGENT")), (
        Set(FACTORS[:2], tuple(ARGUMENTS["coefficients"][agreed(name)]
                               for name in ("C_STIFFNESS", "C_DAMPING"))),
        Point(MATRIX, ARGUMENTS["matrices"].at(counts.element * counts.width * counts.width)),
        *prepared, *slopes, _columns(planar, tangent)))
    of_element = (
        *_pointers(arrays.reference in used), *chain(kernel.constants, planar, {}),
        Point(LAW, _behind(kernel, planar)),
        Point(arrays.g, ARGUMENTS["forces"].at(counts.element * counts.width)),
        gathered(STATE[:2], counts.width),
        *point, *own.loads(), *law, *forces, matrix)
    body = (*_counts(planar), *memory.points,
            For(counts.element, Number(0), counts.count, of_element), Return(agreed("OK")))
    return Kernel(kernel.name, body, {}, memory.rows, memory.squares,
                  operations((*point, *forces)), operations(tangent))


def _counts(planar: bool) -> tuple[Let, ...]:
    """Counts of the body: the surface's node comes behind its coordinates."""
    own = size_of("position", planar) + size_of("rotation", planar)
    return (Let((counts.n,), (counts.width - own,)), *read_counts(Layout(None, planar)),
            Let((counts.row,), (counts.padded(largest(counts.width, 9 * counts.ROTATIONS)),)))


def _pointers(reference: bool) -> tuple[Statement, ...]:
    """Places of nodes, unknowns and frame, whose number stands behind the unknowns.

    ``AT_FRAME`` tells where the numbers are that the contact keeps.
    """
    index = ARGUMENTS["index"]
    frame = 9 * arrays.unknowns[counts.width]
    statements = [Let((counts.first,), (counts.element * counts.stride,)),
                  Point(arrays.nodes, index.at(counts.first + agreed("HEADER"))),
                  Point(arrays.unknowns, arrays.nodes.at(counts.ROTATIONS + 1)),
                  Point(arrays.frame, ARGUMENTS["frames"].at(frame))]
    if reference:
        statements.append(Point(arrays.reference, ARGUMENTS["references"].at(frame)))
    return tuple(statements)


def _behind(kernel: BodyContact, planar: bool) -> Array | View:
    """The place of the constants of the law: behind the others."""
    last = chain(kernel.constants, planar, {})[-1]
    return last.array.at(size_of("position", planar))


def _columns(planar: bool, steps: tuple[Statement, ...]) -> For:
    """Columns of the body's unknowns, then of those of the surface's node."""
    column, r, size = counts.column, counts.r, size_of("position", planar)
    of_state, width = DIRECTIONS[0], counts.width
    turned = () if planar else (If(compared(column, ">=", counts.n + size), (
        For(r, Number(0), Number(3), (Set(
            (of_state[counts.n + size + r],), (FACTORS[0] * ARGUMENTS["T"][
                9 * arrays.nodes[counts.ROTATIONS] + 3 * r + column - counts.n - size],)),)),)),)
    return columns(planar, DIRECTIONS[:2], (*turned, *steps), width)


class _Law:
    """The contact of the point, whose place and velocity are known, with the surface."""

    def __init__(self, law: Element, planar: bool) -> None:
        self.law, self.size = law, size_of("position", planar)
        self.turns = size_of("rotation", planar)
        self.a, self.b, self.rb = law.blocks
        self.place = [counts.n + k for k in range(self.size + self.turns)]

    def loads(self) -> tuple[Set, ...]:
        """Constants, what is kept, and the state of the node that carries the surface."""
        pairs: list[tuple] = [(s, LAW[k]) for k, s in enumerate(
            s for one in self.law.constants for s in one.quantity.kept)]
        for row, block, turned in ((arrays.qe, self.b.state, self.rb.state),
                                   (arrays.ve, self.b.rate, self.rb.rate)):
            pairs += zip(block.kept, (row[at] for at in self.place), strict=False)
            if turned.kind != "rotation":
                pairs += zip(turned.kept, (row[at] for at in self.place[self.size:]), strict=True)
        if self.rb.angle is None:
            pairs += [(s, ARGUMENTS["R"][9 * arrays.nodes[counts.ROTATIONS] + k])
                      for k, s in enumerate(self.rb.state.kept)]
        else:
            angle = arrays.qe[self.place[-1]]
            pairs += [*zip(self.rb.state.kept, (sp.cos(angle), sp.sin(angle)), strict=True),
                      (self.rb.angle, angle)]
        pairs += [(kept(name), ARGUMENTS["references"][_kept_at(k)])
                  for k, (name, _) in enumerate(self.law.memory)]
        used = used_symbols(self.law.printed)
        return tuple(Set((s,), (value,)) for s, value in pairs if s in used)

    def forces(self, start: int) -> tuple[tuple[Statement, ...], int]:
        """Force on the point and the surface, kept numbers; those of the losses for the energies.
        """
        law, targets = self.law, self._targets(arrays.g)
        stages, start = staged(law.stages, start)
        residual, start = stored(
            [*law.residual, *(value for _, value in law.memory)],
            [*targets, *(ARGUMENTS["frames"][_kept_at(k)] for k in range(len(law.memory)))], start)
        energies = ARGUMENTS["energies"]
        place, k = SUMS["strain"]
        sums, start = stored([law.sums["strain"]], [energies[agreed(place) + k]], start,
                             Change.ADD)
        power, start = stored([law.power], [energies[port()]], start)
        lost, start = stored(law.losses, targets, start)
        return (*stages, *residual, If(compared(counts.task, "==", agreed("ENERGY")), (
            *sums, *power, *lost))), start

    def column(self, start: int) -> tuple[tuple[Statement, ...], int]:
        """Differentials of the forces as the point and the surface's node move."""
        law, statements = self.law, []
        for source, blocks in ((arrays.qe.d, (self.b.direction, self.rb.direction)),
                               (arrays.ve.d, (self.b.unit, self.rb.unit))):
            statements += [Set((s,), (source[at],)) for s, at in zip(
                [s for block in blocks for s in block.kept], self.place, strict=True)]
        # directions have the factors of the matrix, and the rate of the point its whole variation
        one = {sp.Symbol(f"c_{name}"): sp.S.One for name in ("stiffness", "damping")}
        one |= {u: sp.Symbol(f"d{v}") for u, v in zip(self.a.unit.kept, self.a.rate.kept,
                                                      strict=True)}
        moves = [tuple((s, sp.sympify(value).xreplace(one)) for s, value in stage)
                 for stage in law.moves]
        staged_moves, start = staged(moves, start)
        values = [sp.sympify(value).xreplace(one) for value in law.linear]
        linear, start = stored(values, self._targets(arrays.g.d, "dFp"), start)
        return (*statements, *staged_moves, *linear), start

    def _targets(self, g: Array, point: str = "Fp") -> list[Target]:
        """The targets of the force: the point in variables, the surface's node in place."""
        return [*(sp.Symbol(f"{point}_{axis}") for axis in "xyz"[:self.size]),
                *(g[at] for at in self.place)]


def _kept_at(k: int) -> Whole:
    """Place of a number that is kept from step to step."""
    return ARGUMENTS["index"][counts.first + agreed("AT_FRAME")] + k
