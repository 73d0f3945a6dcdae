"""Peaks of load histories that fall between the steps of a run, so that no step sees them."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering
from sebody.model.histories import History

MISSED = 0.2            # share of the largest value by which a peak may exceed what steps see
ON_GRID = 1e-6          # of a step: nearer times are those of the step


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
    for name, history in zip(numbering.port_names, numbering.histories, strict=True):
        times = _known(history)
        times = times[(times > begin) & (times < end)]
        if not times.size:
            continue
        steps = times / h
        before = np.floor(steps + ON_GRID) * h
        seen = np.sort([history.values(before), history.values(before + h)], axis=0)
        values = history.values(times)
        excess = np.maximum(values - seen[1], seen[0] - values)
        on_grid = np.abs(steps - np.round(steps)) < ON_GRID
        missed = np.flatnonzero(~on_grid & (excess > MISSED * np.abs(values).max()))
        if missed.size:
            k = missed[0]
            yield name, (f"{name} is {values[k]:.4g} at t = {times[k]:.6g}, between two steps of "
                         f"{h:g} that see {seen[0, k]:.4g} and {seen[1, k]:.4g}: take steps that "
                         "meet or resolve the peak, or variable ones with a tolerance")


def _known(history: History) -> NDArray:
    """Times at which a history may have a peak."""
    if not history.functions:
        return np.array(history.times)
    corners = np.array(history.corners)
    return np.concatenate([corners, (corners[1:] + corners[:-1]) / 2])
