"""Linearized events of runs of index 2: their equations are those of `stabilized`."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.engine.restart import SHORT
from sebody.gradients import stabilized
from sebody.gradients.coefficients import Coefficients
from sebody.gradients.course import Course, Event, initial
from sebody.gradients.history import RESTART, STEP, History
from sebody.gradients.linear import Linear, Matrix, Parts
from sebody.gradients.rates import Rates, rows_of
from sebody.gradients.second_rates import second_rates
from sebody.gradients.turns import Turns
from sebody.runs.simulation import Simulation


def course_of(run: Simulation, linear: Linear, history: History) -> Course:
    """Linearized events of a run, ready for sweeps."""
    found = (StabilizedCourse if run.scheme.stabilized else Course)(run, linear, history)
    found.settle()
    return found


class StabilizedCourse(Course):
    """Course of index 2: unknowns are increments and shifts, see `stabilized`."""

    def __init__(self, run: Simulation, linear: Linear, history: History):
        super().__init__(run, linear, history)
        self.rates = Rates(linear, run.model.size())
        self.lead = self.scheme.alpha_m - self.scheme.alpha_f
        self.restarts = [k for k, kind in enumerate(history.kinds.tolist())
                         if kind == RESTART and (k > 0 or history.past is None)]

    def settle(self) -> None:
        """Also corrections in look aheads, and shifts."""
        n, h = self.linear.free, self.history.steps
        corrections = np.array([self._correction(k) for k in self.restarts]).reshape(-1, n)
        each = [Coefficients.of(self.scheme, step) for step in h.tolist()]
        self.second = stabilized.Second(
            np.array([c.cd for c in each]), np.array([c.cm for c in each]),
            self._shifts(corrections), SHORT * h, corrections, int(self.history.past is None))
        super().settle()

    def _step(self, parts: Parts, c: Coefficients, turns: Turns) -> tuple[Matrix, Parts]:
        return stabilized.step(parts, self.rates.by_motion(), c.cm, c.cd, turns, self.fixed)

    def _restart(self, k: int) -> Event:
        found, end, beside = self.history, self.history.ends[k], self.history.besides[k]
        assert self.second is not None
        ahead = self._ahead(k)
        corrected, own = found.rows[k].copy(), self.second.corrections[self.restarts.index(k)]
        for name, what in (("a", ~self.fixed), ("q", self.fixed)):
            first = self.linear.state.recorded_parts[name].start
            corrected[first:first + len(own)] += own * what
        J, parts = stabilized.restart(
            self._equations(found.rows[k], end, beside), self._equations(corrected, end, beside),
            self._equations(ahead.row, end + ahead.dt, beside), ahead.turns, ahead.dt, self.fixed)
        return Event(k, parts, self._factors(J, 0.0), None, None, self.lead / SHORT)

    def _equations(self, row: NDArray, end: float, beside: float) -> stabilized.Restart:
        """Equations of a restart in a state."""
        parts = self.linear.at(row, end, beside)
        by_motion, by_rates = second_rates(self.linear, self.fixed)
        return stabilized.Restart(
            initial(parts, self.fixed), with_rows(parts.damping, self.fixed, by_rates),
            with_rows(parts.stiffness, self.fixed, by_motion))

    def _ahead(self, k: int) -> stabilized.Ahead:
        found = self.history
        self.linear.at(found.rows[k], found.ends[k], found.besides[k])
        return stabilized.look_ahead(self.linear, self.turning, float(found.steps[k]),
                                     float(found.ends[k]), float(found.besides[k]))

    def _correction(self, k: int) -> NDArray:
        """Accelerations and multipliers that a restart is corrected by in its look ahead."""
        found = self.history
        parts = self.linear.at(found.rows[k], found.ends[k], found.besides[k])
        factors = self._factors(initial(parts, self.fixed), -1.0)
        return factors.solve(self._ahead(k).forces[:, None])[:, 0]

    def _shifts(self, corrections: NDArray) -> NDArray:
        """Shifts in all steps, which are what (1) leaves of the motion."""
        found, s, n = self.history, self.scheme, self.linear.free
        parts = self.linear.state.recorded_parts
        q, v, a = (found.rows[:, parts[name].start:parts[name].start + n] for name in "qva")
        aux, restarts, shifts = found.aux[:n], iter(corrections), np.zeros((len(q), n))
        for k in range(int(found.past is not None), len(q)):
            if found.kinds[k] != STEP:
                aux = a[k] - self.lead / SHORT * next(restarts) * ~self.fixed
                continue
            h = found.steps[k]
            aux = a[k - 1] + found.offsets[k] * (aux - a[k - 1])
            after = ((v[k] - v[k - 1]) / h - (1 - s.gamma) * aux) / s.gamma
            moved = q[k] - q[k - 1]
            moved[self.turning] = q[k][self.turning]
            y = h * v[k - 1] + h * h * ((0.5 - s.beta) * aux + s.beta * after)
            shifts[k], aux = (moved - y) * ~self.fixed, after
        return shifts


def with_rows(A: Matrix, which: NDArray, rows: NDArray) -> Matrix:
    """Some rows of a matrix replaced."""
    put = sparse.csc_array((np.ones(len(rows)), (np.flatnonzero(which), np.arange(len(rows)))),
                           shape=(A.shape[0], len(rows)))
    if isinstance(A, np.ndarray):
        return rows_of(A, ~which) + put @ rows
    return sparse.csc_array(rows_of(A, ~which) + put @ sparse.csc_array(rows))
