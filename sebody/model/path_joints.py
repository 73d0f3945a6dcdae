"""Joints that slide along paths."""

from __future__ import annotations

from collections.abc import Callable
from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.names import path_kind, path_turn_kind
from sebody.model import motions
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, dof_block, known, known_joint
from sebody.model.extent import extent
from sebody.model.frames import FRAMES
from sebody.model.histories import Source
from sebody.model.joint_equations import named
from sebody.model.mechanism import Mechanism
from sebody.model.parts import (
    Attachment,
    DofBlock,
    Element,
    Joint,
    Motion,
    Node,
    OnPath,
    Path,
    Superelement,
    positions,
    rotations,
)
from sebody.model.path_tables import angle_at, curve, rotations_of
from sebody.model.paths import known_path

PATH = "path"       # kind of these joints
OFF = 1e-6          # of the size of the model: by which a node may be off its path
POLISHED = 12       # Newton's steps to it
SAMPLES = 8         # places in each interval between knots from which the nearest one is looked for


def path_joint(model: Mechanism, node: Node | str, path: Path | str, turns: str | None = None,
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
        In a plane: the node turns with the tangent of the path, to which it keeps the angle that it
        has at the start, by one more equation. The moment that this takes is in ``<name>.moment``;
        it pushes the node along the path by itself times the curvature. By default the node turns
        freely.
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
        ends, or a node that is to turn with a path in space or of FE nodes without rotations.

    Examples
    --------
    >>> runs = model.path_joint("trolley", rail, name="runs")
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
    if turns is not None:
        _check_turns(model, what, a, on, turns)
    begins = _start(model, what, a, on, start)
    name = named(model, name, PATH, a)
    way = DofBlock(f"{name}.way", np.array([begins]), np.zeros(1))
    if rate is not None:
        way.rate, way.given = np.array([inputs.number(rate, f"{what}: rate")]), True
    hidden = Node(way.name, np.zeros(0), way, None)     # in no table of the model
    equations: list[Element] = []
    for k, piece in enumerate(on.pieces):
        carrier = piece.carrier
        frame = "converged_mean" if isinstance(carrier, Node) else FRAMES[carrier.frame].kernel
        equations.append(Element(
            name, path_kind(frame, model.planar),
            piece.attachments + positions(a) + (Attachment(hidden, "position"),), {},
            0 if equations else model.dimension, path=OnPath(on, k, way),
            shares=equations[0] if equations else None))
    if turns is not None:
        equations += _turning(name, a, on, way, hidden)
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


def _check_turns(model: Mechanism, what: str, a: Node, path: Path, turns: object) -> None:
    """Refuse a node that cannot turn with a path.

    Raises
    ------
    InputError
        In space, a node without a rotation or on which a body of the path turns, or FE nodes
        without rotations.
    """
    inputs.choice(turns, f"{what}: turns", ("with",))
    if not model.planar:
        raise InputError(f"{what}: turns='with' is of models in a plane: leave it out, and put the "
                         "node on two wheels that are attached to it, with a path_joint each")
    rotation = dof_block(a, "rotation")
    for piece in path.pieces:
        if any(one.dof_block is rotation for one in piece.attachments):
            raise InputError(f"{what}: turns='with', but the node turns as a node of "
                             f"{piece.carrier.name!r} does, which carries path {path.name!r}: "
                             "leave turns= out, or give a node of its own")
        if isinstance(piece.carrier, Superelement) and not rotations_of(piece).size:
            raise InputError(f"{what}: turns='with', but FE nodes of superelement "
                             f"{piece.carrier.name!r} have no rotations: leave turns= out, and put "
                             "the node on two wheels that are attached to it, with a path_joint "
                             "each")


def _turning(name: str, a: Node, path: Path, way: DofBlock, hidden: Node) -> list[Element]:
    """Elements of a node that turns with a path, of one equation."""
    at = float(way.start[0])
    on = _piece_at(path, at)
    held = angle_at(path, on, at - path.pieces[on].offset)
    equations: list[Element] = []
    for k, piece in enumerate(path.pieces):
        carrier = piece.carrier
        frame = "converged_mean" if isinstance(carrier, Node) else FRAMES[carrier.frame].kernel
        equations.append(Element(
            name, path_turn_kind(frame),
            piece.attachments + rotations(a) + (Attachment(hidden, "position"),),
            {"held": held}, 0 if equations else 1,
            path=OnPath(path, k, way, True), shares=equations[0] if equations else None))
    return equations


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
    k = _piece_at(path, way)
    piece, of = path.pieces[k], curve(path, k)
    local = way - piece.offset
    inside = float(np.clip(local, 0.0, piece.ways[-1]))
    place: NDArray = of(inside) + (local - inside) * of(inside, 1)
    return place


def _piece_at(path: Path, way: float) -> int:
    """Number of the piece of a path at a way; beyond its ends of the outer one."""
    return max(sum(way >= piece.offset for piece in path.pieces) - 1, 0)


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
