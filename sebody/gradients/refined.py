"""Recursions over stretches of steps by products, and the inverses that these ask for."""

import numpy as np
from numpy.typing import NDArray

from sebody.engine.state import Scheme
from sebody.errors import InputError
from sebody.gradients import steps
from sebody.gradients.factors import REDUNDANT, Scales
from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.gradients.products import Products

FINEST = 1e-13          # corrections of solutions, relative: rounding of products


class Refined:
    """Steps of a history, forth or back, of columns that are m at a time.

    Parameters
    ----------
    linear : Linear
    products : Products
    scheme : Scheme
    history : History
    columns : int
    back : bool
    places : (r,)
        First coordinate of each rotation that is solved for.
    redundant : bool
        Whether the matrix is singular.
    """

    def __init__(self, linear: Linear, products: Products, scheme: Scheme, history: History,
                 columns: int, back: bool, places: NDArray, redundant: bool):
        self.linear, self.products, self.history = linear, products, history
        self.back, self.redundant, n = back, redundant, linear.free
        self.columns = steps.Columns.of(columns, n, places, max(scheme.tolerance, FINEST))
        self.numbers = (scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma,
                        float(history.ends[-1]))
        self.scales: dict[float, Scales] = {}
        self.whole = np.zeros((n, n))

    def begin(self, motion: tuple[NDArray, ...]) -> None:
        """Columns (n, m) of motion, rates, second and auxiliary rates; what was before is no guide.
        """
        for own, given in zip(self.columns.motion, motion, strict=True):
            own[:] = given.T
        self.columns.counts[steps.GUESSES] = 0
        self.columns.last[:] = 0.0

    @property
    def motion(self) -> list[NDArray]:
        """Columns as of `begin`."""
        return [own.T.copy() for own in self.columns.motion]

    def over(self, first: int, last: int, *arrays: NDArray) -> None:
        """All steps from one event to another: (events, ...) arrays of `steps.backward`, `forward`.

        Raises
        ------
        InputError
            A state without derivatives, or a step that cannot be solved.
        """
        found, piece = self.history, slice(first, last + 1)
        of_events = [getattr(found, name)[piece] for name in ("rows", "steps", "offsets", "ends",
                                                              "besides")]
        sweep = steps.backward if self.back else steps.forward
        read, written = (2, 2) if self.back else (1, 1)
        begin, end = 0, last - first
        while True:
            at = sweep(self.linear.system, self.linear.state, self.products, self.columns,
                       *of_events, *arrays[:read], self.numbers, begin, end,
                       *arrays[read:read + written])
            if at == steps.DONE:
                return
            if at == steps.FAILED:
                raise InputError("the linearized equations of a step cannot be solved, so the run "
                                 "has no gradient: its constraints may be singular there")
            self._invert(first + at)
            begin, end = (begin, at) if self.back else (at, end)

    def _invert(self, event: int) -> None:
        """The inverse of the matrix of a step."""
        found, columns, h = self.history, self.columns, float(self.history.steps[event])
        am, af, b, g, _ = self.numbers
        if steps.put(self.linear.system, self.linear.state, self.products, columns,
                     found.rows[event], found.ends[event], found.besides[event]):
            raise InputError(f"the state at t = {found.ends[event]:.6g} has no derivatives")
        steps.matrix(self.linear.system, self.linear.state, self.products, columns,
                     (1 - am) / ((1 - af) * b * h**2), g / (b * h), self.back, self.whole)
        if h not in self.scales:
            self.scales[h] = Scales(self.whole)
        rows, of_columns = self.scales[h].rows, self.scales[h].columns
        scaled = rows[:, None] * self.whole * of_columns
        invert = np.linalg.inv if not self.redundant else _least
        columns.inverse[:] = of_columns[:, None] * invert(scaled) * rows
        columns.scale[:] = 1.0 / of_columns
        columns.length[0] = h
        counts = columns.counts
        counts[steps.INVERSES] += 1
        counts[steps.SPENT], counts[steps.FRESH] = 0, 1


def _least(A: NDArray) -> NDArray:
    """Of least solutions where constraints are redundant."""
    return np.linalg.pinv(A, rcond=REDUNDANT)
