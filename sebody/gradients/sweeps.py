"""The two recursions over the accepted steps of a run: forward by parameters, backward by
objectives. Equations as numbered in the README of this folder.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.engine.state import Scheme
from sebody.gradients.factors import Factors, Scales
from sebody.gradients.history import RESTART, STEP, History
from sebody.gradients.linear import Linear, Matrix, Parts
from sebody.gradients.products import Products
from sebody.gradients.refined import Refined
from sebody.gradients.second_rates import second_rates
from sebody.gradients.stabilized import Second
from sebody.gradients.turns import Turns, turns_of
from sebody.runs.simulation import Simulation

PIECE = 256         # events that are prepared together


class Bars(NamedTuple):
    """Derivatives of objectives by a state, (n, m) each: by multipliers in those of motion."""

    motion: NDArray
    rates: NDArray
    seconds: NDArray


class Seeds(Protocol):
    """What objectives say of the states of events."""

    def at(self, event: int) -> Bars | None:
        """Derivatives of all objectives by the state that an event leaves."""

    def of_events(self, first: int, last: int) -> tuple[NDArray, NDArray]:
        """The same of some events, (events, m, 3, n), and which of them have any, (events,)."""


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
    """An event, linearized: unknowns are increments or accelerations, of index 2 shifts as well."""

    number: int
    parts: Parts        # of the residuals of the unknowns, (N, n)
    factors: Factors    # (N, N)
    turns: Turns | None                         # of a step
    rates: tuple[NDArray, NDArray] | None       # of second rates by motion and rates: of restarts
    lead: float = 0.0   # of restarts: auxiliary accelerations less shifts times this


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
            q[self.fixed] = 0.0
            event = self.event(int(k))
            forces = np.zeros((self.unknowns, 1))
            forces[:len(q), 0] = np.where(self.fixed, 0.0, state.residual[:len(q)])
            q[self.fixed] = -event.factors.solve(forces)[:len(q)][self.fixed, 0]

    def refined(self, columns: int, back: bool) -> Refined | None:
        """The recursion by products; None where matrices are quicker, or there are no products.

        A matrix is worth as many products as it has columns.
        """
        if self.products is None or columns > self.linear.free:
            return None
        return Refined(self.linear, self.products, self.scheme, self.history, columns, back,
                       self.turning[:, 0], self.redundant)

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


Motion = Sequence[NDArray]      # motion, rates, second and auxiliary rates, or bars of them


def forward(course: Course, slopes: NDArray, motion: NDArray, rates: NDArray,
            see: Callable[[int, NDArray], None], before: Motion | None = None) -> Motion:
    """(8) to (10): derivatives of all states by parameters.

    Parameters
    ----------
    slopes : (events, n, p)
        Of the residuals by parameters, in states that are held; those of the start with its motion
        and rates.
    motion, rates : (n, p)
        Of the start.
    see : function
        Is given the number of the first of some events, and derivatives of their states: of motion
        with multipliers, rates and second rates, (events, 3, n, p).
    before : sequence of (n, p)
        What the sweep over the segment before has returned, in place of the start's.
    """
    now: Motion = before or (motion * course.moving, rates * course.moving, 0.0 * motion,
                             0.0 * motion)
    refined = course.refined(motion.shape[1], back=False)
    for kind, first, last in course.stretches():
        if kind == RESTART:
            now = _over_restart(course, course.event(first), slopes[first], now)
            see(first, np.array(now[:3])[None])
        elif refined is None:
            for k in range(first, last + 1):
                now = _over_step(course, course.event(k), slopes[k], now)
                see(k, np.array(now[:3])[None])
        else:
            refined.begin(now)
            states = np.zeros((last + 1 - first, motion.shape[1], 3, len(motion)))
            refined.over(first, last, np.ascontiguousarray(slopes[first:last + 1].swapaxes(1, 2)),
                         states)
            now = refined.motion
            see(first, np.moveaxis(states, 1, -1))
    return now


def _over_restart(course: Course, event: Event, slopes: NDArray, now: Motion) -> Motion:
    """Accelerations and multipliers anew."""
    xi, v, *_ = now
    moving, y = course.moving, -slopes
    if event.number:        # the slopes of the start hold what its motion does
        y -= _of_restart(event, course.fixed, xi * moving, v)
    y, shift = _halves(event.factors.solve(y), moving)
    return (xi * moving + y * (1 - moving), v, y * moving, y * moving - event.lead * shift)


def _halves(y: NDArray, moving: NDArray) -> tuple[NDArray, NDArray]:
    """Increments with multipliers, and shifts, which only index 2 has."""
    n = len(moving)
    return y[:n], moving * (y[n:] if len(y) > n else 0.0)


def _over_step(course: Course, event: Event, slopes: NDArray, now: Motion) -> Motion:
    """(8) to (10)."""
    (M, C, K), moving, (xi, v, a, aux) = event.parts, course.moving, now
    c = Coefficients.of(course.scheme, float(course.history.steps[event.number]))
    offset = course.history.offsets[event.number]
    aux = (1 - offset) * a + offset * aux
    auxp = -(v / c.h + (0.5 - c.b) * aux) / c.b
    vp = v + c.h * (1 - c.g) * aux + c.h * c.g * auxp
    ap = ((1 - c.am) * auxp + c.am * aux - c.af * a) / (1 - c.af)
    xip = event.turns.moved(xi) * moving
    y, shift = _halves(event.factors.solve(-(slopes + K @ xip + C @ vp + M @ ap)), moving)
    xi, y = xip + event.turns.turned(y + shift), y * moving
    return xi, vp + c.cd * y, ap + c.cm * y, auxp + c.cu * y


def _of_restart(event: Event, fixed: NDArray, xi: NDArray, v: NDArray) -> NDArray:
    """What motion and rates change of the residual of a restart."""
    found = event.parts.stiffness @ xi + event.parts.damping @ v
    if event.rates is not None:
        found[fixed] = event.rates[0] @ xi + event.rates[1] @ v
    return found


class Adjoint(NamedTuple):
    """Result of a sweep back."""

    weights: NDArray    # (events, m, n) of the slopes of the residuals: (16)
    bars: Motion        # (n, m) each, by the state at the start: accelerations are solved for
    sizes: NDArray      # (events,) largest effect of a disturbance of each state on an objective


def backward(course: Course, seeds: Seeds, count: int, after: Motion | None = None) -> Adjoint:
    """(11) to (15): derivatives of objectives by the residuals of all events and by the start.

    `after` are the bars that the sweep over the segment after this one has ended with.
    """
    n, events = course.linear.free, len(course.history.rows)
    extent = course.linear.system.magnitude[:n, None]       # of disturbances: of rates in the run
    duration = course.history.duration
    weights, sizes = np.zeros((events, count, course.unknowns)), np.zeros(events)
    bars: Motion = after or [np.zeros((n, count)) for _ in range(4)]
    refined = course.refined(count, back=True)
    for kind, first, last in reversed(course.stretches()):
        if kind == STEP and refined is not None:
            refined.begin(bars)
            piece = slice(first, last + 1)
            refined.over(first, last, *seeds.of_events(first, last), weights[piece], sizes[piece])
            bars = refined.motion
            continue
        for k in range(last, first - 1, -1):
            over = _back_over_restart if kind == RESTART else _back_over_step
            w, bars = over(course, course.event(k), _seeded(course, seeds.at(k), bars))
            weights[k] = w.T
            sizes[k] = max(np.abs(bars[0] * extent).max(),
                           np.abs(bars[1] * extent).max() / duration)
    return Adjoint(weights, bars, sizes)


def _seeded(course: Course, seed: Bars | None, bars: Motion) -> Motion:
    """With what objectives say of the state."""
    if seed is None:
        return bars
    (X, V, A, U), moving = bars, course.moving
    return X + seed.motion, V + seed.rates * moving, A + seed.seconds * moving, U


def _back_over_restart(course: Course, event: Event, bars: Motion) -> tuple[NDArray, Motion]:
    """Weights, and bars before."""
    (_, C, K), moving, (X, V, A, U) = event.parts, course.moving, bars
    w = event.factors.solve(-_joined(course, A * moving + U + X * (1 - moving),
                                     -event.lead * U * moving), transposed=True)
    X = X * moving
    if event.number:
        of_forces, rates = w.copy(), event.rates
        if rates is not None:
            of_forces[course.fixed] = 0.0
            X = X + rates[0].T @ w[course.fixed] * moving
            V = V + rates[1].T @ w[course.fixed] * moving
        X, V = X + K.T @ of_forces * moving, V + C.T @ of_forces * moving
    return w, (X, V, np.zeros_like(A), np.zeros_like(U))


def _joined(course: Course, y: NDArray, shift: NDArray) -> NDArray:
    """Bars of the unknowns of an event, from its halves."""
    return y if course.unknowns == len(y) else np.concatenate([y, shift])


def _back_over_step(course: Course, event: Event, bars: Motion) -> tuple[NDArray, Motion]:
    """(11) to (15)."""
    (M, C, K), moving, (X, V, A, U) = event.parts, course.moving, bars
    c = Coefficients.of(course.scheme, float(course.history.steps[event.number]))
    offset, turned = course.history.offsets[event.number], event.turns.turned_back(X)
    w = event.factors.solve(-_joined(course, turned + moving * (c.cd * V + c.cm * A + c.cu * U),
                                     turned * moving), transposed=True)
    X1, V1, A1 = ((X + K.T @ w) * moving, (V + C.T @ w) * moving, (A + M.T @ w) * moving)
    U1 = U + c.h * c.g * V1 + (1 - c.am) / (1 - c.af) * A1
    X, V, A = event.turns.moved_back(X1), V1 - U1 / (c.b * c.h), -c.af / (1 - c.af) * A1
    U = c.h * (1 - c.g) * V1 + c.am / (1 - c.af) * A1 - (0.5 - c.b) / c.b * U1
    return w, (X, V, A + (1 - offset) * U, offset * U)
