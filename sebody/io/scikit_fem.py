"""scikit-fem: an FE model of a basis and the matrices that were assembled with it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.isoparametric import reference_nodes
from sebody.fem.materials import uniform_material
from sebody.fem.matrices import fe_matrix
from sebody.fem.model import FEModel
from sebody.fem.solids import SolidPrestress, knows
from sebody.fem.stress import elasticity, solid_stress

_NO_MATERIAL = "no material was given; pass youngs_modulus and poisson_ratio"
_REMEDY = ("give a Basis of an ElementVector of Lagrange elements of order one or two, such as "
           "ElementVector(ElementHex1()) or ElementVector(ElementTetP2())")
# scikit-fem's elements of solids by meshio's names, with the scale and shift of its [0, 1]
KINDS = {"ElementTetP1": ("tetra", 1, 0), "ElementTetP2": ("tetra10", 1, 0),
         "ElementHex1": ("hexahedron", 2, -1), "ElementHexS2": ("hexahedron20", 2, -1),
         "ElementHex2": ("hexahedron27", 2, -1)}
_NAMES = ("x", "y", "z")


def from_skfem(basis: Any, stiffness: sparse.spmatrix, mass: sparse.spmatrix,
               youngs_modulus: float | None = None, poisson_ratio: float | None = None,
               units: str = "") -> FEModel:
    """FE model of a displacement field of scikit-fem.

    Parameters
    ----------
    basis : skfem.Basis
        Of an ``ElementVector`` of Lagrange elements with at most one node an edge, facet, cell.
    stiffness, mass : (n_dofs, n_dofs), sparse
        Assembled with the basis, without conditions.
    youngs_modulus, poisson_ratio : float, optional
        Isotropic material, for stresses and geometric stiffness; none without them.
    units : str
        Of the numbers, such as ``mm t N s``.

    Raises
    ------
    InputError
        Another kind of basis, matrices that do not fit it, or a material no solid has.
    """
    nodes = _nodes(basis)
    dimension, count = nodes.shape
    if dimension * count != basis.N:
        raise InputError(f"the basis has {basis.N} DOFs and {count} nodes: {_REMEDY}")
    stiffness, mass = fe_matrix(stiffness, "stiffness"), fe_matrix(mass, "mass")
    owner = np.empty(basis.N, dtype=int)
    owner[nodes] = np.arange(count)
    axis = np.empty(basis.N, dtype=int)
    axis[nodes] = np.arange(dimension)[:, None]
    dof_map = [(node, _NAMES[k]) for node, k in zip(owner.tolist(), axis.tolist(), strict=True)]
    points = basis.doflocs[:, nodes[0]].T
    cells = _cells(basis, owner, points)
    if (youngs_modulus is None) != (poisson_ratio is None):
        raise InputError("give both youngs_modulus and poisson_ratio, or none of them")
    geometric, stress, materials = None, (), ()
    missing = dict.fromkeys(("stresses", "stiffening"), _NO_MATERIAL)
    if youngs_modulus is not None:
        law = (inputs.number(youngs_modulus, "youngs_modulus", above=0),
               inputs.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5))
        if not cells or not knows(cells[0][0]):
            raise InputError(f"no geometric stiffness of {_name(basis)} elements: use "
                             f"{', '.join(KINDS)}, or leave out the material")
        by_nodes = sparse.csr_array((np.ones(basis.N), (3 * owner + axis, np.arange(basis.N))),
                                    shape=(basis.N, basis.N))
        stress = solid_stress(points, cells, *law)
        geometric = SolidPrestress(points, [(*cells[0], elasticity(*law))], by_nodes)
        materials = [uniform_material(law[0], mass.sum() / dimension, geometric.volume)]
        missing = {}
    return FEModel(stiffness, mass, points, dof_map=dof_map, cells=cells,
                   node_sets=_boundaries(basis, owner), geometric_stiffness=geometric,
                   stress=stress, source=f"scikit-fem, {_name(basis)}", units=units,
                   missing=missing, materials=materials)


def _nodes(basis: Any) -> NDArray:
    """DOFs of every node, (dimension, n_nodes): of vertices, edges, facets, interiors."""
    try:
        dimension = basis.mesh.dim()
        parts = [np.asarray(part) for part in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs,
                                               basis.interior_dofs)]
        several = any(len(part) not in (0, dimension) for part in parts if part.size)
        numbers = np.hstack([part for part in parts if part.size])
    except (AttributeError, ValueError) as error:
        raise inputs.refusal("basis", basis, _REMEDY) from error
    places = basis.doflocs[:, numbers]                    # (dimension, components, nodes)
    if several or dimension not in (2, 3) or not np.array_equal(
            places, np.broadcast_to(places[:, :1], places.shape)):
        raise InputError(f"the basis of {_name(basis)} elements does not consist of displacements "
                         f"at nodes: {_REMEDY}")
    return numbers


def _name(basis: Any) -> str:
    return type(getattr(basis.elem, "elem", basis.elem)).__name__


def _cells(basis: Any, owner: NDArray, points: NDArray) -> list[tuple[str, NDArray]]:
    """The elements in meshio's order of nodes."""
    if _name(basis) not in KINDS:
        return []
    kind, scale, shift = KINDS[_name(basis)]
    own = scale * np.asarray(basis.elem.elem.doflocs) + shift
    nodes = owner[basis.element_dofs[::points.shape[1]]].T              # (e, a)
    wanted = reference_nodes(kind)
    straight, mirrored = (nodes[:, _order(own, reference)]
                          for reference in (wanted, wanted[:, [1, 0, 2]]))
    # scikit-fem sorts the vertices of cells, so half of them may be mirrored
    edges = points[straight[:, _axes(wanted)]] - points[straight[:, :1]]
    positive = np.linalg.det(edges) > 0
    return [(kind, np.where(positive[:, None], straight, mirrored))]


def _order(own: NDArray, wanted: NDArray) -> NDArray:
    distances = np.linalg.norm(wanted[:, None] - own[None], axis=2)
    return distances.argmin(axis=1)


def _axes(nodes: NDArray) -> list[int]:
    """Nodes that are the neighbours of the first one along the axes."""
    steps = np.eye(3) * np.ptp(nodes, axis=0).max()
    return _order(nodes, nodes[0] + steps).tolist()


def _boundaries(basis: Any, owner: NDArray) -> dict[str, list[int]]:
    """Named boundaries of the mesh as node sets."""
    names = basis.mesh.boundaries or {}
    return {str(name): np.unique(owner[basis.get_dofs(str(name)).all()]).tolist()
            for name in names}
