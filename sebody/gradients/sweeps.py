"""The two recursions over the accepted steps of a run: forward by parameters, backward by
objectives. Equations as numbered in the README of this folder.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.engine.state import Scheme
from sebody.gradients.factors import Factors, Scales
from sebody.gradients.history import STEP, History
from sebody.gradients.linear import Linear, Parts
from sebody.gradients.second_rates import second_rates
from sebody.gradients.turns import Turns, turns_of

PIECE = 256         # events whose rotations are prepared together


class Bars(NamedTuple):
    """Derivatives of objectives by a state, (n, m) each: by multipliers in those of motion."""

    motion: NDArray
    rates: NDArray
    seconds: NDArray


class Seeds(Protocol):
    """What objectives say of the states of events."""

    def at(self, event: int) -> Bars | None:
        """Derivatives of all objectives by the state that an event leaves."""


class Coefficients(NamedTuple):
    """Of generalized-alpha with a step h."""

    h: float
    am: float
    af: float
    b: float
    g: float

    @classmethod
    def of(cls, scheme: Scheme, h: float) -> "Coefficients":
        return cls(h, scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma)

    @property
    def cm(self) -> float:
        """``da' / dy``."""
        return (1 - self.am) / ((1 - self.af) * self.b * self.h**2)

    @property
    def cd(self) -> float:
        """``dv' / dy``."""
        return self.g / (self.b * self.h)

    @property
    def cu(self) -> float:
        """``daux' / dy``."""
        return 1 / (self.b * self.h**2)


class Event(NamedTuple):
    """An event, linearized."""

    number: int
    parts: Parts
    factors: Factors
    turns: Turns | None                         # of a step
    rates: tuple[NDArray, NDArray] | None       # of second rates by motion and rates: of restarts


class Course:
    """Linearized events of a run, forth or back."""

    def __init__(self, linear: Linear, scheme: Scheme, history: History):
        self.linear, self.scheme, self.history = linear, scheme, history
        system, n = linear.system, linear.free
        self.fixed = system.is_multiplier[:n] > 0       # multipliers, which do not move
        self.moving = (~self.fixed).astype(float)[:, None]
        places = system.rotation_at[system.rotation_at < n]
        self.turning = places[:, None] + np.arange(3)
        self.redundant = bool(system.regularized[0])
        self._scales: dict[float, Scales] = {}
        self._q = linear.state.recorded_parts["q"].start
        self._turns: tuple[int, list[Turns]] = 0, []        # of some events, from the first one on

    def settle(self) -> None:
        """Multipliers at the ends of steps before jumps: the run has kept those that follow."""
        found, state = self.history, self.linear.state
        for k in np.flatnonzero(found.kinds[1:] != STEP):
            row = found.rows[k]
            q = row[self._q:self._q + self.linear.free]
            q[self.fixed] = 0.0
            event = self._event(int(k))
            forces = state.residual[:self.linear.free, None].copy()
            forces[self.fixed] = 0.0
            q[self.fixed] = -event.factors.solve(forces)[self.fixed, 0]

    def events(self, backwards: bool) -> Iterator[Event]:
        """All events."""
        numbers = range(len(self.history.rows))
        for k in reversed(numbers) if backwards else numbers:
            yield self._event(k)

    def _event(self, k: int) -> Event:
        found = self.history
        row, h = found.rows[k], float(found.steps[k])
        parts = self.linear.at(row, found.ends[k], found.besides[k])
        if found.kinds[k] != STEP:
            rates = second_rates(self.linear, self.fixed) if k > 0 else None
            return Event(k, parts, self._factors(_initial(parts, self.fixed), 0.0), None, rates)
        c = Coefficients.of(self.scheme, h)
        turns = self._turns_of(k)
        J = c.cm * parts.mass + c.cd * parts.damping + turns.of_columns(parts.stiffness)
        return Event(k, parts, self._factors(J, h), turns, None)

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
        return Factors(J, self._scales[h], self.fixed, self.redundant)


def _initial(parts: Parts, fixed: NDArray) -> NDArray:
    """Masses and constraints: the matrix of a restart."""
    if isinstance(parts.mass, np.ndarray):
        J = parts.mass.copy()
        J[fixed] = parts.stiffness[fixed]
        J[:, fixed] = parts.stiffness[:, fixed]
        return J
    some, others = (sparse.diags_array(x.astype(float)) for x in (fixed, ~fixed))
    K = parts.stiffness
    return sparse.csc_array(others @ parts.mass @ others + some @ K + others @ K @ some)


