"""Runs of the reference model, and how good the finest of them is.

The reference model runs with the given step, a half and a quarter of it, and with shorter ones
where the tolerance needs them. Errors of second order fall by four each time; where they do, a
third of the last difference is taken off the finest run, and a sixteenth of the difference that
this makes one run earlier is the reference's own error. Where large ones do not fall, the motion
may be chaotic.
"""

from typing import NamedTuple

import numpy as np

from sebody.explore.advice.quantities import Values, Worst, compared, difference, sizes_of

REGULAR = 2.8, 5.7          # differences that fall by four, within a factor of the root of two
LEAST = 2.0                 # factor by which they are taken to fall at least, as at jumps
CHAOTIC = 0.05, 1.3         # differences above the first that do not fall by the second
ORDER_FACTOR = 4.0          # of errors of second order by halving the step
LEFT = 1.0 / 16.0           # of the change of an extrapolated value, by halving the step


class Reference(NamedTuple):
    """Reference that runs are compared with.

    Parameters
    ----------
    values : Values
        Best known quantities, on the grid of the given step.
    sizes : list of float
        Largest changes of the histories.
    error : float
        Estimated relative error of the values.
    step_error : float
        Of the reference model with the shortest step.
    falls : bool
        Whether the error falls with the step.
    worst : Worst
        Where the last two runs differ most.
    """

    values: Values
    sizes: list[float]
    error: float
    step_error: float
    falls: bool
    worst: Worst


def reference(runs: list[Values], common: bool = False) -> Reference:
    """The reference from runs with steps halved each time, recorded on one grid; two or more.

    Parameters
    ----------
    common : bool
        Whether all errors are relative to the largest size, as absolute tolerances are.
    """
    runs = runs[-3:]
    finest = runs[-1]
    sizes = sizes_of(finest)
    if common:
        sizes = [max(sizes)] * len(sizes)
    worst = compared(*runs[-2:], sizes, (1, 1))
    steps = [difference(a, b, sizes, (1, 1)) for a, b in zip(runs, runs[1:], strict=False)]
    own = steps[-1] / (ORDER_FACTOR - 1.0)
    if len(steps) < 2 or steps[-1] == 0.0:
        return Reference(finest, sizes, own, own, True, worst)
    ratio = steps[0] / steps[1]
    if not REGULAR[0] < ratio < REGULAR[1]:
        own = steps[1] / (min(max(ratio, LEAST), ORDER_FACTOR) - 1.0)
        return Reference(finest, sizes, own, own, steps[1] < CHAOTIC[0] or ratio > CHAOTIC[1],
                         worst)
    better = [_extrapolated(a, b) for a, b in zip(runs, runs[1:], strict=False)]
    left = LEFT * difference(better[0], better[1], sizes, (1, 1))
    return Reference(better[1], sizes, min(left, own), own, True, worst)


def _extrapolated(coarse: Values, fine: Values) -> Values:
    """Histories without their errors of second order; frequencies do not depend on the step."""
    return Values([b + (b - a) / (ORDER_FACTOR - 1.0)
                   for a, b in zip(coarse.histories, fine.histories, strict=True)],
                  fine.frequencies, fine.measures)


def still(values: Values) -> list[int]:
    """Histories that do not change, by their places."""
    return [k for k, one in enumerate(values.histories) if not np.ptp(one, axis=0).any()]
