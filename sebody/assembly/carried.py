"""Constants of option D in the order of its kernels, from the reduced matrices."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.reduction import ReducedBody

_MASSLESS = 1e-13   # moment of inertia that is rounding, relative to the largest


def central_inertia(body: ReducedBody) -> NDArray:
    """Moments of inertia about the centre of mass at rest, (r, r)."""
    rotations = _rotations(body)
    J = rotations.T @ body.mass @ rotations
    return (J + J.T) / 2


def mean_rotation(body: ReducedBody) -> NDArray:
    """Rows of the mean rotation of local coordinates, ``Gam = J_c^-1 y_r^T Mbar``, (r, n).

    With the rigid rotations y_r about the centre of mass. About an axis without inertia a body has
    no mean rotation, as if it did not rotate.
    """
    moments, axes = np.linalg.eigh(central_inertia(body))
    kept = moments > _MASSLESS * max(moments.max(), 0.0)
    return axes[:, kept] / moments[kept] @ axes[:, kept].T @ _rotations(body).T @ body.mass


def _rotations(body: ReducedBody) -> NDArray:
    """Rigid rotations about the centre of mass, (n, r)."""
    return body.rigid_modes_about(body.centre_of_mass)[:, body.coordinates.shape[1]:]


def carried_constants(body: ReducedBody) -> dict[str, ArrayLike]:
    """Values by name.

    Displacements are split into rigid ones and a rest, orthogonal in the mass.
    """
    n, dimension = len(body.mass), body.coordinates.shape[1]
    translations = body.mass @ body.rigid_modes[:, :dimension]
    J = central_inertia(body)
    rows = np.vstack([translations.T, mean_rotation(body)])
    pairs = ((0, 0),) if body.planar else ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    damping = np.zeros((n, 0)) if body.damping is None else body.damping
    return {"columns": [damping.shape[1]], "Jc": [J[pair] for pair in pairs], "rigid_rows": rows,
            "rigid_columns": rows.T, "C": damping}
