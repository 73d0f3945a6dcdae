"""Drives: prescribed motions of nodes, and of joints by an equation."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics.errors import InputError
from sebody.model import motions
from sebody.model.arguments import (
    along,
    chosen_name,
    dof_block,
    known,
    rotation_vector,
    turning_axes,
    vector,
)
from sebody.model.histories import Source
from sebody.model.mechanism import Mechanism
from sebody.model.pairs import pair
from sebody.model.parts import (
    Attachment,
    Axes,
    Element,
    Joint,
    Motion,
    Node,
    positions,
    rotations,
)
from sebody.model.sharing import hold


def drive_angle(model: Mechanism, node: Node | str, motion: Source,
                axis: ArrayLike = (0.0, 0.0, 1.0), to: Node | str | None = None,
                name: str | None = None) -> Joint:
    """Prescribe the angle of `node` against `to` (the ground) about the axis they share.

    The joint itself is built separately. If nothing else acts on the rotation of `node` and there
    is no `to`, `move` does the same without an equation.

    Parameters
    ----------
    motion : table, function, tuple of three functions or ready profile
        The angle, counted from where the nodes start: its value at t = 0 is taken off [rad]. A
        rate that it has at t = 0 is that of the start. See `sebody.model.motions.motion`.
    """
    a, b = pair(model, node, to, "drive", ("rotation",))
    time_function = motions.motion(motion)
    vectors = turning_axes(model, axis, "drive", a, signed=True)
    constants = dict(zip(("n", "m"), vectors[1:], strict=True)) if vectors else {}
    name = chosen_name(model, name, f"angle at {a.name}", ("node",))
    equation = Element(name, model.kind_of("turn_drive"), rotations(a, b), constants, 1,
                       time_function)
    return _drive(model, Joint(name, (equation,), a, b, Axes.of(a, vectors), "drive"))


def drive_slide(model: Mechanism, node: Node | str, motion: Source, axis: ArrayLike,
                to: Node | str | None = None, name: str | None = None) -> Joint:
    """Prescribe the displacement of `to` (a point of the ground) along an axis fixed in `node`.

    Parameters
    ----------
    motion : table, function, tuple of three functions or ready profile
        The displacement, counted from where the nodes start [length]; see `drive_angle`.
    """
    a, b = pair(model, node, to, "drive")
    vectors = along(model, axis, "drive", a)
    constants = {"e": vectors[0], "start": vectors[0] @ (b.point - a.point)}
    time_function = motions.motion(motion)
    name = chosen_name(model, name, f"slide at {a.name}", ("node",))
    equation = Element(name, model.kind_of("slide_drive"), positions(a, b) + rotations(a),
                       constants, 1, time_function)
    return _drive(model, Joint(name, (equation,), a, b, Axes.of(a, vectors), "drive"))


def move(model: Mechanism, node: Node | str, direction: ArrayLike, motion: Source,
         what: str = "position", name: str | None = None) -> Motion:
    """Prescribe the motion of a node: no unknown, no equation.

    Parameters
    ----------
    direction : (3,), planar (2,); of a planar rotation a number
        For positions, the motion times this vector is added to the initial position, and several
        motions add up. For rotations, the axis about which the motion is the angle.
    motion : table, function, tuple of three functions or ready profile
        Counted from where the node starts; see `drive_angle`.
    what : {'position', 'rotation'}

    Raises
    ------
    InputError
        A rotation moved about two axes, or a dependent position at the end of a rigid link.
    """
    node = known(model, node)
    if not isinstance(what, str) or what not in ("position", "rotation"):
        raise InputError(f"cannot move {what!r}: use position or rotation")
    moved = dof_block(node, what)
    if what == "position":
        way = vector(model, direction, f"motion of {moved.name}")
    else:
        way = rotation_vector(model, direction, f"motion of {moved.name}")
        if moved.motions:
            raise InputError(f"{moved.name} is moved about an axis already: rotations about "
                             "two axes do not add up, put a joint between them")
    if not np.linalg.norm(way) > 0:
        raise InputError(f"motion of {moved.name} has the direction {way}: give one "
                         "that is not zero")
    time_function = motions.motion(motion)
    count = len(moved.motions) + 1
    name = chosen_name(model, name, f"motion{f' {count}' * (count > 1)} of {moved.name}", ("node",))
    hold(model, node, what)
    moved.motions.append(Motion(name, way, time_function, Attachment(node, what)))
    return moved.motions[-1]


def _drive(model: Mechanism, drive: Joint) -> Joint:
    model.joints.append(drive)
    return drive
