"""Parts of a surface, and numbers that are computed for every surface."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

FOLD = np.radians(30.0)     # between faces, from which their edge is drawn
TOGETHER = 1e-6             # of the extent: nearer vertices are at one place


class Surface(NamedTuple):
    """Stations, and vertices and triangles on them, in axes of the body; N amplitudes.

    Displacements and rotations of stations are linear in the amplitudes. A vertex is between some
    stations, or a corner of a beam's section about one.
    """

    points: NDArray         # (stations, 3)
    moves: NDArray          # (N, stations, 3) displacements of unit amplitudes
    turns: NDArray          # (N, stations, 3) rotations likewise
    weights: sparse.csr_array       # (vertices, stations) of the stations in a vertex
    offsets: NDArray        # (vertices, 3) from there, turning with the stations
    triangles: NDArray      # (triangles, 3) of vertices; those of beams and solids face outwards
    edges: NDArray          # (edges, 2) of vertices: those of elements
    features: NDArray       # (features, 2) of vertices: the rim, and folds
    nodes: NDArray          # (stations, 2) FE nodes that a station is between
    shares: NDArray         # (stations,) part of the way from the first to the second

    @property
    def vertices(self) -> NDArray:
        """Vertices of the undeformed body, (vertices, 3)."""
        return self.weights @ self.points + self.offsets


def joined(parts: list[Surface]) -> Surface:
    """One surface of several."""
    if len(parts) == 1:
        return parts[0]
    first = np.cumsum([0, *(len(p.offsets) for p in parts)])
    return Surface(
        np.concatenate([p.points for p in parts]),
        *(np.concatenate([getattr(p, name) for p in parts], axis=1) for name in ("moves", "turns")),
        sparse.csr_array(sparse.block_diag([p.weights for p in parts])),
        np.concatenate([p.offsets for p in parts]),
        *(np.concatenate([getattr(p, name) + k for p, k in zip(parts, first, strict=False)])
          for name in ("triangles", "edges", "features")),
        *(np.concatenate([getattr(p, name) for p in parts]) for name in ("nodes", "shares")))


def triangles_of(faces: NDArray) -> NDArray:
    """Faces of three or four corners as triangles."""
    return faces if faces.shape[1] == 3 else np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]])


NO_EDGES = np.zeros((0, 2), dtype=int)


def edges_of(faces: NDArray) -> NDArray:
    """Edges of faces, each once."""
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def folded(surface: Surface) -> Surface:
    """The surface with its features, and with vertices of their own on either side of folds.

    So the mean of the normals around a vertex is that of a smooth part.
    """
    triangles, vertices = surface.triangles, surface.vertices
    if not len(triangles):
        return surface
    corners = np.array([[0, 1], [1, 2], [2, 0]])
    sides = triangles[:, corners].reshape(-1, 2)
    at = (3 * np.arange(len(triangles))[:, None, None] + corners).reshape(-1, 2)    # corners
    places = _places(vertices)
    proper = places[sides[:, 0]] != places[sides[:, 1]]
    sides, at = sides[proper], at[proper]
    # sides from the lower to the higher place, those of one edge after each other
    backwards = places[sides[:, 0]] > places[sides[:, 1]]
    sides, at = (np.where(backwards[:, None], one[:, ::-1], one) for one in (sides, at))
    order = np.lexsort(places[sides].T)
    sides, at, backwards = sides[order], at[order], backwards[order]
    new = np.any(np.diff(places[sides], axis=0) != 0, axis=1)
    first = np.flatnonzero(np.concatenate([[True], new]))
    count = np.diff([*first, len(sides)])
    one, other = first[count == 2], first[count == 2] + 1
    normals = _normals(vertices, triangles)
    cosine = np.einsum("ni,ni->n", normals[at[one, 0] // 3], normals[at[other, 0] // 3])
    # of neighbours that run along their edge in the same way one faces inwards
    smooth = cosine * np.where(backwards[one] == backwards[other], -1.0, 1.0) >= np.cos(FOLD)
    one, other = one[smooth], other[smooth]
    features = np.setdiff1d(first, one)
    return _split(surface, np.concatenate([
        np.column_stack([at[one, k], at[other, k]])[sides[one, k] == sides[other, k]]
        for k in (0, 1)]), at[features])


def _split(surface: Surface, joined_corners: NDArray, features: NDArray) -> Surface:
    """A vertex for each set of corners of triangles that are joined; features by corners."""
    count = surface.triangles.size
    graph = sparse.coo_array((np.ones(len(joined_corners)), joined_corners.T),
                             shape=(count, count))
    vertices, number = connected_components(graph, directed=False)
    old = np.zeros(vertices, dtype=int)
    old[number] = surface.triangles.ravel()
    some = np.zeros(len(surface.offsets), dtype=int)    # one of the vertices that one has become
    some[old] = np.arange(vertices)
    return surface._replace(
        weights=surface.weights[old], offsets=surface.offsets[old],
        triangles=number.reshape(-1, 3), edges=some[surface.edges], features=number[features])


def _normals(vertices: NDArray, triangles: NDArray) -> NDArray:
    """Normals of triangles, (triangles, 3)."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


def _places(vertices: NDArray) -> NDArray:
    """Numbers of the places of vertices, (vertices,): equal where they coincide."""
    near = TOGETHER * np.ptp(vertices, axis=0).max()
    pairs = cKDTree(vertices).query_pairs(near, output_type="ndarray")
    n = len(vertices)
    graph = sparse.coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n))
    return connected_components(graph, directed=False)[1]
