"""Factors with row exchanges in compiled code, where elimination in the loop meets a small pivot.

In Python SuperLU does this, see `sebody.runs.row_exchanges`. It is needed seldom, so these are
factors of a full matrix. Corrections agree but for rounding.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.engine.arrays import Arrays
from sebody.engine.matrix import sum_matrices
from sebody.engine.regularization import PROJECTIONS, REGULARIZATION, regularize
from sebody.engine.state import FACTORED

REGULAR, SINGULAR, MASSES = range(3)    # what factors are: those of masses regularize nothing
SMALLEST = 1e-13        # pivot of a regular matrix, relative to the largest


@dataclass(frozen=True, eq=False)
class Exchanges(Arrays):
    """Factors of the last matrix that needed row exchanges.

    ========  ======================================================================================
    factors   (n, n) L below the diagonal, U
    rows      (n,) row that each one was exchanged with
    kind      (1,) REGULAR, SINGULAR, or MASSES of a restart
    right     (n,) scratch memory
    ========  ======================================================================================
    """

    factors: NDArray
    rows: NDArray
    kind: NDArray
    right: NDArray

    @classmethod
    def of(cls, n: int) -> "Exchanges":
        """Room for matrices of n unknowns."""
        return cls(np.zeros((n, n)), np.zeros(n, dtype=np.int64), np.zeros(1, dtype=np.int64),
                   np.zeros(n))


@compiled
def exchange(system, state, exchanges):
    """Factorize or solve, whichever the loop waits for; 1 where masses are singular."""
    if state.control.phase == FACTORED:
        return _factorize(system, state, exchanges)
    _solve(system, state, exchanges)
    return 0


@compiled
def _factorize(system, state, exchanges):
    if state.control.restart != 0:
        sum_matrices(system, state, state.forces)
        exchanges.kind[0] = MASSES
        return 0 if _decompose(system, state, exchanges) else 1
    exchanges.kind[0] = REGULAR
    if not _decompose(system, state, exchanges):
        regularize(system, state, REGULARIZATION)
        if not _decompose(system, state, exchanges):
            exchanges.kind[0] = SINGULAR        # the step fails
    return 0


@compiled
def _decompose(system, state, exchanges):
    """Factors of the scaled matrix by Gaussian elimination with partial pivoting."""
    n, A = system.diagonal.size, exchanges.factors
    for i in range(n):
        for j in range(n):
            A[i, j] = 0.0
    for k in range(system.rows.size):
        i, j = system.rows[k], system.columns[k]
        if i < n and j < n:
            A[i, j] = state.scale[i] * state.matrix[k] * state.scale[j]
    least, most = np.inf, 0.0
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[p, k]):
                p = i
        exchanges.rows[k] = p
        if p != k:
            for j in range(n):
                A[k, j], A[p, j] = A[p, j], A[k, j]
        pivot = abs(A[k, k])
        least, most = min(least, pivot), max(most, pivot)
        if not 0.0 < pivot < np.inf:
            return False
        for i in range(k + 1, n):
            if A[i, k] != 0.0:
                A[i, k] /= A[k, k]
                for j in range(k + 1, n):
                    A[i, j] -= A[i, k] * A[k, j]
    return least >= SMALLEST * most


@compiled
def _solve(system, state, exchanges):
    """Solve for the correction from the residual; a regularized matrix gets its projections."""
    n = system.diagonal.size
    if exchanges.kind[0] == SINGULAR:
        for i in range(n):
            state.correction[i] = np.nan
        return
    _substitute(state, exchanges, state.residual, state.correction, n)
    if exchanges.kind[0] == REGULAR and state.control.regularized == 1:
        for _ in range(PROJECTIONS):
            for i in range(n):
                state.projected[i] = (state.regularization[i] * system.is_multiplier[i]
                                      * state.correction[i])
            _substitute(state, exchanges, state.projected, state.pulled, n)
            for i in range(n):
                state.correction[i] -= state.pulled[i]


@compiled
def _substitute(state, exchanges, right, out, n):
    A, x = exchanges.factors, exchanges.right
    for i in range(n):
        x[i] = state.scale[i] * right[i]
    for k in range(n):
        p = exchanges.rows[k]
        x[k], x[p] = x[p], x[k]
    for i in range(n):
        for j in range(i):
            x[i] -= A[i, j] * x[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= A[i, j] * x[j]
        x[i] /= A[i, i]
    for i in range(n):
        out[i] = state.scale[i] * x[i]
