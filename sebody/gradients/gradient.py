"""Exact derivatives of what a run gives by what the model is made of."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, cast

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.warned import warn
from sebody.engine.state import Scheme
from sebody.gradients.history import History, history
from sebody.gradients.laws import refuse_break_away
from sebody.gradients.linear import Linear
from sebody.gradients.objectives import Folded, Objectives, Seen, checked
from sebody.gradients.parameters import Column, columns_at_values
from sebody.gradients.segments import Segments
from sebody.gradients.slopes import Slope, Slopes
from sebody.gradients.stabilized_course import course_of
from sebody.gradients.support import refuse_model, refuse_run
from sebody.gradients.sweeps import Adjoint, backward, forward
from sebody.gradients.tables import OfTable, Part, port_of, weights
from sebody.model.model import Model
from sebody.model.variants.copying import copied
from sebody.runs.outputs import Output
from sebody.runs.schemes import checked as checked_scheme, generalized_alpha
from sebody.runs.simulation import Simulation
from sebody.runs.steps import whole_steps
from sebody.runs.tolerance import Tolerance, given

CONVERGED = 1e-10       # of Newton's iteration: errors of gradients are a hundred times that
CHAOTIC = 1e6           # growth from which a run warns
MODES: tuple[Literal["adjoint", "forward"], ...] = "adjoint", "forward"


@dataclass(frozen=True, eq=False)
class Gradient:
    """Values of objectives, and their derivatives by parameters.

    Attributes
    ----------
    value : (m,)
        Of the objectives: components of vectors one after the other.
    matrix : (m, p)
        Derivatives of each by the numbers of the parameters, in the order given.
    rows, columns : tuple of str
        What these are of: ``"tip[1]"`` is the second component of the objective ``tip``.
    growth : float
        By how much the effect of a disturbance on the objectives grows in a run, told from one
        half: near one for ordinary runs, without bound for chaotic ones, whose derivatives are as
        large and hold in a range as small.
    seconds : float
        Of the whole, run included.
    run_seconds : float
        Of the run alone, where it is run for the first time.
    sweep_seconds : float
        Of the recursion back, or forth.
    """

    value: NDArray
    matrix: NDArray
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    growth: float = float("nan")
    seconds: float = 0.0
    run_seconds: float = 0.0
    sweep_seconds: float = 0.0

    def __repr__(self) -> str:
        return f"<Gradient of {len(self.rows)} values by {len(self.columns)} numbers>"

    def of(self, objective: str, parameter: str) -> NDArray:
        """Derivatives of one objective by one parameter, (components, numbers).

        Raises
        ------
        InputError
            Names that were not given.
        """
        found = [[k for k, label in enumerate(labels) if label.partition("[")[0] == name]
                 for labels, name in ((self.rows, objective), (self.columns, parameter))]
        if not all(found):
            raise InputError(f"the gradient has no derivatives of {objective!r} by {parameter!r}: "
                             f"it has those of {', '.join(self.rows)} by {', '.join(self.columns)}")
        return self.matrix[np.ix_(*found)]


def gradient(model: Model, h: float, t_end: float, objectives: Objectives,
             parameters: Sequence[str], mode: Literal["adjoint", "forward"] = "adjoint",
             tolerance: Tolerance | None = None, scheme: Scheme | None = None) -> Gradient:
    """Run a model, and differentiate what the run gives: exactly, without differences of runs.

    Parameters
    ----------
    model : Model
        Is copied.
    h, t_end : float
        Fixed step, and end of the run, a multiple of it [time].
    objectives : mapping
        By names of your choice what `final`, `at_time`, `integral`, `rms` or `soft_maximum` return.
    parameters : sequence of str
        Names as of an `Ensemble`: factors of loads, stiffness and mass count from 1.
    mode : {'adjoint', 'forward'}
        Backwards with a cost that grows with the number of objectives, or forwards with one that
        grows with that of parameters. Results are the same to rounding.
    tolerance : Tolerance, optional
        Variable steps: the sequence of accepted steps is held, and objectives are those over the
        states at their ends, one of which is at `t_end`.
    scheme : Scheme, optional
        `generalized_alpha` with rho 0.9 and a tolerance of 1e-10 by default; of index 3 with a
        fixed step, else of index 2, whose gradients are good to the order of the scheme.

    Raises
    ------
    InputError
        Unknown names, objectives without derivatives, features of the model that are not
        differentiated.
    SimulationError
        The run fails.

    Examples
    --------
    >>> found = gradient(model, 0.01, 5.0, {"tip": final("tip.position")},
    ...                  ["motor.amplitude", "beam.stiffness", "gravity"])
    >>> found.matrix.shape
    (3, 5)
    """
    mode = inputs.choice(mode, "mode", MODES)
    h = inputs.number(h, "h", above=0)
    t_end = h * whole_steps(inputs.number(t_end, "t_end", above=0), h)
    outputs = checked(objectives, t_end)
    inputs.instance(model, "model", Model, "give a sebody.Model")
    model = cast(Model, copied(model))      # which is changed for moments
    columns = columns_at_values(model, parameters)
    refuse_model(model)
    return differentiate(model, h, t_end, outputs, columns, mode,
                         fitting(scheme, given(tolerance)), tolerance)


def fitting(scheme: Scheme | None, tolerance: Tolerance | None = None) -> Scheme:
    """A scheme that converges far enough."""
    if scheme is not None:
        return checked_scheme(scheme)
    return generalized_alpha(tolerance=CONVERGED, index=3 if tolerance is None else 2)


class Differentiated:
    """A run with all its accepted steps, and what linearizes them."""

    def __init__(self, model: Model, h: float, t_end: float, scheme: Scheme,
                 tolerance: Tolerance | None = None):
        self.run = Simulation(model, h, scheme, tolerance=tolerance)
        refuse_run(self.run)
        self.history: History = history(self.run, t_end)
        refuse_break_away(self.run, self.history)
        self.run.watch.look(model, self.run.numbering, self.history.states)
        self.linear = Linear(self.run)
        self.course = course_of(self.run, self.linear, self.history)


def differentiate(model: Model, h: float, t_end: float, outputs: Mapping[str, Output],
                  columns: Sequence[Column], mode: str, scheme: Scheme,
                  tolerance: Tolerance | None = None) -> Gradient:
    """As `gradient`, of names that are checked; `columns` may count from other values."""
    began = time.perf_counter()
    run = Simulation(model, h, scheme, tolerance=tolerance)
    refuse_run(run)
    segments = Segments(run, t_end, [one.time for one in outputs.values() if one.time is not None])
    one = _Parts(model, segments, Folded(outputs, segments), columns)
    matrix, growth, seconds = (_adjoint if mode == "adjoint" else _forward)(one)
    if growth > CHAOTIC:
        warn(f"a disturbance of this run grows {growth:.1g} times in its effect on the objectives: "
             "the motion is unstable or chaotic, and its derivatives hold in a range as small; "
             "shorten the run, or take objectives over a shorter time")
    return Gradient(one.whole.value, matrix, tuple(one.whole.labels),
                    tuple(c.label for c in columns), growth, time.perf_counter() - began,
                    segments.seconds, seconds)


class _Part:
    """A segment of a run, and what is differentiated in it."""

    def __init__(self, one: _Parts, history: History):
        run = one.segments.run
        refuse_break_away(run, history)
        self.history, self.columns = history, one.columns
        self.course = course_of(run, one.linear, history)
        self.seen = Seen(one.whole, run, history, one.linear)
        self.slopes = Slopes(one.model, run, history, self.seen.explicit, self.course)
        self.tables: dict[str, OfTable] = {}    # and amplitudes of loads, by name
        names = {c.name: c for c in one.columns}
        ports = {name: (c, port_of(one.model, run, c)) for name, c in names.items()}
        for name, (column, port) in ports.items():
            if port is not None and one.whole.kinematic:    # objectives look at motion alone
                self.tables[name] = OfTable([
                    Part(residuals, weights(one.model, column, run.grid, history, *value))
                    for residuals, *value in self.slopes.by_load(port)])

    def slope(self, column: Column) -> Slope:
        """Derivatives by a number of a parameter."""
        if column.name in self.tables:
            return self.tables[column.name].slope(column.component, len(self.seen.whole.value),
                                                  self.course.linear.free)
        return self.slopes.of(column)

    def along(self, bars: Adjoint) -> NDArray:
        """Sums over the events for every parameter: (16)."""
        tables = {name: table.contracted(bars.weights) for name, table in self.tables.items()}
        found = np.zeros((len(self.seen.whole.value), len(self.columns)))
        for k, column in enumerate(self.columns):
            if column.name in tables:
                found[:, k] = tables[column.name][:, column.component]
                continue
            slope = self.slopes.of(column)
            found[:, k] = (np.einsum("emn,en->m", bars.weights, slope.residuals)
                           + bars.bars[0].T @ slope.motion + bars.bars[1].T @ slope.rates
                           + slope.objectives)
        return found

    def adding_to(self, found: NDArray, sizes: list[NDArray]) -> Callable[[int, NDArray], None]:
        """Function that adds states' derivatives to those of objectives, and sizes of motion."""
        linear = self.course.linear
        extent = linear.system.magnitude[:linear.free, None]

        def see(first: int, states: NDArray) -> None:
            sizes.append(np.abs(states[:, 0] * extent).max(axis=1))
            seeds, seeded = self.seen.of_events(first, first + len(states) - 1)
            found[:] += np.einsum("emcn,ecnp->mp", seeds[seeded], states[seeded])
        return see


