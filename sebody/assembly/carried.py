"""Constants of option D in the order of its kernels, from the reduced matrices."""

import numpy as np
from numpy.typing import ArrayLike

from sebody.reduction import ReducedBody

_MASSLESS = 1e-13   # moment of inertia that is rounding, relative to the largest


def carried_constants(body: ReducedBody) -> dict[str, ArrayLike]:
    """Values by name.

    Displacements are split into rigid ones and a rest, orthogonal in the mass: ``Gam = J_c^-1
    y_r^T Mbar`` with the rigid rotations y_r about the centre of mass. About an axis without
    inertia a body has no rigid part, as if it did not rotate.
    """
    n, dimension = len(body.mass), body.coordinates.shape[1]
    of_rigid = body.mass @ body.rigid_modes_about(body.centre_of_mass)
    translations, rotations = of_rigid[:, :dimension], of_rigid[:, dimension:]
    J = rotations.T @ body.rigid_modes_about(body.centre_of_mass)[:, dimension:]
    J = (J + J.T) / 2
    moments, axes = np.linalg.eigh(J)
    kept = moments > _MASSLESS * max(moments.max(), 0.0)
    angles = axes[:, kept] / moments[kept] @ axes[:, kept].T @ rotations.T
    rows = np.vstack([translations.T, angles])
    pairs = ((0, 0),) if body.planar else ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    damping = np.zeros((n, 0)) if body.damping is None else body.damping
    return {"columns": [damping.shape[1]], "Jc": [J[pair] for pair in pairs], "rigid_rows": rows,
            "rigid_columns": rows.T, "C": damping}
