"""Pitch circles of gears, which roll on each other or have a belt; racks, and threads of screws."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.pictures.contact_shapes import Shape, across_of, circle, joined, line

PARALLEL = 1e-6         # sine of the angle between axes that are parallel but for rounding
MEET = 1e-3             # distance of axes that meet, of the extent
LARGEST = 3.0           # radius of a ring, of the distance of the axes: a belt is drawn beyond
PULLEYS = 0.5           # sum of the radii of pulleys, likewise
ALONE = 0.1             # largest radius where no place of the axes gives one, of the extent
PITCH, MOST = 8, 160    # teeth of the smaller wheel, most that are drawn of one
TOOTH = 0.08            # length of a tooth, of the smaller radius
RACK = 1.5 * np.pi      # half the length of a rack, of the radius of its pinion
THREAD = 0.02, 0.12     # radius and length of a thread, of the extent
TURNS = 16              # most that are drawn of a thread


class Wheel(NamedTuple):
    """A pitch circle."""

    centre: NDArray         # (3,)
    axis: NDArray           # (3,)
    radius: float
    towards: NDArray        # (3,) unit vector from the centre to where it touches the other
    ring: bool = False      # whether its teeth are inside


class Gearing(NamedTuple):
    """Two wheels, and whether a belt joins them."""

    wheels: tuple[Wheel, Wheel]
    belt: bool = False


def gearing(points: NDArray, axes: NDArray, ratio: float, size: float) -> Gearing:
    """Wheels whose rates about the axes have a ratio, where they roll on each other.

    On parallel axes radii follow from the distance of the axes, and from the sense whether one is a
    ring; wheels of the same sense that would be large have a belt. On axes that meet they are the
    ends of cones that roll on each other, on others they touch on the shortest line between them.

    Parameters
    ----------
    points, axes : (2, 3)
        A point of each axis, where a wheel may be, and its unit vector.
    ratio : float
        Rate about the first axis over that about the second.
    size : float
        Characteristic length of the model [length].
    """
    e, f = axes
    across = np.cross(e, f)
    if np.linalg.norm(across) < PARALLEL:
        return _parallel(points, e, f, ratio * np.sign(e @ f), size)
    feet = _nearest(points, axes)
    apart = feet[1] - feet[0]
    if np.linalg.norm(apart) < MEET * size:
        return _cones(feet.mean(axis=0), points, axes, ratio, size)
    return _outside(feet, axes, ratio)


def wheel(one: Wheel, other: Wheel) -> Shape:
    """A pitch circle, about the origin of space: teeth, and a spoke that turns with it."""
    u, v = one.towards, np.cross(one.axis, one.towards)
    small = min(one.radius, other.radius)
    pitch = 2.0 * np.pi * small / PITCH
    count = min(int(np.pi * one.radius / pitch), MOST // 2)
    angle = np.arange(-count, count + 1)[:, None] * pitch / one.radius
    way = np.cos(angle) * u + np.sin(angle) * v
    inner = one.radius + (TOOTH if one.ring else -TOOTH) * small
    teeth = [line(one.centre + one.radius * w, one.centre + inner * w) for w in way]
    rim = circle(one.radius, u, v, one.centre)
    end = inner + 2.0 * TOOTH * small if one.ring else 0.0
    spoke = line(one.centre + one.radius * u, one.centre + end * u)
    return joined([rim, *teeth, spoke])


def belt(one: Wheel, other: Wheel) -> Shape:
    """The straight parts of a belt around two wheels."""
    away = other.centre - one.centre
    distance = np.linalg.norm(away)
    u, v = away / distance, np.cross(one.axis, away / distance)
    cosine = (one.radius - other.radius) / distance
    sine = np.sqrt(1.0 - cosine**2)
    return joined([line(one.centre + one.radius * way, other.centre + other.radius * way)
                   for way in (cosine * u + sine * v, cosine * u - sine * v)])


def pinion(centre: NDArray, axis: NDArray, way: NDArray, radius: float) -> tuple[Shape, Shape]:
    """A pinion, and a rack that it moves by ``radius x angle`` along a way across its axis."""
    arm = np.cross(way, axis) * np.sign(radius)
    arm, size = arm / np.linalg.norm(arm), abs(radius)
    own = Wheel(centre, axis, size, arm)
    middle, half = centre + size * arm, RACK * size * way
    pitch = 2.0 * np.pi * size / PITCH
    count = int(RACK * size / pitch)
    teeth = [line(middle + k * pitch * way, middle + k * pitch * way + TOOTH * size * arm)
             for k in range(-count, count + 1)]
    return wheel(own, own), joined([line(middle - half, middle + half), *teeth])


def thread(centre: NDArray, axis: NDArray, lead: float, size: float) -> Shape:
    """A helix about an axis that advances by the lead in a radian."""
    radius, length = (part * size for part in THREAD)
    count = min(max(1.0, length / (2.0 * np.pi * abs(lead))), TURNS)
    angle = np.linspace(-np.pi * count, np.pi * count, int(24 * count) + 1)
    u, v = across_of(axis)
    points = centre + radius * (np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)) \
        + np.outer(lead * angle, axis)
    places = np.arange(len(points) - 1)
    return Shape(points, np.column_stack([places, places + 1]), np.zeros((0, 3), dtype=int))


def _parallel(points: NDArray, e: NDArray, f: NDArray, ratio: float, size: float) -> Gearing:
    """Spur gears; the ratio is that of rates about the same direction."""
    middle = points.mean(axis=0)
    centres = points - np.outer((points - middle) @ e, e)
    away = centres[1] - centres[0]
    distance, size_of_ratio = float(np.linalg.norm(away)), abs(ratio)
    if distance < MEET * size:          # one behind the other
        u, radius = across_of(e)[0], ALONE * size / max(1.0, size_of_ratio)
        return Gearing((Wheel(points[0], e, radius, u), Wheel(points[1], f,
                                                              size_of_ratio * radius, u)))
    if ratio < 0:
        return _outside(centres, np.array([e, f]), ratio)
    u = away / distance
    radius = distance / max(abs(size_of_ratio - 1.0), 1e-12)
    if radius * max(size_of_ratio, 1.0) > LARGEST * distance:
        first = PULLEYS * distance / (1.0 + size_of_ratio)
        return Gearing((Wheel(centres[0], e, first, u),
                        Wheel(centres[1], f, size_of_ratio * first, -u)), belt=True)
    u = -u if size_of_ratio > 1.0 else u        # from the axis of the ring to the other
    return Gearing((Wheel(centres[0], e, radius, u, ring=size_of_ratio < 1.0),
                    Wheel(centres[1], f, size_of_ratio * radius, u, ring=size_of_ratio > 1.0)))


def _outside(centres: NDArray, axes: NDArray, ratio: float) -> Gearing:
    """Wheels beside each other that touch on the line between their centres."""
    away = centres[1] - centres[0]
    distance = float(np.linalg.norm(away))
    first = distance / (1.0 + abs(ratio))
    return Gearing((Wheel(centres[0], axes[0], first, away / distance),
                    Wheel(centres[1], axes[1], distance - first, -away / distance)))


def _cones(tip: NDArray, points: NDArray, axes: NDArray, ratio: float, size: float) -> Gearing:
    """Bevel gears: cones with the same tip, which have no velocity where they touch.

    Along p it is ``(w_1 e_1 - w_2 e_2) x p = 0`` with ``w_1 = ratio w_2``.
    """
    p = ratio * axes[0] - axes[1]
    p = p / np.linalg.norm(p)
    along = np.einsum("kd,kd->k", points - tip, axes)
    p = p if (axes @ p) @ along >= 0.0 else -p      # on the side of the shafts
    cosines = axes @ p
    known = (np.abs(along) > MEET * size) & (np.abs(cosines) > 0.1)
    length = (float(np.mean(np.abs(along[known] / cosines[known]))) if known.any()
              else ALONE * size)
    wheels = []
    for axis, cosine in zip(axes, cosines, strict=True):
        centre = tip + length * cosine * axis
        arm = tip + length * p - centre
        wheels.append(Wheel(centre, axis, float(np.linalg.norm(arm)), arm / np.linalg.norm(arm)))
    return Gearing((wheels[0], wheels[1]))


def _nearest(points: NDArray, axes: NDArray) -> NDArray:
    """The ends of the shortest line between two axes, (2, 3)."""
    A = np.column_stack([axes[0], -axes[1]])
    along = np.linalg.lstsq(A, points[1] - points[0], rcond=None)[0]
    return points + along[:, None] * axes
