"""Parts of a model that turn about a line, and parts that stand.

Rotations, and positions off the line, are tied to each other where they belong to one body or one
rigid link, share a block (welds, joints) or where an element resists that one of them turns alone:
its matrix at the start, times the velocities of this turning, is not zero. Positions on the line
tie nothing. A tied group turns freely unless something fixed is in it; drives hold nothing, since
they make things turn. Gears and couplings tie groups that turn about other lines, at the speed of
their ratio.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from sebody.assembly.numbering import coordinates
from sebody.basics.errors import InputError
from sebody.contract.layout import FIELD
from sebody.model.model import Model
from sebody.model.parts import DofBlock, Element, Node, Superelement
from sebody.runs.rotating_frame import Spin, Turning, by_element
from sebody.runs.simulation import Simulation, Standstill
from sebody.runs.state_derivatives import derivative

ON_LINE = 1e-9      # of the model's size: distance of a position on a line
RESISTED = 1e-9     # force of an element against turning, of the sizes of its terms: what is none
GROUND = object()   # what is fixed, as a member of groups


class Line(NamedTuple):
    """A line about which something may turn."""

    point: NDArray
    direction: NDArray      # of unit length; in a plane of one number, 1

    def away(self, point: NDArray) -> float:
        """Distance of a point."""
        off = point - self.point
        return float(np.linalg.norm(
            off if len(self.direction) == 1 else off - off @ self.direction * self.direction))

    def velocity(self, point: NDArray) -> NDArray:
        """Velocity of a point that turns at unit speed."""
        x, y = (point - self.point)[:2]
        return (np.array([-y, x]) if len(self.direction) == 1 else
                np.cross(self.direction, point - self.point))


class _Touching(NamedTuple):
    """An element between groups, and its matrix where the model is built."""

    element: Element
    matrix: csr_matrix


class _Groups:
    """Members that are tied to each other."""

    def __init__(self) -> None:
        self._above: dict[object, object] = {}

    def of(self, member: object) -> object:
        """The member that stands for the group of another."""
        while (above := self._above.get(member, member)) is not member:
            member = above
        return member

    def tie(self, *members: object) -> None:
        """Tie members; the ground stands for what is tied to it."""
        found = {self.of(one) for one in members}
        first = GROUND if GROUND in found else next(iter(found), None)
        for one in found:
            if one is not first:
                self._above[one] = first


class Mechanics:
    """A model where it is built: what ties its blocks, for lines about which parts may turn."""

    def __init__(self, model: Model):
        self.model, self._run = model, unloaded(model)
        self._elements = list(_touching(self._run))
        self._near = ON_LINE * model.size()
        nodes = [*model.nodes.values(), *model.grounds]
        self.blocks = list(dict.fromkeys(
            t for n in nodes for t in (n.position, n.rotation)
            if t is not None and t in self._run.numbering.dof_blocks))

    def turning(self, direction: NDArray, hub: Node | None) -> dict[DofBlock, Turning]:
        """Blocks that turn, and how; none where nothing can turn by itself.
        About the line through the origin, or that through the hub.

        Parameters
        ----------
        direction : (3,)
            Of unit length; in a plane (1,).
        hub : Node, optional
            A node of what turns, on its axis.

        Raises
        ------
        InputError
            The hub stands.
        """
        if hub is None:
            return self._about(Line(np.zeros(self.model.dimension), direction), None)
        found = self._about(Line(hub.point, direction), hub)
        if not found:
            raise InputError(f"hub {hub.name!r} does not turn freely about the direction of the"
                             " spin: name a node of what turns, on its axis")
        return found

    def _about(self, line: Line, hub: Node | None) -> dict[DofBlock, Turning]:
        """Find what turns freely about a line, with what gears turn elsewhere."""
        groups = self._tied(line)
        free = {groups.of(t) for t in self.blocks if self._counts(t, line)} - {GROUND}
        if hub is not None:
            own = [t for t in (hub.rotation, hub.position) if t is not None]
            free &= {groups.of(t) for t in own}
        members = {t: Turning(line.point, 1.0) for t in self.blocks
                   if self._counts(t, line) and groups.of(t) in free}
        if not any(t.rotational or self.model.planar for t in members):
            return {}           # points that are on a line do not turn
        return self._with_centres(members | self._geared(line, members))

    def _counts(self, dof_block: DofBlock, line: Line) -> bool:
        """Tell whether turning about a line moves a block; ways along paths it does not."""
        return dof_block.rotational or (dof_block.start.size == self.model.dimension
                                        and line.away(dof_block.start) > self._near)

    def _tied(self, line: Line) -> _Groups:
        """Groups of blocks that turn about a line together."""
        groups, model = _Groups(), self.model

        def tie(blocks: list[DofBlock]) -> None:
            groups.tie(*(t for t in blocks if self._counts(t, line)))
        for dof_block in self.blocks:
            if dof_block.fixed and not (dof_block.rotational and dof_block.motions):
                if self._counts(dof_block, line):
                    groups.tie(GROUND, dof_block)
            elif dof_block.root is not None:
                tie([dof_block, *dof_block.parents()])
        for body in model.bodies.values():
            tie([*body.positions, *body.rotations])
            if body.reduced.base is not None:
                groups.tie(GROUND, *body.rotations)
        again = True
        while again:            # what is tied may tie others
            again = False
            for one in self._elements:
                own = [t for t in one.element.dof_blocks if self._counts(t, line)]
                parts = {groups.of(t) for t in own}
                resisted = [part for part in parts if len(parts) > 1 and self._resists(
                    one, [t for t in own if groups.of(t) is part], line)]
                if resisted and not _is_gear(one.element):
                    groups.tie(*parts)
                    again = True
        return groups

    def _resists(self, one: _Touching, blocks: list[DofBlock], line: Line) -> bool:
        """Tell if an element resists that some blocks turn about a line, and others do not."""
        forces, terms = self._force(one, blocks, line)
        return bool(np.abs(forces).max(initial=0.0) > RESISTED * terms)

    def _force(self, one: _Touching, blocks: list[DofBlock], line: Line) -> tuple[NDArray, float]:
        """Change of an element's forces where blocks turn, and the largest of its terms."""
        velocity = np.zeros(self._run.numbering.total)
        for dof_block in dict.fromkeys(blocks):
            velocity[coordinates(self._run.numbering, dof_block)] = (
                line.direction if dof_block.rotational else line.velocity(dof_block.start))
        return (one.matrix @ velocity,
                float((abs(one.matrix) @ np.abs(velocity)).max(initial=0.0)))

    def _geared(self, line: Line, members: Mapping[DofBlock, Turning]) -> dict[DofBlock, Turning]:
        """Parts that gears turn about other lines."""
        found: dict[DofBlock, Turning] = {}
        for one in self._elements:
            if not _is_gear(one.element):
                continue
            ends = [at.node for at in one.element.attachments]
            turning = [n for n in ends if n.rotation in members]
            others = [n for n in ends if n.rotation not in members]
            for node in others:
                about = Line(node.point, line.direction)
                parts = self._about_gear(about, node)
                if not turning or not parts:
                    continue
                driver, _ = self._force(one, [n.rotation for n in turning if n.rotation], line)
                driven, _ = self._force(one, [node.rotation] if node.rotation else [], about)
                if size := float(driven @ driven):
                    ratio = -float(driver @ driven) / size
                    found |= {t: Turning(about.point, ratio) for t in parts}
        return found

    def _about_gear(self, line: Line, node: Node) -> list[DofBlock]:
        """Blocks of the part with a node, if it turns freely about a line."""
        groups = self._tied(line)
        own = groups.of(node.rotation)
        return [] if own is GROUND else [t for t in self.blocks if self._counts(t, line)
                                         and groups.of(t) is own]

    def _with_centres(self, members: dict[DofBlock, Turning]) -> dict[DofBlock, Turning]:
        """With the positions on the line of nodes, bodies and links that turn."""
        found = dict(members)
        owners = [*((n.position, n.rotation) for n in self.model.nodes.values()),
                  *((*b.positions, *b.rotations) for b in self.model.bodies.values()),
                  *((t, *t.parents()) for t in self.blocks if t.root is not None)]
        for owner in owners:
            turning = [members[t] for t in owner if t is not None and t in members]
            for dof_block in owner:
                if turning and dof_block is not None and not dof_block.rotational:
                    found.setdefault(dof_block, turning[0])
        return found


