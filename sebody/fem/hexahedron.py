"""A rectangular block of 8-node hexahedra with incompatible modes (translation DOFs only)."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from sebody.basics import inputs, memory
from sebody.fem.layout import SOLID
from sebody.fem.materials import Material
from sebody.fem.matrices import assemble
from sebody.fem.model import FEModel
from sebody.fem.stress import SolidStress, elasticity

_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))[:, ::-1]  # x runs fastest
OF_ELEMENT = 40_000     # bytes: entries of its matrices, and what their assembly needs
_MESHIO = [0, 1, 3, 2, 4, 5, 7, 6]  # the same corners in the order of meshio


def hexahedral_block(
    corner: ArrayLike,
    size: ArrayLike,
    divisions: tuple[int, int, int],
    youngs_modulus: float,
    poisson_ratio: float,
    density: float,
) -> FEModel:
    """Block with edges along the axes, of equal hexahedra; x runs fastest in the node order.

    The incompatible modes of R.L. Taylor, P.J. Beresford and E.L. Wilson (Int. J. Numer. Meth.
    Engng 10, 1976), condensed in each element, let one element follow pure bending.

    Parameters
    ----------
    corner : (3,)
        Corner with the smallest coordinates [length].
    size : (3,)
        Edge lengths [length].
    divisions : (int, int, int)
        Number of elements along each edge.
    youngs_modulus, poisson_ratio, density : float
        Isotropic material.

    Raises
    ------
    InputError
        A size, division, modulus or density that is not positive; a Poisson's ratio outside
        (-1, 0.5).
    """
    corner = inputs.vector(corner, "block corner", 3)
    size = inputs.vector(size, "block size", 3)
    for edge in size:
        inputs.number(edge, "block size: an edge", above=0)
    remedy = "give three whole numbers >= 1"
    counts = np.array([inputs.integer(count, "block divisions: one", least=1) for count in
                       inputs.vector(divisions, "block divisions", 3, remedy=remedy)])
    inputs.number(youngs_modulus, "block youngs_modulus", above=0)
    inputs.number(density, "block density", above=0)
    inputs.number(poisson_ratio, "block poisson_ratio", above=-1, below=0.5)

    memory.check(float(OF_ELEMENT) * float(np.prod(counts.astype(float))),
                 f"block divisions is {inputs.shown(divisions)}: the model", "give fewer divisions")
    nx, ny, nz = counts + 1
    z, y, x = (grid.ravel() for grid in np.meshgrid(*map(np.arange, (nz, ny, nx)), indexing="ij"))
    nodes = corner + np.column_stack([x, y, z]) * (size / counts)
    inside = (x < nx - 1) & (y < ny - 1) & (z < nz - 1)
    step = ((_CORNERS + 1) / 2).astype(int) @ np.array([1, nx, nx * ny])
    connectivity = np.flatnonzero(inside)[:, None] + step
    dofs = (3 * connectivity[:, :, None] + np.arange(3)).reshape(len(connectivity), 24)
    *matrices, strains, slopes = _brick(size / counts, youngs_modulus, poisson_ratio, density)
    stiffness, mass = (
        assemble(dofs, np.broadcast_to(matrix, (len(dofs), 24, 24)), 3 * len(nodes))
        for matrix in matrices
    )
    law, volume = elasticity(youngs_modulus, poisson_ratio), np.prod(size / counts) / 8
    cells = connectivity[:, _MESHIO]
    columns = (3 * np.array(_MESHIO)[:, None] + np.arange(3)).ravel()
    own = SolidStress("hexahedron", cells, nodes, law, strains[_MESHIO][:, :, columns])
    return FEModel(stiffness, mass, nodes, SOLID, cells=[("hexahedron", cells)], stress=(own,),
                   materials=[Material("", float(np.sqrt(youngs_modulus / density)), density)],
                   geometric_stiffness=BrickPrestress(dofs, volume * law @ strains, slopes,
                                                      3 * len(nodes)))


class BrickPrestress:
    """Geometric stiffness ``integral sigma_ij N_a,i N_b,j (x) I`` of the linear stresses.

    O.C. Zienkiewicz and R.L. Taylor, The Finite Element Method, vol. 2. Incompatible modes take
    part in the stresses alone.

    Parameters
    ----------
    dofs : (n, 24)
        DOFs of the elements, the same for all.
    stresses : (g, 6, 24)
        Stress at each integration point times its volume, of unit DOFs.
    slopes : (g, 8, 3)
        Gradients of the nodes' shape functions there [1/length].
    size : int
        Number of DOFs.
    """

    def __init__(self, dofs: NDArray, stresses: NDArray, slopes: NDArray, size: int):
        self._dofs, self._size = dofs, size
        # of unit stresses: (xx, yy, zz, yz, zx, xy)
        parts = [slopes[:, :, None, i] * slopes[:, None, :, j] for i in range(3) for j in range(3)]
        whole = np.array(parts).reshape(3, 3, *parts[0].shape)
        units = [whole[i, i] for i in range(3)] + [
            whole[i, j] + whole[j, i] for i, j in ((1, 2), (2, 0), (0, 1))]
        # rows of the DOFs, columns of the pairs of nodes
        self._factors = np.einsum("gsa,sgmn->amn", stresses, np.array(units)).reshape(24, 64)

    def __call__(self, displacement: NDArray) -> sparse.csc_array:
        """Geometric stiffness (n_dofs, n_dofs) of the displacement (n_dofs,) of a prestress."""
        by_nodes = (displacement[self._dofs] @ self._factors).reshape(-1, 8, 8)
        nodes = self._dofs[:, ::3] // 3
        one = assemble(nodes, (by_nodes + by_nodes.transpose(0, 2, 1)) / 2, self._size // 3)
        return sparse.csc_array(sparse.kron(one, sparse.eye_array(3)))


def _brick(
    edges: NDArray, youngs_modulus: float, poisson_ratio: float, density: float
) -> tuple[NDArray, ...]:
    """One rectangular element, 2 x 2 x 2 Gauss points.

    Returns
    -------
    stiffness, mass : (24, 24)
    strains : (8, 6, 24)
        At the Gauss points.
    slopes : (8, 8, 3)
        Gradients of the shape functions of the nodes there.
    """
    law = elasticity(youngs_modulus, poisson_ratio)
    weight = np.prod(edges) / 8
    full, mass = np.zeros((33, 33)), np.zeros((8, 8))
    strains, gradients = [], []
    for point in _CORNERS / np.sqrt(3):
        factors = (1 + _CORNERS * point) / 2
        shape = factors.prod(axis=1)
        slopes = np.zeros((11, 3))  # 8 shape functions, then 1 - s^2 along each edge
        for axis in range(3):
            others = np.delete(factors, axis, axis=1).prod(axis=1)
            slopes[:8, axis] = _CORNERS[:, axis] / 2 * others
            slopes[8 + axis, axis] = -2 * point[axis]
        gradients.append(slopes * 2 / edges)
        strain = _strain(gradients[-1])
        strains.append(strain)
        full += weight * strain.T @ law @ strain
        mass += weight * density * np.outer(shape, shape)
    nodal, extra = slice(0, 24), slice(24, 33)
    condensed = np.linalg.solve(full[extra, extra], full[extra, nodal])
    stiffness = full[nodal, nodal] - full[nodal, extra] @ condensed
    whole = np.vstack([np.eye(24), -condensed])     # incompatible modes follow the nodes
    return ((stiffness + stiffness.T) / 2, np.kron(mass, np.eye(3)), np.array(strains) @ whole,
            np.array(gradients)[:, :8])


def _strain(slopes: NDArray) -> NDArray:
    """Strains (6, 3 n) of n functions with gradients `slopes` (n, 3)."""
    strain = np.zeros((6, len(slopes), 3))
    for axis in range(3):
        after, last = (axis + 1) % 3, (axis + 2) % 3
        strain[axis, :, axis] = slopes[:, axis]
        strain[3 + axis, :, after] = slopes[:, last]
        strain[3 + axis, :, last] = slopes[:, after]
    return strain.reshape(6, -1)
