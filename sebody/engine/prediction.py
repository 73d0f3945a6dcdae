"""Prediction of accelerations and multipliers in a step, from their changes in the last ones.

The number of corrections in Newton's iteration, and what it leaves with an old matrix, go with the
error of the prediction. Predicted is that nothing changes; or that changes continue as a line or a
parabola; or, from those in the last `ORDER` steps, d_1 the latest,

    c_1 d_1 + ... + c_8 d_8

with the same coefficients for all unknowns: those of least squares for the steps so far, older ones
ever less (autoregression; four vibrations follow such a rule exactly). A step takes what would have
been best for the step before.

The fit costs as much as a part of a correction. Whether it saves as much is tried: in some periods
of `PERIOD` steps it is made, in others not, and the mean corrections of both are compared.
"""

from sebody.compiler.decorators import ANY_ORDER, compiled
from sebody.engine.selection import any_true, either
from sebody.kernels.abi import at, pointer_to

ORDER = 8
ROWS = ORDER + 1        # of changes that are kept: a ring, the latest overwrites the oldest
REFITTED = 4            # steps after which coefficients are solved for anew
FORGET = 0.8            # weight of a step in the fit, relative to the one after it
BETTER = 0.25           # of the square of an error: what the next prediction has to reach
LEAST = 1e-13           # of the squares of changes: added to the equations of the fit
TINY = 1e-300           # the same where nothing changes
PERIOD = 64             # steps with the fit or without it
SETTLING = 24           # first ones of a period, whose corrections do not count
TRIED_AGAIN = 16        # periods after which what has saved less is tried again
WORTH = 0.2             # corrections of a step that the fit has to save

# State.fit, in this order: products of the changes that are kept, equations, right side and
# coefficients of the fit, scratch memory for its elimination, and numbers by name
_EQUATIONS = ROWS * ROWS
_RIGHT = _EQUATIONS + ORDER * ORDER
_COEFFICIENTS = _RIGHT + ORDER
_FACTORS = _COEFFICIENTS + ORDER
_SOLUTION = _FACTORS + ORDER * ORDER
LAST, BEFORE, FITTED, ON, AGE, SUM, WITH, WITHOUT = range(
    _SOLUTION + ORDER, _SOLUTION + ORDER + 8)
FIT = WITHOUT + 1      # its size


@compiled
def ring_place(steps, grid):
    """Places of the changes of the step under way in the ring; in lanes by those of the grid."""
    return steps + ROWS


@compiled
def refitted(on, steps):
    """`on` if coefficients are solved for anew after so many steps, else zero."""
    return on if steps % REFITTED == 0 else 0.0


@compiled
def row(state, steps):
    """Changes in a step, by how many steps there were before."""
    return at(pointer_to(state.changes), state.q.size * (steps % ROWS))


@compiled
def look_back(system, state, of_accelerations):
    """Remember how the last step changed accelerations and multipliers; choose what to predict.

    Changes are measured as those of increments: of accelerations times `of_accelerations`.
    `State.fit` gets the shares LAST, BEFORE and FITTED of the last two changes and of
    `State.fitted` in the prediction.
    """
    fit = pointer_to(state.fit)
    steps = ring_place(state.control.steps, state.control.grid)
    compare_periods(fit, state.control.iteration, state.control.steps)
    of_none, of_line, of_parabola, of_fit = _errors(
        system.diagonal.size, row(state, steps), row(state, steps - 1), row(state, steps - 2),
        pointer_to(state.correction), pointer_to(state.fitted), pointer_to(state.q),
        pointer_to(state.q_old), pointer_to(state.aux), pointer_to(state.aux_old),
        pointer_to(state.weight), pointer_to(system.is_multiplier), of_accelerations,
        0.0 * fit[ON])
    zero = 0.0 * of_none        # in lanes these are lanes
    straight = of_line < BETTER * of_none
    least = either(straight, of_line, of_none)
    bent = of_parabola < BETTER * least
    least = either(bent, of_parabola, least)
    begun = either(fit[AGE] > 0.0, of_fit, least)
    best = either(fit[ON] > 0.0, begun, least) < BETTER * least
    fit[LAST] = either(best, zero, either(bent, zero + 2.0, either(straight, zero + 1.0, zero)))
    fit[BEFORE] = either(best, zero, either(bent, zero - 1.0, zero))
    fit[FITTED] = either(best, zero + 1.0, zero)
    if any_true(fit[ON] > 0.0):
        _fit_anew(system, state, steps)


@compiled(apart=True, fastmath=ANY_ORDER)
def _errors(n, now, last, before, weighted, fitted, q, q_old, aux, aux_old, weight, is_multiplier,
            of_accelerations, none):
    """Keep changes and weighted changes; the squares of what each prediction would have missed.

    Sums in any order, which only tell what to predict next.
    """
    of_none = of_line = of_parabola = of_fit = none
    for i in range(n):
        constraint = is_multiplier[i]
        w = weight[i] * (constraint + (1.0 - constraint) * of_accelerations)
        x = aux[i] - aux_old[i] + constraint * (q[i] - q_old[i])
        line = x - last[i]
        parabola = line - (last[i] - before[i])
        error = x - fitted[i]
        w *= w
        of_none += w * x * x
        of_line += w * line * line
        of_parabola += w * parabola * parabola
        of_fit += w * error * error
        now[i], weighted[i] = x, w * x
    return of_none, of_line, of_parabola, of_fit


