"""Dependent positions, at the ends of rigid links: their motion by that of the unknowns, exactly.

With material angular velocity Omega and acceleration A of an arm r, ``s = Omega x r``::

    (18) dx = dx_root + R (theta x r)
         dv = dv_root + R (dOmega x r) + R (theta x s)
    (19) da = da_root + R (dA x r) + R (dOmega x s + Omega x (dOmega x r))
              + R (theta x (A x r + Omega x s))
    (20) dx = G xi,  dv = G xi' + V xi,  da = G xi'' + W xi' + U xi

The iteration matrix of a run leaves out V, W and U, without harm to what it converges to; a
derivative cannot.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.vectors import skew
from sebody.engine.links import Links
from sebody.engine.state import State

SKEW_AXES = np.array([skew(axis) for axis in np.eye(3)])


class Motion(NamedTuple):
    """(20): operators from the unknowns to all coordinates, (total, free)."""

    G: NDArray | sparse.csc_array
    V: NDArray | sparse.csc_array
    W: NDArray | sparse.csc_array
    U: NDArray | sparse.csc_array


class Followers:
    """The dependent positions of a model."""

    def __init__(self, links: Links, free: int, total: int):
        self.links, self.free, self.total = links, free, total
        self.planar = links.arm_vectors.shape[1] == 2
        d, turns, n = 2 if self.planar else 3, 1 if self.planar else 3, np.arange(free)
        roots = np.array([(x, root) for x, root, *_ in links.dependent if root < free],
                         dtype=np.int64).reshape(-1, 2)
        self.arms = np.array([
            (*links.arms[arm], arm, x) for x, _, first, last in links.dependent
            for arm in range(first, last) if links.arms[arm, 1] < free],
            dtype=np.int64).reshape(-1, 4)      # rotation, its coordinate, arm, position
        own, x = self.arms[:, 1], self.arms[:, 3]
        # entries of all operators: of unknowns and of roots, which are ones, then of arms
        self.ones = free + d * len(roots)
        self.rows = np.concatenate([n, _steps(roots[:, 0], d), _steps(x, d, turns, False)])
        self.columns = np.concatenate([n, _steps(roots[:, 1], d), _steps(own, turns, d, True)])
        self.levers = _steps(own, turns, turns, False), _steps(own, turns, turns, True)

    def __bool__(self) -> bool:
        return bool(self.links.dependent.shape[0])

    def motion(self, state: State, dense: bool) -> Motion:
        """The operators in a state."""
        blocks = self._in_plane(state) if self.planar else self._in_space(state)
        ones, found = np.ones(self.ones), []
        for own in blocks:
            numbers = np.concatenate([ones, own.ravel()])
            found.append(self._matrix(numbers, self.rows, self.columns, self.total, dense))
            ones = np.zeros(self.ones)
        return Motion(*found)

    def _turned(self, state: State) -> tuple[NDArray, NDArray]:
        """In a plane arms in global axes, and the same a right angle ahead; in space rotation
        matrices, and skew matrices of the arms.
        """
        r = self.links.arm_vectors[self.arms[:, 2]]
        if not self.planar:
            return state.R.reshape(-1, 3, 3)[self.arms[:, 0]], _skews(r)
        co, si = np.cos(state.q[self.arms[:, 1]]), np.sin(state.q[self.arms[:, 1]])
        x, y = co * r[:, 0] - si * r[:, 1], si * r[:, 0] + co * r[:, 1]
        return np.stack([x, y], axis=1), np.stack([-y, x], axis=1)

    def _in_plane(self, state: State) -> tuple[NDArray, ...]:
        """Blocks of all arms in G, V, W and U."""
        p, t = self._turned(state)
        rate, second = (x[self.arms[:, 1:2]] for x in (state.v, state.a))
        return t, -rate * p, -2.0 * rate * p, -second * p - rate * rate * t

    def _in_space(self, state: State) -> tuple[NDArray, ...]:
        """The same."""
        R, skew = self._turned(state)
        own = self.arms[:, 1:2] + np.arange(3)
        r, omega = self.links.arm_vectors[self.arms[:, 2]], _skews(state.v[own])
        s = _times(omega, r)
        of_s, second = _skews(s), _times(_skews(state.a[own]), r) + _times(omega, s)
        return -R @ skew, -R @ of_s, -R @ (of_s + omega @ skew), -R @ _skews(second)

    def _matrix(self, numbers: NDArray, rows: NDArray, columns: NDArray, height: int, dense: bool
                ) -> NDArray | sparse.csc_array:
        """Matrix of entries that add up."""
        shape = height, self.free
        if dense:
            return np.bincount(rows * self.free + columns, numbers, height * self.free).reshape(
                shape)
        return sparse.csc_array((numbers, (rows, columns)), shape=shape)

    def reduced(self, state: State, M: NDArray, C: NDArray, K: NDArray, dense: bool
                ) -> tuple[NDArray, NDArray, NDArray]:
        """Matrices of all coordinates as those of the unknowns; forces are in the residual."""
        G, V, W, U = self.motion(state, dense)
        return (G.T @ (M @ G), G.T @ (C @ G + M @ W),
                G.T @ (K @ G + C @ V + M @ U) + self._levers(state, dense))

    def _levers(self, state: State, dense: bool) -> NDArray | sparse.csc_array:
        """Derivative of the moments of constant forces as their arms turn."""
        forces = state.residual[self.arms[:, 3:] + np.arange(2 if self.planar else 3)]
        if self.planar:
            blocks = -(self._turned(state)[0] * forces).sum(axis=1)
        else:
            R, skew = self._turned(state)
            blocks = skew @ _skews(_times(R.transpose(0, 2, 1), forces))
        return self._matrix(blocks.ravel(), *self.levers, self.free, dense)


def _steps(first: NDArray, count: int, others: int = 1, inner: bool = True) -> NDArray:
    """Numbers of blocks, row by row: those of rows, or of columns, `count` of them from each first.
    """
    own = first[:, None] + np.arange(count)
    return (np.tile(own, (1, others)) if inner else np.repeat(own, others, axis=1)).ravel()


def _skews(x: NDArray) -> NDArray:
    """Skew matrices (m, 3, 3) of vectors (m, 3)."""
    return np.tensordot(x, SKEW_AXES, 1)


def _times(A: NDArray, x: NDArray) -> NDArray:
    """Products (m, 3) of matrices and vectors."""
    return (A @ x[..., None])[..., 0]
