"""Runs whose parts let go and lock: one simulation after another, each of what acts.

Where a phase begins, velocities are changed by the impulse that conserves momentum, as where a run
starts from a state of another model; accelerations and multipliers are solved for anew.
"""

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.build import build
from sebody.basics.errors import InputError, Interrupted, SimulationError
from sebody.contract.layout import KINETIC, POTENTIAL, RECORD, STRAIN
from sebody.engine.state import CHUNK, DONE, FAILED, FINEST, Scheme
from sebody.engine.step_control import NEAR
from sebody.model.model import Model
from sebody.model.numbering import record_counts
from sebody.model.parts import Joint
from sebody.results.recording import Event, Recording
from sebody.results.result import Result
from sebody.runs.failures import explained
from sebody.runs.initial_state import begin
from sebody.runs.merged_phases import merged
from sebody.runs.phase_models import acting, locked_as_now, phase_of, switch_times, whole
from sebody.runs.schemes import fitting
from sebody.runs.simulation import LOOK, Simulation
from sebody.runs.steps import last_step
from sebody.runs.taken_over import taken_over
from sebody.runs.threshold_search import Search
from sebody.runs.thresholds import Threshold, thresholds_of
from sebody.runs.tolerance import Tolerance
from sebody.runs.variable_steps import begin_steps, natural_step

END = 2     # in `System.jumps`: steps end there, and nothing jumps


class Phase(Simulation):
    """A part of a run in which the same parts of a model act.

    Parameters
    ----------
    before : Phase, optional
        The phase at whose end it goes on; the first one begins at t = 0, perhaps from `start`.
    """

    def __init__(self, model: Model, h: float, scheme: Scheme, output_every: int,
                 tolerance: Tolerance | None, start: Result | None, threads: int,
                 before: "Phase | None" = None):
        self.before = before
        super().__init__(model, h, scheme, output_every, tolerance, start, threads)
        self._corners, self._jumps = self.system.corners.copy(), self.system.jumps.copy()
        self.system = replace(self.system, corners=np.append(self._corners, np.inf),
                              jumps=np.append(self._jumps, END))

    def now(self) -> Recording:
        """The state reached, as a result reads it."""
        return Recording(self.model, self.numbering, self.system, self.state,
                         self.state.now[None].copy(), 0.0)

    def read_now(self, name: str) -> float | NDArray:
        """A quantity in the state reached, as `read`; sensors without samples measure it, too."""
        sensor = self.model.sensors.get(name)
        if sensor is None or sensor.period:
            return self.read(name)
        return self.sampling.measured(sensor) + sensor.bias

    def energy(self) -> float:
        """Kinetic, strain and potential energy in the state reached."""
        return float(self.now().energies[0, [KINETIC, STRAIN, POTENTIAL]].sum())

    def run_until(self, t: float, progress: Callable[[float], None] | None,
                  thresholds: Sequence[Threshold] = ()) -> list[Threshold]:
        """Advance to a time at which a step ends, on the grid or not, or to a threshold.

        With thresholds, steps are taken one by one.

        Returns
        -------
        list of Threshold
            Those that are reached.
        """
        self.end_at(t)
        grid = int(np.floor(t / self.h + NEAR))
        if not thresholds and grid > self.state.control.grid and grid * self.h > self.time:
            self.run_to(grid * self.h, progress)
        record, found, code = self.rows.record_until(grid + 1), [], CHUNK
        search = Search(self, record, grid + 1, t, self.end_at, thresholds)
        looked = clock.perf_counter()
        try:
            found = search.reached()
            while self.time < t - NEAR * self.h and code not in (DONE, FAILED) and not found:
                search.keep()
                code = search.step()
                found = search.found() if code != FAILED else []
                if progress and clock.perf_counter() - looked > LOOK:
                    looked = clock.perf_counter()
                    progress(min(self.time / t, 1.0))
        except KeyboardInterrupt:
            self.failure = f"interrupted at t = {self.time:.6g}: results up to this time are kept"
        finally:
            self.rows.keep(record)
        self.watch.look(self.model, self.numbering, self.rows.stretches[-1])
        if self.failure:
            raise Interrupted(self.failure, self.result())
        if code == FAILED:
            self.failure = explained(self.model, self.system, self.state, self.numbering)
            raise SimulationError(self.failure, self.result())
        return found

    def end_at(self, t: float) -> None:
        """Let a step end at a time."""
        order = np.argsort(times := np.append(self._corners, t), kind="stable")
        self.system.corners[:] = times[order]
        self.system.jumps[:] = np.append(self._jumps, END)[order]
        self.state.control.corner = 0

    def _begin(self) -> None:
        """Go on from the end of the phase before."""
        if self.before is None:
            super()._begin()
            return
        model, numbering, state = self.model, self.numbering, self.state
        if self.tolerance is not None:
            state.clock.natural = natural_step(model, self.h, self.tolerance, self.plan)
        self._take_over(self.before)
        self.start = begin(model, self.system, numbering, state, goes_on=True)
        self._accelerate()
        if self.tolerance is not None:
            begin_steps(model, self.system, numbering, state, self.h, self.tolerance, self.plan)
        self.held = False

    def _take_over(self, before: "Phase") -> None:
        """Take the state, the time and the place on the output grid over."""
        state, past = self.state, before.now()
        row, _ = taken_over(self.model, self.numbering, state.now, past)
        parts = RECORD.slices(record_counts(self.numbering))
        for block in self.numbering.rotations:
            row[parts["q"]][self.numbering.dof_blocks[block]:][:3] = 0.0    # R has it
        state.now[:] = row
        state.q_old[:], state.R_old[:], state.v_old[:] = state.q, state.R, state.v
        state.frames_old[:] = state.frames
        if state.memory.shape == before.state.memory.shape:
            state.memory[:] = before.state.memory
        t = before.time
        grid = int(np.floor(t / self.h + NEAR))
        state.clock.time, state.control.grid = t, grid
        if self.tolerance is None and t > (grid + NEAR) * self.h:
            state.control.inside = 1
            state.control.unit = int(FINEST * (t / self.h - grid) + NEAR)


