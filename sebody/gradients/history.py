"""The accepted steps of a run: what a gradient is taken along.

A run is a sequence of events: its start, steps, and restarts where accelerations jump. Each one
leaves a state; the next begins from there. Steps have the lengths that the run has accepted,
halved ones and parts of steps up to a jump included. Long runs are divided into segments, see
`segments.py`: the history of a segment begins with the state that the one before has left.
"""

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import memory
from sebody.basics.errors import SimulationError
from sebody.contract.layout import C_STIFFNESS, RECORD_T
from sebody.engine.scalars import numbers_of
from sebody.engine.state import FAILED, Record, State
from sebody.engine.step import write_record
from sebody.runs.aid import Aid, advance
from sebody.runs.failures import explained
from sebody.runs.simulation import Simulation

RESTART, STEP = 0, 1        # kinds of events
OFF = 1e-6                  # of a step: a time that is that near is at its end
ROOM = 8                    # rows that may be recorded in one step of a run


class Past(NamedTuple):
    """State before a segment of a run."""

    kinds: NDArray      # (events,) as of a `History`, from the start to the first of the segment
    ends: NDArray
    besides: NDArray
    recorded: int       # states before the segment


class History(NamedTuple):
    """Events of a run, the first of which is its start, or of a segment of it, the first of which
    has left the state that the segment begins with, and belongs to the segment before.
    """

    rows: NDArray       # (events, size of a row of `layout.RECORD`) states that they leave
    kinds: NDArray      # (events,) RESTART or STEP
    steps: NDArray      # (events,) length of the step; of a restart that which auxiliary
                        # accelerations belong to after it [time]
    offsets: NDArray    # (events,) length over that of the step before: (15) of the README
    ends: NDArray       # (events,) time of the loads [time]
    besides: NDArray    # (events,) by how much loads are read before or after that [time]
    recorded: NDArray   # events whose states a `Result` has, ascending
    seconds: float      # of the run
    duration: float     # of the whole run [time]
    past: Past | None = None    # of a segment that does not begin at the start
    aux: NDArray = np.zeros(0)  # auxiliary accelerations in the first state

    @property
    def times(self) -> NDArray:
        """Times of the recorded states."""
        return self.rows[self.recorded, RECORD_T]

    @property
    def states(self) -> NDArray:
        """The recorded rows."""
        if len(self.recorded) == len(self.rows):        # no copy: of long runs they are most
            return self.rows
        return self.rows[self.recorded]


def history(run: Simulation, t_end: float) -> History:
    """Run a simulation that is at its start to a time, and keep every accepted step.

    Variable steps end there; their states are all recorded.

    Raises
    ------
    SimulationError
        A step failed; what was computed is in the error's `result`.
    """
    meet(run, [t_end])
    return stretch(run, round(t_end / run.h))


def stretch(run: Simulation, last: int, most: int | None = None) -> History:
    """Go on with a run to step `last` of the grid, or for at least `most` events if it is given.

    Returns the events from the state at hand on; `recorded` has this one if it is the start. Fixed
    steps end on the grid.

    Raises
    ------
    SimulationError
        A step failed; the states from here on are in the error's `result`.
    """
    began, control, grid = time.perf_counter(), run.state.control, int(run.state.control.grid)
    end = last if most is None else min(last, grid + most)
    aux = run.state.aux.copy()
    memory.check(8.0 * (end - grid) * run.state.now.size, f"the states of {end - grid} steps",
                 "give an earlier t_end or longer steps")
    if (whole := _whole(run, grid, end)) is not None:
        return whole._replace(seconds=time.perf_counter() - began, duration=run.h * last, aux=aux)
    events = _Events(run, last)
    before = control.steps, float(run.state.clock.aux_step)     # of the last accepted step
    while control.grid < last and (most is None or len(events.rows) <= most
                                   or (run.tolerance is None and control.unit > 0)):
        if not _one_step(run, events.record, last):
            run.failure = explained(run.model, run.system, run.state, run.numbering)
            run.rows.stretches.append(np.array(events.rows)[events.recorded[1:]])
            raise SimulationError(run.failure, run.result())
        if control.steps > before[0]:
            events.add(before[1])
            before = control.steps, float(run.state.clock.aux_step)
    return events.found(time.perf_counter() - began, run.h * last)._replace(aux=aux)


def meet(run: Simulation, times: Sequence[float]) -> None:
    """Let variable steps end at some times."""
    if run.tolerance is None:
        return
    system = run.system
    more = np.setdiff1d(np.array([t for t in times if t > 0.0]), system.corners)
    corners = np.concatenate([system.corners, more])
    order = np.argsort(corners)
    jumps = np.concatenate([system.jumps, np.zeros(len(more), dtype=np.int64)])
    run.system = replace(system, corners=corners[order], jumps=jumps[order])
    run.aid = Aid.of(run.system, run.state, run.sampling.read_sensors)


