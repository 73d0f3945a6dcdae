"""Rotation matrices and vectors by SciPy, loaded at first use: its import takes 0.15 s."""

import numpy as np
from numpy.typing import NDArray


def matrices(vectors: NDArray) -> NDArray:
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3); of one vector one matrix."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(vectors).as_matrix()


def vectors(matrices: NDArray) -> NDArray:
    """Rotation vectors (n, 3), no longer than pi, of rotation matrices (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(matrices).as_rotvec()


def nearest(matrices: NDArray) -> NDArray:
    """Rotations that are nearest to matrices, (..., d, d)."""
    U, _, Vt = np.linalg.svd(matrices)
    U[..., -1] *= np.linalg.det(U @ Vt)[..., None]
    return U @ Vt
