"""Geometric stiffness of solids of any mesh: tetrahedra and hexahedra, linear and quadratic.

The order of the nodes is meshio's, which is VTK's and that of CalculiX and Abaqus.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.errors import InputError
from sebody.fem.model import assemble
from sebody.fem.stress import elasticity

_CORNERS = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
                     (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)], dtype=float)
_HEX_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4),
              (0, 4), (1, 5), (2, 6), (3, 7)]
TETRAHEDRON_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
_TET_CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)


class Kind(NamedTuple):
    """A kind of cell: its nodes on the reference cell, points and weights, slopes of its shapes."""

    nodes: NDArray                                  # (a, 3)
    points: NDArray                                 # (g, 3)
    weights: NDArray                                # (g,)
    slopes: Callable[[NDArray], NDArray]            # (a, 3) at a point


class SolidPrestress:
    """Geometric stiffness ``integral sigma_ij N_a,i N_b,j (x) I`` of the linear stresses.

    O.C. Zienkiewicz and R.L. Taylor, The Finite Element Method, vol. 2.

    Parameters
    ----------
    points : (n, 3)
        Nodes [length].
    cells : sequence of (str, (e, a), float, float)
        Kind of the elements by meshio's name, nodes, Young's modulus and Poisson's ratio.
    motion : (3 n, n_dofs), sparse
        Displacements of the nodes from the DOFs.
    tied : sequence of (rows, nodes, arms)
        Nodes that follow a rotation rigidly: its DOFs (3,), the nodes (k,) and their arms (k, 3)
        from the axis point, whose turning is of second order, too.

    Raises
    ------
    InputError
        An unknown kind, or an element turned inside out.
    """

    def __init__(self, points: NDArray, cells: Sequence[tuple[str, NDArray, float, float]],
                 motion: sparse.csr_array,
                 tied: Sequence[tuple[NDArray, NDArray, NDArray]] = ()):
        self._motion, self._tied, self._count = motion, tuple(tied), len(points)
        self._groups = [_group(points, *group) for group in cells]

    def __call__(self, displacement: NDArray) -> sparse.csc_array:
        """Geometric stiffness (n_dofs, n_dofs) of the displacement (n_dofs,) of a prestress."""
        by_nodes = sparse.csc_array((self._count, self._count))
        forces = np.zeros((self._count, 3))
        for nodes, slopes, pushed in self._stressed(displacement):
            np.add.at(forces, nodes, pushed.sum(axis=1))
            matrices = np.einsum("egai,egbi->eab", pushed, slopes)
            by_nodes = by_nodes + assemble(nodes, matrices, self._count)
        whole = self._motion.T @ sparse.kron(by_nodes, sparse.eye_array(3)) @ self._motion
        return sparse.csc_array(whole + self._of_turning(forces, whole.shape))

    def forces(self, displacement: NDArray) -> NDArray:
        """Internal forces (n_dofs,) of the stresses: those of the stiffness of such elements."""
        found = np.zeros((self._count, 3))
        for nodes, _, pushed in self._stressed(displacement):
            np.add.at(found, nodes, pushed.sum(axis=1))
        return self._motion.T @ found.ravel()

    def _stressed(self, displacement: NDArray) -> Iterator[tuple[NDArray, NDArray, NDArray]]:
        """Of every group nodes (e, a), slopes and ``sigma_ij N_a,j`` times volume (e, g, a, 3)."""
        moved = (self._motion @ displacement).reshape(-1, 3)
        for nodes, slopes, volumes, (lame, shear) in self._groups:
            gradients = np.einsum("egai,eak->egki", slopes, moved[nodes])   # u_k,i
            stresses = shear * (gradients + gradients.swapaxes(2, 3))
            trace = np.trace(gradients, axis1=2, axis2=3)
            stresses += lame * trace[..., None, None] * np.eye(3)
            stresses *= volumes[..., None, None]
            yield nodes, slopes, np.einsum("egij,egaj->egai", stresses, slopes)

    def _of_turning(self, forces: NDArray, shape: tuple[int, int]) -> sparse.csc_array:
        """What forces on tied nodes do when these turn: ``(f r^T + r f^T) / 2 - f . r I``."""
        rows, columns, entries = [], [], []
        for turns, nodes, arms in self._tied:
            moments = forces[nodes].T @ arms
            block = (moments + moments.T) / 2 - np.trace(moments) * np.eye(3)
            rows.append(np.repeat(turns, 3))
            columns.append(np.tile(turns, 3))
            entries.append(block.ravel())
        if not rows:
            return sparse.csc_array(shape)
        places = np.concatenate(rows), np.concatenate(columns)
        return sparse.csc_array(sparse.coo_array((np.concatenate(entries), places), shape=shape))


def reference_nodes(kind: str) -> NDArray:
    """Nodes of the reference cell of a kind, (a, 3); InputError for an unknown one."""
    return _known(kind).nodes


def knows(kind: str) -> bool:
    """Whether there are shapes of this kind of cell."""
    return kind in KINDS


def _known(kind: str) -> Kind:
    if kind not in KINDS:
        raise InputError(f"cells of kind {kind!r} have no geometric stiffness here: use "
                         f"{', '.join(KINDS)}, or none")
    return KINDS[kind]


def _group(points: NDArray, kind: str, nodes: NDArray, youngs_modulus: float, poisson_ratio: float
           ) -> tuple[NDArray, NDArray, NDArray, tuple[float, float]]:
    """Nodes (e, a), slopes (e, g, a, 3), volumes (e, g) of the points, Lame's constants."""
    cell = _known(kind)
    of_reference = np.array([cell.slopes(point) for point in cell.points])      # (g, a, 3)
    jacobians = np.einsum("gai,eak->egik", of_reference, points[nodes])         # x_k by xi_i
    determinants = np.linalg.det(jacobians)
    if (determinants <= 0).any():
        element = int(np.argwhere(determinants <= 0)[0][0])
        raise InputError(f"cell {element} of kind {kind!r}, nodes {nodes[element].tolist()}, is "
                         "turned inside out: correct the mesh or the order of its nodes")
    slopes = np.einsum("egki,gai->egak", np.linalg.inv(jacobians), of_reference)
    law = elasticity(youngs_modulus, poisson_ratio)
    return nodes, slopes, determinants * cell.weights, (law[0, 1], law[3, 3])


