"""Everyday mechanisms with more joints than their motion needs, in any orientation and units.

Each is built in plain axes and put into general position by a `Place`. Bodies are slender rods and
plates; what their motion must be is computed without this program in `test_everyday`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from sebody import Model
from sebody.verify.outside.bricard import POINTS

GRAVITY = 9.81


@dataclass(frozen=True, eq=False)
class Place:
    """Orientation, units of length and mass (that of time stays) and order of a model's parts."""

    rotation: NDArray = field(default_factory=lambda: np.eye(3))
    length: float = 1.0
    mass: float = 1.0
    backwards: bool = False

    @classmethod
    def at_random(cls, seed: int, **others: float) -> "Place":
        """Turned by a random rotation."""
        return cls(Rotation.random(random_state=seed).as_matrix(), **others)

    def point(self, x: ArrayLike) -> NDArray:
        """A point, or a velocity."""
        return self.length * self.rotation @ np.asarray(x, dtype=float)

    def turned(self, v: ArrayLike) -> NDArray:
        """A direction, or an angular velocity."""
        return self.rotation @ np.asarray(v, dtype=float)

    def inertia(self, J: ArrayLike) -> NDArray:
        """An inertia tensor, from principal moments or a matrix."""
        J = np.asarray(J, dtype=float)
        J = np.diag(J) if J.ndim == 1 else J
        return self.mass * self.length**2 * self.rotation @ J @ self.rotation.T

    def back(self, points: NDArray) -> NDArray:
        """Points of a result, in plain axes and units again."""
        return points @ self.rotation / self.length

    def order(self, things: ArrayLike) -> list:
        """Parts in the order in which they are created."""
        things = list(things)
        return things[::-1] if self.backwards else things


def rod(model: Model, place: Place, name: str, node: str, begin: ArrayLike, end: ArrayLike,
        axial: float = 0.0) -> None:
    """A slender rod of mass 1 that moves with a node; `axial` is its inertia about its axis."""
    along = np.subtract(end, begin)
    length = np.linalg.norm(along)
    along = along / length
    across = np.eye(3) - np.outer(along, along)
    model.rigid_body(name, node, place.mass,
                     place.inertia(length**2 / 12.0 * across + axial * np.outer(along, along)),
                     place.point(np.add(begin, end) / 2.0))


def plate(model: Model, place: Place, name: str, node: str, centre: ArrayLike, width: float,
          height: float) -> None:
    """A thin plate of mass 20 in the plane of x and z."""
    J = 20.0 / 12.0 * np.array([height**2, width**2 + height**2, width**2])
    model.rigid_body(name, node, 20.0 * place.mass, place.inertia(J), place.point(centre))


def hung(place: Place, direction: ArrayLike = (0.0, -1.0, 0.0)) -> Model:
    """A model with gravity in some direction of the plain axes."""
    model = Model()
    model.gravity(GRAVITY * place.point(direction))
    return model


def door(place: Place, heights: tuple[float, ...] = (0.3, 1.8)) -> Model:
    """A door on hinges about z at some heights; gravity leans against the hinges' line."""
    model = hung(place, (0.0, -np.sin(0.2), -np.cos(0.2)))
    names = [f"hinge {k}" for k in range(len(heights))]
    model.node(names[0], place.point((0.0, 0.0, heights[0])))
    plate(model, place, "leaf", names[0], (0.4, 0.0, 1.0), 0.8, 2.0)
    for name, z in list(zip(names, heights, strict=True))[1:]:
        model.attach(name, place.point((0.0, 0.0, z)), names[0])
    model.attach("handle", place.point((0.75, 0.0, 1.0)), names[0])
    for name in place.order(names):
        model.revolute(name, axis=place.turned((0.0, 0.0, 1.0)), explicit=name != names[0])
    return model


def gate(place: Place) -> Model:
    """A door with three hinges."""
    return door(place, (0.2, 1.0, 1.9))


def carriage(place: Place) -> Model:
    """A carriage on two parallel rails along x, each with two bearings, that slides down."""
    model = hung(place, (np.sin(0.1), 0.0, -np.cos(0.1)))
    model.node("middle", place.point((0.0, 0.0, 0.1)))
    model.rigid_body("carriage", "middle", 50.0 * place.mass, place.inertia((2.0, 3.0, 4.0)),
                     place.point((0.05, 0.02, 0.2)))
    corners = {f"bearing {k}": (x, y, 0.0) for k, (x, y) in enumerate(
        ((-0.4, -0.3), (0.4, -0.3), (-0.4, 0.3), (0.4, 0.3)))}
    for name, at in corners.items():
        model.attach(name, place.point(at), "middle")
    for name in place.order(corners):
        model.cylindrical(name, axis=place.turned((1.0, 0.0, 0.0)))
    model.attach("handle", place.point((0.0, 0.0, 0.5)), "middle")
    return model


