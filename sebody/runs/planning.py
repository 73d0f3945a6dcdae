"""Steps planned for a whole run, from the errors that a coarser run over the same time has shown.

The scheme keeps an energy of its own, ``H + h^2 H2`` with a function H2 of the state, as long as
its steps are equal. A change of the step from h to h' leaves ``(h^2 - h'^2) H2`` for good, and
changes that come at the same phase of every swing add up. So a plan has one length wherever that
costs little, and few lengths elsewhere. All runs of a plan divide the same lengths, so their errors
fall regularly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.engine.state import State
from sebody.engine.step_control import AIM

LOGGED = 256            # steps between two looks at the log
NEAR = 15               # steps before and after one, in which the longest is no start of a growth
LONGER = 1.26           # factor by which a planned step may exceed that one
GRADED = 0.25           # change of the planned length with time
CONSTANT = 2.0          # factor of the number of steps that one length may cost
WIDE = 1.3              # the same of a minimum over a window
LEVEL = 2.0**0.5        # between two lengths
BISECTIONS = 14         # of the width of the window
MOST_STRETCHES = 50     # corners of loads between which steps are planned by themselves


class Plan(NamedTuple):
    """A choice of steps within a tolerance.

    By default errors choose them one by one.
    """

    schedule: NDArray = np.zeros((0, 2))    # (k, 2) end [time] and length of steps [time]
    finer: float = 1.0      # by which these are divided
    allowed: float = 1.0    # error of a step over its tolerance above which it is repeated
    logged: int = 0         # steps that are logged between two looks
    seconds: float = 0.0    # in the loop that the run took which the plan is from
    stiff: bool = False     # bristles and teeth are stiff for these steps, not by the output grid

    @property
    def steps(self) -> NDArray:
        """The schedule, divided."""
        return self.schedule / (1.0, self.finer)


    @property
    def usual(self) -> float:
        """Median length of the steps."""
        ends, lengths = self.steps.T
        counts, order = np.diff(ends, prepend=0.0) / lengths, np.argsort(lengths)
        half = np.searchsorted(np.cumsum(counts[order]), 0.5 * counts.sum())
        return float(lengths[order][half])


class StepLog:
    """End, length and error over length^3 of all accepted steps of a run."""

    def __init__(self) -> None:
        self._rows: list[NDArray] = []
        self._taken = 0

    def take(self, state: State) -> None:
        """Copy what has been logged since the last look."""
        log, done = state.step_log, int(state.control.steps)
        if done > self._taken:
            self._rows.append(log[np.arange(self._taken, done) % len(log)])
            self._taken = done

    def rows(self) -> NDArray:
        """(steps, 3) all of them."""
        return np.concatenate([np.zeros((0, 3)), *self._rows])


def planned(log: NDArray, corners: NDArray, finer: float = 1.0) -> NDArray:
    """A schedule of steps for the time of a run.

    Parameters
    ----------
    log : (n, 3) ndarray
        Of a `StepLog`.
    corners : ndarray
        Times at which loads have corners: between these, stretches are planned by themselves.
    finer : float
        Factor by which the tolerance of a step is finer than that of the run.

    Returns
    -------
    (k, 2) ndarray
        End of each piece, and length of the steps in it and, in the last one, after it; none
        without a step in the log.
    """
    if not len(log):
        return np.zeros((0, 2))
    ends = log[:, 0]
    inside = corners[(corners > 0.0) & (corners < ends[-1])]
    edges = np.concatenate([[0.0], inside if len(inside) < MOST_STRETCHES else [], ends[-1:]])
    pieces = []
    for begin, end in zip(edges, edges[1:], strict=False):
        rows = log[(ends > begin * (1.0 + 1e-9)) & (ends <= end * (1.0 + 1e-9))]
        if len(rows):
            piece = _planned_stretch(rows, begin, finer)
            piece[-1, 0] = end
            pieces.append(piece)
    return np.concatenate(pieces)


def _planned_stretch(rows: NDArray, begin: float, finer: float) -> NDArray:
    """The schedule of a stretch without corners."""
    from scipy.ndimage import maximum_filter1d  # here: runs with fixed steps start faster

    ends, lengths, rates = rows.T
    starts = np.concatenate([[begin], ends[:-1]])
    times = np.maximum(ends - starts, 0.0)
    shorter = finer**(-1.0 / 3.0)
    wanted = shorter * (AIM / np.maximum(rates, 1e-300))**(1.0 / 3.0)
    # the first steps after an event are short because nothing was known of them
    longest = maximum_filter1d(lengths, 2 * NEAR + 1, mode="nearest")
    wanted = _graded(np.minimum(wanted, LONGER * shorter * longest), ends)
    least, most = wanted.min(), (times / wanted).sum()
    if times.sum() / least <= CONSTANT * most:
        return np.array([[ends[-1], least]])
    window = _window(wanted, starts, ends, lambda steps: (times / steps).sum() <= WIDE * most)
    steps = least * LEVEL**np.floor(np.log(window / least) / np.log(LEVEL) + 1e-9)
    last = np.append(np.flatnonzero(np.diff(steps)), len(steps) - 1)
    return np.stack([ends[last], steps[last]], axis=1)


def _graded(wanted: NDArray, ends: NDArray) -> NDArray:
    """Lengths that change slowly with time, so that one short step does not rule its neighbours."""
    along = GRADED * (ends - ends[0])
    forward = along + np.minimum.accumulate(wanted - along)
    return np.minimum.accumulate((forward + along)[::-1])[::-1] - along


def _window(wanted: NDArray, starts: NDArray, ends: NDArray,
            cheap: Callable[[NDArray], bool]) -> NDArray:
    """Least length within the widest window about each time that is cheap enough."""
    tables = _minima(wanted)

    def least(width: float) -> NDArray:
        first = np.searchsorted(ends, starts - width, side="right")
        last = np.maximum(np.searchsorted(starts, ends + width), first + 1)
        level = np.log2(last - first).astype(int)
        found = np.empty(len(wanted))
        for k in np.unique(level):
            one = level == k
            found[one] = np.minimum(tables[k][first[one]], tables[k][last[one] - 2**k])
        return found

    low, high, best = 0.0, ends[-1] - starts[0], wanted
    for _ in range(BISECTIONS):
        middle = (low + high) / 2.0
        if cheap(found := least(middle)):
            low, best = middle, found
        else:
            high = middle
    return best


def _minima(numbers: NDArray) -> list[NDArray]:
    """Least of 1, 2, 4, ... numbers from each one on."""
    tables, width = [numbers], 1
    while 2 * width <= len(numbers):
        tables.append(np.minimum(tables[-1][:-width], tables[-1][width:]))
        width *= 2
    return tables
