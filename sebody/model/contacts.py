"""Contacts and stops of a model."""

from __future__ import annotations

from typing import Unpack

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.names import body_contact_kind
from sebody.model.acting import Acting
from sebody.model.arguments import (
    chosen_name,
    direction,
    dof_block,
    known,
    known_joint,
    vector,
    warn_of_degrees,
)
from sebody.model.body_points import body_point, start_place
from sebody.model.frames import FRAMES
from sebody.model.frictions import Dry, checked_friction, turning
from sebody.model.impacts import impact_constants
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import ground
from sebody.model.parts import (
    SLIDES,
    TURNS,
    BodyPoint,
    Element,
    Joint,
    Node,
    positions,
    rotations,
)
from sebody.model.signs import warn_of_sign
from sebody.model.surfaces import Surface

DEEP = 0.1          # of its radius, or of the model: a start in deeper contact is refused


def stop(model: Mechanism, of: Joint | str | tuple[Node | str, Node | str],
         lower: float | None = None, upper: float | None = None, restitution: float = 0.5,
         at_speed: float = 1.0, stiffness: float | None = None, exponent: float = 1.5,
         name: str | None = None,
         **acting: Unpack[Acting]) -> Element:
    """Limits of the angle or way of a joint or drive, or of the distance of two nodes.

    Beyond a limit by d the stop pushes back with ``k d^n (1 + c d')`` (Hunt and Crossley), and
    never pulls. Steps in which the rate changes by more than a tenth of the speed of the impact are
    repeated with shorter ones.

    Parameters
    ----------
    of : Joint or str, or two nodes
        A revolute joint or drive of an angle, [rad], or a prismatic or cylindrical joint, slider,
        or drive of a way: the angle or way of its `node` against `to` (the ground) about or along
        the axis, from the start, as results have it; of a joint on a path its way, counted from
        the beginning of the path; or the distance itself of two nodes.
    lower, upper : float, optional
        Limits [length] or [rad]; at least one.
    restitution : float
        Rate after an impact of the speed `at_speed` relative to that before; from 0.01 to 1. Slower
        impacts lose less.
    at_speed : float
        This speed, of the angle, way or distance [rad/time] or [length/time].
    stiffness : float
        k: force / length^n, or moment / angle^n.
    exponent : float
        n, at least 1.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        No limit, a lower one above the upper, a start beyond them, a joint that neither turns nor
        slides, or numbers that make no sense.
    """
    what, kind, attachments, own, start = _measured(model, of)
    if kind == "slide_stop":
        warn_of_sign(model, what, known_joint(model, of, "stop"))
    if lower is None and upper is None:
        raise InputError(f"{what}: it has no limit: give lower=, upper= or both")
    low = -np.inf if lower is None else inputs.number(lower, f"{what}: lower")
    high = np.inf if upper is None else inputs.number(upper, f"{what}: upper")
    checked_limits(what, low, high, start)
    if kind == "turn_stop":
        warn_of_degrees(what, lower=low, upper=high)
    constants = impact_constants(what, restitution, at_speed, stiffness, exponent)
    name = chosen_name(model, name, what.replace("'", ""))
    made = Element(name, model.kind_of(kind), attachments,
                   constants | own | {"lower": low, "upper": high})
    model.loads.append(made)
    return made


def checked_limits(what: str, low: float, high: float, start: float, play: bool = False) -> None:
    """Refuse limits that leave no room, unless it is `play`, or a start beyond them."""
    if low > high or (low == high and not play):
        raise InputError(f"{what}: lower is {low:g} and upper {high:g}, which leaves no room: "
                         "give a lower limit below the upper one")
    if not low <= start <= high:
        raise InputError(f"{what}: it starts at {start:g}, beyond the limits {low:g} and "
                         f"{high:g}: a start inside the stop would be an impact of unknown speed")


def refuse_deep(model: Mechanism, what: str, surface: str, radius: float, gap: float) -> None:
    """Refuse a start deep in a surface, of a sphere about a point that is so far from it."""
    depth = radius - gap
    if depth > DEEP * (radius if radius > 0 else model.size()):
        raise InputError(f"{what}: it starts {depth:g} deep in the {surface}: start it outside, or "
                         "turn the normal (inside=True for a bore)")


