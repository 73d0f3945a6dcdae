"""Joints of a model, built from a small family of generated constraints.

A joint takes no equation where its nodes can share a block instead. With ``explicit=True`` it is
built from equations alone. Every joint takes a name, by default its kind and its node. Its force
and its moment are those on `node`, the first of its arguments, from `to` or the ground, see
`sebody.Result`; a joint with an axis has axes whose first direction is this axis.
"""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics.errors import InputError
from sebody.model.acting import Acting
from sebody.model.arguments import along, axes, chosen_name, dof_block, known, turning_axes
from sebody.model.joint_equations import (
    Equations,
    add_joint,
    locked,
    named,
    on_line,
    parallel,
    perpendicular,
    refuse_plane,
    together,
    turn_together,
)
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import NEAR, on_ground, pair
from sebody.model.parts import Axes, Joint, Node, positions, rotations
from sebody.model.sharing import can_share, hold, share


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
             name: str | None = None,
             **acting: Unpack[Acting]) -> Joint:
    """Revolute joint about an axis through a node, to the ground or to another node.

    Its angle is that of `node` against `to`, about the axis by the right hand, 0 at the start; so
    are limits, drives and actuators. Two multipliers in space, none in a plane: positions are
    shared or fixed.

    Parameters
    ----------
    node : Node or str
        At the place of `to`.
    axis : (3,) array_like or {"x", "y", "z"}
        Direction at the start, global axes; in a plane always out of it.
    to : Node or str, optional
        The other node, the ground by default.
    explicit : bool
        Hold the place by multipliers, not by a shared or fixed position.
    name : str, optional
        Of its results, ``<name>.angle`` and the like; by default ``revolute at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Nodes apart, or without what the joint needs.

    Examples
    --------
    >>> hinge = model.revolute("arm", (0, 1, 0), to="hub", name="hinge")
    """
    what = "revolute joint"
    a, b = pair(model, node, to, what)
    vectors = turning_axes(model, axis, what, a)
    name = named(model, name, what, a)
    explicit = True if acting else explicit
    equations = together(model, a, b, to, what, explicit)
    shared = () if equations else ("position",)
    if vectors:
        grounded = on_ground(model, to) and not explicit
        equations.append(parallel(a, None if grounded else b, vectors))
    return add_joint(model, what, name, a, b, equations, Axes.of(a, vectors), shared)


def universal(model: Mechanism, node: Node | str, axis: ArrayLike, other: ArrayLike,
              to: Node | str | None = None, explicit: bool = False,
              name: str | None = None,
              **acting: Unpack[Acting]) -> Joint:
    """Universal joint: `axis`, fixed in `node`, and `other`, fixed in `to`, stay normal.

    Turns about both axes are free and none is measured: limits, drives and sensors are of revolute
    joints, two of which with a node between them are the same joint.

    Parameters
    ----------
    node : Node or str
        At the place of `to`.
    axis, other : (3,) array_like or {"x", "y", "z"}
        Directions at the start, global axes, normal to each other.
    to : Node or str, optional
        The other node, the ground by default.
    explicit : bool
        Hold the place by multipliers, not by a shared or fixed position.
    name : str, optional
        Of its results, ``<name>.force`` and the like; by default ``universal at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Axes that are not normal to each other, nodes apart, or a planar model.

    Examples
    --------
    >>> cross = model.universal("arm", (1, 0, 0), (0, 1, 0), to="hub", name="cross")
    """
    what = "universal joint"
    refuse_plane(model, what)
    a, b = pair(model, node, to, what)
    n, e = (axes(model, v, what, a)[0] for v in (axis, other))
    if abs(n @ e) > 1e-9:
        raise InputError(f"universal joint at {a.name!r}: its axes are at an angle of "
                         f"{np.degrees(np.arccos(np.clip(abs(n @ e), 0, 1))):.4g} degrees: "
                         "give two that are normal to each other")
    name = named(model, name, what, a)
    explicit = True if acting else explicit
    equations = together(model, a, b, to, what, explicit)
    shared = () if equations else ("position",)
    return add_joint(model, what, name, a, b, [*equations, perpendicular(a, b, e, n)],
                  Axes.of(a, (n, e, np.cross(n, e))), shared)


