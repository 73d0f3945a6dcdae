"""Phases of a run whose parts let go and lock: in each of them the same parts act.

Where a phase begins, velocities are changed by the impulse that conserves momentum, as where a run
starts from a state of another model; accelerations and multipliers are solved for anew.
"""

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import KINETIC, POTENTIAL, RECORD, STRAIN
from sebody.engine.state import CHUNK, DONE, FAILED, FINEST, Record, Scheme
from sebody.engine.step_control import NEAR
from sebody.model.model import Model
from sebody.model.numbering import record_counts
from sebody.results.recording import Recording
from sebody.results.result import Result
from sebody.runs.initial_state import begin
from sebody.runs.simulation import LOOK, Simulation
from sebody.runs.taken_over import taken_over
from sebody.runs.threshold_search import Search
from sebody.runs.thresholds import Threshold
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

    def run_until(self, t_end: float, t: float, progress: Callable[[float], None] | None,
                  thresholds: Sequence[Threshold] = ()) -> list[Threshold]:
        """Advance to a step of the grid, or to the time of a switch if that comes first.

        With thresholds, steps are taken one by one, and the run ends where one is reached.

        Parameters
        ----------
        t_end : float
            Time of a step of the grid.
        t : float
            Time at which a step ends, on the grid or not; infinite without one.

        Returns
        -------
        list of Threshold
            Those that are reached.
        """
        stop, looks = min(t, t_end), bool(thresholds)
        # chosen steps that pass the end would find thresholds beyond it
        ends = stop if looks and self.tolerance is not None else t
        self.end_at(ends)
        grid = int(np.floor(stop / self.h + NEAR))
        if not looks and grid > self.state.control.grid:
            self.run_to(grid * self.h, progress)
        if self.time > stop - NEAR * self.h or t > t_end and not looks:
            return []
        self._look_before(stop)
        record = self.rows.record_until(grid + 1)
        search = Search(self, record, grid + 1, ends, self.end_at, thresholds)
        return self._step_until(stop, search, record, progress)

    def _step_until(self, t: float, search: Search, record: Record,
                    progress: Callable[[float], None] | None) -> list[Threshold]:
        """Take steps one by one; the thresholds that are reached."""
        found, code, stopped = [], CHUNK, False
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
        except BaseException as error:
            search.back()
            stopped = isinstance(error, KeyboardInterrupt)
            if not stopped:
                raise
        finally:
            self.rows.keep(record)
        self._look_after(code == FAILED, stopped)
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
