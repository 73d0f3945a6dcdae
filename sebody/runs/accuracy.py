"""Runs within a tolerance of the whole run: steps are refined until two runs agree."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sebody.assembly.numbering import placed, rotational
from sebody.basics import inputs
from sebody.basics.errors import Interrupted, LimitWarning, SimulationError
from sebody.engine.state import Scheme
from sebody.model.extent import extent
from sebody.model.model import Model
from sebody.results.result import Result
from sebody.runs.progress import showing
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance, given

FIRST = 0.3         # local tolerance of the first run, relative to the tolerance of the run
COARSE = 1e-3       # largest relative local tolerance of the first run
REFINED = 3.0       # the second run takes so many times the steps of the first
LEAST, MOST = 1.5, 6.0      # bounds of that factor for further runs
AIM = 0.5           # share of the tolerance that a further run aims at
SLOWEST, QUICKEST = 0.25, 2.0       # orders at which errors may fall with the number of steps
BISECTIONS = 20     # of the order that three runs show
HOPELESS = 0.5      # two refinements must reduce the difference of runs by this factor


def simulate_within(model: Model, h: float, t_end: float, tolerance: Tolerance | None = None,
                    scheme: Scheme | None = None,
                    progress: Callable[[float], None] | bool | None = None,
                    start: Result | None = None, threads: int = 1) -> Result:
    """Run a model so that its error in time is within a tolerance; steps are chosen.

    The run is repeated with a finer local tolerance until the difference of the last two runs shows
    that the last one is good enough: errors fall with the square of the number of steps. Where
    only that makes it good enough, and not a fall with the number itself, a third run in between
    shows how they fall: vibrations that steps do not resolve converge slowly. Errors are root mean
    squares over the run, of every position and rotation. The error of the model itself, from too
    few modes or bodies, is not part of them.

    Parameters
    ----------
    h : float
        Output grid [time].
    tolerance : Tolerance
        Allowed error of the run, by default 1e-3 of the characteristic length and 1e-3 rad.
    scheme, progress, start, threads
        As for `Simulation` and its `run_to`; a bar counts the runs.

    Returns
    -------
    Result
        The last run, with its estimated `error`, relative to the allowed one, and `all_seconds`.

    Raises
    ------
    SimulationError
        A run fails, or the error does not fall: the motion may be chaotic. The last run is the
        `result` of the exception.
    Interrupted
        Ctrl-C; the last whole run is the `result`, or what there is of the first one.
    """
    inputs.instance(model, "model", Model, "give a sebody.Model")
    wanted = given(tolerance) or Tolerance()
    wanted.check_reachable(extent(model))
    with showing(progress, t_end) as show:
        return _refined(model, h, t_end, wanted, scheme, show, start, threads)


def _refined(model: Model, h: float, t_end: float, wanted: Tolerance, scheme: Scheme | None,
             progress: Callable[[float], None] | None, start: Result | None,
             threads: int) -> Result:
    """The run that is within the tolerance `wanted`, after coarser ones."""
    runs = _Runs(model, h, t_end, wanted, scheme, progress, start, threads)
    coarse = min(FIRST, COARSE / max(wanted.relative, 1e-300))
    before, share = runs.run(coarse), coarse / REFINED**3
    differences: list[float] = []
    while True:
        now = runs.run(share)
        differences.append(difference(now, before, wanted))
        now.error, most = _falling(differences[-1], before, now, 2), MOST
        if now.error <= 1.0 < (slowly := _falling(differences[-1], before, now, 1)):
            between = runs.run(np.sqrt(share * coarse))
            now.error, most = error_by_three(before, between, now, wanted), REFINED
        elif now.error <= 1.0:
            now.error = slowly
        now.all_seconds = runs.seconds
        if now.error <= 1.0:
            for message in now.warnings:
                warnings.warn(message, LimitWarning, stacklevel=3)
            return now
        if len(differences) > 2 and differences[-1] > HOPELESS * differences[-3]:
            raise SimulationError(
                "the error does not decrease with the step: it stays at "
                f"{differences[-1]:.3g} times the tolerance with {now.steps} steps. The motion may "
                "be chaotic, so that only its beginning can be computed: use a larger tolerance "
                "or an earlier end", now)
        before, coarse = now, share
        share /= min(max(np.sqrt(now.error / AIM), LEAST), most)**3


@dataclass
class _Runs:
    """Runs of a model with local tolerances that are shares of the wanted one."""

    model: Model
    h: float
    t_end: float
    wanted: Tolerance
    scheme: Scheme | None
    progress: Callable[[float], None] | None
    start: Result | None
    threads: int
    finest: Result | None = None
    seconds: float = 0.0

    def run(self, share: float) -> Result:
        """One run; what is wrong with a coarse one need not stay, so it does not warn."""
        local = Tolerance(*(share * value for value in self.wanted))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LimitWarning)
                one = Simulation(self.model, self.h, self.scheme, tolerance=local,
                                 start=self.start, threads=self.threads)
                result = one.run_to(self.t_end, self.progress).result()
        except KeyboardInterrupt as stop:
            if self.finest is None:
                raise
            last = self.finest
            last.failure = (f"{stop or 'interrupted'}; the result is that of the previous run, "
                            "with larger steps, and its error may be above the tolerance")
            raise Interrupted(last.failure, last) from stop
        self.seconds += result.seconds
        if self.finest is None or result.steps > self.finest.steps:
            self.finest = result
        return result


def _falling(change: float, coarse: Result, fine: Result, order: int) -> float:
    """Error of a run by its difference from a coarser one, if errors fall with that order."""
    return change / max((fine.steps / coarse.steps)**order - 1.0, LEAST - 1.0)


def error_by_three(coarse: Result, between: Result, fine: Result, allowed: Tolerance) -> float:
    """Error of the last of three runs, relative to the allowed one, at the order they show.

    Errors ``c n^-p`` of runs with n steps have differences whose ratio tells p.
    """
    first, last = difference(between, coarse, allowed), difference(fine, between, allowed)
    steps = np.array([coarse.steps, between.steps, fine.steps]) / fine.steps
    low, high = SLOWEST, QUICKEST
    for _ in range(BISECTIONS):
        order = (low + high) / 2.0
        errors = steps**-order
        slower = first * (errors[1] - errors[2]) < last * (errors[0] - errors[1])
        low, high = (low, order) if slower else (order, high)
    return float(last / max(steps[1]**-low - 1.0, 1e-3))


def difference(one: Result, other: Result, allowed: Tolerance) -> float:
    """Largest root mean square difference of two runs on one grid, relative to the allowed one."""
    moving, rotations = placed(one.model, one.numbering), rotational(one.model, one.numbering)
    if not one.model.planar:
        moving &= ~rotations       # these are compared by their matrices
    q = (one.recorded("q") - other.recorded("q"))[:, moving]
    errors = np.sqrt((q**2).mean(axis=0)) / allowed.allowed(one.arrays_of_loop[0].magnitude[moving],
                                                            rotations[moving])
    R = one.recorded("R") - other.recorded("R")
    angles = np.sqrt((R**2).reshape(len(R), -1, 9).sum(axis=2).mean(axis=0) / 2.0)
    errors = np.append(errors, angles / allowed.allowed(1.0, True))
    return float(errors.max(initial=0.0))
