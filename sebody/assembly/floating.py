"""Constants of option C in the order of its kernels, from the body's integrals."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.reduction.invariants import InertiaInvariants


def floating_constants(invariants: InertiaInvariants) -> dict[str, ArrayLike]:
    """Values by name; the integrals are about the origin of the frame."""
    i = invariants
    axes = len(i.J0)
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)) if axes == 3 else ((0, 0),)
    moments = np.vstack([i.S1, i.g, *(i.h[r, c] + i.h[c, r] for r, c in pairs)])
    across = i.K.transpose(0, 2, 1)
    blocks = [*(i.J2[pair] for pair in pairs), *across, *(across - i.K)]
    return {"sizes": [i.slaved, i.resultants], "c0": i.c0, "J0": [i.J0[pair] for pair in pairs],
            "moment_columns": moments.T, "moment_rows": moments, "Mz": i.Mbar,
            "quadratics": _by_columns(blocks, len(i.Mbar)),
            "followers": _by_columns(i.Q, len(i.E)), "lam": i.lam, "E": i.E,
            "Ghat": _by_columns(i.Ghat, len(i.E))}


def _by_columns(matrices: ArrayLike, n: int) -> NDArray:
    """First columns of all matrices, then their second ones, and so on."""
    stack = np.asarray(matrices).reshape(-1, n, n)
    return stack.transpose(1, 2, 0).reshape(n, -1)
