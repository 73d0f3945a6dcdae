"""Continuous controllers: laws in the equations of motion, as elements."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from sebody.basics.errors import InputError
from sebody.compiler.user_functions import UserFunction
from sebody.model.arguments import chosen_name
from sebody.model.control_parts import Controller
from sebody.model.histories import clock
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Attachment, DofBlock, Element, LawParts, Node

KIND = "continuous"     # of the element


def law_element(model: Mechanism, controller: Controller, derivatives: UserFunction | None,
                corners: Sequence[float]) -> Element:
    """The element of a continuous controller.

    Raises
    ------
    InputError
        An input that another continuous controller sets, or an actuator that lags.
    """
    where = f"controller {controller.name!r}"
    for name in controller.inputs:
        _check_input(model, where, name)
    law = Element(chosen_name(model, None, f"law of {controller.name}"), KIND, (), {},
                  time_function=clock(corners), function=controller.function,
                  law=LawParts(controller.name, _hidden_states(controller), (), derivatives))
    for one in _driven(model, controller):
        _check_prompt(where, one)
    complete_law(model, law, controller, (), ())
    return law


def complete_law(model: Mechanism, law: Element, controller: Controller,
                 read: Iterable[Attachment], modes: tuple[tuple[str, int], ...]) -> None:
    """Let a law act on the places and modes that it reads, its states and its actuators."""
    assert law.law is not None
    states = law.law.states
    places = [*read, *(place for one in _driven(model, controller) for place in one.attachments)]
    own = {place.dof_block: place for place in places}
    hidden = Node(states.name, np.zeros(0), states, None)       # in no table of the model
    law.attachments = (
        *(place for place in own.values() if not place.dof_block.rotational),
        *[Attachment(hidden, "position")] * bool(states.start.size),
        *(place for place in own.values() if place.dof_block.rotational))
    law.dof_blocks = tuple(one.dof_block for one in law.attachments)
    law.law = law.law._replace(modes=modes)


def _driven(model: Mechanism, controller: Controller) -> list[Element]:
    """Actuators that a controller sets."""
    actuators = {load.name: load for load in model.loads
                 if load.time_function is not None and load.time_function.is_input}
    return [actuators[name] for name in controller.outputs if name in actuators]


def _hidden_states(controller: Controller) -> DofBlock:
    """A block of coordinates whose velocities are the states."""
    return DofBlock(f"{controller.name}.states", np.zeros(controller.states.size),
                    controller.states.copy(), given=True)


def _check_input(model: Mechanism, where: str, name: str) -> None:
    """Refuse what other laws give in the same instant, and noise."""
    setters = [one for one in model.controllers.values() if name in one.outputs]
    if setters and not setters[0].period:
        raise InputError(f"{where} reads {name!r} of controller {setters[0].name!r}, and both are "
                         "continuous: write one law that has the inputs of both, or give one of "
                         "them a period")
    sensor = model.sensors.get(name)
    if sensor is not None and sensor.noise and not sensor.period:
        raise InputError(f"{where} reads sensor {name!r}, whose noise has no rate: give the sensor "
                         "rate=, between whose samples its value holds")


def _check_prompt(where: str, actuator: Element) -> None:
    """Refuse an actuator that follows what is set with a lag or limited rate."""
    assert actuator.time_function is not None
    _, lag, rate = (*actuator.time_function.pieces[0], 0.0, 0.0, 0.0)[:3]
    if lag or rate:
        raise InputError(f"{where} is continuous and sets actuator {actuator.name!r}, which has a "
                         f"{'lag' if lag else 'largest rate'}: make the actuator without, and the "
                         "lag a state of the law, x' = (u - x) / T")
