"""Sensors and controllers of a run, as far as Python has to do with them."""

from collections.abc import Callable
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.engine.control import set_input, set_next
from sebody.engine.control_data import (
    COUNTS,
    OUTPUT,
    STOP,
)
from sebody.engine.state import ASKED, SAMPLED, State
from sebody.engine.system import System
from sebody.model.control_order import continuous, sampled
from sebody.model.control_parts import Sensor
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.quantities.reading import Reading, evaluate
from sebody.quantities.symbols import NoTape
from sebody.results.histories import histories
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.results.tapes import States
from sebody.runs.user_faults import functions

MULTIPLE = 1e-6     # of a step: by which a period may miss a multiple of it


class _Taped(NamedTuple):
    """Sensors whose quantities are outputs of one tape."""

    places: NDArray         # of their readings in `State.memory`
    gains: NDArray
    reading: Reading
    turns: bool             # whether it has angles


class Sampling:
    """Work of Python at the samples of a run: readings of sensors that the loop cannot read."""

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State):
        self.model, self.numbering, self.system, self.state = model, numbering, system, state
        self._outside = [(COUNTS + system.control.periods.size + k, sensor)
                         for k, sensor in enumerate(numbering.memory.sensors)
                         if system.control.sensors[k, OUTPUT] == 0]
        self.unsampled: tuple[NDArray, NDArray] | None = None   # by `begin`
        self._read: dict[str, Callable[[], float | NDArray]] = {}
        self._measure: dict[tuple[str, str], Callable[[], float | NDArray]] = {}
        self._start = state.now.copy()
        # users' functions may change or jump, and short pulses be missed: for each piece to see
        self.needs_looks = any(True for _ in functions(model)) or any(
            len(one.times) > 1 or one.waves for one in numbering.time_functions) or bool(
            numbering.series)
        self._driven = {out: one.name for one in continuous(model) for out in one.outputs}
        self._numbers = {name: k for k, name in enumerate(numbering.memory.ports)
                         if name not in self._driven}

    @property
    def has_inputs(self) -> bool:
        """True where there is an input to set."""
        return bool(self._numbers)

    @property
    def samples(self) -> bool:
        """True where there is a task to do at samples."""
        return self.system.control.periods.size > 0

    def read_sensors(self) -> None:
        """Read the sensors that the loop cannot read."""
        taped, others = self._sensors
        if taped is not None:
            self.state.memory[taped.places] = taped.gains * self._values(taped.reading, taped.turns)
        for place, sensor in others:
            self.state.memory[place] = self.measured(sensor)

    @cached_property
    def _sensors(self) -> tuple[_Taped | None, list[tuple[int, Sensor]]]:
        """One tape for all sensors that have one, and the sensors that have none."""
        states = States(self.model, self.numbering, self.system, self.state, self._start)
        taped, others = [], []
        for place, sensor in self._outside:
            try:
                states.put(sensor.quantity, sensor.axes)
                taped.append((place, sensor.gain))
            except NoTape:
                others.append((place, sensor))
        if not taped:
            return None, others
        places, gains = zip(*taped, strict=True)
        return _Taped(np.array(places), np.array(gains), states.reading(),
                      bool(states.tape.angles)), others

    def check(self, h: float, fixed: bool) -> None:
        """Refuse quantities that are no numbers, and periods that fixed steps do not meet.

        Raises
        ------
        InputError
            The message names the sensor or controller.
        """
        for _, sensor in self._outside:
            self._check_number(sensor)
        tasks = [(f"sensor {one.name!r} has the period", one.period)
                 for one in self.model.sensors.values() if one.period]
        tasks += [(f"controller {one.name!r} has the period", one.period)
                  for one in sampled(self.model)]
        tasks += [(f"controller {one.name!r} has a delay beside whole samples of", one.rest)
                  for one in sampled(self.model) if one.rest]
        for what, period in tasks if fixed else ():
            steps = period / h
            if round(steps) < 1 or abs(steps - round(steps)) > MULTIPLE * max(steps, 1.0):
                near = period / max(1, int(np.ceil(steps - MULTIPLE)))
                raise InputError(f"{what} {period:.9g}, which the step {h:.9g} does "
                                 f"not divide: give a step that does, such as {near:.6g}, or "
                                 "variable steps, tolerance=Tolerance(...)")

    def measured(self, sensor: Sensor) -> float | NDArray:
        """Measurement of a sensor in the state reached."""
        key = sensor.quantity, sensor.axes
        if key not in self._measure:
            self._measure[key] = self._reader(*key)
        return sensor.gain * self._measure[key]()

    def _check_number(self, sensor: Sensor) -> None:
        name, quantity = sensor.name, sensor.quantity
        try:
            value = np.asarray(self.measured(sensor))
        except InputError as error:
            raise InputError(f"sensor {name!r}: {error}") from error
        if value.ndim > 0:
            parts = "xyz"[:len(value)] if value.ndim == 1 and len(value) < 4 else "012"
            given = ", ".join(f"{quantity}.{part}" for part in parts[:3])
            raise InputError(f"sensor {name!r} measures {quantity!r}, which is several numbers: "
                             f"give one of them, such as {given}")

    def begin(self) -> bool:
        """Ask for the first samples, once accelerations are known; whether there are any.

        `unsampled` gets `State.frames` and `State.memory` as they are before these.
        """
        if not self.samples:
            return False
        self.unsampled = self.state.frames.copy(), self.state.memory.copy()
        set_next(self.system.control, self.state.memory)
        self.state.control.restart, self.state.control.meets = ASKED, SAMPLED
        return True

    def stop_at(self, t: float) -> None:
        """Let a variable step end at a time at which inputs may be set."""
        if self._numbers and self.state.control["adaptive"]:
            self.state.memory[STOP] = t
            set_next(self.system.control, self.state.memory)

    def set_input(self, name: str, value: float) -> bool:
        """Set an input; whether it changed.

        Raises
        ------
        InputError
            No such input, or no number.
        """
        if name in self._driven:
            raise InputError(f"input {name!r} is what the continuous controller "
                             f"{self._driven[name]!r} sets, so another value would have no "
                             "effect: leave it or the controller out")
        if name not in self._numbers:
            inputs.choice(name, "input", self._numbers or ["none: add model.actuator(...)"])
        if type(value) is not float or value - value != 0.0:
            value = inputs.number(value, f"input {name!r}")
        return bool(set_input(self.system, self.state, self._numbers[name], value))

    def read(self, name: str) -> float | NDArray:
        """A quantity in the state reached.

        Raises
        ------
        InputError
            A name that nothing has.
        """
        reader = self._read.get(name)
        if reader is None:
            reader = self._read.setdefault(inputs.name(name, "name of a quantity"),
                                           self._last(name) or self._reader(name))
        return reader()

    def _last(self, name: str) -> Callable[[], float] | None:
        """Reader of the value that a sensor, a controller or Python gave last."""
        frames, place = self.state.frames, self.numbering.memory.values.get(name)
        return None if place is None else lambda: float(frames[place])

    def _reader(self, name: str, axes: str = "") -> Callable[[], float | NDArray]:
        """Reader of a quantity, of a vector perhaps a component in axes of a node."""
        now = self.state.now
        states = States(self.model, self.numbering, self.system, self.state, self._start)
        try:
            shape = states.put(name, axes)
        except NoTape:
            return lambda: self._looked_up(name, axes)
        if (places := states.places()) is None:
            turns = bool(states.tape.angles)
            return partial(self._evaluated, states.reading(), shape, turns)
        if shape:
            return lambda: now[places].reshape(shape)
        place = int(places[0])
        return lambda: float(now[place])

    def _looked_up(self, name: str, axes: str) -> float | NDArray:
        """A quantity without a tape, perhaps in axes of a node."""
        row = self._row()
        if not axes:
            return look_up(row, name)[0]
        vector, _, label = name.rpartition(".")
        of = histories(row)
        R = of.whole(of.rotation(self.model.nodes[axes].rotation))[0]
        return float(R[:, "xyz".index(label)] @ look_up(row, vector)[0])

    def _evaluated(self, reading: Reading, shape: tuple[int, ...], turns: bool) -> float | NDArray:
        """A quantity whose tape is evaluated in the state reached."""
        values = self._values(reading, turns)
        if not shape:
            return float(values[0])
        found = values.copy()
        return found if len(shape) == 1 else found.reshape(shape)

    def _values(self, reading: Reading, turns: bool) -> NDArray:
        """The outputs of a tape in the state reached; the next evaluation overwrites them."""
        if turns:
            reading.numbers[1:] = 0.0       # angles begin within half a turn
        if evaluate(self.system, self.state, reading):
            raise InputError(f"the state at t = {self.state.clock.time:.6g} cannot be evaluated")
        return reading.values

    def _row(self) -> Recording:
        """The state reached, as a result reads it."""
        return Recording(self.model, self.numbering, self.system, self.state,
                         self.state.now[None].copy(), 0.0)
