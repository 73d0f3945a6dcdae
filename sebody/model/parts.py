"""Parts of a mechanism: blocks and nodes, bodies, the elements and joints between them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.tabular import counted, vector
from sebody.compiler.user_functions import UserFunction
from sebody.fem.section_along import AnySection
from sebody.io.load_series import LoadSeries
from sebody.model.bearing_tables import BearingTable
from sebody.model.time_functions import TimeFunction
from sebody.reduction.body import ReducedBody
from sebody.reduction.invariants import InertiaInvariants


class Motion(NamedTuple):
    """A prescribed motion: displacement along a direction, or rotation about it."""

    name: str
    direction: NDArray
    time_function: TimeFunction
    place: "Attachment"

    def __repr__(self) -> str:
        return (f"<Motion {self.name!r} along {vector(self.direction)}: "
                f"{self.time_function.described()}>")


@dataclass(eq=False)
class GravityCourse:
    """Gravity that changes with time: a field and its amplitude."""

    name: str
    direction: NDArray      # (D,) that the amplitude multiplies [length/time^2]
    time_function: TimeFunction


@dataclass(eq=False, repr=False)
class DofBlock:
    """A block of unknowns: a position or a rotation (in a plane two coordinates or an angle).

    A block is free, fixed or prescribed. A position may also be dependent: at the end of a chain
    of rigid arms that rotate with nodes and begins at a root.
    """

    name: str
    start: NDArray                  # initial position; zeros for a rotation
    rate: NDArray                   # initial velocity, or angular velocity (material = global)
    fixed: bool = False             # not solved for: at rest or prescribed
    motions: list[Motion] = field(default_factory=list)
    root: "DofBlock | None" = None   # of a dependent position
    arms: tuple[tuple["DofBlock", NDArray], ...] = ()     # rotations, and arms in their axes
    given: bool = False             # whether the user gave the initial velocity
    rotational: bool = False        # whether it is a rotation

    @property
    def solved(self) -> bool:
        """Tell whether its coordinates are unknowns."""
        return not self.fixed and self.root is None

    def parents(self) -> list["DofBlock"]:
        """The DOF blocks that determine this one: itself, or root and rotations of the arms."""
        return [self] if self.root is None else [self.root, *(r for r, _ in self.arms)]

    @property
    def state(self) -> str:
        """Words for whether its coordinates are unknowns, and why not."""
        if self.root is not None:
            return "follows by a rigid link"
        if self.motions:
            return f"prescribed by {', '.join(motion.name for motion in self.motions)}"
        return "fixed" if self.fixed else counted(self.start.size, "unknown")

    def __repr__(self) -> str:
        return f"<{self.name}: {self.state}>"


@dataclass(eq=False, repr=False)
class Node:
    """A named point of the model; either DOF block may be absent or shared with another node."""

    name: str
    point: NDArray
    position: DofBlock | None
    rotation: DofBlock | None

    def __repr__(self) -> str:
        states = ", ".join(f"{kind} {getattr(self, kind).state}" for kind in (
            "position", "rotation") if getattr(self, kind) is not None)
        return f"<Node {self.name!r} at {vector(self.point)}: {states}>"


class Attachment(NamedTuple):
    """An element's place: one of the two DOF blocks of a node, which other nodes may share."""

    node: Node
    kind: str       # position or rotation

    @property
    def dof_block(self) -> DofBlock:
        """The block, which the node has."""
        return getattr(self.node, self.kind)


def positions(*nodes: Node) -> tuple[Attachment, ...]:
    """The positions of some nodes, as an element takes them."""
    return tuple(Attachment(node, "position") for node in nodes)


def rotations(*nodes: Node) -> tuple[Attachment, ...]:
    """The rotations of some nodes, as an element takes them: behind the positions."""
    return tuple(Attachment(node, "rotation") for node in nodes)


