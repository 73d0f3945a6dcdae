"""Continuous controllers as rows of numbers for their kernel."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.law_inputs import law_inputs
from sebody.contract.law_row import LAW_HEADER, OUTPUT_PLACES
from sebody.contract.read_numbers import OF_NOTHING
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import Element, LawParts


class ActuatorRow(NamedTuple):
    """The call of an actuator's kernel by a law."""

    address: int
    unknowns: list[int]
    row: list[int]          # its index row


def law_parts(element: Element) -> LawParts:
    """Parts of the element of a continuous controller."""
    assert element.law is not None
    return element.law


def law_constants(model: Mechanism, numbering: Numbering, element: Element) -> dict[str, NDArray]:
    """Values of the constants of a law, by name."""
    controller = model.controllers[law_parts(element).controller]
    inputs = law_inputs(model, numbering, controller)
    ports = numbering.memory.ports
    limits = [numbering.time_functions[ports[name]].limits or (1.0, -1.0) if name in ports
              else (1.0, -1.0) for name in controller.outputs]
    return {"mass": np.array(_mass(model)), "scales": inputs.scales, "limits": np.array(limits),
            "weights": inputs.tape.arrays().weights, "parameters": controller.parameters}


def law_counts(constants: Mapping[str, NDArray]) -> dict[str, int]:
    """The counts that the sizes of its constants refer to."""
    return {"inputs": len(constants["scales"]), "outputs": len(constants["limits"]),
            "products": constants["weights"].size, "parameters": constants["parameters"].size}


def law_row(model: Mechanism, numbering: Numbering, element: Element, unknowns: list[int],
            actuators: dict[Element, ActuatorRow]) -> list[int]:
    """Numbers behind the unknowns in the index row of a law."""
    law = law_parts(element)
    controller = model.controllers[law.controller]
    memory = numbering.memory
    state = law.states
    first = unknowns.index(numbering.dof_blocks[state]) if controller.states.size else 0
    derivatives = 0 if law.derivatives is None else law.derivatives.address
    inputs = law_inputs(model, numbering, controller)
    tape, angles = inputs.tape.arrays(), inputs.tape.angles
    known = {coordinate: k for k, coordinate in enumerate(unknowns)}
    row = [x for one in inputs.reads for x in (
        one.kind, one.place, one.number,
        known.get(one.coordinate, -1) if one.kind != OF_NOTHING else -1)]
    row += [*inputs.tape.outputs, *angles]
    at_steps = LAW_HEADER + len(row)
    at_factors = at_steps + tape.steps.size
    at_outputs = at_factors + tape.factors.size
    row = [controller.function.address, derivatives, len(controller.inputs),
           controller.states.size, len(controller.outputs), first, len(inputs.reads),
           inputs.tape.size, tape.weights.size, len(angles), at_steps, at_factors, at_outputs,
           *row, *tape.steps.tolist(), *tape.factors.tolist()]
    loads = {load.name: load for load in model.loads}
    end = at_outputs + OUTPUT_PLACES * len(controller.outputs)
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


def _mass(model: Mechanism) -> float:
    """Mass of the states, for norms: that of the lightest body."""
    masses = [body.reduced.total_mass for body in model.bodies.values()]
    masses += [body.number("mass") for body in model.rigid_bodies.values()]
    return min((mass for mass in masses if mass > 0.0), default=1.0)
