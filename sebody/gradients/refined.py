"""Recursions over stretches of steps by products, and the inverses that these ask for."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.engine.state import Scheme
from sebody.gradients.backward_steps import backward
from sebody.gradients.coefficients import Coefficients
from sebody.gradients.factors import REDUNDANT, Scales
from sebody.gradients.forward_steps import forward
from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.gradients.products import Products
from sebody.gradients.recursion import FRESH, GUESSES, INVERSES, SPENT, Columns, put
from sebody.gradients.step_equation import DONE, FAILED, invert_now, matrix

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
        self.scheme = scheme
        self.back, self.redundant, n = back, redundant, linear.free
        # weights of the states of laws are small beside others, and their errors grow
        roughly = scheme.tolerance > FINE and products.address.all()
        self.columns = Columns.of(columns, n, products.kept.shape[1], places,
                                  scheme.tolerance if roughly else ROUNDING)
        self.numbers = (scheme.alpha_m, scheme.alpha_f, scheme.beta, scheme.gamma,
                        history.duration)
        self.scales: dict[float, Scales] = {}
        self.missing: dict[float, NDArray] = {}
        self.next = -1          # event that follows those that were passed

    def begin(self, motion: Sequence[NDArray]) -> None:
        """Columns as of `sweeps.Motion`."""
        for own, given in zip(self._carried, motion, strict=True):
            own[:] = given.T

    @property
    def motion(self) -> list[NDArray]:
        """Columns as of `begin`."""
        return [own.T.copy() for own in self._carried]

    @property
    def _carried(self) -> list[NDArray]:
        columns = self.columns
        return [*columns.motion, columns.kept, columns.before, columns.turned]

    def over(self, first: int, last: int, *arrays: NDArray) -> None:
        """All steps from one event to another: (events, ...) arrays of `backward`, `forward`.

        Raises
        ------
        InputError
            A state without derivatives, or a step that cannot be solved.
        """
        if (last if self.back else first) != self.next:     # no step before is a guide
            self.columns.counts[GUESSES] = 0
            self.columns.last[:] = self.columns.rights[:] = 0.0
        self.next = first - 1 if self.back else last + 1
        found, piece = self.history, slice(first, last + 1)
        of_events = [getattr(found, name)[piece] for name in ("rows", "steps", "offsets", "ends",
                                                              "besides")]
        sweep = backward if self.back else forward
        read, written = (2, 2) if self.back else (1, 1)
        begin, end = 0, last - first
        while True:
            at = sweep(self.linear.system, self.linear.state, self.products, self.columns,
                       *of_events, *arrays[:read], self.numbers, begin, end,
                       *arrays[read:read + written])
            if at == DONE:
                return
            if at == FAILED:
                raise InputError("the linearized equations of a step cannot be solved, so the run "
                                 "has no gradient: its constraints may be singular there")
            self._invert(first + at)
            begin, end = (begin, at) if self.back else (at, end)

    def _invert(self, event: int) -> None:
        """The inverse of the matrix of a step, or of its transpose."""
        found, columns, h = self.history, self.columns, float(self.history.steps[event])
        made = self.linear.system, self.linear.state, self.products, columns
        if put(*made, found.rows[event], found.ends[event], found.besides[event]):
            raise InputError(f"the state at t = {found.ends[event]:.6g} has no derivatives")
        c = Coefficients.of(self.scheme, h)
        numbers = c.cm, c.cd, self.back
        if h not in self.scales:
            matrix(*made, *numbers, columns.inverse)
            self.scales[h] = scales = Scales(columns.inverse)
            if self.redundant:
                self.missing[h] = _missing(scales.rows[:, None] * columns.inverse * scales.columns)
        columns.rows[:], columns.scale[:] = self.scales[h].rows, 1.0 / self.scales[h].columns
        columns.added[:] = self.missing.get(h, 0.0)
        if not invert_now(*made, *numbers):
            raise InputError(f"the matrix of the step to t = {found.ends[event]:.6g} is singular, "
                             "so the run has no gradient there")
        columns.length[0] = h
        counts = columns.counts
        counts[INVERSES] += 1
        counts[SPENT], counts[FRESH] = 0, 1
        columns.pace[0] = 0.0


def _missing(A: NDArray) -> NDArray:
    """Addend that makes the singular matrix of redundant constraints regular, and solutions least.

    Its null vectors times those of its transpose: solutions have no part along the former, if the
    right side has none along the latter. They are good enough for later steps, too.
    """
    U, sizes, V = np.linalg.svd(A)
    null = sizes <= REDUNDANT * sizes[0]
    return U[:, null] @ V[null]
