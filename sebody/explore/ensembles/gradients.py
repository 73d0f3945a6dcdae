"""Gradients of many runs of one model with different numbers, in threads."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from threading import Event, Lock, Thread
from typing import Literal, cast
from warnings import catch_warnings, simplefilter

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError, LimitWarning, SimulationError
from sebody.basics.progress import showing
from sebody.basics.warned import warn
from sebody.engine.state import Scheme
from sebody.explore.ensembles.ensemble import Values
from sebody.explore.ensembles.work import INTERRUPTED, LOOK, processors
from sebody.gradients.gradient import CHAOTIC, MODES, Gradient, differentiate, fitting
from sebody.gradients.objectives import Objectives, checked, labels_of
from sebody.gradients.parameters import Parameter, columns_of
from sebody.gradients.point import Point
from sebody.gradients.products import Products
from sebody.gradients.support import refuse_model, refuse_run
from sebody.model.model import Model
from sebody.model.variants.copying import copied
from sebody.parameters.table import checked_values
from sebody.runs.failures import KEPT
from sebody.runs.outputs import Output, forms
from sebody.runs.simulation import Simulation
from sebody.runs.steps import whole_steps
from sebody.runs.tolerance import Tolerance, given as given_tolerance


@dataclass(eq=False)
class Gradients:
    """Values of objectives and their derivatives, of many runs.

    Attributes
    ----------
    value : (r, m)
        Of the objectives in r runs, as of `Gradient`; NaN of runs that failed.
    matrix : (r, m, p)
        Derivatives by the numbers of the parameters, about the values that each run has.
    rows, columns : tuple of str
        What these are of.
    growth : (r,)
        As of `Gradient`.
    failures : dict
        Reason by number of the run, of those that failed.
    interrupted : bool
        Whether Ctrl-C ended it; the runs that were not done are among the failures.
    seconds : float
        Of all runs together.
    """

    value: NDArray
    matrix: NDArray
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    growth: NDArray
    failures: dict[int, str] = field(default_factory=dict)
    interrupted: bool = False
    seconds: float = 0.0

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" * bool(self.failures)
        return (f"<Gradients of {len(self.rows)} values by {len(self.columns)} numbers in "
                f"{len(self.value)} runs{failed}>")

    def __getitem__(self, run: int) -> Gradient:
        """Gradient of a run.

        Raises
        ------
        InputError
            It failed.
        """
        run = inputs.integer(run, "run", least=0)
        if run >= len(self.value):
            raise InputError(f"run is {run}: there are {len(self.value)}, counted from 0")
        if run in self.failures:
            raise InputError(f"run {run} has no gradient: {self.failures[run]}")
        return Gradient(self.value[run], self.matrix[run], self.rows, self.columns,
                        float(self.growth[run]))


def gradients(model: Model, h: float, t_end: float, objectives: Objectives,
              parameters: Sequence[Parameter], values: Mapping[str, Values],
              mode: Literal["adjoint", "forward"] = "adjoint",
              tolerance: Tolerance | None = None, scheme: Scheme | None = None,
              threads: int | None = None,
              progress: Callable[[float], None] | bool | None = None) -> Gradients:
    """Gradients of many runs of a model, each with numbers of its own, in threads.

    Every run has the gradient that `gradient` gives of a model with its numbers; the number of
    threads changes no bit of it. Where a run fails, all others go on.

    Parameters
    ----------
    model, h, t_end, objectives, parameters, mode, tolerance, scheme
        As of `gradient`.
    values : mapping
        Values by name as of `Ensemble.run`: the first axis of each array counts the runs. They may
        be those of `parameters` or of others.
    threads : int, optional
        By default one for each processor. Each works on a copy of the model.
    progress : callable or bool, optional
        As of `Ensemble.run`.

    Raises
    ------
    InputError
        Before the first run: what `gradient` and `Ensemble.run` refuse.

    Examples
    --------
    >>> found = gradients(model, 0.01, 5.0, {"tip": final("tip.position")}, ["beam.stiffness"],
    ...                   {"motor.amplitude": np.linspace(0.5, 2.0, 100)})
    >>> found.matrix.shape
    (100, 3, 1)
    """
    mode = inputs.choice(mode, "mode", MODES)
    h = inputs.number(h, "h", above=0)
    t_end = h * whole_steps(inputs.number(t_end, "t_end", above=0), h)
    outputs = checked(objectives, t_end)
    inputs.instance(model, "model", Model, "give a sebody.Model")
    model = cast(Model, copied(model))
    threads = inputs.integer(processors() if threads is None else threads, "threads", least=1)
    found, rows, runs = checked_values(model, values)
    for name, one in found.items():
        if one.handle.whole:
            raise InputError(f"values of {name!r} are whole bodies: give numbers, such as factors "
                             "of its stiffness and mass")
    columns = columns_of(model, parameters)
    refuse_model(model)
    scheme = fitting(scheme, given_tolerance(tolerance))
    began = time.perf_counter()
    template = Simulation(model, h, scheme, tolerance=tolerance)
    refuse_run(template)
    Products.of(template)       # compiles what is missing, before threads do
    read = forms(template, outputs)
    labels = [label for name, one in outputs.items() for label in labels_of(
        name, () if one.norm else read[one.quantity].shape)]
    shape = runs, len(labels)
    many = Gradients(np.full(shape, np.nan), np.full((*shape, len(columns)), np.nan),
                     tuple(labels), tuple(c.label for c in columns), np.full(runs, np.nan))

    def of_run(member: _Member, run: int) -> Gradient:
        return member.differentiated({name: own[run] for name, own in rows.items()}, h, t_end,
                                     outputs, mode, scheme, tolerance)
    work = _Work(many, of_run, lambda: _Member(model, list(rows), parameters))
    with catch_warnings(), showing(progress) as show:
        simplefilter("ignore", LimitWarning)    # of single runs
        work.go(min(threads, max(runs, 1)), show)
    many.seconds = time.perf_counter() - began
    _warn(many)
    return many


def _warn(many: Gradients) -> None:
    """Say how many runs are chaotic."""
    chaotic = np.flatnonzero(many.growth > CHAOTIC)
    if len(chaotic):
        warn(f"a disturbance grows up to {many.growth[chaotic].max():.1g} times in its effect on "
             f"the objectives of {len(chaotic)} runs, such as run {chaotic[0]}: their motion is "
             "unstable or chaotic, and its derivatives hold in a range as small; shorten the runs")


class _Member:
    """A copy of the model that a thread has for itself."""

    def __init__(self, model: Model, names: list[str], parameters: Sequence[Parameter]):
        self.model = cast(Model, copied(model))
        own = columns_of(self.model, names)
        places = {(c.name, c.component) for c in own}
        others = [name for name in parameters
                  if not places >= {(c.name, c.component)
                                    for c in columns_of(self.model, [name])}]
        self.point = Point(self.model, [*names, *others])
        order = {(c.name, c.component): k for k, c in enumerate(self.point.columns)}
        self.columns = [order[c.name, c.component] for c in columns_of(self.model, parameters)]

    def differentiated(self, values: Mapping[str, NDArray], h: float, t_end: float,
                       outputs: Mapping[str, Output], mode: str, scheme: Scheme,
                       tolerance: Tolerance | None) -> Gradient:
        """The gradient of the model with these values."""
        x = self.point.base.copy()
        own = np.concatenate([np.ravel(one) for one in values.values()])
        x[:len(own)] = own      # these columns come first
        with self.point.at(x) as columns:
            return differentiate(self.model, h, t_end, outputs, [columns[k] for k in self.columns],
                                 mode, scheme, tolerance)


class _Work:
    """Threads that take runs one after the other."""

    def __init__(self, many: Gradients, one: Callable[[_Member, int], Gradient],
                 member: Callable[[], _Member]):
        self.many, self.one, self.member = many, one, member
        self.left = iter(range(len(many.value)))
        self.done, self.lock, self.stop = 0, Lock(), Event()
        self.error: BaseException | None = None

    def go(self, threads: int, progress: Callable[[float], None] | None) -> None:
        """Do all runs; Ctrl-C ends them."""
        runs = len(self.many.value)
        workers = [Thread(target=self._work, daemon=True) for _ in range(threads)]
        try:
            for worker in workers:
                worker.start()
            while any(worker.is_alive() for worker in workers):
                workers[0].join(LOOK) if workers[0].is_alive() else workers.pop(0)
                if progress:
                    progress(self.done / runs)
        except KeyboardInterrupt:
            self.many.interrupted = True
        finally:
            self.stop.set()
            for worker in workers:
                worker.join()
        if self.error is not None:
            raise self.error
        if progress and not self.many.interrupted:
            progress(1.0)
        for run in np.flatnonzero(np.isnan(self.many.value).all(axis=1)):
            self.many.failures.setdefault(int(run), INTERRUPTED)

    def _work(self) -> None:
        try:
            with self.lock:     # the model is copied as it is
                member = self.member()
            while not self.stop.is_set():
                with self.lock:
                    run = next(self.left, None)
                if run is None:
                    return
                self._run(member, run)
                self.done += 1
        except Exception as error:      # of the program: raised by the thread that waits
            self.error = error
            self.stop.set()

    def _run(self, member: _Member, run: int) -> None:
        try:
            found = self.one(member, run)
        except (InputError, SimulationError) as error:      # of this run
            self.many.failures[run] = str(error).replace(f"; {KEPT}", "")   # here they are not
            return
        self.many.value[run], self.many.matrix[run] = found.value, found.matrix
        self.many.growth[run] = found.growth