@compiled
def compare_periods(fit, corrections, steps):
    """Count the corrections of the last step; begin a period with the fit or without it."""
    within = steps % PERIOD
    if within == 0:
        mean = fit[SUM] / (PERIOD - SETTLING)
        on = fit[ON] > 0.0
        fit[WITH] = either(on, mean, fit[WITH])
        fit[WITHOUT] = either(on, fit[WITHOUT], mean)
        zero = 0.0 * mean
        better = either(fit[WITH] + WORTH < fit[WITHOUT], zero + 1.0, zero)
        period = steps // PERIOD
        if period < 3:      # the second one without the fit, the third one with it: the first steps
            better = zero + period // 2     # of a motion are no measure
        elif period % TRIED_AGAIN == 0:
            better = 1.0 - better
        fit[AGE] = fit[AGE] * better
        fit[ON], fit[SUM] = better, zero
    elif within > SETTLING:
        fit[SUM] += corrections


@compiled
def _fit_anew(system, state, steps):
    """Products of the last changes, coefficients of least squares, and the change they predict.

    In lanes nothing of this changes for members without the fit.
    """
    n, fit, on = system.diagonal.size, pointer_to(state.fit), state.fit[ON] > 0.0
    weighted, fitted = pointer_to(state.correction), pointer_to(state.fitted)
    now = steps % ROWS
    for j in range(0, ROWS, 3):         # three at a time: the weighted change is read once for them
        a, b, c = row(state, steps - j), row(state, steps - j - 1), row(state, steps - j - 2)
        of_a = of_b = of_c = 0.0 * fit[0]
        for i in range(n):
            w = weighted[i]
            of_a += w * a[i]
            of_b += w * b[i]
            of_c += w * c[i]
        _put_product(fit, now, (steps - j) % ROWS, of_a)
        _put_product(fit, now, (steps - j - 1) % ROWS, of_b)
        _put_product(fit, now, (steps - j - 2) % ROWS, of_c)
    _add_equations(fit, steps)
    due = refitted(fit[ON], state.control.steps)
    if any_true(due > 0.0):
        _solve(fit, due)
    c0, c1, c2, c3 = (fit[_COEFFICIENTS], fit[_COEFFICIENTS + 1], fit[_COEFFICIENTS + 2],
                      fit[_COEFFICIENTS + 3])
    c4, c5, c6, c7 = (fit[_COEFFICIENTS + 4], fit[_COEFFICIENTS + 5], fit[_COEFFICIENTS + 6],
                      fit[_COEFFICIENTS + 7])
    d0, d1, d2, d3 = (row(state, steps), row(state, steps - 1), row(state, steps - 2),
                      row(state, steps - 3))
    d4, d5, d6, d7 = (row(state, steps - 4), row(state, steps - 5), row(state, steps - 6),
                      row(state, steps - 7))
    for i in range(n):
        total = c0 * d0[i] + c1 * d1[i] + c2 * d2[i] + c3 * d3[i]
        total = total + c4 * d4[i] + c5 * d5[i] + c6 * d6[i] + c7 * d7[i]
        fitted[i] = either(on, total, fitted[i])


@compiled
def _put_product(fit, i, j, product):
    """Keep the product of two changes, by their rows."""
    fit[ROWS * i + j] = fit[ROWS * j + i] = product


@compiled
def _add_equations(fit, steps):
    """Add those of the last step to the equations of the fit, of which a part is kept."""
    zero = 0.0 * fit[AGE]
    older = either(fit[AGE] > 0.0, zero + FORGET, zero)
    fit[AGE] = fit[AGE] + fit[ON]
    counts = either(fit[AGE] > ROWS, zero + 1.0, zero)     # before that, products are missing
    for i in range(ORDER):
        own = at(fit, ROWS * ((steps - i - 1) % ROWS))
        for j in range(i, ORDER):
            k = _EQUATIONS + ORDER * i + j
            fit[k] = older * fit[k] + counts * own[(steps - j - 1) % ROWS]
        fit[_RIGHT + i] = older * fit[_RIGHT + i] + counts * own[steps % ROWS]


@compiled
def _solve(fit, due):
    """Coefficients of least squares: elimination of a positive matrix."""
    A, x = at(fit, _FACTORS), at(fit, _SOLUTION)
    size = 0.0 * fit[0] + TINY
    for i in range(ORDER):
        for j in range(i, ORDER):
            A[ORDER * i + j] = fit[_EQUATIONS + ORDER * i + j]
        x[i] = fit[_RIGHT + i]
        size += LEAST * A[ORDER * i + i]
    for i in range(ORDER):
        A[ORDER * i + i] += size
    for k in range(ORDER):
        pivot = 1.0 / A[ORDER * k + k]
        for i in range(k + 1, ORDER):
            factor = A[ORDER * k + i] * pivot
            for j in range(i, ORDER):
                A[ORDER * i + j] -= factor * A[ORDER * k + j]
            x[i] -= factor * x[k]
        A[ORDER * k + k] = pivot
    for k in range(ORDER - 1, -1, -1):
        for j in range(k + 1, ORDER):
            x[k] -= A[ORDER * k + j] * x[j]
        x[k] *= A[ORDER * k + k]
        fit[_COEFFICIENTS + k] = either(due > 0.0, x[k], fit[_COEFFICIENTS + k])
