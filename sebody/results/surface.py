"""Surfaces of superelements for pictures, from the cells of their FE models.

A surface has stations, whose displacements and rotations are linear in the amplitudes of the body,
and vertices, which are stations or corners of a beam's section about one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.reduction.recovery import Recovery

PIECES = 12             # at least, of the lines of a body from end to end
THIN = 0.006            # half the width of lines without an outline, of the body's extent
# faces of cells by the corners of meshio's order; middle nodes, which follow the corners, are not
# drawn
FACES = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                   (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "triangle": ((0, 1, 2),),
    "quad": ((0, 1, 2, 3),),
}
SOLIDS = "tetra", "hexahedron", "wedge", "pyramid"


class Surface(NamedTuple):
    """Stations, and vertices and triangles on them, in axes of the body; N amplitudes."""

    points: NDArray         # (stations, 3)
    moves: NDArray          # (N, stations, 3) displacements of unit amplitudes
    turns: NDArray          # (N, stations, 3) rotations likewise
    stations: NDArray       # (vertices,) of int
    offsets: NDArray        # (vertices, 3) from the station, turning with it
    triangles: NDArray      # (triangles, 3) of vertices; those of beams and solids face outwards
    edges: NDArray          # (edges, 2) of vertices: those of elements
    nodes: NDArray          # (stations, 2) FE nodes that a station is between
    shares: NDArray         # (stations,) part of the way from the first to the second


def surface_of(recovery: Recovery, amplitudes: int) -> Surface | None:
    """Surface of a body; None where its FE model has no cells."""
    unit = np.eye(amplitudes)
    points, moves = _spatial(recovery.points), _spatial(recovery.displacement(unit))
    turns = _turns(recovery.rotation(unit), moves.shape)
    parts = []
    lines = [nodes[:, :2] for kind, nodes in recovery.cells if kind.startswith("line")]
    if lines and sum(map(len, lines)):
        parts.append(_beams(points, moves, turns, np.concatenate(lines), _outlines(recovery)))
    faces = outer_faces(recovery.cells)
    if faces:
        parts.append(_skin(points, moves, faces))
    return _joined(parts) if parts else None


def outer_faces(cells: tuple[tuple[str, NDArray], ...]) -> list[NDArray]:
    """Faces (n, 3) and (n, 4) of shells, and those of solids that belong to one cell alone."""
    shells: dict[int, list[NDArray]] = {3: [], 4: []}
    solids: dict[int, list[NDArray]] = {3: [], 4: []}
    for kind, nodes in cells:
        kind = kind.rstrip("0123456789")
        for face in FACES.get(kind, ()):
            (solids if kind in SOLIDS else shells)[len(face)].append(nodes[:, face])
    found = []
    for corners in (3, 4):
        if solids[corners]:
            faces = np.concatenate(solids[corners])
            _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True,
                                        return_counts=True)
            shells[corners].append(faces[first[count == 1]])
        if shells[corners]:
            found.append(np.concatenate(shells[corners]))
    return found


def box(sides: NDArray, centre: NDArray, axes: NDArray) -> Surface:
    """A rigid box; `axes` has the directions of its sides as columns."""
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) / 2
    quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2),
                      (1, 3, 7, 5)])
    if np.linalg.det(axes) < 0:
        axes = axes * [1.0, 1.0, -1.0]
    points = centre + (corners * sides) @ axes.T
    none = np.zeros((0, 8, 3))
    return Surface(points, none, none, np.arange(8), np.zeros((8, 3)), _triangles(quads),
                   _edges(quads), np.zeros((8, 2), dtype=int), np.zeros(8))


def _skin(points: NDArray, moves: NDArray, faces: list[NDArray]) -> Surface:
    """Faces of shells and solids, on the nodes that they have."""
    used, inverse = np.unique(np.concatenate([f.ravel() for f in faces]), return_inverse=True)
    places, first = [], 0
    for face in faces:
        places.append(inverse[first:first + face.size].reshape(face.shape))
        first += face.size
    moves = moves[:, used]
    return Surface(points[used], moves, np.zeros_like(moves), np.arange(len(used)),
                   np.zeros((len(used), 3)), np.concatenate([_triangles(f) for f in places]),
                   np.concatenate([_edges(f) for f in places]),
                   np.column_stack([used, used]), np.zeros(len(used)))


def _beams(points: NDArray, moves: NDArray, turns: NDArray, pairs: NDArray,
           outlines: NDArray | None) -> Surface:
    """Lines as beams with a section: cubic between their ends, as beam elements are."""
    if outlines is None:
        half = THIN * np.ptp(points, axis=0).max()
        outlines = _square(points[pairs[:, 1]] - points[pairs[:, 0]], half)
    outlines = _turning(outlines, points[pairs[:, 1]] - points[pairs[:, 0]])
    pieces = max(1, -(-PIECES // len(pairs)))
    s = np.linspace(0.0, 1.0, pieces + 1)
    along = _between(points[None], np.zeros((1, *points.shape)), points, pairs, s)[0][0]
    moved, rotated = _between(moves, turns, points, pairs, s)
    rings, corners = len(pairs) * (pieces + 1), outlines.shape[1]
    offsets = np.repeat(outlines, pieces + 1, axis=0).reshape(-1, 3)
    ring = np.arange(rings).reshape(len(pairs), -1)
    a = (corners * ring[:, :-1, None] + np.arange(corners)).reshape(-1, corners)
    b = a + corners
    sides = np.stack([a, np.roll(a, -1, axis=1), np.roll(b, -1, axis=1), b], axis=-1)
    degree = np.bincount(pairs.ravel(), minlength=len(points))
    ends = [corners * ring[k, at] + _cap(outlines[k])[:, ::way] for k, pair in enumerate(pairs)
            for at, node, way in ((0, pair[0], -1), (-1, pair[1], 1)) if degree[node] != 2]
    triangles = np.concatenate([_triangles(sides.reshape(-1, 4)), *ends])
    return Surface(along, moved, rotated, np.repeat(np.arange(rings), corners), offsets,
                   triangles, np.zeros((0, 2), dtype=int), np.repeat(pairs, pieces + 1, axis=0),
                   np.tile(s, len(pairs)))


def _turning(outlines: NDArray, lines: NDArray) -> NDArray:
    """Outlines (n, corners, 3) that run about their lines, so that sides face outwards."""
    areas = np.cross(outlines, np.roll(outlines, -1, axis=1)).sum(axis=1)
    return np.where((np.einsum("ni,ni->n", areas, lines) < 0)[:, None, None],
                    outlines[:, ::-1], outlines)


def _between(moves: NDArray, turns: NDArray, points: NDArray, pairs: NDArray, s: NDArray
             ) -> tuple[NDArray, NDArray]:
    """Displacements and rotations at the places s of lines, (N, lines * places, 3) each.

    Across the line they are the cubic with the displacements and slopes of the ends, along and
    about it linear.
    """
    lines = points[pairs[:, 1]] - points[pairs[:, 0]]
    length = np.linalg.norm(lines, axis=1)[:, None, None]
    e = (lines / np.maximum(length[:, :, 0], 1e-300))[:, None]
    ends = [(values[:, pairs[:, 0], None], values[:, pairs[:, 1], None])
            for values in (moves, turns)]
    (u0, u1), (t0, t1) = ends
    slopes = [length * np.cross(t, e) for t in (t0, t1)]
    s = s[:, None]
    ramp = u0 + s * (u1 - u0)
    cubic = ((1 + 2 * s) * (1 - s)**2 * u0 + s**2 * (3 - 2 * s) * u1
             + s * (1 - s)**2 * slopes[0] - s**2 * (1 - s) * slopes[1])
    rise = (6 * s * (1 - s) * (u1 - u0) + (1 - s) * (1 - 3 * s) * slopes[0]
            + s * (3 * s - 2) * slopes[1]) / np.maximum(length, 1e-300)
    moved = cubic + _along(ramp - cubic, e)
    rotated = _along(t0 + s * (t1 - t0), e) + np.cross(np.broadcast_to(e, rise.shape), rise)
    return moved.reshape(len(moves), -1, 3), rotated.reshape(len(moves), -1, 3)


def _along(vectors: NDArray, e: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", vectors, np.broadcast_to(e, vectors.shape))[..., None] * e


def _cap(outline: NDArray) -> NDArray:
    """Triangles (n, 3) of the corners of a flat polygon that need not be convex, by its ears."""
    left = [k for k in range(len(outline)) if np.any(outline[k] != outline[k - 1])]
    normal = sum(np.cross(outline[left[k - 1]], outline[left[k]]) for k in range(len(left)))
    found = []
    while len(left) > 3:
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            others = [outline[j] for j in left if j not in (a, b, c)]
            if _is_ear(*outline[[a, b, c]], others, normal):
                break
        found.append((a, b, c))
        left.remove(b)
    return np.array([*found, left])


def _is_ear(a: NDArray, b: NDArray, c: NDArray, others: list[NDArray], normal: NDArray) -> bool:
    """Whether the corner b is convex and no other corner lies in the triangle."""
    def side(p: NDArray, q: NDArray, r: NDArray) -> float:
        return np.cross(q - p, r - q) @ normal
    return side(a, b, c) > 0 and not any(
        min(side(a, b, p), side(b, c, p), side(c, a, p)) >= 0 for p in others)


def _outlines(recovery: Recovery) -> NDArray | None:
    """Outlines in axes of the body, (lines, corners, 3)."""
    if recovery.outlines is None or recovery.axes is None:
        return recovery.outlines
    found, D = recovery.outlines.copy(), recovery.dimension
    found[..., :D] = found[..., :D] @ recovery.axes.T
    return found


def _square(lines: NDArray, half: float) -> NDArray:
    """Squares (n, 4, 3) across lines."""
    least = np.eye(3)[np.argmin(np.abs(lines), axis=1)]
    one = np.cross(lines, least)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    other = np.cross(lines, one)
    other /= np.linalg.norm(other, axis=1, keepdims=True)
    return half * np.stack([-one - other, one - other, one + other, other - one], axis=1)


def _triangles(faces: NDArray) -> NDArray:
    """Faces of three or four corners as triangles."""
    return faces if faces.shape[1] == 3 else np.concatenate([faces[:, :3], faces[:, [0, 2, 3]]])


def _edges(faces: NDArray) -> NDArray:
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _joined(parts: list[Surface]) -> Surface:
    if len(parts) == 1:
        return parts[0]
    stations = np.cumsum([0, *(len(p.points) for p in parts)])
    vertices = np.cumsum([0, *(len(p.stations) for p in parts)])
    return Surface(np.concatenate([p.points for p in parts]),
                   *(np.concatenate([getattr(p, name) for p in parts], axis=1)
                     for name in ("moves", "turns")),
                   np.concatenate([p.stations + k for p, k in zip(parts, stations, strict=False)]),
                   np.concatenate([p.offsets for p in parts]),
                   *(np.concatenate([getattr(p, name) + k
                                     for p, k in zip(parts, vertices, strict=False)])
                     for name in ("triangles", "edges")),
                   *(np.concatenate([getattr(p, name) for p in parts])
                     for name in ("nodes", "shares")))


def _spatial(vectors: NDArray) -> NDArray:
    """Vectors with z = 0 where they are of a plane."""
    if vectors.shape[-1] == 3:
        return vectors
    return np.concatenate([vectors, np.zeros((*vectors.shape[:-1], 1))], axis=-1)


def _turns(rotations: NDArray, shape: tuple[int, ...]) -> NDArray:
    """Rotation vectors, about z in a plane; none where nodes have no rotation."""
    found = np.zeros(shape)
    if rotations.shape[-1] == 3:
        return rotations
    if rotations.shape[-1] == 1:
        found[..., 2] = rotations[..., 0]
    return found
