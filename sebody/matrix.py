"""The iteration matrix in compiled code: scales, factors, solution."""

import numpy as np
from numba import njit

from . import elimination
from .abi import pointer_to
from .dense import columns_times
from .evaluate import sum_matrices
from .state import FLOOR

RELAXATION = 1e-7       # of redundant constraints, in the scaled iteration matrix alone


@njit(cache=True, error_model="numpy")
def equilibrate(system, state):
    """Scales that give the matrix a unit diagonal and unit constraint rows: free of units and h."""
    n = system.diagonal.size
    for i in range(n):
        diagonal = abs(state.matrix[system.diagonal[i]])
        state.scale[i] = 0.0 if system.is_multiplier[i] > 0.0 else (
            1.0 / np.sqrt(diagonal) if diagonal > 0.0 else 1.0)
    sums = state.correction
    sums[:] = 0.0
    for k in range(system.rows.size):
        if system.is_multiplier[system.rows[k]] > 0.0:
            entry = state.matrix[k] * state.scale[system.columns[k]]
            sums[system.rows[k]] += entry * entry
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            state.scale[i] = 1.0 / np.sqrt(sums[i]) if sums[i] > 0.0 else 1.0
    floor = 0.0
    for i in range(n):
        state.weight[i] = 1.0 / state.scale[i]
        size = system.magnitude[i] * state.weight[i]
        floor += size * size
    state.clock[FLOOR] = 8.0 * 2.2e-16 * np.sqrt(floor)     # what rounding of positions leaves


@njit(cache=True, error_model="numpy")
def relax(system, state):
    """Make the matrix of redundant constraints regular.

    Their residuals are consistent and so is the answer: multipliers of least norm. Iterations go on
    until the constraints hold, so nothing is changed but the way there.
    """
    for i in range(system.diagonal.size):
        if system.is_multiplier[i] > 0.0:
            state.matrix[system.diagonal[i]] -= RELAXATION * state.weight[i] * state.weight[i]


@njit(cache=True, error_model="numpy")
def invert_dense(system, state, n):
    """Inverse of a small system, by columns, scales included; False if it is singular."""
    dense = np.empty((n, n))
    size = inverse_size = 0.0
    for j in range(n):
        for i in range(n):
            dense[j, i] = state.scale[i] * state.matrix[j * n + i] * state.scale[j]
            size += abs(dense[j, i])
    if not np.isfinite(size):
        return False
    try:
        inverse = np.linalg.inv(dense)
    except Exception:  # noqa: BLE001  (LAPACK met a zero pivot; compiled code has no other kind)
        return False
    for j in range(n):
        for i in range(n):
            inverse_size += abs(inverse[j, i])
            state.inverse[j, i] = state.scale[i] * inverse[j, i] * state.scale[j]
    return size * inverse_size < 1e16 * n


@njit(cache=True, error_model="numpy", forceinline=True)
def factorize(system, state):
    """Factors of a large system in place of its matrix; False, and the matrix, at a small pivot."""
    done = elimination.eliminate(
        system.block_diagonal.size, pointer_to(system.block_starts), pointer_to(system.block_rows),
        pointer_to(system.block_diagonal), pointer_to(state.matrix), pointer_to(state.column),
        pointer_to(state.scale))
    if not done:
        sum_matrices(system, state, state.forces)
        if system.relaxed[0] == 1:
            relax(system, state)
    return done


@njit(cache=True, error_model="numpy", forceinline=True)
def solve(system, state, dense):
    """Correction from the residual."""
    n, x = system.diagonal.size, pointer_to(state.correction)
    if dense:
        columns_times(pointer_to(state.inverse), pointer_to(state.residual), x, n, n)
        return
    for i in range(n):
        x[i] = state.residual[i]
    for i in range(system.padding.size):
        x[n + i] = 0.0
    elimination.substitute(system.block_diagonal.size, pointer_to(system.block_starts),
                           pointer_to(system.block_rows), pointer_to(system.block_diagonal),
                           pointer_to(state.matrix), x)
