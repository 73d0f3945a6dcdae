"""Sensors, controllers and inputs of a model as arrays, and where what they keep is.

Behind what elements keep in `State.frames` there are, and are recorded: of every input what was set
and when, values of sensors, signals, states of controllers.
"""

from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.channels import channel
from sebody.assembly.memory_map import MemoryMap
from sebody.assembly.numbering import Numbering
from sebody.contract.law_row import OUTSIDE
from sebody.contract.layout import INPUT_NUMBERS
from sebody.engine.control_data import (
    APPLY,
    CHANNEL_NUMBERS,
    CHANNEL_PLACES,
    CONTROLLER,
    COUNTS,
    ITS_QUEUE,
    NEVER,
    NEXT,
    SENSOR,
    STOP,
    Control,
)
from sebody.model.control_order import continuous, order, sampled, signals
from sebody.model.control_parts import Controller, Sensor
from sebody.model.mechanism import Mechanism


class Task(NamedTuple):
    """What is sampled with a period."""

    kind: int
    number: int
    period: float
    offset: float = 0.0     # when it is due first


def control_arrays(model: Mechanism, numbering: Numbering, table_at: NDArray) -> Control:
    """The arrays of a model."""
    stored = numbering.memory
    sensors, controllers = list(stored.sensors), sampled(model)
    tasks = _tasks(sensors, controllers, order(model))
    numbers = {sensor.name: k for k, sensor in enumerate(sensors)}
    channels = [channel(model, numbering, one.quantity, one.axes) for one in sensors]
    first = COUNTS + len(tasks) + 2 * len(sensors)
    queues, first = _queues([(s.delay, 1) for s in sensors], first)
    delayed, first = _queues([(c.whole_delay, len(c.outputs)) for c in controllers], first)
    scratch = list(accumulate((len(c.inputs) + len(c.outputs) for c in controllers),
                              initial=first))
    wires, at_wires = _wires(stored, controllers, numbers)
    ends, at_ends = _ends(stored, controllers)
    held = {*signals(model), *(one.name for one in sensors if one.period)}
    at_parameters = list(accumulate((len(c.parameters) for c in controllers), initial=0))
    return Control(
        tasks=_table([(one.kind, one.number) for one in tasks], 2),
        periods=np.array([one.period for one in tasks], dtype=float),
        offsets=np.array([one.offset for one in tasks], dtype=float),
        channels=_table([one.places for one in channels], 1 + CHANNEL_PLACES),
        coefficients=np.array([s.gain * one.numbers for s, one in zip(
            sensors, channels, strict=True)], dtype=float).reshape(-1, CHANNEL_NUMBERS),
        sensors=_table([(stored.values[s.name], k, s.delay, queues[k])
                        for k, s in enumerate(sensors)], 4),
        errors=np.array([(s.bias, s.noise) for s in sensors], dtype=float).reshape(-1, 2),
        seeds=np.array([s.seed for s in sensors], dtype=np.int64),
        controllers=_table([(
            c.function.address, at_wires[k], len(c.inputs), at_ends[k], len(c.outputs),
            stored.states[c.name], at_parameters[k], c.whole_delay, delayed[k], scratch[k],
            int(c.rest > 0.0))
            for k, c in enumerate(controllers)], 11),
        wires=wires, ends=ends,
        inputs=_table([(port, place, table_at[port]) for port, place in stored.inputs.items()], 3),
        limits=np.array([numbering.time_functions[port].limits or (1.0, -1.0)
                         for port in stored.inputs], dtype=float).reshape(-1, 2),
        parameters=np.concatenate([np.zeros(0), *(c.parameters for c in controllers)]),
        outside=np.array([int(any(one.places[0] == OUTSIDE for one in channels))]),
        flowing=np.array([stored.values[name] for one in continuous(model) for name in one.outputs],
                         dtype=np.int64),
        read=np.array([int(any(name in held for one in continuous(model)
                               for name in one.inputs))]),
        memory=np.array([scratch[-1]]))


def begin(model: Mechanism, numbering: Numbering, control: Control, memory: NDArray,
          frames: NDArray) -> None:
    """Set what inputs, signals, delayed outputs and states are before the first sample."""
    stored = numbering.memory
    memory[:] = 0.0
    memory[NEXT] = memory[STOP] = NEVER
    for port, place in stored.inputs.items():
        start = numbering.time_functions[port].at(0.0)[0]
        frames[place:place + INPUT_NUMBERS] = start, 0.0, start
    for k, one in enumerate(sampled(model)):
        first = stored.states[one.name]
        frames[first:first + len(one.states)] = one.states
        if one.whole_delay:
            starts = [numbering.time_functions[stored.ports[name]].at(0.0)[0]
                      if name in stored.ports else 0.0 for name in one.outputs]
            first = 1 + int(control.controllers[k, ITS_QUEUE])
            memory[first:first + one.whole_delay * len(starts)] = np.tile(starts, one.whole_delay)


def _tasks(sensors: list[Sensor], controllers: list[Controller], ordered: list[Controller]
           ) -> list[Task]:
    """Sensors before controllers, these so that signals are there before they are read.

    What was computed before acts before the next one computes.
    """
    return [*(Task(SENSOR, k, one.period) for k, one in enumerate(sensors) if one.period),
            *(Task(APPLY, k, one.period, one.rest) for k, one in enumerate(controllers)
              if one.rest),
            *(Task(CONTROLLER, controllers.index(one), one.period) for one in ordered)]


def _queues(delays: list[tuple[int, int]], first: int) -> tuple[list[int], int]:
    """Where queues begin: a position, then the numbers of so many samples."""
    places = list(accumulate((1 + delay * size if delay else 0 for delay, size in delays),
                             initial=first))
    return places[:-1], places[-1]


def _wires(stored: MemoryMap, controllers: list[Controller], numbers: dict[str, int]
           ) -> tuple[NDArray, list[int]]:
    """What controllers are given."""
    rows = []
    for one in controllers:
        for name in one.inputs:
            k = numbers.get(name, -1)
            asked = k >= 0 and not stored.sensors[k].period       # read when it is asked for
            rows.append((stored.values[name], k if asked else -1))
    return _table(rows, 2), list(accumulate((len(c.inputs) for c in controllers), initial=0))


def _ends(stored: MemoryMap, controllers: list[Controller]) -> tuple[NDArray, list[int]]:
    """What controllers set."""
    ports = list(stored.inputs)
    rows = [(ports.index(stored.ports[name]), -1) if name in stored.ports
            else (-1, stored.values[name])
            for one in controllers for name in one.outputs]
    return _table(rows, 2), list(accumulate((len(c.outputs) for c in controllers), initial=0))


def _table(rows: list[tuple[int, ...]], width: int) -> NDArray:
    return np.array(rows, dtype=np.int64).reshape(-1, width)
