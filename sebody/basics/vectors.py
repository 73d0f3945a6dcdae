"""Cross products of arrays of vectors, in space and in a plane."""

import numpy as np
from numpy.typing import NDArray


def skew(vectors: NDArray) -> NDArray:
    """Matrices (..., 3, 3) of the cross products ``v x`` with vectors (..., 3)."""
    found = np.zeros((*vectors.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[..., k, j], found[..., j, k] = vectors[..., i], -vectors[..., i]
    return found


def cross(spins: NDArray, vectors: NDArray) -> NDArray:
    """``w x r`` of spins (..., 3), in a plane (..., 1), and vectors (..., D)."""
    if spins.shape[-1] == 1:
        return spins * np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)
    return np.cross(spins, vectors)


def axes_cross(vectors: NDArray) -> NDArray:
    """``e_k x`` the columns of (D, m), for every axis of rotation: (r, D, m)."""
    if len(vectors) == 2:
        return np.array([[-vectors[1], vectors[0]]])
    return np.cross(np.eye(3)[:, :, None], vectors[None], axisa=1, axisb=1, axisc=1)


def moment_of(arms: NDArray, forces: NDArray) -> NDArray:
    """``r x f`` of arms and forces (..., 3), in a plane (..., 2) about its normal, (..., 1)."""
    if arms.shape[-1] == 2:
        return (arms[..., 0] * forces[..., 1] - arms[..., 1] * forces[..., 0])[..., None]
    return np.cross(arms, forces)
