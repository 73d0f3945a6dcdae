"""Predictions in lanes: members count their own steps, and choose for themselves.

Members that were alone for a while have made more steps than those of the grid. The ring of changes
is the same for all: it goes on with the grid.
"""

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import rounded_up, some, spread, where
from sebody.engine import prediction
from sebody.engine.prediction import (
    AGE,
    ON,
    PERIOD,
    REFITTED,
    ROWS,
    SETTLING,
    SUM,
    TRIED_AGAIN,
    WITH,
    WITHOUT,
    WORTH,
)


@in_lanes_of(prediction.ring_place)
def ring_place(steps, grid):
    """See `prediction.ring_place`."""
    return grid + ROWS


@compiled
def _rest(x, of):
    """Whole numbers modulo another one."""
    return x + of * rounded_up(-x / of)


@in_lanes_of(prediction.refitted)
def refitted(on, steps):
    """See `prediction.refitted`."""
    return where(_rest(steps, float(REFITTED)) == 0.0, on, spread(0.0))


@in_lanes_of(prediction.compare_periods)
def compare_periods(fit, corrections, steps):
    """See `prediction.compare_periods`."""
    within, zero, one = _rest(steps, float(PERIOD)), spread(0.0), spread(1.0)
    begins = within == 0.0
    fit[SUM] += where(within > float(SETTLING), corrections, zero)
    if not some(begins):
        return
    mean, on = fit[SUM] / (PERIOD - SETTLING), fit[ON] > 0.0
    fit[WITH] = where(begins & on, mean, fit[WITH])
    fit[WITHOUT] = where(begins & ~on, mean, fit[WITHOUT])
    better, period = where(fit[WITH] + WORTH < fit[WITHOUT], one, zero), steps / PERIOD
    again = _rest(period, float(TRIED_AGAIN)) == 0.0
    early = where(period < 2.0, zero, one)
    better = where(period < 3.0, early, where(again, one - better, better))
    fit[AGE] = where(begins, fit[AGE] * better, fit[AGE])
    fit[ON] = where(begins, better, fit[ON])
    fit[SUM] = where(begins, zero, fit[SUM])
