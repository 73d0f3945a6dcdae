"""Motions of nodes without rows in the matrices: *RIGID BODY, *KINEMATIC, *TIE."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.projection import on_faces
from sebody.io.deck.reading import Deck, Tie
from sebody.io.deck.surfaces import surface_faces
from sebody.io.tied import motion_of

_FACES = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}


class Motion(NamedTuple):
    """Motion of all nodes.

    Parameters
    ----------
    points : (n, 3)
        Places, of nodes that a *TIE moves to the faces these [length].
    matrix : (3 n, n_dofs), sparse
        Displacements from the DOFs.
    known : (n,) of bool
        Whether a node has rows or follows nodes that have.
    rigid : list of (rows, nodes, arms)
        Nodes that follow a rotation, see `SolidPrestress`.
    """

    points: NDArray
    matrix: sparse.csr_array
    known: NDArray
    rigid: list[tuple[NDArray, NDArray, NDArray]]


def deck_motion(deck: Deck, index: dict[int, int], points: NDArray, rows: NDArray, size: int
                ) -> Motion:
    """Motion of the nodes of a deck.

    Parameters
    ----------
    index : dict of int by label
        Nodes of the model.
    points : (n, 3)
        Their places [length].
    rows : (n, 6)
        Row of every DOF, -1 for none.
    size : int
        Number of rows.
    """
    followed, arms, rigid = rows.copy(), np.zeros_like(points), []
    for body in deck.rigid_bodies:
        leader = index[body.reference]
        nodes = np.array([index[label] for label in deck.tied_nodes(body)], dtype=int)
        nodes = nodes[rows[nodes, 0] < 0]
        if (rows[leader] < 0).any() or not len(nodes):
            continue
        followed[nodes] = rows[leader]
        arms[nodes] = points[nodes] - points[leader]
        rigid.append((rows[leader, 3:], nodes, arms[nodes]))
    motion = Motion(points, motion_of(followed, arms, size), (followed[:, :3] >= 0).all(axis=1),
                    rigid)
    for tie in deck.ties:
        motion = _with_tie(deck, tie, index, motion)
    return motion


def _with_tie(deck: Deck, tie: Tie, index: dict[int, int], motion: Motion) -> Motion:
    """The motion with the nodes of a surface that are where the faces of the other one are."""
    nodes = np.array([index[label] for label in deck.surface_nodes(tie.slave)], dtype=int)
    nodes = nodes[~motion.known[nodes]]
    faces: dict[str, list] = {}
    master = deck.surfaces[tie.master]
    for face in [] if master.of_nodes else surface_faces(master, deck.element_sets, deck.solids):
        faces.setdefault(_FACES[len(face)], []).append([index[label] for label in face])
    if not len(nodes) or not faces:
        return motion
    weights = on_faces(motion.points[nodes], motion.points,
                       [(kind, np.array(rows)) for kind, rows in faces.items()])
    count = len(motion.points)
    place = sparse.csr_array((np.ones(len(nodes)), (nodes, np.arange(len(nodes)))),
                             shape=(count, len(nodes)))
    tied = sparse.kron(place @ weights, sparse.eye_array(3), format="csr")
    points = motion.points
    if tie.adjusted:
        points = points.copy()
        points[nodes] = weights @ motion.points
    known = motion.known.copy()
    held = np.asarray((weights != 0).sum(axis=1)).ravel()
    known[nodes] = (weights != 0) @ motion.known.astype(float) >= held
    return motion._replace(points=points, matrix=motion.matrix + tied @ motion.matrix, known=known)
