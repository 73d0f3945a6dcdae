"""Factors with row exchanges, where elimination by blocks meets a small pivot or mass is missing.

The loop asks its aid for them, which calls `exchange`, see `sebody.engine.aid`.
Factors follow from the matrix and the scales in the state alone, so they are no part of a state
that is kept: they are made again when they are asked for.

Some motions have stiffness and no mass, as of MacNeal's bodies. Masses are singular then, and a
restart takes the solution of least norm: such motions get no acceleration, and stiffness alone
places them from the next step on.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK
from sebody.engine.arrays import Arrays
from sebody.engine.matrix import sum_matrices
from sebody.engine.regularization import PROJECTIONS, REGULARIZATION, regularize
from sebody.engine.sparse_lu import ROOM, SINGULAR, Columns, Factors, factorize, substitute
from sebody.engine.state import FACTORS, SOLUTION

UNKNOWN, OF_STEP, OF_MASSES, LEAST, FAILED = range(5)   # what factors are of
DAMPED = 1e-8           # parts of masses that are weaker, relative to the largest entry, are none
ATTEMPTS = 20           # refinements of least squares
SETTLED = 1e-15         # change of the last residual, relative to the right side


@dataclass(frozen=True, eq=False)
class Exchanges(Arrays):
    """A matrix that needs row exchanges, by columns, and its factors.

    ========  ======================================================================================
    factors   of the matrix; first, because their first two arrays may be replaced by larger ones
    kind      (2,) what they are factors of; entries that they need, after ROOM
    matrix    by columns
    scale     (n,) of unknowns
    right, found
              (2 n,) scratch memory
    demand, answer, left
              (n,) right side, solution and residual of least squares
    ========  ======================================================================================
    """

    factors: Factors
    kind: NDArray
    matrix: Columns
    scale: NDArray
    right: NDArray
    found: NDArray
    demand: NDArray
    answer: NDArray
    left: NDArray

    @classmethod
    def of(cls, n: int, stored: int, entries: int = 0) -> "Exchanges":
        """Room for matrices of n unknowns with `stored` entries, zeros included.

        Of least squares there are twice as many unknowns. `entries` are those of factors.
        """
        stored = 2 * (stored + n)
        columns = Columns(np.zeros(stored), np.zeros(stored, dtype=np.int64),
                          np.zeros(2 * n + 1, dtype=np.int64))
        return cls(Factors.of(2 * n, entries), np.zeros(2, dtype=np.int64), columns, np.zeros(n),
                   np.zeros(2 * n), np.zeros(2 * n), np.zeros(n), np.zeros(n), np.zeros(n))


@compiled
def exchange(system, state, exchanges, what):
    """Make FACTORS or a SOLUTION; returns ROOM where factors need more than there is.

    Called again with as many entries as ``kind[1]`` says, it goes on.
    """
    if what == FACTORS:
        exchanges.kind[0] = UNKNOWN
    if exchanges.kind[0] == UNKNOWN:
        outcome = _factorize(system, state, exchanges)
        if outcome == ROOM:
            exchanges.kind[1] = 2 * (exchanges.factors.values.size + exchanges.matrix.entries.size)
            exchanges.kind[0] = UNKNOWN
            return ROOM
    if what == SOLUTION:
        _solve(system, state, exchanges)
    return OK


@compiled
def _factorize(system, state, exchanges):
    if state.control.restart != 0 and (system.regularized[0] == 0 or system.massless[0] == 1):
        return _of_masses(system, state, exchanges)
    n = system.diagonal.size
    for i in range(n):
        exchanges.scale[i] = state.scale[i]
    outcome = _scaled(system, state, exchanges, False)
    if outcome == SINGULAR and state.control.regularized == 0:
        regularize(system, state, REGULARIZATION)
        for i in range(n):
            exchanges.scale[i] = state.scale[i]
        outcome = _scaled(system, state, exchanges, False)
    complete = exchanges.factors.starts[n] > 0
    exchanges.kind[0] = OF_STEP if complete else FAILED     # the step fails
    return outcome


@compiled
def _of_masses(system, state, exchanges):
    """Factors of masses and constraints; of least squares if these are singular."""
    n = system.diagonal.size
    sum_matrices(system, state, state.forces, False)
    _scale_masses(system, state, exchanges.scale)
    exchanges.kind[0] = OF_MASSES
    outcome = _scaled(system, state, exchanges, False)
    if outcome == SINGULAR:
        outcome = _scaled(system, state, exchanges, True)
        exchanges.kind[0] = LEAST if exchanges.factors.starts[2 * n] > 0 else FAILED
    return outcome


@compiled
def _scale_masses(system, state, scale):
    """Scale inertias and constraints to about one, so that no norm depends on axes or units.

    The three coordinates of a position, a rotation or an equation share a scale: from the sum of
    their inertias, or of the squares of their scaled rows.
    """
    n = system.diagonal.size
    for i in range(n):
        scale[i] = 0.0
    for i in range(n):
        if system.is_multiplier[i] == 0.0:
            scale[system.part[i]] += abs(state.matrix[system.diagonal[i]])
    _share_scale(system, scale, 0.0)
    for k in range(system.rows.size):
        i, j = system.rows[k], system.columns[k]
        if i < n and j < n and system.is_multiplier[i] > 0.0 and system.is_multiplier[j] == 0.0:
            entry = state.matrix[k] * scale[j]
            scale[system.part[i]] += entry * entry
    _share_scale(system, scale, 1.0)


@compiled
def _share_scale(system, scale, multiplier):
    """Make scales of the sizes that coordinates, or multipliers, have in the first of a part."""
    for i in range(system.diagonal.size - 1, -1, -1):
        if system.is_multiplier[i] == multiplier:
            size = scale[system.part[i]]
            scale[i] = 1.0 / np.sqrt(size if size > 0.0 else system.inertias[i])


@compiled
def _scaled(system, state, exchanges, damped):
    """Factors of the scaled matrix A, or those of damped least squares, with every unknown twice:

        [DAMPED  A     ]
        [A^T    -DAMPED]
    """
    n, matrix, scale = system.diagonal.size, exchanges.matrix, exchanges.scale
    starts, places = matrix.starts, exchanges.factors.order
    size, times = (2 * n, 2) if damped else (n, 1)
    for j in range(size + 1):
        starts[j] = 0
    for k in range(system.rows.size):
        i, j = system.rows[k], system.columns[k]
        if i < n and j < n and state.matrix[k] != 0.0:
            starts[times * j + times] += 1
            if damped:
                starts[2 * i + 1] += 1
    for j in range(size):
        starts[j + 1] += starts[j] + (1 if damped else 0)
        places[j] = starts[j]
    for k in range(system.rows.size):
        i, j = system.rows[k], system.columns[k]
        if i < n and j < n and state.matrix[k] != 0.0:
            value = scale[i] * state.matrix[k] * scale[j]
            if damped:
                _put(matrix, places, 2 * i, 2 * j + 1, value)
                _put(matrix, places, 2 * j + 1, 2 * i, value)
            else:
                _put(matrix, places, i, j, value)
    if damped:
        for i in range(n):
            _put(matrix, places, 2 * i, 2 * i, DAMPED)
            _put(matrix, places, 2 * i + 1, 2 * i + 1, -DAMPED)
    return factorize(matrix, size, exchanges.factors)


@compiled
def _put(matrix, places, i, j, value):
    p = places[j]
    matrix.rows[p], matrix.entries[p] = i, value
    places[j] = p + 1


@compiled
def _solve(system, state, exchanges):
    """Solve for the correction from the residual."""
    n, kind = system.diagonal.size, exchanges.kind[0]
    if kind == FAILED:
        for i in range(n):
            state.correction[i] = np.nan
    elif kind == LEAST:
        _solve_least(system, state, exchanges)
    else:
        _substitute(exchanges, n, state.residual, state.correction)
    if kind == OF_STEP and state.control.regularized == 1:
        for _ in range(PROJECTIONS):
            for i in range(n):
                state.projected[i] = (state.regularization[i] * system.is_multiplier[i]
                                      * state.correction[i])
            _substitute(exchanges, n, state.projected, state.projected)
            for i in range(n):
                state.correction[i] -= state.projected[i]


@compiled
def _substitute(exchanges, n, right, out):
    for i in range(n):
        exchanges.right[i] = exchanges.scale[i] * right[i]
    substitute(exchanges.factors, n, exchanges.right, exchanges.found)
    for i in range(n):
        out[i] = exchanges.scale[i] * exchanges.found[i]


@compiled
def _solve_least(system, state, exchanges):
    """Least squares of least norm.

    What no accelerations give, such as forces on motions without mass, is part of every residual,
    and what rounding makes of it grows by 1 / DAMPED^2. So the right side is first replaced by what
    the matrix makes of its solution.
    """
    n, demand, answer = system.diagonal.size, exchanges.demand, exchanges.answer
    for i in range(n):
        demand[i] = exchanges.scale[i] * state.residual[i]
    _refine(system, state, exchanges)
    for i in range(n):
        demand[i] -= exchanges.left[i]
    _refine(system, state, exchanges)
    for i in range(n):
        state.correction[i] = exchanges.scale[i] * answer[i]


@compiled
def _refine(system, state, exchanges):
    """Solve for `demand`, refined as `sebody.runs.kkt_solver` derives it; sets what is left."""
    n, right, correction, answer, left = (system.diagonal.size, exchanges.right, exchanges.found,
                                          exchanges.answer, exchanges.left)
    largest = 0.0
    for i in range(n):
        answer[i], left[i] = 0.0, exchanges.demand[i]
        largest = max(largest, abs(left[i]))
    for _ in range(ATTEMPTS):
        for i in range(n):
            right[2 * i], right[2 * i + 1] = left[i], 0.0
        substitute(exchanges.factors, 2 * n, right, correction)
        for i in range(n):
            answer[i] += correction[2 * i + 1]
            right[i] = exchanges.demand[i]
        for k in range(system.rows.size):
            i, j = system.rows[k], system.columns[k]
            if i < n and j < n:
                right[i] -= (exchanges.scale[i] * state.matrix[k] * exchanges.scale[j]
                             * answer[j])
        change = 0.0
        for i in range(n):
            change = max(change, abs(right[i] - left[i]))
            left[i] = right[i]
        if change <= SETTLED * largest:
            break