def cylindrical(model: Mechanism, node: Node | str, axis: ArrayLike,
                to: Node | str | None = None, name: str | None = None,
                **acting: Unpack[Acting]) -> Joint:
    """Cylindrical joint: `node` slides along and turns about an axis that is fixed in it.

    Its displacement and angle are those of `node` against `to` (the ground), along and about the
    axis, 0 at the start; so are limits, drives and actuators.

    Parameters
    ----------
    node : Node or str
        On the axis through `to`.
    axis : (3,) array_like or {"x", "y", "z"}
        Direction at the start, global axes.
    to : Node or str, optional
        The other node, the ground by default.
    name : str, optional
        Of its results, ``<name>.displacement`` and the like; by default ``cylindrical at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        `to` off the axis, or a planar model.

    Examples
    --------
    >>> sleeve = model.cylindrical("cart", (1, 0, 0), to="hub", name="sleeve")
    """
    what = "cylindrical joint"
    refuse_plane(model, what)
    a, b = pair(model, node, to, what)
    vectors = axes(model, axis, what, a)
    equations = [on_line(model, "cylindrical", a, b, vectors[1:]), parallel(a, b, vectors)]
    return add_joint(model, what, named(model, name, what, a), a, b, equations,
                  Axes.of(a, vectors))


def prismatic(model: Mechanism, node: Node | str, axis: ArrayLike,
              to: Node | str | None = None, name: str | None = None,
              **acting: Unpack[Acting]) -> Joint:
    """Prismatic joint: `node` slides along an axis that is fixed in it, and turns with `to`.

    Its displacement is that of `node` against `to` (the ground) along the axis, 0 at the start; so
    are limits, drives and actuators.

    Parameters
    ----------
    node : Node or str
        On the axis through `to`.
    axis : (3,), planar (2,) array_like or {"x", "y", "z"}
        Direction at the start, global axes.
    to : Node or str, optional
        The other node, the ground by default.
    name : str, optional
        Of its results, ``<name>.displacement`` and the like; by default ``prismatic at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        `to` off the axis.

    Examples
    --------
    >>> rail = model.prismatic("cart", (1, 0, 0), name="rail")
    """
    what = "prismatic joint"
    a, b = pair(model, node, to, what)
    vectors = along(model, axis, what, a)
    equations = [on_line(model, "prismatic", a, b, vectors[1:]), *turn_together(model, a, b)]
    return add_joint(model, what, named(model, name, what, a), a, b, equations,
                  Axes.of(a, vectors))


def slider(model: Mechanism, node: Node | str, axis: ArrayLike,
           to: Node | str | None = None, name: str | None = None,
           **acting: Unpack[Acting]) -> Joint:
    """Point on a line: `node` slides along an axis through its place, fixed in `to`.

    Its displacement is that of `node` against `to` (the ground) along the axis, 0 at the start; so
    are limits, drives and actuators. All rotations are free. For a line that bends with a flexible
    body, or is curved, use `path_joint`.

    Parameters
    ----------
    node : Node or str
        On the axis through `to`.
    axis : (3,), planar (2,) array_like or {"x", "y", "z"}
        Direction at the start, global axes.
    to : Node or str, optional
        The other node, the ground by default.
    name : str, optional
        Of its results, ``<name>.displacement`` and the like; by default ``slider at <to>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        `node` off the axis, or a `to` without rotation.

    Examples
    --------
    >>> guide = model.slider("cart", (1, 0, 0), to="hub", name="guide")
    """
    what = "slider"
    b, a = pair(model, node, to, what, ("position",))
    vectors = along(model, axis, what, b)
    dof_block(a, "rotation")
    equations = [on_line(model, what, a, b, vectors[1:])]
    return add_joint(model, what, named(model, name, what, a), b, a, equations,
                  Axes.of(a, vectors))


def planar_joint(model: Mechanism, node: Node | str, normal: ArrayLike,
                 to: Node | str | None = None, name: str | None = None,
                 **acting: Unpack[Acting]) -> Joint:
    """Planar joint: `to` stays in a plane through and fixed in `node`, and parallel to it.

    Its angle is that of `node` against `to` about the normal, 0 at the start.

    Parameters
    ----------
    node : Node or str
    normal : (3,) array_like or {"x", "y", "z"}
        Of the plane at the start, global axes.
    to : Node or str, optional
        The other node, the ground by default.
    name : str, optional
        Of its results, ``<name>.angle`` and the like; by default ``planar at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        `to` off the plane, or a planar model.

    Examples
    --------
    >>> table = model.planar_joint("cart", "z", name="table")
    """
    what = "planar joint"
    refuse_plane(model, what)
    a, b = pair(model, node, to, what)
    vectors = axes(model, normal, what, a)
    on_plane = Equations("on_plane", positions(a, b) + rotations(a), {"n1": vectors[0]}, 1)
    name = chosen_name(model, name, f"{what} at {a.name}", ("node",))
    return add_joint(model, what, name, a, b, [on_plane, parallel(a, b, vectors)],
                  Axes.of(a, vectors))


