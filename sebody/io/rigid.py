"""Forces of rigid motion of an FE model, which a free one does not resist."""

import numpy as np

from sebody.fem.model import FEModel
from sebody.reduction.rigid_motions import rigid_motions


def rigid_residual(model: FEModel) -> float:
    """Largest force of a row under rigid motion, over what its entries would make without signs.

    Rounding of d printed digits leaves some ``10^-d``; a support leaves one.
    """
    count, dimension = model.coordinates.shape
    present = model.rows >= 0
    turning = present.shape[1] > dimension
    keeps = ("full" if turning else "translation",) * count
    middle = model.coordinates.mean(axis=0)
    by_kinds = rigid_motions(model.coordinates, keeps, present.size, middle)
    moves, turns = np.split(by_kinds, [count * dimension])
    by_nodes = np.concatenate([part.reshape(count, -1, by_kinds.shape[1])
                               for part in (moves, turns)], axis=1)
    motions = np.zeros((len(model.stiffness.indptr) - 1, by_kinds.shape[1]))
    motions[model.rows[present]] = by_nodes[present]
    # lengths over the size of the body: rotations of nodes and their displacements are alike
    size = np.ones(len(motions))
    size[model.rows[:, :dimension][present[:, :dimension]]] = model.extent or 1.0
    forces = np.abs(model.stiffness @ motions)
    largest = np.max(np.abs(motions) / size[:, None], axis=0)
    without_signs = (abs(model.stiffness) @ size)[:, None] * largest
    return float(np.max(forces / np.maximum(without_signs, 1e-300), initial=0.0))
