"""Equations of joints: a small family of generated constraints, and what nodes share instead."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import chosen_name, dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import NEAR, check_together, on_ground
from sebody.model.parts import (
    Attachment,
    Axes,
    Connection,
    Element,
    Joint,
    Node,
    Way,
    positions,
    rotations,
)
from sebody.model.sharing import can_share, share
from sebody.model.time_functions import TimeFunction

STILL = TimeFunction((0.0,), ((0.0,),))     # of drives that hold what they would move


class Equations(NamedTuple):
    """A constraint of a joint that has no name yet."""

    kind: str
    attachments: tuple[Attachment, ...]
    constants: Mapping[str, float | NDArray]
    multipliers: int
    time_function: TimeFunction | None = None


def named(model: Mechanism, name: str | None, what: str, a: Node) -> str:
    """The name of a joint, by default its kind and its node."""
    return chosen_name(model, name, f"{what.removesuffix(' joint')} at {a.name}", ("node",))


def add_joint(model: Mechanism, what: str, name: str, node: Node, to: Node,
              equations: list[Equations], axes: Axes | None, shared: tuple[str, ...] = ()) -> Joint:
    """Add a joint between two nodes, some of whose DOF blocks are shared or fixed."""
    joint = Joint(name, tuple(Element(name, *one) for one in equations), node, to, axes,
                  what.removesuffix(" joint"))
    model.joints.append(joint)
    other = to if model.nodes.get(to.name) is to else None
    model.connections += [Connection(kind, node, other, joint) for kind in shared]
    return joint


def together(model: Mechanism, a: Node, b: Node, to: Node | str | None, what: str,
             explicit: bool) -> list[Equations]:
    """Make two positions one: shared or fixed, else by the equations that are returned."""
    inputs.flag(explicit, f"explicit of the {what}")
    check_together(model, a, b, what)
    one, other = dof_block(a, "position"), dof_block(b, "position")
    if explicit and one is other:
        raise InputError(f"{what}: nodes {a.name!r} and {b.name!r} share their position "
                         "already: leave the joint out")
    if on_ground(model, to):
        if explicit or one.root is not None:
            return [Equations(model.kind_of("coincident_ground"), positions(a), {"c": a.point},
                              model.dimension)]
        one.fixed = True
    elif explicit or not can_share(one, other):
        return [Equations(model.kind_of("coincident"), positions(a, b), {}, model.dimension)]
    else:
        share(model, other, one, "position")
    return []


def parallel(a: Node, b: Node | None, vectors: tuple[NDArray, NDArray, NDArray]) -> Equations:
    """An axis of b, or of the ground, stays normal to two directions of a."""
    constants = dict(zip(("e", "n1", "n2"), vectors, strict=True))
    if b is None:
        return Equations("parallel_ground", rotations(a), constants, 2)
    return Equations("parallel", rotations(a, b), constants, 2)


def perpendicular(a: Node, b: Node, e: NDArray, n: NDArray) -> Equations:
    """A direction e of b stays normal to a direction n of a."""
    return Equations("perpendicular", rotations(a, b), {"e": e, "n": n}, 1)


def turn_together(model: Mechanism, a: Node, b: Node) -> list[Equations]:
    """Two nodes keep their relative rotation."""
    if model.planar:
        return [Equations("planar_aligned", rotations(a, b), {}, 1)]
    e, n, m = np.eye(3)
    return [parallel(a, b, (e, n, m)), perpendicular(a, b, m, n)]


def locked(model: Mechanism, a: Node, b: Node) -> list[Equations]:
    """Two nodes keep a relative pose, at first that of the start; see `phases.locked_as_now`."""
    equations = []
    for e in np.eye(model.dimension):
        way = Way.of(a, b, Axes(b, e[:, None]))
        equations.append(Equations(model.kind_of("slide_drive"), way.attachments,
                                   {"e": way.direction, "start": way.start}, 1, STILL))
    if model.planar:
        return [*equations, Equations("planar_turn_drive", rotations(a, b), {}, 1, STILL)]
    return equations + turn_together(model, a, b)


def on_line(model: Mechanism, what: str, a: Node, b: Node, normals: tuple[NDArray, ...]
            ) -> Equations:
    """A point of b stays on a line through a, which turns with a."""
    for normal in normals:
        if abs(normal @ (b.point - a.point)) > NEAR * model.size():
            raise InputError(f"{what}: node {b.name!r} is off the axis through "
                             f"{a.name!r}: place it there or turn the axis")
    return Equations(model.kind_of("on_line"), positions(a, b) + rotations(a),
                     {f"n{k}": normal for k, normal in enumerate(normals, 1)}, len(normals))


def refuse_plane(model: Mechanism, what: str) -> None:
    """Refuse a joint of space in a planar model."""
    if model.planar:
        raise InputError(f"{what}: the model is planar: use Model(), or a revolute or "
                         "prismatic joint")
