"""Surfaces of superelements for pictures, from the cells of their FE models.

Beams are lines of an FE model with the outlines of their sections about them.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.cells import first_order
from sebody.pictures.skin import outer_faces, skin
from sebody.pictures.surface_parts import NO_EDGES, Surface, edges_of, folded, joined, triangles_of
from sebody.reduction.recovery import Recovery

PIECES = 12             # at least, of the lines of a body from end to end
THIN = 0.006            # half the width of lines without an outline, of the body's extent


def beams(points: NDArray, moves: NDArray, turns: NDArray, pairs: NDArray,
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
    triangles = np.concatenate([triangles_of(sides.reshape(-1, 4)), *ends])
    count = rings * corners
    weights = sparse.csr_array((np.ones(count), (np.arange(count),
                                                 np.repeat(np.arange(rings), corners))))
    of_elements = (corners * ring[:, [0, -1], None] + np.arange(corners)).reshape(-1, corners)
    return Surface(along, moved, rotated, weights, offsets, triangles, edges_of(of_elements),
                   NO_EDGES, np.repeat(pairs, pieces + 1, axis=0), np.tile(s, len(pairs)))


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
    triangles = []
    while len(left) > 3:
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            others = [outline[j] for j in left if j not in (a, b, c)]
            if _is_ear(*outline[[a, b, c]], others, normal):
                break
        triangles.append((a, b, c))
        left.remove(b)
    return np.array([*triangles, left])


def _is_ear(a: NDArray, b: NDArray, c: NDArray, others: list[NDArray], normal: NDArray) -> bool:
    """Tell whether the corner b is convex and no other corner lies in the triangle."""
    def side(p: NDArray, q: NDArray, r: NDArray) -> float:
        return np.cross(q - p, r - q) @ normal
    return side(a, b, c) > 0 and not any(
        min(side(a, b, p), side(b, c, p), side(c, a, p)) >= 0 for p in others)


def _square(lines: NDArray, half: float) -> NDArray:
    """Squares (n, 4, 3) across lines."""
    least = np.eye(3)[np.argmin(np.abs(lines), axis=1)]
    one = np.cross(lines, least)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    other = np.cross(lines, one)
    other /= np.linalg.norm(other, axis=1, keepdims=True)
    return half * np.stack([-one - other, one - other, one + other, other - one], axis=1)


def surface_of(recovery: Recovery, amplitudes: int) -> Surface | None:
    """Surface of a body; None where its FE model has no cells."""
    unit = np.eye(amplitudes)
    points, moves = spatial(recovery.points), spatial(recovery.displacement(unit))
    turns = _turns(recovery.rotation(unit), moves.shape)
    parts = []
    lines = [nodes[:, :2] for kind, nodes in recovery.cells if first_order(kind) == "line"]
    if lines and sum(map(len, lines)):
        parts.append(beams(points, moves, turns, np.concatenate(lines), _outlines(recovery)))
    faces = outer_faces(recovery.cells)
    if faces:
        parts.append(skin(points, moves, faces))
    return folded(joined(parts)) if parts else None


def box(sides: NDArray, centre: NDArray, axes: NDArray) -> Surface:
    """A rigid box; `axes` has the directions of its sides as columns."""
    corners = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) / 2
    quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2),
                      (1, 3, 7, 5)])
    if np.linalg.det(axes) < 0:
        axes = axes * [1.0, 1.0, -1.0]
    points = centre + (corners * sides) @ axes.T
    none = np.zeros((0, 8, 3))
    return folded(Surface(points, none, none, sparse.csr_array(np.eye(8)), np.zeros((8, 3)),
                          triangles_of(quads), edges_of(quads), NO_EDGES,
                          np.zeros((8, 2), dtype=int), np.zeros(8)))


def spatial(vectors: NDArray) -> NDArray:
    """Vectors with z = 0 where they are of a plane."""
    if vectors.shape[-1] == 3:
        return vectors
    return np.concatenate([vectors, np.zeros((*vectors.shape[:-1], 1))], axis=-1)


def _outlines(recovery: Recovery) -> NDArray | None:
    """Outlines in axes of the body, (lines, corners, 3)."""
    if recovery.outlines is None or recovery.axes is None:
        return recovery.outlines
    corners, D = recovery.outlines.copy(), recovery.dimension
    corners[..., :D] = corners[..., :D] @ recovery.axes.T
    return corners


def _turns(rotations: NDArray, shape: tuple[int, ...]) -> NDArray:
    """Rotation vectors, about z in a plane; none where nodes have no rotation."""
    vectors = np.zeros(shape)
    if rotations.shape[-1] == 3:
        return rotations
    if rotations.shape[-1] == 1:
        vectors[..., 2] = rotations[..., 0]
    return vectors
