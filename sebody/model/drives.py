"""Drives: prescribed motions of nodes, and of joints by an equation."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics.errors import InputError
from sebody.model import motions
from sebody.model.accelerations import Acceleration, of_acceleration
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, dof_block, known, rotation_vector, vector
from sebody.model.hinges import about, check_axes, slide_of
from sebody.model.histories import Source
from sebody.model.mechanism import Mechanism
from sebody.model.parts import (
    Attachment,
    Axes,
    Element,
    Joint,
    Motion,
    Node,
    Way,
    rotations,
)
from sebody.model.sharing import hold
from sebody.model.signs import warn_of_sign


def drive_angle(model: Mechanism, node: Joint | Node | str, motion: Source,
                axis: ArrayLike | None = None, to: Node | str | None = None,
                name: str | None = None,
                **acting: Unpack[Acting]) -> Joint:
    """Prescribe the angle of `node` against `to` (the ground) about the axis they share.

    The joint itself is built separately. If nothing else acts on the rotation of `node` and there
    is no `to`, `move` does the same without an equation.

    Parameters
    ----------
    node : Joint, Node or str
        A revolute or cylindrical joint, which has both nodes and the axis; or the node.
    axis : (3,), optional
        With a node: by default that of the one hinge between the nodes, or of the node; z where
        there is none.
    motion : table, function, tuple of three functions or ready profile
        The angle, counted from where the nodes start: its value at t = 0 is taken off [rad]. A
        rate that it has at t = 0 is that of the start. See `sebody.model.motions.motion`.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        A joint that does not turn about one axis, hinges about several axes, an axis that the
        joint between the nodes forbids.
    """
    a, b, vectors = about(model, node, axis, to, "drive")
    time_function = motions.motion(motion)
    constants = dict(zip(("n", "m"), vectors[1:], strict=True)) if vectors else {}
    name = chosen_name(model, name, f"angle at {a.name}", ("node",))
    equation = Element(name, model.kind_of("turn_drive"), rotations(a, b), constants, 1,
                       time_function)
    check_axes(model, [equation])
    return _drive(model, Joint(name, (equation,), a, b, Axes.of(a, vectors), "drive"))


def drive_slide(model: Mechanism, node: Joint | Node | str, motion: Source,
                axis: ArrayLike | None = None, to: Node | str | None = None,
                name: str | None = None,
                **acting: Unpack[Acting]) -> Joint:
    """Prescribe the displacement of `node` against `to` (the ground) along an axis fixed in `node`.

    The axis is rigid, as that of a prismatic joint; use `drive_way` along a path of a flexible
    body.
    Its sign is that of the displacement of a prismatic joint, a slider and an actuator.

    Parameters
    ----------
    node : Joint, Node or str
        A prismatic or cylindrical joint or a slider, which has both nodes and the axis; or the
        node.
    motion : table, function, tuple of three functions or ready profile
        The displacement, counted from where the nodes start [length]; see `drive_angle`.
    axis : (3,), planar (2,)
        With a node.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        A joint that does not slide, a node without an axis, an axis along which the joint between
        the nodes does not slide.
    """
    a, b, carrier, axes = slide_of(model, node, axis, to, "drive")
    way = Way.of(a, b, Axes(carrier, axes))
    time_function = motions.motion(motion)
    name = chosen_name(model, name, f"slide at {a.name}", ("node",))
    equation = Element(name, model.kind_of("slide_drive"), way.attachments,
                       {"e": way.direction, "start": way.start}, 1, time_function)
    check_axes(model, [equation])
    drive = _drive(model, Joint(name, (equation,), a, b, Axes(carrier, axes), "drive"))
    warn_of_sign(model, f"drive {name!r}", drive)
    return drive


def move(model: Mechanism, node: Node | str, direction: ArrayLike, motion: Source = None,
         what: str = "position", name: str | None = None,
         acceleration: Acceleration | None = None, drift: str | None = None) -> Motion:
    """Prescribe the motion of a node, or its acceleration: no unknown, no equation.

    Parameters
    ----------
    direction : (3,), planar (2,); of a planar rotation a number
        For positions, the motion times this vector is added to the initial position, and several
        motions add up. For rotations, the axis about which the motion is the angle.
    motion : table, function, tuple of three functions or ready profile
        Counted from where the node starts; see `drive_angle`.
    what : {'position', 'rotation'}
    acceleration : table, path of a CSV file, function of time or ready profile
        In place of `motion`: linear between rows (t, acceleration), zero before and behind them.
        The node starts at rest.
    drift : {'keep', 'remove'}, optional
        What becomes of the speed and the way that a table of accelerations leaves behind its last
        row: 'remove' takes a straight line from the accelerations, and tells it.

    Raises
    ------
    InputError
        A rotation moved about two axes, a dependent position at the end of a rigid link, both or
        none of motion and acceleration, or an acceleration that cannot be integrated.

    Examples
    --------
    >>> model.move("ground floor", (9.81, 0, 0), acceleration="quake.csv", drift="remove")
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
    if (motion is None) == (acceleration is None):
        raise InputError(f"motion of {moved.name}: give either motion= or acceleration=")
    if acceleration is not None:
        time_function = of_acceleration(acceleration, drift, f"acceleration of {moved.name}")
    elif drift is not None:
        raise InputError(f"motion of {moved.name}: drift= is that of an acceleration: leave it out")
    else:
        time_function = motions.motion(motion)
    count = len(moved.motions) + 1
    name = chosen_name(model, name, f"motion{f' {count}' * (count > 1)} of {moved.name}", ("node",))
    hold(model, node, what)
    moved.motions.append(Motion(name, way, time_function, Attachment(node, what)))
    return moved.motions[-1]


def _drive(model: Mechanism, drive: Joint) -> Joint:
    model.joints.append(drive)
    return drive
