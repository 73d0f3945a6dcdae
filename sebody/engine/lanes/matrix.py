"""Matrices of eight members: sums, scales and inverses, see `sebody.engine.matrix`."""

import math

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import every, some, spread, where
from sebody.contract.layout import C_MASS
from sebody.engine.lanes.apart import CUT, GAVE_UP
from sebody.engine.lanes.elimination import eliminate_large
from sebody.engine.lanes.regularization import (
    project_inverse,
    regularize,
    spread_multipliers,
)
from sebody.engine.matrix import ROUNDING, THIN, sum_matrices
from sebody.engine.regularization import WEAKEST
from sebody.engine.state import KEPT
from sebody.kernels.abi import at, pointer_to

SMALL_PIVOT = 1e-9      # relative to the scaled matrix, whose diagonal is one


@compiled
def factorize(system, state, scratch, dense, wanted, evaluated):
    """Sum and factorize the matrices of some members, or invert small ones (dense).

    Returns the members that leave: their matrices need row exchanges, so they are run alone from
    their start, or are no numbers, so their step is cut. `evaluated`
    are those whose element matrices are all new: their scales are, too.
    """
    control, clock = state.control, state.clock
    zero = spread(0.0)
    if not dense and not every(wanted):
        for k in range(state.matrix.size):
            scratch.factors[k] = state.matrix[k]
    sum_matrices(system, state, state.forces)
    if some(evaluated):
        _equilibrate(system, state, evaluated)
    control.regularized = system.regularized[0]
    if control.regularized == 1:
        regularize(system, state, wanted)
    if dense:
        failed = wanted & ~_invert(system, state, scratch, wanted, evaluated)
    else:
        failed = wanted & ~eliminate_large(system, state, scratch.factors, wanted)
        if control.regularized == 1 and some(evaluated):
            spread_multipliers(system, state, pointer_to(state.inverse), False, evaluated)
    clock.factor_step = clock.current_step
    clock.baseline_contraction = where(evaluated, spread(0.5), clock.baseline_contraction)
    clock.excess = where(evaluated, zero, clock.excess)
    control.age = where(evaluated, zero, control.age)
    control.wanted = where(wanted, spread(float(KEPT)), control.wanted)
    one = where(wanted, spread(1.0), zero)
    control.secant = where(wanted, zero, control.secant)
    control.fresh += one
    control.matrices += one
    if some(failed):        # forces that are no numbers: the step is too long
        left = spread(0.0)
        for i in range(system.diagonal.size):
            left += 0.0 * state.residual[i]
        control.reason = where(failed, where(left == 0.0, spread(GAVE_UP), spread(CUT)),
                               control.reason)
    return failed


@compiled(forceinline=True)
def _equilibrate(system, state, wanted):
    """Scales of the members that want a matrix, and what rounding leaves of their positions."""
    n, mass = system.diagonal.size, state.coefficients[C_MASS]
    sums = state.correction
    for i in range(n):
        sums[i] = spread(0.0)
        if system.is_multiplier[i] == 0.0:
            diagonal = max(abs(state.matrix[system.diagonal[i]]), THIN * mass * system.inertias[i])
            state.scale[i] = where(wanted, 1.0 / math.sqrt(diagonal), state.scale[i])
    for k in range(system.rows.size):
        if (system.is_multiplier[system.rows[k]] > 0.0
                and system.is_multiplier[system.columns[k]] == 0.0):
            entry = state.matrix[k] * state.scale[system.columns[k]]
            sums[system.rows[k]] += entry * entry
    floor = spread(0.0)
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            scale = where(sums[i] > 0.0, 1.0 / math.sqrt(sums[i]), spread(1.0))
            state.scale[i] = where(wanted, scale, state.scale[i])
        state.weight[i] = where(wanted, 1.0 / state.scale[i], state.weight[i])
        size = max(system.magnitude[i], abs(state.q[i])) * state.weight[i]
        floor += where(system.magnitude[i] > 0.0, size * size, spread(0.0))
    state.clock.floor = where(wanted, ROUNDING * math.sqrt(floor), state.clock.floor)


@compiled
def _invert(system, state, scratch, wanted, evaluated):
    """Invert the scaled matrices by Gauss-Jordan elimination without exchanges.

    Multipliers come after the unknowns they act on, whose part of the matrix is dominated by
    masses. Returns the members whose pivots are large enough.
    """
    n, regularized = system.diagonal.size, state.control.regularized == 1
    A = pointer_to(scratch.dense)
    size = inverse_size = spread(0.0)
    for j in range(n):
        for i in range(n):
            entry = state.scale[i] * state.matrix[j * n + i] * state.scale[j]
            A[j * n + i] = entry
            size += abs(entry)
    good = size < 1e300
    for k in range(n):
        own = at(A, k * n)
        good = good & (abs(own[k]) > SMALL_PIVOT)
        factor = 1.0 / own[k]
        own[k] = 1.0
        for j in range(n):
            own[j] = own[j] * factor
        for i in range(n):
            if i != k:
                row = at(A, i * n)
                factor = row[k]
                row[k] = 0.0
                for j in range(n):
                    row[j] = row[j] - factor * own[j]
    for j in range(n):
        if system.is_multiplier[j] > 0.0 and not regularized:
            good = good & ~(WEAKEST * abs(A[j * n + j]) > 1.0)
        for i in range(n):
            inverse_size += abs(A[j * n + i])
    good = good & (size * inverse_size < 1e16 * n)
    if regularized:
        if some(evaluated):
            spread_multipliers(system, state, A, True, evaluated)
        project_inverse(system, state, A, pointer_to(scratch.projected), n)
    whole, inverse = every(wanted), state.inverse
    for j in range(n):
        for i in range(n):
            entry = state.scale[i] * A[j * n + i] * state.scale[j]
            inverse[j, i] = entry if whole else where(wanted, entry, inverse[j, i])
    return good
