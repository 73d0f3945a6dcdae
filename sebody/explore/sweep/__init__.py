"""Sweeps: many runs of a scene over lists and distributions of its parameters.

    texts -> axes -> design -> batches -> threads or cluster -> table -> files, indices, picture
"""

import json
import time
from collections.abc import Callable, Hashable, Mapping
from inspect import signature
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target
from sebody.basics.progress import showing
from sebody.basics.spelling import unknown
from sebody.explore.ensembles import Output
from sebody.explore.ensembles.work import processors
from sebody.explore.sweep import executors as places, sobol
from sebody.explore.sweep.batches import EQUILIBRIUM, OF_RUN, Plan, check_plan, tasks_of
from sebody.explore.sweep.design import Design, design
from sebody.explore.sweep.table import Table
from sebody.explore.sweep.variations import Distribution
from sebody.parameters.table import GRAVITY

BATCH = 100             # runs of a task
SAVED = 5.0             # seconds between two savings of the table


def sweep(build: Callable[..., Any], outputs: Mapping[str, Output],
          listed: Mapping[str, list] | None = None,
          sampled: Mapping[str, Distribution] | None = None, runs: int | None = None,
          seed: int = 0, sampler: str = "lhs", sobol_n: int | None = None,
          fixed: Mapping[str, Any] | None = None, output: str | Path | None = None,
          threads: int | None = None, cluster: str | None = None, workers: int | None = None,
          progress: Callable[[float], None] | bool | None = None) -> Table:
    """Run a scene for all combinations of listed values, each with all sampled sets.

    Parameters are ``step``, ``t_end``, ``rho``, ``equilibrium`` (true where runs start from that of
    their model), arguments of `build`, with which the model is built anew, and all that `Ensemble`
    can vary by name, with which it is not. With equilibria there are only the former.

    Parameters
    ----------
    build : callable
        Returns a `Scene`.
    outputs : mapping
        What is kept of a run: what `maximum`, `final` and the like return.
    listed : mapping
        Values by name.
    sampled : mapping
        Distributions by name.
    runs : int
        Number of sampled sets.
    sobol_n : int, optional
        In place of `runs`: the design of Sobol's indices, with this base number.
    fixed : mapping
        What does not vary: ``step``, ``t_end``, ``rho``, ``equilibrium`` and further arguments of
        `build`.
    output : path, optional
        File of the table, from which an interrupted sweep continues.
    threads : int
        By default one for each processor.
    cluster : str
        Address of a scheduler of Dask.
    workers : int
        Processes of this machine in place of threads.

    Raises
    ------
    InputError
        Before the first run: unknown names, values that cannot be had, a table of another sweep.
    """
    listed, sampled, fixed = _checked(build, outputs, listed, sampled, fixed)
    made = (sobol.saltelli(sampled, sobol_n, seed) if sobol_n is not None
            else design(listed, sampled, runs, seed, sampler))
    if sobol_n is not None and listed:
        raise InputError("--sobol compares sampled parameters: leave out --vary")
    if not made.columns:
        raise InputError("nothing varies: give --vary NAME=VALUES or --sample NAME=DISTRIBUTION")
    if both := sorted(set(fixed) & set(made.columns)):
        raise InputError(f"{both[0]} varies and is set to {fixed[both[0]]}: leave out one of them")
    plan = Plan(uuid4().hex, build, tuple(fixed.items()), tuple(outputs.items()), made.runs)
    own = *OF_RUN, *signature(build).parameters
    structural = set(made.columns) & set(own)
    for name in made.columns:       # other parameters are <owner>.<name>, but for gravity
        if "." not in name and name not in (*own, GRAVITY):
            raise unknown("parameter", name, (*own, GRAVITY), "a sweep of this scene has")
    if EQUILIBRIUM in (*fixed, *made.columns) and (others := set(made.columns) - structural):
        raise InputError(f"{min(others)} cannot vary where runs start from equilibrium: each of "
                         "its values has another one; make it an argument of build, with which the "
                         "model is built anew")
    models, units = check_plan(plan, made.columns, structural)
    path = None if output is None else check_target(output, "table", (".npz",))
    table = _begun(path, _text(build, fixed, outputs, made, models), made)
    table.units = units
    left = np.flatnonzero(~table.done)
    where = (places.cluster(cluster, workers) if cluster is not None or workers is not None else
             places.threads(processors() if threads is None else
                            inputs.integer(threads, "threads", least=1)))
    saved = time.monotonic()
    try:
        with showing(progress, None) as show, where as run:
            for answer in run(iter(tasks_of(plan, made.columns, structural, left, BATCH))):
                table.take(answer)
                if show:
                    show(table.done.mean())
                if path and time.monotonic() - saved > SAVED:
                    table.save(path)
                    saved = time.monotonic()
    finally:
        if path:
            table.save(path)
    return table


def _checked(build: Callable[..., Any], outputs: Mapping[str, Output],
             *given: Mapping[str, Any] | None) -> list[dict[str, Any]]:
    """Listed, sampled and fixed values as dicts of names.

    Raises
    ------
    InputError
        Something else, values that are no list or of which one is there twice.
    """
    inputs.function(build, "build", "give a function that returns a Scene")
    inputs.mapping(outputs, "outputs", "give a dict of names and what maximum(...) and the like "
                   "return")
    checked = [inputs.mapping({} if one is None else one, what, "give a dict of values by name")
               for one, what in zip(given, ("listed", "sampled", "fixed"), strict=True)]
    for one in checked:
        for name in one:
            inputs.name(name, "name of a parameter")
    for name, values in checked[0].items():
        checked[0][name] = inputs.items(values, f"values of {name}", "give a list")
        if not checked[0][name]:
            raise inputs.refusal(f"values of {name}", values, "give one at least")
        for value in checked[0][name]:
            if not isinstance(value, Hashable):
                raise inputs.refusal(f"a value of {name}", value, "give a number or a text")
        if twice := first_twice(checked[0][name]):
            raise InputError(f"{name} has the value {inputs.shown(twice[0])} twice: give it once")
    for name, one in checked[1].items():
        inputs.instance(one, f"distribution of {name}", Distribution, "give what "
                        "sebody.explore.sweep.variations.distribution returns")
    return checked


def first_twice(values: list) -> tuple | None:
    """The first value that occurs again, if there is one; values may be of any kind."""
    seen = set()
    for value in values:
        if (type(value), repr(value)) in seen:
            return (value,)
        seen.add((type(value), repr(value)))
    return None


def _begun(path: Path | None, text: str, made: Design) -> Table:
    """The table that is there already, or an empty one."""
    if path is not None and path.exists():
        table = Table.load(path)
        if table.design != text or not table.has(made.columns):
            raise InputError(f"{path} is the table of another sweep, with other scenes, models, "
                             "parameters or outputs, or of another version of sebody: give "
                             "another --output, or remove it")
        return table
    return Table.empty(text, dict(made.columns), made.runs)


def _text(build: Callable, fixed: Mapping[str, Any], outputs: Mapping[str, Output],
          made: Design, models: list[str]) -> str:
    """Key of equal sweeps: also the models, whatever file they are from."""
    return json.dumps([getattr(build, "__module__", ""), getattr(build, "__qualname__", ""),
                       sorted((n, str(v)) for n, v in fixed.items()),
                       [(n, str(o)) for n, o in outputs.items()], made.text(), models])


__all__ = ["Distribution", "Table", "sweep"]
