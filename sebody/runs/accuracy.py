"""Runs within a tolerance of the whole run: steps are refined until two runs agree."""

import warnings
from collections.abc import Callable

import numpy as np

from sebody import inputs
from sebody.assembly.numbering import placed, rotational
from sebody.engine.state import Scheme
from sebody.errors import Interrupted, LimitWarning, SimulationError
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
HOPELESS = 0.5      # two refinements must reduce the difference of runs by this factor


def simulate_within(model: Model, h: float, t_end: float, tolerance: Tolerance | None = None,
                    scheme: Scheme | None = None,
                    progress: Callable[[float], None] | bool | None = None,
                    start: Result | None = None) -> Result:
    """Run a model so that its error in time is within a tolerance; steps are chosen.

    The run is repeated with a finer local tolerance until the difference of the last two runs shows
    that the last one is good enough: errors fall with the square of the number of steps. Errors
    are root mean squares over the run, of every position and rotation. The error of the model
    itself, from too few modes or bodies, is not part of them.

    Parameters
    ----------
    h : float
        Output grid [time].
    tolerance : Tolerance
        Allowed error of the run, by default 1e-3 of the characteristic length and 1e-3 rad.
    scheme, progress, start
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
        return _refined(model, h, t_end, wanted, scheme, show, start)


def _refined(model: Model, h: float, t_end: float, wanted: Tolerance, scheme: Scheme | None,
             progress: Callable[[float], None] | None, start: Result | None) -> Result:
    """The run that is within the tolerance `wanted`, after coarser ones."""
    share, seconds = min(FIRST, COARSE / max(wanted.relative, 1e-300)), 0.0
    before: Result | None = None
    differences: list[float] = []
    while True:
        local = Tolerance(*(share * value for value in wanted))
        try:
            with warnings.catch_warnings():     # what is wrong with a coarse run need not stay
                warnings.simplefilter("ignore", LimitWarning)
                run = Simulation(model, h, scheme, tolerance=local, start=start)
                now = run.run_to(t_end, progress).result()
        except KeyboardInterrupt as stop:
            if before is None:
                raise
            before.failure = (f"{stop or 'interrupted'}; the result is that of the previous run, "
                              "with larger steps, and its error may be above the tolerance")
            raise Interrupted(before.failure, before) from stop
        seconds += now.seconds
        now.all_seconds = seconds
        if before is None:
            share, before = share / REFINED**3, now
            continue
        differences.append(difference(now, before, wanted))
        now.error = differences[-1] / max((now.steps / before.steps)**2 - 1.0, 1.0)
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
        share /= min(max(np.sqrt(now.error / AIM), LEAST), MOST)**3
        before = now


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
