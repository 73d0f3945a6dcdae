"""Surfaces that spheres and points touch: planes, spheres and cylinders of the ground or a body."""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import ArrayLike

from sebody.basics import inputs
from sebody.model.parts import Node


class Surface(NamedTuple):
    """A surface; made by `plane`, `sphere` or `cylinder`."""

    kind: str                           # plane | sphere | cylinder
    direction: ArrayLike | None         # normal of a plane, axis of a cylinder
    point: ArrayLike | None             # on it, or its centre; that of the node by default
    radius: float | None
    inside: bool                        # whether it is touched from inside, as a bore
    node: Node | str | None             # that carries it; the ground by default


def plane(normal: ArrayLike, point: ArrayLike | None = None,
          node: Node | str | None = None) -> Surface:
    """A plane, to be touched from the side its normal points to.

    Parameters
    ----------
    normal : (3,), in a plane (2,)
    point : (3,) or (2,), optional
        A point of it at the start, global axes; that of the node, or the origin, by default.
    node : Node or str, optional
        Node that carries it; the ground by default.
    """
    return Surface("plane", normal, point, None, False, node)


def sphere(radius: float, point: ArrayLike | None = None, node: Node | str | None = None,
           inside: bool = False) -> Surface:
    """A sphere about a node or a point of the ground; in a planar model a circle.

    Parameters
    ----------
    radius : float
        Its radius [length].
    point : (3,) or (2,), optional
        Its centre on the ground [length], the origin by default.
    node : Node or str, optional
        Node at its centre that carries it.
    inside : bool
        Whether it is touched from inside: a socket, or in a plane a bore.
    """
    inside = inputs.flag(inside, "inside of the sphere")
    return Surface("sphere", None, point, inputs.number(radius, "radius of the sphere", above=0),
                   inside, node)


def cylinder(axis: ArrayLike, radius: float, point: ArrayLike | None = None,
             node: Node | str | None = None, inside: bool = False) -> Surface:
    """A cylinder without end; see `sphere`. In a planar model take a sphere, which is a circle."""
    inside = inputs.flag(inside, "inside of the cylinder")
    return Surface("cylinder", axis, point,
                   inputs.number(radius, "radius of the cylinder", above=0), inside, node)
