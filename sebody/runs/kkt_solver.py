"""Solution of scaled sparse systems, outside the loop."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgetrf, dgetrs
from scipy.sparse import block_array, csc_matrix, diags, eye_array
from scipy.sparse.csgraph import structural_rank
from scipy.sparse.linalg import SuperLU, splu

from sebody.engine.regularization import LIGHT
from sebody.engine.system import System

SMALL = 100         # unknowns up to which LAPACK takes less time than SciPy to call SuperLU
SINGULAR = 1e-13    # smallest pivot of a regular matrix, relative to the largest
SUSPICIOUS = 1e-6   # pivot below which constraints are looked into, relative to the largest
ROUNDING = 1e-15    # of sums of entries of about one
REGULARIZATION = 1e-8   # of regularized matrices as in the engine, but never of an older state
ATTEMPTS = 20       # refinements: each leaves 2 REGULARIZATION / s of a part of strength s
DAMPED = 1e-8       # parts that are weaker, relative to the largest entry, are none
SETTLED = 1e-15     # change of the last refinement, relative to the solution


def factors(matrix: csc_matrix, **options: object) -> SuperLU:
    """Factors by SuperLU with its options.

    Raises
    ------
    RuntimeError
        A pivot is exactly zero. Of a matrix whose pattern is singular SuperLU would read beyond its
        arrays; one with a stored diagonal, zeros included, is not.
    """
    n = matrix.shape[0]
    stored = np.count_nonzero(matrix.indices == np.repeat(np.arange(n), np.diff(matrix.indptr)))
    if stored < n and structural_rank(matrix) < n:
        raise RuntimeError("the pattern is singular")
    return splu(matrix, **options)


class _Dense:
    """Factors of a small matrix."""

    def __init__(self, matrix: NDArray):
        self._factors, self._exchanges, zero = dgetrf(matrix, overwrite_a=True)
        if zero:
            raise RuntimeError("a pivot is exactly zero")
        self.pivots = np.abs(self._factors.diagonal())

    def solve(self, right: NDArray) -> NDArray:
        return dgetrs(self._factors, self._exchanges, right)[0]


class _Sparse:
    """Factors of a large one; pivots in the order of elimination."""

    def __init__(self, matrix: csc_matrix):
        self._factors = factors(matrix)
        self.solve = self._factors.solve

    @cached_property
    def pivots(self) -> NDArray:
        return np.abs(self._factors.U.diagonal())


class Scaled:
    """A matrix with symmetrically scaled rows and columns, and its factors if it has any.

    Parameters
    ----------
    matrix : (n, n)
        Of any units; not changed.
    units : (n,), optional
        Factors of rows and columns before they are scaled by their largest entries.
    """

    def __init__(self, matrix: csc_matrix, units: NDArray | None = None):
        if not matrix.has_canonical_format:
            matrix = matrix.copy()
            matrix.sum_duplicates()
        row, across = matrix.indices, matrix.shape[1]
        column = np.repeat(np.arange(across), np.diff(matrix.indptr))
        units = np.ones(across) if units is None else units
        largest = np.zeros(across)
        np.maximum.at(largest, column, np.abs(matrix.data) * units[row] * units[column])
        self.scale = units / np.sqrt(np.maximum(largest, 1e-300))
        # on the entries: for a few bodies SciPy's products take ten times as long as their numbers
        self._entries, self._pattern = matrix.data * self.scale[row] * self.scale[column], matrix
        try:
            if across <= SMALL:
                dense = np.zeros((across, across), order="F")
                dense[row, column] = self._entries
                self.factors: _Dense | _Sparse | None = _Dense(dense)
            else:
                self.factors = _Sparse(self.matrix)
        except RuntimeError:        # a pivot is exactly zero
            self.factors = None

    @cached_property
    def matrix(self) -> csc_matrix:
        """The scaled matrix."""
        pattern = self._pattern
        return csc_matrix((self._entries, pattern.indices, pattern.indptr), shape=pattern.shape)

    @cached_property
    def regular(self) -> bool:
        """Tell whether no pivot is too small to be trusted."""
        return self._pivots_above(SINGULAR)

    @cached_property
    def suspicious(self) -> bool:
        """Tell whether a pivot is so small that constraints may be redundant."""
        return not self._pivots_above(SUSPICIOUS)

    def _pivots_above(self, share: float) -> bool:
        if self.factors is None:
            return False
        pivots = self.factors.pivots
        return bool(pivots.min() >= share * pivots.max())

    def solve(self, right: NDArray) -> NDArray:
        """Solution by the factors."""
        assert self.factors is not None     # of a regular matrix
        return self.scale * self.factors.solve(self.scale * right)

    def least(self, right: NDArray) -> tuple[NDArray, NDArray]:
        """Solution of least norm, and the scaled residuals that remain."""
        demand = self.scale * right
        if len(right) <= SMALL:
            answer = np.linalg.lstsq(self.matrix.toarray(), demand, rcond=1e-11)[0]
        else:
            answer = LeastSquares(self.matrix).solve(demand)
        return self.scale * answer, np.abs(self.matrix @ answer - demand)


class LeastSquares:
    """Least squares of least norm, by factors of a sparse matrix.

    ``|A x - b|^2 + DAMPED^2 |x - x_0|^2`` is least where

        [DAMPED  A     ] [y      ]   [b - A x_0]
        [A^T    -DAMPED] [x - x_0] = [0        ]

    a matrix whose condition is 1 / DAMPED. Repeated from x = 0, a part of strength s of A is left
    by the factor ``DAMPED^2 / (s^2 + DAMPED^2)`` (K. Riley, Math. Tables and Other Aids to
    Computation 9, 1955, p. 96).
    """

    def __init__(self, matrix: csc_matrix):
        self.matrix, damped = matrix, DAMPED * eye_array(matrix.shape[0])
        self._factors = factors(csc_matrix(block_array([[damped, matrix], [matrix.T, -damped]])))

    def solve(self, right: NDArray) -> NDArray:
        """The solution, of what A can make of the right side.

        What A cannot make is part of every residual, and what rounding makes of this part grows by
        1 / DAMPED^2. So it is left out before the right side is solved for.
        """
        return self._refined(self.matrix @ self._refined(right))

    def _refined(self, right: NDArray) -> NDArray:
        n = len(right)
        answer = np.zeros(n)
        for _ in range(ATTEMPTS):
            change = self._factors.solve(np.append(right - self.matrix @ answer, np.zeros(n)))[n:]
            answer += change
            if np.abs(change).max() <= SETTLED * np.abs(answer).max():
                break
        return answer


def _symmetric(matrix: csc_matrix) -> SuperLU:
    """Factors without exchanges of rows."""
    return splu(csc_matrix(matrix), permc_spec="NATURAL", diag_pivot_thresh=0.0,
                options={"SymmetricMode": True})


class Relaxed:
    """A singular matrix of masses and constraints, by regularized factors.

    See `sebody.engine.regularization`. The system says which unknowns are
    multipliers, which belong together and about which axes bodies have nearly no inertia.

    Parameters
    ----------
    matrix : (n, n)
    sizes : (n,)
        Of the matrix at every position and rotation; not read at multipliers.
    system : System
    """

    def __init__(self, matrix: csc_matrix, sizes: NDArray, system: System):
        n = len(sizes)
        self.matrix, sizes, part = csc_matrix(matrix), sizes.copy(), system.part[:n]
        multipliers = np.flatnonzero(system.is_multiplier[:n])
        held = 1.0 / sizes
        held[multipliers] = 0.0
        largest = np.zeros(n)
        np.maximum.at(largest, part[multipliers], (self.matrix.power(2) @ held)[multipliers])
        sizes[multipliers] = largest[part[multipliers]]
        sizes[sizes == 0.0] = 1.0
        self.scale = 1.0 / np.sqrt(sizes)
        self.regularization = LIGHT * system.massless_axes[:n]
        self.regularization[multipliers] = -REGULARIZATION * sizes[multipliers]
        scaled = diags(self.scale) @ (self.matrix + diags(self.regularization)) @ diags(self.scale)
        try:
            self.factors = _symmetric(scaled)
        except RuntimeError:    # a motion without mass; of pivots more is rounding than of entries
            self.factors = _symmetric(scaled + diags(np.where(system.is_multiplier[:n], 0.0,
                                                              ROUNDING / REGULARIZATION)))

    @property
    def pivots(self) -> NDArray:
        """Pivots of the scaled matrix: of a redundant constraint REGULARIZATION."""
        return np.abs(self.factors.U.diagonal())

    def unmoved(self, vector: NDArray) -> NDArray:
        """The part of (n,) or (n, k), in scaled unknowns, on which the matrix does not act."""
        return self.factors.solve(((self.scale**2 * self.regularization) * vector.T).T)

    def least(self, right: NDArray) -> tuple[NDArray, NDArray]:
        """Solution of least norm, and the scaled residuals that remain."""
        answer = np.zeros(len(right))
        for _ in range(ATTEMPTS):
            correction = self._solve(right - self.matrix @ answer)
            correction -= self._solve(self.regularization * correction)
            answer += correction
            if np.abs(correction / self.scale).max() <= SETTLED * np.abs(answer / self.scale).max():
                break
        return answer, np.abs(self.scale * (right - self.matrix @ answer))

    def _solve(self, right: NDArray) -> NDArray:
        return self.scale * self.factors.solve(self.scale * right)
