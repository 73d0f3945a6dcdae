"""Continuous controllers: laws in the equations of motion, as elements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sebody.basics.errors import InputError
from sebody.compiler.user_functions import UserFunction
from sebody.model.arguments import chosen_name
from sebody.model.control_parts import Controller
from sebody.model.histories import clock
from sebody.model.mechanism import Mechanism
from sebody.model.parts import SLIDES, TURNS, Attachment, DofBlock, Element, LawParts, Node
from sebody.model.parts import positions as at_positions
from sebody.model.parts import rotations as at_rotations

KIND = "continuous"     # of the element
MEASURED = ("position, velocity, rotation and angular velocity of nodes, modes of bodies and their "
            "rates, angles, rates, displacements and speeds of joints")
PARTS = {"position": "position", "velocity": "position", "rotation": "rotation",
         "angular_velocity": "rotation"}


class Touched(NamedTuple):
    """What a quantity depends on."""

    places: tuple[Attachment, ...]
    modes: tuple[tuple[str, int], ...] = ()     # superelement and internal mode


def law_element(model: Mechanism, controller: Controller, derivatives: UserFunction | None,
                corners: Sequence[float]) -> Element:
    """The element of a continuous controller.

    Raises
    ------
    InputError
        An input that the equations of motion cannot read, or an actuator that lags.
    """
    where = f"controller {controller.name!r}"
    touched = [_read(model, where, name) for name in controller.inputs]
    actuators = {load.name: load for load in model.loads
                 if load.time_function is not None and load.time_function.is_input}
    driven = [actuators[name] for name in controller.outputs if name in actuators]
    for one in driven:
        _check_prompt(where, one)
    places = [place for one in touched for place in one.places]
    places += [place for one in driven for place in one.attachments]
    own = {place.dof_block: place for place in places}
    states = _hidden_states(controller)
    hidden = Node(states.name, np.zeros(0), states, None)       # in no table of the model
    attachments = [place for place in own.values() if not place.dof_block.rotational]
    attachments += [Attachment(hidden, "position")] * bool(controller.states.size)
    attachments += [place for place in own.values() if place.dof_block.rotational]
    modes = tuple(dict.fromkeys(mode for one in touched for mode in one.modes))
    return Element(chosen_name(model, None, f"law of {controller.name}"), KIND,
                   tuple(attachments), {}, time_function=clock(corners),
                   function=controller.function,
                   law=LawParts(controller.name, states, modes, derivatives))


def _hidden_states(controller: Controller) -> DofBlock:
    """A block of coordinates whose velocities are the states."""
    return DofBlock(f"{controller.name}.states", np.zeros(controller.states.size),
                    controller.states.copy(), given=True)


def _read(model: Mechanism, where: str, name: str) -> Touched:
    """What an input depends on: nothing in the equations, if it is held between samples."""
    setters = [one for one in model.controllers.values() if name in one.outputs]
    if setters and not setters[0].period:
        raise InputError(f"{where} reads {name!r} of controller {setters[0].name!r}, and both are "
                         "continuous: write one law that has the inputs of both, or give one of "
                         "them a period")
    sensor = model.sensors.get(name)
    held = sensor is not None and sensor.period
    if held or setters or any(load.name == name for load in model.loads):
        return Touched(())
    if sensor is None:
        return _touched(model, where, name, "")
    if sensor.noise:
        raise InputError(f"{where} reads sensor {name!r}, whose noise has no rate: give the sensor "
                         "rate=, between whose samples its value holds")
    return _touched(model, where, sensor.quantity, sensor.axes)


def _touched(model: Mechanism, where: str, quantity: str, axes: str) -> Touched:
    """What a quantity depends on."""
    owner, _, last = quantity.rpartition(".")
    turned = at_rotations(model.nodes[axes]) if axes else ()
    joints = [one for one in model.joints if one.name == owner]
    if joints and last in ("angle", "rate") and joints[0].kind in TURNS:
        return Touched(at_rotations(joints[0].node, joints[0].to))
    if joints and last in ("displacement", "speed") and joints[0].kind in SLIDES:
        return Touched((*at_positions(joints[0].node, joints[0].to),
                        *at_rotations(joints[0].own_axes.carrier)))
    name, _, part = owner.rpartition(".")
    if owner in model.nodes and model.planar and last in ("rotation", "angular_velocity"):
        name, part = owner, last
    if name in model.bodies and part in ("modes", "mode_rates") and last.isdecimal():
        return Touched((), ((name, int(last)),))
    node, kind = model.nodes.get(name), PARTS.get(part)
    if node is not None and kind is not None and getattr(node, kind) is not None:
        return Touched((Attachment(node, kind), *turned))
    raise InputError(f"{where} is continuous and cannot read {quantity!r}: it reads {MEASURED}; "
                     "for anything else give a sensor with rate=, between whose samples its value "
                     "holds")


def _check_prompt(where: str, actuator: Element) -> None:
    """Refuse an actuator that follows what is set with a lag or limited rate."""
    assert actuator.time_function is not None
    _, lag, rate = (*actuator.time_function.pieces[0], 0.0, 0.0, 0.0)[:3]
    if lag or rate:
        raise InputError(f"{where} is continuous and sets actuator {actuator.name!r}, which has a "
                         f"{'lag' if lag else 'largest rate'}: make the actuator without, and the "
                         "lag a state of the law, x' = (u - x) / T")
