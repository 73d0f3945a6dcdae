"""Displacements inside a body from its reduced coordinates."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import block_diag

from sebody.basics.tabular import brief
from sebody.fem.beam_stress import BeamStress
from sebody.fem.stress import SolidStress, StressModes


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
    stress : tuple of SolidStress, BeamStress or StressModes
        What stresses the displacements cause, of those of the first n shapes.
    static : (n_nodes k, n_b + pairs + loads), optional
        Static displacements, in addition to the shapes, under the loads of unit inertia: of unit
        accelerations of the n_b boundary coordinates, then of unit products of angular velocities
        ``w_k w_l``, k <= l; then under the loads of the body. See
        `sebody.reduction.static_correction`.
    nodes : (n_nodes,) of int, optional
        Their numbers in the FE model, of which these are a part; ascending.
    """

    shapes: NDArray
    coordinates: NDArray
    node_dofs: tuple[str, ...]
    axes: NDArray | None = None
    by: NDArray | None = None
    cells: tuple[tuple[str, NDArray], ...] = ()
    labels: NDArray | None = None
    outlines: NDArray | None = None
    stress: tuple[SolidStress | BeamStress | StressModes, ...] = ()
    static: NDArray | None = None
    nodes: NDArray | None = None

    __repr__ = brief

    @property
    def dimension(self) -> int:
        """Coordinates of a node."""
        return self.coordinates.shape[1]

    @cached_property
    def points(self) -> NDArray:
        """FE nodes in the axes of the body, (n_nodes, D)."""
        return self.coordinates if self.axes is None else self.coordinates @ self.axes.T

    def has(self, number: int) -> bool:
        """Tell whether the node of this number in the FE model is among those that are kept."""
        if self.nodes is None:
            return 0 <= number < len(self.coordinates)
        place = self.place(number)
        return place < len(self.nodes) and self.nodes[place] == number

    def place(self, number: int) -> int:
        """Place of a node among those that are kept, by its number in the FE model."""
        return number if self.nodes is None else int(np.searchsorted(self.nodes, number))

    def places(self, paths: Mapping[str, NDArray]) -> list[int]:
        """Places of the nodes of paths among those that are kept."""
        return [self.place(int(node)) for nodes in paths.values() for node in nodes]

    def number(self, place: int) -> int:
        """Number in the FE model of a node, by its place among those that are kept."""
        return int(place) if self.nodes is None else int(self.nodes[place])

    @property
    def fibred(self) -> bool:
        """True where stresses are those of fibres of beams, of which nodes have the largest."""
        return any(isinstance(one, BeamStress) for one in self.stress)

    def called(self, place: int) -> int:
        """The label of a node that is kept, or its number in the FE model if it has none."""
        return self.number(place) if self.labels is None else int(self.labels[place])

    def displacement(self, z: NDArray, nodes: ArrayLike | None = None) -> NDArray:
        """Displacements of nodes, all by default, in the axes of the body.

        Parameters
        ----------
        z : (n, N)
            Reduced coordinates, and those that follow them where these are known, in n states.
        nodes : (k,) of int, optional

        Returns
        -------
        (n, k, D)
        """
        return self._vectors(z, nodes, "translation")

    def rotation(self, z: NDArray, nodes: ArrayLike | None = None) -> NDArray:
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

    def restricted(self, nodes: NDArray) -> "Recovery":
        """Restrict to some nodes alone, with the elements all of whose nodes are among them."""
        nodes = np.unique(nodes)
        place = np.full(len(self.coordinates), -1)
        place[nodes] = np.arange(len(nodes))
        rows = (len(self.node_dofs) * nodes[:, None] + np.arange(len(self.node_dofs))).ravel()
        cells = tuple((kind, place[own[np.all(place[own] >= 0, axis=1)]])
                      for kind, own in self.cells)
        lines = [np.all(place[own] >= 0, axis=1) for kind, own in self.cells if kind == "line"]
        outlines = self.outlines if self.outlines is None else self.outlines[np.concatenate(lines)]
        stress = tuple(found for one in self.stress
                       if len((found := one.restricted(place, self.coordinates[nodes])).nodes))
        return replace(
            self, shapes=self.shapes[rows], coordinates=self.coordinates[nodes],
            cells=tuple(cell for cell in cells if len(cell[1])), stress=stress,
            labels=None if self.labels is None else self.labels[nodes], outlines=outlines,
            static=None if self.static is None else self.static[rows],
            nodes=nodes if self.nodes is None else self.nodes[nodes])

    def rotated(self, rotation: NDArray, by: NDArray) -> "Recovery":
        """The body rotated about the FE origin by (D, D), in the old axes; y becomes ``by @ y``."""
        if self.axes is not None:
            rotation, by = rotation @ self.axes, by @ self.by
        return replace(self, axes=rotation, by=by)

    def _vectors(self, z: NDArray, nodes: ArrayLike | None, kind: str) -> NDArray:
        turning = [name.startswith("r") for name in self.node_dofs]
        chosen = np.flatnonzero(np.array(turning) == (kind == "rotation"))
        count, width = len(self.coordinates), len(self.node_dofs)
        if nodes is None and len(chosen) == width:
            shapes, at = self.shapes[:, :z.shape[1]], np.arange(count)
        else:
            at = np.arange(count) if nodes is None else np.asarray(nodes)
            shapes = self.shapes[(width * at[:, None] + chosen).ravel(), :z.shape[1]]
        vectors = (self.in_fe_axes(z) @ shapes.T).reshape(len(z), len(at), len(chosen))
        return vectors if self.axes is None or len(chosen) < 2 else vectors @ self.axes.T

    def all_dofs(self, z: NDArray) -> NDArray:
        """All DOFs in the axes of the body, node after node, (n, n_dofs)."""
        field = self.in_fe_axes(z) @ self.shapes[:, :z.shape[1]].T
        if self.axes is None:
            return field
        angles = sum(name.startswith("r") for name in self.node_dofs)
        turn = block_diag(self.axes, *{0: [], 1: [np.eye(1)], 3: [self.axes]}[angles])
        return (field.reshape(-1, len(turn)) @ turn.T).reshape(field.shape)
