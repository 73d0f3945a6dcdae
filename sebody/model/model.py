"""What a user builds: nodes made of triplets, superelements on them, joints and loads.

Unknowns are triplets (formulation: a node is a position triplet plus a rotation triplet, each its
own block). Two bodies that share a position triplet have a spherical joint between them without a
multiplier, a fixed triplet is no unknown at all.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.errors import InputError
from sebody.fem import Section, planar_beam, straight_beam
from sebody.kernels.loader import superelement_kernel
from sebody.model.forces import Forces
from sebody.model.joints import Joints
from sebody.model.nodes import Element, Node, Triplet
from sebody.reduction import ReducedBody, body_weights, craig_bampton

FRAMES = ("converged_mean", "mean", "mean_small", "node", "positions")
INERTIAS = ("a", "b")


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
class Model(Joints, Forces):
    """A mechanism: nodes, superelements, rigid bodies, joints and forces.

    Parameters
    ----------
    planar : bool
        Motion in the x-y plane: positions (x, y) and one angle a node.
    """

    planar: bool = False
    nodes: dict[str, Node] = field(default_factory=dict)
    bodies: dict[str, Superelement] = field(default_factory=dict)
    rigid_bodies: dict[str, Element] = field(default_factory=dict)
    joints: list[Element] = field(default_factory=list)
    loads: list[Element] = field(default_factory=list)      # springs and dampers among them
    grounds: list[Node] = field(default_factory=list)       # fixed ends of joints to the ground
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
             at: Node | str | None = None) -> Node:
        """Add a node.

        Parameters
        ----------
        name : str
        point : (3,), planar (2,)
            Initial position, global axes [length].
        keeps : {'full', 'translation', 'rotation'}
        at : Node or str, optional
            Share the position triplet of this node: a spherical joint with no multiplier.

        Raises
        ------
        InputError
            Name taken, wrong shape, or `at` is somewhere else.
        """
        self._check_new(name)
        at = None if at is None else self._known(at)
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
        rotation = None if keeps == "translation" else self._rotation(f"{name}.rotation")
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
                                     inertia, placed.modes, placed.damping is not None)
        self.bodies[name] = Superelement(name, placed, nodes, frame, inertia, layout, alpha,
                                         alpha_r, kernel, np.zeros(placed.modes))
        return self.bodies[name]

    def beam(self, name: str, ends: tuple[Node | str, Node | str], section: Section,
             elements: int, bodies: int | None = None, modes: int = 0,
             up: ArrayLike | None = None, **placing) -> list[Node]:
        """A straight beam as equal superelements; of one element each they are nonlinear beams.

        A superelement of one finite element, with the mean of its two rotations as frame, has the
        strain energy of Simo and Reissner's geometrically exact beam: the rotation half way between
        the nodes sees the chord, ``Gamma = R_m^T (x_b - x_a) / l - t``, and each node is turned by
        half of ``log(R_a^T R_b)`` against it. The exact linear stiffness does not lock; with no
        shear factor in the section it is that of Euler and Bernoulli. So beams without modes and
        with as many bodies as elements are the nonlinear reference for superelements.

        Parameters
        ----------
        ends : two Nodes or str
            Full nodes at the ends of the axis.
        section : Section
        elements : int
            Finite elements from end to end.
        bodies : int, optional
            Superelements; as many as elements by default.
        modes : int
            Internal modes of each.
        up : (3,), optional
            Direction of the section's y axis, see `sebody.fem.straight_beam`.
        **placing
            Arguments of `superelement`, such as ``frame``.

        Returns
        -------
        list of Node
            All nodes from end to end, named ``<name> 1`` and so on between them. Superelements are
            named alike; a single one is called `name`.

        Raises
        ------
        InputError
            No element, elements that cannot be divided among the bodies, or names that are taken.
        """
        first, last = (self._known(n) for n in ends)
        bodies = elements if bodies is None else bodies
        if elements != int(elements) or elements < 1:
            raise InputError(f"beam {name!r} has {elements} elements: give a whole number >= 1")
        if bodies != int(bodies) or bodies < 1 or elements % bodies:
            raise InputError(f"beam {name!r}: {elements} elements cannot be divided among {bodies} "
                             "bodies: give a multiple")
        step, each = (last.point - first.point) / bodies, elements // bodies
        nodes = [first, *(self.node(f"{name} {k}", first.point + k * step)
                          for k in range(1, bodies)), last]
        fe_model = (planar_beam(first.point, first.point + step, section, each) if self.planar else
                    straight_beam(first.point, first.point + step, section, each, up))
        body = craig_bampton(fe_model, [(0, "full"), (each, "full")], modes)
        for k, pair in enumerate(zip(nodes, nodes[1:], strict=False), 1):
            self.superelement(name if bodies == 1 else f"{name} {k}", body, pair, **placing)
        return nodes

    def rigid_body(self, name: str, node: Node | str, mass: float, inertia: ArrayLike,
                   centre: ArrayLike | None = None) -> Element:
        """A rigid body that moves with a node.

        Parameters
        ----------
        mass : float
        inertia : (3, 3) or (3,), planar float
            About the centre of mass, global axes at the start (three numbers: principal moments).
        centre : (3,), planar (2,), optional
            Centre of mass at the start, global axes; the node by default.

        Raises
        ------
        InputError
            A mass or inertia no body has, or a name that is taken.
        """
        node = self._known(node)
        self._check_rigid(name, mass)
        centre = node.point if centre is None else self._vector(centre, f"centre of {name!r}")
        arm = centre - node.point
        J = self._inertia(name, inertia)
        if self.planar:
            moments = np.array([J + mass * arm @ arm])
        else:
            J = J + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
            moments = J[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
        self.rigid_bodies[name] = Element(
            name, self._kind("rigid_body"),
            (self._triplet(node, "position"), self._triplet(node, "rotation")),
            np.concatenate([[mass], mass * arm, moments]))
        return self.rigid_bodies[name]

    def point_mass(self, name: str, node: Node | str, mass: float) -> Element:
        """A mass on a node, without inertia of rotation.

        Raises
        ------
        InputError
            A mass that is not positive, or a name that is taken.
        """
        self._check_rigid(name, mass)
        self.rigid_bodies[name] = Element(
            name, self._kind("point_mass"), (self._triplet(self._known(node), "position"),),
            np.array([float(mass)]))
        return self.rigid_bodies[name]

    def attach(self, name: str, point: ArrayLike, to: Node | str) -> Node:
        """A node at the end of a massless rigid link from another one: no unknown, no equation.

        Its rotation is that of `to`. Bodies, joints and loads may act on it as on any node, and
        further links may start from it.

        Raises
        ------
        InputError
            Name taken, or `to` lacks a triplet.
        """
        master = self._known(to)
        self._check_new(name)
        point = self._vector(point, f"point of node {name!r}")
        position, rotation = (self._triplet(master, k) for k in ("position", "rotation"))
        root = position if position.root is None else position.root
        arms = (*position.arms, (rotation, point - master.point))
        hanging = Triplet(f"{name}.position", point, np.zeros(self.dimension), root=root, arms=arms)
        self.nodes[name] = Node(name, point, hanging, rotation)
        return self.nodes[name]

    def initial_velocity(self, node: Node | str, linear: ArrayLike | None = None,
                         angular: ArrayLike | None = None) -> None:
        """Initial velocity of a node, global axes.

        What is not given follows from the joints, see `sebody.Simulation`.
        """
        node = self._known(node)
        for kind, value in (("position", linear), ("rotation", angular)):
            if value is not None:
                triplet = self._triplet(node, kind)
                rate = (self._vector(value, f"initial rate of {triplet.name}")
                        if kind == "position" else
                        self._turning(value, f"initial rate of {triplet.name}"))
                if not triplet.solved and np.any(rate):
                    raise InputError(f"initial rate of {triplet.name} is {value}, but it is fixed, "
                                     "prescribed or hangs on another node: leave it out")
                triplet.rate, triplet.given = rate, True

    def rigid_velocity(self, linear: ArrayLike, angular: ArrayLike,
                       about: ArrayLike | None = None) -> None:
        """Start all free triplets in a rigid motion of the whole model."""
        linear = self._vector(linear, "linear velocity")
        angular = self._turning(angular, "angular velocity")
        centre = np.zeros(self.dimension) if about is None else self._vector(about, "about")
        for node in self.nodes.values():
            if node.position is not None and node.position.solved:
                arm = node.point - centre
                turning = (angular[0] * np.array([-arm[1], arm[0]]) if self.planar
                           else np.cross(angular, arm))
                node.position.rate = linear + turning
            if node.rotation is not None and node.rotation.solved:
                node.rotation.rate = angular.copy()

    def _kind(self, name: str) -> str:
        return "planar_" + name if self.planar else name

    def _known(self, node: Node | str) -> Node:
        name = node.name if isinstance(node, Node) else node
        if name not in self.nodes:
            raise InputError(f"node {name!r} is unknown: the model has "
                             f"{', '.join(self.nodes) or 'no nodes'}")
        if isinstance(node, Node) and self.nodes[name] is not node:
            raise InputError(f"node {name!r} is of another model: use that of this one")
        return self.nodes[name]

    def _check_new(self, name: str) -> None:
        if name in self.nodes:
            raise InputError(f"node {name!r} exists already: give every node its own name")

    def _check_rigid(self, name: str, mass: float) -> None:
        if name in self.rigid_bodies or name in self.bodies:
            raise InputError(f"body {name!r} exists already: give it its own name")
        if not (np.isfinite(mass) and mass > 0):
            raise InputError(f"mass of {name!r} is {mass}: give a positive number")

    def _inertia(self, name: str, inertia: ArrayLike) -> NDArray:
        """Inertia about the centre of mass; moments must be those of a body."""
        J = np.asarray(inertia, dtype=float)
        if self.planar:
            if J.shape != () or not (np.isfinite(J) and J >= 0):
                raise InputError(f"inertia of {name!r} is {inertia}: give one number >= 0")
            return J
        J = np.diag(J) if J.shape == (3,) else J
        if J.shape != (3, 3) or not np.isfinite(J).all():
            raise InputError(f"inertia of {name!r} has shape {J.shape}: give 3 x 3 finite numbers, "
                             "or three principal moments")
        if np.abs(J - J.T).max() > 1e-9 * np.abs(J).max():
            raise InputError(f"inertia of {name!r} is not symmetric: check its entries")
        principal = np.linalg.eigvalsh(J)
        if principal[0] < -1e-9 * principal[2] or (
                principal[0] + principal[1] < (1 - 1e-9) * principal[2]):
            raise InputError(f"inertia of {name!r} has the principal moments {principal}: no body "
                             "has one that is negative or larger than the sum of the others")
        return J

    def _ground(self, node: Node) -> Node:
        """A fixed node at the place of another one."""
        ground = Node(f"ground at {node.name}", node.point,
                      Triplet("ground.position", node.point, np.zeros(self.dimension), fixed=True),
                      self._rotation("ground.rotation", fixed=True))
        self.grounds.append(ground)
        return ground

    def _rotation(self, name: str, fixed: bool = False) -> Triplet:
        return Triplet(name, np.zeros(self.rotation_size), np.zeros(self.rotation_size), fixed,
                       turns=True)

    def triplets(self) -> list[Triplet]:
        """All triplets, each once."""
        return list({id(t): t for n in (*self.nodes.values(), *self.grounds)
                     for t in (n.position, n.rotation) if t is not None}.values())

    def _size(self) -> float:
        """Extent of the model, at least one unit of length."""
        return max([1.0, *(np.abs(n.point).max() for n in self.nodes.values())])

    @staticmethod
    def _triplet(node: Node, kind: str) -> Triplet:
        triplet = getattr(node, kind)
        if triplet is None:
            raise InputError(f"node {node.name!r} has no {kind}: make it with keeps='full'")
        return triplet

    def _vector(self, value: ArrayLike, what: str) -> NDArray:
        vector = _numbers(value)
        if vector.shape != (self.dimension,) or not np.isfinite(vector).all():
            raise InputError(f"{what} is {value}: give {self.dimension} finite numbers")
        return vector

    def _turning(self, value: ArrayLike, what: str) -> NDArray:
        """A vector of rotation: three numbers, in a plane one."""
        vector = np.atleast_1d(_numbers(value))
        if vector.shape != (self.rotation_size,) or not np.isfinite(vector).all():
            raise InputError(f"{what} is {value}: give {self.rotation_size} finite number(s)")
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


def _numbers(value: ArrayLike) -> NDArray:
    """As an array of numbers; what is none becomes NaN, which is refused with its name."""
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        return np.full(1, np.nan)


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