def forward(course: Course, slopes: NDArray, motion: NDArray, rates: NDArray,
            see: Callable[[int, NDArray, NDArray, NDArray], None]) -> None:
    """(8) to (10): derivatives of all states by parameters.

    Parameters
    ----------
    slopes : (events, n, p)
        Of the residuals by parameters, in states that are held; those of the start with its motion
        and rates.
    motion, rates : (n, p)
        Of the start.
    see : function
        Is given the number of an event, and derivatives of its state: of motion with multipliers,
        rates and second rates, (n, p) each.
    """
    moving = course.moving
    xi, v = motion * moving, rates * moving
    a = aux = np.zeros_like(xi)
    for event in course.events(backwards=False):
        M, C, K = event.parts
        if event.turns is None:
            y = -slopes[event.number]
            if event.number:        # the slopes of the start hold what its motion does
                y -= _of_restart(event, course.fixed, xi * moving, v)
            y = event.factors.solve(y)
            a = y * moving
            xi, aux = xi * moving + y * (1 - moving), a
        else:
            c = Coefficients.of(course.scheme, float(course.history.steps[event.number]))
            offset = course.history.offsets[event.number]
            aux = (1 - offset) * a + offset * aux
            auxp = -(v / c.h + (0.5 - c.b) * aux) / c.b
            vp = v + c.h * (1 - c.g) * aux + c.h * c.g * auxp
            ap = ((1 - c.am) * auxp + c.am * aux - c.af * a) / (1 - c.af)
            xip = event.turns.moved(xi) * moving
            y = event.factors.solve(-(slopes[event.number] + K @ xip + C @ vp + M @ ap))
            xi, y = xip + event.turns.turned(y), y * moving
            v, a, aux = vp + c.cd * y, ap + c.cm * y, auxp + c.cu * y
        see(event.number, xi, v, a)


def _of_restart(event: Event, fixed: NDArray, xi: NDArray, v: NDArray) -> NDArray:
    """What motion and rates change of the residual of a restart."""
    found = event.parts.stiffness @ xi + event.parts.damping @ v
    found[fixed] = event.rates[0] @ xi + event.rates[1] @ v
    return found


class Adjoint(NamedTuple):
    """Result of a sweep back."""

    weights: NDArray    # (events, n, m) of the slopes of the residuals: (16)
    motion: NDArray     # (n, m) of the motion at the start, given rates, accelerations solved for
    rates: NDArray      # (n, m)
    sizes: NDArray      # (events,) largest effect of a disturbance of each state on an objective


def backward(course: Course, seeds: Seeds, count: int) -> Adjoint:
    """(11) to (15): derivatives of objectives by the residuals of all events and by the start."""
    n, moving = course.linear.free, course.moving
    X, V, A, U = (np.zeros((n, count)) for _ in range(4))
    events = len(course.history.rows)
    extent = course.linear.system.magnitude[:n, None]       # of disturbances: of rates in the run
    duration = course.history.ends[-1]
    weights, sizes = np.zeros((events, n, count)), np.zeros(events)
    for event in course.events(backwards=True):
        k = event.number
        M, C, K = event.parts
        if (seed := seeds.at(k)) is not None:
            X, V, A = X + seed.motion, V + seed.rates * moving, A + seed.seconds * moving
        if event.turns is None:
            w = event.factors.solve(-(A * moving + U + X * (1 - moving)), transposed=True)
            X, A, U = X * moving, np.zeros_like(A), np.zeros_like(U)
            if k:
                of_forces = w.copy()
                of_forces[course.fixed] = 0.0
                X = X + (K.T @ of_forces + event.rates[0].T @ w[course.fixed]) * moving
                V = V + (C.T @ of_forces + event.rates[1].T @ w[course.fixed]) * moving
        else:
            c = Coefficients.of(course.scheme, float(course.history.steps[k]))
            offset = course.history.offsets[k]
            w = event.factors.solve(-(event.turns.turned_back(X) + moving * (
                c.cd * V + c.cm * A + c.cu * U)), transposed=True)
            X1, V1, A1 = ((X + K.T @ w) * moving, (V + C.T @ w) * moving, (A + M.T @ w) * moving)
            U1 = U + c.h * c.g * V1 + (1 - c.am) / (1 - c.af) * A1
            X = event.turns.moved_back(X1)
            V = V1 - U1 / (c.b * c.h)
            A = -c.af / (1 - c.af) * A1
            U = c.h * (1 - c.g) * V1 + c.am / (1 - c.af) * A1 - (0.5 - c.b) / c.b * U1
            A, U = A + (1 - offset) * U, offset * U
        weights[k] = w
        sizes[k] = max(np.abs(X * extent).max(), np.abs(V * extent).max() / duration)
    return Adjoint(weights, X, V, sizes)
