"""Joints, bodies, loads and springs of a spatial model in a plane of symmetry.

A joint keeps those of its equations that restrict motion in the plane.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Axes, Element, Joint, positions, rotations
from sebody.model.rope_parts import ROPE
from sebody.model.spring_laws import unpacked
from sebody.model.variants.flat_contacts import LAWS, flat_places, sign_of_angle
from sebody.model.variants.flat_ropes import ROPE_KINDS, flat_wheel, rope_equation, sharing
from sebody.model.variants.flattening import Flattening

PARALLEL = 1e-9         # one less the cosine of an angle that is rounding
TURNING_TOGETHER = ("weld", "prismatic")    # joints whose nodes keep any direction


def check_joints(model: Mechanism) -> None:
    """Check that the planar form of every joint is known.

    Raises
    ------
    InputError
        It is not; the message names the joint and the kind of its equation.
    """
    for joint in model.joints:
        for one in joint.constraints:
            if one.kind not in EQUATIONS:
                raise InputError(f"joint {joint.name!r} {_unknown(one.kind, 'EQUATIONS')}")


def _unknown(kind: str, table: str) -> str:
    return (f"has the kind {kind!r}, whose form in a plane is unknown: build the planar model by "
            f"hand, or add {kind!r} to {table} in sebody/model/variants/flat_elements.py")


def flat_element(flat: Flattening, element: Element) -> Element:
    """A rigid body, load or spring in the plane.

    Raises
    ------
    InputError
        It is not symmetric about the plane, or its form in a plane is unknown.
    """
    if element.kind in LAWS:
        kind, constants = LAWS[element.kind](flat, element)
        return Element(element.name, kind, flat_places(flat, element, kind), constants,
                       tuned=element.tuned)
    if element.function is not None:
        raise InputError(f"{element.name!r} is a function of yours, whose symmetry is unknown: "
                         "build the planar model by hand")
    if element.table is not None:
        raise InputError(f"{element.name!r} has a table of the speed: build the planar model with "
                         "it by hand, or give bushing(..., speed=)")
    if element.kind not in ELEMENTS:
        raise InputError(f"{element.name!r} {_unknown(element.kind, 'ELEMENTS')}")
    kind, constants = ELEMENTS[element.kind](flat, element)
    hidden = None if element.hidden is None else flat.dof_block(element.hidden)
    return Element(element.name, kind, tuple(flat.place(p) for p in element.attachments), constants,
                   time_function=element.time_function, hidden=hidden, tuned=element.tuned)


def flat_joint(flat: Flattening, joint: Joint) -> Joint:
    """A joint or drive in the plane, with fewer equations.

    Raises
    ------
    InputError
        It is not symmetric about the plane.
    """
    if joint.kind == "revolute" and not flat.is_normal(joint.axis):
        raise InputError(f"the axis of {joint.name!r} is not normal to the plane")
    node, to = flat.node(joint.node), flat.node(joint.to)
    equations: list[Element] = []
    for one in joint.constraints:
        equation = EQUATIONS[one.kind](flat, joint, one)
        if equation is not None and not (equation.kind == "planar_aligned" and any(
                e.kind == equation.kind for e in equations)):
            equations.append(equation)
    if any(e.kind == "planar_turn_drive" for e in equations) and (
            flat.plane.normal @ joint.axis < 0):
        node, to = to, node     # it turns `to` about the normal as `node` about its axis
        equations = [Element(e.name, e.kind, e.attachments[::-1], e.constants, e.multipliers,
                             e.time_function)
                     for e in equations]
    if joint.kind == ROPE:
        equations = sharing(joint, equations)
    return Joint(joint.name, tuple(equations), node, to, _axes(flat, joint), joint.kind)


def _axes(flat: Flattening, joint: Joint) -> Axes | None:
    if joint.axes is None:
        return None
    first = joint.axis
    if joint.kind in ("spherical", "weld") or not flat.is_inside(first):
        return Axes.of(flat.node(joint.axes.carrier))
    e = flat.vector(first, joint.name)
    return Axes.of(flat.node(joint.axes.carrier), (e, np.array([-e[1], e[0]])))


# equations of joints


def _equation(flat: Flattening, one: Element, kind: str, multipliers: int,
              constants: dict | None = None, attachments: tuple | None = None) -> Element:
    attachments = tuple(flat.place(p)
                        for p in one.attachments) if attachments is None else attachments
    return Element(one.name, kind, attachments, constants or {}, multipliers, one.time_function)


def _coincident(flat: Flattening, joint: Joint, one: Element) -> Element:
    return _equation(flat, one, "planar_coincident", 2)


def _coincident_ground(flat: Flattening, joint: Joint, one: Element) -> Element:
    return _equation(flat, one, "planar_coincident_ground", 2,
                     {"c": flat.point(one.vector("c"), f"{joint.name!r}")})


def _parallel(flat: Flattening, joint: Joint, one: Element) -> Element | None:
    if flat.is_normal(one.vector("e")):
        return None
    return _aligned(flat, joint, one, flat.is_inside(one.vector("e")))


def _perpendicular(flat: Flattening, joint: Joint, one: Element) -> Element | None:
    e, n = (one.vector(name) for name in ("e", "n"))
    if any(flat.is_normal(a) and flat.is_inside(b) for a, b in ((e, n), (n, e))):
        return None
    return _aligned(flat, joint, one, flat.is_inside(e) and flat.is_inside(n))


def _aligned(flat: Flattening, joint: Joint, one: Element, symmetric: bool) -> Element:
    if not symmetric and joint.kind not in TURNING_TOGETHER:
        raise InputError(f"the axis of {joint.name!r} is neither in the plane nor normal to it")
    return _equation(flat, one, "planar_aligned", 1,
                     attachments=rotations(flat.node(joint.node), flat.node(joint.to)))


def _on_line(flat: Flattening, joint: Joint, one: Element) -> Element:
    axis = np.cross(one.vector("n1"), one.vector("n2"))
    if flat.is_normal(axis):
        return _equation(flat, one, "planar_coincident", 2,
                         attachments=positions(*(flat.node(p.node) for p in one.attachments[:2])))
    e = flat.vector(axis, f"the axis of {joint.name!r}")
    return _equation(flat, one, "planar_on_line", 1, {"n1": np.array([-e[1], e[0]])})


def _on_plane(flat: Flattening, joint: Joint, one: Element) -> Element | None:
    normal = one.vector("n1")
    if flat.is_normal(normal):
        return None
    return _equation(flat, one, "planar_on_line", 1,
                     {"n1": flat.vector(normal, f"the normal of {joint.name!r}")})


def _distance(flat: Flattening, joint: Joint, one: Element) -> Element:
    return _equation(flat, one, "planar_distance", 1, dict(one.constants))


def _turn_drive(flat: Flattening, joint: Joint, one: Element) -> Element:
    flat.axial(joint.axis, f"the axis of {joint.name!r}")
    return _equation(flat, one, "planar_turn_drive", 1)


def _slide_drive(flat: Flattening, joint: Joint, one: Element) -> Element:
    e = flat.vector(one.vector("e"), f"the axis of {joint.name!r}")
    return _equation(flat, one, "planar_slide_drive", 1,
                     {"e": e, "start": one.constants["start"]})


def _coupling(flat: Flattening, joint: Joint, one: Element) -> Element:
    constants: dict[str, float | NDArray] = {}
    ratio = one.number("ratio")
    for k in "12":
        if "e" + k in one.constants:
            constants |= {"e" + k: flat.vector(one.vector("e" + k), f"an axis of {one.name!r}"),
                          "start" + k: one.number("start" + k)}
        else:
            ratio *= sign_of_angle(flat, one, k)
            constants["rest" + k] = 0.0
    return _equation(flat, one, f"planar_{one.kind}", 1, constants | {"ratio": ratio})


EQUATIONS: dict[str, Callable[[Flattening, Joint, Element], Element | None]] = {
    "coincident": _coincident, "coincident_ground": _coincident_ground, "parallel": _parallel,
    "parallel_ground": _parallel, "perpendicular": _perpendicular, "on_line": _on_line,
    "on_plane": _on_plane, "distance": _distance, "turn_drive": _turn_drive,
    "slide_drive": _slide_drive,
    **{f"couple_{pair}": _coupling for pair in ("turn_turn", "slide_turn", "slide_slide")},
    **dict.fromkeys(ROPE_KINDS, rope_equation)}


# rigid bodies, loads and springs


def _rigid_body(flat: Flattening, one: Element) -> tuple[str, dict]:
    c = one.constants
    first = flat.vector(one.vector("mc"), f"the centre of mass of {one.name!r}")
    J = np.array([[c[f"J_{''.join(sorted(a + b))}"] for b in "xyz"] for a in "xyz"])
    own = flat.plane.axes.T @ J @ flat.plane.axes
    if np.abs(own[:2, 2]).max() > 1e-9 * np.trace(J):
        raise InputError(f"no principal axis of inertia of {one.name!r} is normal to the plane")
    return "planar_rigid_body", {"mass": c["mass"], "mc": first, "J_zz": own[2, 2]}


def _unchanged(flat: Flattening, one: Element) -> tuple[str, dict]:
    return f"planar_{one.kind}", dict(one.constants)


def _force(flat: Flattening, one: Element) -> tuple[str, dict]:
    return f"planar_{one.kind}", {"d": flat.vector(one.direction, repr(one.name))}


def _torque(flat: Flattening, one: Element) -> tuple[str, dict]:
    return "planar_torque", {"d": np.array([flat.axial(one.direction, repr(one.name))])}


def _torsion_spring(flat: Flattening, one: Element) -> tuple[str, dict]:
    c = one.constants
    axis = np.cross(one.vector("n"), one.vector("m"))
    side = np.sign(flat.axial(axis, f"the axis of {one.name!r}"))
    return "planar_torsion_spring", {"k": c["k"], "k3": c["k3"], "c": c["c"],
                                     "rest": side * c["rest"]}


def _table_torsion_spring(flat: Flattening, one: Element) -> tuple[str, dict]:
    axis = np.cross(one.vector("n"), one.vector("m"))
    side = np.sign(flat.axial(axis, f"the axis of {one.name!r}"))
    tables = {name: one.vector(name) if side > 0 else unpacked(one.vector(name)).mirrored().packed()
              for name in ("force", "damper")}
    return "planar_table_torsion_spring", tables | {"rest": side * one.number("rest")}


def _bushing(flat: Flattening, one: Element) -> tuple[str, dict]:
    """Its axes may lie in the plane in any direction where the third is normal to it.

    Where coefficients along axes are equal, any axes will do.
    """
    axes = np.array([one.constants[f"e{k}"] for k in (1, 2, 3)]) @ flat.plane.axes
    tilted = [name for name in one.constants if name[1:2] in ("t", "u") and len(name) > 2]
    if any(one.number(name) for name in tilted):
        raise InputError(f"{one.name!r} couples tilts, which leave the plane")
    of = {name: axes.T @ np.diag(one.constants[name]) @ axes for name in ("k", "c", "kt", "ct")}
    for name in ("k", "c") if one.kind == "bearing" else ():
        across = np.zeros((3, 3))
        across[0, 1], across[1, 0] = (one.number(name + at) for at in ("12", "21"))
        of[name] = of[name] + axes.T @ across @ axes
    turn = np.eye(3)
    if abs(axes[:, 2]).max() > 1.0 - PARALLEL:      # of one axis
        first = np.delete(axes, np.argmax(abs(axes[:, 2])), axis=0)[0]
        turn[:2, 0], turn[:2, 1] = first[:2], [-first[1], first[0]]
    for name, matrix in of.items():
        turned = of[name] = turn.T @ matrix @ turn
        held = turned - np.diag(np.diag(turned))
        if name in ("k", "c") and one.kind == "bearing":
            held[:2, :2] = 0.0
        if np.abs(held).max() > 1e-9 * np.abs(turned).max():
            raise InputError(f"{one.name!r} has other coefficients along axes that are neither in "
                             "the plane nor normal to it")
    kept: dict[str, NDArray] = {name: np.diag(matrix)[:2] if name in ("k", "c") else
                                np.diag(matrix)[2:] for name, matrix in of.items()}
    if one.kind == "bearing":
        for name in ("k", "c"):
            kept |= {f"{name}12": of[name][0, 1], f"{name}21": of[name][1, 0]}
    return f"planar_{one.kind}", kept | {"e1": turn[:2, 0], "e2": turn[:2, 1]}


def _table_bushing(flat: Flattening, one: Element) -> tuple[str, dict]:
    """One axis is normal to the plane; laws along it and of tilts push nowhere in the plane."""
    axes = np.array([one.constants[f"e{k}"] for k in (1, 2, 3)]) @ flat.plane.axes
    normal = int(np.argmax(abs(axes[:, 2])))
    side = np.sign(axes[normal, 2])
    if abs(axes[normal, 2]) < 1.0 - PARALLEL:
        raise InputError(f"{one.name!r} has no axis normal to the plane, along which its laws act")
    first, second = ((normal + step) % 3 for step in ((1, 2) if side > 0 else (2, 1)))
    for key in (str(normal + 1), f"t{first + 1}", f"t{second + 1}"):
        if any(unpacked(one.vector(name + key)).at(np.zeros(1)) for name in ("force", "damper")):
            raise InputError(f"the law of {one.name!r} pushes out of the plane where it is at rest")
    tables = {}
    for name in ("force", "damper"):
        about = one.vector(f"{name}t{normal + 1}")
        tables[f"{name}t3"] = about if side > 0 else unpacked(about).mirrored().packed()
        for k, axis in enumerate((first, second), start=1):
            tables[f"{name}{k}"] = one.vector(f"{name}{axis + 1}")
    return "planar_table_bushing", tables | {"e1": axes[first, :2], "e2": axes[second, :2]}


def _turn_motor(flat: Flattening, one: Element) -> tuple[str, dict]:
    along = flat.axial(one.vector("e"), f"the axis of {one.name!r}")
    return "planar_turn_motor", {"gain": one.number("gain") * np.sign(along)}


def _turn_rotor(flat: Flattening, one: Element) -> tuple[str, dict]:
    flat.axial(one.vector("e"), f"the axis of {one.name!r}")
    return "planar_turn_rotor", {name: one.constants[name] for name in ("inertia", "ratio")}


def _of_winch(flat: Flattening, one: Element) -> tuple[str, dict]:
    return one.kind, dict(one.constants)


def _along(flat: Flattening, one: Element) -> tuple[str, dict]:
    return f"planar_{one.kind}", dict(one.constants) | {
        "e": flat.vector(one.vector("e"), f"the axis of {one.name!r}")}


ELEMENTS: dict[str, Callable[[Flattening, Element], tuple[str, dict]]] = {
    "rigid_body": _rigid_body, "point_mass": _unchanged, "force": _force, "follower_force": _force,
    "torque": _torque, "follower_torque": _torque, "spring": _unchanged,
    "torsion_spring": _torsion_spring, "table_spring": _unchanged,
    "table_torsion_spring": _table_torsion_spring, "bushing": _bushing, "bearing": _bushing,
    "table_bushing": _table_bushing,
    "turn_motor": _turn_motor, "turn_rotor": _turn_rotor, "slide_motor": _along,
    "slide_rotor": _along, "line_motor": _unchanged, "line_rotor": _unchanged,
    "rope_wheel": flat_wheel, "friction_rope": _unchanged, "way_motor": _of_winch,
    "way_rotor": _of_winch}
