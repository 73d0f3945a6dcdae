"""Advice on how much of a model some quantities need: see the page beside this file."""

from collections.abc import Callable, Iterable

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.progress import showing
from sebody.explore.advice.first_runs import run_first
from sebody.explore.advice.limits import include, refusal
from sebody.explore.advice.measures import absolute
from sebody.explore.advice.outcome import Advice, Reason, Trial, Unreached
from sebody.explore.advice.quantities import Quantities
from sebody.explore.advice.report import conclusion
from sebody.explore.advice.runner import Laboratory
from sebody.explore.advice.runs import Runs
from sebody.explore.advice.search import Search
from sebody.model.model import Model
from sebody.runs.steps import check_steps

STEPS = 128         # of a run whose step is not given

__all__ = ["Advice", "Reason", "Trial", "advise"]


def advise(model: Model, h: float | None, t_end: float, quantities: str | Iterable[str],
           tolerance: float | str = 1e-3, budget: float = 20.0,
           progress: Callable[[float], None] | bool | None = None,
           start: str | None = None) -> Advice:
    """Find the cheapest model that keeps some quantities within a tolerance.

    Parameters
    ----------
    model : Model
        Any that has the parts; beams of `Model.beam` are divided anew for the reference model.
    h : float or None
        A usual time step [time]; the reference has a quarter of it, or less where loads or the
        tolerance need it. None for a first guess of a 128th of the time.
    t_end : float
        End of the runs, a whole number of steps [time].
    quantities : str or iterable of str
        Names as results have them, with ``peak``, ``rms``, ``final`` or ``< 50 Hz`` behind them
        unless the whole history is compared, or ``frequency 1`` and so on, about the equilibrium at
        the start or the steady rotation. The error of a quantity is its largest difference,
        relative to its largest change
        from the start; that of a frequency is relative to it.
    tolerance : float or str
        Largest error, relative; with a unit, as ``"2mm"``, absolute. Models without units are taken
        to be in metres, newtons and seconds.
    budget : float
        No further run is begun once the runs have taken so many times the time of the reference.
    progress : callable or bool, optional
        As of `Simulation.run_to`; the bar begins anew with each run.
    start : str, optional
        ``"equilibrium"`` for runs that start in equilibrium under gravity and the loads of t = 0.

    Returns
    -------
    Advice
        Also after Ctrl-C, with the best until then, once there is a reference.

    Raises
    ------
    InputError
        Quantities that do not exist or do not change, or a tolerance that the reference model does
        not reach: then `advice` of the exception is the best that was found.
    SimulationError
        The reference model does not run, or its error does not fall with the step.
    """
    inputs.instance(model, "model", Model, "give a sebody.Model")
    wanted = Quantities(quantities)
    t_end = inputs.number(t_end, "t_end", above=0)
    h = t_end / STEPS if h is None else inputs.number(h, "h", above=0)
    check_steps(t_end, h)
    if not np.isclose(t_end / h, round(t_end / h), rtol=1e-9, atol=0):
        raise InputError(f"t_end is {t_end:g}, {t_end / h:.6g} steps of {h:g}: give a whole number "
                         "of steps")
    limit, own = absolute(tolerance, str(model.units or "")) if isinstance(tolerance, str) else (
        tolerance, False)
    limit = inputs.number(limit, "tolerance", above=0, **({} if own else {"below": 1}))
    if own and wanted.numbers:
        raise InputError(f"tolerance is {tolerance!r}: tolerances of frequencies are relative; "
                         "give a number without a unit")
    if start not in (None, "equilibrium"):
        raise inputs.refusal("start", start, "give 'equilibrium' or nothing")
    budget = inputs.number(budget, "budget", above=0)
    wanted.check(model, h)
    with showing(progress, t_end) as show:
        lab = Laboratory(model, wanted, Runs(wanted, h, t_end, show, start is not None),
                         limit, limit if own else None)
        run_first(lab)
        include(lab)
        search = Search(lab, budget)
        try:
            found, given = search.go(), lab.given()
            outcome = search.better(found)
        except KeyboardInterrupt:
            return conclusion(search, search.best(), interrupted=True)
    advice = conclusion(search, outcome, given)
    if reason := refusal(search, outcome):
        raise Unreached(reason, advice)
    return advice
