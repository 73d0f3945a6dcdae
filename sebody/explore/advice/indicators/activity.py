"""Motions that are smooth except for short times, where variable steps pay."""

import numpy as np

from sebody.results.result import Result

QUIET = 1e-3        # of the largest rate: slower ones need no shorter steps


def activity(result: Result) -> float:
    """Steps that variable ones would take, relative to fixed ones of the shortest length.

    Errors of a step grow as the third power of its length times the rate j of the accelerations,
    in units of each coordinate's size, so steps of equal errors are as ``j^(-1/3)``: the mean of
    ``j^(1/3)`` over its largest value. Jumps of the accelerations count once, not at all times.
    """
    size = np.where(result.system.magnitude > 0.0, result.system.magnitude, np.inf)
    rates = np.abs(np.diff(result.recorded("a")[:, :len(size)], axis=0) / size[:len(size)])
    largest = rates.max(axis=1)
    if not largest.any():
        return 1.0
    lengths = np.maximum(largest / largest.max(), QUIET)**(1.0 / 3.0)
    return float(lengths.mean())
