"""Predictions in lanes: members count their own steps, and choose for themselves.

Members that were alone for a while have made more steps than those of the grid. The ring of changes
is the same for all: it goes on with the grid.
"""

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import rounded_up, some, spread, where
from sebody.engine import prediction
from sebody.engine.prediction import (
    AGE,
    COEFFICIENTS,
    EQUATIONS,
    FORGET,
    ON,
    ORDER,
    PERIOD,
    REFITTED,
    RIGHT,
    ROWS,
    SETTLING,
    SOLVED,
    SUM,
    TRIED_AGAIN,
    WITH,
    WITHOUT,
    WORTH,
    solve,
)
from sebody.kernels.abi import at, pointer_to


@in_lanes_of(prediction.either)
def either(condition, a, b):
    """See `prediction.either`."""
    return where(condition, a, b)


@in_lanes_of(prediction.any_positive)
def any_positive(x):
    """See `prediction.any_positive`."""
    return some(x > 0.0)


@in_lanes_of(prediction.row)
def row(state, steps):
    """See `prediction.row`: steps count relative to those of the members."""
    control = state.control
    ring = (control.grid + int(steps - control.steps)) % ROWS
    return at(pointer_to(state.changes), state.q.size * ring)


@compiled
def _rest(x, of):
    """Whole numbers modulo another one."""
    return x + of * rounded_up(-x / of)


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
    better = where(period < 2.0, period, where(again, one - better, better))
    fit[AGE] = where(begins, fit[AGE] * better, fit[AGE])
    fit[ON] = where(begins, better, fit[ON])
    fit[SUM] = where(begins, zero, fit[SUM])


@in_lanes_of(prediction.fit_anew)
def fit_anew(system, state, steps):
    """See `prediction.fit_anew`; of members that make no fit nothing changes."""
    n, fit = system.diagonal.size, pointer_to(state.fit)
    weighted, fitted = pointer_to(state.correction), pointer_to(state.fitted)
    on = fit[ON] > 0.0
    for i in range(ORDER, 0, -1):
        for j in range(ORDER, 0, -1):
            k = ROWS * i + j
            fit[k] = where(on, fit[k - ROWS - 1], fit[k])
    for j in range(ROWS):
        change, total = row(state, steps - j), spread(0.0)
        for i in range(n):
            total += weighted[i] * change[i]
        fit[j] = where(on, total, fit[j])
        fit[ROWS * j] = where(on, total, fit[ROWS * j])
    _add_equations(fit, on)
    due = on & (_rest(steps, float(REFITTED)) == 0.0)
    if some(due):
        solve(fit, at(fit, SOLVED))
        for k in range(ORDER):
            fit[COEFFICIENTS + k] = where(due, fit[SOLVED + k], fit[COEFFICIENTS + k])
    for i in range(n):
        total = spread(0.0)
        for j in range(ORDER):
            total += fit[COEFFICIENTS + j] * row(state, steps - j)[i]
        fitted[i] = where(on, total, fitted[i])


@compiled
def _add_equations(fit, on):
    """See `prediction.add_equations`."""
    zero, one = spread(0.0), spread(1.0)
    older = where(fit[AGE] > 0.0, spread(FORGET), zero)
    fit[AGE] = where(on, fit[AGE] + 1.0, fit[AGE])
    counts = where(fit[AGE] > float(ROWS), one, zero)
    for i in range(ORDER):
        for j in range(i, ORDER):
            k = EQUATIONS + ORDER * i + j
            fit[k] = where(on, older * fit[k] + counts * fit[ROWS * (i + 1) + j + 1], fit[k])
        fit[RIGHT + i] = where(on, older * fit[RIGHT + i] + counts * fit[i + 1], fit[RIGHT + i])
