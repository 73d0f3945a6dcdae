"""Nodes tied rigidly to reference nodes by the FE program: their motion and their mass."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.mass_field import MassField

_EXACT = 1e-9   # of the mass matrix, relative to its largest entry: files have some 14 digits


def motion_of(rows: NDArray, arms: NDArray, size: int) -> sparse.csr_array:
    """Displacements (3 n, size) of points that follow nodes.

    Parameters
    ----------
    rows : (n, 6)
        DOFs of the node that each point follows: three translations, three rotations; -1 where
        there is none.
    arms : (n, 3)
        From that node to the point [length].
    """
    count = len(rows)
    blocks = np.zeros((count, 3, 6))
    blocks[:, :, :3] = np.eye(3)
    blocks[:, :, 3:] = np.cross(np.eye(3), arms[:, None, :]).transpose(0, 2, 1)    # e_k x r
    columns = np.broadcast_to(rows[:, None, :], blocks.shape)
    places = np.broadcast_to(np.arange(3 * count).reshape(count, 3, 1), blocks.shape)
    there = (columns >= 0) & (blocks != 0.0)
    return sparse.csr_array(sparse.coo_array(
        (blocks[there], (places[there], columns[there])), shape=(3 * count, size)))


def tied_mass_field(mass: sparse.csc_array, points: NDArray, rows: NDArray) -> MassField | None:
    """Points of mass of solids of which parts are tied to reference nodes.

    The mass matrix is ``T^T (m (x) I) T`` of the FE nodes, those of rigid parts included. All that
    it holds of the mass m of a rigid part are moments of order zero to two: four points, the
    reference node and one along each axis, have the same. None if the matrix is no such product.

    Parameters
    ----------
    mass : (n_dofs, n_dofs)
    points : (n, 3)
        Nodes with DOFs [length].
    rows : (n, 6)
        Their DOFs as for `motion_of`.
    """
    rigid = np.flatnonzero((rows[:, 3:] >= 0).all(axis=1))
    if (rows[:, :3] < 0).any() or (rows[:, 3:] >= 0).any(axis=1).sum() != len(rigid):
        return None
    moments = _moments(sparse.csr_array(mass), rows, rigid)
    length = _radius(moments, len(rows), rigid) or float(np.ptp(points, axis=0).max()) or 1.0
    chosen = sparse.csr_array((np.ones(3 * len(rigid)), (np.arange(3 * len(rigid)),
                                                         np.repeat(rigid, 3))),
                              shape=(3 * len(rigid), len(rows)))
    inverse = sparse.block_array([
        [sparse.eye_array(len(rows)), None],
        [-chosen / length, sparse.eye_array(3 * len(rigid)) / length]], format="csr")
    arms = np.vstack([np.zeros(points.shape), np.tile(length * np.eye(3), (len(rigid), 1))])
    owners = np.concatenate([np.arange(len(rows)), np.repeat(rigid, 3)])
    field = MassField(points[owners] + arms, motion_of(rows[owners], arms, mass.shape[0]),
                      sparse.csr_array(inverse.T @ moments @ inverse))
    defect = abs(field.matrix() - mass)
    return field if defect.max() <= _EXACT * abs(mass).max() else None


def _radius(moments: sparse.csr_array, count: int, rigid: NDArray) -> float:
    """Largest radius of gyration of a rigid part: points as far off are within the body."""
    masses = moments.diagonal()[rigid]
    turns = moments.diagonal()[count:].reshape(-1, 3).sum(axis=1)
    there = (masses > 0) & (turns > 0)
    return float(np.sqrt(np.max(turns[there] / masses[there], initial=0.0)))


def _moments(mass: sparse.csr_array, rows: NDArray, rigid: NDArray) -> sparse.csr_array:
    """Sums of m over pairs of nodes, and of m times the arms of rigid ones, (n + 3 k,) * 2."""
    x, y, z = rows[:, :3].T
    rx, ry, rz = rows[rigid, 3:].T
    # the velocity of a tied node is u + psi x r, so the coupling of u with psi is -skew(sum m r)
    first = [-mass[z][:, ry], -mass[x][:, rz], -mass[y][:, rx]]
    order = np.arange(3 * len(rigid)).reshape(3, -1).T.ravel()     # node after node
    G = sparse.hstack(first, format="csr")[:, order] if len(rigid) else sparse.csr_array(
        (len(rows), 0))
    turns = rows[rigid, 3:].ravel()
    B = mass[turns][:, turns].toarray().reshape(len(rigid), 3, len(rigid), 3)
    half = np.einsum("aibi->ab", B) / 2
    # B = sum m (r_a . r_b I - r_b r_a^T)
    P = half[:, None, :, None] * np.eye(3)[None, :, None, :] - B.transpose(0, 3, 2, 1)
    H = sparse.csr_array(P.reshape(3 * len(rigid), 3 * len(rigid)))
    return sparse.block_array([[mass[x][:, x], G], [G.T, H]], format="csr")