@dataclass(eq=False, repr=False)
class Superelement:
    """A reduced body placed on nodes, with its matrices in global axes."""

    name: str
    reduced: ReducedBody
    nodes: tuple[Node, ...]
    frame: str
    inertia: str
    stiffening: bool
    layout: str
    alpha: NDArray          # frame weights of the positions
    alpha_r: NDArray        # and of the rotations
    kernel: str             # name of the generated module
    mode_rates: NDArray     # initial velocities of the internal modes

    def __repr__(self) -> str:
        nodes = ", ".join(node.name for node in self.nodes)
        return (f"<Superelement {self.name!r} on {nodes}: mass {self.reduced.total_mass:.6g}, "
                f"{counted(self.reduced.modes, 'mode')}, frame {self.frame}, inertia {self.inertia}"
                + (", stiffening>" if self.stiffening else ">"))

    @property
    def invariants(self) -> InertiaInvariants | None:
        """The constants of its exact inertia, without those of stiffening where it has none."""
        constants = self.reduced.invariants
        return constants if constants is None or self.stiffening else constants.unstiffened

    @property
    def positions(self) -> list[DofBlock]:
        """Position DOF blocks in the order of the reduced coordinates."""
        return [Attachment(self.nodes[i], "position").dof_block
                for i in self.reduced.position_nodes]

    @property
    def rotations(self) -> list[DofBlock]:
        """Rotation DOF blocks in the order of the reduced coordinates."""
        return [Attachment(self.nodes[i], "rotation").dof_block
                for i in self.reduced.rotation_nodes]

    @property
    def firsts(self) -> list[int]:
        """The first of the unknowns of each of its attachments."""
        sizes = [one.dof_block.start.size for one in self.attachments]
        return [0, *accumulate(sizes)][:len(sizes)]

    @property
    def attachments(self) -> tuple[Attachment, ...]:
        """The attachments of its reduced coordinates, without internal modes."""
        return (positions(*(self.nodes[i] for i in self.reduced.position_nodes))
                + rotations(*(self.nodes[i] for i in self.reduced.rotation_nodes)))


class BodyPoint(NamedTuple):
    """A point of a body away from its boundary nodes: a node of its FE model."""

    body: Superelement
    place: int      # of the node among those of the recovery


class PathPiece(NamedTuple):
    """The part of a path on one body, or a curve that is fixed on a node."""

    carrier: Superelement | Node
    places: tuple[int, ...]     # of its knots in the recovery of the body; none of a node
    points: NDArray             # the knots at the start, global axes, (K, D) [length]
    ways: NDArray               # of the knots along this piece, from 0 [length]
    offset: float               # of the way along the whole path, where this piece begins

    @property
    def attachments(self) -> tuple[Attachment, ...]:
        """The attachments of the body, without internal modes; or of the node."""
        if isinstance(self.carrier, Node):
            return positions(self.carrier) + rotations(self.carrier)
        return self.carrier.attachments

    @property
    def modes(self) -> int:
        """Internal modes of the body."""
        return 0 if isinstance(self.carrier, Node) else self.carrier.reduced.modes

    @property
    def carrier_width(self) -> int:
        """Coordinates of the body or node, with internal modes."""
        return sum(one.dof_block.start.size for one in self.attachments) + self.modes


@dataclass(eq=False, repr=False)
class Path:
    """A way along bodies, or along a curve on a node or the ground."""

    name: str
    pieces: tuple[PathPiece, ...]   # with straight ones on the ground at ends that have some
    blend: float            # length over which one body hands over to the next [length]
    ends: tuple[str, str]   # refuse, straight, ground or stop
    length: float           # along chords between knots, without the ground at its ends [length]
    buffers: Mapping[str, float | NDArray]  # constants of the law of stops at its ends

    def __repr__(self) -> str:
        carriers = dict.fromkeys(piece.carrier.name for piece in self.pieces)
        return (f"<Path {self.name!r} on {', '.join(carriers)}: length {self.length:.6g}, "
                f"{sum(len(piece.ways) for piece in self.pieces)} knots>")


class OnPath(NamedTuple):
    """The place of an element of a point on a path, or of forces: one for each piece.

    Elements of a point share its equations, and those of a node that turns with the path theirs.
    In space one of these keeps a direction of the node across one of the path's section.
    """

    path: Path
    piece: int
    way: DofBlock | None    # hidden: how far along the path the point is; none of forces
    turns: bool = False     # with the tangent of the path, apart from being on it
    section: NDArray | None = None  # in space: this direction and its slope at knots, (K, 2, 3)

    @property
    def here(self) -> PathPiece:
        """The piece."""
        return self.path.pieces[self.piece]


class LawParts(NamedTuple):
    """Parts of the element of a continuous controller."""

    controller: str
    states: DofBlock                        # hidden: its velocities are the states
    modes: tuple[tuple[str, int], ...]      # superelements and internal modes that it reads
    derivatives: UserFunction | None


