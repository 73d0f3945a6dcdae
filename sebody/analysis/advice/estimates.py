"""What errors are expected: indicators, corrected by what runs have shown.

The error of a choice is the sum of what its forms and its step contribute. An indicator may be off
by `UNSURE`; once a run has shown what a contribution is, others of its kind are scaled alike, and
may be off by `SURE`. Measured contributions are taken as they are.
"""

from collections.abc import Hashable
from typing import NamedTuple

from sebody.analysis.advice.changes import Choice, Step
from sebody.analysis.advice.forms import Form, Part
from sebody.analysis.advice.indicators import contributions
from sebody.analysis.advice.indicators.recorded import Recorded

UNSURE = 30.0       # factor by which an indicator must exclude what is not tried
SURE = 3.0          # the same once a run has shown its scale
ORDER = 2           # of the time integration
SEEN = 1.2          # the same of a step that some choice was run with
CAUTION = 0.03      # least share of an error that its largest contribution is said to make


class Contribution(NamedTuple):
    """A part of an error, and the factor by which it may be smaller."""

    kind: Hashable
    error: float
    doubt: float


class Estimates:
    """Expected errors of choices.

    Parameters
    ----------
    recorded : Recorded
        The reference run.
    parts : list of Part
    step_errors : dict of float to float
        Measured errors of the richest model by its steps.
    """

    def __init__(self, recorded: Recorded, parts: list[Part], step_errors: dict[float, float]):
        self._recorded, self._parts, self._steps = recorded, parts, step_errors
        self._raw: dict[tuple[int, Form], dict[str, float]] = {}
        self._factors: dict[Hashable, float] = {}
        self._measured: dict[tuple[int, Form], float] = {}
        self._seen: dict[Step, float] = {}      # contributions of steps that were run

    def raw(self, k: int, form: Form) -> dict[str, float]:
        """What the indicators say of a form of the k-th part."""
        if (k, form) not in self._raw:
            part = self._parts[k]
            self._raw[k, form] = {} if form == part.richest else contributions(
                self._recorded, part, form)
        return self._raw[k, form]

    def of_form(self, k: int, form: Form) -> list[Contribution]:
        """Contributions of a form of the k-th part."""
        if (k, form) in self._measured:
            return [Contribution((k, form), self._measured[k, form], 1.0)]
        return [self._corrected((k, name), error) for name, error in self.raw(k, form).items()]

    def of_step(self, step: Step) -> list[Contribution]:
        """Contribution of a step."""
        if step in self._seen:
            return [Contribution(step, self._seen[step], SEEN)]
        h, error = min(self._steps.items(), key=lambda item: abs(item[0] - step.h))
        return [self._corrected("step", error * (step.h / h)**ORDER)]

    def _corrected(self, kind: Hashable, error: float) -> Contribution:
        known = kind in self._factors
        return Contribution(kind, self._factors.get(kind, 1.0) * error, SURE if known else UNSURE)

    def contributions(self, choice: Choice) -> list[Contribution]:
        """All contributions to the error of a choice."""
        return [*(one for k, form in enumerate(choice.forms) for one in self.of_form(k, form)),
                *self.of_step(choice.step)]

    def learn_form(self, k: int, form: Form, error: float) -> None:
        """Take the measured error of a form, tried alone."""
        self._learn(self.of_form(k, form), error)
        self._measured[k, form] = error

    def exclude(self, k: int, form: Form) -> None:
        """A form that does not run."""
        self._measured[k, form] = float("inf")

    def learn(self, choice: Choice, error: float) -> None:
        """Take the measured error of a choice."""
        found = self.contributions(choice)
        scaled = self._learn(found, error)
        step = next(one for one in found if one.kind in ("step", choice.step))
        if scaled == step.kind:
            self._seen[choice.step] = max(
                error - sum(one.error for one in found if one is not step), CAUTION * error)

    def _learn(self, found: list[Contribution], error: float) -> Hashable | None:
        """Scale the largest contribution that was not measured, so that the sum is the error."""
        open_ones = [one for one in found if one.doubt > 1.0 and one.error > 0.0]
        if not open_ones:
            return None
        largest = max(open_ones, key=lambda one: one.error)
        rest = sum(one.error for one in found) - largest.error
        share = max(error - rest, CAUTION * error)
        self._factors[largest.kind] = self._factors.get(largest.kind, 1.0) * share / largest.error
        return largest.kind


def expected(found: list[Contribution]) -> float:
    """Sum of contributions."""
    return sum(one.error for one in found)


def least(found: list[Contribution]) -> float:
    """The sum as small as it may be."""
    return sum(one.error / one.doubt for one in found)
