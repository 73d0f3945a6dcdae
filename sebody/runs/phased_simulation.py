"""Runs whose parts let go and lock, piece by piece: one phase after another."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.build import build
from sebody.basics import inputs
from sebody.basics.errors import InputError, Interrupted, SimulationError
from sebody.basics.progress import showing
from sebody.engine.state import Scheme
from sebody.engine.step_control import NEAR
from sebody.model.model import Model
from sebody.model.parts import Joint
from sebody.model.summary import summary
from sebody.results.recording import Event
from sebody.results.result import Result
from sebody.runs.merged_phases import merged
from sebody.runs.phase_models import acting, locked_as_now, phase_of, switch_times, whole
from sebody.runs.phases import Phase
from sebody.runs.schemes import checked, fitting
from sebody.runs.thresholds import BROKE, LET_GO, thresholds_of
from sebody.runs.tolerance import Tolerance, given

Reached = tuple[str, str]       # what lets go at a threshold, and one of `thresholds.DID`


class PhasedSimulation:
    """A `Simulation` of a model of which parts let go, lock or break.

    Parameters
    ----------
    model : Model
        See `Simulation` for the arguments.

    Attributes
    ----------
    events : list of Event
        What let go and locked so far: time, names, energy lost.
    phases : list of Phase
        Simulations of what acts, the last of which goes on.
    reached : list of list
        For each event, what let go at thresholds, as `change` takes it.

    Raises
    ------
    InputError
        As of `Simulation`.
    """

    def __init__(self, model: Model, h: float, scheme: Scheme | None = None, output_every: int = 1,
                 tolerance: Tolerance | None = None, start: Result | None = None,
                 threads: int = 1):
        self.model = inputs.instance(model, "model", Model, "give a sebody.Model")
        self.h = inputs.number(h, "the time step", above=0)
        if scheme is not None:
            checked(scheme)
        tolerance = given(tolerance)
        self.system, self.numbering = build(whole(model))
        self.scheme = fitting(scheme, bool(self.numbering.multipliers), tolerance is not None,
                              bool(model.ways()))
        self._how = self.h, self.scheme, output_every, tolerance
        self._threads = threads
        self._locked: dict[str, Joint] = {}
        self._broken: set[str] = set()      # what let go at a threshold
        self._acting = acting(model, 0.0)
        self.events: list[Event] = []
        self.reached: list[list[Reached]] = []
        self.phases = [Phase(phase_of(model, self._acting, {}), *self._how, start, threads)]

    def __repr__(self) -> str:
        return (f"<{type(self).__name__} of a {summary(self.model)}: step {self.h:.6g}, "
                f"t = {self.time:.6g}, events: {len(self.events)}>")

    @property
    def time(self) -> float:
        """Time reached."""
        return self.phases[-1].time

    def run_to(self, t_end: float, progress: Callable[[float], None] | bool | None = None
               ) -> PhasedSimulation:
        """Advance to the grid step nearest to `t_end`, through all that lets go and locks before.

        Raises
        ------
        InputError, SimulationError, Interrupted
            As of `Simulation.run_to`; what was computed is in the error's `result`. A part that
            locks does not fit the pose at that time.
        """
        with showing(progress, t_end) as show:
            try:
                self._run_to(t_end, show)
            except (SimulationError, Interrupted) as error:
                result = self.result()
                result.failure = str(error)
                raise type(error)(result.failure, result) from error
        return self

    def _run_to(self, t_end: float, progress: Callable[[float], None] | None) -> None:
        last = self.phases[-1].last_step(t_end)
        end = last * self.h
        while (phase := self.phases[-1]).state.control.grid < last:
            t = self._next_switch()
            of_all = min(t / end, 1.0)
            share = None if progress is None else (
                lambda part, of_all=of_all: progress(part * of_all))
            thresholds = thresholds_of(self.model, self._acting, phase.read_now)
            reached = phase.run_until(end, t, share, thresholds)
            if reached or phase.time > t - NEAR * self.h:
                self.change([(one.name, one.did) for one in reached])

    def _next_switch(self) -> float:
        """The next time at which something lets go or locks that has not broken before."""
        near = NEAR * self.h
        begun = self.events[-1].time if self.events else 0.0
        return min((t for t in switch_times(self.model) if t > begun + near and
                    self._acts_at(t + near) != self._acting), default=math.inf)

    def _acts_at(self, t: float) -> set[str]:
        return acting(self.model, t) - self._broken

    def change(self, reached: Sequence[Reached]) -> None:
        """Begin the next phase, with what acts from the time reached on.

        Parameters
        ----------
        reached : sequence of tuple
            What lets go for good, and which of `thresholds.DID` it did.

        Raises
        ------
        SimulationError
                A joint does not fit the pose.
        """
        before = self.phases[-1]
        for_good = {name for name, _ in reached}
        acts = self._acts_at(before.time + NEAR * self.h) - for_good
        gone, come = self._acting - acts, acts - self._acting
        broke = {name for name, did in reached if did == BROKE}
        now = before.now()
        locked = self._locked | {joint.name: locked_as_now(joint, now)
                                 for joint in self.model.joints if joint.name in come}
        words = [f"{', '.join(sorted(names))} {did}" for names, did in (
            (broke, BROKE), (gone - broke, LET_GO), (come, "locked")) if names]
        try:
            phase = Phase(phase_of(self.model, acts, locked), *self._how, None, self._threads,
                          before)
        except InputError as error:
            raise SimulationError(f"{' and '.join(words)} at t = {before.time:.6g}, but {error}",
                                  before.result()) from error
        lost = before.energy() - phase.energy()
        self.events.append(Event(float(before.time), ", ".join(words), lost))
        self.reached.append(list(reached))
        self.phases.append(phase)
        self._acting, self._locked = acts, locked
        self._broken |= for_good

    def switches_now(self) -> bool:
        """Tell whether the time reached is one at which something lets go or locks."""
        return self._acts_at(self.time + NEAR * self.h) != self._acting

    def waiting(self) -> set[str]:
        """Names of what acts and has times or limits at which it does not any more."""
        return set(self._acting)

    def set_input(self, name: str, value: float) -> None:
        """Set the input of an actuator, see `Simulation.set_input`."""
        self.phases[-1].set_input(name, value)

    def read(self, name: str) -> float | NDArray:
        """A quantity in the state reached, see `Simulation.read`.

        Of what does not act it is zero, as in results; its work is that which it has done.
        """
        owner = name.rpartition(".")[0]
        idle = self.model.switches.keys() - self._acting
        if not any(owner == one or owner.startswith(f"{one}.") for one in idle):
            return self.phases[-1].read(name)
        value = self.result()[name][-1]
        if name.endswith(".work"):      # that of all phases, not only up to the last row
            works = [(phase.numbering.port_names, phase.state.works) for phase in self.phases]
            return float(sum(done[ports.index(owner)] for ports, done in works if owner in ports))
        return np.zeros_like(value) if np.ndim(value) else 0.0

    def result(self) -> Result:
        """The results computed so far, in the numbering of the whole model."""
        return merged(self.model, self.system, self.numbering,
                      [phase.result() for phase in self.phases], self.events, self.h)
