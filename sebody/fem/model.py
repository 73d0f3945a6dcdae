"""What an FE program hands over: matrices, node coordinates and the meaning of the DOFs."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from sebody import inputs
from sebody.errors import InputError
from sebody.fem.mass_field import MassField, nodal_field

SPATIAL = ("x", "y", "z", "rx", "ry", "rz")
PLANAR = ("x", "y", "rz")
SOLID = ("x", "y", "z")
SYMMETRY_LIMIT = 1e-8   # difference of entries across the diagonal, relative to its own entries


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
        Unknown DOF layout, shapes that do not fit together, entries that are no finite real
        numbers, or matrices that are not symmetric.
    """

    stiffness: sparse.csc_array
    mass: sparse.csc_array
    coordinates: NDArray
    node_dofs: tuple[str, ...] = SPATIAL
    mass_field: MassField | None = None
    geometric_stiffness: Callable[[NDArray], sparse.csc_array] | None = None

    def __post_init__(self) -> None:
        layouts = f"use {SPATIAL}, {PLANAR} or {SOLID}"
        node_dofs = tuple(inputs.items(self.node_dofs, "node_dofs", layouts))
        if node_dofs not in (SPATIAL, PLANAR, SOLID):
            raise InputError(f"node_dofs {node_dofs} unknown; {layouts}")
        object.__setattr__(self, "node_dofs", node_dofs)
        dimension = sum(not name.startswith("r") for name in node_dofs)
        need = f"DOFs {node_dofs} need (n_nodes, {dimension})"
        coordinates = inputs.reals(self.coordinates, "coordinates", need)
        if coordinates.ndim != 2 or coordinates.shape[1] != dimension or not len(coordinates):
            raise InputError(f"coordinates have shape {coordinates.shape}; {need}")
        if not np.isfinite(coordinates).all():
            node = int(np.argwhere(~np.isfinite(coordinates))[0][0])
            raise InputError(f"coordinates of node {node} are {coordinates[node]}; give finite "
                             "numbers")
        object.__setattr__(self, "coordinates", coordinates)
        size = len(coordinates) * len(self.node_dofs)
        for name in ("stiffness", "mass"):
            matrix = fe_matrix(getattr(self, name), name)
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
        """Rows of one node in the matrices; `kind` is 'full', 'translation' or 'rotation'.

        Raises
        ------
        InputError
            A node or kind there is not.
        """
        last = len(self.coordinates) - 1
        node = inputs.integer(node, "node", least=0, most=last,
                              remedy=f"the model has nodes 0 to {last}")
        is_rotation = np.array([name.startswith("r") for name in self.node_dofs])
        wanted = {
            "full": np.full(len(is_rotation), True),
            "translation": ~is_rotation,
            "rotation": is_rotation,
        }
        wanted = wanted[inputs.choice(kind, "kind of DOFs", wanted)]
        return node * self.dofs_per_node + np.flatnonzero(wanted)

    def node_at(self, point: ArrayLike) -> int:
        """Index of the node at `point`; InputError when the nearest is not there."""
        point = inputs.vector(point, "point", self.coordinates.shape[1])
        distance = np.linalg.norm(self.coordinates - point, axis=1)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 1e-6 * np.max(np.ptp(self.coordinates, axis=0)):
            raise InputError(
                f"no node at {point}: the nearest, node {nearest}, is {distance[nearest]:.3g} "
                "away; give the position of a node"
            )
        return nearest


def fe_matrix(value: object, name: str) -> sparse.csc_array:
    """A matrix of an FE model as CSC.

    Parameters
    ----------
    value : (n, n), dense or sparse
    name : str
        Of the matrix, for the message.

    Raises
    ------
    InputError
        Entries that are no finite real numbers, or a matrix that is not symmetric.
    """
    remedy = "give a square matrix of real numbers, dense or of scipy.sparse"
    if sparse.issparse(value):
        if value.dtype.kind not in "iuf" or value.ndim != 2:
            raise InputError(f"{name} has numbers of type {value.dtype} and the shape "
                             f"{value.shape}: {remedy}")
        matrix = sparse.csc_array(value, dtype=float, copy=True)
    else:
        dense = inputs.reals(value, name, remedy)
        if dense.ndim != 2:
            raise InputError(f"{name} has shape {dense.shape}: {remedy}")
        matrix = sparse.csc_array(dense)
    if not np.isfinite(matrix.data).all():
        entries = matrix.tocoo()
        k = int(np.argmin(np.isfinite(entries.data)))
        raise InputError(f"{name}[{entries.row[k]}, {entries.col[k]}] is {entries.data[k]}: the "
                         "matrix must be finite, export it again")
    if matrix.shape[0] == matrix.shape[1]:
        _check_symmetry(matrix, name)
    return matrix


def _check_symmetry(matrix: sparse.csc_array, name: str) -> None:
    """Refuse entries that differ across the diagonal, relative to its entries in their rows."""
    defect = sparse.coo_array(matrix - matrix.T)
    if not defect.nnz:
        return
    diagonal = np.sqrt(np.abs(matrix.diagonal()))
    allowed = SYMMETRY_LIMIT * diagonal[defect.row] * diagonal[defect.col]
    k = int(np.argmax(np.abs(defect.data) - allowed))
    if abs(defect.data[k]) > allowed[k]:
        i, j = int(defect.row[k]), int(defect.col[k])
        raise InputError(f"{name} is not symmetric: {name}[{i}, {j}] = {matrix[i, j]:.6g} but "
                         f"{name}[{j}, {i}] = {matrix[j, i]:.6g}: export both triangles or mirror "
                         "one")


def assemble(element_dofs: NDArray, element_matrices: NDArray, size: int) -> sparse.csc_array:
    """Sum element matrices (n_elements, k, k) at rows `element_dofs` (n_elements, k)."""
    width = element_dofs.shape[1]
    rows = np.repeat(element_dofs, width, axis=1).ravel()
    columns = np.tile(element_dofs, (1, width)).ravel()
    entries = (element_matrices.ravel(), (rows, columns))
    return sparse.csc_array(sparse.coo_array(entries, shape=(size, size)))
