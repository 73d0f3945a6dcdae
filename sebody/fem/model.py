"""What an FE program hands over: matrices, node coordinates and the meaning of the DOFs."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from sebody.errors import InputError
from sebody.fem.mass_field import MassField, nodal_field

SPATIAL = ("x", "y", "z", "rx", "ry", "rz")
PLANAR = ("x", "y", "rz")
SOLID = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class FEModel:
    """Linear FE model with the same DOFs at every node, node after node, in global axes.

    Parameters
    ----------
    stiffness, mass : (n_dofs, n_dofs), dense or sparse
        Symmetric FE matrices of the free body; kept as CSC.
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        Node positions [length].
    node_dofs : tuple of str
        DOFs of one node in order: ``('x', 'y', 'z', 'rx', 'ry', 'rz')``, planar
        ``('x', 'y', 'rz')``, solids ``('x', 'y', 'z')``; an ``r`` marks a rotation.
    mass_field : MassField, optional
        What the mass matrix is made of, for the inertia of the moving body. Models without
        rotations whose mass is the same along x, y and z have that of their nodes by default.
    geometric_stiffness : function, optional
        Geometric stiffness (n_dofs, n_dofs), sparse and symmetric, of the linear stresses that a
        displacement (n_dofs,) of the free body causes.

    Raises
    ------
    InputError
        Unknown DOF layout, or shapes that do not fit together.
    """

    stiffness: sparse.csc_array
    mass: sparse.csc_array
    coordinates: NDArray
    node_dofs: tuple[str, ...] = SPATIAL
    mass_field: MassField | None = None
    geometric_stiffness: Callable[[NDArray], sparse.csc_array] | None = None

    def __post_init__(self) -> None:
        coordinates = np.array(self.coordinates, dtype=float)
        if self.node_dofs not in (SPATIAL, PLANAR, SOLID):
            raise InputError(
                f"node_dofs {self.node_dofs} unknown; use {SPATIAL}, {PLANAR} or {SOLID}"
            )
        dimension = sum(not name.startswith("r") for name in self.node_dofs)
        if coordinates.ndim != 2 or coordinates.shape[1] != dimension:
            raise InputError(
                f"coordinates have shape {coordinates.shape}; DOFs {self.node_dofs} need "
                f"(n_nodes, {dimension})"
            )
        object.__setattr__(self, "coordinates", coordinates)
        size = len(coordinates) * len(self.node_dofs)
        for name in ("stiffness", "mass"):
            matrix = sparse.csc_array(getattr(self, name), dtype=float)
            if matrix.shape != (size, size):
                raise InputError(
                    f"{name} has shape {matrix.shape}; {len(coordinates)} nodes with "
                    f"{self.dofs_per_node} DOFs each need ({size}, {size})"
                )
            object.__setattr__(self, name, matrix)
        if self.mass_field is not None:
            self.mass_field.check(size, dimension)
        elif self.node_dofs == SOLID:
            object.__setattr__(self, "mass_field", nodal_field(self.mass, coordinates))

    @property
    def dofs_per_node(self) -> int:
        """Number of DOFs of each node."""
        return len(self.node_dofs)

    def dofs(self, node: int, kind: str = "full") -> NDArray:
        """Rows of one node in the matrices; `kind` is 'full', 'translation' or 'rotation'."""
        is_rotation = np.array([name.startswith("r") for name in self.node_dofs])
        wanted = {
            "full": np.full(len(is_rotation), True),
            "translation": ~is_rotation,
            "rotation": is_rotation,
        }[kind]
        return node * self.dofs_per_node + np.flatnonzero(wanted)

    def node_at(self, point: ArrayLike) -> int:
        """Index of the node at `point`; InputError when the nearest is not there."""
        distance = np.linalg.norm(self.coordinates - np.asarray(point, dtype=float), axis=1)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 1e-6 * np.max(np.ptp(self.coordinates, axis=0)):
            raise InputError(
                f"no node at {point}: the nearest, node {nearest}, is {distance[nearest]:.3g} "
                "away; give the position of a node"
            )
        return nearest


def assemble(element_dofs: NDArray, element_matrices: NDArray, size: int) -> sparse.csc_array:
    """Sum element matrices (n_elements, k, k) at rows `element_dofs` (n_elements, k)."""
    width = element_dofs.shape[1]
    rows = np.repeat(element_dofs, width, axis=1).ravel()
    columns = np.tile(element_dofs, (1, width)).ravel()
    entries = (element_matrices.ravel(), (rows, columns))
    return sparse.csc_array(sparse.coo_array(entries, shape=(size, size)))
