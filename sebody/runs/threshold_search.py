"""The instant at which a step passes a threshold: the step is taken again, shorter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from sebody.engine.scalars import numbers_of
from sebody.engine.state import ASKED, CHUNK, DONE, FAILED, Record, State
from sebody.engine.step_control import NEAR
from sebody.runs.aid import advance
from sebody.runs.simulation import Simulation
from sebody.runs.thresholds import Threshold

TOGETHER = 1e-9     # of a limit: what is as near to it breaks at the same time
PRECISE = 1e-12     # of a step, to which the instant is found


class Search:
    """Steps of a phase one by one, and the instant in the last one at which something lets go.

    In the state at an instant, accelerations and multipliers are solved for anew, as at a jump: so
    a force is a function of positions and velocities alone, and not of the length of the step.

    Parameters
    ----------
    run : Simulation
    last : int
        Step of the grid that the run does not pass.
    end : float
        Time at which a step ends if nothing lets go before, infinite without one.
    end_at : callable
        Lets a step end at a time.
    """

    def __init__(self, run: Simulation, record: Record, last: int, end: float,
                 end_at: Callable[[float], None], thresholds: Sequence[Threshold]):
        self.run, self.record, self.last, self.end = run, record, last, end
        self.thresholds, self.end_at = thresholds, end_at
        self._kept = [(own, own.copy()) for own in _arrays(run.state)] if thresholds else []
        self._start, self._whole = run.time, True

    def step(self) -> int:
        """Take one step; the code of the loop."""
        return advance(self.run, self.record, self.last, 1)

    def keep(self) -> None:
        """Remember the state reached."""
        self._whole = False
        for own, kept in self._kept:
            np.copyto(kept, own)
        self._start, self._whole = self.run.time, True

    def back(self) -> None:
        """Return to the state that was remembered, unless that was interrupted."""
        if self._whole:
            for own, kept in self._kept:
                np.copyto(own, kept)
            self.run.aid.forget()

    def reached(self) -> list[Threshold]:
        """Thresholds that are passed in the state reached."""
        return [one for one in self.thresholds if one.excess() > 0.0]

    def found(self) -> list[Threshold]:
        """Thresholds that are passed first in the last step; the run is at that instant then."""
        if not self.reached():
            return []
        from scipy.optimize import brentq  # takes 0.1 s to load

        t, h = self.run.time, self.run.h
        if self._beyond(t) <= 0.0:      # the step alone has it so
            self.end_at(self.end)
            return []
        if self._beyond(self._start) <= 0.0:
            t = brentq(self._beyond, self._start, t, xtol=PRECISE * h, rtol=1e-15)
        else:
            t = self._start
        excess = self._beyond(t)
        return [one for one in self.thresholds
                if one.excess() >= min(excess, 0.0) - TOGETHER]

    def _beyond(self, t: float) -> float:
        """Largest excess at a time in the last step, at which the run is then."""
        run = self.run
        self.back()
        if t - self._start > NEAR * run.h:
            self.end_at(t)
            code = CHUNK
            while run.time < t - NEAR * min(run.h, t - self._start) and code not in (DONE, FAILED):
                code = self.step()
        run.state.control.restart = ASKED
        self.solve()
        return max(one.excess() for one in self.thresholds)

    def solve(self) -> None:
        """Solve for the accelerations and multipliers of the state reached."""
        advance(self.run, self.record, self.last, 0)


def _arrays(state: State) -> list[NDArray]:
    """All arrays of a state, scalars as arrays that share their memory."""
    values = [getattr(state, field.name) for field in fields(State)]
    return [numbers_of(value) if isinstance(value, np.record) else value for value in values]
