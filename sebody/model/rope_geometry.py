"""The way of a rope at the start: spans between points and sheaves, angles of contact."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model.parts import Node
from sebody.model.rope_parts import RopePlace, Sheave

Z = np.array([0.0, 0.0, 1.0])
OFF = 1e-6          # sine of the angle by which a rope may be off the plane of a sheave
ROUNDED = 1e-9      # of a turn: angles of contact below are none
TURN = 2.0 * np.pi


class Span(NamedTuple):
    """The straight part of a rope from one place to the next."""

    a: RopePlace
    b: RopePlace
    length: float
    direction: NDArray      # unit vector, (3,)


def spans_of(what: str, places: Sequence[tuple[Node, Sheave | None]], signs: Sequence[float]
             ) -> tuple[list[RopePlace], list[Span]]:
    """Places with their angles of contact, and the spans between them.

    Raises
    ------
    InputError
        A place at or inside the next one, a rope that is not in the plane of a sheave.
    """
    made = _sided(what, places, signs)
    straight = [_straight(what, a, b) for a, b in zip(made, made[1:], strict=False)]
    for k in range(1, len(made) - 1):
        if made[k].sheave is not None:
            before, after = straight[k - 1][1], straight[k][1]
            angle = np.arctan2(made[k].normal @ np.cross(before, after), before @ after)
            wrap = np.sign(made[k].radius) * angle % TURN
            if TURN - wrap < ROUNDED * TURN:
                wrap = 0.0
            made[k] = made[k]._replace(wrap=float(wrap))
    return made, [Span(a, b, *one) for a, b, one in zip(made, made[1:], straight, strict=False)]


def _sided(what: str, places: Sequence[tuple[Node, Sheave | None]], signs: Sequence[float]
           ) -> list[RopePlace]:
    """Places with signed radii: sheaves that follow each other are seen from one side."""
    made: list[RopePlace] = []
    for (node, sheave), sign in zip(places, signs, strict=True):
        if sheave is None:
            made.append(RopePlace(node, None, 0.0, Z, 0.0))
            continue
        before = made[-1] if made and made[-1].sheave is not None else None
        normal = sheave.axis
        if before is not None:
            if np.linalg.norm(np.cross(before.normal, normal)) > OFF:
                assert before.sheave is not None
                raise InputError(f"{what}: sheaves {before.sheave.name!r} and {sheave.name!r} have "
                                 "axes that are not parallel: turn one of them, or lead the rope "
                                 "through a point between them")
            if before.normal @ normal < 0.0:
                normal, sign = -normal, -sign
        made.append(RopePlace(node, sheave, sign * sheave.radius, normal, 0.0))
    return made


def _straight(what: str, a: RopePlace, b: RopePlace) -> tuple[float, NDArray]:
    """Length and direction of a span."""
    d = np.zeros(3)
    d[:len(a.node.point)] = b.node.point - a.node.point
    distance, difference = float(np.linalg.norm(d)), b.radius - a.radius
    names = [repr(one.node.name if one.sheave is None else one.sheave.name) for one in (a, b)]
    if not distance > 0.0:
        raise InputError(f"{what}: {names[0]} and {names[1]} are at one point: give places that "
                         "lie apart")
    for one in (a, b):
        if one.sheave is not None and abs(one.normal @ d) > OFF * distance:
            off = np.degrees(np.arcsin(min(float(abs(one.normal @ d)) / distance, 1.0)))
            raise InputError(f"{what}: from {names[0]} to {names[1]} it leaves the plane of sheave "
                             f"{one.sheave.name!r} by {off:.3g} degrees: turn the axis of the "
                             "sheave, or move one of the nodes")
    if not distance > abs(difference):
        raise InputError(f"{what}: {names[0]} and {names[1]} are {distance:.6g} apart and overlap: "
                         "move them apart, or give smaller radii")
    length = float(np.sqrt(distance**2 - difference**2))
    if a.sheave is None and b.sheave is None:
        return length, d / distance
    normal = a.normal if a.sheave is not None else b.normal
    along, across = d / distance, np.cross(normal, d / distance)
    return length, (length * along - difference * across) / distance
