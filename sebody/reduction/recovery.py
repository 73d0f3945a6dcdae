"""Displacements inside a body from its reduced coordinates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag


@dataclass(frozen=True, eq=False)
class Recovery:
    """Shapes of the FE model: displacements ``Phi y + Psi eta`` in the axes of the body.

    Parameters
    ----------
    shapes : (n_nodes k, N)
        Node after node, 0 for DOFs that a node does not have: of the n reduced coordinates, then
        of those that follow them in second order.
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        FE nodes [length].
    node_dofs : tuple of str
        The k DOFs of one node in order, as in `FEModel`.
    """

    shapes: NDArray
    coordinates: NDArray
    node_dofs: tuple[str, ...]

    def rotated(self, rotation: NDArray, by: NDArray) -> "Recovery":
        """The body rotated about the FE origin by (D, D), in the old axes; y becomes ``by @ y``."""
        n, angles = len(by), sum(name.startswith("r") for name in self.node_dofs)
        axes = {0: [], 1: [np.eye(1)], 3: [rotation]}[angles]
        turn = block_diag(rotation, *axes)
        shapes = self.shapes.reshape(len(self.coordinates), len(turn), -1)
        shapes = (turn @ shapes).reshape(self.shapes.shape)
        return Recovery(np.hstack([shapes[:, :n] @ by.T, shapes[:, n:]]),
                        self.coordinates @ rotation.T, self.node_dofs)
