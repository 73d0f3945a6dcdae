"""The linearized runs of simplified models, all of them in one forward sweep.

A simplified model moves by xi, v, a beside the full one, whose run is known. It follows (8) to (10)
of the README under constraints that what it loses is zero, whose forces are ``E mu``:

    (25) J dy + E mu = -(K xip + C vp + M ap),   E^T (xip + T dy) = -e

The start has the same for positions, rates and accelerations. The matrix J of a step is factorized
once for all simplified models.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.gradients.coefficients import Coefficients
from sebody.gradients.course import Course, Event
from sebody.gradients.factors import Factors
from sebody.gradients.second_rates import second_rates
from sebody.gradients.simplifications import Motion
from sebody.model.numbering import coordinates
from sebody.runs.simulation import Simulation

CUTOFF = 1e-9       # relative: forces of constraints that other constraints exclude


class Change(NamedTuple):
    """The differences of simplified models from the full one in a state."""

    motion: NDArray     # (n, p) of the unknowns, multipliers included
    rates: NDArray      # (n, p)
    seconds: NDArray    # (n, p)
    forces: NDArray     # (forces of all elements, p) of what is held, on the bodies


class Lost(NamedTuple):
    """All that is lost in a state: (24), of all simplified models together."""

    whole: NDArray      # (total, K) E of all coordinates
    E: NDArray          # (n, K) of the unknowns
    e: NDArray          # (K, 1)
    rate: NDArray       # (K, 1)
    second: NDArray     # (K, 1)
    ends: NDArray       # of each motion


See = Callable[[int, Change], None]


class Sweep:
    """Changes of the motion by simplifications.

    Parameters
    ----------
    run : Simulation
    course : Course
        Of the full model.
    models : sequence of sequences of Motion
        What each simplified model loses.
    """

    def __init__(self, run: Simulation, course: Course, models: Sequence[Sequence[Motion]]):
        self.course, self.linear = course, course.linear
        self.given = given_rates(run)
        self.each = list(dict.fromkeys(one for own in models for one in own))
        self.models = [[self.each.index(one) for one in own] for own in models]

    def go(self, see: See) -> None:
        """The whole sweep; `see` is given the number of every event, and what changes there."""
        shape = self.linear.free, len(self.models)
        xi, v, a, aux = (np.zeros(shape) for _ in range(4))
        for k in range(len(self.course.history.rows)):
            event = self.course.event(k)
            lost = self._lost()
            if event.turns is None:
                xi, v, a, mu = self._restart(event, lost, xi, v)
                aux = a
            else:
                xi, v, a, aux, mu = self._step(event, lost, xi, v, a, aux)
            see(event.number, Change(xi, v, a, self._forces(lost, mu)))

    def _lost(self) -> Lost:
        """Motion that is lost in the state that was evaluated last."""
        linear = self.linear
        found = [one.at(linear.state) for one in self.each]
        whole, *others = (np.concatenate(parts, axis=-1) for parts in zip(*found, strict=True))
        if linear.followers:
            E = linear.followers.motion(linear.state, linear.dense).G.T @ whole
        else:
            E = whole[:linear.free]
        e, rate, second = (one[:, None] for one in others)
        return Lost(whole, E, e, rate, second, np.cumsum([0, *(one.E.shape[1] for one in found)]))

    def _forces(self, lost: Lost, mu: NDArray) -> NDArray:
        """Forces of constraints on the bodies that are rigid."""
        found = np.zeros((self.linear.state.g.size, len(self.models)))
        for k, one in enumerate(self.each):
            if one.forces is not None:
                own = slice(lost.ends[k], lost.ends[k + 1])
                places = self.linear.system.g_unknown[one.forces]
                found[one.forces] += lost.whole[places, own] @ mu[own]
        return found

    def _step(self, event: Event, lost: Lost, xi: NDArray, v: NDArray, a: NDArray, aux: NDArray
              ) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
        course, k = self.course, event.number
        c = Coefficients.of(course.scheme, float(course.history.steps[k]))
        offset, moving, turns = course.history.offsets[k], course.moving, event.turns
        assert turns is not None
        M, C, K = event.parts
        aux = (1 - offset) * a + offset * aux
        auxp = -(v / c.h + (0.5 - c.b) * aux) / c.b
        vp = v + c.h * (1 - c.g) * aux + c.h * c.g * auxp
        ap = ((1 - c.am) * auxp + c.am * aux - c.af * a) / (1 - c.af)
        xip = turns.moved(xi) * moving
        y, mu = self._solved(event.factors, -(K @ xip + C @ vp + M @ ap), lost,
                             turns.turned_back(lost.E), -lost.e - lost.E.T @ xip)
        xi, y = xip + turns.turned(y), y * moving
        return xi, vp + c.cd * y, ap + c.cm * y, auxp + c.cu * y, mu

    def _restart(self, event: Event, lost: Lost, xi: NDArray, v: NDArray
                 ) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Accelerations are solved for anew; at the start of a run motion and rates are fitted."""
        fixed, moving, factors = self.course.fixed, self.course.moving, event.factors
        M, C, K = event.parts
        xi, rates, ones = xi * moving, event.rates, np.ones((1, len(self.models)))
        if event.number == 0:
            none = np.zeros_like(xi)
            xi = self._solved(factors, none, lost, lost.E, -lost.e * ones)[0] * moving
            v = self._fitted(factors, lost)
            if xi.any() or v.any():
                rates = second_rates(self.linear, fixed)
        rhs = -(K @ xi + C @ v)
        rhs[fixed] = 0.0 if rates is None else -(rates[0] @ xi + rates[1] @ v)
        y, mu = self._solved(factors, rhs, lost, lost.E, -lost.second * ones)
        return xi + y * (1 - moving), v, y * moving, mu

    def _fitted(self, factors: Factors, lost: Lost) -> NDArray:
        """Rates of the start: those that were given stay, others change least in energy."""
        n = self.linear.free
        given = np.eye(n)[:, self.given]
        found = np.zeros((n, len(self.models)))
        for j, own in enumerate(self.models):
            places = self._places(lost, own)
            target = -lost.rate[places]
            if target.any():
                A = np.hstack([given, lost.E[:, places]])
                found[:, [j]] = _constrained(found[:, [j]], factors.solve(A), A, np.concatenate(
                    [np.zeros((len(self.given), 1)), target]))[0]
        return found * self.course.moving

    def _places(self, lost: Lost, own: list[int]) -> NDArray:
        """Columns of E of some motions."""
        none = np.zeros(0, dtype=int)
        return np.concatenate([none, *(np.arange(lost.ends[i], lost.ends[i + 1]) for i in own)])

    def _solved(self, factors: Factors, rhs: NDArray, lost: Lost, rows: NDArray, target: NDArray
                ) -> tuple[NDArray, NDArray]:
        """Solutions of (25): every column under the constraints of its model alone.

        Parameters
        ----------
        rows : (n, K)
            Of the constraints, by the unknowns that are solved for.
        target : (K, p)

        Returns
        -------
        (n, p), (K, p)
            Unknowns, and forces of the constraints.
        """
        p = rhs.shape[1]
        found = factors.solve(np.hstack([rhs, lost.E]))
        y, Z, mu = found[:, :p].copy(), found[:, p:], np.zeros_like(target)
        for j, own in enumerate(self.models):
            places = self._places(lost, own)
            y[:, [j]], mu[places, j:j + 1] = _constrained(y[:, [j]], Z[:, places], rows[:, places],
                                                          target[places, j:j + 1])
        return y, mu


def _constrained(y: NDArray, Z: NDArray, rows: NDArray, target: NDArray
                 ) -> tuple[NDArray, NDArray]:
    """``y - Z mu`` with ``rows^T (y - Z mu) = target``, and the least mu if it is not unique."""
    mu = np.linalg.lstsq(rows.T @ Z, rows.T @ y - target, rcond=CUTOFF)[0]
    return y - Z @ mu, mu


def given_rates(run: Simulation) -> list[int]:
    """Unknowns whose rates at the start were given."""
    known = run.numbering.dof_blocks
    return [i for block in run.model.dof_blocks() if block.solved and block.given and block in known
            for i in coordinates(run.numbering, block)]
