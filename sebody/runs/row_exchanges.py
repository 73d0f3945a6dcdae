"""Factors with row exchanges, where the elimination in the loop meets a small pivot."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags

from sebody.assembly.evaluation import assembled
from sebody.engine.matrix import sum_matrices
from sebody.engine.regularization import PROJECTIONS, REGULARIZATION, regularize
from sebody.engine.state import FACTORED, PROJECTED, SOLVED, State
from sebody.engine.system import System
from sebody.runs.kkt_solver import SINGULAR, Scaled, factors
from sebody.runs.redundancy import least

THRESHOLD = 0.01        # pivots on the diagonal are kept down to this share of the largest


class RowExchanges:
    """Factors of the iteration matrix by SuperLU; of a singular one, regularized."""

    def __init__(self, system: System, state: State):
        self.system, self.state = system, state
        self._factors = None
        self._solver: Callable[[NDArray], NDArray] | None = None    # of a restart

    def serve(self) -> None:
        """Factorize or solve if the loop waits for it, perhaps since an interrupted call."""
        phase = self.state.control.phase
        if phase == FACTORED:
            self.factorize()
        elif phase in (PROJECTED, SOLVED):
            self.solve()

    def factorize(self) -> None:
        """Factorize the sum in `State.matrix`."""
        self._solver = None
        if self.state.control.restart:
            self._solver = self._of_masses()
        elif not self._factorized():
            regularize(self.system, self.state, REGULARIZATION)
            self._factorized()

    def solve(self) -> None:
        """Solve for the correction from the residual."""
        n, state = self.system.diagonal.size, self.state
        if self._solver is not None:
            state.correction[:n] = self._solver(state.residual[:n].copy())
            return
        correction = self._solved(state.residual[:n])
        if state.control.regularized:
            for _ in range(PROJECTIONS):
                correction -= self._solved(state.regularization[:n] * self.system.is_multiplier[:n]
                                           * correction)
        state.correction[:n] = correction

    def _of_masses(self) -> Callable[[NDArray], NDArray]:
        """What solves for accelerations and multipliers, of least norm where they are not unique.

        Some motions have stiffness and no mass, as of MacNeal's bodies. They are combinations of
        coordinates, so what a factor divides by is rounding. They get no acceleration, and
        stiffness alone places them from the next step on.
        """
        sum_matrices(self.system, self.state, self.state.forces)
        masses = assembled(self.system, self.state)
        if self.system.regularized[0]:
            return least(masses, self.system)
        scaled = Scaled(masses)
        return scaled.solve if scaled.regular else lambda right: scaled.least(right)[0]

    def _factorized(self) -> bool:
        """Whether the matrix is regular."""
        scale = diags(self.state.scale[:self.system.diagonal.size])
        matrix = csc_matrix(scale @ assembled(self.system, self.state) @ scale)
        try:
            factors_of_it = factors(matrix, permc_spec="NATURAL", diag_pivot_thresh=THRESHOLD)
        except RuntimeError:
            self._factors = None
            return False
        self._factors = factors_of_it
        pivots = np.abs(factors_of_it.U.diagonal())
        return bool(pivots.min() >= SINGULAR * pivots.max())

    def _solved(self, right: NDArray) -> NDArray:
        if self._factors is None:
            return np.full(right.size, np.nan)      # the step fails
        scale = self.state.scale[:right.size]
        return scale * self._factors.solve(scale * right)
