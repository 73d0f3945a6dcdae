"""Motions without mass, which follow the others statically.

Lumped masses have no rotary inertia, MacNeal's bodies no mass of the boundary: of motions N with
``M N = 0`` the equations are ``N^T K x = 0``. With the others P, ``x = T y``,
``T = P - N (N^T K N)^-1 N^T K P``, the vibrations are those of ``P^T K T`` and ``P^T M P``, as in
R.J. Guyan, AIAA J. 3, 1965. Other frequencies are infinite.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

MASSLESS = 1e-12    # eigenvalue of the unit-free mass, relative to the largest
_BARE = 1e-12       # the same of the stiffness of motions without mass


class Condensed(NamedTuple):
    """Matrices without the motions that have no mass.

    Parameters
    ----------
    mass, stiffness, damping : (m, m)
    motions : (n, m)
        Of the coordinates before.
    following : int
        Number of motions without mass that follow statically.
    bare : int
        Number of motions that have neither mass nor stiffness; they are left out.
    """

    mass: NDArray
    stiffness: NDArray
    damping: NDArray
    motions: NDArray
    following: int
    bare: int


def condensed(mass: NDArray, stiffness: NDArray, damping: NDArray | None = None) -> Condensed:
    """Matrices (n, n) without the motions that have neither mass nor damping."""
    size = units(mass, stiffness)
    scaled = [np.zeros_like(mass) if matrix is None else matrix / np.outer(size, size)
              for matrix in (mass, stiffness, damping)]
    M, K, C = scaled
    values, vectors = np.linalg.eigh((M + M.T) / 2)
    without = values <= MASSLESS * np.abs(values).max(initial=0.0)
    if not without.any():
        return Condensed(mass, stiffness, np.zeros_like(mass) if damping is None else damping,
                         np.eye(len(mass)), 0, 0)
    N, P = vectors[:, without], vectors[:, ~without]
    inertia = np.diag(values[~without])
    if C.any():
        turn, damped, _ = np.linalg.svd(np.hstack([N.T @ C, N.T @ C.T]))
        slow = np.arange(N.shape[1]) < np.sum(damped > MASSLESS * np.abs(C).max())
        N, P = N @ turn[:, ~slow], np.hstack([P, N @ turn[:, slow]])
        inertia = np.pad(inertia, (0, slow.sum()))      # zero: rounding would make them vibrate
    own = N.T @ K @ N
    left, singular, right = np.linalg.svd(own)
    stiff = singular > _BARE * max(np.abs(K).max(initial=0.0), np.finfo(float).tiny)
    inverse = right[stiff].T / singular[stiff] @ left[:, stiff].T
    T = P - N @ (inverse @ (N.T @ K @ P))
    return Condensed(inertia, P.T @ K @ T, P.T @ C @ P, T / size[:, None],
                     int(stiff.sum()), int(np.sum(~stiff)))


def units(mass: NDArray, stiffness: NDArray) -> NDArray:
    """Unit of each coordinate, (n,), of its stiffness and its mass: either may be rounding alone.

    With the usual ratio of stiffness to mass a mass that is rounding stays small.
    """
    k, m = np.abs(np.diag(stiffness)), np.abs(np.diag(mass))
    both = (k > 0) & (m > 0)
    size = np.sqrt(k + (float(np.median(k[both] / m[both])) if both.any() else 1.0) * m)
    size[size == 0] = 1.0
    return size


def inert(mass: NDArray, rigid: NDArray) -> int:
    """Number of rigid motions (n, r) that have inertia; a bar has none about its axis."""
    inertia = rigid.T @ mass @ rigid
    unit = np.sqrt(np.abs(np.diag(inertia)))
    unit[unit == 0] = 1.0
    return int(np.linalg.matrix_rank(inertia / np.outer(unit, unit), tol=MASSLESS))