@dataclass(eq=False, repr=False)
class Element:
    """A rigid body, load, spring, or constraint of a joint: a generated kernel on DOF blocks."""

    name: str
    kind: str                       # name of its kernel without the prefix
    attachments: tuple[Attachment, ...]       # positions first, then rotations
    constants: Mapping[str, float | NDArray]    # by the names that the kernel has for them
    multipliers: int = 0
    time_function: TimeFunction | None = None
    mode: tuple[str, int] | None = None     # superelement and internal mode of a mode force
    function: UserFunction | None = None    # compiled function of a user force, kept alive
    body: Superelement | None = None        # on all whose coordinates a load on a body acts
    point: BodyPoint | None = None  # of a contact; the body's coordinates come first
    path: OnPath | None = None      # of a point on a path; the body's coordinates come first
    hidden: DofBlock | None = None  # an unknown on no node, of ropes and sheaves
    shares: "Element | None" = None     # whose multipliers it adds to
    pressed_by: "Joint | None" = None       # whose multipliers the friction in it reads
    reads: tuple[int, ...] | None = None    # which of its equations; all of them by default
    seen: int | None = None     # of friction along a path: piece whose tangent it reads
    law: LawParts | None = None             # of a continuous controller
    series: LoadSeries | None = None    # of a load on a body: of the columns of its loads
    tuned: Mapping[str, float] = field(default_factory=dict)    # see `sebody.runs.tuning`
    table: BearingTable | None = None   # of the speed, of a bearing
    read_at: float | None = None        # the speed at which its coefficients are from the table
    dof_blocks: tuple[DofBlock, ...] = field(init=False)       # those of the places

    def __post_init__(self) -> None:
        self.dof_blocks = tuple(one.dof_block for one in self.attachments)

    @property
    def firsts(self) -> list[int]:
        """The first of the unknowns of each of its attachments."""
        sizes = [dof_block.start.size for dof_block in self.dof_blocks]
        places, modes = self.carried
        if places:      # internal modes come behind the nodes of the body
            sizes[places - 1] += modes
        return [0, *accumulate(sizes)][:len(sizes)]

    @property
    def carried(self) -> tuple[int, int]:
        """The number of attachments of a body, which come first, and of modes of this body."""
        if self.path is not None:
            return len(self.path.here.attachments), self.path.here.modes
        if self.point is not None:
            return len(self.point.body.attachments), self.point.body.reduced.modes
        return 0, 0

    @property
    def width(self) -> int:
        """Unknowns of an element whose first ones are those of a body, with its multipliers."""
        own = sum(dof_block.start.size for dof_block in self.dof_blocks) + self.carried[1]
        return own + self.equations.multipliers

    @property
    def way(self) -> DofBlock | None:
        """An unknown that is on no node: the way of a point on a path, a length of a rope."""
        return self.hidden if self.path is None else self.path.way

    @property
    def read(self) -> "tuple[Element, ...]":
        """The equations whose multipliers it reads."""
        if self.pressed_by is None:
            return ()
        equations = tuple(one for one in self.pressed_by.constraints
                          if not (one.path and one.path.turns))
        return equations if self.reads is None else tuple(equations[k] for k in self.reads)

    @property
    def inert(self) -> bool:
        """Tell whether it has an unknown with mass: a wheel has, the friction of a rope has not."""
        return self.hidden is not None and self.pressed_by is None

    @property
    def equations(self) -> "Element":
        """The element whose multipliers it acts with: itself, or the one that it adds to."""
        return self if self.shares is None else self.shares

    @property
    def direction(self) -> NDArray:
        """Direction of a force or torque."""
        return self.vector("d")

    def number(self, name: str) -> float:
        """A constant that is a number."""
        return float(self.constants[name])

    def vector(self, name: str) -> NDArray:
        """A constant that is a vector."""
        return np.asarray(self.constants[name])

    def __repr__(self) -> str:
        nodes = dict.fromkeys(place.node.name for place in self.attachments)
        numbers = [f"{name} {np.asarray(value).item():.6g}" for name, value in
                   self.constants.items() if np.size(value) == 1]
        course = []
        if self.time_function and self.function is None:
            course = [self.time_function.described()]
        said = "; ".join([", ".join(numbers), *course]).strip("; ")
        return (f"<{self.kind.replace('_', ' ')} {self.name!r}"
                + f" on {', '.join(nodes)}" * bool(nodes) + f": {said}" * bool(said) + ">")


