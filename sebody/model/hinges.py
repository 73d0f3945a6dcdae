"""Axes about and along which two nodes may move against each other, from their joints."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics.errors import InputError
from sebody.basics.tabular import vector
from sebody.model.arguments import along, dof_block, known, turning_axes
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import pair
from sebody.model.parts import COUPLING, SLIDES, TURNS, DofBlock, Element, Joint, Node

HINGES = (*TURNS, "planar")     # joints whose nodes turn about one axis against each other
RIGID = ("weld", "prismatic")   # and those whose nodes do not turn
PARALLEL = 1e-6                 # one less the cosine of axes that are the same
NORMAL = 1e-6                   # cosine of axes of which one has no part along the other
Z = (0.0, 0.0, 1.0)


def about(model: Mechanism, of: Joint | Node | str, axis: ArrayLike | None,
          to: Node | str | None, what: str
          ) -> tuple[Node, Node, tuple[NDArray, NDArray, NDArray] | None]:
    """Nodes and axes of what acts about the axis of a hinge.

    Parameters
    ----------
    of : Joint, Node or str
        The hinge, or a node that turns against `to` (the ground).
    axis : array_like, optional
        By default that of the hinges between the nodes, else of those of the node, else z.

    Returns
    -------
    node, to, axes as of `turning_axes`

    Raises
    ------
    InputError
        A joint that does not turn about one axis, or one with an axis or a node beside it; a node
        with hinges about several axes.
    """
    joint = _joint(model, of, axis, to, what)
    if joint is None:
        assert not isinstance(of, Joint)
        a, b = pair(model, of, to, what, ("rotation",))
        if axis is None:
            axis = Z if model.planar else _common_axis(model, a, b, what)
        return a, b, turning_axes(model, axis, what, a, signed=True)
    if joint.kind not in TURNS:
        raise InputError(f"{what}: {joint.name!r} is a {joint.kind}, which does not turn about one "
                         f"axis: give a {' or '.join(TURNS)} joint")
    vectors = None if model.planar else turning_axes(model, joint.axis, what, joint.node)
    return joint.node, joint.to, vectors


def slide_of(model: Mechanism, of: Joint | Node | str, axis: ArrayLike | None,
             to: Node | str | None, what: str) -> tuple[Node, Node, Node, NDArray]:
    """Nodes of what acts along the way of a joint, the one that carries its axes, and these axes.

    Raises
    ------
    InputError
        A joint that does not slide, or one with an axis or a node beside it; a node without axis.
    """
    joint = _joint(model, of, axis, to, what)
    if joint is None:
        assert not isinstance(of, Joint)
        a, b = pair(model, of, to, what)
        if axis is None:
            raise InputError(f"{what} at {a.name!r} has no axis: give axis=, or a joint in place "
                             "of the node")
        return a, b, a, np.column_stack(along(model, axis, what, a))
    if joint.kind not in SLIDES:
        remedy = ("prescribe its way by drive_way" if joint.kind == "path" else
                  f"give a {' or '.join(SLIDES)} joint")
        raise InputError(f"{what}: {joint.name!r} is a {joint.kind}, which does not slide along "
                         f"one axis: {remedy}")
    return joint.node, joint.to, joint.own_axes.carrier, joint.own_axes.columns


def check_axes(model: Mechanism, elements: Iterable[Element] | None = None) -> None:
    """Refuse springs and drives about, or along, axes that joints between their nodes forbid.

    Parameters
    ----------
    elements : iterable of Element, optional
        By default all of the model, which may be older than the joints.

    Raises
    ------
    InputError
        The message names both and the axis of the joint.
    """
    turning, sliding = _between(model, "rotation"), _between(model, "position")
    for one in (*model.loads, *model.constraints) if elements is None else elements:
        kind = one.kind.removeprefix("planar_")
        if kind in ("torsion_spring", "table_torsion_spring", "turn_drive"):
            a, b = (place.node for place in one.attachments)
            axis = None if model.planar else np.cross(
                one.vector("n"), one.vector("m")) + 0.0       # no -0
            for joint in turning.get(_key(a, b, "rotation"), ()):
                _check_turn(one, axis, joint)
        elif kind == "slide_drive":
            a, b = (place.node for place in one.attachments[:2])
            for joint in sliding.get(_key(a, b, "position"), ()):
                if joint.kind in SLIDES and abs(joint.axis @ one.vector("e")) < NORMAL:
                    raise _forbidden(one, one.vector("e"), joint, "along")


def _check_turn(one: Element, axis: NDArray | None, joint: Joint) -> None:
    if joint.kind in RIGID:
        raise InputError(f"{one.name!r} acts on the angle of two nodes that {joint.kind} "
                         f"{joint.name!r} keeps from turning: leave it out, or give another joint")
    if axis is None:
        return
    if joint.kind in HINGES and abs(joint.axis @ axis) < 1.0 - PARALLEL:
        raise _forbidden(one, axis, joint, "about")
    if joint.kind == "universal":
        first, second, normal = joint.own_axes.columns.T
        if abs(normal @ axis) > 1.0 - PARALLEL:
            raise InputError(
                f"{one.name!r} is about {vector(axis)}, which {joint.kind} {joint.name!r} forbids, "
                f"since it turns about {vector(first)} and {vector(second)}: give one of these as "
                "axis=")


def _forbidden(one: Element, axis: NDArray, joint: Joint, how: str) -> InputError:
    does = "turns about" if how == "about" else "slides along"
    return InputError(
        f"{one.name!r} is {how} {vector(axis)}, which {joint.kind} {joint.name!r} forbids, since "
        f"it {does} {vector(joint.axis)}: give the joint {joint.name!r} in place of the node, once "
        "it is made, or its axis")


def _joint(model: Mechanism, of: Joint | Node | str, axis: ArrayLike | None,
           to: Node | str | None, what: str) -> Joint | None:
    """The joint that is given; none where it is a node."""
    named = [one for one in model.joints if one is of or one.name == of]
    if isinstance(of, str) and of in model.nodes:
        if named and axis is None and to is None and (
                model.nodes[of] is not named[0].node or named[0].to not in model.grounds):
            raise InputError(f"{what}: {of!r} is a node and a joint, of other nodes: give the "
                             "Joint or the Node itself")
        return None
    if not named:
        if isinstance(of, Joint):
            raise InputError(f"{what}: joint {of.name!r} is of another model: use that of this one")
        known(model, of)        # refuses what is no node
        return None
    if axis is not None or to is not None:
        raise InputError(f"{what} is given joint {named[0].name!r}, which has an axis and two "
                         "nodes: leave axis and to out")
    return named[0]


def _common_axis(model: Mechanism, a: Node, b: Node, what: str) -> NDArray | tuple:
    """The axis of the hinges between two nodes, else of those of the first node."""
    hinges = [one for one in model.joints if one.kind in HINGES]
    ends, own = _key(a, b, "rotation"), _end(a, "rotation")
    for found in ([one for one in hinges if _key(one.node, one.to, "rotation") == ends],
                  [one for one in hinges if _end(one.node, "rotation") == own],
                  [one for one in hinges if _end(one.to, "rotation") == own]):
        if not found:
            continue
        if any(one.axis @ found[0].axis < 1.0 - PARALLEL for one in found):
            raise InputError(f"{what}: node {a.name!r} has hinges about several axes, "
                             f"{', '.join(repr(one.name) for one in found)}: give one of these "
                             "joints in place of the node, or axis=")
        return found[0].axis
    return Z


def _between(model: Mechanism, kind: str) -> dict[frozenset, list[Joint]]:
    """Joints that always act, by what they are between."""
    found: dict[frozenset, list[Joint]] = {}
    for joint in model.joints:
        if joint.kind not in ("drive", "distance", "path", COUPLING) and (
                joint.name not in model.switches) and all(
                getattr(node, kind) is not None for node in (joint.node, joint.to)):
            found.setdefault(_key(joint.node, joint.to, kind), []).append(joint)
    return found


def _key(a: Node, b: Node, kind: str) -> frozenset:
    return frozenset((_end(a, kind), _end(b, kind)))


def _end(node: Node, kind: str) -> DofBlock | None:
    """The block by which nodes are the same; none of what is fixed, as the ground."""
    block = dof_block(node, kind)
    return None if block.fixed and not block.motions else block
