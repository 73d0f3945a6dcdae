"""NGSolve: an FE model of a space of displacements and the matrices assembled with it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.materials import uniform_material
from sebody.fem.model import FEModel
from sebody.fem.solids import TETRAHEDRON_EDGES, SolidPrestress, knows
from sebody.fem.stress import elasticity, solid_stress
from sebody.io.tied import motion_of

_NO_MATERIAL = "no material was given; pass youngs_modulus and poisson_ratio"
_REMEDY = "give VectorH1(mesh, order=1) or order=2, whole (no dirichlet), on straight cells"
_NAMES = ("x", "y", "z")
_KINDS = {("TET", 1): "tetra", ("TET", 2): "tetra10"}


def from_ngsolve(space: Any, stiffness: Any, mass: Any, youngs_modulus: float | None = None,
                 poisson_ratio: float | None = None, units: str = "") -> FEModel:
    """FE model of a displacement field of NGSolve.

    Its shapes of order two are not displacements of nodes; the matrices are turned to the
    displacements of vertices and of the middles of edges.

    Parameters
    ----------
    space : ngsolve.VectorH1
        Of order one, or of order two on tetrahedra or triangles.
    stiffness, mass : ngsolve.BilinearForm
        Assembled; whole matrices, not symmetric storage.
    youngs_modulus, poisson_ratio : float, optional
        Isotropic material, for stresses and geometric stiffness; none without them.
    units : str
        Of the numbers, such as ``mm t N s``.

    Raises
    ------
    InputError
        Another kind of space, or matrices that do not fit it.
    """
    mesh, dimension, rows = _rows(space)
    ends = np.array([[v.nr for v in edge.vertices] for edge in mesh.edges]).reshape(-1, 2)
    corners = np.array([vertex.point for vertex in mesh.vertices])
    ends = ends[:rows.shape[0] - len(corners)]
    points = np.vstack([corners, _middles(space, mesh, rows, ends)])
    turn = _nodal(space, mesh, rows, ends)
    matrices = [sparse.csc_array(turn.T @ _matrix(form, name, space.ndof) @ turn)
                for form, name in ((stiffness, "stiffness"), (mass, "mass"))]
    dof_map: list = [None] * rows.size
    for node, own in enumerate(rows.tolist()):
        for row, name in zip(own, _NAMES, strict=False):
            dof_map[row] = (node, name)
    cells = _cells(mesh, points, len(corners), ends)
    geometric, stress, materials = None, (), ()
    missing = dict.fromkeys(("stresses", "stiffening"), _NO_MATERIAL)
    if youngs_modulus is not None and poisson_ratio is not None:
        law = (inputs.number(youngs_modulus, "youngs_modulus", above=0),
               inputs.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5))
        if len(cells) != 1 or not knows(cells[0][0]):
            raise InputError("no geometric stiffness of these cells: use tetrahedra, or leave out "
                             "the material")
        whole = np.hstack([rows, np.full(rows.shape, -1)])
        stress = solid_stress(points, cells, *law)
        geometric = SolidPrestress(points, [(*cells[0], elasticity(*law))],
                                   motion_of(whole, np.zeros_like(points), space.ndof))
        materials = [uniform_material(law[0], matrices[1].sum() / dimension, geometric.volume)]
        missing = {}
    return FEModel(*matrices, points, dof_map=dof_map, cells=cells,
                   node_sets=_boundaries(mesh, ends),
                   geometric_stiffness=geometric, stress=stress,
                   source=f"NGSolve, VectorH1 of order {2 if len(ends) else 1}", units=units,
                   missing=missing, materials=materials)


def _rows(space: Any) -> tuple[Any, int, NDArray]:
    """Mesh, dimension, and the DOFs (n_nodes, dimension) of vertices, then edges."""
    from ngsolve import EDGE, VERTEX, NodeId

    try:
        mesh = space.mesh
        dimension, components = mesh.dim, len(space.components)
        rows = [list(space.GetDofNrs(NodeId(VERTEX, k))) for k in range(mesh.nv)]
        edges = [list(space.GetDofNrs(NodeId(EDGE, k))) for k in range(mesh.nedge)]
        free = sum(space.FreeDofs())
    except (AttributeError, TypeError) as error:
        raise inputs.refusal("space", space, _REMEDY) from error
    rows += [numbers for numbers in edges if numbers]
    if components != dimension or any(len(numbers) != dimension for numbers in rows) or (
            len(rows) * dimension != space.ndof) or free != space.ndof:
        raise InputError(f"the space has {space.ndof} DOFs, {free} of them free, and "
                         f"{len(rows)} vertices and edges with {dimension} displacements: "
                         f"{_REMEDY}")
    return mesh, dimension, np.array(rows)


def _matrix(form: Any, name: str, size: int) -> sparse.csc_array:
    try:
        rows, columns, values = form.mat.COO()
        shape = form.mat.height, form.mat.width
    except (AttributeError, TypeError) as error:
        raise inputs.refusal(name, form, "give an assembled BilinearForm") from error
    if shape != (size, size):
        raise InputError(f"{name} has shape {shape}; the space has {size} DOFs: assemble it with "
                         "this space")
    matrix = sparse.csc_array(sparse.coo_array((np.array(values), (np.array(rows),
                                                                   np.array(columns)))))
    matrix.resize(size, size)
    if not sparse.triu(matrix, 1).nnz:      # symmetric storage keeps one triangle
        matrix = matrix + sparse.tril(matrix, -1).T
    return matrix


def _nodal(space: Any, mesh: Any, rows: NDArray, ends: NDArray) -> sparse.csr_array:
    """Coefficients (n_dofs, n_dofs) of displacements of the nodes, in the rows of the former."""
    matrix = sparse.eye_array(space.ndof, format="lil")
    if len(ends):
        scale = _edge_value(space, mesh, rows, ends)
        first = mesh.nv
        for axis in range(rows.shape[1]):
            inner = rows[first:, axis]
            matrix[inner, inner] = 1 / scale
            for end in ends.T:
                matrix[inner, rows[end, axis]] = -0.5 / scale
    return sparse.csr_array(matrix)


def _middles(space: Any, mesh: Any, rows: NDArray, ends: NDArray) -> NDArray:
    """Places of the middles of edges, (n_edges, dimension), which ``mesh.Curve(2)`` has moved.

    The geometry of order two is a displacement field of the space: its coefficients are exact.

    Raises
    ------
    InputError
        A mesh of higher order.
    """
    order = mesh.GetCurveOrder()
    if order > (2 if len(ends) else 1):
        raise InputError(
            f"the mesh is curved, of order {order}, beyond what the space has nodes for: " + (
                "call mesh.Curve(2)" if len(ends) else
                "take VectorH1(mesh, order=2) with mesh.Curve(2), or mesh.Curve(1)"))
    if order < 2 or not len(ends):
        corners = np.array([vertex.point for vertex in mesh.vertices])
        return corners[ends].mean(axis=1).reshape(len(ends), corners.shape[1])
    from ngsolve import CoefficientFunction, GridFunction, x, y, z

    field = GridFunction(space)
    field.Set(CoefficientFunction((x, y, z)[:mesh.dim]))
    values = np.array(field.vec)[rows]
    return values[ends].mean(axis=1) + _edge_value(space, mesh, rows, ends) * values[mesh.nv:]


def _edge_value(space: Any, mesh: Any, rows: NDArray, ends: NDArray) -> float:
    """Value of the shape of an edge at its middle, the same of all edges."""
    from ngsolve import GridFunction

    field = GridFunction(space)
    sizes = []
    for edge in {0, len(ends) // 2, len(ends) - 1}:
        field.vec[:] = 0.0
        field.vec[int(rows[mesh.nv + edge, 0])] = 1.0
        sizes.append(_at_middle(field, mesh, edge))
    if np.ptp(sizes) > 1e-12 or not abs(sizes[0]) > 1e-12:
        raise InputError(f"the shapes of edges have the values {sizes} in their middles: {_REMEDY}")
    return float(sizes[0])


def _at_middle(field: Any, mesh: Any, edge: int) -> float:
    """First component of a field in the middle of an edge, where it is straight or not."""
    from ngsolve import EDGE, NodeId

    element = next(iter(mesh[NodeId(EDGE, edge)].elements))
    corners = [vertex.nr for vertex in mesh[element].vertices]
    wanted = {vertex.nr for vertex in mesh[NodeId(EDGE, edge)].vertices}
    # NGSolve's reference simplices have their corners at e_1, e_2, (e_3,) and the origin
    places = np.vstack([np.eye(mesh.dim), np.zeros(mesh.dim)])
    at = np.mean([place for place, corner in zip(places, corners, strict=True)
                  if corner in wanted], axis=0)
    element_map = mesh.GetTrafo(element)        # which the point needs as long as it is used
    return field(element_map(*at))[0]


def _cells(mesh: Any, points: NDArray, count: int, ends: NDArray) -> list[tuple[str, NDArray]]:
    """Tetrahedra in meshio's order of nodes, turned right way round."""
    edge_of = {tuple(sorted(pair)): count + k for k, pair in enumerate(ends.tolist())}
    by_kind: dict[str, list] = {}
    for element in mesh.Elements():
        kind = _KINDS.get((str(element.type).removeprefix("ET."), 2 if len(ends) else 1))
        if kind is None:
            return []
        corners = [vertex.nr for vertex in element.vertices]
        if np.linalg.det(points[corners[1:]] - points[corners[0]]) < 0:
            corners[:2] = corners[1::-1]
        middles = [edge_of[tuple(sorted((corners[i], corners[j])))]
                   for i, j in TETRAHEDRON_EDGES] if len(ends) else []
        by_kind.setdefault(kind, []).append(corners + middles)
    return [(kind, np.array(cells)) for kind, cells in by_kind.items()]


def _boundaries(mesh: Any, ends: NDArray) -> dict[str, list[int]]:
    """Named boundaries as node sets."""
    sets, count = {}, mesh.nv
    for name in dict.fromkeys(mesh.GetBoundaries()):
        elements = list(mesh.Boundaries(name).Elements())
        corners = {vertex.nr for element in elements for vertex in element.vertices}
        middles = {count + edge.nr for element in elements for edge in element.edges
                   if len(ends)}
        if name:
            sets[str(name)] = sorted(corners | middles)
    return sets
