"""Motion of the mass of an FE model with its DOFs: points, their displacement and rotation."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError


@dataclass(frozen=True, eq=False)
class MassField:
    """Points of mass: ``T = sum_pq m_pq v_p . v_q / 2 + sum_p w_p . J_p w_p / 2``.

    An FE mass matrix alone does not say how rotation of the body changes its inertia: consistent
    masses of beams, for one, couple nodal rotations to displacements between the nodes. Where the
    matrix is a sum over points with a displacement (and a rotation) each, the products with
    the vectors that a rotation of the body makes of these are exact.

    Parameters
    ----------
    points : (p, 3), planar (p, 2)
        Undeformed positions [length].
    translation : (3 p, n_dofs), planar (2 p, n_dofs), sparse
        Displacements of the points from the DOFs.
    mass : (p, p), sparse
        Diagonal where points are those of an integration, m of a nodal mass ``m (x) I``.
    rotation : (3 p, n_dofs), planar (p, n_dofs), sparse, optional
        Rotation vectors of the points; none where no point has rotary inertia.
    inertia : (p, 3, 3), planar (p, 1, 1), optional
        Rotary inertia of the points in the model's axes [mass length^2].
    """

    points: NDArray
    translation: sparse.csr_array
    mass: sparse.csr_array
    rotation: sparse.csr_array | None = None
    inertia: NDArray | None = None

    def check(self, size: int, dimension: int) -> None:
        """Raise InputError unless the parts fit a model of `size` DOFs in so many dimensions."""
        count, angles = len(self.points), 1 if dimension == 2 else 3
        wanted = {"points": (count, dimension), "translation": (dimension * count, size),
                  "mass": (count, count), "rotation": (angles * count, size),
                  "inertia": (count, angles, angles)}
        for name, shape in wanted.items():
            part = getattr(self, name)
            if part is not None and part.shape != shape:
                raise InputError(f"mass_field.{name} has shape {part.shape}; {count} points of a "
                                 f"model with {size} DOFs need {shape}")
        if (self.rotation is None) != (self.inertia is None):
            raise InputError("mass_field has rotation or inertia without the other; give both")

    def matrix(self) -> sparse.csc_array:
        """The FE mass matrix these points make, (n_dofs, n_dofs)."""
        dimension = self.points.shape[1]
        weights = sparse.kron(self.mass, sparse.eye_array(dimension))
        total = self.translation.T @ weights @ self.translation
        if self.rotation is not None:
            total = total + self.rotation.T @ sparse.block_diag(list(self.inertia)) @ self.rotation
        return sparse.csc_array(total)


def nodal_field(mass: sparse.csc_array, coordinates: NDArray, rows: NDArray) -> MassField | None:
    """The nodes as points, if the mass is that of points: ``m (x) I``, rotary inertia lumped.

    Nodes may lack DOFs, and rotations may be massless (shells and reference nodes of many FE
    programs). Consistent masses of beams and shells couple rotations to displacements between the
    nodes: they are none of points at the nodes.

    Parameters
    ----------
    mass : (n_dofs, n_dofs), sparse
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
    rows : (n_nodes, k)
        Row of every DOF, -1 for none; translations first.

    Returns
    -------
    MassField or None
        None unless the mass is of this form.
    """
    count, dimension = coordinates.shape
    total = sparse.csr_array(mass)
    nodes = np.empty(total.shape[0], dtype=int)
    axes = np.empty(total.shape[0], dtype=int)
    present = rows >= 0
    nodes[rows[present]], axes[rows[present]] = np.nonzero(present)
    entries = total.tocoo()
    first, second = axes[entries.row], axes[entries.col]
    moves = first < dimension
    limit = _ROUNDING * np.sqrt(np.outer(*[_largest(mass, axes < dimension)] * 2))
    same_axis = moves & (first == second)
    same_node = ~moves & (second >= dimension) & (nodes[entries.row] == nodes[entries.col])
    kind = (~moves).astype(int), (second >= dimension).astype(int)
    if np.any(np.abs(entries.data) > np.where(same_axis | same_node, np.inf, limit[kind])):
        return None
    by_axes = []
    for axis in range(dimension):
        diagonal = same_axis & (first == axis)
        at = nodes[entries.row[diagonal]], nodes[entries.col[diagonal]]
        by_axes.append(sparse.csr_array(sparse.coo_array((entries.data[diagonal], at),
                                                         shape=(count, count))))
        rest = by_axes[axis] - by_axes[0]
        if rest.nnz and abs(rest).max() > limit[0, 0]:
            return None
    translation = _selection(rows[:, :dimension], total.shape[0])
    angles = rows.shape[1] - dimension
    if not np.any(same_node & (entries.data != 0)):
        return MassField(coordinates, translation, by_axes[0])
    inertia = np.zeros((count, angles, angles))
    inertia[nodes[entries.row[same_node]], first[same_node] - dimension,
            second[same_node] - dimension] = entries.data[same_node]
    return MassField(coordinates, translation, by_axes[0],
                     _selection(rows[:, dimension:], total.shape[0]), inertia)


def _largest(mass: sparse.csc_array, moves: NDArray) -> tuple[float, float]:
    """Largest masses of translations and of rotations."""
    diagonal = np.abs(mass.diagonal())
    return diagonal[moves].max(initial=0.0), diagonal[~moves].max(initial=0.0)


def _selection(rows: NDArray, size: int) -> sparse.csr_array:
    """Picks `rows` (n, k) of a vector, 0 for -1: (n k, size)."""
    flat = rows.ravel()
    there = np.flatnonzero(flat >= 0)
    return sparse.csr_array((np.ones(len(there)), (there, flat[there])), shape=(len(flat), size))


_ROUNDING = 1e-12  # of an assembled matrix, relative to its largest entries
