"""Surfaces of superelements for pictures, from the cells of their FE models."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.cells import first_order
from sebody.pictures.beam_surface import beams
from sebody.pictures.skin import outer_faces, skin
from sebody.pictures.surface_parts import NO_EDGES, Surface, edges_of, folded, joined, triangles_of
from sebody.reduction.recovery import Recovery


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
