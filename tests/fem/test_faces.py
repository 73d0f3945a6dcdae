"""Outer faces and their integrals: areas and second moments of bodies that scikit-fem meshes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody.fem import FEModel, hexahedral_block
from sebody.fem.face_functions import face_rule
from sebody.fem.faces import faces_within, normals, surface_mass

TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
SIZES = np.array([3.0, 2.0, 1.0])


def block(kind):
    """A turned and stretched block, 2 x 1 x 1 cells or twelve tetrahedra, of a kind of element."""
    skfem = pytest.importorskip("skfem")
    mesh = {"hexahedron": skfem.MeshHex, "tetra": skfem.MeshTet,
            "wedge": skfem.MeshWedge1}[kind.rstrip("01257")]()
    mesh = mesh.refined(1) if kind.startswith("tetra") else mesh
    points, cells = mesh.p.T, mesh.t.T
    if kind.startswith("hexahedron"):
        # scikit-fem counts the corners of a cell in another order than VTK
        centre = points[cells].mean(axis=1, keepdims=True)
        signs = np.sign(points[cells] - centre).astype(int)
        vtk = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
               (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
        order = np.array([[np.flatnonzero((s == v).all(axis=1))[0] for v in vtk] for s in signs])
        cells = np.take_along_axis(cells, order, axis=1)
    if kind[-1].isdigit():
        points, cells = with_middles(kind, points, cells)
    if kind == "hexahedron27":
        points, cells = with_middles_of_faces(points, cells)
    return points * SIZES @ TURN.T + [5, 6, 7], cells


EDGES = {"tetra10": [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)],
         "hexahedron20": [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4),
                          (1, 5), (2, 6), (3, 7)]}


EDGES["hexahedron27"] = EDGES["hexahedron20"]
# those of VTK: x-, x+, y-, y+, z-, z+, and the cell itself
MIDDLES = [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7),
           tuple(range(8))]


def with_middles_of_faces(points, cells):
    for corners in MIDDLES:     # faces of two cells come twice: their places are one
        own = np.arange(len(points), len(points) + len(cells))
        points = np.vstack([points, points[cells[:, list(corners)]].mean(axis=1)])
        cells = np.hstack([cells, own[:, None]])
    _, first, index = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    return points[first], index.ravel()[cells]


def with_middles(kind, points, cells):
    edges = np.sort(np.stack([cells[:, list(edge)] for edge in EDGES[kind]], axis=1), axis=2)
    unique, index = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    middles = len(points) + index.reshape(len(cells), -1)
    return np.vstack([points, points[unique].mean(axis=1)]), np.hstack([cells, middles])


def model_of(points, cells):
    eye = np.eye(points.size)
    return FEModel(eye, eye, points, ("x", "y", "z"), cells=cells)


@pytest.mark.parametrize("kind", ["hexahedron", "hexahedron20", "hexahedron27", "tetra",
                                  "tetra10", "wedge"])
def test_the_surface_of_a_block(kind):
    points, cells = block(kind)
    model = model_of(points, [(kind, cells)])
    nodes = np.arange(len(points))
    W = surface_mass(model, nodes)
    a, b, c = SIZES
    assert_allclose(W.sum(), 2 * (a * b + b * c + c * a), rtol=1e-13)
    # second moment about the end face's middle of the end face across x alone
    local = (points - [5, 6, 7]) @ TURN
    end = np.flatnonzero(local[:, 0] > a - 1e-9)
    W = surface_mass(model, end)
    arms = local[end] - [a, b / 2, c / 2]
    # bilinear, quadratic and linear functions of a plane face hold its coordinates exactly
    expected = np.diag([0, b**3 * c / 12, c**3 * b / 12])
    assert_allclose(arms.T @ (W @ arms), expected, atol=1e-12)
    # outward normals: the volume by the divergence theorem
    volume = 0.0
    for face_kind, faces in faces_within(model, nodes):
        values, slopes, weights = face_rule(face_kind)
        places = np.einsum("ga,fad->fgd", values, points[faces])
        volume += np.einsum("fgd,fgd,g->", places, normals(points[faces], slopes), weights) / 3
    assert_allclose(volume, a * b * c, rtol=1e-12)


def test_shells_are_faces_and_planes_have_edges():
    points = np.array([[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [4, 0, 0.0]])
    shell = model_of(points @ TURN.T, [("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]])])
    assert_allclose(surface_mass(shell, np.arange(5)).sum(), 9.0, rtol=1e-14)
    areas = surface_mass(shell, np.arange(4)).sum(axis=0)
    assert_allclose(areas, 1.5, rtol=1e-14)
    eye = np.eye(15)
    plane = FEModel(eye, eye, points[:, :2], ("x", "y", "rz"), cells=shell.cells)
    edge = surface_mass(plane, np.array([0, 1, 4]))
    assert_allclose(edge.toarray(), np.array([[4, 2, 0], [2, 8, 2], [0, 2, 4]]) / 6, rtol=1e-14)
    quadratic = FEModel(np.eye(24), np.eye(24), np.array([
        [0, 0], [2, 0], [2, 3], [0, 3], [1, 0], [2, 1.5], [1, 3], [0, 1.5]]), ("x", "y", "rz"),
        cells=[("quad8", [range(8)])])
    assert_allclose(surface_mass(quadratic, np.array([1, 5, 2])).sum(axis=0), [0.5, 2, 0.5],
                    rtol=1e-14)
    assert faces_within(plane, [0, 4]) == []


def test_blocks_know_their_elements():
    block = hexahedral_block([1, 2, 3], [3, 2, 1], (3, 2, 1), 1.0, 0.3, 1.0)
    assert_allclose(surface_mass(block, np.arange(24)).sum(), 22.0, rtol=1e-14)
