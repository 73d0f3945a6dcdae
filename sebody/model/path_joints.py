"""Joints that slide along paths."""

from __future__ import annotations

from collections.abc import Callable
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model import motions
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, dof_block, known, known_joint
from sebody.model.extent import extent
from sebody.model.histories import Source
from sebody.model.joint_equations import named
from sebody.model.mechanism import Mechanism
from sebody.model.parts import (
    DofBlock,
    Element,
    Joint,
    Motion,
    Node,
    Path,
)
from sebody.model.path_equations import holding
from sebody.model.path_tables import curve, piece_at
from sebody.model.path_turns import check_turns, turning
from sebody.model.paths import known_path

PATH = "path"       # kind of these joints
OFF = 1e-6          # of the size of the model: by which a node may be off its path
POLISHED = 12       # Newton's steps to it
SAMPLES = 8         # places in each interval between knots from which the nearest one is looked for


def path_joint(model: Mechanism, node: Node | str, path: Path | str, turns: str | None = None,
               axis: ArrayLike | None = None, across: ArrayLike | None = None,
               start: float | None = None, rate: float | None = None, inertia: float = 0.0,
               name: str | None = None, **acting: Unpack[Acting]) -> Joint:
    """Point that stays on a path: `node` slides along flexible bodies, and turns freely or not.

    How far along the path it is, its way, is an unknown of its own, so the force on `node` is
    normal to the deformed path unless something acts along it. For a straight line that is fixed
    in a node use `slider`, which has no unknown and no path; for a carriage that slides in a rigid
    guide and does not turn `prismatic`, with `drive_slide` for its motion.

    Parameters
    ----------
    node : Node or str
        A node that is not one of the path's own bodies; on the path at the start.
    path : Path or str
        Of `path`.
    turns : {"with"}, optional
        The node turns with the path and keeps the orientation to it that it has at the start: in a
        plane to the tangent, by one more equation, in space to the section of the deformed body,
        by three. The moment that this takes is in ``<name>.moment``; it pushes the node along the
        path by itself times the curvature. By default the node turns freely.
    axis : (3,) array_like or {"x", "y", "z"}, optional
        In space, with `turns`: direction at the start, global axes, about which the node turns
        freely: two more equations keep this axis of the node along that of the section.
    across : {"free"} or (3,) array_like or {"x", "y", "z"}, optional
        In space: the path leaves the node free in one direction across, as a wheel without flanges
        does, and holds it along its tangent and the other normal, those of the undeformed path in
        axes of the body's frame. ``"free"`` is level, normal to the path and to the z axis; else
        the direction at the start, global axes. By default the path holds the node all around.
    start : float, optional
        The way at the start [length]; by default that of the nearest place. Give it where the path
        comes by the same place twice.
    rate : float, optional
        Rate of the way at the start [length/time]; by default it follows from the velocities.
    inertia : float
        Of wheels that turn with the way, a sum of J/r^2 [mass].
    name : str, optional
        Of its results, ``<name>.way``, ``<name>.rate``, ``<name>.force`` on the node and the like;
        by default ``path at <node>``.
    **acting
        `until`, `breaks_at`, `release_when`: when it lets go, and with it what acts along its way,
        see `sebody.model.acting.Acting`; it has no `from_`.

    Raises
    ------
    InputError
        A node off the path or of one of its bodies, a path of another model, a start beyond its
        ends, a node that is to turn with FE nodes without rotations, an axis in a plane, or a
        direction across that is along the path.

    Examples
    --------
    >>> runs = model.path_joint("trolley", rail, name="runs")
    >>> sledge = model.path_joint("sledge", rail, turns="with")
    """
    a = known(model, node)
    what = f"path joint at {a.name!r}"
    on = known_path(model, path, what)
    dof_block(a, "position")
    if "from_" in acting:
        raise InputError(f"{what} has from_=, but the node would have to be on the path by chance: "
                         "leave it out; weld(..., from_=) locks any pose")
    for piece in on.pieces:
        if isinstance(piece.carrier, Node):
            if a is piece.carrier or a.position is piece.carrier.position:
                raise InputError(f"{what}: the node carries path {on.name!r} itself: give another "
                                 "one")
        elif any(a.position is t for t in piece.carrier.positions):
            raise InputError(f"{what}: the node is one of superelement {piece.carrier.name!r}, "
                             f"which path {on.name!r} goes along: give a node of its own at this "
                             "place")
    wheels = inputs.number(inertia, f"{what}: inertia", least=0)
    check_turns(model, what, a, on, turns, axis)
    begins = _start(model, what, a, on, start)
    name = named(model, name, PATH, a)
    way = DofBlock(f"{name}.way", np.array([begins]), np.zeros(1))
    if rate is not None:
        way.rate, way.given = np.array([inputs.number(rate, f"{what}: rate")]), True
    hidden = Node(way.name, np.zeros(0), way, None)     # in no table of the model
    equations = holding(model, what, name, a, on, way, hidden, across)
    if turns is not None:
        equations += turning(model, name, a, on, way, hidden, axis)
    carrier = on.pieces[0].carrier
    to = carrier if isinstance(carrier, Node) else carrier.nodes[carrier.reduced.position_nodes[0]]
    joint = Joint(name, tuple(equations), a, to, None, PATH)
    model.joints.append(joint)
    if wheels:
        model.loads.append(Element(
            chosen_name(model, None, f"wheels of {name}"), "way_rotor",
            joint.constraints[0].attachments[-1:], {"inertia": wheels, "ratio": 1.0}))
    if "stop" in on.ends:
        low, high = (limit if end == "stop" else far for end, limit, far in zip(
            on.ends, (0.0, on.length), (-np.inf, np.inf), strict=True))
        model.loads.append(Element(
            chosen_name(model, None, f"ends of {name}"), "way_stop",
            joint.constraints[0].attachments[-1:], {**on.buffers, "lower": low, "upper": high}))
    return joint


