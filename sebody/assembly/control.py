"""Sensors, controllers and inputs of a model as arrays, and where what they keep is.

Behind what elements keep in `State.frames` there are, and are recorded: of every input what was set
and when, values of sensors, signals, states of controllers.
"""

from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import INPUT_NUMBERS
from sebody.engine.control_data import (
    APPLY,
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
from sebody.model.numbering import MemoryMap, Numbering
from sebody.quantities.expressions import Tape
from sebody.quantities.symbols import NoTape, Recorded


class Tapes(NamedTuple):
    """Tapes of sensors, one after the other."""

    places: list[tuple[int, ...]]       # of every sensor, from OUTPUT on: see `engine.control_data`
    reads: NDArray
    steps: NDArray
    factors: NDArray
    weights: NDArray


class Task(NamedTuple):
    """A task that is done with a period."""

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
    tapes = [_tape(model, numbering, one) for one in sensors]
    first = COUNTS + len(tasks) + 2 * len(sensors)
    at_numbers = list(accumulate((0 if tape is None else tape.size for tape in tapes),
                                 initial=first))
    first = at_numbers[-1]
    queues, first = _queues([(s.delay, 1) for s in sensors], first)
    delayed, first = _queues([(c.whole_delay, len(c.outputs)) for c in controllers], first)
    scratch = list(accumulate((len(c.inputs) + len(c.outputs) for c in controllers),
                              initial=first))
    wires, at_wires = _wires(stored, controllers, numbers)
    ends, at_ends = _ends(stored, controllers)
    held = {*signals(model), *(one.name for one in sensors if one.period)}
    read = _together(tapes, at_numbers)
    at_parameters = list(accumulate((len(c.parameters) for c in controllers), initial=0))
    return Control(
        tasks=_table([(one.kind, one.number) for one in tasks], 2),
        periods=np.array([one.period for one in tasks], dtype=float),
        offsets=np.array([one.offset for one in tasks], dtype=float),
        sensors=_table([(stored.values[s.name], s.delay, queues[k], *places) for k, (s, places)
                        in enumerate(zip(sensors, read.places, strict=True))], 10),
        reads=read.reads, steps=read.steps, factors=read.factors, weights=read.weights,
        scales=np.array([(s.gain, s.bias, s.noise) for s in sensors], dtype=float).reshape(-1, 3),
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
        outside=np.array([int(None in tapes)]),
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


def _tape(model: Mechanism, numbering: Numbering, sensor: Sensor) -> Tape | None:
    """The tape of what a sensor measures; None where Python has to read it, or to refuse it."""
    of = Recorded(model, numbering)
    try:
        shape = of.put(sensor.quantity, sensor.axes)
    except (NoTape, InputError):
        return None
    timed = any(place == of.parts["t"].start for (_, place), _ in of.tape.read_for())
    return None if shape or timed else of.tape      # the time is written to recorded rows alone


def _together(tapes: list[Tape | None], at_numbers: list[int]) -> Tapes:
    """Tapes one after the other; `at_numbers` are the places of their numbers."""
    places, reads, arrays = [], [], [Tape().arrays()]
    ends = np.array([part.size for part in arrays[0]])
    for tape, at in zip(tapes, at_numbers, strict=False):
        if tape is None:
            places.append((0,) * 7)
            continue
        before = len(reads)
        reads += [(number, place) for (_, place), number in tape.read_for()]
        places.append((tape.outputs[0], at, before, len(reads), *ends.tolist()))
        arrays.append(tape.arrays())
        ends = ends + [part.size for part in arrays[-1]]
    return Tapes(places, _table(reads, 2), *map(np.concatenate, zip(*arrays, strict=True)))


def _queues(delays: list[tuple[int, int]], first: int) -> tuple[list[int], int]:
    """The places where queues start: a position, then the numbers of so many samples."""
    places = list(accumulate((1 + delay * size if delay else 0 for delay, size in delays),
                             initial=first))
    return places[:-1], places[-1]


def _wires(stored: MemoryMap, controllers: list[Controller], numbers: dict[str, int]
           ) -> tuple[NDArray, list[int]]:
    """Wires: places of what controllers are given."""
    rows = []
    for one in controllers:
        for name in one.inputs:
            k = numbers.get(name, -1)
            asked = k >= 0 and not stored.sensors[k].period       # read when it is asked for
            rows.append((stored.values[name], k if asked else -1))
    return _table(rows, 2), list(accumulate((len(c.inputs) for c in controllers), initial=0))


def _ends(stored: MemoryMap, controllers: list[Controller]) -> tuple[NDArray, list[int]]:
    """Ends: places of what controllers set."""
    ports = list(stored.inputs)
    rows = [(ports.index(stored.ports[name]), -1) if name in stored.ports
            else (-1, stored.values[name])
            for one in controllers for name in one.outputs]
    return _table(rows, 2), list(accumulate((len(c.outputs) for c in controllers), initial=0))


def _table(rows: list[tuple[int, ...]], width: int) -> NDArray:
    return np.array(rows, dtype=np.int64).reshape(-1, width)
