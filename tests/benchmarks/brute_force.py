"""The cheapest model of a scene within a tolerance, by running everything on advise's axes.

All forms of all parts with all steps are the choices, as `sebody.explore.advice` has them in its
table. Four rules save runs; no indicator of advise is used.

1. Choices run in the order of predicted time, that of the poorest model with the same step and of
   each part's form beside it, all measured. They end where the rest is predicted to take `SLACK`
   times as long as the cheapest that was found.
2. A form that alone, beside the reference forms of the other parts and with the same step, errs by
   `SPOILS` times the tolerance is left out, and so are forms whose errors alone do as the root of
   the sum of their squares: errors of several parts do not take one another away.
3. In a model of several parts a form is left out if another form of its part takes less time and
   errs less alone.
4. Forms that miss the tolerance with a step with which the reference model errs by less than `FINE`
   of it do not run with other steps: the step is not what they miss it by.

As `advise` does, the search wants a choice to be within the tolerance with half its step, too;
what is so by luck is counted apart.

Planar models, shared and dropped DOF blocks are to change nothing but the time: they are taken
where they can be made, agree with the reference model and take less time.
"""

import heapq
import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from sebody.basics.errors import InputError, SimulationError
from sebody.explore.advice.changes import Builder, Choice, Step
from sebody.explore.advice.first_runs import LONGER
from sebody.explore.advice.forms import Form, Part, parts_of
from sebody.explore.advice.judgement import SHORTER
from sebody.explore.advice.quantities import Quantities, Values, difference, sizes_of
from sebody.explore.advice.runner import FINER
from sebody.model.model import Model
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance
from sebody.verify.chart.timing import poor_variants, processor_seconds

SLACK = 1.5
SPOILS = 2.0
FINE = 0.25
FINEST = 8              # steps of the reference in one given step; twice as many, extrapolated
TIMES = 3               # runs of which the quickest counts, for predictions
LOCAL = [10.0**-k for k in range(1, 7)]     # local tolerances of variable steps
EXACT = 5e-5            # error that what should change nothing may make


def begun(model: Model, step: Step, grid: float) -> Simulation:
    """A run that is recorded on a grid, or in its own steps if they are longer."""
    return Simulation(model, step.h, output_every=max(round(grid / step.h), 1),
                      tolerance=None if step.local is None else Tolerance(step.local))


@dataclass(frozen=True)
class Found:
    """A choice that ran: its error against the reference and its processor time [s]."""

    choice: Choice
    error: float
    seconds: float


