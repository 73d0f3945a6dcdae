"""The two recursions over the accepted steps of a run: forward by parameters, backward by
objectives. Equations as numbered in the README of this folder.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sebody.gradients.coefficients import Coefficients
from sebody.gradients.course import Course, Event
from sebody.gradients.history import RESTART, STEP

# motion, rates, second and auxiliary rates; what laws keep, and have kept before the last step; the
# increments of this step: changes or bars, a column each
Motion = Sequence[NDArray]


class Bars(NamedTuple):
    """Derivatives of objectives by a state, (n, m) each: by multipliers in those of motion."""

    motion: NDArray
    rates: NDArray
    seconds: NDArray


class Seeds(Protocol):
    """Derivatives of objectives by the states of events."""

    def at(self, event: int) -> Bars | None:
        """Derivatives of all objectives by the state that an event leaves."""

    def of_events(self, first: int, last: int) -> tuple[NDArray, NDArray]:
        """The same of some events, (events, m, 3, n), and which of them have any, (events,)."""


def forward(course: Course, slopes: NDArray, motion: NDArray, rates: NDArray,
            see: Callable[[int, NDArray], None], before: Motion | None = None) -> Motion:
    """(8) to (10): derivatives of all states by parameters.

    Parameters
    ----------
    slopes : (events, n + k, p)
        Of the residuals by parameters, in states that are held, and of what laws keep; those of
        the start with its motion and rates.
    motion, rates : (n, p)
        Of the start.
    see : function
        Is given the number of the first of some events, and derivatives of their states: of motion
        with multipliers, rates and second rates, (events, 3, n, p).
    before : sequence of (n, p)
        What the sweep over the segment before has returned, in place of the start's.
    """
    now: Motion = before or (motion * course.moving, rates * course.moving,
                             *course.nothing(motion.shape[1])[2:])
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
    xi, v, _, _, *kept = now
    n, moving = len(xi), course.moving
    y = -slopes[:course.unknowns]
    if event.number:        # the slopes of the start hold what its motion does
        y -= _of_restart(course, event, xi * moving, v, kept)
    y, shift = _halves(event.factors.solve(y), moving)
    kept = course.nothing(xi.shape[1])[4:]
    xi = xi * moving + y * (1 - moving)
    if course.kept:
        own = (xi, v, *now[5:]) if event.number else (y * (1 - moving), 0.0 * v, *kept[1:])
        kept[0] = slopes[n:] + course.along(event.number, *own)[1]
    return xi, v, y * moving, y * moving - event.lead * shift, *kept


def _halves(y: NDArray, moving: NDArray) -> tuple[NDArray, NDArray]:
    """Increments with multipliers, and shifts, which only index 2 has."""
    n = len(moving)
    return y[:n], moving * (y[n:] if len(y) > n else 0.0)


def _over_step(course: Course, event: Event, slopes: NDArray, now: Motion) -> Motion:
    """(8) to (10)."""
    (M, C, K), moving, (xi, v, a, aux, *kept) = event.parts, course.moving, now
    assert event.turns is not None      # which restarts do not have
    c = Coefficients.of(course.scheme, float(course.history.steps[event.number]))
    offset = course.history.offsets[event.number]
    aux = (1 - offset) * a + offset * aux
    auxp = -(v / c.h + (0.5 - c.b) * aux) / c.b
    vp = v + c.h * (1 - c.g) * aux + c.h * c.g * auxp
    ap = ((1 - c.am) * auxp + c.am * aux - c.af * a) / (1 - c.af)
    xip = event.turns.moved(xi) * moving
    y, shift = _halves(event.factors.solve(-(slopes + K @ xip + C @ vp + M @ ap)), moving)
    xi, y = xip + event.turns.turned(y + shift), y * moving
    return xi, vp + c.cd * y, ap + c.cm * y, auxp + c.cu * y, *kept


def _of_restart(course: Course, event: Event, xi: NDArray, v: NDArray, kept: Motion) -> NDArray:
    """Change of a restart's residual by motion and rates, and by what laws have kept before."""
    if course.kept:
        found = course.along(event.number, xi, v, *kept[1:])[0]
    else:
        found = event.parts.stiffness @ xi + event.parts.damping @ v
    if event.rates is not None:
        found[course.fixed] = event.rates[0] @ xi + event.rates[1] @ v
    return found