class Course:
    """A run through all phases.

    Parameters
    ----------
    model : Model
        See `simulate` for these and the others.
    """

    def __init__(self, model: Model, h: float, scheme: Scheme | None, output_every: int,
                 tolerance: Tolerance | None, start: Result | None, threads: int):
        self.model, self.h = model, h
        self.system, self.numbering = build(whole(model))
        scheme = fitting(scheme, bool(self.numbering.multipliers), tolerance is not None,
                         bool(model.ways()))
        self._how = h, scheme, output_every, tolerance
        self._threads = threads
        self._locked: dict[str, Joint] = {}
        self._broken: set[str] = set()      # what let go at a threshold
        self.events: list[Event] = []
        self._acting = acting(model, 0.0)
        self.phases = [Phase(phase_of(model, self._acting, {}), *self._how, start, threads)]

    def run_to(self, t_end: float, progress: Callable[[float], None] | None) -> "Course":
        """Run through all phases that begin before a time, up to it.

        Raises
        ------
        SimulationError, Interrupted
            As of `Simulation.run_to`; what was computed is in the error's `result`. A part that
            locks does not fit the pose at that time.
        """
        last = last_step(t_end, self.h, self.phases[-1].time, 0)
        end = last * self.h
        try:
            while self.phases[-1].time < end - NEAR * self.h:
                phase = self.phases[-1]
                times = [t for t in switch_times(self.model, end)
                         if t > phase.time + NEAR * self.h]
                thresholds = thresholds_of(self.model, self._acting, phase.read_now)
                if not times and not thresholds:
                    phase.run_to(t_end, progress)
                    break
                t = min([*times, end])
                share = None if progress is None else lambda part, t=t: progress(part * t / end)
                reached = phase.run_until(t, share, thresholds)
                if reached or times:
                    self._switch(phase.time + NEAR * self.h if reached else t, reached)
        except (SimulationError, Interrupted) as error:
            raise type(error)(str(error), self.result()) from error
        return self

    def _switch(self, t: float, reached: Sequence[Threshold]) -> None:
        """Begin the next phase with what acts from a time on."""
        before = self.phases[-1]
        self._broken |= {one.name for one in reached}
        acts = acting(self.model, t) - self._broken
        gone, come = self._acting - acts, acts - self._acting
        if not gone and not come:       # a time of what broke before
            return
        broke = {one.name for one in reached if one.did == "broke"}
        now = before.now()
        self._locked |= {joint.name: locked_as_now(joint, now) for joint in self.model.joints
                         if joint.name in come}
        model = phase_of(self.model, acts, self._locked)
        words = [f"{', '.join(sorted(names))} {did}" for names, did in (
            (broke, "broke"), (gone - broke, "let go"), (come, "locked"))
            if names]
        try:
            phase = Phase(model, *self._how, None, self._threads, before)
        except InputError as error:
            raise SimulationError(f"{' and '.join(words)} at t = {before.time:.6g}, but {error}",
                                  self.result()) from error
        lost = before.energy() - phase.energy()
        self.events.append(Event(float(before.time), ", ".join(words), lost))
        self.phases.append(phase)
        self._acting = acts

    def result(self) -> Result:
        """The results computed so far, in the numbering of the whole model."""
        return merged(self.model, self.system, self.numbering,
                      [phase.result() for phase in self.phases], self.events, self.h)