def contact(model: Mechanism, node: Node | str, on: Surface, radius: float = 0.0,
            stiffness: float | None = None, restitution: float = 0.5, at_speed: float = 1.0,
            exponent: float = 1.5, friction: float = 0.0, static: float | None = None,
            bristle: float | None = None, damping: float | None = None, speed: float = 0.0,
            name: str | None = None,
            **acting: Unpack[Acting]) -> Element:
    """Contact of a sphere about a node, or of the node itself, with a surface.

    Where it presses by d the force is ``k d^n (1 + c d')`` along the normal (see `stop`), and
    friction acts in both directions of the surface (see `friction`): a sphere rolls.

    Parameters
    ----------
    node : Node or str
        Centre of the sphere; or ``"BODY.nodeLABEL"``, as in results, a point of a superelement: a
        node of its FE model, which moves as the recovery says. For other points of a body
        `attach` a node.
    on : Surface
        `sebody.plane`, `sebody.sphere` or `sebody.cylinder`, of the ground or of a node.
    radius : float
        Of the sphere (in a plane of the disc) [length]; 0 for a point.
    stiffness : float
        k: force / length^n; Hertz's is ``4/3 E* sqrt(R)`` with n = 1.5.
    restitution, at_speed, exponent : float
        See `stop`.
    friction, static : float
        Coefficients of sliding and of break-away.
    bristle, damping, speed : float
        See `friction`; they need a coefficient.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        No surface, a node of another model, a sphere without rotation, a surface of the node
        itself, an FE node that the body does not have, a start in deep penetration, or numbers
        that make no sense.
    """
    if point := body_point(model, node, "contact"):
        return _inside(model, point, str(node), on, radius, impact_constants(
            f"contact of {node!r}", restitution, at_speed, stiffness, exponent), _dry(
                f"contact of {node!r}", friction, static, bristle, damping, speed),
            name)
    a = known(model, node)
    what = f"contact of {a.name!r}"
    on = inputs.instance(on, f"{what}: on", Surface, "give a sebody.plane, sphere or cylinder")
    r = inputs.number(radius, f"{what}: radius", least=0)
    b = _carrier(model, on, a, what)
    shape, gap = _shape(model, on, a, b, what)
    refuse_deep(model, what, on.kind, r, gap)
    dof_block(a, "position")
    attachments = positions(a, b) + (rotations(a, b) if r > 0 else rotations(b))
    if r > 0 and a.rotation is None:
        raise InputError(f"{what}: node {a.name!r} has no rotation, so a sphere about it cannot "
                         "roll: make it with keeps='full', or give a point, radius=0")
    dof_block(b, "rotation")
    constants = impact_constants(what, restitution, at_speed, stiffness, exponent)
    dry = _dry(what, friction, static, bristle, damping, speed)
    name = chosen_name(model, name, what.replace("'", ""))
    kind = f"{'sphere' if r > 0 else 'point'}_on_{on.kind}"
    made = Element(name, model.kind_of(kind), attachments,
                   constants | dict(dry.constants) | {"radius": r} | shape, tuned=dry.tuned)
    model.loads.append(made)
    return made


def _dry(what: str, friction: float, static: float | None, bristle: float | None,
         damping: float | None, speed: float) -> Dry:
    """Coefficients of the friction of a contact, of which none is given where there is none."""
    dry = checked_friction(what, friction, static, bristle, damping, speed, "friction")
    given = {"static": static, "bristle": bristle, "damping": damping, "speed": speed or None}
    if not dry.constants["coefficient"] > 0 and (
            unused := [f"{name}=" for name, value in given.items() if value is not None]):
        raise InputError(f"{what} has {', '.join(unused)} and no friction: give friction=, the "
                         "coefficient of sliding, or leave the rest out")
    return dry


