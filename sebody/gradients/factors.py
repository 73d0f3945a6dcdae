"""Solutions with the exact matrix of a step and with its transpose.

The matrix mixes masses over the square of a step with constraints: it is equilibrated first, rows
and columns to a largest entry of one, and solutions are refined. With redundant constraints it is
singular, and multipliers are not unique: a small number on their diagonal makes it regular, and
refinement takes out what that number does. Derivatives do not depend on the choice.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import lapack
from scipy.sparse.linalg import splu

from sebody.basics.errors import InputError

ROUNDS = 4              # of equilibration
REDUNDANT = 1e-9        # on the diagonal of multipliers, of equilibrated matrices
REFINEMENTS = 2, 4      # of ordinary and of redundant systems


class Scales:
    """Factors of rows and columns, kept as long as steps have one length."""

    def __init__(self, A: NDArray | sparse.csc_array):
        size = abs(A)
        n = A.shape[0]
        self.rows, self.columns = np.ones(n), np.ones(n)
        for _ in range(ROUNDS):
            for axis, scale in ((1, self.rows), (0, self.columns)):
                largest = np.asarray(size.max(axis=axis).todense()).ravel() if sparse.issparse(
                    size) else size.max(axis=axis)
                factor = 1 / np.sqrt(np.where(largest > 0, largest, 1.0))
                scale *= factor
                size = (size * (factor[:, None] if axis == 1 else factor) if not sparse.issparse(
                    size) else _scaled(size, factor, axis))


def _scaled(A: sparse.csc_array, factor: NDArray, axis: int) -> sparse.csc_array:
    D = sparse.diags_array(factor)
    return sparse.csc_array(D @ A if axis == 1 else A @ D)


class Factors:
    """A factorized matrix.

    Parameters
    ----------
    A : (n, n)
    scales : Scales
    multipliers : (n,) bool
    redundant : bool
        Whether constraints are.

    Raises
    ------
    InputError
        A singular matrix.
    """

    def __init__(self, A: NDArray | sparse.csc_array, scales: Scales, multipliers: NDArray,
                 redundant: bool):
        self.A, self.scales = A, scales
        self.refinements = REFINEMENTS[redundant]
        small = -REDUNDANT * multipliers if redundant else None
        if sparse.issparse(A):
            scaled = _scaled(_scaled(A, scales.rows, 1), scales.columns, 0)
            self._factors = splu(sparse.csc_matrix(
                scaled if small is None else scaled + sparse.diags_array(small)))
            return
        scaled = scales.rows[:, None] * A * scales.columns
        if small is not None:
            scaled[np.diag_indices_from(scaled)] += small
        lu, pivots, status = lapack.dgetrf(scaled)
        if status > 0 or not np.isfinite(lu).all():
            raise InputError("the matrix of a step is singular, so the run has no gradient there")
        self._factors = lu, pivots

    def solve(self, b: NDArray, transposed: bool = False) -> NDArray:
        """x of ``A x = b``, or of ``A^T x = b``, of columns (n, m)."""
        A = self.A.T if transposed else self.A
        x = self._once(b, transposed)
        for _ in range(self.refinements):
            x += self._once(b - A @ x, transposed)
        return x

    def _once(self, b: NDArray, transposed: bool) -> NDArray:
        first, last = self.scales.rows, self.scales.columns
        if transposed:
            first, last = last, first
        if isinstance(self._factors, tuple):
            y = lapack.dgetrs(*self._factors, first[:, None] * b, trans=int(transposed))[0]
        else:
            y = self._factors.solve(first[:, None] * b, trans="T" if transposed else "N")
        return last[:, None] * y
