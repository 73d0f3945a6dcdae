"""Features of time functions that steps miss: peaks between steps, jumps that are not declared."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.close_rows import Grid, close_corners, stretches
from sebody.model.histories import of_columns
from sebody.model.numbering import Numbering
from sebody.model.time_functions import TimeFunction

MANY, SHARE = 20, 0.1   # steps, and share of all steps, that close rows may divide unsaid
MISSED = 0.2            # share of the largest value by which a peak may exceed what steps see
ON_GRID = 1e-6          # of a step: nearer times are those of the step
SAMPLES = 200           # times at which a function is looked at for jumps
SUSPECTS = 10           # largest changes from one to the next that are looked into
HALVINGS = 40           # of the time between: to rounding
ABRUPT = 0.1            # share of the change that is left of a jump, and no more of what is steep


def unseen(numbering: Numbering, h: float, begin: float, end: float) -> Iterator[tuple[str, str]]:
    """Loads and drives with a peak that fixed steps miss, and a warning for each.

    Known are the rows of tables, and the corners of a function with the times between them.

    Parameters
    ----------
    h : float
        Step [time].
    begin, end : float
        Of the run [time].
    """
    for name, time_function in zip(numbering.port_names, numbering.time_functions, strict=True):
        times = _known(time_function, h)
        yield from _missed([name], time_function.values, times[(times > begin) & (times < end)], h)
    for load in numbering.series:
        assert load.series is not None
        series = load.series
        times = _known(of_columns(series)[0], h)
        names = [f"column {column} of {load.name}" for column in series.names]
        yield from _missed(names, series.at, times[(times > begin) & (times < end)], h)


def _missed(names: Sequence[str], course: Callable[[NDArray], NDArray], times: NDArray, h: float
            ) -> Iterator[tuple[str, str]]:
    """Those of some functions, (times,) or (times, names), that have a peak which steps miss."""
    if not times.size:
        return
    steps = times / h
    off_grid = np.abs(steps - np.round(steps)) >= ON_GRID
    if not off_grid.any():
        return
    before = np.floor(steps + ON_GRID) * h
    seen, values = np.sort([course(before), course(before + h)], axis=0), course(times)
    excess = np.maximum(values - seen[1], seen[0] - values)
    missed = (excess > MISSED * np.abs(values).max(axis=0)).reshape(len(times), -1)
    missed &= off_grid[:, None]
    for column in np.flatnonzero(missed.any(axis=0)).tolist():
        k, name = np.argmax(missed[:, column]), names[column]
        value, low, high = (one.reshape(len(times), -1)[k, column] for one in (values, *seen))
        yield name, (f"{name} is {value:.4g} at t = {times[k]:.6g}, between two steps of "
                     f"{h:g}, at which it is {low:.4g} and {high:.4g}: choose "
                     "steps that meet or resolve the peak, or variable steps with a tolerance")


def divided(numbering: Numbering, h: float, begin: float, end: float
            ) -> Iterator[tuple[str, str]]:
    """Loads whose close rows divide many fixed steps, and a warning for each.

    Parameters
    ----------
    h : float
        Step [time].
    begin, end : float
        Of the run [time].
    """
    for port in np.flatnonzero(numbering.forced):
        time_function = numbering.time_functions[port]
        if time_function.functions or time_function.is_time:
            continue
        found = stretches(time_function, Grid(h, fixed=True))
        count = 0 if found is None else int(((found.times[:, 2] > begin)
                                             & (found.begins < end)).sum())
        if count > max(MANY, SHARE * (end - begin) / h):
            name = numbering.port_names[port]
            yield name, (f"rows of the table of {name} are closer than the step of {h:g} in "
                         f"{count} steps: so that nothing of it is lost, each of them is divided "
                         "into as many as four, which takes longer; take steps as long as rows "
                         "are apart, or a table with rows as far apart as the steps")


def untold(numbering: Numbering, h: float, begin: float, end: float) -> Iterator[tuple[str, str]]:
    """Functions of time that jump where no corner says so, and a warning for each.

    Parameters
    ----------
    h : float
        Step [time].
    begin, end : float
        Of the run [time].
    """
    times = np.linspace(begin, end, min(SAMPLES, max(2, round((end - begin) / h) + 1)))
    for name, time_function in zip(numbering.port_names, numbering.time_functions, strict=True):
        if time_function.functions and not time_function.corners:
            jumps = _jump(time_function.functions[-1].ctypes, times)
            if jumps:
                yield name, (f"the function of {name} jumps from {jumps[1]:.4g} to {jumps[2]:.4g} "
                             f"at t = {jumps[0]:.9g}, which is not declared: give it as "
                             "with_corners(function, times), so that steps end at its jumps; "
                             "otherwise errors fall in proportion to the step only, not to "
                             "its square")


def _jump(function: Callable[[float], float],
          times: NDArray) -> tuple[float, float, float] | None:
    """The first time at which a function jumps, and the values before and after it."""
    values = np.array([function(t) for t in times])
    changes = np.abs(np.diff(values))
    for k in sorted(np.argsort(changes)[::-1][:SUSPECTS]):
        a, b, before, after = times[k], times[k + 1], values[k], values[k + 1]
        if not changes[k] > 0.0:
            continue
        for _ in range(HALVINGS):
            t = (a + b) / 2
            value = function(t)
            if abs(value - before) > abs(after - value):
                b, after = t, value
            else:
                a, before = t, value
        if abs(after - before) > ABRUPT * changes[k]:
            return b, before, after
    return None


def _known(time_function: TimeFunction, h: float) -> NDArray:
    """Times at which a time function may have a peak that steps miss: none of close rows."""
    if not time_function.functions:
        return np.setdiff1d(time_function.times, close_corners(time_function, Grid(h, fixed=True)))
    corners = np.array(time_function.corners)
    return np.concatenate([corners, (corners[1:] + corners[:-1]) / 2])
