"""What a user builds: nodes made of triplets, superelements on them, joints and loads.

Unknowns are triplets (formulation: a node is a position triplet plus a rotation triplet, each its
own block). Two bodies that share a position triplet have a spherical joint between them without a
multiplier, a fixed triplet is no unknown at all.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .kernels import superelement_kernel
from .loads import History, history
from .reduction import ReducedBody, body_weights

FRAMES = ("converged_mean", "mean", "mean_small", "node", "positions")
INERTIAS = ("a", "b")


@dataclass
class Triplet:
    """A block of unknowns: a position or a rotation (in a plane two coordinates or an angle)."""

    name: str
    start: NDArray                  # initial position; zeros for a rotation
    rate: NDArray                   # initial velocity, or angular velocity (material = global)
    fixed: bool = False


@dataclass(eq=False)
class Node:
    """A named point of the model; either triplet may be absent or shared with another node."""

    name: str
    point: NDArray
    position: Triplet | None
    rotation: Triplet | None


@dataclass(eq=False)
class Superelement:
    """A reduced body placed on nodes, with its matrices in global axes."""

    name: str
    body: ReducedBody
    nodes: tuple[Node, ...]
    frame: str
    inertia: str
    layout: str
    alpha: NDArray
    alpha_r: NDArray
    kernel: object
    mode_rates: NDArray

    @property
    def positions(self) -> list[Triplet]:
        """Position triplets in the order of the reduced coordinates."""
        return [self.nodes[i].position for i in self.body.position_nodes]

    @property
    def rotations(self) -> list[Triplet]:
        """Rotation triplets in the order of the reduced coordinates."""
        return [self.nodes[i].rotation for i in self.body.rotation_nodes]


@dataclass(eq=False)
class Joint:
    """Constraint equations between triplets of one kind, or to the ground."""

    name: str
    kind: str
    triplets: tuple[Triplet, ...]
    constants: NDArray
    multipliers: int


@dataclass(eq=False)
class Load:
    """A dead force or torque on a triplet."""

    name: str
    kind: str
    triplet: Triplet
    direction: NDArray
    history: History


@dataclass(eq=False)
class Model:
    """A mechanism: nodes, superelements, joints and loads.

    Parameters
    ----------
    planar : bool
        Motion in the x-y plane: positions (x, y) and one angle a node.
    """

    planar: bool = False
    nodes: dict[str, Node] = field(default_factory=dict)
    bodies: dict[str, Superelement] = field(default_factory=dict)
    joints: list[Joint] = field(default_factory=list)
    loads: list[Load] = field(default_factory=list)
    gravity_field: NDArray | None = None

    def __post_init__(self) -> None:
        self.gravity(np.zeros(self.dimension) if self.gravity_field is None
                     else self.gravity_field)

    @property
    def dimension(self) -> int:
        """Coordinates of a position."""
        return 2 if self.planar else 3

    @property
    def rotation_size(self) -> int:
        """Coordinates of a rotation."""
        return 1 if self.planar else 3

    def node(self, name: str, point: ArrayLike, keeps: str = "full",
             at: Node | None = None) -> Node:
        """Add a node.

        Parameters
        ----------
        name : str
        point : (3,), planar (2,)
            Initial position, global axes [length].
        keeps : {'full', 'translation', 'rotation'}
        at : Node, optional
            Share the position triplet of this node: a spherical joint with no multiplier.

        Raises
        ------
        InputError
            Name taken, wrong shape, or `at` is somewhere else.
        """
        if name in self.nodes:
            raise InputError(f"node {name!r} exists already: give every node its own name")
        point = self._vector(point, f"point of node {name!r}")
        if keeps not in ("full", "translation", "rotation"):
            raise InputError(f"node {name!r} keeps {keeps!r}: use full, translation or rotation")
        size = max(1.0, np.abs(point).max())
        if at is not None and np.abs(at.point - point).max() > 1e-9 * size:
            raise InputError(f"node {name!r} at {point} cannot share the position of "
                             f"{at.name!r} at {at.point}: give both the same point")
        position = None if keeps == "rotation" else (
            at.position if at is not None else
            Triplet(f"{name}.position", point, np.zeros(self.dimension)))
        rotation = None if keeps == "translation" else Triplet(
            f"{name}.rotation", np.zeros(self.rotation_size), np.zeros(self.rotation_size))
        self.nodes[name] = Node(name, point, position, rotation)
        return self.nodes[name]

    def superelement(self, name: str, body: ReducedBody, nodes: Iterable[Node | str],
                     frame: str = "converged_mean", inertia: str = "b",
                     rotation: ArrayLike | None = None, frame_node: int = 0) -> Superelement:
        """Place a reduced body on nodes.

        Parameters
        ----------
        body : ReducedBody
            Reduced matrices in any axes.
        nodes : iterable of Node or str
            One node for each boundary node of the body, in its order.
        frame : {'converged_mean', 'mean', 'mean_small', 'node', 'positions'}
        inertia : {'a', 'b'}
        rotation : (3, 3), planar (2, 2), optional
            Turns FE axes into global axes; identity by default.
        frame_node : int
            For ``frame='node'``: which boundary node carries the frame.

        Raises
        ------
        InputError
            Nodes that do not fit the body, unknown options, or no kernel for the layout (the
            message says how to make it).
        """
        nodes = tuple(self._known(n) for n in nodes)
        if name in self.bodies:
            raise InputError(f"superelement {name!r} exists already: give it its own name")
        if body.planar != self.planar:
            raise InputError(f"superelement {name!r} is {'planar' if body.planar else 'spatial'} "
                             f"and the model is {'planar' if self.planar else 'spatial'}: use one "
                             "kind in a model")
        if frame not in FRAMES:
            raise InputError(f"frame {frame!r} is unknown: use one of {', '.join(FRAMES)}")
        if inertia not in INERTIAS:
            raise InputError(f"inertia {inertia!r} is unknown: use one of {', '.join(INERTIAS)}")
        placed = body if rotation is None else body.rotated(np.asarray(rotation, dtype=float))
        self._check_place(name, placed, nodes)
        _check_frame(name, placed, frame)
        alpha, alpha_r = body_weights(placed)
        if frame == "node":
            alpha, alpha_r = _weights_of_node(name, placed, frame_node)
        layout = layout_name(placed)
        kernel = superelement_kernel(layout, "converged_mean" if frame == "node" else frame,
                                     inertia, placed.modes)
        self.bodies[name] = Superelement(name, placed, nodes, frame, inertia, layout, alpha,
                                         alpha_r, kernel, np.zeros(placed.modes))
        return self.bodies[name]

    def fix(self, node: Node | str, what: str = "both") -> None:
        """Fix a node's position, rotation or both: fixed triplets are no unknowns."""
        node = self._known(node)
        if what not in ("position", "rotation", "both"):
            raise InputError(f"cannot fix {what!r}: use position, rotation or both")
        for kind in ("position", "rotation"):
            if what in (kind, "both"):
                self._triplet(node, kind).fixed = True

    def revolute(self, node: Node | str, axis: ArrayLike = (0.0, 0.0, 1.0),
                 to: Node | str | None = None) -> None:
        """Revolute joint about an axis through a node, to the ground or to another node.

        To the ground the position triplet is fixed; to another node both must share one. Two
        multipliers in space, none in a plane.
        """
        node = self._known(node)
        rotation = self._triplet(node, "rotation")
        position = self._triplet(node, "position")
        if to is None:
            rotations = (rotation,)
        else:
            to = self._known(to)
            if to.position is not position:
                raise InputError(f"revolute joint: nodes {node.name!r} and {to.name!r} do not "
                                 "share a position: make the second one with at=")
            rotations = (rotation, self._triplet(to, "rotation"))
        if self.planar:
            position.fixed = position.fixed or to is None
            return
        axis = self._vector(axis, f"axis of the revolute joint at {node.name!r}")
        length = np.linalg.norm(axis)
        if not length > 0:
            raise InputError(f"axis of the revolute joint at {node.name!r} is zero: give its "
                             "direction")
        e = axis / length
        first = np.cross(e, np.eye(3)[np.argmin(np.abs(e))])
        first /= np.linalg.norm(first)
        position.fixed = position.fixed or to is None
        kind = "revolute_ground" if to is None else "revolute"
        constants = np.concatenate([e, first, np.cross(e, first)])
        self.joints.append(Joint(f"{kind} at {node.name}", kind, rotations, constants, 2))

    def spherical(self, node: Node | str, to: Node | str | None = None) -> None:
        """Spherical joint as an explicit constraint with a multiplier a direction.

        For comparison: `fix(node, "position")`, or a second node made with ``at=``, is the same
        joint with fewer unknowns.
        """
        node = self._known(node)
        position = self._triplet(node, "position")
        triplets, constants = (position,), node.point
        if to is not None:
            to = self._known(to)
            if np.abs(to.point - node.point).max() > 1e-9 * max(1.0, np.abs(node.point).max()):
                raise InputError(f"spherical joint: nodes {node.name!r} and {to.name!r} start "
                                 "apart: give both the same point")
            triplets, constants = (position, self._triplet(to, "position")), np.zeros(0)
            if triplets[0] is triplets[1]:
                raise InputError(f"spherical joint: nodes {node.name!r} and {to.name!r} share "
                                 "their position already: leave the joint out")
        kind = self._kind("spherical_ground" if to is None else "spherical")
        self.joints.append(Joint(f"{kind} at {node.name}", kind, triplets, constants,
                                 self.dimension))

    def force(self, node: Node | str, direction: ArrayLike,
              amplitude: ArrayLike | Callable[[float], float] | History | None = None) -> None:
        """Dead force on a node: `direction` (global axes) times a history."""
        triplet = self._triplet(self._known(node), "position")
        vector = self._vector(direction, f"force on {triplet.name}")
        self.loads.append(Load(f"force on {triplet.name}", self._kind("force"), triplet, vector,
                               history(amplitude)))

    def torque(self, node: Node | str, direction: ArrayLike,
               amplitude: ArrayLike | Callable[[float], float] | History | None = None) -> None:
        """Dead torque on a node: `direction` (global axes; a number in a plane) times a history."""
        triplet = self._triplet(self._known(node), "rotation")
        vector = np.atleast_1d(np.asarray(direction, dtype=float))
        if vector.shape != (self.rotation_size,) or not np.isfinite(vector).all():
            raise InputError(f"torque on {triplet.name} is {direction}: give "
                             f"{self.rotation_size} finite number(s)")
        self.loads.append(Load(f"torque on {triplet.name}", self._kind("torque"), triplet, vector,
                               history(amplitude)))

    def gravity(self, field: ArrayLike) -> None:
        """Uniform gravity on every superelement, through its reduced mass.

        Parameters
        ----------
        field : (3,), planar (2,)
            Acceleration of free fall [length/time^2].

        Raises
        ------
        InputError
            Not so many finite numbers.
        """
        self.gravity_field = self._vector(field, "gravity")

    def initial_velocity(self, node: Node | str, linear: ArrayLike | None = None,
                         angular: ArrayLike | None = None) -> None:
        """Initial velocity of a node, global axes."""
        node = self._known(node)
        for kind, value in (("position", linear), ("rotation", angular)):
            if value is not None:
                triplet = self._triplet(node, kind)
                rate = np.atleast_1d(np.asarray(value, dtype=float))
                if rate.shape != triplet.rate.shape or not np.isfinite(rate).all():
                    raise InputError(f"initial rate of {triplet.name} is {value}: give "
                                     f"{triplet.rate.size} finite number(s)")
                triplet.rate[:] = rate

    def rigid_velocity(self, linear: ArrayLike, angular: ArrayLike,
                       about: ArrayLike | None = None) -> None:
        """Start all free triplets in a rigid motion of the whole model."""
        linear = self._vector(linear, "linear velocity")
        angular = np.atleast_1d(np.asarray(angular, dtype=float))
        centre = np.zeros(self.dimension) if about is None else self._vector(about, "about")
        for node in self.nodes.values():
            if node.position is not None and not node.position.fixed:
                arm = node.point - centre
                turning = (angular[0] * np.array([-arm[1], arm[0]]) if self.planar
                           else np.cross(angular, arm))
                node.position.rate[:] = linear + turning
            if node.rotation is not None and not node.rotation.fixed:
                node.rotation.rate[:] = angular

    def _kind(self, name: str) -> str:
        return "planar_" + name if self.planar else name

    def _known(self, node: Node | str) -> Node:
        name = node.name if isinstance(node, Node) else node
        if name not in self.nodes:
            raise InputError(f"node {name!r} is unknown: the model has "
                             f"{', '.join(self.nodes) or 'no nodes'}")
        return self.nodes[name]

    @staticmethod
    def _triplet(node: Node, kind: str) -> Triplet:
        triplet = getattr(node, kind)
        if triplet is None:
            raise InputError(f"node {node.name!r} has no {kind}: make it with keeps='full'")
        return triplet

    def _vector(self, value: ArrayLike, what: str) -> NDArray:
        vector = np.asarray(value, dtype=float)
        if vector.shape != (self.dimension,) or not np.isfinite(vector).all():
            raise InputError(f"{what} is {value}: give {self.dimension} finite numbers")
        return vector

    def _check_place(self, name: str, body: ReducedBody, nodes: tuple[Node, ...]) -> None:
        if len(nodes) != len(body.keeps):
            raise InputError(f"superelement {name!r} has {len(body.keeps)} boundary nodes and "
                             f"{len(nodes)} were given: give one node for each")
        for node, keep in zip(nodes, body.keeps, strict=True):
            for kind, other in (("position", "rotation"), ("rotation", "translation")):
                if keep != other:
                    self._triplet(node, kind)
        points = np.array([n.point for n in nodes])
        offset = points - body.coordinates
        error = np.abs(offset - offset.mean(axis=0)).max()
        if error > 1e-6 * max(np.ptp(points, axis=0).max(), 1e-300):
            raise InputError(f"superelement {name!r}: the nodes do not lie where the body's "
                             f"boundary nodes are (off by {error:.3g} after the best shift): pass "
                             "rotation=, the matrix that turns FE axes into global axes")


