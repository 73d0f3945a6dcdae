"""Friction that slides under forces of constraints, in small motion without multipliers."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import orth

WORKLESS = 1e-12    # of its parts: work of constraints alone, which is rounding


def without_multipliers(free: NDArray, G: NDArray, columns: NDArray) -> NDArray:
    """Motions (n, r) on which multipliers do no work, for motions `free` that constraints G allow.

    Constraints alone do no work on `free` itself. Friction that slides has forces by what presses,
    which multipliers say: its share of their columns K_l does work there. The motions are
    ``free - G^T V y``, where V spans the multipliers of independent equations, such that

        (free - G^T V y)^T K_l V = 0

    Parameters
    ----------
    G : (m, n)
    columns : (n, m)
        Derivatives of the forces by the multipliers.
    """
    work = free.T @ columns
    parts = np.abs(free).T @ np.abs(columns)
    if not np.abs(work).max(initial=0.0) > WORKLESS * parts.max(initial=0.0):
        return free
    V = orth(G)
    y = np.linalg.solve((V.T @ G @ columns @ V).T, (work @ V).T)
    return free - G.T @ (V @ y)