def _whole(run: Simulation, first: int, last: int) -> History | None:
    """Steps of the grid in one go; None, and the run as before, if it is to be step by step.

    That is where steps are rejected or loads jump.
    """
    state, start, count = run.state, copy_of(run.state), last - first
    before, steps, cuts = float(state.clock.aux_step), state.control.steps, state.control.cuts
    after = (first + OFF) * run.h if first else -np.inf
    inside = (run.system.corners > after) & (run.system.corners <= (last + OFF) * run.h)
    if run.tolerance is not None or (run.system.jumps[inside] > 0).any():
        return None
    record = Record.of(state, count + 1)
    state.control.recorded = 0
    write_record(state, record)
    code = advance(run, record, last, count + 1)
    if code == FAILED or state.control.steps - steps != count or state.control.cuts > cuts:
        put_back(state, start)
        run.aid.forget()
        return None
    offsets, kinds = np.ones(count + 1), np.full(count + 1, STEP)
    kinds[0] = RESTART
    lengths = np.full(count + 1, run.h)
    if first:
        offsets[1] = run.h / before
    else:
        lengths[0] = before
    times = record.rows[:, RECORD_T].copy()
    return History(record.rows, kinds, lengths, offsets, times, 0.0 * times,
                   np.arange(first > 0, count + 1), 0.0, 0.0)


def copy_of(state: State) -> list[NDArray]:
    """Copies of all that a state has."""
    return [numbers_of(one).copy() if isinstance(one, np.record) else one.copy()
            for one in (getattr(state, name) for name in State.__annotations__)]


def put_back(state: State, numbers: list[NDArray]) -> None:
    """Undo what was done to a state since it was copied."""
    for name, before in zip(State.__annotations__, numbers, strict=True):
        one = getattr(state, name)
        (numbers_of(one) if isinstance(one, np.record) else one)[...] = before


def _one_step(run: Simulation, record: Record, last: int) -> bool:
    """Advance by one accepted step, and by the restart that may follow; False if it fails."""
    run.state.control.recorded = 0
    return advance(run, record, last, 1) != FAILED


class _Events:
    """Collects the events of a run."""

    def __init__(self, run: Simulation, last: int):
        self.run, self.varies = run, run.tolerance is not None
        self.record = Record.of(run.state, max(ROOM, last + 1) if self.varies else ROOM)
        self.kinds, self.steps, self.offsets = [RESTART], [float(run.state.clock.aux_step)], [1.0]
        self.ends, self.besides = [float(run.state.clock.time)], [0.0]
        self.rows, self.recorded = [run.state.now.copy()], [0] * int(run.state.control.steps == 0)

    def add(self, aux_step: float) -> None:
        """Add the step that was accepted last, and the restart if there was one."""
        state, clock = self.run.state, self.run.state.clock
        end, beside = float(clock.end), float(clock.beside)
        # a restart leaves the coefficients of its own matrix, masses and constraints
        restarted = state.coefficients[C_STIFFNESS] == 0.0
        length = float(clock.aux_step)
        if restarted or not np.isfinite(length):
            length = float(clock.time) - self.ends[-1]
        row = state.now.copy()
        if restarted:
            row[state.recorded_parts["a"]] = self._accelerations_before(length)
        self._event(row, STEP, length, length / aux_step, end, beside)
        if restarted:
            self._event(state.now.copy(), RESTART, float(clock.aux_step), 1.0, float(clock.time),
                        -beside)
        if state.control.recorded or self.varies:
            self.recorded.append(len(self.rows) - 1)

    def _event(self, row: NDArray, kind: int, *numbers: float) -> None:
        row[RECORD_T] = self.run.state.clock.time
        self.rows.append(row)
        self.kinds.append(kind)
        for values, number in zip((self.steps, self.offsets, self.ends, self.besides), numbers,
                                  strict=True):
            values.append(number)

    def _accelerations_before(self, h: float) -> NDArray:
        """Accelerations at the end of the step, before they were solved for anew: (2), (3)."""
        state: State = self.run.state
        s = self.run.scheme
        aux = ((state.v - state.v_old) / h - (1 - s.gamma) * state.aux_old) / s.gamma
        found = ((1 - s.alpha_m) * aux + s.alpha_m * state.aux_old - s.alpha_f * state.a_old) / (
            1 - s.alpha_f)
        return np.where(self.run.system.is_multiplier[:len(found)] > 0, 0.0, found)

    def found(self, seconds: float, duration: float) -> History:
        """All events."""
        return History(
            np.array(self.rows), np.array(self.kinds), np.array(self.steps),
            np.array(self.offsets), np.array(self.ends), np.array(self.besides),
            np.array(self.recorded, dtype=np.int64), seconds, duration)
