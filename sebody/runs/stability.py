"""Stability of equilibria: whether a motion that the constraints allow has a negative stiffness.

The symmetric stiffness K of the unknowns x, with the constraints ``G x = 0``, is scaled so that its
diagonal is one. A state is stable where

    K + PENALTY G^T G + shift

has a Cholesky factorization, or, where constraints that give way by the penalty mislead this, where
the softest motion, found by inverse iteration with exact constraints, has no negative stiffness.
The shift is what rounding makes of zero, such as the stiffness against a rod that spins between
ball joints, and `SOFT` of the inertias times the square of the pace at which loads move the
structure. Loads that follow the structure have no potential and an unsymmetric tangent: of these
nothing is said.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpotrf
from scipy.sparse import block_array, csc_matrix, diags_array
from scipy.sparse.linalg import splu

from sebody.runs.simulation import Simulation

PENALTY = 1e3           # stiffness of constraints, relative to that of the unknowns
ROUNDED = 1e-13         # scaled stiffness that may be rounding
SOFT = 1e-7             # square of a rate that counts as zero, relative to that of the pace
FOLLOWING = 1e-8        # part of a tangent that is not symmetric, relative to its largest entry
SMALL = 150             # unknowns up to which LAPACK takes less time than SciPy to call SuperLU
GIVING = 1e-12          # of constraints in the inverse iteration
ITERATIONS = 30         # of the inverse iteration
DENSEST = 1e15          # shift beyond which a matrix has no numbers


class Softest(NamedTuple):
    """The motion with the least stiffness."""

    stiffness: float    # scaled, of a motion of norm one
    motion: NDArray     # (unknowns,)


class Stiffness:
    """The stiffness of a state in all motions that its constraints allow.

    Parameters
    ----------
    run : Simulation
    tangent : (n, n)
        Of all unknowns; its symmetric part is taken.
    unit : float
        Square of the pace of the loads [1/time^2].
    """

    def __init__(self, run: Simulation, tangent: csc_matrix, unit: float):
        n = tangent.shape[0]
        held = run.system.is_multiplier[:n] > 0.0
        self._free = np.flatnonzero(~held)
        inertias = unit * run.system.inertias[:n]
        size = np.maximum(np.abs(tangent.diagonal()), inertias)
        size[held | (size <= 0.0)] = 1.0
        self._scale, self._tangent = 1.0 / np.sqrt(size), tangent
        self._shift = (ROUNDED + SOFT * inertias / size)[self._free]
        # entries by NumPy: SciPy's products take longer than the factors of a small structure
        rows, columns = tangent.indices, np.repeat(np.arange(n), np.diff(tangent.indptr))
        values = tangent.data * self._scale[rows] * self._scale[columns]
        place = np.cumsum(np.where(held, 0, 1)) - 1
        moved, motion = ~held[rows] & ~held[columns], held[rows] & ~held[columns]
        shape = len(self._free), len(self._free)
        one, other, half = place[rows[moved]], place[columns[moved]], values[moved] / 2.0
        self._K = csc_matrix((np.append(half, half), (np.append(one, other),
                                                      np.append(other, one))), shape=shape)
        equation = (np.cumsum(held) - 1)[rows[motion]]
        strength = np.bincount(equation, values[motion]**2, n - len(self._free))
        strength[strength == 0.0] = 1.0
        self._G = csc_matrix((values[motion] / np.sqrt(strength[equation]),
                              (equation, place[columns[motion]])), shape=(len(strength), shape[1]))

    @cached_property
    def follows(self) -> bool:
        """Tell whether loads follow the structure, or friction holds it: no potential."""
        scaled = csc_matrix(diags_array(self._scale) @ self._tangent @ diags_array(self._scale))
        odd = abs(scaled - scaled.T)
        return bool(odd.max() > FOLLOWING * abs(scaled).max())

    def surely_stable(self) -> bool:
        """Tell whether no motion has a negative stiffness though constraints give way a little."""
        return bool(np.isfinite(self._K.data).all()) and self._positive(self._shift)

    def stiff(self) -> bool:
        """Tell whether all motions have a positive stiffness, which is more than rounding."""
        return bool(np.isfinite(self._K.data).all()) and self._positive(-self._shift)

    def stable(self) -> bool:
        """Tell whether no motion has a negative stiffness."""
        if self.surely_stable():
            return True
        if not np.isfinite(self._K.data).all():
            return False
        softest = self.softest()
        own = (softest.motion / self._scale)[self._free]
        return bool(softest.stiffness >= -(self._shift @ own**2) / (own @ own))

    def softest(self) -> Softest:
        """The motion whose scaled stiffness is least, by inverse iteration."""
        shift = ROUNDED
        while not self._positive(np.full(len(self._shift), shift)) and shift < DENSEST:
            shift *= 4.0
        n, m = len(self._shift), self._G.shape[0]
        matrix = self._K + shift * diags_array(np.ones(n))
        if m:
            giving = diags_array(np.full(m, -GIVING))
            matrix = block_array([[matrix, self._G.T], [self._G, giving]])
        factors = splu(csc_matrix(matrix))
        motion = np.random.default_rng(1).standard_normal(n)
        for _ in range(ITERATIONS):
            motion = factors.solve(np.append(motion, np.zeros(m)))[:n]
            motion /= np.linalg.norm(motion)
        full = np.zeros(len(self._scale))
        full[self._free] = motion * self._scale[self._free]
        return Softest(float(motion @ (self._K @ motion)), full)

    @cached_property
    def _penalized(self) -> csc_matrix:
        return csc_matrix(self._K + PENALTY * (self._G.T @ self._G))

    def _positive(self, shift: NDArray) -> bool:
        """Tell whether the matrix with this on its diagonal is positive definite."""
        if len(shift) <= SMALL:
            whole = self._penalized.toarray()
            whole[np.diag_indices(len(whole))] += shift
            return bool(dpotrf(whole, overwrite_a=True)[1] == 0)
        try:
            factors = splu(csc_matrix(self._penalized + diags_array(shift)),
                           permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
                           options={"SymmetricMode": True})
        except RuntimeError:        # a pivot is exactly zero
            return False
        return bool(np.array_equal(factors.perm_r, factors.perm_c)
                    and factors.U.diagonal().min() > 0.0)
