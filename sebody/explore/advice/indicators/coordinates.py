"""Displacements of nodes as boundary coordinates of a body, and back."""

import numpy as np
from numpy.typing import NDArray

from sebody.reduction.body import ReducedBody


def flat(body: ReducedBody, shifts: NDArray, turns: NDArray) -> NDArray:
    """Displacements (n, k, d) and rotations (n, k, r) of nodes as coordinates, (n, boundary)."""
    n = len(shifts)
    return np.hstack([shifts[:, list(body.position_nodes)].reshape(n, -1),
                      turns[:, list(body.rotation_nodes)].reshape(n, -1)])


def nodal(body: ReducedBody, coordinates: NDArray) -> tuple[NDArray, NDArray]:
    """The inverse of `flat`; zero where a body keeps none."""
    n, nodes, d = len(coordinates), len(body.keeps), body.coordinates.shape[1]
    r, first = 1 if d == 2 else 3, d * len(body.position_nodes)
    shifts, turns = np.zeros((n, nodes, d)), np.zeros((n, nodes, r))
    shifts[:, list(body.position_nodes)] = coordinates[:, :first].reshape(n, -1, d)
    turns[:, list(body.rotation_nodes)] = coordinates[:, first:].reshape(n, -1, r)
    return shifts, turns


def compliance(body: ReducedBody) -> NDArray:
    """Compliance of the free boundary, for forces in balance: pseudo-inverse of its stiffness."""
    n = len(body.stiffness) - body.modes
    return np.linalg.pinv(body.stiffness[:n, :n], rcond=1e-12, hermitian=True)
