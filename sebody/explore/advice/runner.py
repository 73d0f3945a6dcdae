"""Runs of the reference model and of choices, and their errors; see `first_runs`, then `search`."""

from dataclasses import dataclass
from math import inf
from time import process_time

from sebody.assembly.build import build
from sebody.basics.errors import InputError, SimulationError
from sebody.explore.advice.changes import Builder, Choice, Step
from sebody.explore.advice.cost import Cost
from sebody.explore.advice.estimates import Estimates, expected
from sebody.explore.advice.forms import Part, parts_of
from sebody.explore.advice.labels import in_brief
from sebody.explore.advice.loads import Missed, missed
from sebody.explore.advice.outcome import Doubt, Trial
from sebody.explore.advice.quantities import Quantities, Worst, compared, difference
from sebody.explore.advice.reference import Reference
from sebody.explore.advice.runs import Run, Runs
from sebody.model.model import Model

FINER = (4, 2, 1)       # parts of the given step, of the first runs of the reference model


@dataclass
class Tried:
    """A choice that ran, or failed."""

    choice: Choice
    error: float
    predicted: float
    seconds: float
    worst: Worst = Worst(0.0, "")
    h: float = 0.0          # of its records


class Laboratory:
    """All runs of a search, and what they are compared with.

    Parameters
    ----------
    model : Model
        As given.
    quantities : Quantities
    runs : Runs
    tolerance : float
    absolute : float, optional
        Largest error in the quantities' own unit, in place of the relative one.
    """

    def __init__(self, model: Model, quantities: Quantities, runs: Runs, tolerance: float,
                 absolute: float | None = None):
        self.model, self.quantities, self.runs = model, quantities, runs
        self.tolerance, self.absolute = tolerance, absolute
        self.parts: list[Part] = parts_of(model, quantities.owners,
                                           quantities.places.beams)
        self.builder = Builder(model, self.parts, quantities.owners)
        self.cost = Cost(model, self.parts, runs.t_end)
        self.table: list[Trial] = []
        self.tried: list[Tried] = []
        self.bases: dict[float, Run] = {}       # runs of the reference model by their steps
        self.doubts: list[Doubt] = []           # of the guards
        self.warnings: tuple[str, ...] = ()     # of the reference
        self.remarks: list[str] = []
        self.count, self.begun = 0, process_time()      # runs, and since when [s]
        self._ports: tuple | None = None
        self.given_step = self.trial = Step(runs.h)     # trial: that forms are tried with alone
        self._work = self._guards = self.unit = 0.0
        self.reference: Reference               # this and the next by `first_runs`
        self.estimates: Estimates

    @property
    def detailed(self) -> Choice:
        """The choice of the reference model, with the shortest step that it ran with."""
        step = Step(min(self.bases, default=self.runs.h / FINER[0]))
        return Choice(tuple(part.detailed for part in self.parts), step)

    def spent(self) -> float:
        """Work of all runs, relative to that of the reference model with its shortest step."""
        return self._work / self.unit

    @property
    def guarded(self) -> float:
        """The part of it that was spent on guards."""
        return self._guards / self.unit

    def missed(self, h: float) -> Missed:
        """The load or drive of which steps miss most."""
        if self._ports is None:
            self._ports = tuple(zip(*build(self.model)[1].courses, strict=True)) or ((), ())
        return missed(*self._ports, h, self.runs.t_end)

    def add_error(self, error: float) -> None:
        """Add an error to that of the reference, and so to those of all runs."""
        self.reference = self.reference._replace(error=self.reference.error + error)
        for one in self.tried:
            one.error += error
            self.estimates.learn_step(one.choice.step, one.error)

    def beside(self, model: Model, step: Step, words: str, every: int = 0,
               frequencies: list[float] | None = None) -> Run:
        """Run a model as rich as the reference model, or richer, that is no choice; see `Runs.run`.

        Raises
        ------
        InputError, SimulationError
            It does not run, or lacks a quantity.
        """
        run = self.runs.run(model, step, every=every, frequencies=frequencies)
        self.count += 1
        work = self.cost.work(self.detailed, run.iterations)
        self._work, self._guards = self._work + work, self._guards + work
        self.table.append(Trial(f"the reference model {words}", step.h, 0.0, run.seconds,
                                kind="guard"))
        return run

    @property
    def unstable(self) -> bool:
        """Tell whether a disturbance grows: then no symmetry may be assumed."""
        return any(one.error > 0.0 for one in self.doubts[1:])

    def run_detailed(self, h: float) -> Run:
        """Run the reference model with a step."""
        choice = self.detailed._replace(step=Step(h))
        self.bases[h] = self.run(choice, watched=True)
        return self.bases[h]

    def run(self, choice: Choice, watched: bool = False) -> Run:
        """Run a choice.

        Raises
        ------
        InputError, SimulationError
            It cannot be made, does not run, or lacks a quantity.
        """
        measured = self.runs.run(self.builder.build(choice), choice.step, watched)
        self.count += 1
        if self._work == 0.0:
            self.cost.measured(choice, measured.seconds, measured.iterations)
        self._work += self.cost.work(choice, measured.iterations)
        self.cost.counted(choice.step, measured.iterations)
        return measured

    def given(self) -> Tried:
        """The model as it was given, with the given step: what would have been run."""
        forms = tuple(part.given for part in self.parts)
        return self.attempt(Choice(forms, self.given_step), "given")[0]

    def error(self, run: Run) -> float:
        """Error of a run with that of the reference."""
        return self.reference.error + self.worst(run).error

    def worst(self, run: Run) -> Worst:
        """The place and time where a run differs most from the reference."""
        stride = max(round(run.h / self.runs.h), 1)
        return compared(run.values, self.reference.values, self.reference.sizes, (1, stride))

    def apart(self, run: Run, h: float) -> float:
        """Difference of a run from the reference model with the same step."""
        return difference(run.values, self.bases[h].values, self.reference.sizes, (1, 1))

    def attempt(self, choice: Choice, kind: str) -> tuple[Tried, Run | None]:
        """Run a choice and put it into the table; its error is infinite if it does not run."""
        predicted, cost = expected(self.estimates.contributions(choice)), self.cost.of(choice)
        error, seconds, run, words = inf, 0.0, None, in_brief(self.parts, choice)
        try:
            run = self.run(choice)
            error, seconds = self.error(run), run.seconds
        except (InputError, SimulationError) as reason:
            words = f"{words}: {reason}"
        self.table.append(Trial(words, choice.step.h, error, seconds, predicted, cost, kind,
                                choice.step.local))
        tried = Tried(choice, error, predicted, seconds)
        if run:
            tried.worst, tried.h = self.worst(run), run.h
        self.tried.append(tried)
        return tried, run
