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

FINE = 1e-12            # tolerance of runs whose steps are refined to rounding
ROUNDING = 1e-15


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
        self.columns = steps.Columns.of(
            columns, n, places, scheme.tolerance if scheme.tolerance > FINE else ROUNDING)
        self.numbers = (scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma,
                        history.duration)
        self.scales: dict[float, Scales] = {}
        self.missing: dict[float, NDArray] = {}
        self.next = -1          # event that follows those that were passed

    def begin(self, motion: tuple[NDArray, ...]) -> None:
        """Columns (n, m) of motion, rates, second and auxiliary rates."""
        for own, given in zip(self.columns.motion, motion, strict=True):
            own[:] = given.T

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
        if (last if self.back else first) != self.next:     # no step before is a guide
            self.columns.counts[steps.GUESSES] = 0
            self.columns.last[:] = self.columns.rights[:] = 0.0
        self.next = first - 1 if self.back else last + 1
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
        """The inverse of the matrix of a step, or of its transpose."""
        found, columns, h = self.history, self.columns, float(self.history.steps[event])
        am, af, b, g, _ = self.numbers
        made = self.linear.system, self.linear.state, self.products, columns
        if steps.put(*made, found.rows[event], found.ends[event], found.besides[event]):
            raise InputError(f"the state at t = {found.ends[event]:.6g} has no derivatives")
        numbers = (1 - am) / ((1 - af) * b * h**2), g / (b * h), self.back
        if h not in self.scales:
            steps.matrix(*made, *numbers, columns.inverse)
            self.scales[h] = scales = Scales(columns.inverse)
            if self.redundant:
                self.missing[h] = _missing(scales.rows[:, None] * columns.inverse * scales.columns)
        columns.rows[:], columns.scale[:] = self.scales[h].rows, 1.0 / self.scales[h].columns
        columns.added[:] = self.missing.get(h, 0.0)
        if not steps.invert_now(*made, *numbers):
            raise InputError(f"the matrix of the step to t = {found.ends[event]:.6g} is singular, "
                             "so the run has no gradient there")
        columns.length[0] = h
        counts = columns.counts
        counts[steps.INVERSES] += 1
        counts[steps.SPENT], counts[steps.FRESH] = 0, 1
        columns.pace[0] = 0.0


def _missing(A: NDArray) -> NDArray:
    """What makes the singular matrix of redundant constraints regular, and solutions nearly least.

    Its null vectors times those of its transpose: solutions have no part along the former, if the
    right side has none along the latter. They are good enough for later steps, too.
    """
    U, sizes, V = np.linalg.svd(A)
    null = sizes <= REDUNDANT * sizes[0]
    return U[:, null] @ V[null]
