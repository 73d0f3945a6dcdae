"""The models of the phases of a run: what lets go is left out, what locks keeps its pose."""

from collections.abc import Mapping
from copy import copy
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.model.model import Model
from sebody.model.parts import COUPLING, Element, Joint, Node
from sebody.model.time_functions import TimeFunction
from sebody.results.histories import histories
from sebody.results.recording import Recording


def switch_times(model: Model) -> set[float]:
    """Times at which something lets go or locks."""
    return {t for switch in model.switches.values() for t in switch.times}


def acting(model: Model, t: float) -> set[str]:
    """Names of the parts with times that act from a time on."""
    return {name for name, switch in model.switches.items() if switch.acts(t)}


def phase_of(model: Model, acts: set[str], locked: Mapping[str, Joint]) -> Model:
    """The model with the parts that act; it shares all of them with the model.

    Friction in a joint that has let go is left out with it.

    Parameters
    ----------
    acts : set of str
        Those that act of the parts with times.
    locked : mapping of str to Joint
        Joints with the pose that they lock, in place of those of the model.
    """
    phase = copy(model)
    phase.is_phase = True
    gone = model.switches.keys() - acts
    phase.joints = [locked.get(one.name, one) for one in model.joints if one.name not in gone]
    joints = {one.name: one for one in phase.joints}
    ways = {one.way for joint in model.joints if joint.name in gone for one in joint.constraints}
    phase.loads = []
    for load in model.loads:
        if load.pressed_by is not None and load.pressed_by.name in gone or any(
                place.dof_block in ways for place in load.attachments):
            continue        # friction and springs in a joint go with it
        if load.name not in gone:
            phase.loads.append(_pressed(load, joints))
        elif load.time_function is not None and load.time_function.is_input:
            phase.loads.append(_idle(load))     # whose signal controllers go on to give
    return phase


def _idle(actuator: Element) -> Element:
    """An actuator without force."""
    name = "gain" if "gain" in actuator.constants else "d"
    return replace(actuator, constants={**actuator.constants,
                                        name: 0.0 * np.asarray(actuator.constants[name])})


def whole(model: Model) -> Model:
    """The model with all of its parts, as if they acted all the time."""
    return phase_of(model, set(model.switches), {})


def locked_as_now(joint: Joint, now: Recording) -> Joint:
    """A weld, distance or coupling that holds the pose in a state; other joints as they are.

    Coordinates of a coupling count from the state.

    A weld keeps the place of `node` in axes of `to` and ``C = R^T R'``, the rotation of `to` in
    axes of `node`: a direction ``C n`` of `node` stays where the direction n of `to` is.
    """
    if joint.kind == COUPLING:
        (one,) = joint.constraints
        return replace(joint, constraints=(_counted_from(one, now),))
    if joint.kind not in ("weld", "distance"):
        return joint
    return replace(joint, constraints=tuple(_as_now(one, now) for one in joint.constraints))


def _as_now(one: Element, now: Recording) -> Element:
    kind = one.kind.removeprefix("planar_")
    places = [_place(node, now) for node in dict.fromkeys(at.node for at in one.attachments)]
    (x, R), (y, S) = places
    if kind == "distance":
        return replace(one, constants={**one.constants, "length": float(np.linalg.norm(y - x))})
    if kind == "slide_drive":
        start = float(one.vector("e") @ R.T @ (y - x))
        return replace(one, constants={**one.constants, "start": start})
    if kind == "turn_drive":
        angle = _angle(one.attachments[0].node, now) - _angle(one.attachments[1].node, now)
        return replace(one, time_function=TimeFunction((0.0,), ((angle,),)))
    turned = {name: R.T @ S @ one.vector(name) for name in one.constants if name != "e" or
              kind not in ("parallel", "perpendicular")}
    return replace(one, constants={**one.constants, **turned})


def _counted_from(one: Element, now: Recording) -> Element:
    """A coupling whose angles and displacements are 0 in a state."""
    constants = dict(one.constants)
    kinds = one.kind.removeprefix("planar_").split("_")[1:]
    places = [place.node for place in one.attachments if place.kind == "position"]
    turning = [place.node for place in one.attachments if place.kind == "rotation"]
    for k, kind in enumerate(kinds, 1):
        if kind == "slide":
            (x, R), (y, _) = (_place(places.pop(0), now) for _ in range(2))
            turning.pop(0)
            constants[f"start{k}"] = float((R @ one.vector(f"e{k}")) @ (y - x))
            continue
        a, b = turning.pop(0), turning.pop(0)
        if f"rest{k}" in constants:
            constants[f"rest{k}"] = _angle(a, now) - _angle(b, now)
            continue
        # the direction of b that the one of a has now; both are normal to the axis
        seen = _place(b, now)[1].T @ _place(a, now)[1] @ one.vector(f"d{k}")
        n, m = one.vector(f"n{k}"), one.vector(f"m{k}")
        angle = np.arctan2(m @ seen, n @ seen)
        constants[f"n{k}"] = np.cos(angle) * n + np.sin(angle) * m
        constants[f"m{k}"] = np.cos(angle) * m - np.sin(angle) * n
    return replace(one, constants=constants)


def _place(node: Node, now: Recording) -> tuple[NDArray, NDArray]:
    """Position and rotation matrix of a node in a state."""
    of = histories(now)
    x = node.point if node.position is None else of.whole(of.coordinates("q", node.position))[-1]
    return x, of.whole(of.rotation(node.rotation))[-1]


def _angle(node: Node, now: Recording) -> float:
    """Angle of a node of a planar model in a state."""
    if node.rotation is None:
        return 0.0
    of = histories(now)
    return float(of.whole(of.coordinates("q", node.rotation))[-1, 0])


def _pressed(load: Element, joints: Mapping[str, Joint]) -> Element:
    """A load, with the joint of the phase where one presses it."""
    joint = load.pressed_by and joints[load.pressed_by.name]
    return load if joint is load.pressed_by else replace(load, pressed_by=joint)