def unloaded(model: Model) -> Simulation:
    """A model where it is built, at rest and without loads."""
    run = Standstill(model, 1.0)
    state = run.state
    state.v[:], state.a[:], state.loads[:], state.coefficients[FIELD:] = 0.0, 0.0, 0.0, 0.0
    state.q[run.system.is_multiplier[:state.q.size] > 0] = 0.0
    return run


def parts_of(model: Model, spin: Spin, hub: Node | None = None) -> Spin:
    """The spin of the parts that turn; of everything where nothing turns by itself.

    Raises
    ------
    InputError
        The hub stands.
    """
    parts = Mechanics(model).turning(unit(spin), hub)
    return Spin(spin.velocity, spin.planar, parts) if parts else spin


def unit(spin: Spin) -> NDArray:
    """Direction of a spin, of unit length; (1,) in a plane."""
    velocity = np.atleast_1d(spin.velocity)
    size = np.linalg.norm(velocity)
    return velocity / size if size else np.ones(1) if spin.planar else np.eye(3)[0]


def turning_bodies(model: Model, parts: Mapping[DofBlock, Turning]
                   ) -> dict[str, tuple[Superelement, Turning]]:
    """Superelements that turn."""
    found = {}
    for name, body in model.bodies.items():
        own = [parts[t] for t in (*body.rotations, *body.positions) if t in parts]
        if own and all(t in parts for t in body.rotations):
            found[name] = body, own[0]
    return found


def _touching(run: Simulation) -> Iterator[_Touching]:
    """Elements that may tie blocks: neither drives nor loads nor what has bristles."""
    derivative(run, 0.0, 0.0, 1.0)
    whole, numbering = csr_matrix(by_element(run)), run.numbering
    starts = sorted([*numbering.forces_at.values(), whole.shape[0]])
    ends = dict(zip(starts, starts[1:], strict=False))
    for element in (*run.model.constraints, *run.model.loads):
        if (element.time_function is None and element.law is None and element.series is None
                and element not in numbering.bristles and element in numbering.forces_at):
            first = numbering.forces_at[element]
            yield _Touching(element, whole[first:ends[first]])


def _is_gear(element: Element) -> bool:
    return element.kind.endswith(("gear_play", "couple_turn_turn"))
