"""A few runs of a sweep at a time, here or on another machine: what is sent, and what comes back.

What a process has built it keeps: batches of one model use one ensemble.
"""

from collections.abc import Callable, Mapping
from threading import Lock
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError, SebodyError
from sebody.basics.units import parsed_units
from sebody.explore.ensembles import Ensemble, Output
from sebody.runs.schemes import generalized_alpha
from sebody.runs.statics import equilibrium
from sebody.runs.steps import check_steps

KEPT = 32               # ensembles that a process keeps
TRIED = 64              # structures that are built before the first run, to see that they can be
EQUILIBRIUM = "equilibrium"
OF_RUN = ("step", "t_end", "rho", EQUILIBRIUM)      # parameters of the run, not of the scene

_lock = Lock()
_kept: dict[tuple, tuple[Ensemble, float]] = {}


class Plan(NamedTuple):
    """Common parts of all runs of a sweep."""

    name: str                       # of this sweep: another process gets a new `build` every time
    build: Callable[..., Any]       # returns a Scene
    fixed: tuple[tuple[str, Any], ...]      # of the run and of `build`, that do not vary
    outputs: tuple[tuple[str, Output], ...]
    runs: int = 1                   # of the whole sweep: the same bits in parts of any size


class Batch(NamedTuple):
    """Some runs of one structure."""

    plan: Plan
    structure: tuple[tuple[str, Any], ...]      # arguments of `build` and of the run that vary
    parameters: dict[str, NDArray]              # of the ensemble, (runs,)
    rows: NDArray                               # numbers of the runs in the sweep


class Answer(NamedTuple):
    """Outcome of the runs of a batch."""

    rows: NDArray
    values: dict[str, NDArray]
    reached: NDArray
    failures: dict[int, str]        # by number of the run in the sweep


def run_task(batches: list[Batch]) -> list[Answer]:
    """Run some batches, one after the other, in one thread."""
    return [_run(batch) for batch in batches]


def _run(batch: Batch) -> Answer:
    """Run a batch; a model that cannot be built fails all of its runs."""
    try:
        ensemble, t_end = _ensemble(batch.plan, batch.structure)
        outcome = ensemble.part(batch.parameters, t_end, dict(batch.plan.outputs), batch.plan.runs)
    except SebodyError as error:
        count = len(batch.rows)
        return Answer(batch.rows, {}, np.full(count, np.nan),
                      {int(row): str(error) for row in batch.rows})
    return Answer(batch.rows, outcome.values, outcome.reached,
                  {int(batch.rows[k]): reason for k, reason in outcome.failures.items()})


def _ensemble(plan: Plan, structure: tuple[tuple[str, Any], ...]) -> tuple[Ensemble, float]:
    key = plan.name, structure
    with _lock:
        ensemble = _kept.pop(key, None) or _built(plan, structure)
        _kept[key] = ensemble          # the last one used is the last one given up
        while len(_kept) > KEPT:
            _kept.pop(next(iter(_kept)))
        return ensemble


def _built(plan: Plan, structure: tuple[tuple[str, Any], ...]) -> tuple[Ensemble, float]:
    given = {**dict(plan.fixed), **dict(structure)}
    of_run = {name: given.pop(name) for name in OF_RUN if name in given}
    scene = _scene(plan.build, given)
    scheme = generalized_alpha(of_run["rho"]) if "rho" in of_run else None
    h = inputs.number(of_run.get("step", scene.h), "the time step", above=0)
    t_end = inputs.number(of_run.get("t_end", scene.t_end), "t_end", least=0)
    check_steps(t_end, h)
    steps = round(t_end / h)
    start = equilibrium(scene.model) if of_run.get(EQUILIBRIUM) else None
    return Ensemble(scene.model, h, scheme, start=start), steps * h


def _scene(build: Callable[..., Any], given: Mapping[str, Any]) -> Any:
    """Scene that a function returns.

    Raises
    ------
    InputError
        It raises something, or returns no scene.
    """
    shown = ", ".join(f"{name}={inputs.shown(value)}" for name, value in given.items())
    try:
        scene = build(**given)
    except SebodyError as error:
        raise InputError(f"build({shown}): {error}") from error
    except Exception as error:          # of a user's file
        raise InputError(f"build({shown}) raised {type(error).__name__}: {error}; correct the "
                         "scene or its parameters") from error
    if not all(hasattr(scene, name) for name in ("model", "h", "t_end")):
        raise inputs.refusal(f"what build({shown}) returned", scene, "return a Scene")
    return scene


def tasks_of(plan: Plan, columns: Mapping[str, NDArray], structural: set[str], rows: NDArray,
             most: int) -> list[list[Batch]]:
    """Some rows of a design as tasks: batches of one structure each.

    Parameters
    ----------
    structural : set of str
        Parameters with which the model is built anew.
    rows : (k,)
        Numbers of the runs.
    most : int
        Runs of a task.
    """
    groups: dict[tuple, list[int]] = {}
    for row in rows:
        key = tuple((name, _plain(columns[name][row])) for name in columns if name in structural)
        groups.setdefault(key, []).append(int(row))
    tasks, room = [[]], most
    for key, members in groups.items():
        while members:
            own, members = np.array(members[:room]), members[room:]
            tasks[-1].append(Batch(plan, key, {
                name: np.asarray(values[own], dtype=float) for name, values in columns.items()
                if name not in structural}, own))
            room -= len(own)
            if not room:
                tasks.append([])
                room = most
    return [task for task in tasks if task]


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def check_plan(plan: Plan, columns: Mapping[str, NDArray], structural: set[str]
               ) -> tuple[list[str], dict[str, str]]:
    """Build the first run and check all values, so that nothing wrong is found half-way.

    Returns
    -------
    list of str
        Hashes of the models that were built: tables of other models are those of other sweeps.
    dict of str to str
        Units of outputs, of a model that has units.

    Raises
    ------
    InputError
        A scene that cannot be built, a quantity or parameter it does not have, a value it cannot
        have.
    """
    of_structure = {n: v for n, v in columns.items() if n in structural}
    first = tasks_of(plan, of_structure, structural, np.arange(1), 1)[0][0]
    ensemble, t_end = _ensemble(plan, first.structure)
    others = [_built(plan, structure) for structure in _others(of_structure, first.structure)]
    ensemble.check({name: values for name, values in columns.items() if name not in structural},
                   t_end, dict(plan.outputs))
    units = parsed_units(ensemble.model.units)
    return ([f"{one.identity} until {end!r}" for one, end in ((ensemble, t_end), *others)],
            {name: one.unit(units) for name, one in plan.outputs} if units else {})


def _others(columns: Mapping[str, NDArray], first: tuple[tuple[str, Any], ...]
            ) -> list[tuple[tuple[str, Any], ...]]:
    """Further structures to try: all of a few, else every value once beside the first ones."""
    rows = zip(*(map(_plain, values) for values in columns.values()), strict=True)
    every = list({repr(row): tuple(zip(columns, row, strict=True)) for row in rows}.values())
    if len(every) > TRIED:
        every = [tuple((n, value if n == name else old) for n, old in first)
                 for name, values in columns.items()
                 for value in {repr(v): _plain(v) for v in values}.values()]
    return [one for one in every[:TRIED] if repr(one) != repr(first)]
