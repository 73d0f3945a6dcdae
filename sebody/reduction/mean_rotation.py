"""The mean rotation of a body's local coordinates, weighted by mass."""

import numpy as np
from numpy.typing import NDArray

from sebody.reduction.body import ReducedBody

MASSLESS = 1e-13    # moment of inertia that is rounding, relative to the largest


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
    massive = moments > MASSLESS * max(moments.max(), 0.0)
    return axes[:, massive] / moments[massive] @ axes[:, massive].T @ _rotations(body).T @ body.mass


def _rotations(body: ReducedBody) -> NDArray:
    """Rigid rotations about the centre of mass, (n, r)."""
    return body.rigid_modes_about(body.centre_of_mass)[:, body.coordinates.shape[1]:]
