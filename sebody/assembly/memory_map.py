"""Numbers that are stored from step to step beside unknowns, and their places in `State.frames`.

Behind the frames of the superelements there is what elements keep; then, of every input, what was
set and when; what sensors measured last; signals of controllers; their states.
"""

from collections.abc import Mapping
from itertools import accumulate

from sebody.basics.errors import InputError
from sebody.contract.layout import INPUT_NUMBERS
from sebody.kernels.loader import element_kernel
from sebody.model.control_order import actuators, sampled, signals
from sebody.model.control_parts import Controller, Sensor
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import MemoryMap
from sebody.model.parts import Element, Node, Superelement


def memory_map(model: Mechanism, ports: Mapping[Element | Superelement, int],
               angles: Mapping[Element, int]) -> MemoryMap:
    """Number what is stored; `ports` are those of loads, `angles` those that laws keep."""
    memories, first = {}, 9 * len(frame_numbers(model))
    for one in (*model.loads, *model.constraints):
        if count := angles.get(one, len(element_kernel(one.kind).MEMORY)):
            memories[one] = list(range(first, first + count))
            first += count
    inputs = {ports[one]: first + INPUT_NUMBERS * k
              for k, one in enumerate(actuators(model).values())}
    own = {name: ports[one] for name, one in actuators(model).items()}
    first += INPUT_NUMBERS * len(inputs)
    sensors, set_by_controllers = _sensors(model), signals(model)
    names = [*(one.name for one in sensors), *set_by_controllers]
    values = {name: first + k for k, name in enumerate(names)}
    values |= {name: inputs[port] for name, port in own.items()}
    first += len(names)
    controllers = sampled(model)
    places = list(accumulate((len(one.states) for one in controllers), initial=first))
    states = {one.name: place for one, place in zip(controllers, places, strict=False)}
    return MemoryMap(memories, inputs, own, sensors, values, states, places[-1])


def frame_numbers(model: Mechanism) -> dict[Superelement | Element, int]:
    """Numbers of the frames of superelements, then of points on curves that nodes carry."""
    curves = [c for c in model.constraints
              if c.path is not None and isinstance(c.path.here.carrier, Node)]
    return {owner: k for k, owner in enumerate((*model.bodies.values(), *curves))}


def _sensors(model: Mechanism) -> list[Sensor]:
    """Sensors, and quantities that controllers name without one."""
    sensors = dict(model.sensors)
    known = {*sensors, *signals(model), *actuators(model)}
    for controller in sampled(model):
        for name in controller.inputs:
            if name not in known and name not in sensors:
                _check_quantity(model, controller, name, known)
                sensors[name] = Sensor(name, name, 0.0, 0, 0.0, 0.0, 0)
    return list(sensors.values())


def _check_quantity(model: Mechanism, controller: Controller, name: str, known: set[str]) -> None:
    """Refuse an input that is neither a sensor nor looks like a quantity."""
    if "." not in name:
        there = ", ".join(sorted(known)) or "none"
        raise InputError(f"controller {controller.name!r}: input {name!r} is unknown: give a "
                         f"sensor, signal or actuator ({there}), or a quantity such as "
                         "'tip.position.y'")
