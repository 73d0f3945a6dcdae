"""The search: one part at a time, then all together, cheapest first."""

from dataclasses import dataclass

import numpy as np

from sebody.analysis.advice.changes import Builder, Choice, Step
from sebody.analysis.advice.combinations import combinations
from sebody.analysis.advice.cost import Cost
from sebody.analysis.advice.estimates import Estimates, expected, least
from sebody.analysis.advice.forms import Form, Part, parts_of
from sebody.analysis.advice.indicators.recorded import Recorded
from sebody.analysis.advice.outcome import Trial
from sebody.analysis.advice.quantities import Quantities, difference
from sebody.analysis.advice.reference import FINER, Reference, reference, still
from sebody.analysis.advice.runs import Run, Runs
from sebody.errors import InputError, SimulationError
from sebody.model.model import Model

LONGER = (4, 2)             # steps that are tried, in given ones
MOST_ALONE = 6              # forms of a part that are tried alone
MOST_TOGETHER = 24          # choices that are tried
SHARE = 0.5                 # of the tolerance, that one part may use


@dataclass
class Tried:
    """A choice that ran."""

    choice: Choice
    model: Model
    error: float
    predicted: float
    seconds: float


class Search:
    """A search for the cheapest model.

    Parameters
    ----------
    model : Model
        As given.
    quantities : Quantities
    runs : Runs
    tolerance, budget : float
    """

    def __init__(self, model: Model, quantities: Quantities, runs: Runs, tolerance: float,
                 budget: float):
        self.model, self.quantities, self.runs = model, quantities, runs
        self.tolerance, self.budget = tolerance, budget
        self.parts: list[Part] = parts_of(model, quantities.owners)
        self.builder = Builder(model, self.parts)
        self.cost = Cost(model, self.parts, runs.t_end)
        self.untried: list[str] = []
        self.tried: list[Tried] = []
        self._failed: list[Choice] = []
        self._work = 0.0
        self._bases: dict[float, Run] = {}      # runs of the richest model by their steps

    @property
    def richest(self) -> tuple[Form, ...]:
        """Forms of the richest model."""
        return tuple(part.richest for part in self.parts)

    def start(self) -> None:
        """Run the reference, and judge it.

        Raises
        ------
        InputError
            Quantities that do not change, or a tolerance that the richest model does not reach.
        SimulationError
            It does not run, or its error does not fall with the step.
        """
        fine = Choice(self.richest, Step(self.runs.h / FINER[-1]))
        model = self.builder.build(fine)
        first = self._run(fine, model)
        self._whole = self._work
        self._bases[fine.step.h] = first
        for k in still(first.values):
            raise InputError(f"quantity {self.quantities.histories[k]!r} does not change: give one "
                             "that the motion changes")
        for part in FINER[-2::-1]:
            step = Step(self.runs.h / part)
            try:
                self._bases[step.h] = self._run(fine._replace(step=step), model)
            except SimulationError:
                if part > 1:
                    raise
        found = [self._bases[h] for h in sorted(self._bases, reverse=True)]
        self.reference: Reference = reference([run.values for run in found])
        self.cost.measured(fine, first.seconds)
        errors = {h: self._error(run) for h, run in self._bases.items()}
        errors[fine.step.h] = self.reference.step_error
        self._judge(fine.step.h)
        for h in sorted(errors):
            self.runs.table.append(Trial("all as it is", h, 0.0 if h == fine.step.h else errors[h],
                                         self._bases[h].seconds))
        recorded = Recorded(self.model, first.result, self.quantities.histories,
                            self.reference.sizes)
        self.estimates = Estimates(recorded, self.parts, errors)
        self.tried.append(Tried(fine, model, max(errors[fine.step.h], self.reference.error),
                                errors[fine.step.h], first.seconds))

    def _judge(self, fine: float) -> None:
        own = self.reference.step_error
        if own <= self.tolerance and self.reference.error <= SHARE * self.tolerance:
            return
        if not self.reference.falls:
            raise SimulationError(
                f"the error does not fall with the step: it stays at {own:.2g} with the step "
                f"{fine:g}. The motion may be chaotic, then only its beginning can be computed: "
                "use a larger tolerance or an earlier end", self._bases[fine].result)
        raise InputError(f"with the step {fine:g} the whole model has an error of about "
                         f"{own:.2g} from the step: give a smaller h, or a larger "
                         f"tolerance than {self.tolerance:g}")

    def spent(self) -> float:
        """Work of all runs, relative to that of the reference."""
        return self._work / self._whole

    def _run(self, choice: Choice, model: Model) -> Run:
        run = self.runs.run(model, choice.step)
        self._work += self.cost.work(choice, run.iterations)
        return run

    def _error(self, run: Run) -> float:
        """Error of a run with that of the reference."""
        stride = max(round(run.h / self.runs.h), 1)
        return self.reference.error + difference(run.values, self.reference.values,
                                                 self.reference.sizes, (1, stride))

    def alone(self, k: int) -> None:
        """Try forms of the k-th part, the others as rich as they are."""
        part, h = self.parts[k], max(self._bases)
        failed: list[Form] = []
        best = np.inf
        forms = sorted((form for form in part.forms if form != part.richest),
                       key=lambda form: self.cost.of_form(part, form))
        for _ in range(MOST_ALONE):
            form = next((
                f for f in forms if self.cost.of_form(part, f) < best
                and not any(f.poorer(other) for other in failed)
                and least(self.estimates.of_form(k, f)) <= SHARE * self.tolerance), None)
            if form is None or self.spent() > self.budget:
                return
            forms.remove(form)
            error = self._try_alone(k, form, h)
            if error <= SHARE * self.tolerance:
                best = self.cost.of_form(part, form)
            else:
                failed.append(form)

    def _try_alone(self, k: int, form: Form, h: float) -> float:
        choice = Choice(tuple(form if k == i else one for i, one in enumerate(self.richest)),
                        Step(h))
        predicted = expected(self.estimates.of_form(k, form))
        sentence, seconds, total = "", 0.0, np.inf
        try:
            model = self.builder.build(choice)
            sentence = "; ".join(self.builder.sentences(choice))
            run = self._run(choice, model)
            error = difference(run.values, self._bases[h].values, self.reference.sizes, (1, 1))
            total, seconds = self._error(run), run.seconds
        except (InputError, SimulationError) as reason:
            sentence, error = f"{sentence or form}: {reason}", np.inf
        self.runs.table.append(Trial(sentence, h, total, seconds, predicted, self.cost.of(choice),
                                     "alone"))
        if np.isfinite(error):
            self.estimates.learn_form(k, form, error)
        else:
            self.estimates.exclude(k, form)
        return error

    def steps(self) -> list[Step]:
        """Steps that are tried, longest first."""
        count = round(self.runs.t_end / self.runs.h)
        return [*(Step(k * self.runs.h) for k in LONGER if count % k == 0),
                *(Step(self.runs.h / k) for k in FINER)]

    def together(self) -> Tried:
        """Try choices of all forms and steps, cheapest first; the first that is confirmed."""
        for _ in range(MOST_TOGETHER):
            choice = self._next()
            if choice is None or self.spent() > self.budget:
                break
            found = self._try(choice, "together")
            if found.error <= self.tolerance and self._confirmed(found):
                return found
            self._failed.append(choice)
        passing = [one for one in self.tried if one.error <= self.tolerance
                   and one.choice not in self._failed]
        return min(passing, key=lambda one: one.seconds)

    def _next(self) -> Choice | None:
        """The cheapest choice that may be within the tolerance."""
        open_parts = [[part.richest] if part.name in self.untried else
                      [form for form in part.forms] for part in self.parts]
        found = [Choice(forms, step) for forms in combinations(
            self.parts, open_parts, self.estimates, self.cost) for step in self.steps()]
        cheapest_first = sorted(found, key=self.cost.of)
        done = [one.choice for one in self.tried]
        return next((one for one in cheapest_first if one not in done
                     and not any(one.poorer(other) for other in self._failed)
                     and least(self.estimates.contributions(one)) <= self.tolerance), None)

    def _try(self, choice: Choice, kind: str) -> Tried:
        predicted = expected(self.estimates.contributions(choice))
        sentence, seconds, error, model = "", 0.0, np.inf, self.model
        try:
            model = self.builder.build(choice)
            sentence = "; ".join(self.builder.sentences(choice)) or "all as it is"
            run = self._run(choice, model)
            error, seconds = self._error(run), run.seconds
            self.estimates.learn(choice, error)
        except (InputError, SimulationError) as reason:
            sentence = f"{sentence}: {reason}"
        self.runs.table.append(Trial(sentence, choice.step.h, error, seconds, predicted,
                                     self.cost.of(choice), kind))
        found = Tried(choice, model, error, predicted, seconds)
        self.tried.append(found)
        return found

    def _confirmed(self, found: Tried) -> bool:
        """Whether the error stays within the tolerance with half the step."""
        half = found.choice._replace(step=Step(found.choice.step.h / 2))
        if half.step.h < self.runs.h / FINER[-1]:
            return True
        again = next((one for one in self.tried if one.choice == half), None) or self._try(
            half, "confirmation")
        return again.error <= self.tolerance
