"""The advised model as a point of a chart."""

from typing import NamedTuple

from sebody.basics.errors import SebodyError
from sebody.explore.advice import Advice, advise
from sebody.explore.advice.changes import Step
from sebody.model.model import Model

FAMILY = "advised"
MOST = 160      # characters of a reason


class Advised(NamedTuple):
    """Advice, or why there is none; `told` is a sentence for the chart."""

    advice: Advice | None
    told: str

    @property
    def step(self) -> Step:
        """Step of its run."""
        local = None if self.advice.local is None else self.advice.local.relative
        return Step(self.advice.step, local)

    @property
    def label(self) -> str:
        """The model in brief."""
        local = ", variable steps" if self.advice.local else ""
        return f"advised: {self.advice.trial.change}; step {self.advice.step:g}{local}"


def advised(model: Model, h: float, t_end: float, quantities: list[str],
            tolerance: float) -> Advised:
    """Advice for a chart; a scene may have none."""
    try:
        advice = advise(model, h, t_end, quantities, tolerance)
    except SebodyError as reason:
        text = str(reason)
        return Advised(None, f"no model is advised at {tolerance:g}: "
                       + (text if len(text) <= MOST else f"{text[:MOST]} ..."))
    return Advised(advice, f"advised: the cheapest model that `advise` found for {tolerance:g}"
                   + ("" if advice.confirmed else ", not confirmed"))
