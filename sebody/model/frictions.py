"""Dry friction in the joints of a model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Unpack

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name
from sebody.model.joint_forces import give_forces, has_forces
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Attachment, Axes, Element, Joint, positions, rotations

# kernels by the kind of joint, and whether it is in a plane
KERNELS = {("revolute", False): "friction_turn_f3m2", ("universal", False): "friction_turn_f3m1",
           ("prismatic", False): "friction_slide_f2m3", ("slider", False): "friction_slide_f2",
           ("cylindrical", False): "friction_cylindrical_f2m2",
           ("spherical", False): "friction_spherical_f3",
           ("path", False): "friction_way", ("path", True): "friction_way",
           ("revolute", True): "friction_turn_f2", ("spherical", True): "friction_turn_f2",
           ("prismatic", True): "friction_slide_f1m1", ("slider", True): "friction_slide_f1"}
SLIDING = ("prismatic", "slider", "path")
BEARINGS = ("friction_turn_f3m2", "friction_turn_f3m1")
TAKES = {"radial": (1.0, 0.0), "axial": (0.0, 1.0), "whole": (1.0, 1.0)}
DAMPING = 0.7           # of bristles, relative to the critical one


class Dry(NamedTuple):
    """Checked coefficients of dry friction."""

    constants: Mapping[str, float]
    tuned: Mapping[str, float]


def friction(model: Mechanism, joint: Joint | str, coefficient: float, static: float | None = None,
             radius: float | None = None, preload: float = 0.0, arm: float | None = None,
             reaction: bool = True, bristle: float | None = None,
             damping: float | None = None, speed: float = 0.0, slip: float | None = None,
             takes: str | None = None, name: str | None = None,
             **acting: Unpack[Acting]) -> Element | tuple[Element, ...]:
    """Dry friction in a joint or drive: it sticks up to a limit, and slides against the motion.

    The limit is the coefficient times the normal force, times the radius where the joint turns. The
    normal force is `preload` plus the force in the joint across its axis, plus its moment across
    the axis over `arm`. Joints of shared positions get equations, whose multipliers are this force.
    The force along the axis of a hinge is that of a collar, with friction of its own: a second
    `friction` in the joint that takes it.

    Along a path each of its bodies has friction of what it bears, and they are numbered where
    there are several.

    Sticking is elastic: bristles with a stiffness, which bend up to the limit and do not creep.

    Parameters
    ----------
    joint : Joint or str
        A revolute, universal (friction about both axes), prismatic, cylindrical or spherical joint,
        a slider, a joint on a path, or a drive, which knows no normal force but the preload.
    coefficient : float
        Of sliding.
    static : float, optional
        Of break-away, at least `coefficient`, by default the same. It acts until the joint slides.
    radius : float, optional
        Where the friction acts; needed where the joint turns [length].
    preload : float
        Normal force that is always there [force].
    arm : float, optional
        Arm on which the joint takes moments across its axis [length]; without it they press
        nothing.
    reaction : bool
        Whether the force in the joint presses; else the preload alone does.
    bristle : float, optional
        Stiffness of sticking, force/length or moment/angle. By default that with which the mass
        that the joint sees vibrates with the period 2 pi h of a step h.
    slip : float, optional
        In place of `bristle`: displacement [length], or angle [rad], at which it gives way under
        the preload.
    damping : float, optional
        Of this vibration, relative to the critical one; 0.7 by default.
    takes : {'radial', 'axial', 'whole'}, optional
        Which force in a revolute or universal joint in space presses: across the axis, as in a
        journal, by default; along it, as on a collar of this `radius`; or its whole size.
    speed : float
        Reference speed of a smooth law without sticking (Brown and McPhee), for gradients
        [length/time] or [rad/time]; 0 for bristles. It takes nothing that is of bristles.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Returns
    -------
    Element, or two of a universal joint, ``name 1`` about the axis of `node`, ``name 2``; along a
    path over several bodies one of each, ``name 1`` and so on

    Raises
    ------
    InputError
        A negative coefficient, a static one below that of sliding, no radius, a smooth law with
        bristles, or a joint without friction, such as a weld.
    """
    joint = _joint(model, joint)
    what = f"friction in {joint.name!r}"
    sliding = _sliding(joint)
    dry = checked_friction(what, coefficient, static, bristle, damping, speed)
    if slip is not None:
        _refuse_bristles(what, speed, slip=slip)
    if radius is None and not sliding:
        raise InputError(f"{what}: the joint turns, so its friction acts on a radius: give radius=")
    own_radius = 1.0 if radius is None else inputs.number(radius, f"{what}: radius", above=0)
    preload = inputs.number(preload, f"{what}: preload", least=0)
    stiffness = {} if slip is None else {"bristle": _stiffness(
        what, slip, bristle, dry.constants["static"] * preload * own_radius)}
    constants = dict(dry.constants) | stiffness | {
        "radius": own_radius, "preload": preload,
        "per_moment": 0.0 if arm is None else 1.0 / inputs.number(arm, f"{what}: arm", above=0)}
    reads = inputs.flag(reaction, f"{what}: reaction") and joint.kind != "drive"
    if not reads and not preload > 0:
        raise InputError(f"{what}: nothing presses, since the force in it is not read: give "
                         "preload=" + " or reaction=True" * (joint.kind != "drive"))
    if joint.kind == "path":
        _refuse_levers(what, radius=radius, arm=arm)
        del constants["radius"], constants["per_moment"]
        constants["reads"] = float(reads)
    parts = _parts(model, joint, sliding, what)
    if reads and any(one.path and one.path.section is not None and not one.path.turns
                     for one in joint.constraints):
        raise InputError(f"{what}: the path leaves the node of joint {joint.name!r} free across, "
                         "so friction does not read its force: give reaction=False and preload=")
    kind = KERNELS[joint.kind, model.planar] if reads else _plain(joint, sliding, what)
    if takes is not None or kind in BEARINGS:
        constants |= _taken(what, joint, kind, takes)
    name = chosen_name(model, name, what.replace("'", ""))
    if reads and joint.kind != "path" and not has_forces(joint):
        give_forces(model, joint)
    made = []
    for k, (attachments, own) in enumerate(parts, 1):
        label = f"{name} {k}" if len(parts) > 1 else name
        made.append(Element(label, model.kind_of(kind), attachments, constants | own,
                            pressed_by=joint if reads or joint.kind == "path" else None,
                            seen=k - 1 if joint.kind == "path" else None, tuned=dry.tuned))
    model.loads.extend(made)
    return made[0] if len(made) == 1 else tuple(made)


def _refuse_levers(what: str, **given: float | None) -> None:
    """Refuse what is of moments and turns, which a point on a path has not."""
    for name, value in given.items():
        if value is not None:
            raise InputError(f"{what}: a point on a path turns freely and bears no moment: leave "
                             f"{name}= out")


def _taken(what: str, joint: Joint, kind: str, takes: str | None) -> dict[str, float]:
    """Squares of the shares of the forces across and along the axis of a hinge."""
    if kind not in BEARINGS:
        raise InputError(f"{what}: takes is of revolute and universal joints in space whose force "
                         f"is read, and this is a {joint.kind}: leave it out")
    across, along = TAKES[inputs.choice(takes or "radial", f"{what}: takes", TAKES)]
    return {"across": across, "along": along}


def _stiffness(what: str, slip: float, bristle: float | None, limit: float) -> float:
    """Stiffness of bristles that give way at a displacement under a force."""
    slip = inputs.number(slip, f"{what}: slip", above=0)
    if bristle is not None:
        raise InputError(f"{what} has a slip and a bristle, which both say how stiff sticking is: "
                         "give one of them")
    if not limit > 0:
        raise InputError(f"{what} has a slip of {slip:g} and no force under which it gives way: "
                         "give preload= and a coefficient above zero, or bristle=")
    return limit / slip


def checked_friction(what: str, coefficient: float, static: float | None, bristle: float | None,
                     damping: float | None, speed: float, called: str = "coefficient") -> Dry:
    """Check what all dry friction has; `called` is the argument with the coefficient."""
    mu = inputs.number(coefficient, f"{what}: {called}", least=0)
    break_away = mu if static is None else inputs.number(static, f"{what}: static", least=0)
    if break_away < mu:
        raise InputError(f"{what}: static is {break_away:g}, below the coefficient of sliding "
                         f"{mu:g}: a body that slides would stick at a larger force; give at "
                         "least that")
    stiffness = 0.0 if bristle is None else inputs.number(bristle, f"{what}: bristle", above=0)
    critical = DAMPING if damping is None else inputs.number(damping, f"{what}: damping", least=0)
    smooth = inputs.number(speed, f"{what}: speed", least=0)
    _refuse_bristles(what, smooth, bristle=bristle, damping=damping)
    return Dry({"bristle": stiffness, "bristle_damping": 0.0, "coefficient": mu,
                "static": break_away, "speed": smooth}, {"damping": critical})


def _refuse_bristles(what: str, speed: float, **given: float | None) -> None:
    """Refuse what is of bristles for the smooth law, which has none."""
    for name, value in given.items():
        if value is not None and speed > 0:
            raise InputError(f"{what} has {name}= {value:g} and speed= {speed:g}, but the smooth "
                             f"law of a speed has no bristles: give one of the two")


def _joint(model: Mechanism, joint: Joint | str) -> Joint:
    element = model.element(joint) if isinstance(joint, str) else joint
    if not isinstance(element, Joint) or element not in model.joints:
        raise inputs.refusal("joint", joint, "give a joint of the model or its name")
    return element


def _sliding(joint: Joint) -> bool:
    """Tell whether measures are lengths alone."""
    if joint.kind == "drive":
        return "slide" in joint.constraints[0].kind
    return joint.kind in SLIDING


def _plain(joint: Joint, sliding: bool, what: str) -> str:
    """The kernel that reads no multipliers."""
    if joint.kind == "path":
        return KERNELS["path", False]
    if joint.kind == "cylindrical":
        raise InputError(f"{what}: leave reaction=False out, a cylindrical joint knows its force")
    if joint.kind == "spherical" and len(joint.node.point) == 3:
        return "friction_spherical"
    return "friction_slide" if sliding else "friction_turn"


def _parts(model: Mechanism, joint: Joint, sliding: bool, what: str
           ) -> list[tuple[tuple[Attachment, ...], dict[str, float | NDArray]]]:
    """Places and constants of the geometry: two of a universal joint."""
    if joint.kind != "drive" and (joint.kind, model.planar) not in KERNELS:
        kinds = sorted({kind for kind, planar in KERNELS if planar == model.planar})
        raise InputError(f"{what}: a {joint.kind} has no friction: use it in {', '.join(kinds)} "
                         "joints or in drives")
    a, b = joint.node, joint.to
    if joint.kind == "path":
        return [(one.attachments[-1:], {}) for one in joint.constraints
                if one.path and not one.path.turns]
    if sliding:
        return [(joint.way.attachments, {"e": joint.way.direction})]
    if joint.kind == "cylindrical":
        return [(positions(a, b) + rotations(a, b),
                 {"e": joint.way.direction} | turning(joint.own_axes))]
    if joint.kind == "spherical" and not model.planar:
        return [(rotations(a, b), {})]
    if joint.kind == "universal":
        n, e, _ = joint.own_axes.columns.T
        return [(rotations(b, a), _seen(n, e)), (rotations(a, b), _seen(e, n))]
    return [(rotations(a, b), {} if model.planar else turning(joint.own_axes))]


def turning(axes: Axes) -> dict[str, float | NDArray]:
    """Source of the angle about the first of some axes."""
    return _seen(axes.columns[:, 0], axes.columns[:, 1])


def _seen(axis: NDArray, across: NDArray) -> dict[str, float | NDArray]:
    """A direction across the axis, and the same and one at a right angle in the other body."""
    across = across - axis * (axis @ across)
    across = across / np.linalg.norm(across)
    return {"d": across, "n": across, "m": np.cross(axis, across)}
