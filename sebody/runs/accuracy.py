"""Runs within a tolerance of the whole run: steps are refined until runs agree."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import placed, rotational
from sebody.basics import inputs
from sebody.basics.errors import Interrupted, LimitWarning, SimulationError
from sebody.basics.progress import showing
from sebody.basics.spelling import naming_arguments
from sebody.basics.warned import warn
from sebody.engine.state import Scheme
from sebody.model.extent import extent
from sebody.model.model import Model
from sebody.results.result import Result
from sebody.runs.planning import LOGGED, Plan, planned
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance, given

FIRST = 0.3         # local tolerance of the run that plans, relative to the tolerance of the run
COARSE = 1e-3       # largest relative local tolerance of that run
REFINED = 1.6       # the second run divides the planned steps by this
LEAST, MOST = 1.5, 2.5      # bounds of that factor from one further run to the next
AIM = 0.5           # share of the tolerance that a further run aims at
SLOWEST, QUICKEST = 0.25, 4.0       # orders at which errors may fall with the number of steps
BISECTIONS = 30     # of the order that three runs show
SECOND = 1.8, 2.3   # orders that are that of the scheme
REGULAR = 1.3, 3.0  # orders of differences that fall regularly, but not with that order yet
CAUTION = 0.5       # by which an order may become less
SURE = 0.1          # share of the tolerance in which two runs are enough
HOPELESS = 0.5      # share of the last three differences that the next one must be below
RESOLVED = 30.0     # divisor of planned steps up to which runs may be too coarse to converge


@naming_arguments
def simulate_within(model: Model, h: float, t_end: float, tolerance: Tolerance | None = None,
                    scheme: Scheme | None = None,
                    progress: Callable[[float], None] | bool | None = None,
                    start: Result | None = None, threads: int = 1) -> Result:
    """Run a model so that its error in time is within a tolerance; steps are chosen.

    A first run plans the steps; further ones divide the planned steps by larger and larger numbers,
    until the differences of the last three show that the last one is good enough. All have the same
    steps but for that number, so the differences tell the order at which errors fall. Where it is
    that of the scheme, errors follow from it; where differences fall irregularly, as those of runs
    with contacts do, two runs one after the other must be good enough. Errors are root mean squares
    over the run, of every position and rotation. The error of the model itself, from too few modes
    or bodies, is not part of them.

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
        A run fails, or the error does not fall: the motion may be chaotic, or friction breaks away
        irregularly. The last run is the `result` of the exception.
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
    runs.plan()
    smooth = not any(load.tuned for load in model.loads)    # without friction and backlash
    before, divisors, differences = runs.run(1.0), [1.0, REFINED], []
    estimates: list[Estimate] = []
    while True:
        now = runs.run(divisors[-1])
        differences.append(difference(now, before, wanted))
        estimates.append(estimated(divisors[-3:], differences[-2:], smooth))
        last = estimates[-1]
        now.error, now.all_seconds = last.error, runs.seconds
        if _good_enough(estimates):
            for message in now.warnings:
                warn(message)
            return now
        if (divisors[-1] > RESOLVED and last.error > 1.0
                and differences[-1] > HOPELESS * max(differences[-4:-1])):
            raise SimulationError(
                "the error does not decrease with the step: it stays at "
                f"{differences[-1]:.3g} times the tolerance with {now.steps} steps. "
                + ("The motion may be chaotic, so that only its beginning can be computed: use a "
                   "larger tolerance or an earlier end" if smooth else
                   "When friction breaks away or teeth meet is known to the first order in the "
                   "step, and irregularly: use a larger tolerance, or an earlier end where "
                   "the motion is chaotic"), now)
        before = now
        divisors.append(divisors[-1] * min(max(np.sqrt(last.error / AIM), LEAST), MOST))


@dataclass
class _Runs:
    """Runs of a model whose steps are parts of planned ones."""

    model: Model
    h: float
    t_end: float
    wanted: Tolerance
    scheme: Scheme | None
    progress: Callable[[float], None] | None
    start: Result | None
    threads: int
    schedule: NDArray = field(default_factory=lambda: np.zeros((0, 2)))
    finest: Result | None = None
    seconds: float = 0.0

    def plan(self) -> None:
        """Make the run whose errors tell the steps of the others."""
        pilot = self._one(Plan(logged=LOGGED))
        self.schedule = planned(pilot.log.rows(), pilot.system.corners)

    def run(self, divisor: float) -> Result:
        """One run with the planned steps divided by a number."""
        return self._one(Plan(self.schedule, divisor, np.inf, stiff=True)).result()

    def _one(self, plan: Plan) -> Simulation:
        """A run; what is wrong with a coarse one need not stay, so it does not warn."""
        share = min(FIRST, COARSE / max(self.wanted.relative, 1e-300))
        local = Tolerance(*(share * value for value in self.wanted))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", LimitWarning)
                one = Simulation(self.model, self.h, self.scheme, tolerance=local,
                                 start=self.start, threads=self.threads, plan=plan)
                one.run_to(self.t_end, self.progress)
                result = one.result()
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
        return one


class Estimate(NamedTuple):
    """Error of a run relative to the allowed one."""

    error: float
    most: float             # the same with caution
    regular: bool = False   # differences of runs fall as those of errors of one order do
    second: bool = False    # of the order of the scheme


def estimated(divisors: Sequence[float], differences: Sequence[float], smooth: bool = True
              ) -> Estimate:
    """The error of the last of three runs, from differences of each run from the one before.

    Errors ``c k^-p`` of runs with steps h/k have differences whose ratio tells p. Of two runs, of
    differences that do not fall so, and of motions that are not smooth, because of friction, the
    error is taken to fall with the number of steps, and to be no less than the last difference.
    """
    k, last = np.array(divisors) / divisors[-1], float(differences[-1])
    cautious = max(_falling(last, k[-2], 1.0), last)
    if len(differences) < 2 or not smooth:
        return Estimate(cautious, cautious)
    low, high = SLOWEST, QUICKEST
    for _ in range(BISECTIONS):
        order = (low + high) / 2.0
        errors = k**-order
        slower = differences[0] * (errors[1] - errors[2]) < last * (errors[0] - errors[1])
        low, high = (low, order) if slower else (order, high)
    if not REGULAR[0] < low < REGULAR[1]:
        return Estimate(cautious, cautious)
    most = _falling(last, k[1], max(1.0, min(low, 2.0) - CAUTION))
    if SECOND[0] < low < SECOND[1]:
        return Estimate(_falling(last, k[1], 2.0), most, True, True)
    return Estimate(most, most, True)


def _falling(change: float, coarser: float, order: float) -> float:
    """Error of a run by its difference from one with a smaller divisor, relative to its own."""
    return float(change / (coarser**-order - 1.0))


def _good_enough(estimates: Sequence[Estimate]) -> bool:
    """Tell whether the last run is within the tolerance.

    Three runs that are too coarse may fall with the order of the scheme by chance: that counts for
    sure only with the run before them.
    """
    last = estimates[-1]
    if len(estimates) < 2:
        return last.error <= SURE
    if not last.regular:
        return max(one.error for one in estimates[-2:]) <= 1.0
    return (last.error if last.second and estimates[-2].second else last.most) <= 1.0


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