def rockers(place: Place, count: int, along: ArrayLike = (0.0, 1.0, 0.0)) -> Model:
    """Parallel rockers of length 1 side by side, their ends hinged to one coupler."""
    model = hung(place)
    axis = place.turned((0.0, 0.0, 1.0))
    begin, end = along, np.add(along, (count - 1.0, 0.0, 0.0))
    numbers = place.order(range(count))
    for k in numbers:
        foot = np.array((k, 0.0, 0.0))
        model.node(f"ground {k}", place.point(foot))
        rod(model, place, f"rocker {k}", f"ground {k}", foot, foot + along)
        model.attach(f"B{k}", place.point(foot + along), f"ground {k}")
        model.revolute(f"ground {k}", axis=axis)
    first, *others = numbers
    model.node("coupler", place.point(np.add(along, (first, 0.0, 0.0))), at=f"B{first}")
    rod(model, place, "coupler", "coupler", begin, end)
    model.revolute(f"B{first}", axis=axis, to="coupler")
    for k in others:
        model.attach(f"C{k}", place.point(np.add(along, (k, 0.0, 0.0))), "coupler")
        model.revolute(f"C{k}", axis=axis, to=f"B{k}", explicit=True)
    model.initial_velocity(f"ground {first}", angular=place.turned((0.0, 0.0, -1.0)))
    return model


def four_bar(place: Place) -> Model:
    """Two rockers and a coupler on revolutes in space: a redundant loop."""
    return rockers(place, 2)


def parallelogram(place: Place) -> Model:
    """Five bars, the ground among them: redundant even in a plane."""
    return rockers(place, 3)


CUBE = np.vstack([POINTS, POINTS[:1]])


def bricard(place: Place) -> Model:
    """Bricard's loop: six slender rods along edges of a cube on revolutes, the last one fixed."""
    model = hung(place)
    rods = list(pairwise(CUBE))
    axes = [np.cross(a1 - a0, b1 - b0) for (a0, a1), (b0, b1) in zip(
        [rods[-1], *rods[:-1]], rods, strict=True)]
    for k in place.order(range(5)):
        model.node(f"rod {k}", place.point(rods[k][0]))
        rod(model, place, f"rod {k}", f"rod {k}", *rods[k])
        model.attach(f"end {k}", place.point(rods[k][1]), f"rod {k}")
    for k in place.order(range(6)):
        axis = place.turned(axes[k])
        if k == 0:
            model.revolute("rod 0", axis=axis)
        elif k < 5:
            model.revolute(f"end {k - 1}", axis=axis, to=f"rod {k}", explicit=True)
        else:
            model.revolute("end 4", axis=axis, explicit=True)
    return model


def box(place: Place) -> Model:
    """A square of four rods closed by welds, hinged at a corner."""
    model = hung(place)
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (0, -1, 0), (0, 0, 0)], dtype=float)
    for k in place.order(range(4)):
        model.node(f"corner {k}", place.point(corners[k]))
        rod(model, place, f"side {k}", f"corner {k}", corners[k], corners[k + 1])
        model.attach(f"end {k}", place.point(corners[k + 1]), f"corner {k}")
    for k in place.order(range(4)):
        model.weld(f"end {k}", f"corner {(k + 1) % 4}", explicit=True)
    model.revolute("corner 0", axis=place.turned((0.0, 0.0, 1.0)))
    return model


def double_pendulum(place: Place, axial: float = 0.0) -> Model:
    """Two slender rods on parallel revolutes: no inertia about their own axes, or little."""
    model = hung(place)
    axis = place.turned((0.0, 0.0, 1.0))
    model.node("upper", place.point((0.0, 0.0, 0.0)))
    rod(model, place, "upper", "upper", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), axial)
    model.attach("elbow", place.point((1.0, 0.0, 0.0)), "upper")
    model.node("lower", place.point((1.0, 0.0, 0.0)), at="elbow")
    rod(model, place, "lower", "lower", (1.0, 0.0, 0.0), (2.0, 0.0, 0.0), axial)
    model.attach("tip", place.point((2.0, 0.0, 0.0)), "lower")
    model.revolute("upper", axis=axis)
    model.revolute("elbow", axis=axis, to="lower")
    return model


MODELS: dict[str, tuple[Callable[[Place], Model], str]] = {     # and the node that is followed
    "door": (door, "handle"), "gate": (gate, "handle"), "carriage": (carriage, "handle"),
    "four-bar": (four_bar, "B0"), "parallelogram": (parallelogram, "B0"),
    "bricard": (bricard, "end 2"), "box": (box, "corner 2"),
    "double pendulum": (double_pendulum, "tip")}
