"""Displacements inside a body from its reduced coordinates."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag


@dataclass(frozen=True, eq=False)
class Recovery:
    """Shapes of the FE model: displacements ``Phi y + Psi eta`` in the axes of the body.

    Bodies that are rotated copies of each other share the shapes.

    Parameters
    ----------
    shapes : (n_nodes k, N)
        Node after node, 0 for DOFs that a node does not have: of the n reduced coordinates, then
        of those that follow them in second order; in FE axes.
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        FE nodes in FE axes [length].
    node_dofs : tuple of str
        The k DOFs of one node in order, as in `FEModel`.
    axes : (D, D), optional
        Rotates vectors from FE axes to axes of the body.
    by : (n, n), optional
        The same of the reduced coordinates.
    cells, labels, outlines
        As in `FEModel`.
    """

    shapes: NDArray
    coordinates: NDArray
    node_dofs: tuple[str, ...]
    axes: NDArray | None = None
    by: NDArray | None = None
    cells: tuple[tuple[str, NDArray], ...] = ()
    labels: NDArray | None = None
    outlines: NDArray | None = None

    @property
    def dimension(self) -> int:
        """Coordinates of a node."""
        return self.coordinates.shape[1]

    @cached_property
    def points(self) -> NDArray:
        """FE nodes in the axes of the body, (n_nodes, D)."""
        return self.coordinates if self.axes is None else self.coordinates @ self.axes.T

    def displacement(self, z: NDArray, nodes: NDArray | None = None) -> NDArray:
        """Displacements of nodes, all by default, in the axes of the body.

        Parameters
        ----------
        z : (n, N)
            Reduced coordinates and those that follow them, in n states.
        nodes : (k,) of int, optional

        Returns
        -------
        (n, k, D)
        """
        return self._vectors(z, nodes, "translation")

    def rotation(self, z: NDArray, nodes: NDArray | None = None) -> NDArray:
        """Rotation vectors of nodes likewise, (n, k, 3), in a plane (n, k, 1).

        FE nodes without rotations have none: (n, k, 0).
        """
        return self._vectors(z, nodes, "rotation")

    def in_fe_axes(self, z: NDArray) -> NDArray:
        """Amplitudes (n, N) of the shapes in FE axes."""
        if self.by is None:
            return z
        n = len(self.by)
        return np.hstack([z[:, :n] @ self.by, z[:, n:]])

    def rotated(self, rotation: NDArray, by: NDArray) -> "Recovery":
        """The body rotated about the FE origin by (D, D), in the old axes; y becomes ``by @ y``."""
        if self.axes is not None:
            rotation, by = rotation @ self.axes, by @ self.by
        return replace(self, axes=rotation, by=by)

    def _vectors(self, z: NDArray, nodes: NDArray | None, kind: str) -> NDArray:
        turning = [name.startswith("r") for name in self.node_dofs]
        own = np.flatnonzero(np.array(turning) == (kind == "rotation"))
        count, width = len(self.coordinates), len(self.node_dofs)
        if nodes is None and len(own) == width:
            shapes, nodes = self.shapes, np.arange(count)
        else:
            nodes = np.arange(count) if nodes is None else np.asarray(nodes)
            shapes = self.shapes[(width * nodes[:, None] + own).ravel()]
        found = (self.in_fe_axes(z) @ shapes.T).reshape(len(z), len(nodes), len(own))
        return found if self.axes is None or len(own) < 2 else found @ self.axes.T

    def all_dofs(self, z: NDArray) -> NDArray:
        """All DOFs in the axes of the body, node after node, (n, n_dofs)."""
        field = self.in_fe_axes(z) @ self.shapes.T
        if self.axes is None:
            return field
        angles = sum(name.startswith("r") for name in self.node_dofs)
        turn = block_diag(self.axes, *{0: [], 1: [np.eye(1)], 3: [self.axes]}[angles])
        return (field.reshape(-1, len(turn)) @ turn.T).reshape(field.shape)
