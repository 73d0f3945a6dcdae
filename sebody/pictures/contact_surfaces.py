"""Contact surfaces, stops, gears and curves of a picture: where they are, and what carries them."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.model.body_points import start_place, surface_touched
from sebody.model.mechanism import Mechanism
from sebody.model.parts import COUPLING, Element, Node, positions, rotations
from sebody.pictures.contact_shapes import (
    Shape,
    across_of,
    ball,
    circle,
    disc,
    hatched,
    joined,
    line,
    patch,
    polyline,
    sector,
    tube,
)
from sebody.pictures.drawn_nodes import DrawnNode
from sebody.pictures.gear_wheels import PARALLEL, belt, gearing, pinion, thread, wheel
from sebody.pictures.path_curves import path_curves
from sebody.pictures.surface import spatial

AROUND_CONTACT = 0.3, 0.1       # margin of surfaces of the ground, of bodies; of the extent
HATCH = 0.02            # length of hatches, of the extent
PLATE = 0.04            # half the width of the plates of a stop, likewise
FAN = 0.15              # radius of the range of an angle, likewise
Z = np.array([0.0, 0.0, 1.0])
ALIKE = 9               # digits in which planes of several contacts are the same one


class ContactSurface(NamedTuple):
    """A surface that is touched, a ball that touches one, the limits of a stop, or a wheel."""

    name: str               # of the contact, stop or gear
    kind: str               # plane, sphere, cylinder, ball, limits, pointer, gear, rack,
                            # thread, belt
    node: str | None        # that carries it; None on the ground
    shape: Shape            # from this node, in axes that turn with it; on the ground in space


def contact_lines(model: Mechanism, nodes: Mapping[str, DrawnNode], size: float) -> NDArray:
    """The lines of all contact surfaces in the first frame, (points, 3), with NaN between them."""
    lines = [np.zeros((0, 3))]
    for one in contact_surfaces(model, nodes, size):
        ends = vertices_of(one, nodes, 0)[one.shape.lines]
        lines.append(np.concatenate([ends, np.full_like(ends[:, :1], np.nan)], 1).reshape(-1, 3))
    return np.concatenate(lines)


def contact_surfaces(model: Mechanism, nodes: Mapping[str, DrawnNode], size: float
                     ) -> list[ContactSurface]:
    """Surfaces, balls, limits and wheels of contacts, stops, gears and couplings of drawn `nodes`.

    Contacts with the same plane share a patch, and those of the same ball this ball.
    """
    surfaces: list[ContactSurface] = []
    planes: dict[tuple, list[tuple[Element, NDArray]]] = {}
    balls: dict[tuple[str, float], str] = {}
    for one in (*model.loads, *(c for joint in model.joints if joint.kind == COUPLING
                                for c in joint.constraints)):
        arm = None
        if one.point is not None:
            one, arm = _as_of_node(one)
        kind, _, surface = one.kind.removeprefix("planar_").partition("_on_")
        if not (surface or kind in LIMITS) or not all(
                _on_ground(model, held.node) or held.node.name in nodes
                for held in one.attachments):
            continue
        if kind in LIMITS:
            surfaces += LIMITS[kind](model, one, size)
            continue
        path = _path(model, one, nodes, arm)
        if surface == "plane":
            planes.setdefault(_same_plane(model, one, size), []).append((one, path))
        else:
            surfaces.append(_round(model, one, surface, path, size))
        if one.number("radius") > 0:
            balls.setdefault((one.attachments[0].node.name, one.number("radius")), one.name)
    make = disc if model.planar else ball
    return [*(_plane(model, touching, size) for touching in planes.values()), *surfaces,
            *(ContactSurface(name, "ball", node, make(radius))
              for (node, radius), name in balls.items()), *_curves(model, nodes, size),
            *_sheaves(model, nodes)]


def _sheaves(model: Mechanism, nodes: Mapping[str, DrawnNode]) -> Iterator[ContactSurface]:
    """Sheaves of ropes: a circle, and a spoke that turns with the node.

    The spoke of one with inertia, which turns by itself, is among the lines of ropes.
    """
    for one in model.sheaves.values():
        if one.node.name in nodes:
            u, v = across_of(one.axis)
            parts = [circle(one.radius, u, v, np.zeros(3))]
            if one.wheel is None:
                parts.append(line(np.zeros(3), one.radius * u))
            yield ContactSurface(one.name, "gear", one.node.name, joined(parts))


def _curves(model: Mechanism, nodes: Mapping[str, DrawnNode], size: float
            ) -> Iterator[ContactSurface]:
    for name, node, points in path_curves(model, size):
        carrier = _carrier(model, node)
        if carrier is None or carrier in nodes:
            yield ContactSurface(name, "curve", carrier, polyline(
                points if carrier is None else points - spatial(node.point)))


def vertices_of(one: ContactSurface, nodes: Mapping[str, DrawnNode], frame: int) -> NDArray:
    """Its points in space in a frame, (points, 3)."""
    if one.node is None:
        return one.shape.points
    node = nodes[one.node]
    turned = (one.shape.points if node.rotation is None
              else Rotation.from_quat(node.rotation[frame]).apply(one.shape.points))
    return node.position[frame] + turned


def _on_ground(model: Mechanism, node: Node) -> bool:
    return model.nodes.get(node.name) is not node


def _carrier(model: Mechanism, node: Node) -> str | None:
    return None if _on_ground(model, node) else node.name


def _as_of_node(one: Element) -> tuple[Element, NDArray]:
    """The contact of a point inside a body as one of its nearest node, and the arm from there."""
    assert one.point is not None
    place, (surface, constants) = start_place(one.point), surface_touched(one)
    a = min((p.node for p in one.point.body.attachments if p.kind == "position"),
            key=lambda node: float(np.linalg.norm(place - node.point)))
    b = one.attachments[-1].node
    return (replace(one, kind=f"point_on_{surface}", constants=constants, point=None,
                    attachments=positions(a, b) + rotations(b)), spatial(place - a.point))


def _path(model: Mechanism, one: Element, nodes: Mapping[str, DrawnNode], arm: NDArray | None
          ) -> NDArray:
    """Places of what touches, seen from the node that carries the surface, (frames, 3).

    `arm` is that of a point inside a body, from its nearest node, as if this part were rigid.
    """
    a, b = (held.node for held in one.attachments[:2])
    place = nodes[a.name].position
    if arm is not None:
        turn = nodes[a.name].rotation
        place = place + (arm if turn is None else Rotation.from_quat(turn).apply(arm))
    if _on_ground(model, b):
        return place
    away, rotation = place - nodes[b.name].position, nodes[b.name].rotation
    return away if rotation is None else Rotation.from_quat(rotation).apply(away, inverse=True)


def _margin(node: str | None, size: float) -> float:
    return AROUND_CONTACT[node is not None] * size


def _normal(model: Mechanism, one: Element) -> tuple[NDArray, float]:
    """Normal of a plane, and how far it is from the node that carries it or from the origin."""
    n, b = spatial(one.vector("n")), one.attachments[1].node
    return n, one.number("level") + float(n @ spatial(b.point) if _on_ground(model, b) else 0.0)


def _same_plane(model: Mechanism, one: Element, size: float) -> tuple:
    n, level = _normal(model, one)
    return (_carrier(model, one.attachments[1].node),
            *(np.round([*n, level / size], ALIKE) + 0.0))       # no -0


def _plane(model: Mechanism, touching: list[tuple[Element, NDArray]], size: float
           ) -> ContactSurface:
    """The part of a plane about all places over it that some contacts reach."""
    first = touching[0][0]
    n, level = _normal(model, first)
    node = _carrier(model, first.attachments[1].node)
    along, across = (np.cross(Z, n), Z) if model.planar else across_of(n)
    sides = []
    for way in (along, across):
        room = [_margin(node, size) + one.number("radius") for one, _ in touching]
        at = [path @ way for _, path in touching]
        sides.append((min(x.min() - r for x, r in zip(at, room, strict=True)),
                      max(x.max() + r for x, r in zip(at, room, strict=True))))
    (left, right), (low, high) = sides
    base = level * n + left * along
    shape = (hatched(base, (right - left) * along, HATCH * size * n) if model.planar else
             patch(base + low * across, (right - left) * along, (high - low) * across))
    return ContactSurface(first.name, "plane", node, shape)


def _round(model: Mechanism, one: Element, surface: str, path: NDArray, size: float
           ) -> ContactSurface:
    """A sphere, or the stretch of a cylinder along which it is touched."""
    b = one.attachments[1].node
    node, radius, inside = _carrier(model, b), one.number("size"), one.number("side") < 0
    if surface == "sphere":
        shape = (disc if model.planar else ball)(radius, inside)
    else:
        e = one.vector("e")
        along = (path - (0.0 if node else spatial(b.point))) @ e
        margin = _margin(node, size)
        shape = tube(e, radius, along.min() - margin, along.max() + margin, inside)
    return ContactSurface(one.name, surface, node, _from(model, b, shape))


def _from(model: Mechanism, node: Node, shape: Shape) -> Shape:
    """A shape about a node; of the ground in space."""
    if not _on_ground(model, node):
        return shape
    return shape._replace(points=shape.points + spatial(node.point))


def _angle(model: Mechanism, one: Element, size: float) -> list[ContactSurface]:
    """The range of an angle on the second body, and a ray on the first one that stays in it."""
    a, b = (held.node for held in one.attachments)
    axis = Z if model.planar else np.cross(one.vector("n"), one.vector("m"))
    zero = _towards(model, a, axis)
    side = np.cross(axis, zero)
    ends = [end for end in (one.number("lower"), one.number("upper")) if np.isfinite(end)]
    fan = sector(zero, side, min(*ends, 0.0), max(*ends, 0.0), FAN * size, ends)
    return [ContactSurface(one.name, "limits", _carrier(model, b), _from(model, b, fan)),
            ContactSurface(one.name, "pointer", _carrier(model, a),
                           _from(model, a, line(0 * zero, FAN * size * zero)))]


def _towards(model: Mechanism, node: Node, axis: NDArray) -> NDArray:
    """A direction across an axis, to the farthest node that turns with a node if there is one."""
    away = [spatial(other.point - node.point) for other in model.nodes.values()
            if other.rotation is node.rotation]
    across = max((way - axis * (axis @ way) for way in away), key=np.linalg.norm,
                 default=np.zeros(3))
    if not np.linalg.norm(across) > 0:
        across = across_of(axis)[0]
    return across / np.linalg.norm(across)


def _way(model: Mechanism, one: Element, size: float) -> list[ContactSurface]:
    """Plates on the first body, where the second node is at the limits, and a line at this node."""
    a, b = (held.node for held in one.attachments[:2])
    e, start = spatial(one.vector("e")), spatial(b.point - a.point)
    half = PLATE * size
    along, across = (np.cross(Z, e), Z) if model.planar else across_of(e)
    plates = []
    for limit, side in ((one.number("lower"), 1.0), (one.number("upper"), -1.0)):
        if np.isfinite(limit):
            corner = start + limit * e - half * along
            plates.append(hatched(corner, 2 * half * along, side * HATCH * size * e)
                          if model.planar else
                          patch(corner - half * across, 2 * half * along, 2 * half * across))
    mark = line(half * along, -half * along)
    return [ContactSurface(one.name, "limits", _carrier(model, a), _from(model, a, joined(plates))),
            ContactSurface(one.name, "pointer", _carrier(model, b), _from(model, b, mark))]


def _distance(model: Mechanism, one: Element, size: float) -> list[ContactSurface]:
    """Circles about the first node, without a skin: the second node is often outside of one."""
    a = one.attachments[0].node
    make = disc if model.planar else ball
    limits = [end for end in (one.number("lower"), one.number("upper"))
              if np.isfinite(end) and end > 0]
    return [ContactSurface(one.name, "limits", _carrier(model, a),
                           _from(model, a, shape._replace(triangles=shape.triangles[:0])))
            for shape in (make(end, inside=True) for end in limits)]


def _gears(model: Mechanism, one: Element, size: float) -> list[ContactSurface]:
    """The pitch circles of two wheels, each on the shaft that turns in its bearing."""
    found = [_shaft(model, one, k) for k in (1, 2)]
    shafts, axes = [node for node, _ in found], [axis for _, axis in found]
    made = gearing(np.array([spatial(node.point) for node in shafts]), np.array(axes),
                   one.number("ratio"), size)
    surfaces = []
    for k, node in enumerate(shafts):
        shape = wheel(made.wheels[k], made.wheels[1 - k])
        surfaces.append(_placed(model, one, "gear", node, shape))
    bearings = {_carrier(model, held.node) for held in one.attachments} - {
        surface.node for surface in surfaces}
    if made.belt and bearings == {None}:
        surfaces.append(ContactSurface(one.name, "belt", None, belt(*made.wheels)))
    return surfaces


def _shaft(model: Mechanism, one: Element, k: int) -> tuple[Node, NDArray]:
    """The node that turns by the k-th coordinate, an angle, and the axis of this angle."""
    turns = [held.node for held in one.attachments if held.kind == "rotation"]
    a, b = turns[:2] if k == 1 else turns[-2:]
    axis = Z if model.planar else np.cross(one.vector(f"n{k}"), one.vector(f"m{k}"))
    return (b, -axis) if _on_ground(model, a) else (a, axis)    # angles are those of the first


def _rack(model: Mechanism, one: Element, size: float) -> list[ContactSurface]:
    """A pinion and its rack, each on its own node; the thread of a screw."""
    (shaft, axis), lead = _shaft(model, one, 2), one.number("ratio")
    carrier, other = (held.node for held in one.attachments[:2])
    body, way = (carrier, -spatial(one.vector("e1"))) if _on_ground(model, other) else (
        other, spatial(one.vector("e1")))
    centre = spatial(shaft.point)
    if np.linalg.norm(np.cross(way, axis)) < PARALLEL:
        return [_placed(model, one, "thread", shaft,
                        thread(centre, axis, lead * np.sign(way @ axis), size))]
    wheel_of, rack = pinion(centre, axis, way, lead)
    return [_placed(model, one, "gear", shaft, wheel_of), _placed(model, one, "rack", body, rack)]


def _placed(model: Mechanism, one: Element, kind: str, node: Node, shape: Shape) -> ContactSurface:
    """A shape in space, carried by a node."""
    return ContactSurface(one.name, kind, _carrier(model, node), shape._replace(
        points=shape.points - (0.0 if _on_ground(model, node) else spatial(node.point))))


LIMITS = {"turn_stop": _angle, "slide_stop": _way, "distance_stop": _distance,
          "gear_play": _gears, "couple_turn_turn": _gears, "couple_slide_turn": _rack}
