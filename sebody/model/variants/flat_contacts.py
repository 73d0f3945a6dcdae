"""Friction, stops, gears and contacts of a spatial model in a plane of symmetry."""

from collections.abc import Callable
from typing import Any

import numpy as np

from sebody.basics.errors import InputError
from sebody.contract.names import body_contact_kind
from sebody.model.frames import FRAMES
from sebody.model.parts import Attachment, Element, Superelement
from sebody.model.variants.flattening import Flattening

Made = tuple[str, dict[str, Any]]


def flat_places(flat: Flattening, one: Element, kind: str) -> tuple[Attachment, ...]:
    """Its places; of a cylindrical joint that only turns in the plane the rotations."""
    attachments = [p for p in one.attachments if "turn" not in kind or p.kind == "rotation"]
    if "friction_slide" in kind:
        attachments = attachments[:3]
    return tuple(flat.place(p) for p in attachments)


def _scalars(one: Element) -> dict[str, Any]:
    """Constants that are no directions."""
    return {name: value for name, value in one.constants.items() if np.ndim(value) == 0}


def _axis(one: Element, number: str = "") -> np.ndarray:
    """The axis about which an angle is read."""
    return np.cross(one.constants["n" + number], one.constants["m" + number])


def sign_of_angle(flat: Flattening, one: Element, number: str = "") -> float:
    """Tell whether the angle counts as in the plane: 1, or -1 where it counts against it."""
    return float(np.sign(flat.axial(_axis(one, number), f"the axis of {one.name!r}")))


def _turn(kind: str) -> Callable[[Flattening, Element], Made]:
    def made(flat: Flattening, one: Element) -> Made:
        sign_of_angle(flat, one)
        return kind, _scalars(one)
    return made


def _journal(flat: Flattening, one: Element) -> Made:
    """In the plane nothing presses along the normal."""
    sign_of_angle(flat, one)
    kept = {name: value for name, value in _scalars(one).items() if name not in ("across", "along")}
    return "planar_friction_turn" + "_f2" * (one.number("across") > 0), kept


def _universal(flat: Flattening, one: Element) -> Made:
    raise InputError(f"{one.name!r} is friction in a universal joint, which leaves the plane")


def _ball(kind: str) -> Callable[[Flattening, Element], Made]:
    return lambda flat, one: (kind, _scalars(one))


def _slide(kind: str) -> Callable[[Flattening, Element], Made]:
    def made(flat: Flattening, one: Element) -> Made:
        e = flat.vector(one.vector("e"), f"the axis of {one.name!r}")
        return kind, _scalars(one) | {"e": e}
    return made


def _cylindrical(flat: Flattening, one: Element) -> Made:
    """In the plane it slides, or turns about the normal."""
    if not flat.is_normal(one.vector("e")):
        found = _slide("planar_friction_slide_f1m1")(flat, one)
        return found[0], found[1] | {"radius": 1.0}
    c = _scalars(one)
    return "planar_friction_turn_f2", c | {"bristle": c["bristle"] * c["radius"]**2}


def _turn_stop(flat: Flattening, one: Element) -> Made:
    return "planar_turn_stop", _limits(_scalars(one), sign_of_angle(flat, one))


def _limits(c: dict[str, Any], sign: float) -> dict[str, Any]:
    """The limits of a measure that may count the other way."""
    if sign > 0:
        return c
    return c | {"lower": -np.asarray(c["upper"]), "upper": -np.asarray(c["lower"])}


def _gear(flat: Flattening, one: Element) -> Made:
    first, second = (sign_of_angle(flat, one, k) for k in "12")
    c = _limits(_scalars(one), first)
    return "planar_gear_play", c | {"ratio": c["ratio"] * first * second}


def _on_plane(flat: Flattening, one: Element) -> Made:
    n = flat.vector(one.vector("n"), f"the normal of {one.name!r}")
    return "planar_" + one.kind, _scalars(one) | {"n": n}


def _on_cylinder(flat: Flattening, one: Element) -> Made:
    if not flat.is_normal(one.vector("e")):
        raise InputError(f"the axis of {one.name!r} is not normal to the plane")
    return "planar_" + one.kind.replace("cylinder", "sphere"), _scalars(one)


LAWS: dict[str, Callable[[Flattening, Element], Made]] = {
    "friction_turn": _turn("planar_friction_turn"),
    "friction_turn_f3m2": _journal, "friction_turn_f3m1": _universal,
    "friction_slide": _slide("planar_friction_slide"),
    "friction_slide_f2": _slide("planar_friction_slide_f1"),
    "friction_slide_f2m3": _slide("planar_friction_slide_f1m1"),
    "friction_cylindrical_f2m2": _cylindrical, "friction_spherical": _ball("planar_friction_turn"),
    "friction_spherical_f3": _ball("planar_friction_turn_f2"),
    "turn_stop": _turn_stop, "slide_stop": _slide("planar_slide_stop"),
    "distance_stop": _ball("planar_distance_stop"), "gear_play": _gear,
    "sphere_on_plane": _on_plane, "point_on_plane": _on_plane,
    "sphere_on_sphere": _ball("planar_sphere_on_sphere"),
    "point_on_sphere": _ball("planar_point_on_sphere"),
    "sphere_on_cylinder": _on_cylinder, "point_on_cylinder": _on_cylinder}


def flat_point_contact(flat: Flattening, one: Element, body: Superelement) -> Element:
    """The contact of a point inside a body, on the planar body in the place of its own.

    Raises
    ------
    InputError
        A planar body that does not know its FE nodes, or a surface that leaves the plane.
    """
    assert one.point is not None
    if body.reduced.recovery is None:
        raise InputError(f"{one.name!r} touches an FE node of {body.name!r}, whose FE nodes are "
                         "not all in the plane")
    e = np.zeros(2)
    if one.number("flat"):
        e = flat.vector(one.vector("e"), f"the normal of {one.name!r}")
    elif np.any(one.vector("e")) and not flat.is_normal(one.vector("e")):
        raise InputError(f"the axis of {one.name!r} is not normal to the plane")
    return Element(one.name, body_contact_kind(FRAMES[body.frame].kernel, True),
                   body.attachments + tuple(flat.place(p) for p in one.attachments[-2:]),
                   _scalars(one) | {"e": e}, tuned=one.tuned,
                   point=one.point._replace(body=body))
