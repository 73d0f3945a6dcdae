"""Sensors and controllers of a run, as far as Python has to do with them."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.channels import channel
from sebody.assembly.numbering import Numbering
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.law_row import DOT, OUTSIDE
from sebody.engine.control import set_input, set_next
from sebody.engine.control_data import (
    COUNTS,
    HAS,
    STOP,
    WAITS,
)
from sebody.engine.state import ASKED, SAMPLED, State
from sebody.engine.system import System
from sebody.model.control_order import continuous, sampled
from sebody.model.control_parts import Sensor
from sebody.model.mechanism import Mechanism
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.runs.user_faults import functions

MULTIPLE = 1e-6     # of a step: by which a period may miss a multiple of it
AXES = {"position": "q", "velocity": "v", "acceleration": "a"}


class Sampling:
    """What a run needs of Python at samples: readings of sensors that the loop cannot read."""

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State):
        self.model, self.numbering, self.system, self.state = model, numbering, system, state
        kinds = system.control.channels[:, 0]
        self._outside = [(COUNTS + system.control.periods.size + k, sensor)
                         for k, sensor in enumerate(numbering.memory.sensors)
                         if kinds[k] == OUTSIDE]
        self.unsampled: tuple[NDArray, NDArray] | None = None   # by `begin`
        self._readers: dict[str, Callable[[], float | NDArray]] = {}
        # users' functions may change or jump, and short pulses be missed: for each piece to see
        self.needs_looks = any(True for _ in functions(model)) or any(
            len(one.times) > 1 or one.waves for one in numbering.time_functions)
        self._driven = {out: one.name for one in continuous(model) for out in one.outputs}
        self._numbers = {name: k for k, name in enumerate(numbering.memory.ports)
                         if name not in self._driven}

    @property
    def has_inputs(self) -> bool:
        """Whether there is anything to set."""
        return bool(self._numbers)

    @property
    def samples(self) -> bool:
        """Whether there is anything to sample."""
        return self.system.control.periods.size > 0

    def serve(self) -> None:
        """Read what the loop waits for."""
        memory = self.state.memory
        if memory[WAITS] == 1.0 and memory[HAS] == 0.0:
            row = self._row()
            for place, sensor in self._outside:
                memory[place] = _measured(row, sensor)[0]
            memory[HAS] = 1.0

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

    def _check_number(self, sensor: Sensor) -> None:
        name, quantity = sensor.name, sensor.quantity
        try:
            value = _measured(self._row(), sensor)
        except InputError as error:
            raise InputError(f"sensor {name!r}: {error}") from error
        if value.ndim > 1:
            parts = "xyz"[:value.shape[1]] if value.ndim == 2 and value.shape[1] < 4 else "012"
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
        reader = self._readers.get(name)
        if reader is None:
            reader = self._readers.setdefault(inputs.name(name, "name of a quantity"),
                                              self._reader(name))
        return reader()

    def _reader(self, name: str) -> Callable[[], float | NDArray]:
        now, frames, values = self.state.now, self.state.frames, self.numbering.memory.values
        if name in values:
            place = values[name]
            return lambda: float(frames[place])
        owner, _, quantity = name.rpartition(".")
        node = self.model.nodes.get(owner)
        if quantity in AXES and node is not None and node.position is not None:
            part = self.state.recorded_parts[AXES[quantity]]
            first = part.start + self.numbering.dof_blocks[node.position]
            last = first + self.model.dimension
            return lambda: now[first:last].copy()
        made = channel(self.model, self.numbering, name)
        (kind, one), numbers = made.places[:2], made.numbers
        if kind == DOT and np.count_nonzero(numbers) == np.count_nonzero(numbers[1:4]) == 1:
            k = int(np.flatnonzero(numbers)[0])
            factor, place = float(numbers[k]), int(one + k - 1)
            return lambda: factor * float(now[place])
        self._check_known(name)
        return lambda: look_up(self._row(), name)[0]

    def _check_known(self, name: str) -> None:
        look_up(self._row(), name)

    def _row(self) -> Recording:
        """The state reached, as a result reads it."""
        return Recording(self.model, self.numbering, self.system, self.state,
                         self.state.now[None].copy(), 0.0)


def _measured(row: Recording, sensor: Sensor) -> NDArray:
    """What a sensor measures in the states of a recording, perhaps in axes of a node, (n, ...)."""
    if not sensor.axes:
        return sensor.gain * look_up(row, sensor.quantity)
    vector, _, label = sensor.quantity.rpartition(".")
    values, R = look_up(row, vector), look_up(row, f"{sensor.axes}.rotation")
    if row.model.planar:
        c, s = np.cos(R), np.sin(R)
        R = np.stack([c, -s, s, c], axis=1).reshape(-1, 2, 2)
    if values.shape[1:] != R.shape[2:]:
        raise InputError(f"{vector!r} is no vector, which axes turn: leave out axes=")
    return sensor.gain * np.einsum("nji,nj->ni", R, values)[:, "xyz".index(label)]
