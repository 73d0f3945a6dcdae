"""PARDISO of Intel's MKL in the place of SuperLU, where the package pypardiso is installed.

O. Schenk and K. Gärtner, Future Generation Computer Systems 20, 2004. The package is looked for and
never needed: MKL's licence is its own.
"""

from weakref import finalize

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

_SYMMETRIC = 2      # PARDISO's type of real symmetric positive definite matrices


class Pardiso:
    """Factors of a symmetric positive definite matrix (n, n), both triangles.

    Raises
    ------
    ImportError, OSError
        Without pypardiso, or without the libraries of MKL.
    ValueError
        A matrix that is not positive definite.
    """

    def __init__(self, matrix: sparse.csc_array):
        from pypardiso import PyPardisoSolver

        upper = sparse.csr_matrix(sparse.triu(matrix, format="csr"))
        upper.sort_indices()
        self._upper, self._solver = upper, PyPardisoSolver(mtype=_SYMMETRIC)
        finalize(self, self._solver.free_memory, everything=True)   # MKL holds it, not NumPy
        self._solver.factorize(upper)

    def solve(self, forces: NDArray) -> NDArray:
        """Solutions of right-hand sides (n, k)."""
        return self._solver.solve(self._upper, np.asfortranarray(forces))
