"""Runs of which the end is known: planned steps, and parts that let go and lock."""

import warnings
from collections.abc import Callable

from sebody.basics.errors import LimitWarning, SimulationError
from sebody.basics.progress import showing
from sebody.basics.spelling import naming_arguments
from sebody.engine.state import Scheme
from sebody.model.model import Model
from sebody.results.result import Result
from sebody.runs.phased_simulation import PhasedSimulation
from sebody.runs.planning import LOGGED, Plan, planned
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance, given

COARSER = 30.0          # tolerance of the run that plans steps, relative to that of the run
COARSEST = 1e-2         # largest relative tolerance of that run, unless the run's own is larger


@naming_arguments
def simulate(model: Model, h: float, t_end: float, scheme: Scheme | None = None,
             output_every: int = 1, progress: Callable[[float], None] | bool | None = None,
             tolerance: Tolerance | None = None, start: Result | None = None,
             threads: int = 1) -> Result:
    """Run a model from 0 to `t_end`; see `Simulation` for the arguments and exceptions.

    With a tolerance, steps are planned for the whole run by a coarser one that comes first, so that
    they change as little as its errors allow: the energy of conservative motion drifts where steps
    change with its phase, as those of a `Simulation` do, which does not know its end. A progress
    bar counts the two runs.
    """
    with showing(progress, t_end) as show:
        if isinstance(model, Model) and model.switches:
            phased = PhasedSimulation(model, h, scheme, output_every, tolerance, start, threads)
            return phased.run_to(t_end, show).result()
        run = planned_simulation(model, h, t_end, scheme, output_every, show, tolerance, start,
                                 threads)
        return run.run_to(t_end, show).result()


def planned_simulation(model: Model, h: float, t_end: float, scheme: Scheme | None = None,
                       output_every: int = 1, progress: Callable[[float], None] | None = None,
                       tolerance: Tolerance | None = None, start: Result | None = None,
                       threads: int = 1) -> Simulation:
    """The simulation that `simulate` runs to `t_end`: with a tolerance, its steps are planned.

    If the run with a larger tolerance fails, errors choose the steps one by one.
    """
    plan = Plan()
    if (asked := given(tolerance)) is not None:
        coarser = max(1.0, min(COARSER, COARSEST / max(asked.relative, 1e-300)))
        local = Tolerance(*(coarser * value for value in asked))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LimitWarning)       # what is wrong there need not stay
            pilot = Simulation(model, h, scheme, 1, local, start, threads, Plan(logged=LOGGED))
            try:
                pilot.run_to(t_end, progress)
                schedule = planned(pilot.log.rows(), pilot.system.corners, coarser)
                plan = Plan(schedule, seconds=pilot.seconds)
            except SimulationError:
                plan = Plan(seconds=pilot.seconds)
    return Simulation(model, h, scheme, output_every, tolerance, start, threads, plan)
