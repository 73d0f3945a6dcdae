"""Peaks of load histories that fall between the steps of a run, so that no step sees them."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering
from sebody.engine.evaluate import set_loads
from sebody.engine.system import System
from sebody.model.histories import History

MISSED = 0.2            # share of the largest value by which a peak may exceed what steps see
ON_GRID = 1e-6          # of a step: nearer times are those of the step


def unseen(system: System, numbering: Numbering, h: float, begin: float,
           end: float) -> Iterator[tuple[str, str]]:
    """Loads and drives with a peak that fixed steps miss, and a warning for each.

    Known are the times of tables, and the corners of a function with the times between them.

    Parameters
    ----------
    h : float
        Step [time].
    begin, end : float
        Of the run [time].
    """
    for port, (name, history) in enumerate(zip(numbering.port_names, numbering.histories,
                                               strict=True)):
        times = _known(history)
        times = times[(times > begin) & (times < end)]
        steps = times / h
        times = times[np.abs(steps - np.round(steps)) > ON_GRID]
        if not times.size:
            continue
        before = np.floor(times / h) * h
        values, first, second = (_values(system, numbering, port, t)
                                 for t in (times, before, before + h))
        low, high = np.minimum(first, second), np.maximum(first, second)
        missed = np.maximum(values - high, low - values) > MISSED * np.abs(values).max()
        if missed.any():
            k = int(np.argmax(missed))
            yield name, (f"{name} is {values[k]:.4g} at t = {times[k]:.6g}, between two steps of "
                         f"{h:g} that see {first[k]:.4g} and {second[k]:.4g}: take steps that "
                         "meet or resolve the peak, or variable ones with a tolerance")


def _known(history: History) -> NDArray:
    """Times at which a history may have a peak."""
    if not history.functions:
        return np.array(history.times)
    corners = np.array(history.corners)
    return np.concatenate([corners, (corners[1:] + corners[:-1]) / 2])


def _values(system: System, numbering: Numbering, port: int, times: NDArray) -> NDArray:
    """Values of a history."""
    loads, found = np.zeros(3 * len(numbering.histories)), np.zeros(len(times))
    for k, t in enumerate(times):
        set_loads(system, loads, t)
        found[k] = loads[3 * port]
    return found
