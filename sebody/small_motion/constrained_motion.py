"""Small motion of a model with constraints in coordinates that may move freely."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lstsq, lu_factor, lu_solve, qr, solve_triangular

from sebody.assembly.numbering import hidden_states
from sebody.basics.errors import InputError
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.small_motion.coordinate_names import coordinate_names
from sebody.small_motion.inputs_of_motion import Input
from sebody.small_motion.pressed_friction import without_multipliers

DEPENDENT = 1e-9    # pivot, of the largest, of constraints that others contain
MASSLESS = 1e-13    # likewise, of the masses
RATE = "{}.rate"


class ConstrainedMotion:
    """Small motion of a constrained model: its coordinates that may move freely, and the rest.

    Matrices and pushes are of all unknowns, positions in global axes.
    """

    def __init__(self, run: Simulation | Result, matrices: list[NDArray], inputs: list[Input]):
        M, C, K = matrices
        n = len(K)
        self._inputs = inputs
        self._multipliers = np.flatnonzero(run.system.is_multiplier[:n])
        self._moving = np.setdiff1d(np.arange(n), self._multipliers)
        moving, inner = self._moving, np.ix_(self._moving, self._moving)
        self._matrices = M[inner], C[inner], K[inner]
        self._constraint_columns = K[np.ix_(moving, self._multipliers)]
        self._pushes = np.array([one.pushes for one in inputs]).transpose(1, 2, 0)     # (3, n, m)
        self._scale = 1.0 / np.sqrt(np.maximum(np.diag(self._matrices[0]),
                                               1e-12 * np.diag(self._matrices[0]).max()))
        self._eliminate(K[np.ix_(self._multipliers, moving)])
        self._tests = without_multipliers(self._N, K[np.ix_(self._multipliers, moving)],
                                          self._constraint_columns)
        driven = [bool(one.moves) for one in inputs]
        self._driven = np.flatnonzero(driven)
        self._free_names = [coordinate_names(run)[moving[k]] for k in self._independent]
        self._hidden = hidden_states(run.model, run.numbering)

    def _eliminate(self, G: NDArray) -> None:
        """Choose coordinates that follow from the others: those that the constraints hold best."""
        m, n = G.shape
        rows = np.linalg.norm(G * self._scale, axis=1)
        rows[rows == 0.0] = 1.0
        Q, R, order = qr(G * self._scale / rows[:, None], pivoting=True)
        pivots = np.abs(np.diag(R))
        rank = int(np.sum(pivots > DEPENDENT * pivots.max(initial=0.0)))
        dependent, self._independent = order[:rank], np.sort(order[rank:])
        back = np.argsort(order[rank:])
        follow = -solve_triangular(R[:rank, :rank], R[:rank, rank:][:, back])
        free = self._independent
        self._N = np.zeros((n, len(free)))
        self._N[free, np.arange(len(free))] = 1.0
        self._N[dependent] = self._scale[dependent, None] * follow / self._scale[free]
        b = self._pushes[0][self._multipliers] / rows[:, None]
        turned = Q.T @ b
        if np.abs(turned[rank:]).max(initial=0.0) > 1e-7 * np.abs(b).max(initial=0.0):
            raise InputError(f"a drive among {', '.join(one.name for one in self._inputs)} cannot "
                             "move: other joints or drives hold what it drives; name another input")
        self._P = np.zeros((n, b.shape[1]))
        self._P[dependent] = self._scale[dependent, None] * solve_triangular(
            R[:rank, :rank], turned[:rank])

    def _independent_pushes(self) -> list[NDArray]:
        """``f_k - X_k P`` of the moving unknowns, for stiffness, damping and mass."""
        M, C, K = self._matrices
        return [f[self._moving] - X @ self._P for f, X in zip(self._pushes, (K, C, M), strict=True)]

    def matrices(self) -> tuple[NDArray, NDArray]:
        """A and B."""
        N, L, r = self._N, self._tests, self._N.shape[1]
        m, d = len(self._inputs), len(self._driven)
        M, C, K = (L.T @ X @ N for X in self._matrices)
        size = 1.0 / np.sqrt(np.maximum(np.abs(np.diag(M)), 1e-300))
        factors = lu_factor(size[:, None] * M * size)
        pivots = np.abs(np.diag(factors[0]))
        if r and pivots.min() < MASSLESS * pivots.max():
            raise InputError("the model has motions without mass, which have no state: give every "
                             "node that moves mass and rotation inertia")

        def accelerated(X: NDArray) -> NDArray:
            return size[:, None] * lu_solve(factors, size[:, None] * X)
        by_value, by_rate, by_second = (accelerated(L.T @ X) for X in self._independent_pushes())
        A, B = np.zeros((2 * r + 2 * d, 2 * r + 2 * d)), np.zeros((2 * r + 2 * d, m))
        A[:r, r:2 * r] = np.eye(r)
        A[r:2 * r, :r], A[r:2 * r, r:2 * r] = -accelerated(K), -accelerated(C)
        B[r:2 * r] = by_value
        at = self._driven
        A[r:2 * r, 2 * r:2 * r + d], A[r:2 * r, 2 * r + d:] = by_value[:, at], by_rate[:, at]
        B[r:2 * r, at] = by_second[:, at]
        A[2 * r:2 * r + d, 2 * r + d:] = np.eye(d)
        B[2 * r + d + np.arange(d), at] = 1.0
        return A, B

    def amplitudes(self) -> NDArray:
        """Inputs and their rates, (3, size + m, m), of every state and every input alone."""
        r, m, d = self._N.shape[1], len(self._inputs), len(self._driven)
        size = 2 * r + 2 * d
        values = np.zeros((3, size + m, m))
        values[0, size + np.arange(m), np.arange(m)] = 1.0
        for k, j in enumerate(self._driven):
            values[:, size + j, j] = 0.0, 0.0, 1.0
            values[0, 2 * r + k, j] = values[1, 2 * r + d + k, j] = 1.0
        return values

    def motions(self, A: NDArray, B: NDArray) -> list[NDArray]:
        """Motion of all unknowns, multipliers included, and its rates, by every state and input."""
        r = self._N.shape[1]
        amplitudes = self.amplitudes()
        cases = np.eye(len(A) + B.shape[1])
        second = np.vstack([A[r:2 * r].T, B[r:2 * r].T])
        n = len(self._moving) + len(self._multipliers)
        rows = [np.zeros((len(cases), n)) for _ in range(3)]
        for z, xi, u in zip(rows, (cases[:, :r], cases[:, r:2 * r], second), amplitudes,
                            strict=True):
            z[:, self._moving] = xi @ self._N.T + u @ self._P.T
        if self._multipliers.size:
            M, C, K = self._matrices
            left = (sum(u @ f[self._moving].T for u, f in zip(amplitudes, self._pushes,
                                                              strict=True))
                    - sum(z[:, self._moving] @ X.T for z, X in zip(rows, (K, C, M),
                                                                   strict=True)))
            constraint_columns = self._scale[:, None] * self._constraint_columns
            columns = np.linalg.norm(constraint_columns, axis=0)
            columns[columns == 0.0] = 1.0
            forces = lstsq(constraint_columns / columns, self._scale[:, None] * left.T,
                           cond=DEPENDENT)[0]
            rows[0][:, self._multipliers] = (forces / columns[:, None]).T
        return rows

    def names(self) -> tuple[str, ...]:
        """Names of the states."""
        driven = [self._inputs[j].name for j in self._driven]
        free = self._moving[self._independent]
        rates = [self._hidden.get(at, RATE.format(name))
                 for at, name in zip(free, self._free_names, strict=True)]
        listed = [*self._free_names, *rates, *driven, *map(RATE.format, driven)]
        return tuple(listed[k] for k in self.states)

    @property
    def states(self) -> NDArray:
        """Numbers of the states without integrals of controllers' states: nothing depends on them.
        """
        hidden = np.isin(self._moving[self._independent], list(self._hidden))
        total = 2 * len(self._independent) + 2 * len(self._driven)
        return np.setdiff1d(np.arange(total), np.flatnonzero(hidden))
