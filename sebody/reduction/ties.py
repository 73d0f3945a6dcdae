"""Rigid faces of a reduction: the FE DOFs that they leave independent, and their turning."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.layout import PLANAR, SPATIAL
from sebody.fem.model import FEModel
from sebody.reduction.interfaces import RigidFace


class Ties:
    """FE DOFs ``q = T qi`` of independent ones: those of loose nodes, then those of each face.

    Parameters
    ----------
    fe_model : FEModel
    faces : sequence of RigidFace
        Without common nodes.

    Attributes
    ----------
    independent : (n_dofs,) of int
        Independent DOF of each FE DOF; -1 on rigid faces.
    lengths : (size,)
        1 for translations, the characteristic length for rotations.
    rigid : (size, 6), planar (size, 3)
        Rigid motions times `lengths`, rotations by 1 / extent about the middle of the model.
    """

    def __init__(self, fe_model: FEModel, faces: Sequence[RigidFace]):
        self._model, self._faces = fe_model, list(faces)
        dimension = fe_model.coordinates.shape[1]
        self._dimension, self._angles = dimension, 3 if dimension == 3 else 1
        count = fe_model.stiffness.shape[0]
        tied = np.zeros(count, dtype=bool)
        for face in faces:
            rows = fe_model.rows[list(face.nodes)]
            tied[rows[rows >= 0]] = True
        self.independent = np.where(tied, -1, np.cumsum(~tied) - 1)
        self._loose = int(np.sum(~tied))
        self.size = self._loose + (dimension + self._angles) * len(self._faces)
        self._matrix = self._tie() if self._faces else None
        self.lengths, self.rigid = self._rigid()

    def project(self, matrix: sparse.csc_array) -> sparse.csc_array:
        """``T^T A T`` of an FE matrix A."""
        if self._matrix is None:
            return matrix
        projected = sparse.csc_array(self._matrix.T @ matrix @ self._matrix)
        return sparse.csc_array((projected + projected.T) / 2)

    def gather(self, forces: NDArray) -> NDArray:
        """``T^T f``."""
        return forces if self._matrix is None else self._matrix.T @ forces

    def spread(self, shapes: NDArray) -> NDArray:
        """``T qi``."""
        return shapes if self._matrix is None else self._matrix @ shapes

    def face_rows(self, face: RigidFace, kind: str) -> NDArray:
        """Independent DOFs of the translation or the rotation of a face."""
        first = self._loose + (self._dimension + self._angles) * self._faces.index(face)
        if kind == "translation":
            return first + np.arange(self._dimension)
        return first + self._dimension + np.arange(self._angles)

    def tied_rows(self) -> NDArray:
        """FE DOFs of the translations of the nodes of rigid faces."""
        rows = [self._model.rows[list(face.nodes), :self._dimension].ravel()
                for face in self._faces]
        rows = np.concatenate(rows) if rows else np.zeros(0, dtype=int)
        return rows[rows >= 0]

    def name(self, row: int) -> str:
        """The independent DOF as messages name it."""
        model = self._model
        if row >= self._loose:
            face, part = divmod(row - self._loose, self._dimension + self._angles)
            names = SPATIAL if self._dimension == 3 else PLANAR
            own = self._faces[face]
            return f"{names[part]} of {own.called if own.name else f'rigid face {face}'}"
        node, kind = np.argwhere(model.rows == np.flatnonzero(self.independent == row)[0])[0]
        return f"{model.node_dofs[kind]} of {model.node_name(int(node))}"

    def owners(self) -> NDArray:
        """FE node of each independent DOF, the number of nodes and more for faces, (size,)."""
        model = self._model
        result = np.empty(self.size, dtype=int)
        there = (model.rows >= 0) & (self.independent[model.rows] >= 0)
        result[self.independent[model.rows[there]]] = np.nonzero(there)[0]
        own = self._dimension + self._angles
        result[self._loose:] = len(model.rows) + np.arange(self.size - self._loose) // own
        return result

    def owner_name(self, owner: int) -> str:
        """A node or a face of `owners` as messages name it."""
        face = owner - len(self._model.rows)
        if face < 0:
            return self._model.node_name(owner)
        own = self._faces[face]
        return own.called if own.name else f"rigid face {face}"

    def second_order(self, forces: NDArray, basis: NDArray) -> NDArray:
        """Second derivative of the work of forces (n_dofs,) on the turning of rigid faces.

        A face turned by psi moves a node at the arm r by ``psi x (psi x r) / 2`` beyond the linear
        ``psi x r``: forces f that the prestress has there add ``(f r^T + r f^T) / 2 - f . r I``.
        """
        result = np.zeros((basis.shape[1],) * 2)
        for face in self._faces:
            rows = self._model.rows[list(face.nodes), :self._dimension]
            own = np.where(rows >= 0, forces[rows], 0.0)
            moments = own.T @ (self._model.coordinates[list(face.nodes)] - face.point)
            whole = (moments + moments.T) / 2 - np.trace(moments) * np.eye(len(moments))
            # in a plane the angle turns the arm about the third axis: - f . r
            block = -np.trace(moments)[None, None] if self._angles == 1 else whole
            turn = basis[self.face_rows(face, "rotation")]
            result += turn.T @ block @ turn
        return result

    def _tie(self) -> sparse.csc_array:
        loose = np.flatnonzero(self.independent >= 0)
        rows, columns, values = [loose], [self.independent[loose]], [np.ones(len(loose))]
        for face in self._faces:
            nodes = list(face.nodes)
            moves = _rigid_rows(self._model.coordinates[nodes] - face.point, self._model.node_dofs)
            own = np.concatenate([self.face_rows(face, "translation"),
                                  self.face_rows(face, "rotation")])
            places = self._model.rows[nodes]
            there = (places >= 0)[:, :, None] & (moves != 0)
            rows.append(np.broadcast_to(places[:, :, None], moves.shape)[there])
            columns.append(np.broadcast_to(own, moves.shape)[there])
            values.append(moves[there])
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        shape = (len(self.independent), self.size)
        tie = sparse.csc_array(sparse.coo_array(entries, shape=shape))
        tie.indices, tie.indptr = tie.indices.astype(np.int32), tie.indptr.astype(np.int32)
        return tie

    def _rigid(self) -> tuple[NDArray, NDArray]:
        """`lengths` and `rigid`."""
        model = self._model
        middle = (model.coordinates.max(axis=0) + model.coordinates.min(axis=0)) / 2
        extent = model.extent or 1.0
        lengths = np.ones(self.size)
        rigid = np.zeros((self.size, self._dimension + self._angles))
        there = (model.rows >= 0) & (self.independent[model.rows] >= 0)
        rows = self.independent[model.rows[there]]
        rigid[rows] = _rigid_rows((model.coordinates - middle) / extent, model.node_dofs)[there]
        turns = np.arange(len(model.node_dofs)) >= self._dimension
        lengths[rows] = np.where(np.broadcast_to(turns, there.shape)[there], extent, 1.0)
        for face in self._faces:
            arm = (face.point - middle)[None] / extent
            turning = self.face_rows(face, "rotation")
            rows = np.concatenate([self.face_rows(face, "translation"), turning])
            rigid[rows] = _rigid_rows(arm, SPATIAL if self._dimension == 3 else PLANAR)[0]
            lengths[turning] = extent
        return lengths, rigid


def _rigid_rows(arms: NDArray, node_dofs: tuple[str, ...]) -> NDArray:
    """Motion of nodes at arms (n, D) by unit translations and rotations, (n, k, D + r)."""
    count, dimension = arms.shape
    angles = 3 if dimension == 3 else 1
    result = np.zeros((count, len(node_dofs), dimension + angles))
    result[:, :dimension, :dimension] = np.eye(dimension)
    if dimension == 2:
        result[:, 0, 2], result[:, 1, 2] = -arms[:, 1], arms[:, 0]
    else:
        result[:, :3, 3:] = np.cross(np.eye(3), arms[:, None, :]).transpose(0, 2, 1)
    turning = len(node_dofs) - dimension
    result[:, dimension:, dimension:] = np.eye(angles)[:turning]
    return result


def collinear(points: NDArray) -> bool:
    """Tell whether points lie on a line."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return len(points) < 3 or spread[1] < 1e-8 * spread[0]
