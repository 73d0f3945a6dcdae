"""Solution of scaled sparse systems, outside the loop."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

SINGULAR = 1e-13    # smallest pivot of a regular matrix, relative to the largest


class Scaled:
    """A matrix with symmetrically scaled rows and columns, and its factors if it has any.

    Parameters
    ----------
    matrix : (n, n)
        Of any units; not changed.
    """

    def __init__(self, matrix: csc_matrix):
        self.scale = 1.0 / np.sqrt(np.maximum(abs(matrix).max(axis=0).toarray().ravel(), 1e-300))
        self.matrix = csc_matrix(
            matrix.multiply(self.scale[:, None]).multiply(self.scale[None, :]))
        try:
            self.factors = splu(self.matrix)
        except RuntimeError:        # a pivot is exactly zero
            self.factors = None

    @property
    def regular(self) -> bool:
        """Whether no pivot is too small to be trusted."""
        if self.factors is None:
            return False
        pivots = np.abs(self.factors.U.diagonal())
        return bool(pivots.min() >= SINGULAR * pivots.max())

    @property
    def weakest(self) -> int | None:
        """The unknown of the smallest pivot, None if a pivot is exactly zero."""
        if self.factors is None:
            return None
        pivot = int(np.argmin(np.abs(self.factors.U.diagonal())))
        return int(np.argsort(self.factors.perm_c)[pivot])

    def solve(self, right: NDArray) -> NDArray:
        """Solution by the factors."""
        return self.scale * self.factors.solve(self.scale * right)

    def least(self, right: NDArray) -> tuple[NDArray, NDArray]:
        """Solution of least norm by dense algebra, and the scaled residuals that remain."""
        demand = self.scale * right
        answer = np.linalg.lstsq(self.matrix.toarray(), demand, rcond=1e-11)[0]
        return self.scale * answer, np.abs(self.matrix @ answer - demand)