def _linear_hexahedron(point: NDArray) -> NDArray:
    factors = 1 + _CORNERS * point
    return np.column_stack([_CORNERS[:, i] * factors[:, j] * factors[:, k] for i, j, k in (
        (0, 1, 2), (1, 2, 0), (2, 0, 1))]) / 8


def _serendipity(point: NDArray) -> NDArray:
    """Slopes of the twenty shapes: corners ``prod(1 + c x) (c . x - 2) / 8``, middles ``/ 4``."""
    found = np.zeros((20, 3))
    for a, corner in enumerate(_CORNERS):
        factors = 1 + corner * point
        rest = corner @ point - 2
        for i in range(3):
            others = np.prod(np.delete(factors, i))
            found[a, i] = corner[i] * others * (rest + factors[i]) / 8
    for a, (first, second) in enumerate(_HEX_EDGES, 8):
        middle = (_CORNERS[first] + _CORNERS[second]) / 2
        values = np.where(middle == 0, 1 - point**2, 1 + middle * point)
        rates = np.where(middle == 0, -2 * point, middle)
        for i in range(3):
            found[a, i] = rates[i] * np.prod(np.delete(values, i)) / 4
    return found


def _linear_tetrahedron(point: NDArray) -> NDArray:
    return np.array([(-1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)


def _quadratic_tetrahedron(point: NDArray) -> NDArray:
    values = np.array([1 - point.sum(), *point])
    rates = _linear_tetrahedron(point)
    corners = (4 * values - 1)[:, None] * rates
    middles = [4 * (values[i] * rates[j] + values[j] * rates[i]) for i, j in TETRAHEDRON_EDGES]
    return np.vstack([corners, middles])


def _gauss(count: int) -> tuple[NDArray, NDArray]:
    points, weights = np.polynomial.legendre.leggauss(count)
    return (np.array(list(product(points, repeat=3))),
            np.array([a * b * c for a, b, c in product(weights, repeat=3)]))


def _middles(corners: NDArray, edges: list[tuple[int, int]]) -> NDArray:
    return np.vstack([corners, [(corners[i] + corners[j]) / 2 for i, j in edges]])


_NEAR, _FAR = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
_FOUR = np.array([(_NEAR, _NEAR, _NEAR), (_FAR, _NEAR, _NEAR), (_NEAR, _FAR, _NEAR),
                  (_NEAR, _NEAR, _FAR)])
KINDS = {
    "tetra": Kind(_TET_CORNERS, np.full((1, 3), 0.25), np.full(1, 1 / 6), _linear_tetrahedron),
    "tetra10": Kind(_middles(_TET_CORNERS, TETRAHEDRON_EDGES), _FOUR, np.full(4, 1 / 24),
                    _quadratic_tetrahedron),
    "hexahedron": Kind(_CORNERS, *_gauss(2), _linear_hexahedron),
    "hexahedron20": Kind(_middles(_CORNERS, _HEX_EDGES), *_gauss(3), _serendipity),
}
