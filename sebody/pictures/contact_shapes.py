"""Shapes that stand for contact surfaces: patches, balls, tubes and the ranges of stops."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

AROUND = 48             # corners of a circle
ROWS = 8                # of a sphere, from pole to pole
GENERATORS = 8          # lines along a cylinder
HATCHES = 3, 60         # behind a line, at least and at most
APART, SLOPE = 1.5, 0.5         # of their length: their distance, and how far they lean


class Shape(NamedTuple):
    """Points, the lines between them that are drawn, and translucent triangles."""

    points: NDArray         # (points, 3)
    lines: NDArray          # (lines, 2)
    triangles: NDArray      # (triangles, 3), seen where their corners turn left


def patch(base: ArrayLike, along: NDArray, across: NDArray) -> Shape:
    """A rectangle of a plane: its corner and its sides."""
    corners = base + np.array([0 * along, along, along + across, across])
    return Shape(corners, _loop(4), _both_sides(np.array([[0, 1, 2], [0, 2, 3]])))


def hatched(base: ArrayLike, along: NDArray, normal: NDArray) -> Shape:
    """A line in a plane, with hatches on the side that is not touched, as long as the normal."""
    way, high = along / np.linalg.norm(along), np.linalg.norm(normal)
    count = int(np.clip(np.linalg.norm(along) / (APART * high), *HATCHES))
    starts = base + np.linspace(0.0, 1.0, count + 1)[1:, None] * along
    points = np.concatenate([[base, base + along], starts, starts - normal - SLOPE * high * way])
    hatches = 2 + np.column_stack([np.arange(count), count + np.arange(count)])
    return Shape(points, np.concatenate([[[0, 1]], hatches]), _none())


def ball(radius: float, inside: bool = False) -> Shape:
    """A sphere by three circles; touched from inside its far half is seen."""
    x, y, z = np.eye(3)
    circles = [circle(radius, *pair) for pair in ((x, y), (y, z), (z, x))]
    height = np.linspace(-np.pi / 2, np.pi / 2, ROWS + 1)
    skin = joined([circle(radius * np.cos(h), x, y, radius * np.sin(h) * z) for h in height])
    return joined([*circles, Shape(skin.points, skin.lines[:0], _between_rows(ROWS, inside))])


def disc(radius: float, inside: bool = False) -> Shape:
    """A circle in the plane of x and y: a disc with a spoke, or from inside a bore."""
    x, y, _ = np.eye(3)
    rim = circle(radius, x, y)
    if inside:
        return rim
    points = np.concatenate([rim.points, np.zeros((1, 3))])
    fan = np.column_stack([_loop(AROUND), np.full(AROUND, AROUND)])
    return Shape(points, np.concatenate([rim.lines, [[AROUND, 0]]]), _both_sides(fan))


def tube(axis: NDArray, radius: float, low: float, high: float, inside: bool = False) -> Shape:
    """A stretch of a cylinder about an axis through the origin."""
    u, v = across_of(axis)
    ends = joined([circle(radius, u, v, at * axis) for at in (low, high)])
    places = np.arange(GENERATORS) * AROUND // GENERATORS
    generators = np.column_stack([places, places + AROUND])
    return Shape(ends.points, np.concatenate([ends.lines, generators]), _between_rows(1, inside))


def sector(zero: NDArray, side: NDArray, low: float, high: float, radius: float,
           ends: Sequence[float]) -> Shape:
    """Angles from `low` to `high`, counted from `zero` to `side`, with rays at some of them."""
    angle = np.linspace(low, high, AROUND)
    arc = radius * (np.outer(np.cos(angle), zero) + np.outer(np.sin(angle), side))
    rays = [AROUND - 1 if end == high else 0 for end in ends]
    row = np.column_stack([np.arange(AROUND - 1), np.arange(1, AROUND)])
    fan = np.column_stack([row, np.full(AROUND - 1, AROUND)])
    return Shape(np.concatenate([arc, np.zeros((1, 3))]),
                 np.concatenate([row, [[AROUND, ray] for ray in rays]]), _both_sides(fan))


def line(one: NDArray, other: NDArray) -> Shape:
    """A line between two points."""
    return Shape(np.array([one, other]), np.array([[0, 1]]), _none())


def polyline(points: NDArray) -> Shape:
    """Lines from each point to the next."""
    first = np.arange(len(points) - 1)
    return Shape(points, np.column_stack([first, first + 1]), _none())


def across_of(axis: NDArray) -> tuple[NDArray, NDArray]:
    """Two directions at right angles to an axis and to each other."""
    side = np.cross(np.eye(3)[np.argmin(np.abs(axis))], axis)
    side /= np.linalg.norm(side)
    return side, np.cross(axis, side)


def joined(shapes: Sequence[Shape]) -> Shape:
    """Several shapes as one."""
    first = np.cumsum([0, *(len(shape.points) for shape in shapes[:-1])])
    return Shape(np.concatenate([shape.points for shape in shapes]),
                 np.concatenate([k + shape.lines for k, shape in zip(first, shapes, strict=True)]),
                 np.concatenate([k + shape.triangles
                                 for k, shape in zip(first, shapes, strict=True)]))


def circle(radius: float, u: NDArray, v: NDArray, centre: ArrayLike = (0.0, 0.0, 0.0)) -> Shape:
    """A circle in the plane of two directions."""
    angle = 2 * np.pi * np.arange(AROUND)[:, None] / AROUND
    return Shape(np.asarray(centre) + radius * (np.cos(angle) * u + np.sin(angle) * v),
                 _loop(AROUND), _none())


def _loop(count: int) -> NDArray:
    """Lines around a polygon."""
    return np.column_stack([np.arange(count), (np.arange(count) + 1) % count])


def _between_rows(rows: int, inside: bool) -> NDArray:
    """Triangles between neighbouring circles."""
    one, next_one = _loop(AROUND).T
    row = np.concatenate([np.column_stack([one, next_one, AROUND + one]),
                          np.column_stack([next_one, AROUND + next_one, AROUND + one])])
    triangles = np.concatenate([k * AROUND + row for k in range(rows)])
    return triangles[:, ::-1] if inside else triangles


def _both_sides(triangles: NDArray) -> NDArray:
    return np.concatenate([triangles, triangles[:, ::-1]])


def _none() -> NDArray:
    return np.zeros((0, 3), dtype=int)
