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

from sebody.compiler.decorators import compiled
from sebody.engine.links import Links
from sebody.engine.state import State


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
        blocks = _arms(self.arms, self.links.arm_vectors, state.q, state.R, state.v, state.a)
        ones, found = np.ones(self.ones), []
        for own in blocks:
            numbers = np.concatenate([ones, own.ravel()])
            found.append(self._matrix(numbers, self.rows, self.columns, self.total, dense))
            ones = np.zeros(self.ones)
        return Motion(*found)

    def _matrix(self, numbers: NDArray, rows: NDArray, columns: NDArray, height: int, dense: bool
                ) -> NDArray | sparse.csc_array:
        """Of entries that add up."""
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
        blocks = _levers(self.arms, self.links.arm_vectors, state.q, state.R, state.residual)
        return self._matrix(blocks.ravel(), *self.levers, self.free, dense)


def _steps(first: NDArray, count: int, others: int = 1, inner: bool = True) -> NDArray:
    """Numbers of blocks, row by row: those of rows, or of columns, `count` of them from each first.
    """
    own = first[:, None] + np.arange(count)
    return (np.tile(own, (1, others)) if inner else np.repeat(own, others, axis=1)).ravel()


@compiled
def _skew(x):
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


@compiled
def _arms(arms, vectors, q, R, v, a):
    """Blocks of all arms in G, V, W and U: (18) and (19)."""
    d = vectors.shape[1]
    turns = 1 if d == 2 else 3
    found = np.empty((4, arms.shape[0], d, turns))
    for k in range(arms.shape[0]):
        c, r = arms[k, 1], vectors[arms[k, 2]]
        if d == 2:
            co, si, rate = np.cos(q[c]), np.sin(q[c]), v[c]
            x, y = co * r[0] - si * r[1], si * r[0] + co * r[1]
            for i, p, t in ((0, x, -y), (1, y, x)):
                found[0, k, i, 0], found[1, k, i, 0] = t, -rate * p
                found[2, k, i, 0] = -2.0 * rate * p
                found[3, k, i, 0] = -a[c] * p - rate * rate * t
            continue
        turn = np.ascontiguousarray(R[9 * arms[k, 0]:9 * arms[k, 0] + 9]).reshape(3, 3)
        arm, spin, second = _skew(r), _skew(v[c:c + 3]), _skew(a[c:c + 3])
        s = np.dot(spin, r)
        found[0, k] = -np.dot(turn, arm)
        found[1, k] = -np.dot(turn, _skew(s))
        found[2, k] = -np.dot(turn, _skew(s) + np.dot(spin, arm))
        found[3, k] = -np.dot(turn, _skew(np.dot(second, r) + np.dot(spin, s)))
    return found


@compiled
def _levers(arms, vectors, q, R, residual):
    """Blocks of all arms: of the moment of a force by the arm's turning."""
    d = vectors.shape[1]
    turns = 1 if d == 2 else 3
    found = np.empty((arms.shape[0], turns, turns))
    for k in range(arms.shape[0]):
        c, r = arms[k, 1], vectors[arms[k, 2]]
        force = residual[arms[k, 3]:arms[k, 3] + d]
        if d == 2:
            co, si = np.cos(q[c]), np.sin(q[c])
            found[k, 0, 0] = -((co * r[0] - si * r[1]) * force[0]
                               + (si * r[0] + co * r[1]) * force[1])
            continue
        turn = np.ascontiguousarray(R[9 * arms[k, 0]:9 * arms[k, 0] + 9]).reshape(3, 3)
        found[k] = np.dot(_skew(r), _skew(np.dot(turn.T, force)))
    return found