class Beam(NamedTuple):
    """A beam as it was built of superelements."""

    name: str
    nodes: tuple[Node, ...]             # from end to end
    section: AnySection
    elements: int
    options: Mapping[str, Any]          # the further arguments of `Model.beam`
    parts: tuple[Superelement, ...]
    bodies: tuple[ReducedBody, ...]     # of these parts, as built
    places: tuple[float, ...]           # of the nodes, from 0 to 1 along the beam

    def __repr__(self) -> str:
        return (f"<Beam {self.name!r} from {self.nodes[0].name} to {self.nodes[-1].name}: "
                f"{counted(self.elements, 'element')} in "
                f"{counted(len(self.parts), 'superelement')}>")


class Axes(NamedTuple):
    """Axes of a joint: the columns of a matrix at the start, which turn with a node."""

    carrier: Node
    columns: NDArray

    @classmethod
    def of(cls, carrier: Node, vectors: Sequence[NDArray] | None = None) -> "Axes":
        """Axes along some vectors, by default those of space at the start."""
        return cls(carrier, np.eye(len(carrier.point)) if vectors is None else
                   np.column_stack(vectors))


class Way(NamedTuple):
    """A way along an axis that turns with a node: of a joint's `node` against its `to`.

    In axes of the carrier it is ``direction . (other - carrier)``, less its value at the start.
    """

    carrier: Node
    other: Node
    direction: NDArray      # along the axis, or against it where the carrier is `node` of the joint

    @classmethod
    def of(cls, node: Node, to: Node, axes: Axes) -> "Way":
        """That of `node` against `to` along the first of some axes, which turn with one of them."""
        e = axes.columns[:, 0]
        return cls(node, to, -e) if axes.carrier is node else cls(to, node, e)

    @property
    def attachments(self) -> tuple[Attachment, ...]:
        """The attachments of an element along the way."""
        return positions(self.carrier, self.other) + rotations(self.carrier)

    @property
    def start(self) -> float:
        """Its value at the start [length]."""
        return float(self.direction @ (self.other.point - self.carrier.point))


TURNS = ("revolute", "cylindrical")                 # joints with an angle
SLIDES = ("prismatic", "slider", "cylindrical")     # joints with a way
COUPLING = "coupling"                               # an equation between two of these coordinates


@dataclass(eq=False, repr=False)
class Joint:
    """A joint or drive: its constraints; none if its nodes are fixed or share DOF blocks."""

    name: str
    constraints: tuple[Element, ...]
    node: Node          # its force and moment are those on this node
    to: Node            # from this one, which is fixed if the joint is to the ground
    axes: Axes | None   # none of a distance, whose axis is the line between the nodes
    kind: str           # revolute, universal, ..., weld, distance; drive

    def __repr__(self) -> str:
        course = f"; {self.time_function.described()}" if self.time_function else ""
        return (f"<{self.kind} {self.name!r} of {self.node.name} to {self.to.name}: "
                f"{counted(self.multipliers, 'equation')}{course}>")

    @property
    def own_axes(self) -> Axes:
        """Its axes, where it is known to have some: it is no distance."""
        assert self.axes is not None
        return self.axes

    @property
    def axis(self) -> NDArray:
        """The first of its axes, at the start."""
        return self.own_axes.columns[:, 0]

    @property
    def way(self) -> Way:
        """The way of `node` against `to` along its axis, where it slides."""
        return Way.of(self.node, self.to, self.own_axes)

    @property
    def multipliers(self) -> int:
        """Number of its equations."""
        return sum(c.multipliers for c in self.constraints)

    @property
    def time_function(self) -> TimeFunction | None:
        """The motion of a drive."""
        return next((c.time_function for c in self.constraints), None)


class Connection(NamedTuple):
    """Two nodes with a DOF block in common, or at the ends of a rigid link.

    What one passes to the other takes no equation: it is found from the balance of the nodes.
    """

    kind: str               # position or rotation: whether a force or a moment is passed
    node: Node
    to: Node | None         # none: the ground
    joint: Joint | None = None      # that made it; none of a support, a link, a node made with at=
    spare: bool = False     # of a support or a node made with at=: none where joints do the same
