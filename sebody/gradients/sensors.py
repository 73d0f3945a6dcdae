"""Derivatives of quantities by the states of a run."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.vectors import skew
from sebody.gradients.followed import Followed, Rows, refuse_kept
from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.kernels.rotations import inverse_tangent_coefficients
from sebody.quantities.names import AXES, NORM
from sebody.quantities.symbols import NoTape
from sebody.results.naming import look_up, rotation_vectors
from sebody.results.recording import Recording
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import SMALL, Moves, differences

PIECE = 64          # motions that are compared at a time
FINER = 30.0        # factor of the steps of differences from one try to the next
SMALLEST = 1e-8     # of them, of the characteristic length: rounding is 1e-8 of a derivative then
WHOLE = 1e-6        # rad: a rotation that near whole turns has a vector without derivative
LARGE = 1.0         # rad: from here on closed forms are as exact as series
CLOSE = 1e-5        # of the largest derivative: differences that agree like this are right


class Sensor(Protocol):
    """A quantity that objectives look at."""

    def at(self, k: int, event: int) -> Rows:
        """Derivatives in a recorded state."""


def rows_over(sensor: Sensor, states: Sequence[int], events: Sequence[int]) -> Rows:
    """Derivatives in some recorded states, (states, components, n) each."""
    if isinstance(sensor, Followed):
        return sensor.over(events)
    return Rows(*map(np.array, zip(*(sensor.at(k, event) for k, event in zip(
        states, events, strict=True)), strict=True)))


def put(linear: Linear, history: History, event: int) -> None:
    """Make the state of an event that of the arrays."""
    linear.put(history.rows[event], history.ends[event], history.besides[event])


class Evaluated:
    """A quantity without a tape, differentiated along all motions that it depends on."""

    def __init__(self, run: Simulation, quantity: str, size: int, linear: Linear,
                 history: History):
        self.run, self.quantity, self.size = run, quantity, size
        self.linear, self.history = linear, history
        self.kept: dict[int, Rows] = {}     # of recorded states

    def at(self, k: int, event: int) -> Rows:
        if k not in self.kept:
            self.kept[k] = self._differentiated(event)
        return self.kept[k]

    def _differentiated(self, event: int) -> Rows:
        linear, n = self.linear, self.linear.free
        put(linear, self.history, event)
        G, V, W, U = linear.followers.motion(linear.state, dense=True)
        none = np.zeros((n, linear.total))
        moves = [np.concatenate(parts) for parts in (
            (G.T, none, none), (V.T, G.T, none), (U.T, W.T, G.T))]
        one = Result(self.run.model, self.run.numbering, linear.system, linear.state,
                     linear.state.now[None].copy(), 0.0)
        refuse_kept(self.run, self.quantity)
        found = self._smooth(one, moves, float(self.history.ends[event]))
        return Rows(*(part.T for part in np.split(found, 3)))

    def _smooth(self, one: Result, moves: list[NDArray], t: float) -> NDArray:
        """Differences over steps that are so small that smaller ones give the same."""
        small, last = SMALL, self._at(one, moves, SMALL)
        while small > SMALLEST:
            small /= FINER
            found = self._at(one, moves, small)
            apart = np.abs(found - last).max(axis=0)
            if (apart <= CLOSE * np.abs(last).max(axis=0)).all():
                return last
            last = found
        raise InputError(f"quantity {self.quantity!r} has no derivative at t = {t:.6g}: it is not "
                         "smooth there, as a length is not where it is zero: give its components, "
                         "or another time")

    def _at(self, one: Result, moves: list[NDArray], small: float) -> NDArray:
        count = len(moves[0])
        found = np.zeros((count, self.size))
        for first in range(0, count, PIECE):
            piece = slice(first, min(first + PIECE, count))
            along = Moves(*(move[piece] for move in moves))
            pushed = np.zeros((len(along.positions), self.linear.state.g.size))
            found[piece] = differences(one, [self.quantity], along, pushed, small)[
                self.quantity].reshape(-1, self.size)
        return found


def smoothly(run: Simulation, quantity: str, size: int, linear: Linear, history: History
             ) -> Followed | Evaluated:
    """Sensor of a smooth quantity: its tape, or differences."""
    try:
        return Followed(run, quantity, linear, history)
    except NoTape:
        return Evaluated(run, quantity, size, linear, history)


class RotationVector:
    """Components of a rotation vector, or its length, where it is followed through turns.

    Of a vector phi of any length, ``R = exp(phi)`` and ``dR = R skew(theta)``:

        dphi = theta + phi x theta / 2 + (1 - |phi|/2 cot(|phi|/2)) phi x (phi x theta) / |phi|^2

    Parameters
    ----------
    matrices : Followed
        Of the nine entries of R.
    rotations, vectors : (states, 3, 3), (states, 3)
        R and phi in the recorded states.
    component : str
    """

    def __init__(self, matrices: Followed, rotations: NDArray, vectors: NDArray, component: str):
        self.matrices, self.rotations, self.vectors = matrices, rotations, vectors
        self.component = component

    def at(self, k: int, event: int) -> Rows:
        R, phi = self.rotations[k], self.vectors[k]
        operator = self._rate(phi)
        return Rows(*(operator @ _axial(R.T @ rows.reshape(3, 3, -1).transpose(2, 0, 1))
                      for rows in self.matrices.at(k, event)))

    def _rate(self, phi: NDArray) -> NDArray:
        """Derivative of the component by theta, (1, 3)."""
        angle, across = float(np.linalg.norm(phi)), skew(phi)
        name = f"{self.matrices.quantity}.{self.component}"
        turns = round(angle / (2 * np.pi))
        if turns and abs(angle - 2 * np.pi * turns) < WHOLE:
            raise InputError(f"quantity {name!r} has no derivative where the rotation is "
                             f"{turns} whole turn{'s' * (turns > 1)}: give the angle of a joint, "
                             "or another time")
        e = ((1.0 - 0.5 * angle / np.tan(0.5 * angle)) / angle**2 if angle > LARGE else
             inverse_tangent_coefficients(angle**2)[0])
        found = np.eye(3) + 0.5 * across + e * (across @ across)
        if self.component != NORM:
            return found[[AXES.index(self.component)]]
        if angle == 0.0:
            raise InputError(f"quantity {name!r} is zero in a state, where it has no derivative: "
                             "give its components")
        return (phi / angle)[None] @ found


def rotation_vector(run: Simulation, quantity: str, linear: Linear, history: History
                    ) -> RotationVector | None:
    """Sensor of a component or the length of a rotation vector; None of other quantities."""
    base, _, component = quantity.rpartition(".")
    if component not in (*AXES, NORM):
        return None
    before = history.past is not None   # turns are counted from the state before a segment on
    rows = history.rows[np.concatenate([[0], history.recorded])] if before else history.states
    parts = run.model, run.numbering, run.system, run.state
    try:
        if look_up(Recording(*parts, rows[:1], 0.0), base).shape[1:] != (3, 3):
            return None
    except InputError:      # no quantity of its own
        return None
    matrices = look_up(Recording(*parts, rows, 0.0), base)
    return RotationVector(Followed(run, base, linear, history), matrices[before:],
                          rotation_vectors(matrices)[before:], component)


def _axial(S: NDArray) -> NDArray:
    """Vectors (3, k) of skew matrices (k, 3, 3)."""
    return 0.5 * np.array([S[:, 2, 1] - S[:, 1, 2], S[:, 0, 2] - S[:, 2, 0],
                           S[:, 1, 0] - S[:, 0, 1]])
