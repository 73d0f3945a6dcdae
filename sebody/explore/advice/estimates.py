"""Expected errors: indicators, corrected by what runs have shown.

The error of a choice is the root of the sum of squares of what its forms and its step contribute,
which have different directions and times. An indicator may be off
by `UNSURE`; once a run has shown what a contribution is, others of its kind are scaled alike, and
may be off by `SURE`, or by `SHARED` where several made the error of the run. Measured contributions
are taken as they are.
"""

from collections.abc import Hashable
from typing import NamedTuple

import numpy as np

from sebody.explore.advice.axes import indicated
from sebody.explore.advice.changes import Choice, Step
from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.recorded import Recorded

UNSURE = 30.0       # factor by which an indicator must exclude what is not tried
SURE = 3.0          # the same once a run has shown its scale
ORDER = 2           # of the time integration
SEEN = 1.2          # the same of a step that one choice was run with, and of what was an error
SHARED = 10.0       # the same where it was a part of an error among others
KNOWN = 0.1         # share of an error from which the scale of a contribution is known
ALONE = 0.5         # of it, that no other one exceeds where it made the error alone
HALVINGS = 80       # of the range of a factor, in logarithms
CAUTION = 0.03      # least share of an error that what was not measured is said to make


class Contribution(NamedTuple):
    """A part of an error, and the factor by which it may be smaller."""

    kind: Hashable
    error: float
    doubt: float
    raw: float = 0.0        # what the indicator says


class Estimates:
    """Expected errors of choices.

    Parameters
    ----------
    recorded : Recorded
        The reference run.
    parts : list of Part
    step_errors : dict of Step to float
        Measured errors of the reference model by its steps.
    """

    def __init__(self, recorded: Recorded, parts: list[Part], step_errors: dict[Step, float]):
        self.recorded, self._parts, self._steps = recorded, parts, step_errors
        self._raw: dict[tuple[int, Form], dict[str, float]] = {}
        self._factors: dict[Hashable, float] = {}
        self._combined: dict[tuple[Form, ...], float] = {}
        self._main: set[tuple[Hashable, float]] = set()     # contributions that made an error
        self._doubts: dict[Hashable, float] = {}
        self._measured: dict[tuple[int, Form], float] = {}
        self._seen: dict[Step, list[float]] = {}      # contributions of steps that were run

    def raw(self, k: int, form: Form) -> dict[str, float]:
        """Indicated errors of a form of the k-th part."""
        if (k, form) not in self._raw:
            part = self._parts[k]
            self._raw[k, form] = {} if form == part.detailed else indicated(
                self.recorded, part, form)
        return self._raw[k, form]

    def confirmed(self, k: int, form: Form) -> float | None:
        """The measured error of a form tried alone."""
        return self._measured.get((k, form))

    def measured(self, k: int) -> bool:
        """Tell whether a form of the k-th part was tried."""
        return any(place == k for place, _ in self._measured)

    def of_form(self, k: int, form: Form) -> list[Contribution]:
        """Contributions of a form of the k-th part."""
        if (k, form) in self._measured:
            return [Contribution((k, form), self._measured[k, form], 1.0)]
        return [self._corrected((k, name), error) for name, error in self.raw(k, form).items()]

    def of_step(self, step: Step) -> list[Contribution]:
        """Contribution of a step."""
        if step in self._steps and step.local is None and step not in self._seen:
            return [Contribution(step, float(self._steps[step]), SURE)]
        if step in self._seen:
            errors = self._seen[step]
            return [Contribution(step, errors[-1], SEEN if len(errors) == 1 else 1.0)]
        known = {one: error for one, error in self._steps.items()
                 if (one.local is None) == (step.local is None)}
        if not known:
            return [Contribution(step, float("inf"), 1.0)]
        if step.local is None:
            one = min(known, key=lambda other: abs(np.log(other.h / step.h)))
            return [self._corrected("step", known[one] * (step.h / one.h)**ORDER)]
        one = min(known, key=lambda other: abs(np.log(other.local / step.local)))
        return [self._corrected("variable steps", known[one] * (
            step.local / one.local)**(ORDER / (ORDER + 1)))]

    def learn_step(self, step: Step, error: float) -> None:
        """Take the measured error of the reference model with a step."""
        self._steps[step] = error

    def _corrected(self, kind: Hashable, error: float) -> Contribution:
        doubt = SEEN if (kind, error) in self._main else self._doubts.get(kind, UNSURE)
        return Contribution(kind, self._factors.get(kind, 1.0) * error, doubt, error)

    def contributions(self, choice: Choice) -> list[Contribution]:
        """All contributions to the error of a choice."""
        if choice.forms in self._combined:
            listed = [Contribution(choice.forms, self._combined[choice.forms], 1.0)]
        else:
            listed = [one for k, form in enumerate(choice.forms) for one in self.of_form(k, form)]
        return [*listed, *self.of_step(choice.step)]

    def learn_form(self, k: int, form: Form, error: float) -> None:
        """Take the measured error of a form, tried alone; infinite if it does not run."""
        if error < float("inf"):
            self._learn(self.of_form(k, form), error)
        self._measured[k, form] = error

    def learn(self, choice: Choice, error: float) -> None:
        """Take the measured error of a choice.

        What a fixed step that the reference model ran with does not explain is that of its forms
        together.
        """
        contributions = self.contributions(choice)
        step, rest = contributions[-1], expected(contributions[:-1])
        known = choice.step in self._steps and choice.step.local is None
        if known and error - SEEN * step.error > SURE * rest:
            self._combined[choice.forms] = error - step.error
            return
        self._learn(contributions, error)
        if step.error > expected(contributions) / 2:
            self._seen.setdefault(choice.step, []).append(_rest(error, rest))

    def _learn(self, found: list[Contribution], error: float) -> None:
        """Scale what was not measured, the larger the more, so that all is the error."""
        open_ones = [one for one in found if one.doubt > 1.0 and one.error > 0.0]
        if not open_ones:
            return
        measured = expected([one for one in found if one not in open_ones])
        wanted, largest = _rest(error, measured), max(one.error for one in open_ones)
        shares = [one.error / largest for one in open_ones]
        alone = sorted(shares)[-2:][0] < ALONE or len(shares) == 1
        power = _power([one.error for one in open_ones], shares, wanted)
        for one, share in zip(open_ones, shares, strict=True):
            scaled = one.error * power**share
            self._factors[one.kind] = self._factors.get(one.kind, 1.0) * power**share
            if scaled > KNOWN * wanted:
                doubt = SURE if alone and share == 1.0 else SHARED
                if doubt == SURE:
                    self._main.add((one.kind, one.raw))
                self._doubts[one.kind] = min(self._doubts.get(one.kind, UNSURE), doubt)


def _power(errors: list[float], shares: list[float], wanted: float) -> float:
    """The factor that, to the power of its share on each error, makes all what is wanted."""
    low, high = 1e-12, 1e12
    for _ in range(HALVINGS):
        middle = (low * high)**0.5
        total = sum((error * middle**share)**2 for error, share in zip(errors, shares, strict=True))
        low, high = (middle, high) if total < wanted**2 else (low, middle)
    return low


def _rest(error: float, measured: float) -> float:
    """Rest of an error without a part that was measured."""
    return max(float(np.sqrt(max(error**2 - measured**2, 0.0))), CAUTION * error)


def expected(found: list[Contribution]) -> float:
    """Contributions together."""
    return float(np.sqrt(sum(one.error**2 for one in found)))


def least(found: list[Contribution]) -> float:
    """The same as small as it may be."""
    return float(np.sqrt(sum((one.error / one.doubt)**2 for one in found)))