def drive_way(model: Mechanism, joint: Joint | str, motion: Source, name: str | None = None
              ) -> Motion:
    """Prescribe the way of a path joint along its path: no unknown, no equation.

    Parameters
    ----------
    joint : Joint or str
        Of `path_joint`.
    motion : table, function, tuple of three functions or ready profile
        Counted from where the joint starts [length]; see `drive_angle`.
    name : str, optional
        Of its results, ``<name>.thrust``, ``<name>.power`` and ``<name>.work``.

    Raises
    ------
    InputError
        Another kind of joint, or one that is driven already.
    """
    driven = known_joint(model, joint, "drive of the way")
    way = way_of(driven, "drive_way")
    if way.fixed:
        raise InputError(f"drive_way: joint {driven.name!r} is driven already: leave one drive out")
    time_function = motions.motion(motion)
    name = chosen_name(model, name, f"drive of {driven.name}")
    place = driven.constraints[0].attachments[-1]
    way.fixed = True
    way.motions.append(Motion(name, np.ones(1), time_function, place))
    return way.motions[-1]


def way_of(joint: Joint, what: str) -> DofBlock:
    """The way of a path joint.

    Raises
    ------
    InputError
        Another kind of joint.
    """
    if joint.kind != PATH:
        raise InputError(f"{what}: joint {joint.name!r} is a {joint.kind}, which has no way along "
                         "a path: give a joint of path_joint")
    path = joint.constraints[0].path
    assert path is not None and path.way is not None
    return path.way


def _start(model: Mechanism, what: str, a: Node, path: Path, start: float | None) -> float:
    """The way at which a node is on a path.

    Raises
    ------
    InputError
        It is off the path, by how much and where the nearest place is.
    """
    if start is None:
        way = _nearest(path, a.point)
    else:
        way = inputs.number(start, f"{what}: start")
        for end, beyond in zip(path.ends, (way < 0, way > path.length), strict=True):
            if beyond and end in ("refuse", "stop"):
                raise InputError(f"{what}: start is {way:g}, beyond the ends of path "
                                 f"{path.name!r}, 0 and {path.length:g}: give a way between them, "
                                 "or make the path with ends='straight'")
    there = place_at(path, way)
    apart = float(np.linalg.norm(a.point - there))
    if apart > OFF * max(extent(model), path.length):
        where = ", ".join(f"{x:.9g}" for x in there)
        found = "the nearest place on it" if start is None else f"its place at start={way:g}"
        raise InputError(f"{what}: the node is {apart:.3g} away from path {path.name!r}: {found} "
                         f"is ({where}), put the node there")
    return way


def place_at(path: Path, way: float) -> NDArray:
    """The place on a path at the start, global axes; straight on beyond its ends."""
    k = piece_at(path, way)
    piece, of = path.pieces[k], curve(path, k)
    local = way - piece.offset
    inside = float(np.clip(local, 0.0, piece.ways[-1]))
    place: NDArray = of(inside) + (local - inside) * of(inside, 1)
    return place


def _nearest(path: Path, point: NDArray) -> float:
    """The way of the place on a path that is nearest to a point."""
    found = []
    for k, piece in enumerate(path.pieces):
        of = curve(path, k)
        ways = np.unique(np.concatenate([np.linspace(one, other, SAMPLES + 1) for one, other in zip(
            piece.ways, piece.ways[1:], strict=False)]))
        i = int(np.argmin(np.linalg.norm(of(ways) - point, axis=1)))
        low, high = ways[max(i - 1, 0)], ways[min(i + 1, len(ways) - 1)]

        def square(way: float, of: Callable[..., NDArray] = of) -> float:
            return float(np.sum((of(way) - point)**2))
        local = _polished(of, float(ways[i]), point, float(low), float(high))
        found.append((square(local), local + piece.offset))
        found += [(square(end), end + piece.offset) for end in (0.0, float(piece.ways[-1]))]
    return float(min(found)[1])


def _polished(of: Callable[..., NDArray], way: float, point: NDArray, low: float, high: float
              ) -> float:
    """A way where the path is normal to the line to a point, from one nearby: Newton's steps."""
    for _ in range(POLISHED):
        gap, slope, bend = of(way) - point, of(way, 1), of(way, 2)
        change = -(gap @ slope) / max(slope @ slope + gap @ bend, 1e-300)
        way = float(np.clip(way + change, low, high))
    return way
