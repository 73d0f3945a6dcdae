"""Runs of choices: the reference model with several steps first, then what is compared with it."""

from dataclasses import dataclass
from math import inf

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
from sebody.explore.advice.labels import in_brief
from sebody.explore.advice.loads import SEEN, Missed, missed
from sebody.explore.advice.outcome import Doubt, Trial
from sebody.explore.advice.quantities import Quantities, Worst, compared, difference, sizes_of
from sebody.explore.advice.reference import ORDER_FACTOR, Reference, reference, still
from sebody.explore.advice.runs import Run, Runs
from sebody.model.model import Model

FINER = (4, 2, 1)       # parts of the given step, of the first runs of the reference model
SHORTER = (8, 16, 32, 64)     # further ones, where the tolerance needs them
GOOD = 0.2              # of the tolerance, that the reference may be off by without them
LARGEST = 0.9           # relative tolerance, that an absolute one is at most
SHORTEST = 64           # parts of the given step, of the grid
EARLY = 3               # steps of the grid, that errors are those of the start in
MARGIN = 1.2            # of a tolerance that would pass
SHARE = 0.5             # of the tolerance, that the reference must be good to


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
        self._ports: tuple | None = None
        self.given_step = Step(runs.h)
        self._work = self._unit = 0.0

    @property
    def detailed(self) -> Choice:
        """The choice of the reference model, with the shortest step that it ran with."""
        step = Step(min(self.bases, default=self.runs.h / FINER[0]))
        return Choice(tuple(part.detailed for part in self.parts), step)

    def spent(self) -> float:
        """Work of all runs, relative to that of the first."""
        return self._work / self._unit

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
            if self.reference.error <= GOOD * self.tolerance or (
                    self.reference.step_error / most > self.tolerance):
                break
            self._base(self.runs.h / part)
            self.reference = self._reference()
        self._judge()
        self._guard()
        errors = {h: self.error(run) for h, run in self.bases.items()}
        finest = min(errors)
        errors[finest] = max(self.reference.step_error, self.reference.error)
        words = in_brief(self.parts, choice)
        for h in sorted(errors):
            self.table.append(Trial(words, h, 0.0 if h == finest else errors[h],
                                    self.bases[h].seconds))
            run = self.bases[h]
            self.tried.append(Tried(choice._replace(step=Step(h)), errors[h], errors[h],
                                    run.seconds, self.worst(run), run.h))
        recorded = Recorded(self.model, first.result, self.quantities.wholes(first.result),
                            self.reference.sizes, first.values.frequencies)
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
            found = build(self.model)[1]
            self._ports = found.port_names, found.histories
        return missed(*self._ports, h, self.runs.t_end)

    def _guard(self) -> None:
        """Run the reference model off the grid, and disturbed: what that casts doubt on."""
        fine = min(self.bases)
        self.warnings = self.bases[fine].result.warnings
        if not self.quantities.histories:
            return
        step = Step(OFF_GRID * fine)
        run = self.runs.run(self.builder.build(self.detailed), step, every=1)
        self.doubts.append(off_the_grid(run.result, run.values, step.h, self.reference,
                                        self.runs.h))
        coarse = max(self.bases)
        still = self.bases[coarse].result
        scales = Scales.of(still)
        other = self.runs.run(disturbed(self.builder.build(self.detailed), scales), Step(coarse))
        self.doubts.append(amplified(other.result, still, scales))

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
        found = [self.bases[h].values for h in sorted(self.bases, reverse=True)]
        return reference(found, self.absolute is not None)

    def _judge(self) -> None:
        """Refuse a tolerance that the reference is not good for."""
        if self.reference.error <= SHARE * self.tolerance:
            return
        worst, fine = self.reference.worst, min(self.bases)
        first = worst.row is not None and worst.row < EARLY
        where = "" if worst.row is None else f" at t = {worst.row * self.runs.h:.4g}"
        told = (f"{worst.quantity} is known to {self.reference.error:.2g} of its change only, worst"
                f"{where}, even with the step {fine:.3g}")
        enough = (f"a tolerance of {self.reference.error / SHARE * MARGIN:.1g} would pass: half of "
                  "it is left for the reference")
        if first:
            raise InputError(
                f"{told}: the model is loaded suddenly at the start, which excites its fastest "
                "vibrations; start from the equilibrium (start='equilibrium'), let loads grow from "
                f"zero, or measure {worst.quantity} by rms or below a frequency; {enough}")
        if not self.reference.falls:
            raise SimulationError(
                f"{told}, and shorter steps do not change that: the motion depends on the step, as "
                "in chaotic motions, impacts and undamped vibrations; give an "
                f"earlier end, damping, or measure {worst.quantity} by rms, peak or below a "
                f"frequency; {enough}", self.bases[fine].result)
        raise InputError(f"{told}: shorter steps that are tried, down to "
                         f"{self.runs.h / SHORTER[-1]:.3g}, are not enough; {enough}")

    def run(self, choice: Choice, watched: bool = False) -> Run:
        """Run a choice.

        Raises
        ------
        InputError, SimulationError
            It cannot be made, does not run, or lacks a quantity.
        """
        found = self.runs.run(self.builder.build(choice), choice.step, watched)
        if self._unit == 0.0:
            self.cost.measured(choice, found.seconds, found.iterations)
            self._unit = self.cost.work(choice, found.iterations)
        self._work += self.cost.work(choice, found.iterations)
        self.cost.counted(choice.step, found.iterations)
        return found

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
        found = Tried(choice, error, predicted, seconds)
        if run:
            found.worst, found.h = self.worst(run), run.h
        self.tried.append(found)
        return found, run
