"""Joints of a model, built from a small family of generated constraints.

A joint takes no equation where its nodes can share a block instead. With ``explicit=True`` it is
built from equations alone. Every joint takes a name, by default its kind and its node. Its force
and its moment are those on `node`, the first of its arguments, from `to` or the ground, see
`sebody.Result`; a joint with an axis has axes whose first direction is this axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import along, axes, chosen_name, dof_block, known, turning_axes
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import NEAR, check_together, on_ground, pair
from sebody.model.parts import (
    Attachment,
    Axes,
    Connection,
    Element,
    Joint,
    Node,
    positions,
    rotations,
)
from sebody.model.sharing import can_share, hold, share


class Equations(NamedTuple):
    """A constraint of a joint that has no name yet."""

    kind: str
    attachments: tuple[Attachment, ...]
    constants: Mapping[str, float | NDArray]
    multipliers: int


def fix(model: Mechanism, node: Node | str, what: str = "both") -> None:
    """Fix a node's position, rotation or both: fixed DOF blocks are no unknowns.

    Parameters
    ----------
    what : {'both', 'position', 'rotation'}
        ``'translation'``, as nodes keep it, is the position.

    Raises
    ------
    InputError
        The position is a dependent one, at the end of a rigid link.
    """
    node = known(model, node)
    if not isinstance(what, str) or what not in ("position", "translation", "rotation", "both"):
        raise InputError(f"cannot fix {what!r}: use position, rotation or both")
    kinds = ("position", "rotation") if what == "both" else (
        "position" if what == "translation" else what,)
    for kind in kinds:
        dof_block(node, kind)
    for kind in kinds:
        hold(model, node, kind)


def revolute(model: Mechanism, node: Node | str, axis: ArrayLike = (0.0, 0.0, 1.0),
             to: Node | str | None = None, explicit: bool = False,
             name: str | None = None) -> Joint:
    """Revolute joint about an axis through a node, to the ground or to another node.

    Its angle is that of `node` against `to`, about the axis; so are limits, drives and actuators.
    Two multipliers in space, none in a plane: positions are shared or fixed.
    """
    what = "revolute joint"
    a, b = pair(model, node, to, what)
    vectors = turning_axes(model, axis, what, a)
    name = _named(model, name, what, a)
    equations = _together(model, a, b, to, what, explicit)
    shared = () if equations else ("position",)
    if vectors:
        grounded = on_ground(model, to) and not explicit
        equations.append(_parallel(a, None if grounded else b, vectors))
    return _joint(model, what, name, a, b, equations, Axes.of(a, vectors), shared)


def universal(model: Mechanism, node: Node | str, axis: ArrayLike, other: ArrayLike,
              to: Node | str | None = None, explicit: bool = False,
              name: str | None = None) -> Joint:
    """Universal joint: `axis`, fixed in `node`, and `other`, fixed in `to`, stay normal."""
    what = "universal joint"
    _spatial(model, what)
    a, b = pair(model, node, to, what)
    n, e = (axes(model, v, what, a)[0] for v in (axis, other))
    if abs(n @ e) > 1e-9:
        raise InputError(f"universal joint at {a.name!r}: its axes are at an angle of "
                         f"{np.degrees(np.arccos(np.clip(abs(n @ e), 0, 1))):.4g} degrees: "
                         "give two that are normal to each other")
    name = _named(model, name, what, a)
    equations = _together(model, a, b, to, what, explicit)
    shared = () if equations else ("position",)
    return _joint(model, what, name, a, b, [*equations, _perpendicular(a, b, e, n)],
                  Axes.of(a, (n, e, np.cross(n, e))), shared)


def cylindrical(model: Mechanism, node: Node | str, axis: ArrayLike,
                to: Node | str | None = None, name: str | None = None) -> Joint:
    """Cylindrical joint: `node` slides along and turns about an axis that is fixed in it.

    Its displacement and angle are those of `node` against `to` (the ground), along and about the
    axis; so are limits, drives and actuators.
    """
    what = "cylindrical joint"
    _spatial(model, what)
    a, b = pair(model, node, to, what)
    vectors = axes(model, axis, what, a)
    equations = [_on_line(model, "cylindrical", a, b, vectors[1:]), _parallel(a, b, vectors)]
    return _joint(model, what, _named(model, name, what, a), a, b, equations,
                  Axes.of(a, vectors))


def prismatic(model: Mechanism, node: Node | str, axis: ArrayLike,
              to: Node | str | None = None, name: str | None = None) -> Joint:
    """Prismatic joint: `node` slides along an axis that is fixed in it, and turns with `to`.

    Its displacement is that of `node` against `to` (the ground) along the axis; so are limits,
    drives and actuators.
    """
    what = "prismatic joint"
    a, b = pair(model, node, to, what)
    vectors = along(model, axis, what, a)
    equations = [_on_line(model, "prismatic", a, b, vectors[1:]), *_turn_together(model, a, b)]
    return _joint(model, what, _named(model, name, what, a), a, b, equations,
                  Axes.of(a, vectors))


def slider(model: Mechanism, node: Node | str, axis: ArrayLike,
           to: Node | str | None = None, name: str | None = None) -> Joint:
    """Point on a line: `node` slides along an axis through its place, fixed in `to`.

    Its displacement is that of `node` against `to` (the ground) along the axis; so are limits,
    drives and actuators.
    """
    what = "slider"
    b, a = pair(model, node, to, what, ("position",))
    vectors = along(model, axis, what, b)
    dof_block(a, "rotation")
    equations = [_on_line(model, what, a, b, vectors[1:])]
    return _joint(model, what, _named(model, name, what, a), b, a, equations,
                  Axes.of(a, vectors))


def planar_joint(model: Mechanism, node: Node | str, normal: ArrayLike,
                 to: Node | str | None = None, name: str | None = None) -> Joint:
    """Planar joint: `to` stays in a plane through and fixed in `node`, and parallel to it."""
    what = "planar joint"
    _spatial(model, what)
    a, b = pair(model, node, to, what)
    vectors = axes(model, normal, what, a)
    on_plane = Equations("on_plane", positions(a, b) + rotations(a), {"n1": vectors[0]}, 1)
    name = chosen_name(model, name, f"{what} at {a.name}", ("node",))
    return _joint(model, what, name, a, b, [on_plane, _parallel(a, b, vectors)],
                  Axes.of(a, vectors))


def spherical(model: Mechanism, node: Node | str, to: Node | str | None = None,
              explicit: bool = True, name: str | None = None) -> Joint:
    """Spherical joint as an explicit constraint with one multiplier for each direction.

    For comparison: `fix(node, "position")`, or a second node made with ``at=``, is the same
    joint with fewer unknowns, and so is ``explicit=False``.
    """
    what = "spherical joint"
    a, b = pair(model, node, to, what, ("position",))
    name = _named(model, name, what, a)
    equations = _together(model, a, b, to, what, explicit)
    return _joint(model, what, name, a, b, equations, Axes.of(a),
                  () if equations else ("position",))


def weld(model: Mechanism, node: Node | str, to: Node | str | None = None,
         explicit: bool = False, name: str | None = None) -> Joint:
    """Join two nodes rigidly: they share both blocks, or with ``explicit=True`` by equations."""
    a, b = pair(model, node, to, "weld")
    name = _named(model, name, "weld", a)
    equations = _together(model, a, b, to, "weld", explicit)
    shared: tuple[str, ...] = () if equations else ("position",)
    one, other = dof_block(a, "rotation"), dof_block(b, "rotation")
    if explicit or not (on_ground(model, to) or can_share(one, other)):
        equations += _turn_together(model, a, b)
    else:
        shared += ("rotation",)
        if on_ground(model, to):
            one.fixed = True
        else:
            share(model, other, one, "rotation")
    return _joint(model, "weld", name, a, b, equations, Axes.of(a), shared)


def distance(model: Mechanism, node: Node | str, to: Node | str,
             name: str | None = None) -> Joint:
    """Two points keep the distance they start at: a massless rod with ball joints."""
    a, b = pair(model, node, known(model, to), "distance", ("position",))
    length = float(np.linalg.norm(b.point - a.point))
    if not length > NEAR * model.size():
        raise InputError(f"distance between {a.name!r} and {b.name!r} is zero: use a spherical "
                         "joint for nodes that coincide")
    rod = Equations(model.kind_of("distance"), positions(a, b), {"length": length}, 1)
    return _joint(model, "distance", _named(model, name, "distance", a), a, b, [rod], None)


def _named(model: Mechanism, name: str | None, what: str, a: Node) -> str:
    return chosen_name(model, name, f"{what.removesuffix(' joint')} at {a.name}", ("node",))


def _joint(model: Mechanism, what: str, name: str, node: Node, to: Node,
           equations: list[Equations], axes: Axes | None, shared: tuple[str, ...] = ()) -> Joint:
    """Add a joint between two nodes, some of whose DOF blocks are shared or fixed."""
    joint = Joint(name, tuple(Element(name, *one) for one in equations), node, to, axes,
                  what.removesuffix(" joint"))
    model.joints.append(joint)
    other = to if model.nodes.get(to.name) is to else None
    model.connections += [Connection(kind, node, other, joint) for kind in shared]
    return joint


def _together(model: Mechanism, a: Node, b: Node, to: Node | str | None, what: str,
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


def _parallel(a: Node, b: Node | None, vectors: tuple[NDArray, NDArray, NDArray]) -> Equations:
    """An axis of b, or of the ground, stays normal to two directions of a."""
    constants = dict(zip(("e", "n1", "n2"), vectors, strict=True))
    if b is None:
        return Equations("parallel_ground", rotations(a), constants, 2)
    return Equations("parallel", rotations(a, b), constants, 2)


def _perpendicular(a: Node, b: Node, e: NDArray, n: NDArray) -> Equations:
    """A direction e of b stays normal to a direction n of a."""
    return Equations("perpendicular", rotations(a, b), {"e": e, "n": n}, 1)


def _turn_together(model: Mechanism, a: Node, b: Node) -> list[Equations]:
    if model.planar:
        return [Equations("planar_aligned", rotations(a, b), {}, 1)]
    e, n, m = np.eye(3)
    return [_parallel(a, b, (e, n, m)), _perpendicular(a, b, m, n)]


def _on_line(model: Mechanism, what: str, a: Node, b: Node,
             normals: tuple[NDArray, ...]) -> Equations:
    for normal in normals:
        if abs(normal @ (b.point - a.point)) > NEAR * model.size():
            raise InputError(f"{what}: node {b.name!r} is off the axis through "
                             f"{a.name!r}: place it there or turn the axis")
    return Equations(model.kind_of("on_line"), positions(a, b) + rotations(a),
                     {f"n{k}": normal for k, normal in enumerate(normals, 1)}, len(normals))


def _spatial(model: Mechanism, what: str) -> None:
    if model.planar:
        raise InputError(f"{what}: the model is planar: use Model(), or a revolute or "
                         "prismatic joint")
