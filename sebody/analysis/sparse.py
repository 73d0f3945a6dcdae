"""Solution of scaled sparse systems, outside the loop."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

SMALL = 100         # unknowns up to which LAPACK takes less time than SciPy to call SuperLU
SINGULAR = 1e-13    # smallest pivot of a regular matrix, relative to the largest


class _Dense:
    """Factors of a small matrix."""

    def __init__(self, matrix: csc_matrix):
        self._factors, self._exchanges, zero = dgetrf(matrix.toarray(order="F"), overwrite_a=True)
        if zero:
            raise RuntimeError("a pivot is exactly zero")
        self.pivots, self.unknowns = np.abs(self._factors.diagonal()), np.arange(matrix.shape[0])

    def solve(self, right: NDArray) -> NDArray:
        return dgetrs(self._factors, self._exchanges, right)[0]


class _Sparse:
    """Factors of a large one; pivots in the order of elimination."""

    def __init__(self, matrix: csc_matrix):
        self._factors = splu(matrix)
        self.solve = self._factors.solve

    @cached_property
    def pivots(self) -> NDArray:
        return np.abs(self._factors.U.diagonal())

    @property
    def unknowns(self) -> NDArray:
        return np.argsort(self._factors.perm_c)


class Scaled:
    """A matrix with symmetrically scaled rows and columns, and its factors if it has any.

    Parameters
    ----------
    matrix : (n, n)
        Of any units; not changed.
    """

    def __init__(self, matrix: csc_matrix):
        matrix = csc_matrix(matrix, copy=not matrix.has_canonical_format)
        matrix.sum_duplicates()
        entries, row, across = matrix.data, matrix.indices, matrix.shape[1]
        column = np.repeat(np.arange(across), np.diff(matrix.indptr))
        largest = np.zeros(across)
        np.maximum.at(largest, column, np.abs(entries))
        self.scale = 1.0 / np.sqrt(np.maximum(largest, 1e-300))
        # on the entries: for a few bodies SciPy's products take ten times as long as their numbers
        matrix.data = entries * self.scale[row] * self.scale[column]
        self.matrix = matrix
        try:
            self.factors = (_Dense if across <= SMALL else _Sparse)(self.matrix)
        except RuntimeError:        # a pivot is exactly zero
            self.factors = None

    @cached_property
    def regular(self) -> bool:
        """Whether no pivot is too small to be trusted."""
        if self.factors is None:
            return False
        pivots = self.factors.pivots
        return bool(pivots.min() >= SINGULAR * pivots.max())

    @property
    def weakest(self) -> int | None:
        """The unknown of the smallest pivot, None if a pivot is exactly zero."""
        if self.factors is None:
            return None
        return int(self.factors.unknowns[np.argmin(self.factors.pivots)])

    def solve(self, right: NDArray) -> NDArray:
        """Solution by the factors."""
        return self.scale * self.factors.solve(self.scale * right)

    def least(self, right: NDArray) -> tuple[NDArray, NDArray]:
        """Solution of least norm by dense algebra, and the scaled residuals that remain."""
        demand = self.scale * right
        answer = np.linalg.lstsq(self.matrix.toarray(), demand, rcond=1e-11)[0]
        return self.scale * answer, np.abs(self.matrix @ answer - demand)
