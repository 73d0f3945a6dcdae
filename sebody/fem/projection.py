"""Nearest points on faces of elements."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import KDTree

from sebody.fem.face_functions import face_functions

_NEAREST = 12       # faces by their middles, of which a point is on the nearest
_ROUNDS = 30        # of Gauss and Newton's iteration; flat faces with straight edges take one


def on_faces(points: NDArray, places: NDArray, faces: Sequence[tuple[str, NDArray]]
             ) -> sparse.csr_array:
    """Weights of the nodes that make the nearest points on faces.

    Parameters
    ----------
    points : (p, 3)
    places : (n, 3)
        Of all nodes [length].
    faces : sequence of (kind, (m, k) of int)
        As `faces_within` returns them.

    Returns
    -------
    (p, n), sparse
    """
    nearest = np.full(len(points), np.inf)
    weights: list[tuple[NDArray, NDArray]] = [(np.zeros(0, dtype=int), np.zeros(0))] * len(points)
    for kind, nodes in faces:
        near = KDTree(places[nodes].mean(axis=1)).query(points, min(_NEAREST, len(nodes)))[1]
        near = near.reshape(len(points), -1)
        for candidate in near.T:
            values, distances = _on_face(kind, places[nodes[candidate]], points)
            for k in np.flatnonzero(distances < nearest):
                nearest[k], weights[k] = distances[k], (nodes[candidate[k]], values[k])
    rows = np.repeat(np.arange(len(points)), [len(own) for own, _ in weights])
    columns, entries = (np.concatenate([pair[part] for pair in weights]) for part in (0, 1))
    return sparse.csr_array((entries, (rows, columns)), shape=(len(points), len(places)))


def _on_face(kind: str, corners: NDArray, points: NDArray) -> tuple[NDArray, NDArray]:
    """Values (p, k) of the functions where one face (p, k, 3) each is nearest, and distances."""
    triangle = kind.startswith("triangle")
    place = np.full((len(points), 2), 1 / 3 if triangle else 0.0)
    for _ in range(_ROUNDS):
        values, slopes = face_functions(kind, place)
        missing = points - np.einsum("pk,pkd->pd", values, corners)
        tangents = np.einsum("pkd,pkc->pdc", corners, slopes)
        squares = tangents.transpose(0, 2, 1) @ tangents
        step = np.linalg.solve(squares, np.einsum("pdc,pd->pc", tangents, missing)[..., None])
        moved = _within(place + step[..., 0], triangle)
        done = np.abs(moved - place).max() < 1e-14
        place = moved
        if done:
            break
    values = face_functions(kind, place)[0]
    return values, np.linalg.norm(points - np.einsum("pk,pkd->pd", values, corners), axis=1)


def _within(place: NDArray, triangle: bool) -> NDArray:
    """Coordinates that are on the face."""
    if not triangle:
        return place.clip(-1.0, 1.0)
    place = place.clip(0.0, 1.0)
    beyond = np.maximum(place.sum(axis=1, keepdims=True) - 1.0, 0.0)
    return (place - beyond / 2).clip(0.0, 1.0)
