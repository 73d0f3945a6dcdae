"""How accelerations and multipliers will change in a step, from how they changed in the last ones.

The error that Newton's iteration with an old matrix leaves, and the number of its corrections, go
with the error of the prediction. The change in the next step is predicted as

    c_1 d_1 + c_2 d_2 + c_3 d_3 + c_4 d_4

from those in the last `ORDER` steps, d_1 the latest, with the same coefficients for all unknowns.
Four sets of coefficients are compared in every step: none (nothing changes), (1), (2, -1), which
continue changes as a line and a parabola, and those that would have been best in the last steps, of
least squares with older steps ever less (autoregression; vibrations that steps resolve follow such
a rule exactly, four coefficients serve two of them). The next step takes the set that would have
predicted the last change best. All this is done with the products of the d_i alone.
"""

from sebody.compiler.decorators import compiled
from sebody.kernels.abi import at, pointer_to

ORDER = 4
FORGET = 0.8            # weight of a step in the fit, relative to the one after it
BETTER = 0.25           # of the square of an error: what a set of more coefficients has to reach
LEAST = 1e-13           # of the squares of changes: added to the equations of the fit
TINY = 1e-300           # the same where nothing changes

# State.fit, in this order: products of the last changes, equations and right side of the fit, its
# coefficients, and those that the next step takes
_ROWS = ORDER + 1
_EQUATIONS = _ROWS * _ROWS
_RIGHT = _EQUATIONS + ORDER * ORDER
_FITTED = _RIGHT + ORDER
CHOSEN = _FITTED + ORDER
_LOWER = CHOSEN + ORDER     # scratch memory for the elimination
FIT = _LOWER + ORDER * ORDER    # its size


@compiled
def either(condition, a, b):
    """One of two numbers."""
    return a if condition else b


@compiled
def remember_changes(system, state, of_accelerations):
    """Remember how the last step changed accelerations and multipliers; choose coefficients.

    Changes are measured as those of increments: of accelerations times `of_accelerations`.
    """
    n, total = system.diagonal.size, state.q.size
    d1 = pointer_to(state.changes)
    d2, d3, d4 = at(d1, total), at(d1, 2 * total), at(d1, 3 * total)
    s0 = s1 = s2 = s3 = s4 = 0.0 * state.clock.floor        # in lanes these are lanes
    for i in range(n):
        constraint = system.is_multiplier[i]
        new = (state.aux[i] - state.aux_old[i]) + constraint * (state.q[i] - state.q_old[i])
        a, b, c, d = d1[i], d2[i], d3[i], d4[i]
        w = state.weight[i] * (constraint + (1.0 - constraint) * of_accelerations)
        z = w * w * new
        s0 += z * new
        s1 += z * a
        s2 += z * b
        s3 += z * c
        s4 += z * d
        d1[i], d2[i], d3[i], d4[i] = new, a, b, c
    fit = pointer_to(state.fit)
    for i in range(ORDER, 0, -1):
        for j in range(ORDER, 0, -1):
            fit[_ROWS * i + j] = fit[_ROWS * (i - 1) + j - 1]
    fit[0], fit[1], fit[2], fit[3], fit[4] = s0, s1, s2, s3, s4
    for j in range(1, _ROWS):
        fit[_ROWS * j] = fit[j]
    _choose(fit)


@compiled
def _choose(fit):
    """Take the coefficients that would have predicted the last change best."""
    none = fit[0]
    zero = 0.0 * none       # a number like the others: in lanes all of them are lanes
    line = none - 2.0 * fit[1] + fit[_ROWS + 1]
    parabola = (none - 4.0 * fit[1] + 2.0 * fit[2] + 4.0 * fit[_ROWS + 1] - 4.0 * fit[_ROWS + 2]
                + fit[2 * _ROWS + 2])
    fitted = 1.0 * none
    for i in range(ORDER):
        product = -2.0 * fit[i + 1]
        for j in range(ORDER):
            product += fit[_ROWS * (i + 1) + j + 1] * fit[_FITTED + j]
        fitted += product * fit[_FITTED + i]
    _fit_anew(fit)
    straight = line < BETTER * none
    least = either(straight, line, none)
    curved = parabola < BETTER * least
    least = either(curved, parabola, least)
    best = fitted < BETTER * least
    fit[CHOSEN] = either(best, fit[_FITTED],
                         either(curved, zero + 2.0, either(straight, zero + 1.0, zero)))
    fit[CHOSEN + 1] = either(best, fit[_FITTED + 1], either(curved, zero - 1.0, zero))
    fit[CHOSEN + 2] = either(best, fit[_FITTED + 2], zero)
    fit[CHOSEN + 3] = either(best, fit[_FITTED + 3], zero)


@compiled
def _fit_anew(fit):
    """Coefficients of least squares: elimination without exchanges, in place of the last ones."""
    A, x = at(fit, _LOWER), at(fit, _FITTED)
    size = 0.0 * fit[0]
    for i in range(ORDER):
        for j in range(ORDER):
            k = _EQUATIONS + ORDER * i + j
            fit[k] = FORGET * fit[k] + fit[_ROWS * (i + 1) + j + 1]
            A[ORDER * i + j] = fit[k]
        fit[_RIGHT + i] = FORGET * fit[_RIGHT + i] + fit[i + 1]
        x[i] = fit[_RIGHT + i]
        size += A[ORDER * i + i]
    for i in range(ORDER):
        A[ORDER * i + i] += LEAST * size + TINY
    for k in range(ORDER):
        pivot = 1.0 / A[ORDER * k + k]
        for i in range(k + 1, ORDER):
            factor = A[ORDER * i + k] * pivot
            for j in range(k + 1, ORDER):
                A[ORDER * i + j] -= factor * A[ORDER * k + j]
            x[i] -= factor * x[k]
        A[ORDER * k + k] = pivot
    for k in range(ORDER - 1, -1, -1):
        for j in range(k + 1, ORDER):
            x[k] -= A[ORDER * k + j] * x[j]
        x[k] *= A[ORDER * k + k]