def spherical(model: Mechanism, node: Node | str, to: Node | str | None = None,
              explicit: bool = True, name: str | None = None,
              **acting: Unpack[Acting]) -> Joint:
    """Spherical joint as an explicit constraint with one multiplier for each direction.

    For comparison: `fix(node, "position")`, or a second node made with ``at=``, is the same
    joint with fewer unknowns, and so is ``explicit=False``. Its force is that of `to` on `node`.

    Parameters
    ----------
    node : Node or str
        At the place of `to`.
    to : Node or str, optional
        The other node, the ground by default.
    explicit : bool
        Hold the place by multipliers, not by a shared or fixed position.
    name : str, optional
        Of its results, ``<name>.force`` and the like; by default ``spherical at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Nodes apart.

    Examples
    --------
    >>> ball = model.spherical("arm", to="hub", name="ball")
    """
    what = "spherical joint"
    a, b = pair(model, node, to, what, ("position",))
    name = named(model, name, what, a)
    explicit = True if acting else explicit
    equations = together(model, a, b, to, what, explicit)
    return add_joint(model, what, name, a, b, equations, Axes.of(a),
                  () if equations else ("position",))


def weld(model: Mechanism, node: Node | str, to: Node | str | None = None,
         explicit: bool = False, name: str | None = None,
         **acting: Unpack[Acting]) -> Joint:
    """Join two nodes rigidly: they share both blocks, or with ``explicit=True`` by equations.

    Parameters
    ----------
    node : Node or str
        At the place of `to`; for nodes apart there is `attach`. With `from_` anywhere: it locks the
        pose of that time.
    to : Node or str, optional
        The other node, the ground by default.
    explicit : bool
        Hold place and rotation by multipliers.
    name : str, optional
        Of its results, ``<name>.moment`` and the like; by default ``weld at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Nodes apart.

    Examples
    --------
    >>> joined = model.weld("arm", to="hub", name="clamp")
    """
    a, b = pair(model, node, to, "weld")
    name = named(model, name, "weld", a)
    if "from_" in acting:
        return add_joint(model, "weld", name, a, b, locked(model, a, b), Axes.of(a))
    explicit = True if acting else explicit
    equations = together(model, a, b, to, "weld", explicit)
    shared: tuple[str, ...] = () if equations else ("position",)
    one, other = dof_block(a, "rotation"), dof_block(b, "rotation")
    if explicit or not (on_ground(model, to) or can_share(one, other)):
        equations += turn_together(model, a, b)
    else:
        shared += ("rotation",)
        if on_ground(model, to):
            one.fixed = True
        else:
            share(model, other, one, "rotation")
    return add_joint(model, "weld", name, a, b, equations, Axes.of(a), shared)


def distance(model: Mechanism, node: Node | str, to: Node | str,
             name: str | None = None,
             **acting: Unpack[Acting]) -> Joint:
    """Two points keep the distance they start at: a massless rod with ball joints.

    Its force is that on `node`, along the rod; tension pulls `node` towards `to`.

    Parameters
    ----------
    node, to : Node or str
        Apart from each other.
    name : str, optional
        Of its results, ``<name>.force`` and the like; by default ``distance at <node>``.
    **acting
        `until`, `from_`: when it acts, see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        Nodes that coincide.

    Examples
    --------
    >>> rod = model.distance("cart", "hub", name="rod")
    """
    a, b = pair(model, node, known(model, to), "distance", ("position",))
    length = float(np.linalg.norm(b.point - a.point))
    if not length > NEAR * model.size():
        raise InputError(f"distance between {a.name!r} and {b.name!r} is zero: use a spherical "
                         "joint for nodes that coincide")
    rod = Equations(model.kind_of("distance"), positions(a, b), {"length": length}, 1)
    return add_joint(model, "distance", named(model, name, "distance", a), a, b, [rod], None)