def _check_frame(name: str, body: ReducedBody, frame: str) -> None:
    """Refuse a frame that the kept triplets cannot define."""
    if frame != "positions":
        if not body.rotation_nodes:
            raise InputError(f"superelement {name!r} keeps no rotation, so its frame cannot be "
                             f"{frame!r}: use frame='positions'")
        return
    points = body.coordinates[list(body.position_nodes)]
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < body.coordinates.shape[1] or (
            spread[body.coordinates.shape[1] - 2] < 1e-6 * max(spread[0], 1e-300)):
        raise InputError(f"superelement {name!r}: the nodes that keep their position lie on a "
                         "line, so the frame 'positions' cannot see rotations about it: use "
                         "'converged_mean', or keep a node off the line")


def layout_name(body: ReducedBody) -> str:
    """Canonical layout name of a reduced body: counts of its full, half and planar nodes."""
    counts = [(letter, body.keeps.count(keep)) for letter, keep in
              (("f", "full"), ("t", "translation"), ("r", "rotation"))]
    return "planar-" * body.planar + "".join(f"{c}{n}" for c, n in counts if n)


def _weights_of_node(name: str, body: ReducedBody, node: int) -> tuple[NDArray, NDArray]:
    if node not in body.position_nodes or node not in body.rotation_nodes:
        raise InputError(f"superelement {name!r}: boundary node {node} cannot carry the frame, it "
                         "needs both its position and its rotation: choose a full node")
    alpha = np.array([float(i == node) for i in body.position_nodes])
    return alpha, np.array([float(i == node) for i in body.rotation_nodes])
