"""How much of a model some quantities need: bodies that may be rigid, internal modes, the step.

Every variant runs, and its quantities are compared with those of the whole model at a fine step.
Bodies are tried one at a time, from the poorest variant up, at the fine step; what is enough alone
is put together, and what errs most is taken back until the whole is enough. Then comes the step.
"""

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.analysis.simulation import simulate
from sebody.errors import InputError, LimitWarning, SimulationError
from sebody.model.model import Model
from sebody.model.variants import Variant, keep_modes, rigid

FINE = 4            # the fine step is so many times shorter than the given one
STEPS = (4, 2, 1)   # longer steps that are tried, longest first, relative to the given one
SHARE = 0.5         # of the tolerance is for the model, the rest for the step
ORDER = 2           # of the time integration

Change = Callable[[Model], Variant]


@dataclass(frozen=True)
class Trial:
    """A variant that was run.

    Parameters
    ----------
    change : str
        What was changed, or why it did not run.
    step : float
        Its time step.
    error : float
        Largest relative error of the quantities; infinite of what did not run.
    seconds : float
        Time of the run.
    """

    change: str
    step: float
    error: float
    seconds: float


@dataclass(frozen=True, eq=False)
class Advice:
    """The poorest model found that keeps the quantities.

    Parameters
    ----------
    model : Model
        It; the given one stays as it was.
    step : float
        Longest time step found.
    changes : tuple of str
        What was changed, in sentences.
    error : float
        Largest relative error of the quantities, with that of the reference.
    tolerance : float
    table : tuple of Trial
        All runs, in their order; the first is the reference.
    untried : tuple of str
        Bodies that were left as they are because the search had taken long enough.
    """

    model: Model
    step: float
    changes: tuple[str, ...]
    error: float
    tolerance: float
    table: tuple[Trial, ...]
    untried: tuple[str, ...] = ()

    def summary(self) -> str:
        """The changes, the time they save, and the error."""
        reference, chosen = self.table[0], self.table[-1]
        return "\n".join([
            *self.changes,
            *([f"not tried: {', '.join(self.untried)}; raise the budget"] if self.untried else []),
            f"step {self.step:g}",
            f"a run takes {chosen.seconds:.3g} s, the reference {reference.seconds:.3g} s; "
            f"{len(self.table)} runs",
            f"confirmed error {self.error:.2g} <= {self.tolerance:g}"])


def advise(model: Model, h: float, t_end: float, quantities: str | Iterable[str],
           tolerance: float = 1e-3, budget: float = 20.0) -> Advice:
    """Find which bodies may be rigid, how many modes others need, and which step is enough.

    Parameters
    ----------
    model : Model
        The richest that is of interest, with all modes.
    h : float
        A usual time step [time]; the reference has a quarter of it.
    t_end : float
        End of the runs, a whole number of steps [time].
    quantities : str or iterable of str
        Names as results have them. The error of a quantity is its largest difference, relative to
        its largest change from the start.
    tolerance : float
        Largest error.
    budget : float
        No further body is tried once the runs have taken so many times the time of the first.

    Returns
    -------
    Advice

    Raises
    ------
    InputError
        Quantities that do not exist or do not change, or a tolerance that the whole model does not
        reach with the fine step.
    SimulationError
        The whole model does not run.
    """
    inputs.instance(model, "model", Model, "give a sebody.Model")
    names = [quantities] if isinstance(quantities, str) else inputs.items(
        quantities, "quantities", "give names of quantities")
    h, t_end = inputs.number(h, "h", above=0), inputs.number(t_end, "t_end", above=0)
    if not np.isclose(t_end / h, round(t_end / h), rtol=1e-9, atol=0):
        raise InputError(f"t_end is {t_end:g}, {t_end / h:.6g} steps of {h:g}: give a whole number "
                         "of steps")
    search = _Search(h, t_end, names, inputs.number(tolerance, "tolerance", above=0, below=1))
    budget = inputs.number(budget, "budget", above=0)
    search.start(model)
    changes, untried = {}, []
    for name in model.bodies:
        if search.spent() > budget:
            untried.append(name)
        elif found := _enough(search, model, name):
            changes[name] = found
    return replace(_together(search, model, changes), untried=tuple(untried))