class _Parts:
    """A run in segments, and what is differentiated."""

    def __init__(self, model: Model, segments: Segments, whole: Folded, columns: Sequence[Column]):
        self.model, self.segments, self.whole, self.columns = model, segments, whole, columns
        self.linear = Linear(segments.run)


def _adjoint(one: _Parts) -> tuple[NDArray, float, float]:
    """One sweep back over the segments, and sums in each of them."""
    found = np.zeros((len(one.whole.value), len(one.columns)))
    bars, seconds = None, 0.0
    sizes: list[NDArray] = []
    for segment in one.segments.back():
        part = _Part(one, segment)
        began = time.perf_counter()
        swept = backward(part.course, part.seen, len(found), bars)
        seconds += time.perf_counter() - began
        found += part.along(swept)
        bars, sizes = swept.bars, [swept.sizes, *sizes]
    return found, _growth(np.concatenate(sizes)), seconds


def _growth(sizes: NDArray) -> float:
    """Square of the growth in the first half of a run, going back, of what is not zero.

    An integral sums up effects that are nothing at its end: the last of them is no measure.
    """
    seen = sizes[sizes > 0]
    return float((seen.max() / seen[len(seen) // 2:].max()) ** 2) if len(seen) else 1.0


def _forward(one: _Parts) -> tuple[NDArray, float, float]:
    """One sweep forth over the segments, with a column for every parameter."""
    found = np.zeros((len(one.whole.value), len(one.columns)))
    now, seconds = None, 0.0
    sizes: list[NDArray] = []
    for segment in one.segments.forth():
        part = _Part(one, segment)
        each = [part.slope(column) for column in one.columns]
        given, began = stacked(each), time.perf_counter()
        now = forward(part.course, *given, part.adding_to(found, sizes), now)
        seconds += time.perf_counter() - began
        found += np.stack([slope.objectives for slope in each], axis=1)
    return found, _growth_forth(np.concatenate(sizes)), seconds


def _growth_forth(sizes: NDArray) -> float:
    """Square of the growth in the second half of a run, of the column that grows least.

    In a chaotic run all columns grow alike; those that begin to act late say nothing.
    """
    quarter, half, end = (len(sizes) // 4, len(sizes) // 2, len(sizes))
    old = (sizes[quarter] > 0) & (sizes[half] > 0)
    if not old.any():
        return float("nan")
    return float((sizes[half:end, old].max(axis=0) / sizes[half, old]).min() ** 2)


def stacked(each: Sequence[Slope]) -> tuple[NDArray, NDArray, NDArray]:
    """Slopes of residuals with what laws keep, of motion and rates of the start; by all parameters,
    these last.
    """
    residuals, motion, rates = (np.stack([getattr(slope, name) for slope in each], axis=-1)
                                for name in ("residuals", "motion", "rates"))
    return residuals, motion, rates
