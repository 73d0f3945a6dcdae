"""Advice: the model, its numbers, and all runs that led to it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import NamedTuple

from sebody.basics.errors import InputError
from sebody.model.model import Model
from sebody.runs.tolerance import Tolerance

TRUSTED = 0.5       # of the tolerance, that the reference may be off by


@dataclass(frozen=True)
class Trial:
    """A run of the search.

    Parameters
    ----------
    change : str
        Forms of the parts and changes of the whole model, and why it did not run.
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
        What it was for: reference, alone, together, confirmation, given.
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


class Unreached(InputError):
    """No model within the tolerance; `advice` is the best there is."""

    def __init__(self, message: str, advice: "Advice"):
        super().__init__(message)
        self.advice = advice


class Reason(NamedTuple):
    """Choice of a part, of the whole model or of the run, and why.

    Parameters
    ----------
    of : str
        Name of the part; model or step.
    chosen, why : str
    predicted, confirmed : float, optional
        Errors that this alone makes.
    """

    of: str
    chosen: str
    why: str
    predicted: float | None = None
    confirmed: float | None = None

    def __str__(self) -> str:
        numbers = [f"{word} {value:.1g}" for word, value in (
            ("predicted", self.predicted), ("confirmed", self.confirmed)) if value is not None]
        told = ", ".join([*[self.why] * bool(self.why), *numbers])
        return f"{self.of}: {self.chosen}" + (f"; {told}" if told else "")


class Doubt(NamedTuple):
    """An error that the reference model itself may have: how large, why, and what helps.

    Where it was measured and is small, the errors of runs contain it.
    """

    error: float
    sentence: str
    remedy: str
    measured: bool = False


@dataclass(frozen=True, eq=False)
class Advice:
    """The cheapest model found that keeps the quantities.

    Parameters
    ----------
    model : Model
        It; the given one stays as it was.
    step : float
        Its time step, or the grid of its variable steps [time].
    changes : tuple of str
        What was changed, in sentences.
    error : float
        Largest relative error of the quantities, with that of the reference.
    tolerance : float
    table : tuple of Trial
        All runs, in their order; the first is the reference.
    untried : tuple of str
        Parts that were left as they are because the search had taken long enough.
    local : Tolerance, optional
        Of variable steps: the `tolerance` of `simulate`.
    predicted : float
        Error that was predicted before its run.
    seconds : float
        Time of its run [s].
    t_end : float
        End of its run [time].
    lines : tuple of str
        Calls of `sebody.model.variants` that make it from the given model.
    reasons : tuple of Reason
    remarks : tuple of str
        What was found besides: times, neighbours at other tolerances, limits.
    interrupted : bool
        Whether Ctrl-C ended the search: this is the best until then.
    doubts : tuple of Doubt
        Possible errors of the reference itself, the largest first: by theory in its bodies, by
        loads between its steps, by instability.
    warnings : tuple of str
        Of the runs of the reference and of the chosen model.
    kept : str
        What is kept how well, when it is worst, and what limits it, in a sentence.
    balanced : bool
        Whether runs start from equilibrium.
    """

    model: Model
    step: float
    changes: tuple[str, ...]
    error: float
    tolerance: float
    table: tuple[Trial, ...]
    untried: tuple[str, ...] = ()
    local: Tolerance | None = None
    predicted: float = 0.0
    seconds: float = 0.0
    t_end: float = 0.0
    lines: tuple[str, ...] = ()
    reasons: tuple[Reason, ...] = ()
    remarks: tuple[str, ...] = ()
    interrupted: bool = False
    doubts: tuple[Doubt, ...] = ()
    warnings: tuple[str, ...] = ()
    kept: str = ""
    balanced: bool = False

    @property
    def doubt(self) -> float:
        """Possible errors of the reference."""
        return max((one.error for one in self.doubts), default=0.0)

    @property
    def confirmed(self) -> bool:
        """Tell whether the error is within the tolerance, of a reference good to half of it."""
        return self.error <= self.tolerance and self.doubt <= TRUSTED * self.tolerance

    def __repr__(self) -> str:
        return self.summary()

    @property
    def trial(self) -> Trial:
        """The run of the table that was chosen."""
        local = None if self.local is None else self.local.relative
        return next(one for one in reversed(self.table)
                    if (one.error, one.step, one.local) == (self.error, self.step, local))

    def rows(self) -> list[dict]:
        """The table as plain dictionaries, which ``pandas.DataFrame`` takes."""
        return [asdict(one) for one in self.table]

    def code(self, given: Sequence[str]) -> str:
        """The model and its run as Python.

        Parameters
        ----------
        given : sequence of str
            Lines that make the given model, by the name ``model``, imports first.
        """
        names = sorted({line.partition("= ")[2].partition("(")[0] for line in self.lines})
        imports = [f"from sebody import {'Tolerance, ' * bool(self.local)}simulate",
                   *["from sebody.analysis import equilibrium"] * self.balanced]
        if names:
            imports.append(f"from sebody.model.variants import {', '.join(names)}")
        local = f", tolerance=Tolerance({self.local.relative!r})" if self.local else ""
        start = ", start=equilibrium(model)" * self.balanced
        run = f"result = simulate(model, {self.step!r}, {self.t_end!r}{local}{start})"
        own = [line for line in given if line.startswith(("from ", "import "))]
        return "\n".join([*own, *imports, "", *given[len(own):], *self.lines, run])

    def summary(self) -> str:
        """Choices and reasons, the time they save, and the error."""
        return "\n".join([
            *([self.kept] if self.kept else []),
            *map(str, self.reasons),
            *([f"not tried: {', '.join(self.untried)}; raise the budget"] if self.untried else []),
            *self.remarks,
            *(["interrupted: this is the best until then"] if self.interrupted else []),
            *(f"warning: {one}" for one in self.warnings),
            *(f"the reference model may itself be off by {one.error:.1g}: {one.sentence}; "
              f"{one.remedy}" for one in self.doubts if one.error > TRUSTED * self.tolerance),
            f"predicted error {self.predicted:.2g}", self._verdict()])

    def _verdict(self) -> str:
        """The last line."""
        if self.confirmed:
            return f"confirmed error {self.error:.2g} <= {self.tolerance:g}"
        if self.error > self.tolerance:
            return f"not confirmed: error {self.error:.2g} > {self.tolerance:g}"
        return (f"not confirmed: within {self.error:.2g} of the reference model, which may itself "
                f"be off by {self.doubt:.2g}")
