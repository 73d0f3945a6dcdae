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

from sebody.engine.links import Links
from sebody.engine.state import State
from sebody.vectors import skew


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
        self.rows, self.columns, self.turned = self._pattern()

    def __bool__(self) -> bool:
        return bool(self.links.dependent.shape[0])

    def _pattern(self) -> tuple[NDArray, NDArray, int]:
        """Rows and columns of the blocks of all operators: of roots, then of arms."""
        links, d = self.links, self.links.arm_vectors.shape[1]
        turns = 1 if self.planar else 3
        rows, columns = [], []
        for x, root, first, last in links.dependent:
            if root < self.free:
                rows.append(x + np.arange(d))
                columns.append(root + np.arange(d))
            for arm in range(first, last):
                c = links.arms[arm, 1]
                if c < self.free:
                    rows.append(np.repeat(x + np.arange(d), turns))
                    columns.append(np.tile(c + np.arange(turns), d))
        none = [np.zeros(0, dtype=np.int64)]
        return np.concatenate(rows + none), np.concatenate(columns + none), turns

    def motion(self, state: State, dense: bool) -> Motion:
        """The operators in a state."""
        values: list[list[NDArray]] = [[], [], [], []]
        links, d = self.links, self.links.arm_vectors.shape[1]
        for _, root, first, last in links.dependent:
            if root < self.free:
                values[0].append(np.ones(d))
                for other in values[1:]:
                    other.append(np.zeros(d))
            for arm in range(first, last):
                if links.arms[arm, 1] < self.free:
                    for own, block in zip(values, self._arm(state, arm), strict=True):
                        own.append(block.ravel())
        n = np.arange(self.free)
        found = []
        for k, own in enumerate(values):
            numbers = np.concatenate([np.ones(self.free) * (k == 0), *own])
            rows, columns = np.concatenate([n, self.rows]), np.concatenate([n, self.columns])
            one = sparse.csc_array((numbers, (rows, columns)), shape=(self.total, self.free))
            found.append(one.toarray() if dense else one)
        return Motion(*found)

    def _arm(self, state: State, arm: int) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Blocks of an arm in G, V, W and U."""
        number, c = self.links.arms[arm]
        r = self.links.arm_vectors[arm]
        if self.planar:
            co, si = np.cos(state.q[c]), np.sin(state.q[c])
            p = np.array([co * r[0] - si * r[1], si * r[0] + co * r[1]])
            t = np.array([-p[1], p[0]])
            rate, second = state.v[c], state.a[c]
            return t, -rate * p, -2.0 * rate * p, -second * p - rate * rate * t
        R = state.R[9 * number:9 * number + 9].reshape(3, 3)
        omega, second = state.v[c:c + 3], state.a[c:c + 3]
        s = np.cross(omega, r)
        return (-R @ skew(r), -R @ skew(s), -R @ (skew(s) + skew(omega) @ skew(r)),
                -R @ skew(np.cross(second, r) + np.cross(omega, s)))

    def reduced(self, state: State, M: NDArray, C: NDArray, K: NDArray, dense: bool
                ) -> tuple[NDArray, NDArray, NDArray]:
        """Matrices of all coordinates as those of the unknowns; forces are in the residual."""
        G, V, W, U = self.motion(state, dense)
        return (G.T @ (M @ G), G.T @ (C @ G + M @ W),
                G.T @ (K @ G + C @ V + M @ U) + self._levers(state, dense))

    def _levers(self, state: State, dense: bool) -> NDArray | sparse.csc_array:
        """Derivative of the moments of constant forces as their arms turn."""
        links, d = self.links, self.links.arm_vectors.shape[1]
        rows, columns, values = ([np.zeros(0)] for _ in range(3))
        for x, _, first, last in links.dependent:
            force = state.residual[x:x + d]
            for arm in range(first, last):
                number, c = links.arms[arm]
                if c >= self.free:
                    continue
                r = links.arm_vectors[arm]
                if self.planar:
                    co, si = np.cos(state.q[c]), np.sin(state.q[c])
                    p = np.array([co * r[0] - si * r[1], si * r[0] + co * r[1]])
                    block = np.array([[-p @ force]])
                else:
                    R = state.R[9 * number:9 * number + 9].reshape(3, 3)
                    block = skew(r) @ skew(R.T @ force)
                own = c + np.arange(len(block))
                row, column = np.broadcast_arrays(own[:, None], own[None])
                for into, what in zip((rows, columns, values), (row, column, block), strict=True):
                    into.append(np.ravel(what))
        found = sparse.csc_array(
            (np.concatenate(values), (np.concatenate(rows).astype(int),
                                      np.concatenate(columns).astype(int))),
            shape=(self.free, self.free))
        return found.toarray() if dense else found
