"""Geometric stiffness of solids of any mesh, integrated as FE programs integrate the stiffness.

The order of the nodes is meshio's, which is VTK's and that of CalculiX and Abaqus.
"""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.fem.isoparametric import slopes_at
from sebody.fem.matrices import assemble

TETRAHEDRON_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]   # middles of tetra10


class InvertedCell(InputError):
    """A cell that is turned inside out, or has no volume.

    Parameters
    ----------
    message : str
    group, cell : int
        Which of the groups of cells, and which of its cells.
    """

    def __init__(self, message: str, group: int, cell: int):
        super().__init__(message)
        self.group, self.cell = group, cell


class SolidPrestress:
    """Geometric stiffness ``integral sigma_ij N_a,i N_b,j (x) I`` of the linear stresses.

    O.C. Zienkiewicz and R.L. Taylor, The Finite Element Method, vol. 2.

    Parameters
    ----------
    points : (n, 3)
        Nodes [length].
    cells : sequence of (str, (e, a), (6, 6) or (e, 6, 6))
        Kind of the elements by meshio's name, nodes, stress of a strain of all or of each; see
        `sebody.fem.stress` for the order of the components.
    motion : (3 n, n_dofs), sparse
        Displacements of the nodes from the DOFs.
    tied : sequence of (rows, nodes, arms)
        Nodes that follow a rotation rigidly: its DOFs (3,), the nodes (k,) and their arms (k, 3)
        from the axis point, whose turning is of second order, too.

    Raises
    ------
    InputError
        An unknown kind, or an element turned inside out (`InvertedCell`).
    """

    def __init__(self, points: NDArray, cells: Sequence[tuple[str, NDArray, NDArray]],
                 motion: sparse.csr_array,
                 tied: Sequence[tuple[NDArray, NDArray, NDArray]] = ()):
        self._motion, self._tied, self._count = motion, tuple(tied), len(points)
        self._groups = [_group(k, points, *group) for k, group in enumerate(cells)]

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

    def projected(self, displacements: NDArray, basis: NDArray) -> NDArray:
        """Geometric stiffnesses of displacements (n_dofs, k) on a basis (n_dofs, n), (k, n, n)."""
        n, k = basis.shape[1], displacements.shape[1]
        shapes = (self._motion @ basis).reshape(self._count, 3 * n)
        moved = (self._motion @ displacements).reshape(self._count, 3 * k)
        if not k:
            return np.zeros((0, n, n))
        if n > _FEW or k < _SINGLE:
            result = self._by_nodes(shapes, moved)
        else:
            half = np.zeros((k, n * n))
            for nodes, slopes, volumes, law in self._groups:
                count, g, a, _ = slopes.shape
                step = max(1, int(_BLOCK / (g * max(6 * n * n, 18 * k))))
                made = np.empty((min(step, count) * g, 6, n, n))
                for first in range(0, count, step):
                    part = slice(first, first + step)
                    by_axes = _by_axes(slopes[part])
                    own = nodes[part]
                    gradients = (by_axes @ shapes[own]).reshape(-1, 3, 3, n)     # u_c,i: [i, c]
                    products = made[:len(gradients)]
                    for m, (i, j) in enumerate(zip(_FIRST, _SECOND, strict=True)):
                        np.matmul(gradients[:, i].transpose(0, 2, 1), gradients[:, j],
                                  out=products[:, m])
                    stresses = _stresses(by_axes @ moved[own], volumes[part],
                                         law if law.ndim == 2 else law[part])
                    stresses[:, :3] *= 0.5
                    half += stresses.reshape(-1, k).T @ products.reshape(-1, n * n)
            half = half.reshape(k, n, n)
            result = half + half.transpose(0, 2, 1)
        if self._tied:
            result = result + self._turning(moved, basis)
        return result

    def _by_nodes(self, shapes: NDArray, moved: NDArray) -> NDArray:
        """The same of many shapes: a scalar matrix of the nodes for each prestress."""
        size, k, n = self._count, moved.shape[1] // 3, shapes.shape[1] // 3
        keys = np.concatenate([
            (nodes[:, :, None] * size + nodes[:, None, :]).ravel() for nodes, *_ in self._groups])
        places, which = np.unique(keys, return_inverse=True)
        starts = np.concatenate([[0], np.cumsum(np.bincount(places // size, minlength=size))])
        columns, flat = places % size, shapes.reshape(3 * size, n)
        result = np.empty((k, n, n))
        for number in range(k):
            own = np.ascontiguousarray(moved.reshape(size, 3, k)[:, :, number])
            entries = []
            for nodes, slopes, volumes, law in self._groups:
                for first in range(0, len(nodes), _ELEMENTS):
                    part = slice(first, first + _ELEMENTS)
                    by_axes = _by_axes(slopes[part])
                    stresses = _stresses(by_axes @ own[nodes[part]], volumes[part],
                                         law if law.ndim == 2 else law[part])
                    pushed = stresses[:, _TENSOR, 0] @ by_axes.reshape(-1, 3, by_axes.shape[2])
                    entries.append((by_axes.transpose(0, 2, 1) @ pushed.reshape(by_axes.shape)
                                    ).ravel())
            matrix = sparse.csr_array((np.bincount(which, np.concatenate(entries), len(places)),
                                       columns, starts), shape=(size, size))
            result[number] = flat.T @ (matrix @ shapes).reshape(3 * size, n)
        return result

    def _turning(self, moved: NDArray, basis: NDArray) -> NDArray:
        """Matrices that `_of_turning` adds, of prestresses on a basis: forces on tied nodes."""
        k = moved.shape[1] // 3
        tied = np.zeros(self._count, dtype=bool)
        for _, nodes, _ in self._tied:
            tied[nodes] = True
        forces = np.zeros((self._count, 3, k))
        for nodes, slopes, volumes, law in self._groups:
            chosen = np.flatnonzero(tied[nodes].any(axis=1))
            for first in range(0, len(chosen), _ELEMENTS):
                part = chosen[first:first + _ELEMENTS]
                by_axes = _by_axes(slopes[part])
                stresses = _stresses(by_axes @ moved[nodes[part]], volumes[part],
                                     law if law.ndim == 2 else law[part])
                pushed = by_axes.transpose(0, 2, 1) @ stresses[:, _TENSOR].reshape(
                    len(part), -1, 3 * k)
                np.add.at(forces, nodes[part], pushed.reshape(*nodes[part].shape, 3, k))
        result = np.zeros((k, basis.shape[1], basis.shape[1]))
        for turns, nodes, arms in self._tied:
            moments = np.einsum("nik,nj->kij", forces[nodes], arms)
            block = (moments + moments.transpose(0, 2, 1)) / 2
            block -= np.trace(moments, axis1=1, axis2=2)[:, None, None] * np.eye(3)
            result += basis[turns].T @ block @ basis[turns]
        return result

    def forces(self, displacement: NDArray) -> NDArray:
        """Internal forces (n_dofs,) of the stresses: those of the stiffness of such elements."""
        total = np.zeros((self._count, 3))
        for nodes, _, pushed in self._stressed(displacement):
            np.add.at(total, nodes, pushed.sum(axis=1))
        return self._motion.T @ total.ravel()

    @property
    def volume(self) -> float:
        """Volume of all cells."""
        return float(sum(volumes.sum() for _, _, volumes, _ in self._groups))

    def _stressed(self, displacement: NDArray) -> Iterator[tuple[NDArray, NDArray, NDArray]]:
        """Nodes (e, a) of every group, slopes and ``sigma_ij N_a,j`` times volume (e, g, a, 3)."""
        moved = (self._motion @ displacement).reshape(-1, 3)
        for nodes, slopes, volumes, law in self._groups:
            gradients = np.einsum("egai,eak->egki", slopes, moved[nodes])   # u_k,i
            shears = gradients[..., _SECOND, _FIRST] * (_FIRST != _SECOND)
            stresses = ((gradients[..., _FIRST, _SECOND] + shears) @ law)[..., _TENSOR]
            stresses *= volumes[..., None, None]
            yield nodes, slopes, np.einsum("egij,egaj->egai", stresses, slopes)

    def _of_turning(self, forces: NDArray, shape: tuple[int, int]) -> sparse.csc_array:
        """Stiffness of forces on tied nodes that turn: ``(f r^T + r f^T) / 2 - f . r I``."""
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


_FEW = 64       # shapes up to which products of their gradients at all points are less work
_SINGLE = 4     # prestresses below which making these products does not pay
_BLOCK = 2.5e5  # numbers of a block of elements, which stay in the cache
_ELEMENTS = 2000


def _by_axes(slopes: NDArray) -> NDArray:
    """Slopes (e, g, a, 3) as matrices (e, 3 g, a)."""
    count, g, a, _ = slopes.shape
    return np.ascontiguousarray(slopes.transpose(0, 1, 3, 2)).reshape(count, 3 * g, a)


def _stresses(derived: NDArray, volumes: NDArray, law: NDArray) -> NDArray:
    """Stresses times volume (e g, 6, k) of derivatives u_c,i (e, 3 g, 3 k)."""
    count, g = volumes.shape
    gradients = derived.reshape(count * g, 3, 3, -1)
    strains = np.empty((count * g, 6, gradients.shape[3]))
    for m, (i, j) in enumerate(zip(_FIRST, _SECOND, strict=True)):
        strains[:, m] = gradients[:, i, j] if i == j else gradients[:, i, j] + gradients[:, j, i]
    if law.ndim == 2:
        stresses = law @ strains
    else:
        stresses = (law[:, None] @ strains.reshape(count, g, 6, -1)).reshape(strains.shape)
    stresses *= volumes.reshape(-1, 1, 1)
    return stresses


def knows(kind: str) -> bool:
    """Tell whether there is a full integration of this kind of cell."""
    return kind in _RULES


def _group(number: int, points: NDArray, kind: str, nodes: NDArray, law: NDArray
           ) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Nodes (e, a), slopes (e, g, a, 3), volumes (e, g) of the points, and the law."""
    if kind not in _RULES:
        raise InputError(f"cells of kind {kind!r} have no geometric stiffness here: use "
                         f"{', '.join(_RULES)}, or none")
    places, weights = _RULES[kind]
    of_reference = slopes_at(kind, places).transpose(0, 2, 1)                   # (g, a, 3)
    jacobians = np.einsum("gai,eak->egik", of_reference, points[nodes])         # x_k by xi_i
    determinants = np.linalg.det(jacobians)
    if (determinants <= 0).any():
        element = int(np.argwhere(determinants <= 0)[0][0])
        raise InvertedCell(f"cell {element} of kind {kind!r}, nodes {nodes[element].tolist()}, is "
                           "inverted: correct the mesh or the order of its nodes", number,
                           element)
    slopes = np.einsum("egki,gai->egak", np.linalg.inv(jacobians), of_reference)
    return nodes, slopes, determinants * weights, law


# components (xx, yy, zz, yz, zx, xy) of tensors, and their places in these
_FIRST, _SECOND = np.array([0, 1, 2, 1, 2, 0]), np.array([0, 1, 2, 2, 0, 1])
_TENSOR = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])


def _gauss(count: int) -> tuple[NDArray, NDArray]:
    points, weights = np.polynomial.legendre.leggauss(count)
    return (np.array(list(product(points, repeat=3))),
            np.array([a * b * c for a, b, c in product(weights, repeat=3)]))


def _prism(triangle: tuple[tuple[float, float], ...], count: int) -> tuple[NDArray, NDArray]:
    """Points in the triangle with equal weights, Gauss's along the axis."""
    pairs = list(zip(*np.polynomial.legendre.leggauss(count), strict=True))
    return (np.array([(*place, z) for z, _ in pairs for place in triangle]),
            np.array([weight / 2 / len(triangle) for _, weight in pairs for _ in triangle]))


_NEAR, _FAR = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
_FOUR = np.array([(_NEAR, _NEAR, _NEAR), (_FAR, _NEAR, _NEAR), (_NEAR, _FAR, _NEAR),
                  (_NEAR, _NEAR, _FAR)])
# points and weights of the integration that FE programs use, of linear wedges two points
_RULES = {"tetra": (np.full((1, 3), 0.25), np.full(1, 1 / 6)),
          "tetra10": (_FOUR, np.full(4, 1 / 24)), "hexahedron": _gauss(2),
          "hexahedron20": _gauss(3), "hexahedron27": _gauss(3),
          "wedge": _prism(((1 / 3, 1 / 3),), 2),
          "wedge15": _prism(((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)), 3)}
