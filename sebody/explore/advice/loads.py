"""Loads and drives compared with the step: what steps of a length miss.

Between its steps a run does not evaluate a load. It integrates at best the load's linear
interpolation, so the spectrum of the difference of the two, relative to the strongest line of the
load itself, says what share of the load steps of a length miss: all of a pulse that is shorter
than they are, or of a ripple with a whole number of periods in each.
Steps miss nothing of tables whose rows are closer than they are; see `assembly/close_rows.py`.
"""

from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.close_rows import Grid, close_corners
from sebody.model.time_functions import TimeFunction

SEEN = 0.01             # share of a load's strongest line that reference steps may miss
OFF_GRID = 0.9137       # samples of a load are so much denser, so that they are on no step's grid
DENSE = 32              # samples in a step
MOST = 2**17            # samples of a load
SIDE = 1e-9             # of a sample: a value just before a corner


class Missed(NamedTuple):
    """Share of a load or drive that steps miss: its name, the share, and where most is missed."""

    name: str
    share: float
    time: float


def missed(names: Iterable[str], time_functions: Iterable[TimeFunction], h: float,
           t_end: float) -> Missed:
    """The load or drive of which steps of a length miss most.

    Parameters
    ----------
    h, t_end : float
        Step and end of a run [time].
    """
    shares = [Missed(name, *_share(time_function, h, t_end))
              for name, time_function in zip(names, time_functions, strict=True)
              if not _is_constant(time_function)]
    return max(shares, key=lambda one: one.share, default=Missed("", 0.0, 0.0))


def _is_constant(time_function: TimeFunction) -> bool:
    return not time_function.functions and not time_function.waves and not any(
        any(piece[1:]) for piece in time_function.pieces) and len(time_function.pieces) == 1


@lru_cache(maxsize=512)
def _share(time_function: TimeFunction, h: float, t_end: float) -> tuple[float, float]:
    """The share of a time function that steps miss, and the time where they miss most."""
    times, values = _sampled(time_function, h, t_end)
    steps = np.union1d(np.arange(0.0, t_end + h, h),
                       close_corners(time_function, Grid(h, fixed=True)))    # steps end there, too
    off = values - np.interp(times, steps, time_function.values(steps))
    cells = np.linspace(0.0, t_end, min(MOST, int(DENSE * OFF_GRID * t_end / h) + 2))
    load, lost = (np.abs(np.fft.rfft(_means(times, one, cells))) for one in (values, off))
    if load.max() == 0.0:
        return 0.0, 0.0
    return float(lost.max() / load.max()), float(times[np.argmax(np.abs(off))])


def _sampled(time_function: TimeFunction, h: float, t_end: float) -> tuple[NDArray, NDArray]:
    """Values on no step's grid, and on both sides of all times where it bends or jumps."""
    count = min(MOST, int(DENSE * OFF_GRID * t_end / h) + 2)
    known = np.array(time_function.corners if time_function.functions else time_function.times,
                     dtype=float)
    known = known[(known > 0.0) & (known < t_end)]
    middles = (known[1:] + known[:-1]) / 2
    before = known - SIDE * t_end / count
    times = np.unique(np.concatenate([np.linspace(0.0, t_end, count), known, before, middles]))
    return times, time_function.values(times)


def _means(times: NDArray, values: NDArray, cells: NDArray) -> NDArray:
    """Means of a time function over cells, by trapezia."""
    whole = np.concatenate([[0.0], np.cumsum(np.diff(times) * (values[1:] + values[:-1]) / 2)])
    return np.diff(np.interp(cells, times, whole)) / np.diff(cells)
