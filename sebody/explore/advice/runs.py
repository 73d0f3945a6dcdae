"""Runs of a model, and what is kept of them."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from numpy.typing import NDArray

from sebody.basics.errors import LimitWarning
from sebody.explore.advice.changes import Step
from sebody.explore.advice.quantities import Quantities, Values
from sebody.model.mechanism import Mechanism
from sebody.model.model import Model
from sebody.model.numbering import Numbering
from sebody.results.recording import Recording
from sebody.results.result import Result
from sebody.runs.limits.watch import Watch
from sebody.runs.statics import equilibrium
from sebody.runs.tolerance import Tolerance
from sebody.runs.whole_runs import planned_simulation


class Run(NamedTuple):
    """A run: its quantities on its grid, the grid's step, its time and Newton iterations.

    Time and iterations include those of the run that plans variable steps.
    """

    values: Values
    h: float
    seconds: float
    iterations: float
    result: Result


class _Unwatched(Watch):
    """Runs without warnings, whose making takes as long as a short run."""

    def say(self, key: str, message: str) -> None:
        """Nothing."""

    def look(self, model: Mechanism, numbering: Numbering, rows: NDArray) -> None:
        """Nothing is compared."""

    def judge(self, run: Recording) -> None:
        """Nothing is compared."""


@dataclass
class Runs:
    """Makes runs.

    Parameters
    ----------
    quantities : Quantities
    h : float
        Step of the grid that quantities are recorded on: the given one, or a part of it.
    t_end : float
    progress : callable, optional
        Called between and during runs.
    balanced : bool
        Whether runs start from the equilibrium under the loads of t = 0.
    """

    quantities: Quantities
    h: float
    t_end: float
    progress: Callable[[float], None] | None = None
    balanced: bool = False

    def run(self, model: Model, step: Step, watched: bool = False, every: int = 0,
            frequencies: list[float] | None = None) -> Run:
        """Run a model; recorded on the grid, or on a longer step.

        Parameters
        ----------
        watched : bool
            Whether the result has the run's warnings, which take as long as a short run.
        every : int
            Steps from one record to the next, where it is not on the grid.
        frequencies : list of float, optional
            Known ones, which depend neither on the step nor on a disturbance.

        Raises
        ------
        InputError, SimulationError
            It does not run, or lacks a quantity.
        """
        end = self.t_end if not every else step.h * int(self.t_end / step.h)
        every = every or max(round(self.h / step.h), 1)
        tolerance = None if step.local is None else Tolerance(step.local)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LimitWarning)       # advice tells them
            start = equilibrium(model) if self.balanced else None
            simulation = planned_simulation(model, step.h, end, None, every, self.progress,
                                            tolerance, start)
            if not watched:
                simulation.watch = _Unwatched()
            result = simulation.run_to(end, self.progress).result()
        h = step.h * every
        seconds = result.all_seconds or result.seconds
        iterations = result.iterations_per_step * result.steps * seconds / max(result.seconds,
                                                                               1e-12)
        return Run(self.quantities.of(result, h, self.h, frequencies), h, seconds, iterations,
                   result)
