"""What advice is: the model, its numbers, and all runs that led to it."""

from dataclasses import asdict, dataclass, field
from typing import NamedTuple

from sebody.model.model import Model


@dataclass(frozen=True)
class Trial:
    """A run of the search.

    Parameters
    ----------
    change : str
        What was changed, or why it did not run.
    step : float
        Its time step.
    error : float
        Largest relative error of the quantities; infinite of what did not run.
    seconds : float
        Time of the run in the compiled loop.
    predicted : float
        Error that was predicted before the run.
    cost : float
        Time that was predicted [s].
    kind : str
        What it was for: reference, alone, together, confirmation, default.
    local : float, optional
        Local tolerance of variable steps; then `step` is the grid.
    """

    change: str
    step: float
    error: float
    seconds: float
    predicted: float = 0.0
    cost: float = 0.0
    kind: str = "reference"
    local: float | None = None


class Reason(NamedTuple):
    """What was chosen on one axis, and why."""

    axis: str           # "beam" and so on; "step"
    chosen: str
    why: str
    predicted: float | None
    confirmed: float | None

    def __str__(self) -> str:
        numbers = [f"{word} {value:.1g}" for word, value in (
            ("predicted", self.predicted), ("confirmed", self.confirmed)) if value is not None]
        told = ", ".join([*[self.why] * bool(self.why), *numbers])
        return f"{self.axis}: {self.chosen}" + (f"; {told}" if told else "")


@dataclass(frozen=True, eq=False)
class Advice:
    """The cheapest model found that keeps the quantities.

    Parameters
    ----------
    model : Model
        It; the given one stays as it was.
    step : float
        Its time step, or the grid of its variable steps.
    changes : tuple of str
        What was changed, in sentences.
    error : float
        Largest relative error of the quantities, with that of the reference: confirmed.
    tolerance : float
    table : tuple of Trial
        All runs, in their order; the first is the reference.
    untried : tuple of str
        Parts that were left as they are because the search had taken long enough.
    """

    model: Model
    step: float
    changes: tuple[str, ...]
    error: float
    tolerance: float
    table: tuple[Trial, ...]
    untried: tuple[str, ...] = ()
    predicted: float = 0.0
    seconds: float = 0.0
    reasons: tuple[Reason, ...] = field(default=())
    remarks: tuple[str, ...] = ()

    def rows(self) -> list[dict]:
        """The table as plain dictionaries, which ``pandas.DataFrame`` takes."""
        return [asdict(one) for one in self.table]

    def summary(self) -> str:
        """What was chosen and why, the time it saves, and the error."""
        return "\n".join([
            *map(str, self.reasons),
            *([f"not tried: {', '.join(self.untried)}; raise the budget"] if self.untried else []),
            *self.remarks,
            f"predicted error {self.predicted:.2g}",
            f"confirmed error {self.error:.2g} <= {self.tolerance:g}"])
