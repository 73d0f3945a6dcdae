"""The accepted steps of a run and its restarts as linearized events, which sweeps pass."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.gradients import products
from sebody.gradients.coefficients import Coefficients
from sebody.gradients.factors import Factors, Scales
from sebody.gradients.history import STEP, History
from sebody.gradients.linear import Linear, Matrix, Parts
from sebody.gradients.products import Products
from sebody.gradients.refined import Refined
from sebody.gradients.second_rates import second_rates
from sebody.gradients.stabilized import Second
from sebody.gradients.turns import Turns, turns_of
from sebody.runs.simulation import Simulation

PIECE = 256         # events that are prepared together
CORRECTIONS = 6     # of multipliers before a jump, on which friction depends


class Event(NamedTuple):
    """An event, linearized: unknowns are increments or accelerations, of index 2 shifts as well."""

    number: int
    parts: Parts        # of the residuals of the unknowns, (N, n)
    factors: Factors    # (N, N)
    turns: Turns | None                         # of a step
    rates: tuple[NDArray, NDArray] | None       # of second rates by motion and rates: of restarts
    lead: float = 0.0   # of restarts: auxiliary accelerations less shifts times this


class OfKept(NamedTuple):
    """Bars by weights of forces and of what laws keep, a column each."""

    motion: NDArray
    rates: NDArray
    kept: NDArray       # of what was kept before
    increments: NDArray


class Course:
    """Linearized events of a run, forth or back."""

    def __init__(self, run: Simulation, linear: Linear, history: History):
        self.linear, self.scheme, self.history = linear, run.scheme, history
        system, n = linear.system, linear.free
        self.fixed = system.is_multiplier[:n] > 0       # multipliers, which do not move
        self.moving = (~self.fixed).astype(float)[:, None]
        places = system.rotation_at[system.rotation_at < n]
        self.turning = places[:, None] + np.arange(3)
        self.redundant = bool(system.regularized[0])
        self.unknowns = n * (2 if run.scheme.stabilized else 1)     # of an event
        self.products = Products.of(run) if linear.dense and self.unknowns == n else None
        self.kept = 0 if self.products is None else self.products.kept.shape[1]     # by laws
        self.second: Second | None = None       # what second residuals of index 2 are made with
        self._scales: dict[float, Scales] = {}
        self._q = linear.state.recorded_parts["q"].start
        self._turns: tuple[int, list[Turns]] = 0, []        # of some events, from the first one on

    def settle(self) -> None:
        """Multipliers at the ends of steps before jumps: the run has kept those that follow."""
        found, state = self.history, self.linear.state
        for k in np.flatnonzero(found.kinds[1:] != STEP):
            row = found.rows[k]
            q = row[self._q:self._q + self.linear.free]
            if not self.kept:       # else forces depend on them in other ways, too
                q[self.fixed] = 0.0
            for _ in range(CORRECTIONS if self.kept else 1):
                event = self.event(int(k))
                forces = np.zeros((self.unknowns, 1))
                forces[:len(q), 0] = np.where(self.fixed, 0.0, state.residual[:len(q)])
                q[self.fixed] -= event.factors.solve(forces)[:len(q)][self.fixed, 0]

    def refined(self, columns: int, back: bool) -> Refined | None:
        """The recursion by products; None where matrices are quicker, or there are no products.

        A matrix is worth as many products as it has columns; it says nothing of what laws keep.
        """
        if self.products is None or (columns > self.linear.free and not self.kept):
            return None
        return Refined(self.linear, self.products, self.scheme, self.history, columns, back,
                       self.turning[:, 0], self.redundant)

    def nothing(self, columns: int) -> list[NDArray]:
        """Changes or bars that are zero."""
        n, k = self.linear.free, self.kept
        return [np.zeros((rows, columns)) for rows in (n, n, n, n, k, k, n)]

    def along(self, event: int, xi: NDArray, v: NDArray, before: NDArray, increments: NDArray
              ) -> tuple[NDArray, NDArray]:
        """Changes of forces and of what laws keep at an event, by those of the motion there and of
        what was kept before: columns.
        """
        found, n = self._prepared(event), self.linear.free
        forces, kept = np.zeros_like(xi), np.zeros_like(before)
        for j in range(xi.shape[1]):
            found.motion[:], found.kept[0] = 0.0, before[:, j]
            found.motion[0, :n], found.motion[1, :n] = xi[:, j], v[:, j]
            found.motion[3, :n] = increments[:, j]
            products.along(self.linear.system, self.linear.state, found, n)
            forces[:, j], kept[:, j] = found.forces[:n], found.kept[1]
        return forces, kept

    def transposed(self, event: int, weights: NDArray, kept: NDArray) -> OfKept:
        """Bars at an event by weights of forces and of what laws keep: columns."""
        found, n = self._prepared(event), self.linear.free
        bars = OfKept(*(np.zeros_like(one) for one in (weights, weights, kept, weights)))
        for j in range(weights.shape[1]):
            found.forces[:n], found.kept[1] = weights[:, j], kept[:, j]
            products.transposed(self.linear.system, self.linear.state, found, n)
            bars.motion[:, j], bars.rates[:, j] = found.motion[0, :n], found.motion[1, :n]
            bars.kept[:, j], bars.increments[:, j] = found.kept[0], found.motion[3, :n]
        return bars

    def _prepared(self, event: int) -> Products:
        """Products in the state of an event."""
        assert self.products is not None
        self.linear.at(self.history.rows[event], self.history.ends[event],
                       self.history.besides[event])
        if products.prepare(self.linear.system, self.linear.state, self.products):
            raise InputError(f"the state at t = {self.history.ends[event]:.6g} has no derivatives")
        return self.products

    def stretches(self) -> list[tuple[int, int, int]]:
        """Kind, first and last of events in a row: pieces of steps, single restarts."""
        kinds, begin = self.history.kinds, int(self.history.past is not None)
        # if there is one, event 0 is of the segment before
        single = np.flatnonzero(kinds != STEP)
        found = [(int(kinds[k]), int(k), int(k)) for k in single if k >= begin]
        ends = [begin - 1, *single[single >= begin].tolist(), len(kinds)]
        for before, after in zip(ends, ends[1:], strict=False):
            found += [(STEP, k, min(k + PIECE, after) - 1)
                      for k in range(before + 1, after, PIECE)]
        return sorted(found, key=lambda one: one[1])

    def event(self, k: int) -> Event:
        found = self.history
        if found.kinds[k] != STEP:
            return self._restart(k)
        h, turns = float(found.steps[k]), self._turns_of(k)
        parts = self.linear.at(found.rows[k], found.ends[k], found.besides[k])
        J, parts = self._step(parts, Coefficients.of(self.scheme, h), turns)
        return Event(k, parts, self._factors(J, h), turns, None)

    def _step(self, parts: Parts, c: Coefficients, turns: Turns) -> tuple[Matrix, Parts]:
        """The matrix of a step, and derivatives of its residuals."""
        return c.cm * parts.mass + c.cd * parts.damping + turns.of_columns(parts.stiffness), parts

    def _restart(self, k: int) -> Event:
        found = self.history
        parts = self.linear.at(found.rows[k], found.ends[k], found.besides[k])
        rates = second_rates(self.linear, self.fixed) if k > 0 else None
        return Event(k, parts, self._factors(initial(parts, self.fixed), 0.0), None, rates)

    def _turns_of(self, k: int) -> Turns:
        first, found = self._turns
        if not first <= k < first + len(found):
            first = k - k % PIECE
            rows = self.history.rows[first:first + PIECE]
            found = turns_of(self.turning, rows[:, self._q + self.turning])
            self._turns = first, found
        return found[k - first]

    def _factors(self, J: NDArray, h: float) -> Factors:
        if h not in self._scales:
            self._scales[h] = Scales(J)
        fixed = np.tile(self.fixed, J.shape[0] // len(self.fixed))
        return Factors(J, self._scales[h], fixed, self.redundant)


def initial(parts: Parts, fixed: NDArray) -> NDArray:
    """Masses and constraints: the matrix of a restart."""
    if isinstance(parts.mass, np.ndarray):
        J = parts.mass.copy()
        J[fixed] = parts.stiffness[fixed]
        J[:, fixed] = parts.stiffness[:, fixed]
        return J
    some, others = (sparse.diags_array(x.astype(float)) for x in (fixed, ~fixed))
    K = parts.stiffness
    return sparse.csc_array(others @ parts.mass @ others + some @ K + others @ K @ some)
