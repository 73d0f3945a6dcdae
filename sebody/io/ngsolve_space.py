"""NGSolve: an FE model of a space of displacements and the matrices assembled with it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody import inputs
from sebody.errors import InputError
from sebody.fem.model import FEModel
from sebody.fem.solids import TETRAHEDRON_EDGES, SolidPrestress, knows
from sebody.fem.stress import solid_stress
from sebody.io.tied import motion_of

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
        In words.

    Raises
    ------
    InputError
        Another kind of space, or matrices that do not fit it.
    """
    mesh, dimension, rows = _rows(space)
    ends = np.array([[v.nr for v in edge.vertices] for edge in mesh.edges]).reshape(-1, 2)
    corners = np.array([vertex.point for vertex in mesh.vertices])
    ends = ends[:rows.shape[0] - len(corners)]
    points = np.vstack([corners, corners[ends].mean(axis=1)])
    turn = _nodal(space, mesh, rows, ends)
    matrices = [sparse.csc_array(turn.T @ _matrix(form, name, space.ndof) @ turn)
                for form, name in ((stiffness, "stiffness"), (mass, "mass"))]
    dof_map: list = [None] * rows.size
    for node, own in enumerate(rows.tolist()):
        for row, name in zip(own, _NAMES, strict=False):
            dof_map[row] = (node, name)
    cells = _cells(mesh, points, len(corners), ends)
    geometric, stress = None, ()
    if youngs_modulus is not None and poisson_ratio is not None:
        law = (inputs.number(youngs_modulus, "youngs_modulus", above=0),
               inputs.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5))
        if len(cells) != 1 or not knows(cells[0][0]):
            raise InputError("no geometric stiffness of these cells: use tetrahedra, or leave out "
                             "the material")
        whole = np.hstack([rows, np.full(rows.shape, -1)])
        stress = solid_stress(points, cells, *law)
        geometric = SolidPrestress(points, [(*cells[0], *law)],
                                   motion_of(whole, np.zeros_like(points), space.ndof))
    return FEModel(*matrices, points, dof_map=dof_map, cells=cells,
                   node_sets=_boundaries(mesh, ends),
                   geometric_stiffness=geometric, stress=stress,
                   source=f"NGSolve, VectorH1 of order {2 if len(ends) else 1}", units=units)


def _rows(space: Any) -> tuple[Any, int, NDArray]:
    """Mesh, dimension, and the DOFs (n_nodes, dimension) of vertices, then edges."""
    from ngsolve import EDGE, VERTEX, NodeId

    try:
        mesh = space.mesh
        dimension, components = mesh.dim, len(space.components)
        found = [list(space.GetDofNrs(NodeId(VERTEX, k))) for k in range(mesh.nv)]
        edges = [list(space.GetDofNrs(NodeId(EDGE, k))) for k in range(mesh.nedge)]
        free = sum(space.FreeDofs())
    except (AttributeError, TypeError) as error:
        raise inputs.refusal("space", space, _REMEDY) from error
    found += [own for own in edges if own]
    if components != dimension or any(len(own) != dimension for own in found) or (
            len(found) * dimension != space.ndof) or free != space.ndof:
        raise InputError(f"the space has {space.ndof} DOFs, {free} of them free, and "
                         f"{len(found)} vertices and edges with {dimension} displacements: "
                         f"{_REMEDY}")
    return mesh, dimension, np.array(found)


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
            own = rows[first:, axis]
            matrix[own, own] = 1 / scale
            for end in ends.T:
                matrix[own, rows[end, axis]] = -0.5 / scale
    return sparse.csr_array(matrix)


def _edge_value(space: Any, mesh: Any, rows: NDArray, ends: NDArray) -> float:
    """Value of the shape of an edge at its middle, the same of all edges."""
    from ngsolve import GridFunction

    field = GridFunction(space)
    found = []
    for edge in {0, len(ends) // 2, len(ends) - 1}:
        field.vec[:] = 0.0
        field.vec[int(rows[mesh.nv + edge, 0])] = 1.0
        middle = np.mean([mesh.vertices[int(v)].point for v in ends[edge]], axis=0)
        found.append(field(mesh(*middle))[0])
    if np.ptp(found) > 1e-12 or not abs(found[0]) > 1e-12:
        raise InputError(f"the shapes of edges have the values {found} in their middles: {_REMEDY}")
    return float(found[0])


def _cells(mesh: Any, points: NDArray, count: int, ends: NDArray) -> list[tuple[str, NDArray]]:
    """Tetrahedra in meshio's order of nodes, turned right way round."""
    edge_of = {tuple(sorted(pair)): count + k for k, pair in enumerate(ends.tolist())}
    found: dict[str, list] = {}
    for element in mesh.Elements():
        kind = _KINDS.get((str(element.type).removeprefix("ET."), 2 if len(ends) else 1))
        if kind is None:
            return []
        corners = [vertex.nr for vertex in element.vertices]
        if np.linalg.det(points[corners[1:]] - points[corners[0]]) < 0:
            corners[:2] = corners[1::-1]
        middles = [edge_of[tuple(sorted((corners[i], corners[j])))]
                   for i, j in TETRAHEDRON_EDGES] if len(ends) else []
        found.setdefault(kind, []).append(corners + middles)
    return [(kind, np.array(cells)) for kind, cells in found.items()]


def _boundaries(mesh: Any, ends: NDArray) -> dict[str, list[int]]:
    """Named boundaries as node sets."""
    found, count = {}, mesh.nv
    for name in dict.fromkeys(mesh.GetBoundaries()):
        elements = list(mesh.Boundaries(name).Elements())
        corners = {vertex.nr for element in elements for vertex in element.vertices}
        middles = {count + edge.nr for element in elements for edge in element.edges
                   if len(ends)}
        if name:
            found[str(name)] = sorted(corners | middles)
    return found
