"""Factors with row exchanges, where the elimination in the loop meets a small pivot."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags

from sebody.analysis.evaluation import assembled
from sebody.analysis.sparse import SINGULAR, factors
from sebody.engine.relaxation import PROJECTIONS, RELAXATION, relax
from sebody.engine.state import RELAXED, State
from sebody.engine.system import System

THRESHOLD = 0.01        # pivots on the diagonal are kept down to this share of the largest


class RowExchanges:
    """Factors of the iteration matrix by SuperLU; of a singular one, regularized."""

    def __init__(self, system: System, state: State):
        self.system, self.state = system, state
        self._factors = None

    def factorize(self) -> None:
        """Factorize the sum in `State.matrix`."""
        if not self._factorized():
            relax(self.system, self.state, RELAXATION)
            self._factorized()

    def solve(self) -> None:
        """Solve for the correction from the residual."""
        n, state = self.system.diagonal.size, self.state
        correction = self._solved(state.residual[:n])
        if state.control[RELAXED]:
            for _ in range(PROJECTIONS):
                correction -= self._solved(state.relaxation[:n] * self.system.is_multiplier[:n]
                                           * correction)
        state.correction[:n] = correction

    def _factorized(self) -> bool:
        """Whether the matrix is regular."""
        scale = diags(self.state.scale[:self.system.diagonal.size])
        matrix = csc_matrix(scale @ assembled(self.system, self.state) @ scale)
        try:
            self._factors = factors(matrix, permc_spec="NATURAL", diag_pivot_thresh=THRESHOLD)
        except RuntimeError:
            self._factors = None
            return False
        pivots = np.abs(self._factors.U.diagonal())
        return bool(pivots.min() >= SINGULAR * pivots.max())

    def _solved(self, right: NDArray) -> NDArray:
        if self._factors is None:
            return np.full(right.size, np.nan)      # the step fails
        scale = self.state.scale[:right.size]
        return scale * self._factors.solve(scale * right)