class Adjoint(NamedTuple):
    """Result of a sweep back."""

    weights: NDArray    # (events, m, n + k) of the slopes of the residuals and of what laws keep
    bars: Motion        # (n, m) each, by the state at the start: accelerations are solved for
    sizes: NDArray      # (events,) largest effect of a disturbance of each state on an objective


def backward(course: Course, seeds: Seeds, count: int, after: Motion | None = None) -> Adjoint:
    """(11) to (15): derivatives of objectives by the residuals of all events and by the start.

    `after` are the bars that the sweep over the segment after this one has ended with.
    """
    n, events = course.linear.free, len(course.history.rows)
    extent = course.linear.system.magnitude[:n, None]       # of disturbances: of rates in the run
    duration = course.history.duration
    weights, sizes = np.zeros((events, count, course.unknowns + course.kept)), np.zeros(events)
    bars: Motion = after or course.nothing(count)
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
    (X, V, A, U, *kept), moving = bars, course.moving
    return X + seed.motion, V + seed.rates * moving, A + seed.seconds * moving, U, *kept


def _back_over_restart(course: Course, event: Event, bars: Motion) -> tuple[NDArray, Motion]:
    """Weights, and bars before."""
    (_, C, K), moving, (X, V, A, U, Z, *_) = event.parts, course.moving, bars
    before = course.nothing(X.shape[1])[4:]
    of_kept = course.transposed(event.number, 0.0 * X, Z) if course.kept else None
    if of_kept is not None:     # slopes of the start hold what its motion does
        X = X + of_kept.motion * (1.0 if event.number else 1 - moving)
    w = event.factors.solve(-_joined(course, A * moving + U + X * (1 - moving),
                                     -event.lead * U * moving), transposed=True)
    X = X * moving
    if event.number:
        of_forces, rates = w.copy(), event.rates
        if rates is not None:
            of_forces[course.fixed] = 0.0
            X = X + rates[0].T @ w[course.fixed] * moving
            V = V + rates[1].T @ w[course.fixed] * moving
        if of_kept is not None:
            own = course.transposed(event.number, of_forces, 0.0 * Z)
            X, V = X + own.motion * moving, V + (own.rates + of_kept.rates) * moving
            before[1:] = own.kept + of_kept.kept, own.increments + of_kept.increments
        else:
            X, V = X + K.T @ of_forces * moving, V + C.T @ of_forces * moving
    return np.concatenate([w, Z]), (X, V, np.zeros_like(A), np.zeros_like(U), *before)


def _joined(course: Course, y: NDArray, shift: NDArray) -> NDArray:
    """Bars of the unknowns of an event, from its halves."""
    return y if course.unknowns == len(y) else np.concatenate([y, shift])


def _back_over_step(course: Course, event: Event, bars: Motion) -> tuple[NDArray, Motion]:
    """(11) to (15)."""
    (M, C, K), moving, (X, V, A, U, *kept) = event.parts, course.moving, bars
    assert event.turns is not None
    c = Coefficients.of(course.scheme, float(course.history.steps[event.number]))
    offset, turned = course.history.offsets[event.number], event.turns.turned_back(X)
    w = event.factors.solve(-_joined(course, turned + moving * (c.cd * V + c.cm * A + c.cu * U),
                                     turned * moving), transposed=True)
    X1, V1, A1 = ((X + K.T @ w) * moving, (V + C.T @ w) * moving, (A + M.T @ w) * moving)
    U1 = U + c.h * c.g * V1 + (1 - c.am) / (1 - c.af) * A1
    X, V, A = event.turns.moved_back(X1), V1 - U1 / (c.b * c.h), -c.af / (1 - c.af) * A1
    U = c.h * (1 - c.g) * V1 + c.am / (1 - c.af) * A1 - (0.5 - c.b) / c.b * U1
    return w, (X, V, A + (1 - offset) * U, offset * U, *kept)
