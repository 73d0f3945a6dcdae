"""Derivatives of quantities by the states of a run."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import Moves, differences

PIECE = 64          # motions that are compared at a time


class Rows(NamedTuple):
    """Derivatives of the components of a quantity, (components, n) each."""

    motion: NDArray
    rates: NDArray
    seconds: NDArray


class Sensor(Protocol):
    """A quantity that objectives look at."""

    def at(self, k: int, event: int) -> Rows:
        """Derivatives in a recorded state."""


def put(linear: Linear, history: History, event: int) -> None:
    """Make the state of an event that of the arrays."""
    linear.at(history.rows[event], history.ends[event], history.besides[event])


class Coordinates:
    """A quantity whose components are coordinates, their rates or second rates."""

    def __init__(self, what: str, places: list[int], linear: Linear, history: History):
        self.what, self.places, self.linear, self.history = what, places, linear, history
        self.follows = places[-1] >= linear.free and bool(linear.followers)
        self._own = self._of(np.eye(linear.total, linear.free)[places])

    def _of(self, rows: NDArray) -> Rows:
        none = np.zeros_like(rows)
        return Rows(*(rows if self.what == name else none for name in "qva"))

    def at(self, k: int, event: int) -> Rows:
        if not self.follows:
            return self._own
        put(self.linear, self.history, event)
        G, V, W, U = self.linear.followers.motion(self.linear.state, dense=True)
        none = np.zeros((len(self.places), self.linear.free))
        operators = {"q": (G,), "v": (V, G), "a": (U, W, G)}[self.what]
        found = [A[self.places] for A in operators]
        return Rows(*found, *[none] * (3 - len(found)))


class Evaluated:
    """Any quantity, differentiated along all motions that it depends on."""

    def __init__(self, run: Simulation, quantity: str, size: int, linear: Linear,
                 history: History):
        self.run, self.quantity, self.size = run, quantity, size
        self.linear, self.history = linear, history
        self.kept: dict[int, Rows] = {}     # of recorded states
        self._active: NDArray | None = None

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
        found = np.zeros((3 * n, self.size))
        one = Result(self.run.model, self.run.numbering, linear.system, linear.state,
                     linear.state.now[None].copy(), 0.0)
        for first in range(0, 3 * n, PIECE):
            piece = slice(first, min(first + PIECE, 3 * n))
            along = Moves(*(move[piece] for move in moves))
            pushed = np.zeros((len(along.positions), linear.state.g.size))
            found[piece] = differences(one, [self.quantity], along, pushed)[
                self.quantity].reshape(-1, self.size)
        return Rows(*(part.T for part in np.split(found, 3)))
