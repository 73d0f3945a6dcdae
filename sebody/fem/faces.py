"""Outer faces of a mesh and integrals over them.

Kinds of elements and the order of their nodes are those of meshio (VTK). The faces of solids, and
in a plane the edges of elements, are ordered so that their normal points outwards, whatever the
handedness of the elements; elements of shells are faces as they are.
"""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.cells import CORNERS, EDGES, MIDDLES, SOLIDS, faces_of
from sebody.fem.face_functions import face_rule
from sebody.fem.model import FEModel

_QUADRATIC = {"tetra10": "tetra", "hexahedron20": "hexahedron", "wedge15": "wedge",
              "hexahedron27": "hexahedron", "triangle6": "triangle", "quad8": "quad"}
_REVERSED = {"line": [1, 0], "line3": [1, 0, 2], "triangle": [0, 2, 1],
             "triangle6": [0, 2, 1, 5, 4, 3], "quad": [0, 3, 2, 1],
             "quad8": [0, 3, 2, 1, 7, 6, 5, 4], "quad9": [0, 3, 2, 1, 7, 6, 5, 4, 8]}
_FACE_KINDS = {2: "line", 3: "line3", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}
_WITH_MIDDLES = {"hexahedron27"}


def faces_within(model: FEModel, nodes: Iterable[int]) -> list[tuple[str, NDArray]]:
    """Outer faces all of whose nodes are among `nodes`.

    Returns
    -------
    list of (kind, (m, k) of int)
        'triangle', 'triangle6', 'quad', 'quad8' or 'quad9' with their nodes; in a plane 'line' or
        'line3'.
    """
    inside = np.zeros(len(model.coordinates), dtype=bool)
    inside[list(nodes)] = True
    planar = model.coordinates.shape[1] == 2
    groups: dict[str, list[tuple[NDArray, NDArray]]] = {}
    for kind, cells in model.cells:
        middles = model.coordinates[cells].mean(axis=1)
        for face_kind, columns in _faces_of(kind, planar):
            candidates = cells[:, columns]
            taken = inside[candidates].all(axis=1)
            groups.setdefault(face_kind, []).append((candidates[taken], middles[taken]))
    result = []
    for kind, parts in groups.items():
        faces, middles = (np.vstack(arrays) for arrays in zip(*parts, strict=True))
        _, first, times = np.unique(np.sort(faces, axis=1), axis=0, return_index=True,
                                    return_counts=True)
        outer = np.sort(first[times == 1])      # an inner face has an element on either side
        if len(outer):
            result.append((kind, _outward(model, kind, faces[outer], middles[outer])))
    return result


def _outward(model: FEModel, kind: str, faces: NDArray, middles: NDArray) -> NDArray:
    """The faces, turned over where the element behind, of that middle, is in front of them."""
    corners = model.coordinates[faces]
    _, slopes, weights = face_rule(kind)
    normal = np.einsum("fgd,g->fd", normals(corners, slopes), weights)
    away = np.einsum("fd,fd->f", normal, corners.mean(axis=1) - middles)
    return np.where(away[:, None] < 0, faces[:, _REVERSED[kind]], faces)


def _faces_of(kind: str, planar: bool) -> Iterator[tuple[str, list[int]]]:
    """Kind and nodes, in the element, of each face of an element."""
    base = _QUADRATIC.get(kind, kind)
    if base not in CORNERS or (planar and base in SOLIDS):
        return
    count = CORNERS[base] + (len(EDGES[base]) if kind in _QUADRATIC else 0)
    if planar:
        for k, edge in enumerate(EDGES[base]):
            columns = [*edge, *([CORNERS[base] + k] if kind in _QUADRATIC else [])]
            yield _face_kind(2, len(columns)), columns
        return
    for k, face in enumerate(faces_of(kind, count)):
        middle = [count + MIDDLES[base][k]] if kind in _WITH_MIDDLES else []
        yield _face_kind(3 if len(face) in (3, 6) else 4, len(face) + len(middle)), [*face, *middle]


def _face_kind(corners: int, nodes: int) -> str:
    return "triangle" if corners == nodes == 3 else _FACE_KINDS[nodes]


def surface_mass(model: FEModel, nodes: NDArray) -> sparse.csr_array:
    """``integral N_a N_b dA`` (k, k) over the outer faces within `nodes` (k,), N their functions.

    Sums of its rows are the areas of the nodes (0 or less at corners of quadratic faces), its total
    is the area; in a plane lengths in place of areas.
    """
    place = np.full(len(model.coordinates), -1)
    place[nodes] = np.arange(len(nodes))
    shape = (len(nodes), len(nodes))
    total = sparse.csr_array(shape)
    for kind, faces in faces_within(model, nodes):
        values, slopes, weights = face_rule(kind)
        corners = model.coordinates[faces]
        areas = weights * np.linalg.norm(normals(corners, slopes), axis=-1)
        entries = np.einsum("fg,ga,gb->fab", areas, values, values)
        rows = np.broadcast_to(place[faces][:, :, None], entries.shape)
        columns = np.broadcast_to(place[faces][:, None, :], entries.shape)
        total = total + sparse.csr_array(sparse.coo_array(
            (entries.ravel(), (rows.ravel(), columns.ravel())), shape=shape))
    return total


def normals(corners: NDArray, slopes: NDArray) -> NDArray:
    """Outward normals (f, g, D), as long as the area of a unit of the face's coordinates.

    Parameters
    ----------
    corners : (f, k, D)
        Positions of the nodes.
    slopes : (g, k, D - 1)
        Derivatives of their functions at the points of integration.
    """
    tangents = np.einsum("fad,gac->fgcd", corners, slopes)
    if corners.shape[2] == 2:
        return np.stack([tangents[:, :, 0, 1], -tangents[:, :, 0, 0]], axis=-1)
    return np.cross(tangents[:, :, 0], tangents[:, :, 1])
