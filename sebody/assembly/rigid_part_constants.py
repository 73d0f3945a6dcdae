"""Constants of option D in the order of its kernels, from the reduced matrices."""

import numpy as np
from numpy.typing import ArrayLike

from sebody.reduction.body import ReducedBody
from sebody.reduction.mean_rotation import central_inertia, mean_rotation


def rigid_part_constants(body: ReducedBody) -> dict[str, ArrayLike]:
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