def _inside(model: Mechanism, point: BodyPoint, called: str, on: Surface, radius: float,
            impact: dict[str, float | NDArray], dry: Dry, name: str | None) -> Element:
    """Contact of a point inside a body with a surface."""
    what = f"contact of {called!r}"
    on = inputs.instance(on, f"{what}: on", Surface, "give a sebody.plane, sphere or cylinder")
    if inputs.number(radius, f"{what}: radius", least=0) > 0:
        raise InputError(f"{what}: radius is {radius:g}, but an FE node is a point: leave radius "
                         "out, or shift the surface by it")
    if isinstance(on.node, Node | str) and known(model, on.node) in point.body.nodes:
        raise InputError(f"{what}: the {on.kind} is on node {known(model, on.node).name!r} of the "
                         "same body: give another one")
    a = Node(called, start_place(point), None, None)
    b = _carrier(model, on, a, what)
    shape, gap = _shape(model, on, a, b, what)
    refuse_deep(model, what, on.kind, 0.0, gap)
    own = {"e": shape.get("n", shape.get("e", np.zeros(model.dimension))),
           "level": shape.get("level", 0.0), "flat": float(on.kind == "plane"),
           "size": shape.get("size", 1.0), "side": shape.get("side", 1.0), "radius": 0.0}
    dof_block(b, "rotation")
    made = Element(chosen_name(model, name, what.replace("'", "")),
                   body_contact_kind(FRAMES[point.body.frame].kernel, model.planar),
                   point.body.attachments + positions(b) + rotations(b),
                   impact | dict(dry.constants) | own, tuned=dry.tuned, point=point)
    model.loads.append(made)
    return made


def _measured(model: Mechanism, of: object) -> tuple[str, str, tuple, dict, float]:
    """Measure of a stop: in words, its kernel, places and constants, and its value now."""
    if isinstance(of, tuple | list):
        if len(of) != 2:
            raise inputs.refusal("stop", of, "give a joint or two nodes")
        a, b = (known(model, one) for one in of)
        if a is b:
            raise InputError(f"stop: node {a.name!r} is given twice: give two nodes")
        return (f"stop of {a.name!r} and {b.name!r}", "distance_stop", positions(a, b), {},
                float(np.linalg.norm(b.point - a.point)))
    joint = known_joint(model, of, "stop")
    what = f"stop of {joint.name!r}"
    kind = joint.constraints[0].kind.removeprefix("planar_") if joint.kind == "drive" else ""
    if joint.kind in SLIDES or kind == "slide_drive":
        way = joint.way
        return (what, "slide_stop", way.attachments, {"e": way.direction, "start": way.start}, 0.0)
    if joint.kind == "path":
        place = joint.constraints[0].attachments[-1]
        return what, "way_stop", (place,), {}, float(place.dof_block.start[0])
    if joint.kind in TURNS or kind == "turn_drive":
        own = {} if model.planar else turning(joint.own_axes)
        return what, "turn_stop", rotations(joint.node, joint.to), own, 0.0
    raise InputError(f"{what}: a {joint.kind} has neither an angle nor a way: give a revolute, "
                     "prismatic or cylindrical joint, a slider or a drive, or two nodes")


def _carrier(model: Mechanism, on: Surface, a: Node, what: str) -> Node:
    """The node that carries a surface: on the ground a fixed one at its point."""
    if on.node is None:
        point = np.zeros(model.dimension) if on.point is None else vector(
            model, on.point, f"{what}: point of the {on.kind}")
        if on.kind != "sphere":     # nearest to the node: in its plane of symmetry, if it has one
            assert on.direction is not None
            axis = direction(model, on.direction, what, a)
            along = axis * (axis @ (a.point - point))
            point = a.point - along if on.kind == "plane" else point + along
        return ground(model, Node(on.kind, point, None, None))
    b = known(model, on.node)
    if b is a:
        raise InputError(f"{what}: the {on.kind} is on the node itself: give another one")
    if on.point is not None and on.kind != "plane":
        raise InputError(f"{what}: the {on.kind} is about node {b.name!r}: leave its point out, or "
                         "attach a node there")
    return b


def _shape(model: Mechanism, on: Surface, a: Node, b: Node, what: str
           ) -> tuple[dict[str, float | NDArray], float]:
    """Constants of a surface, and the distance of the node from it."""
    s = a.point - b.point
    if on.kind == "plane":
        assert on.direction is not None
        n = direction(model, on.direction, what, a)
        level = 0.0 if on.point is None or on.node is None else float(n @ (vector(
            model, on.point, f"{what}: point of the plane") - b.point))
        return {"n": n, "level": level}, float(n @ s) - level
    side = -1.0 if on.inside else 1.0
    assert on.radius is not None
    own: dict[str, float | NDArray] = {"size": on.radius, "side": side}
    if on.kind == "cylinder":
        if model.planar:
            raise InputError(f"{what}: the model is planar: give a sphere, which is a circle in it")
        assert on.direction is not None
        e: NDArray = direction(model, on.direction, what, a)
        own["e"], s = e, s - e * (e @ s)
    return own, side * (float(np.linalg.norm(s)) - on.radius)
