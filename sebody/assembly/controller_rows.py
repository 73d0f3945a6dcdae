"""Continuous controllers as rows of numbers for their kernel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.channels import channel
from sebody.assembly.numbering import Numbering, record_counts
from sebody.basics.errors import InputError
from sebody.contract.law_row import (
    ALONG,
    ANGLE,
    DOT,
    FLAT_ALONG,
    FLAT_RATE,
    HELD,
    ITS_RATE,
    LAW_HEADER,
    OUTPUT_PLACES,
    OUTSIDE,
    READING_NUMBERS,
    READING_PLACES,
    TURNED,
)
from sebody.contract.layout import RECORD
from sebody.model.control_parts import Controller
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, LawParts


class ActuatorRow(NamedTuple):
    """How a law calls the kernel of an actuator."""

    address: int
    unknowns: list[int]
    row: list[int]          # its index row


def law_parts(element: Element) -> LawParts:
    """What makes the element of a continuous controller."""
    assert element.law is not None
    return element.law


def law_constants(model: Mechanism, numbering: Numbering, element: Element) -> dict[str, NDArray]:
    """Values of the constants of a law, by name."""
    controller = model.controllers[law_parts(element).controller]
    readings = np.zeros((len(controller.inputs), READING_NUMBERS))
    for row, name in zip(readings, controller.inputs, strict=True):
        if name not in numbering.memory.values or _is_measured(model, name):
            _, row[:-1], row[-1] = _channel(model, numbering, controller, name)
    ports = numbering.memory.ports
    limits = [numbering.time_functions[ports[name]].limits or (1.0, -1.0) if name in ports
              else (1.0, -1.0) for name in controller.outputs]
    return {"mass": np.array(_mass(model)), "readings": readings,
            "limits": np.array(limits), "parameters": controller.parameters}


def law_counts(model: Mechanism, element: Element) -> dict[str, int]:
    """The counts that the sizes of its constants refer to."""
    controller = model.controllers[law_parts(element).controller]
    return {"inputs": len(controller.inputs), "outputs": len(controller.outputs),
            "parameters": len(controller.parameters)}


def law_row(model: Mechanism, numbering: Numbering, element: Element, unknowns: list[int],
            actuators: dict[Element, ActuatorRow]) -> list[int]:
    """What follows the unknowns in the index row of a law."""
    law = law_parts(element)
    controller = model.controllers[law.controller]
    memory = numbering.memory
    state = law.states
    first = unknowns.index(numbering.dof_blocks[state]) if controller.states.size else 0
    derivatives = 0 if law.derivatives is None else law.derivatives.address
    row = [controller.function.address, derivatives, len(controller.inputs),
           controller.states.size, len(controller.outputs), first]
    for name in controller.inputs:
        if name in memory.values and not _is_measured(model, name):
            row += [HELD, 0, memory.values[name], *(READING_PLACES - 3) * [0]]
        else:
            places = _channel(model, numbering, controller, name)[0]
            row += _reading(numbering, places, unknowns)
    loads = {load.name: load for load in model.loads}
    end = LAW_HEADER + READING_PLACES * len(controller.inputs) + (
        OUTPUT_PLACES * len(controller.outputs))
    rows: list[int] = []
    for name in controller.outputs:
        if name not in memory.ports:
            row += [-1, memory.values[name], 0, 0, 0, 0]
            continue
        actuator = actuators[loads[name]]
        row += [memory.ports[name], memory.values[name], actuator.address, len(actuator.unknowns),
                len(actuator.row), end + len(rows)]
        rows += [unknowns.index(i) for i in actuator.unknowns] + actuator.row
    return row + rows


def _is_measured(model: Mechanism, name: str) -> bool:
    """Whether an input is a sensor that is read in every evaluation."""
    return name in model.sensors and not model.sensors[name].period


def _channel(model: Mechanism, numbering: Numbering, controller: Controller, name: str
             ) -> tuple[NDArray, NDArray, float]:
    """Places and numbers of a channel, and the bias of its sensor."""
    sensor = model.sensors.get(name)
    quantity, axes, bias, gain = (name, "", 0.0, 1.0) if sensor is None else (
        sensor.quantity, sensor.axes, sensor.bias, sensor.gain)
    read = channel(model, numbering, quantity, axes)
    if read.places[0] == OUTSIDE:
        raise InputError(f"controller {controller.name!r} is continuous and cannot read "
                         f"{quantity!r}, which takes more than motion of nodes and angles about "
                         "axes: give a sensor with rate=, between whose samples its value holds")
    return read.places, gain * read.numbers, bias


def _reading(numbering: Numbering, places: NDArray, unknowns: list[int]) -> list[int]:
    """A row of a reading: places in q, v or R, and first unknowns among those of the law."""
    at = RECORD.slices(record_counts(numbering))
    first_of = {9 * k: numbering.dof_blocks[block] for block, k in numbering.rotations.items()}
    kind, one, two, three = (int(number) for number in places[:4])
    rated = False

    def coordinate(place: int) -> int:
        nonlocal rated
        rated = at["v"].start <= place < at["v"].stop
        return place - (at["v"].start if rated else at["q"].start)

    def matrix(place: int) -> int:
        return place - at["R"].start
    if kind == DOT:
        values = coordinate(one), coordinate(two)
        first = values
    elif kind == ANGLE:
        values = matrix(one), matrix(two) if two >= 0 else -1
        first = first_of[values[0]], first_of[values[1]] if two >= 0 else first_of[values[0]]
    elif kind == TURNED:
        values = matrix(one), coordinate(two)
        first = first_of[values[0]], values[1]
    elif kind in (ALONG, ITS_RATE, FLAT_ALONG, FLAT_RATE):
        flat = kind in (FLAT_ALONG, FLAT_RATE)
        ends = coordinate(two), coordinate(three)
        values = coordinate(one) if flat else matrix(one), ends[0]
        first = values[0] if flat else first_of[values[0]], *ends
        return [kind, 0, *values, ends[1], first[0], *(unknowns.index(i) for i in first)]
    elif at["R"].start <= one < at["R"].stop:       # INTO
        values = matrix(one), coordinate(two)
        first = first_of[values[0]], values[1]
    else:                                           # IN_PLANE
        values = coordinate(one), coordinate(two)
        first = values
    return [kind, int(rated), *values, 0, 0, *(unknowns.index(i) for i in first), 0]


def _mass(model: Mechanism) -> float:
    """Mass of the states, for norms: that of the lightest body."""
    masses = [body.reduced.total_mass for body in model.bodies.values()]
    masses += [body.number("mass") for body in model.rigid_bodies.values()]
    return min((mass for mass in masses if mass > 0.0), default=1.0)
