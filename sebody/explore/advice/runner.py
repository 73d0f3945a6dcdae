"""Runs of choices: the reference model with several steps first, then what is compared with it."""

from dataclasses import dataclass, replace
from math import inf
from time import process_time

import numpy as np

from sebody.assembly.build import build
from sebody.errors import InputError, SimulationError
from sebody.explore.advice.changes import Builder, Choice, Step
from sebody.explore.advice.cost import Cost
from sebody.explore.advice.estimates import Estimates, expected
from sebody.explore.advice.forms import Part, parts_of
from sebody.explore.advice.guards import (
    OFF_GRID,
    Scales,
    amplified,
    disturbed,
    off_the_grid,
)
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.judgement import SHARE, SHORTER, judge
from sebody.explore.advice.labels import in_brief
from sebody.explore.advice.loads import SEEN, Missed, missed
from sebody.explore.advice.outcome import Doubt, Trial
from sebody.explore.advice.quantities import Quantities, Worst, compared, difference, sizes_of
from sebody.explore.advice.reference import ORDER_FACTOR, Reference, reference, still
from sebody.explore.advice.runs import Run, Runs
from sebody.model.model import Model

FINER = (4, 2, 1)       # parts of the given step, of the first runs of the reference model
GOOD = 0.2              # of the tolerance, that the reference may be off by without them
LARGEST = 0.9           # relative tolerance, that an absolute one is at most
LONGER = (2, 4)         # given steps, that a step may be
MISSED = 0.2            # of a load, that steps which are tried may not see
REGULAR = 0.05          # error from which errors by the step fall as they will for shorter ones
COARSE = 0.02           # error by a step up to the given one, with which forms are tried alone
LONGEST = 2.0           # of the tolerance, that a longer step is expected to be off by
SHORTEST = 64           # parts of the given step, of the grid


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
        self._work = self._guards = self._unit = 0.0

    @property
    def detailed(self) -> Choice:
        """The choice of the reference model, with the shortest step that it ran with."""
        step = Step(min(self.bases, default=self.runs.h / FINER[0]))
        return Choice(tuple(part.detailed for part in self.parts), step)

    def spent(self) -> float:
        """Work of all runs, relative to that of the reference model with its shortest step."""
        return self._work / self._unit

    @property
    def guarded(self) -> float:
        """The part of it that was spent on guards."""
        return self._guards / self._unit

    def start(self) -> None:
        """Run the reference, and judge it.

        Raises
        ------
        InputError
            Quantities that do not exist or do not change, or a tolerance that the reference model
            does not reach.
        SimulationError
            It does not run, or its error does not fall with the step.
        """
        self._shorten()
        choice = self.detailed
        first = self._base(choice.step.h)
        for k in still(first.values):
            what = f"quantity {self.quantities.histories[k]!r} does not change"
            if not np.ptp(first.result.recorded("q"), axis=0).any():
                raise InputError(f"{what}: the model does not move; give it loads, a drive or "
                                 "initial velocities")
            raise InputError(f"{what}: give one that the motion changes")
        if self.absolute is not None:
            self.tolerance = min(self.absolute / max(sizes_of(first.values)), LARGEST)
        for part in FINER[1:]:
            try:
                self._base(self.runs.h / part)
            except SimulationError:
                if part > 1:
                    raise
                self._base(self.runs.h / SHORTER[0])    # the fall of errors needs three runs
        self.reference = self._reference()
        for part in SHORTER:
            if self.runs.h / part in self.bases:
                continue
            most = ORDER_FACTOR**(len(SHORTER) - SHORTER.index(part))
            hopeless = (self.reference.step_error < REGULAR
                        and self.reference.step_error / most > self.tolerance)
            if self.reference.error <= GOOD * self.tolerance or hopeless:
                break
            self._base(self.runs.h / part)
            self.reference = self._reference()
        judge(self.reference, self.tolerance, self.runs.h, self.bases)
        self._unit = self.cost.work(choice, self.bases[min(self.bases)].iterations)
        self._lengthen()
        self.table += [Trial(in_brief(self.parts, choice), h, 0.0, run.seconds)
                       for h, run in sorted(self.bases.items())]
        self._guard()
        errors = {h: self.error(run) for h, run in self.bases.items()}
        finest = min(errors)
        errors[finest] = max(self.reference.step_error, self.reference.error)
        self.table = [replace(one, error=errors[one.step])
                      if one.kind == "reference" else one
                      for one in self.table]
        for h in sorted(errors):
            run = self.bases[h]
            self.tried.append(Tried(choice._replace(step=Step(h)), errors[h], errors[h],
                                    run.seconds, self.worst(run), run.h))
        recorded = Recorded(self.model, first.result, self.quantities.wholes(first.result),
                            self.reference.sizes, first.values.frequencies, self.parts)
        self.estimates = Estimates(recorded, self.parts,
                                   {Step(h): error for h, error in errors.items()})

    def _shorten(self) -> None:
        """Take a part of the given step as the grid where loads need shorter ones.

        Raises
        ------
        InputError
            No part that is tried resolves a load.
        """
        if not self.quantities.histories:
            return
        given = self.runs.h
        while (load := self.missed(self.runs.h / FINER[0])).share > SEEN:
            self.runs.h /= 2
            if given / self.runs.h > SHORTEST:
                raise InputError(
                    f"{load.name} changes too fast for the step: even steps of "
                    f"{2 * self.runs.h / FINER[0]:.3g} miss {load.share:.0%} of it, most at t = "
                    f"{load.time:.5g}; give a smaller h than {given:g}")
            self.remarks = [f"{load.name} needs shorter steps than those of {given:g}: the grid "
                            f"is {self.runs.h:g}"]

    def missed(self, h: float) -> Missed:
        """The load or drive of which steps miss most."""
        if self._ports is None:
            share = build(self.model)[1]
            self._ports = share.port_names, share.time_functions
        return missed(*self._ports, h, self.runs.t_end)

    def _lengthen(self) -> None:
        """Find the longest step that the motion is resolved with: forms are tried with it alone."""
        if not self.quantities.histories:
            self.trial = Step(max(self.bases))
            return
        self._try_longer()
        # unresolved vibrations make forms differ by up to the error of the step
        most = {h: COARSE if h <= self.runs.h else SHARE * self.tolerance for h in self.bases}
        resolving = [h for h, run in self.bases.items() if self.worst(run).error <= most[h]]
        self.trial = Step(max(resolving, default=min(self.bases)))

    def _try_longer(self) -> None:
        """Run the reference model with longer steps than the given one where they may do."""
        h, count = self.runs.h, round(self.runs.t_end / self.runs.h)
        for k in LONGER:
            error = self.worst(self.bases[max(self.bases)]).error
            if (count % k or ORDER_FACTOR * error > LONGEST * self.tolerance
                    or self.missed(k * h).share > MISSED):
                return
            try:
                self._base(k * h)
            except SimulationError:
                return

    def _guard(self) -> None:
        """Run the reference model off the grid, and disturbed: what that casts doubt on."""
        fine = min(self.bases)
        self.warnings = self.bases[fine].result.warnings
        if not self.quantities.histories:
            return
        step, whole = Step(OFF_GRID * fine), self.builder.build(self.detailed)
        known = self.bases[fine].values.frequencies
        run = self.beside(whole, step, "off the grid of all others", 1, known)
        off, doubt = off_the_grid(run.result, run.values, step.h, self.reference, self.runs.h)
        self.table[-1] = replace(self.table[-1], error=off)
        coarse = min(self.trial.h, max(h for h in self.bases if h <= self.runs.h))
        still = self.bases[coarse].result
        scales = Scales.of(still)
        other = self.beside(disturbed(whole, scales), Step(coarse), "slightly disturbed", 0, known)
        self.table[-1] = replace(self.table[-1], error=self.apart(other, coarse))
        growth = amplified(other.result, still, scales)
        self.doubts += [doubt, growth.doubt]
        self.remarks += growth.remark

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
        """Whether a disturbance grows: then no symmetry may be assumed."""
        return any(one.error > 0.0 for one in self.doubts[1:])

    def _base(self, h: float) -> Run:
        """Run the reference model with a step."""
        choice = self.detailed._replace(step=Step(h))
        self.bases[h] = self.run(choice, watched=True)
        return self.bases[h]

    def _reference(self) -> Reference:
        values = [self.bases[h].values for h in sorted(self.bases, reverse=True)]
        return reference(values, self.absolute is not None)

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
        """Where a run differs most from the reference."""
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
