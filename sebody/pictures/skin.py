"""Skins of FE models: the outer faces of solids and those of shells, curved if they are.

Faces of second order are divided into so many triangles that their curvature is seen.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.cells import FACES, SOLIDS, faces_of, first_order
from sebody.pictures.surface_parts import NO_EDGES, Surface, edges_of

STRAIGHT = 2            # pieces of an edge of second order, so that deformations bend it
MOST_PIECES = 8
TURN = np.radians(8.0)  # of an edge by a piece
ROUNDING = 1e-9         # of shape functions
MOST = 100_000          # triangles of a skin, beyond which edges have the fewest pieces


class Lattice(NamedTuple):
    """Points of a face and what lies between them."""

    values: NDArray         # (points, k) shape functions of the face's nodes
    triangles: NDArray      # (triangles, 3)
    rim: NDArray            # (points on it,) around the face


def outer_faces(cells: tuple[tuple[str, NDArray], ...]) -> list[NDArray]:
    """Faces (n, k) of shells, and those of solids that belong to one cell alone.

    Of k nodes: three or four corners, then in second order the middles of the edges.
    """
    shells: dict[int, list[NDArray]] = {}
    solids: dict[int, list[NDArray]] = {}
    for kind, nodes in cells:
        base = first_order(kind)
        if base in FACES:
            for face in faces_of(kind, nodes.shape[1]):
                elements = solids if base in SOLIDS else shells
                elements.setdefault(len(face), []).append(nodes[:, face])
    for count, parts in solids.items():
        faces, corners = np.concatenate(parts), 3 if count in (3, 6) else 4
        _, first, times = np.unique(np.sort(faces[:, :corners], axis=1), axis=0,
                                    return_index=True, return_counts=True)
        shells.setdefault(count, []).append(faces[first[times == 1]])
    return [faces for _, parts in sorted(shells.items())
            if len(faces := np.concatenate(parts))]


def skin(points: NDArray, moves: NDArray, faces: list[NDArray]) -> Surface:
    """The surface of faces, with stations at the nodes that they have."""
    used, inverse = np.unique(np.concatenate([f.ravel() for f in faces]), return_inverse=True)
    own = np.split(inverse, np.cumsum([f.size for f in faces])[:-1])
    faces = [place.reshape(face.shape) for place, face in zip(own, faces, strict=True)]
    pieces = _pieces(points[used], faces)
    lattices = [lattice(face.shape[1], pieces) for face in faces]
    weights, numbers = _vertices(faces, lattices, len(used))
    moves = moves[:, used]
    return Surface(
        points[used], moves, np.zeros_like(moves), weights, np.zeros((weights.shape[0], 3)),
        np.concatenate([number[:, one.triangles].reshape(-1, 3)
                        for number, one in zip(numbers, lattices, strict=True)]),
        np.unique(np.concatenate([edges_of(number[:, one.rim])
                                  for number, one in zip(numbers, lattices, strict=True)]), axis=0),
        NO_EDGES, np.column_stack([used, used]), np.zeros(len(used)))


def lattice(nodes: int, pieces: int) -> Lattice:
    """Points of a face of 3, 4, 6 or 8 nodes; faces of first order are not divided."""
    pieces = pieces if nodes > 4 else 1
    n = pieces + 1
    if nodes in (3, 6):
        at = [(i, j) for j in range(n) for i in range(n - j)]
        place = {one: k for k, one in enumerate(at)}
        s, t = np.array(at).T / pieces
        triangles = [(place[i, j], place[i + 1, j], place[i, j + 1])
                     for i, j in at if i + j < pieces]
        triangles += [(place[i + 1, j], place[i + 1, j + 1], place[i, j + 1])
                      for i, j in at if i + j < pieces - 1]
        rim = [(i, 0) for i in range(pieces)] + [(pieces - i, i) for i in range(pieces)] + [
            (0, pieces - i) for i in range(pieces)]
        values = _triangle(np.stack([1 - s - t, s, t], axis=1), nodes)
    else:
        at = [(i, j) for j in range(n) for i in range(n)]
        place = {one: k for k, one in enumerate(at)}
        quads = np.array([[place[i, j], place[i + 1, j], place[i + 1, j + 1], place[i, j + 1]]
                          for i, j in at if i < pieces and j < pieces])
        triangles = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
        rim = ([(i, 0) for i in range(pieces)] + [(pieces, i) for i in range(pieces)]
               + [(pieces - i, pieces) for i in range(pieces)]
               + [(0, pieces - i) for i in range(pieces)])
        values = _quad(2 * np.array(at) / pieces - 1, nodes)
    return Lattice(values, np.array(triangles), np.array([place[one] for one in rim]))


def _triangle(area: NDArray, nodes: int) -> NDArray:
    """Shape functions (n, nodes) of a triangle at area coordinates (n, 3)."""
    if nodes == 3:
        return area
    return np.hstack([area * (2 * area - 1), 4 * area * np.roll(area, -1, axis=1)])


def _quad(at: NDArray, nodes: int) -> NDArray:
    """Shape functions (n, nodes) of a quadrilateral, bilinear or of the serendipity family."""
    s, t = at[:, :1], at[:, 1:]
    a, b = np.array([-1.0, 1, 1, -1]), np.array([-1.0, -1, 1, 1])
    along, across = 1 + a * s, 1 + b * t
    if nodes == 4:
        return along * across / 4
    c, d = np.array([0.0, 1, 0, -1]), np.array([-1.0, 0, 1, 0])
    middles = np.where(c == 0, (1 - s**2) * (1 + d * t), (1 + c * s) * (1 - t**2)) / 2
    return np.hstack([along * across * (a * s + b * t - 1) / 4, middles])


def _pieces(points: NDArray, faces: list[NDArray]) -> int:
    """Pieces of the edges of faces of second order, by how far the most curved one turns."""
    most, count = 0.0, 0
    for face in (face for face in faces if face.shape[1] > 4):
        corners = face.shape[1] // 2
        begin = points[face[:, :corners]]
        end, middle = np.roll(begin, -1, axis=1), points[face[:, corners:]]
        rise = np.linalg.norm(middle - (begin + end) / 2, axis=2)
        chord = np.linalg.norm(end - begin, axis=2)
        # tangents of a parabola turn by 8 rise / chord
        most = max(most, float((8 * rise / np.maximum(chord, 1e-300)).max(initial=0.0)))
        count += len(face)
    pieces = min(max(STRAIGHT, 2 * int(np.ceil(most / TURN / 2))), MOST_PIECES)
    while pieces > STRAIGHT and 2 * count * pieces**2 > MOST:
        pieces -= 2
    return pieces


def _vertices(faces: list[NDArray], lattices: list[Lattice], stations: int
              ) -> tuple[sparse.csr_array, list[NDArray]]:
    """Weights of the stations in all vertices, and the vertices (faces, points) of each lattice.

    Points that faces share, of the same stations with the same weights, are one vertex.
    """
    points, width = [], max(face.shape[1] for face in faces)
    for face, one in zip(faces, lattices, strict=True):
        values = np.where(np.abs(one.values) > ROUNDING, one.values, 0.0)
        labels = np.where(values != 0, face[:, None] + 1, 0)       # 0: not of this point
        blank = (0, width - labels.shape[2])
        labels = np.pad(labels, ((0, 0), (0, 0), blank))
        values = np.broadcast_to(np.pad(values, ((0, 0), blank)), labels.shape)
        order = np.argsort(labels, axis=2)
        points.append(np.stack([np.take_along_axis(labels, order, 2),
                                np.take_along_axis(values, order, 2)]).reshape(2, -1, width))
    labels, values = np.concatenate(points, axis=1)
    keys = np.hstack([labels, np.round(values / ROUNDING)])        # those of two faces nearly agree
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    found, values = labels[first].astype(int) - 1, values[first]
    at = np.broadcast_to(np.arange(len(found))[:, None], found.shape)
    weights = sparse.csr_array((values[found >= 0], (at[found >= 0], found[found >= 0])),
                               shape=(len(found), stations))
    sizes = [len(face) * len(one.values) for face, one in zip(faces, lattices, strict=True)]
    numbers = np.split(inverse.ravel(), np.cumsum(sizes)[:-1])
    return weights, [number.reshape(len(face), -1)
                     for number, face in zip(numbers, faces, strict=True)]
