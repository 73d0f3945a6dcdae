"""A run in segments whose steps fit into some memory, each of which can be had again.

A run whose states fit is kept as it is: it has one segment. Of longer ones the state at the begin
of every segment is kept, and the steps from there on are computed again when they are asked for:
the same to the last digit, as a state has all that the loop reads, and factors with row exchanges
are made again from its matrix.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import memory
from sebody.basics.errors import SimulationError
from sebody.gradients.history import History, Past, copy_of, meet, put_back, stretch
from sebody.runs.simulation import Simulation

STATES = 8e6        # bytes of states that are kept at a time: a gradient takes five times that
NUMBERS = 64.0      # bytes of an event that are kept of the whole run: its times, kind, ...


class Begin(NamedTuple):
    """Beginning of a segment."""

    state: list[NDArray]    # copies of the run's
    most: int | None        # events of the segment; None: to the end of the run
    recorded: int           # states before


class Segments:
    """A run from its start, in segments.

    Parameters
    ----------
    run : Simulation
        At its start.
    t_end : float
    met : sequence of float
        Times at which variable steps end, beside `t_end`.

    Attributes
    ----------
    seconds : float
        Of the run, where it is run for the first time.
    """

    def __init__(self, run: Simulation, t_end: float, met: Sequence[float] = ()):
        self.run, self.last = run, round(t_end / run.h)
        memory.check(NUMBERS * self.last, f"times of {self.last} steps",
                     "give an earlier t_end or longer steps")
        meet(run, [*met, t_end])
        most = max(int(STATES / run.state.now.nbytes), 2)
        self._restart(Begin(copy_of(run.state), most, 0))

    def _restart(self, start: Begin) -> None:
        self.begins, self.seconds = [start], 0.0
        self._numbers: list[tuple[NDArray, NDArray, NDArray]] = []      # of all events
        self._kept: History | None = None

    def join(self) -> None:
        """Make the run one segment, however many states it has; it is to be run through again."""
        self._restart(self.begins[0]._replace(most=None))

    def __len__(self) -> int:
        return len(self._numbers)

    def run_through(self) -> Iterator[History]:
        """Run for the first time, and give every segment.

        Raises
        ------
        SimulationError
            A step failed; what was computed from the start on is in the error's `result`.
        """
        while len(self) < len(self.begins):
            one = self._first(len(self))
            self.seconds += one.seconds
            own = int(one.past is not None)
            self._numbers.append((one.kinds[own:].copy(), one.ends[own:].copy(),
                                  one.besides[own:].copy()))
            if self.run.state.control.grid < self.last:
                begin = self.begins[-1]
                self.begins.append(begin._replace(
                    state=copy_of(self.run.state), recorded=begin.recorded + len(one.recorded)))
            else:
                self._kept = one
            yield one

    def _first(self, k: int) -> History:
        """A segment that was not run before."""
        try:
            return self.at(k)
        except SimulationError:
            if k > 0:       # once more, to keep all states that there are
                self.join()
                self.at(0)
            raise

    def back(self) -> Iterator[History]:
        """All segments, the last one first."""
        for k in range(len(self) - 1, -1, -1):
            yield self.at(k)
            self._kept = None

    def forth(self) -> Iterator[History]:
        """All segments, the first one first."""
        for k in range(len(self)):
            if k < len(self) - 1:
                self._kept = None
            yield self.at(k)

    def at(self, k: int) -> History:
        """Segment k."""
        if self._kept is not None and k == len(self) - 1:
            return self._kept
        begin = self.begins[k]
        put_back(self.run.state, begin.state)
        self.run.aid.forget()
        found = stretch(self.run, self.last, begin.most)
        if k == 0:
            return found
        kinds, ends, besides = (np.concatenate(of) for of in zip(*self._numbers[:k], strict=True))
        return found._replace(past=Past(kinds, ends, besides, begin.recorded))