@dataclass
class BruteForce:
    """Runs of a scene on advise's axes, each made once.

    Parameters
    ----------
    model : Model
    names : tuple of str
        Quantities.
    h, t_end : float
    """

    model: Model
    names: tuple[str, ...]
    h: float
    t_end: float
    ran: dict[Choice, Found] = field(default_factory=dict)

    def __post_init__(self) -> None:
        wanted = Quantities(self.names)
        self._frequencies = Quantities([n for n in self.names if n not in wanted.histories]
                                       ) if wanted.numbers else None
        self._histories = Quantities(wanted.histories)
        self._of_forms: dict[tuple[Form, ...], list[float]] = {}
        self.parts: list[Part] = parts_of(self.model, wanted.owners)
        self.builder = Builder(self.model, self.parts, wanted.owners)
        self.steps = self._steps()
        self.fine = Step(self.h / max(FINER))
        self.exact = {"shared": False, "dropped": False, "planar": False}
        self.reference, self.own_error = self._reference()
        self.sizes = sizes_of(self.reference)

    @property
    def detailed(self) -> Choice:
        """The reference model with the shortest step."""
        return Choice(tuple(part.detailed for part in self.parts), self.fine)

    def _steps(self) -> list[Step]:
        """All that advise may try."""
        count = round(self.t_end / self.h)
        return [*(Step(k * self.h) for k in LONGER if count % k == 0),
                *(Step(self.h / k) for k in (*sorted(FINER), *SHORTER[:1])),
                *(Step(self.h, local) for local in LOCAL)]

    def _reference(self) -> tuple[Values, float]:
        """The reference model, extrapolated in the step, and the estimate of its error."""
        coarse, fine = (self._values(self.detailed._replace(step=Step(self.h / k)))[0]
                        for k in (FINEST, 2 * FINEST))
        best = Values([b + (b - a) / 3.0 for a, b in zip(coarse.histories, fine.histories,
                                                        strict=True)],
                      fine.frequencies, fine.measures)
        return best, difference(fine, best, sizes_of(best), (1, 1))

    def _values(self, choice: Choice) -> tuple[Values, float, float]:
        """Quantities of a run, the step of their grid, and its time."""
        model = self.builder.make(choice).model
        with poor_variants():
            run = begun(model, choice.step, self.h)
            seconds = processor_seconds(run, self.t_end)
            result = run.result()
        if self._frequencies and choice.forms not in self._of_forms:
            self._of_forms[choice.forms] = self._frequencies.of(result, self.h).frequencies
        histories = self._histories.of(result, self.h).histories
        return (Values(histories, self._of_forms.get(choice.forms, []), self._histories.measures),
                max(choice.step.h, self.h), seconds)

    def run(self, choice: Choice) -> Found:
        """Error and time of a choice; both infinite of what does not run."""
        if choice not in self.ran:
            error = seconds = np.inf
            try:
                values, h, seconds = self._values(choice)
                error = difference(values, self.reference, self.sizes, (1, round(h / self.h)))
            except (InputError, SimulationError):
                pass        # what does not run is not within any tolerance
            self.ran[choice] = Found(choice, error, seconds)
        return self.ran[choice]

    def error_of(self, model: Model, step: Step) -> float:
        """Error of any model, by the same reference."""
        with poor_variants():
            result = begun(model, step, self.h).run_to(self.t_end).result()
        frequencies = (self._frequencies.of(result, self.h).frequencies if self._frequencies
                       else [])
        return difference(Values(self._histories.of(result, self.h).histories, frequencies,
                                 self._histories.measures),
                          self.reference, self.sizes, (1, max(round(step.h / self.h), 1)))

    def explore(self, tolerance: float) -> None:
        """What the rules need up to a tolerance: errors of forms alone, and their times."""
        given = Step(self.h)
        whole = self._values(self.detailed._replace(step=given))[0]
        self.alone = [{form: self._alone(k, form, given, whole) for form in part.forms}
                      for k, part in enumerate(self.parts)]
        base = self._poorest(given)
        self._look_at_exact(base, whole)
        base = base._replace(**self.exact)
        least = self._quickest(base)
        self._added = [{form: self._quickest(self._with(base, k, form)) - least
                        for form, error in alone.items() if error <= SPOILS * tolerance}
                       for k, alone in enumerate(self.alone)]
        self._of_steps = {step: self._quickest(base._replace(step=step)) for step in self.steps}
        self._of_steps = {step: seconds for step, seconds in self._of_steps.items()
                          if np.isfinite(seconds)}
        self._least = least
        self._of_detailed = {step: self.run(self.detailed._replace(step=step)).error
                            for step in self.steps}

    def _with(self, choice: Choice, k: int, form: Form) -> Choice:
        return choice._replace(forms=tuple(form if k == i else one
                                           for i, one in enumerate(choice.forms)))

    def _alone(self, k: int, form: Form, step: Step, whole: Values) -> float:
        """Error of a form of one part, against the reference with the same step."""
        try:
            values, _, _ = self._values(self._with(self.detailed._replace(step=step), k, form))
            return difference(values, whole, self.sizes, (1, 1))
        except (InputError, SimulationError):
            return np.inf

    def _poorest(self, step: Step) -> Choice:
        """A choice of little cost that runs: parts rigid or without modes."""
        found = Choice(tuple(min((f for f in part.forms if not f.rigid),
                                 key=lambda f: (f.bodies, f.modes)) for part in self.parts), step)
        for k, part in enumerate(self.parts):
            rigid = self._with(found, k, next(f for f in part.forms if f.rigid))
            if np.isfinite(self._quickest(rigid)):
                found = rigid
        return found

    def _look_at_exact(self, base: Choice, whole: Values) -> None:
        """What should change nothing, where it can be made, agrees and pays."""
        for name in self.exact:
            changed = {**self.exact, name: True}
            detailed = self.detailed._replace(step=base.step, **changed)
            try:
                if self.builder.make(detailed).changes == self.builder.make(self.detailed).changes:
                    continue
                found = difference(self._values(detailed)[0], whole, self.sizes, (1, 1))
            except (InputError, SimulationError):
                continue
            if found <= EXACT and self._quickest(base._replace(**changed)) < self._quickest(
                    base._replace(**self.exact)):
                self.exact[name] = True

    def _quickest(self, choice: Choice) -> float:
        """Time of the quickest of several runs."""
        try:
            return min(self._values(choice)[2] for _ in range(TIMES))
        except (InputError, SimulationError):
            return np.inf

    def predicted(self, choice: Choice) -> float:
        """Time of a choice."""
        added = sum(own[form] for own, form in zip(self._added, choice.forms, strict=True))
        return self._of_steps[choice.step] * (1.0 + max(added, 0.0) / self._least)

    def forms(self, tolerance: float) -> list[list[Form]]:
        """Forms of each part that rules 2 and 3 leave."""
        found = []
        for k, alone in enumerate(self.alone):
            added = self._added[k]
            kept = [form for form, error in alone.items()
                    if error <= SPOILS * tolerance and np.isfinite(added[form])]
            if len(self.parts) > 1:
                kept = [form for form in kept if not any(
                    added[other] < added[form] and alone[other] < alone[form] for other in kept)]
            found.append(kept)
        return found

    def cheapest(self, tolerance: float) -> tuple[list[Found], list[Found], int]:
        """Choices within a tolerance, quickest first.

        Returns
        -------
        sure, all : list of Found
            Those that are within it with half the step, too, and all of them.
        int
            How many choices ran.
        """
        best, sure, found, count, missed = np.inf, [], [], 0, set()
        for choice in self._cheapest_first(self.forms(tolerance)):
            if self.predicted(choice) > SLACK * best:
                break
            if choice.forms in missed or self._spoilt(choice.forms, tolerance):
                continue
            one = self.run(choice)
            count += 1
            if one.error > tolerance and self._of_detailed[choice.step] <= FINE * tolerance:
                missed.add(choice.forms)
            if one.error <= tolerance:
                found.append(one)
                finer = choice._replace(step=choice.step.finer())
                if self.run(finer).error <= tolerance:
                    best = min(best, one.seconds)
                    sure.append(one)
        return *(sorted(own, key=lambda one: one.seconds) for own in (sure, found)), count

    def _spoilt(self, forms: tuple[Form, ...], tolerance: float) -> bool:
        errors = [alone[form] for alone, form in zip(self.alone, forms, strict=True)]
        return bool(np.linalg.norm(errors) > SPOILS * tolerance)

    def _cheapest_first(self, forms: list[list[Form]]) -> Iterator[Choice]:
        """All choices by their predicted times, without making all of them first."""
        columns = [sorted(own, key=self._added[k].get) for k, own in enumerate(forms)]
        if not all(columns):
            return
        order, queue, seen = itertools.count(), [], set()

        def push(places: tuple[int, ...], step: Step) -> None:
            if (places, step) not in seen:
                seen.add((places, step))
                choice = Choice(tuple(c[i] for c, i in zip(columns, places, strict=True)), step,
                                **self.exact)
                heapq.heappush(queue, (self.predicted(choice), next(order), places, choice))
        for step in self._of_steps:
            push((0,) * len(columns), step)
        while queue:
            _, _, places, choice = heapq.heappop(queue)
            yield choice
            for k, i in enumerate(places):
                if i + 1 < len(columns[k]):
                    push((*places[:k], i + 1, *places[k + 1:]), choice.step)
