"""Joints and drives of a model, built from a small family of generated constraints.

A joint takes no equation where its nodes can share a triplet instead. With ``explicit=True`` it is
built from equations alone.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.errors import InputError
from sebody.model import histories
from sebody.model.nodes import Element, Node, Triplet, unit_vectors

NEAR = 1e-9     # of the size of the model: nodes of a joint start together


class Joints:
    """The joints of `sebody.Model`."""

    def fix(self, node: Node | str, what: str = "both") -> None:
        """Fix a node's position, rotation or both: fixed triplets are no unknowns.

        Raises
        ------
        InputError
            The position hangs on another node by a rigid link.
        """
        node = self._known(node)
        if what not in ("position", "rotation", "both"):
            raise InputError(f"cannot fix {what!r}: use position, rotation or both")
        for kind in ("position", "rotation"):
            if what in (kind, "both"):
                self._hold(self._triplet(node, kind))

    def revolute(self, node: Node | str, axis: ArrayLike = (0.0, 0.0, 1.0),
                 to: Node | str | None = None, explicit: bool = False) -> None:
        """Revolute joint about an axis through a node, to the ground or to another node.

        Two multipliers in space, none in a plane: positions are shared or fixed.
        """
        a, b = self._pair(node, to, "revolute joint")
        if not self.planar:
            e, *normals = self._axis(axis, "revolute joint", a)
        self._together(a, b, to, "revolute joint", explicit)
        if self.planar:
            return
        grounded = to is None and not explicit
        rotations = (a.rotation,) if grounded else (a.rotation, b.rotation)
        self._constrain("revolute", "parallel_ground" if grounded else "parallel", a,
                        tuple(rotations), (e, *normals), 2)

    def universal(self, node: Node | str, axis: ArrayLike, other: ArrayLike,
                  to: Node | str | None = None, explicit: bool = False) -> None:
        """Universal joint: `axis`, fixed in `node`, and `other`, fixed in `to`, stay normal."""
        self._spatial("universal joint")
        a, b = self._pair(node, to, "universal joint")
        n, e = (self._axis(v, "universal joint", a)[0] for v in (axis, other))
        if abs(n @ e) > 1e-9:
            raise InputError(f"universal joint at {a.name!r}: its axes enclose "
                             f"{np.degrees(np.arccos(np.clip(abs(n @ e), 0, 1))):.4g} degrees: "
                             "give two that are normal to each other")
        self._together(a, b, to, "universal joint", explicit)
        self._constrain("universal", "perpendicular", a, (a.rotation, b.rotation), (e, n), 1)

    def cylindrical(self, node: Node | str, axis: ArrayLike, to: Node | str | None = None) -> None:
        """Cylindrical joint: `to` slides along and turns about an axis fixed in `node`."""
        self._spatial("cylindrical joint")
        a, b = self._pair(node, to, "cylindrical joint")
        e, *normals = self._axis(axis, "cylindrical joint", a)
        self._on_line("cylindrical", a, b, normals)
        self._constrain("cylindrical", "parallel", a, (a.rotation, b.rotation), (e, *normals), 2)

    def prismatic(self, node: Node | str, axis: ArrayLike, to: Node | str | None = None) -> None:
        """Prismatic joint: `to` slides along an axis fixed in `node` and turns with it."""
        a, b = self._pair(node, to, "prismatic joint")
        if self.planar:
            e = self._direction(axis, "prismatic joint", a)
            self._on_line("prismatic", a, b, [np.array([-e[1], e[0]])])
        else:
            self._on_line("prismatic", a, b, self._axis(axis, "prismatic joint", a)[1:])
        self._turn_together("prismatic", a, b)

    def slider(self, node: Node | str, axis: ArrayLike, to: Node | str | None = None) -> None:
        """Point on a line: `node` slides along an axis through its place, fixed in `to`."""
        what = "slider"
        b, a = self._pair(node, to, what, ("position",))
        if self.planar:
            e = self._direction(axis, what, b)
            normals = [np.array([-e[1], e[0]])]
        else:
            normals = self._axis(axis, what, b)[1:]
        self._triplet(a, "rotation")
        self._on_line(what, a, b, normals)

    def planar_joint(self, node: Node | str, normal: ArrayLike,
                     to: Node | str | None = None) -> None:
        """Planar joint: `to` stays in a plane through and fixed in `node`, and parallel to it."""
        self._spatial("planar joint")
        a, b = self._pair(node, to, "planar joint")
        e, *normals = self._axis(normal, "planar joint", a)
        self._constrain("planar joint", "on_plane", a, (a.position, b.position, a.rotation),
                        (e,), 1)
        self._constrain("planar joint", "parallel", a, (a.rotation, b.rotation), (e, *normals), 2)

    def spherical(self, node: Node | str, to: Node | str | None = None,
                  explicit: bool = True) -> None:
        """Spherical joint as an explicit constraint with a multiplier a direction.

        For comparison: `fix(node, "position")`, or a second node made with ``at=``, is the same
        joint with fewer unknowns; ``explicit=False`` makes it that.
        """
        a, b = self._pair(node, to, "spherical joint", ("position",))
        self._together(a, b, to, "spherical joint", explicit)

    def weld(self, node: Node | str, to: Node | str | None = None, explicit: bool = False) -> None:
        """Nodes move as one: they share both triplets; with ``explicit=True`` by equations."""
        a, b = self._pair(node, to, "weld")
        self._together(a, b, to, "weld", explicit)
        if explicit:
            self._turn_together("weld", a, b)
        elif to is None:
            self._hold(a.rotation)
        else:
            self._share(b.rotation, a.rotation, "rotation")

    def distance(self, node: Node | str, to: Node | str) -> None:
        """Two points keep the distance they start at: a massless rod with ball joints."""
        a, b = self._pair(node, to, "distance", ("position",))
        length = np.linalg.norm(b.point - a.point)
        if not length > NEAR * self._size():
            raise InputError(f"distance between {a.name!r} and {b.name!r} is zero: use a spherical "
                             "joint for nodes that start together")
        self._constrain("distance", self._kind("distance"), a, (a.position, b.position),
                        (np.array([length]),), 1)

    def drive_angle(self, node: Node | str, motion: object, axis: ArrayLike = (0.0, 0.0, 1.0),
                    to: Node | str | None = None) -> None:
        """Prescribe the angle of `node` against `to` (the ground) about the axis they share.

        The joint itself is built apart. Without `to` and with nothing else that turns `node`,
        `move` takes no equation.

        Parameters
        ----------
        motion : table or tuple of three functions
            See `sebody.model.histories.motion`; zero at the start [rad].
        """
        a, b = self._pair(node, to, "drive", ("rotation",))
        history = self._starting_at_zero(histories.motion(motion), a)
        constants = ()
        if not self.planar:
            constants = self._axis(axis, "drive", a)[1:]
        self._constrain("angle", self._kind("turn_drive"), a, (a.rotation, b.rotation), constants,
                        1, history)

    def drive_slide(self, node: Node | str, motion: object, axis: ArrayLike,
                    to: Node | str | None = None) -> None:
        """Prescribe the way of `to` (a point of the ground) along an axis fixed in `node`.

        Parameters
        ----------
        motion : table or tuple of three functions
            Of the way from the start [length]; see `sebody.model.histories.motion`.
        """
        a, b = self._pair(node, to, "drive")
        e = self._direction(axis, "drive", a)
        history = self._starting_at_zero(histories.motion(motion), a)
        self._constrain("slide", self._kind("slide_drive"), a,
                        (a.position, b.position, a.rotation),
                        (e, np.array([e @ (b.point - a.point)])), 1, history)

    def move(self, node: Node | str, direction: ArrayLike, motion: object,
             what: str = "position") -> None:
        """Prescribe the motion of a node: no unknown, no equation.

        Parameters
        ----------
        direction : (3,), planar (2,); of a planar rotation a number
            The motion times this is added to the place (may be called again, for positions), or is
            the angle about this axis.
        motion : table or tuple of three functions
            See `sebody.model.histories.motion`; zero at the start.
        what : {'position', 'rotation'}

        Raises
        ------
        InputError
            A rotation moved about two axes, or a position that hangs on another node.
        """
        node = self._known(node)
        if what not in ("position", "rotation"):
            raise InputError(f"cannot move {what!r}: use position or rotation")
        triplet = self._triplet(node, what)
        if what == "position":
            vector = self._vector(direction, f"motion of {triplet.name}")
        else:
            vector = self._turning(direction, f"motion of {triplet.name}")
            if triplet.motions:
                raise InputError(f"{triplet.name} is moved about an axis already: rotations about "
                                 "two axes do not add up, put a joint between them")
        if not np.linalg.norm(vector) > 0:
            raise InputError(f"motion of {triplet.name} has the direction {direction}: give one "
                             "that is not zero")
        history = self._starting_at_zero(histories.motion(motion), node)
        self._hold(triplet)
        triplet.motions.append((vector, history))

    def _hold(self, triplet: Triplet) -> None:
        if triplet.root is not None:
            raise InputError(f"{triplet.name} hangs on another node by a rigid link: fix or move "
                             f"{triplet.root.name} and its rotation instead")
        triplet.fixed = True

    def _pair(self, node: Node | str, to: Node | str | None, what: str,
              kinds: tuple[str, ...] = ("position", "rotation")) -> tuple[Node, Node]:
        """Both nodes of a joint; the ground is a fixed node at the place of the first."""
        a = self._known(node)
        b = self._ground(a) if to is None else self._known(to)
        if a is b:
            raise InputError(f"{what}: node {a.name!r} is joined to itself: give two nodes")
        for kind in kinds:
            self._triplet(a, kind)
            self._triplet(b, kind)
        return a, b

    def _together(self, a: Node, b: Node, to: Node | str | None, what: str,
                  explicit: bool) -> None:
        """Both positions become one: shared or fixed, else by equations."""
        self._check_together(a, b, what)
        if explicit:
            if a.position is b.position:
                raise InputError(f"{what}: nodes {a.name!r} and {b.name!r} share their position "
                                 "already: leave the joint out")
            name = what.removesuffix(" joint")
            if to is None:
                self._constrain(name, self._kind("coincident_ground"), a, (a.position,),
                                (a.point,), self.dimension)
            else:
                self._constrain(name, self._kind("coincident"), a, (a.position, b.position), (),
                                self.dimension)
        elif to is None and a.position.root is None:
            a.position.fixed = True
        elif a.position is not b.position:
            self._share(b.position, a.position, "position")

    def _check_together(self, a: Node, b: Node, what: str) -> None:
        if np.abs(b.point - a.point).max() > NEAR * self._size():
            raise InputError(f"{what}: nodes {a.name!r} and {b.name!r} start apart: give both the "
                             "same point")

    def _share(self, gone: Triplet, kept: Triplet, kind: str) -> None:
        """Every node, joint and load with the one triplet gets the other."""
        if gone.fixed or gone.root is not None:
            gone, kept = kept, gone
        if gone.fixed or gone.root is not None:
            raise InputError(f"{gone.name} and {kept.name} cannot be one: each of them is fixed or "
                             "hangs on another node; use explicit=True")
        if gone.given and not kept.given:
            kept.rate, kept.given = gone.rate, True
        for node in (*self.nodes.values(), *self.grounds):
            if getattr(node, kind) is gone:
                setattr(node, kind, kept)
        for element in (*self.joints, *self.loads, *self.rigid_bodies.values()):
            element.triplets = tuple(kept if t is gone else t for t in element.triplets)
        for triplet in self.triplets():
            if triplet.root is gone:
                triplet.root = kept
            triplet.arms = tuple((kept if r is gone else r, arm) for r, arm in triplet.arms)

    def _turn_together(self, what: str, a: Node, b: Node) -> None:
        if self.planar:
            self._constrain(what, "planar_aligned", a, (a.rotation, b.rotation), (), 1)
            return
        e, n, m = np.eye(3)
        self._constrain(what, "parallel", a, (a.rotation, b.rotation), (e, n, m), 2)
        self._constrain(what, "perpendicular", a, (a.rotation, b.rotation), (m, n), 1)

    def _on_line(self, what: str, a: Node, b: Node, normals: list[NDArray]) -> None:
        for normal in normals:
            if abs(normal @ (b.point - a.point)) > NEAR * self._size():
                raise InputError(f"{what}: node {b.name!r} is off the axis through "
                                 f"{a.name!r}: place it there or turn the axis")
        self._constrain(what, self._kind("on_line"), a, (a.position, b.position, a.rotation),
                        tuple(normals), len(normals))

    def _constrain(self, what: str, kind: str, a: Node, triplets: tuple[Triplet, ...],
                   constants, multipliers: int, history=None) -> None:
        self.joints.append(Element(f"{what} at {a.name}", kind, triplets,
                                   np.concatenate([*constants, np.zeros(0)]), multipliers,
                                   history))

    def _starting_at_zero(self, history, node: Node):
        value = (history.functions[0].ctypes(0.0) if history.functions else
                 np.interp(0.0, history.times, [c[0] for c in history.cubics]))
        if abs(value) > 1e-9:
            raise InputError(f"the motion at {node.name!r} is {value:.6g} at t = 0: motions count "
                             "from the start, take that off")
        return history

    def _spatial(self, what: str) -> None:
        if self.planar:
            raise InputError(f"{what}: the model is planar: use Model(), or a revolute or "
                             "prismatic joint")

    def _axis(self, axis: ArrayLike, what: str, node: Node) -> tuple[NDArray, NDArray, NDArray]:
        """Unit vector along an axis and two normals of it."""
        return unit_vectors(self._direction(axis, what, node))

    def _direction(self, axis: ArrayLike, what: str, node: Node) -> NDArray:
        axis = self._vector(axis, f"axis of the {what} at {node.name!r}")
        length = np.linalg.norm(axis)
        if not length > 0:
            raise InputError(f"axis of the {what} at {node.name!r} is zero: give its direction")
        return axis / length
