"""Time functions of loads whose corners lie closer together than steps: their impulse is kept.

Tables often write a jump as two rows a microsecond apart, or a blow as three. Steps see a load at
their ends only. In every interval of the output grid, the stretch that close corners cover is
replaced by two constant levels of the same integral and first moment. Steps end where levels begin,
as at jumps, and integrate constants exactly: the impulse is that of the table to rounding. Levels
begin and end at fractions of the interval, so that corners of several loads make no steps that are
short by rounding. On the grid the load is that of the table.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.model.histories import LoadSeries, Pieces, of_columns, pieces_of
from sebody.model.numbering import Numbering
from sebody.model.parts import Element
from sebody.model.time_functions import TimeFunction

# parts of an output interval at which levels begin and end: longer than restarts look ahead
FIXED, CHOSEN = 2**9, 2**10
# least parts over which what is held at the grid is made up for
SPREAD_FIXED, SPREAD_CHOSEN = 64, 8
SHORT = 1e-3            # of an output interval: corners that are close for steps that are chosen
SAME = 1e-6             # of a step: times that are as near are one
ROUNDED = 1e-9          # of a part, by which rounding may put a time off
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)    # exact for polynomials of degree eleven


class Grid(NamedTuple):
    """The steps that loads are given to."""

    h: float        # output interval, the length of fixed steps [time]
    fixed: bool

    @property
    def close(self) -> float:
        """Distance below which corners are close [time]."""
        return self.h * ((1.0 - SAME) if self.fixed else SHORT)

    @property
    def parts(self) -> int:
        """Parts of an output interval."""
        return FIXED if self.fixed else CHOSEN

    @property
    def spread(self) -> int:
        """Parts that levels take at least which begin at the grid."""
        return SPREAD_FIXED if self.fixed else SPREAD_CHOSEN


class Stretches(NamedTuple):
    """Stretches of close corners, one in an output interval: constant levels in their place.

    Up to the first level a load holds the value it begins with.
    """

    begins: NDArray     # (n,) where the time function is replaced from [time]
    times: NDArray      # (n, 3) where the first and second level begin, and where the second ends

    def inside(self, t: float) -> bool:
        """Tell whether a time lies within a stretch, after its beginning and before its end."""
        k = int(np.searchsorted(self.begins, t, side="left")) - 1
        return k >= 0 and t < self.times[k, 2]


class Means(NamedTuple):
    """Levels as linear functions of the values that a time function has in its stretches."""

    times: NDArray      # (p,) beginnings of pieces, or of stretches
    later: NDArray      # (p,) how much later the values are taken
    weights: sparse.csr_array   # (2 n, p) of these values in the first and second level of each


def close_corners(time_function: TimeFunction, grid: Grid) -> NDArray:
    """Corners of a load with another one closer than a step, ascending."""
    corners = np.array(time_function.corners, dtype=float)
    if not time_function.functions and any(len(piece) > 2 for piece in time_function.pieces):
        corners = np.union1d(corners, time_function.times)      # smooth ones are missed as well
    if len(corners) < 2 or time_function.is_input:
        return corners[:0]
    close = np.diff(corners) < grid.close
    return corners[np.append(close, False) | np.append(False, close)]


def given_to_steps(numbering: Numbering, grid: Grid | None
                   ) -> tuple[list[TimeFunction], list[list[float]]]:
    """Time functions of all ports and when accelerations jump with them: with a grid for steps."""
    time_functions, jumps = list(numbering.time_functions), list(numbering.jumps)
    if grid is not None:
        for port in np.flatnonzero(numbering.forced):
            time_functions[port], jumps[port] = of_steps(time_functions[port], jumps[port], grid)
    return time_functions, jumps


def series_given_to_steps(numbering: Numbering, grid: Grid | None) -> dict[Element, Pieces]:
    """Pieces of the series of all loads, with a grid for steps; loads of one series share them.

    All columns of a series have the same rows, so the same stretches of close ones.
    """
    made: dict[LoadSeries, Pieces] = {}
    for load in numbering.series:
        assert load.series is not None
        if load.series not in made:
            made[load.series] = _pieces_of_steps(load.series, grid)
    return {load: made[load.series] for load in numbering.series if load.series is not None}


def _pieces_of_steps(series: LoadSeries, grid: Grid | None) -> Pieces:
    pieces = series.pieces
    if grid is None:
        return pieces
    columns = of_columns(series)
    if stretches(columns[0], grid) is None:
        return pieces
    given = [of_steps(one, pieces.jumps.tolist(), grid) for one in columns]
    return pieces_of([one for one, _ in given], pieces.coefficients.shape[1], given[0][1])


def of_steps(time_function: TimeFunction, jumps: Sequence[float], grid: Grid
             ) -> tuple[TimeFunction, list[float]]:
    """A load as steps are given it, and the times at which it makes accelerations jump.

    A compiled function stays as it is: steps end at its close corners.
    """
    if time_function.functions or time_function.is_time:
        corners = close_corners(time_function, grid).tolist() if grid.fixed else []
        return time_function, sorted({*jumps, *corners})
    found = stretches(time_function, grid)
    if found is None:
        return time_function, list(jumps)
    outside = [t for t in time_function.corners if not found.inside(t)]
    begun = sorted({*[t for t in jumps if not found.inside(t)], *found.times.ravel().tolist()})
    corners = tuple(sorted({*outside, *begun}))
    return replace(_replaced(time_function, found), corners=corners), begun


def stretches(time_function: TimeFunction, grid: Grid) -> Stretches | None:
    """Places of close corners of a load that is no compiled function; None if there are none."""
    covered = _covered(close_corners(time_function, grid), grid)
    if not covered:
        return None
    parts, k = grid.parts, np.array(list(covered))
    ends = (np.array(list(covered.values())) / grid.h - k[:, None]) * parts
    first = np.floor(ends[:, 0] + ROUNDED).astype(int)
    last = np.ceil(ends[:, 1] - ROUNDED).astype(int)
    on_grid = first <= 0
    first = np.where(on_grid, 1, first)
    last = np.minimum(np.maximum(last, first + np.where(on_grid, grid.spread, 1)), parts)
    middle = np.where(last - first > 1, (first + last) // 2, last)
    return Stretches(
        np.where(on_grid, k * grid.h, (k + first / parts) * grid.h),
        (k[:, None] + np.stack([first, middle, last], axis=1) / parts) * grid.h)


def _covered(corners: NDArray, grid: Grid) -> dict[int, tuple[float, float]]:
    """First and last time between close corners, by the number of the output interval."""
    found: dict[int, tuple[float, float]] = {}
    tiny = ROUNDED / grid.parts
    for begin, end in zip(corners[:-1].tolist(), corners[1:].tolist(), strict=True):
        if end - begin >= grid.close or end <= 0.0:
            continue
        begin = max(begin, 0.0)
        k = int(np.floor(begin / grid.h + tiny))
        while k * grid.h < end - tiny * grid.h:
            first, last = max(begin, k * grid.h), min(end, (k + 1) * grid.h)
            found[k] = found.get(k, (first, last))[0], last
            k += 1
    return found


def means(time_function: TimeFunction, found: Stretches) -> Means:
    """Levels of the integrals and first moments that a time function has in its stretches."""
    begins, (first, second, end) = found.begins, found.times.T
    points = np.unique(np.concatenate([begins, end, time_function.times]))
    a, b = points[:-1], points[1:]
    owner = np.searchsorted(begins, a, side="right") - 1
    kept = (owner >= 0) & (a < end[owner])
    a, b, owner = (one[kept].repeat(len(POINTS)) for one in (a, b, owner))
    later = (b - a) * np.tile(POINTS + 1.0, kept.sum()) / 2.0
    share = (b - a) * np.tile(WEIGHTS, kept.sum()) / 2.0
    moment = share * (a - second[owner] + later)
    # what is held up to the first level is no part of them
    held, every = first - begins, np.arange(len(begins))
    owner = np.append(owner, every)
    share = np.append(share, -held)
    moment = np.append(moment, held * (second - begins - held / 2.0))
    before, after = (second - first)[owner], (end - second)[owner]
    two = after > 0.0
    one = np.where(two, share * after - 2.0 * moment, share) / (before * np.where(
        two, before + after, 1.0))
    other = np.divide(share - one * before, after, out=one.copy(), where=two)
    columns = np.arange(len(owner))
    weights = sparse.csr_array((np.append(one, other), (
        np.append(2 * owner, 2 * owner + 1), np.append(columns, columns))),
        shape=(2 * len(begins), len(owner)))
    return Means(np.append(a, begins), np.append(later, 0.0 * begins), weights)


def _replaced(time_function: TimeFunction, found: Stretches) -> TimeFunction:
    """A time function with levels in place of what they stand for."""
    given = means(time_function, found)
    values = (given.weights @ time_function.after(given.times, given.later[:, None])[:, 0]
              ).reshape(-1, 2)
    none, begun = (0.0, 0.0, 0.0), set(found.begins.tolist())
    waves = time_function.waves or (none,) * len(time_function.pieces)
    rows = [row for row in zip(time_function.times, time_function.pieces, waves, strict=True)
            if row[0] not in begun and not found.inside(row[0])]
    kept = begun | {row[0] for row in rows}
    for begin, (first, second, end), (one, other), held in zip(
            found.begins.tolist(), found.times.tolist(), values.tolist(),
            time_function.values(found.begins).tolist(), strict=True):
        if begin < first:
            rows.append((begin, (held,), none))
        rows.append((first, (one,), none))
        if second < end:
            rows.append((second, (other,), none))
        if end not in kept:
            rows.append((end, *time_function.moved(end)))
    times, pieces, waves = zip(*sorted(rows, key=lambda row: row[0]), strict=True)
    return TimeFunction(times, pieces, waves if time_function.waves else ())