@dataclass
class _Search:
    """The runs so far, and what they are compared with."""

    h: float
    t_end: float
    names: list[str]
    tolerance: float
    table: list[Trial] = field(default_factory=list)
    reference: list[NDArray] = field(default_factory=list)
    own_error: float = 0.0      # of the reference

    def start(self, model: Model) -> None:
        """Run the reference, and its model with twice the step for the reference's error."""
        fine = self.h / FINE
        self.reference, seconds = self._run(model, fine, FINE)
        for name, values in zip(self.names, self.reference, strict=True):
            if not np.ptp(values, axis=0).any():
                raise InputError(f"quantity {name!r} does not change: give one that the motion "
                                 "changes")
        self.table.append(Trial("all as it is", fine, 0.0, seconds))
        other, seconds = self._run(model, 2 * fine, FINE // 2)
        difference = self._difference(other, 1)
        self.table.append(Trial("all as it is", 2 * fine, difference, seconds))
        self.own_error = difference / (2**ORDER - 1)
        if self.own_error > SHARE * self.tolerance:
            raise InputError(f"with the step {fine:g} the whole model has an error of about "
                             f"{self.own_error:.2g} from the step: give a smaller h, or a larger "
                             f"tolerance than {self.tolerance:g}")

    def spent(self) -> float:
        """Time of all runs, relative to that of the reference."""
        return sum(trial.seconds for trial in self.table) / self.table[0].seconds

    def error(self, model: Model, change: str, step: float) -> float:
        """Error of a variant that is run, with that of the reference."""
        multiple = max(round(step / self.h), 1)
        try:
            found, seconds = self._run(model, step, max(round(self.h / step), 1))
            error = self._difference(found, multiple) + self.own_error
        except (InputError, SimulationError) as reason:
            change, error, seconds = f"{change}: {reason}", np.inf, 0.0
        self.table.append(Trial(change, step, error, seconds))
        return error

    def _run(self, model: Model, step: float, every: int) -> tuple[list[NDArray], float]:
        with warnings.catch_warnings():         # of variants that are taken, none is poor
            warnings.simplefilter("ignore", LimitWarning)
            result = simulate(model, step, self.t_end, output_every=every)
        return ([np.asarray(result[name]) for name in self.names],
                result.microseconds_per_step * result.steps * 1e-6)

    def _difference(self, found: list[NDArray], multiple: int) -> float:
        errors = []
        for name, one, whole in zip(self.names, found, self.reference, strict=True):
            if one.shape[1:] != whole.shape[1:]:
                raise InputError(f"quantity {name!r} has fewer components")
            axes = tuple(range(1, whole.ndim))
            size = np.sqrt(((whole - whole[0])**2).sum(axis=axes)).max()
            off = np.sqrt(((one - whole[::multiple])**2).sum(axis=axes)).max()
            errors.append(off / size)
        return max(errors)


def _enough(search: _Search, model: Model, name: str) -> tuple[float, Change] | None:
    """Error and change of the poorest variant of a body that is enough, tried alone."""
    def with_modes(count: int) -> Change:
        return lambda model: keep_modes(model, name, count)
    most = model.bodies[name].body.modes
    counts = dict.fromkeys([0, *(2**k for k in range(most.bit_length()))])
    for change in (lambda model: rigid(model, name), *(with_modes(n) for n in counts if n < most)):
        try:
            found = change(model)
        except InputError as reason:
            search.table.append(Trial(str(reason), search.h / FINE, np.inf, 0.0))
            continue
        error = search.error(found.model, found.change, search.h / FINE)
        if error <= SHARE * search.tolerance:
            return error, change
    return None


def _together(search: _Search, model: Model, changes: dict[str, tuple[float, Change]]) -> Advice:
    """What is enough together, and the longest step."""
    while True:
        found, sentences = _changed(search, model, changes)
        whole = "; ".join(sentences) or "all as it is"
        if len(sentences) < 2 or search.error(found, whole, search.h / FINE) <= (
                SHARE * search.tolerance):
            break
        del changes[max(changes, key=lambda name: changes[name][0])]
    count = round(search.t_end / search.h)
    steps = [k * search.h for k in STEPS if count % k == 0]
    for step in (*steps, search.h / 2, search.h / FINE):
        error = search.error(found, whole, step)
        if error <= search.tolerance:
            break
    return Advice(found, step, tuple(sentences), error, search.tolerance, tuple(search.table))


def _changed(search: _Search, model: Model, changes: dict[str, tuple[float, Change]]
             ) -> tuple[Model, list[str]]:
    """The model with all changes, and their sentences; those are left out that exclude another."""
    sentences = []
    for name, (_, change) in list(changes.items()):
        try:
            model, sentence = change(model)
            sentences.append(sentence)
        except InputError as reason:
            search.table.append(Trial(str(reason), search.h / FINE, np.inf, 0.0))
            del changes[name]
    return model, sentences
