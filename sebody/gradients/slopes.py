"""Derivatives by a parameter: of the residuals of all events in states that are held, of the start,
and of objectives beside what the motion changes.

The model is built with four values of the parameter, and evaluated in the recorded states: of
most parameters residuals are polynomials of at most the third degree, so that differences over
large steps are exact; of others the steps are small. Motions that are prescribed, and positions
that are fixed, follow the parameter. Nothing is integrated: these are no differences of runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple
from warnings import catch_warnings, simplefilter

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError, LimitWarning
from sebody.gradients.changed_residuals import ChangedResiduals, port_values
from sebody.gradients.course import Course
from sebody.gradients.history import RESTART, History
from sebody.gradients.parameters import Column
from sebody.gradients.start_rates import fitted_rates
from sebody.model.model import Model
from sebody.parameters.changes import Handle
from sebody.reduction.body import ReducedBody
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import STEPS, WEIGHTS

LARGE, SHORT = 0.25, 1e-3       # steps of differences, relative to the size of a parameter
POLYNOMIAL = 1e-8               # differences over one and two steps that agree like this are exact
SMOOTH = 1e-2                   # that agree worse are no differences of a smooth function
NOISE = 1e-8                    # of values: velocities of the start have so much
ROUNDED = 1e-13                 # of forces: what rounding may leave of residuals, which are sums
EQUAL = 1e-2                    # frequencies closer than this may change places in such steps
SOLVED = 1e-6                   # of velocities: difference of what is given from what is solved for
# in words, by field of `Slope`
ROUGH = {"residuals": "forces", "motion": "the positions at the start",
         "rates": "the velocities at the start", "objectives": "what is differentiated"}


class Slope(NamedTuple):
    """Derivatives by one number."""

    residuals: NDArray      # (events, n + k), and of the k numbers that laws keep; of the start
                            # with what its motion changes
    motion: NDArray         # (n,) of the start: positions, rotations
    rates: NDArray          # (n,)
    objectives: NDArray     # (m,) with the motion held


class Value(NamedTuple):
    """A model with one value of a parameter, in the states of a run."""

    residuals: NDArray
    motion: NDArray
    rates: NDArray
    objectives: NDArray
    rounding: float         # of the residuals


class Slopes:
    """Derivatives by the parameters of a model along a run.

    Parameters
    ----------
    model : Model
        Is changed for moments, and put back.
    run : Simulation
    history : History
    objectives : function
        Values of all objectives, (m,), of recorded rows and a simulation of the model that is
        changed; None where they do not depend on anything but motion.
    course : Course, optional
        Of the run, if it is of index 2 or has laws.
    """

    def __init__(self, model: Model, run: Simulation, history: History,
                 objectives: Callable[[Simulation, NDArray], NDArray],
                 course: Course | None = None):
        self.model, self.run, self.history, self.objectives = model, run, history, objectives
        self.held = ChangedResiduals(run, history, course)

    def of(self, column: Column) -> Slope:
        """Derivatives by a number of a parameter.

        Raises
        ------
        InputError
            The model cannot have values near its own.
        """
        handle, component, name = column.handle, column.component, column.name
        base = np.asarray(handle.base, dtype=float).ravel()
        if column.design:
            size = abs(base[component]) or float(np.abs(base).max()) or 1.0
        else:
            size = max(float(np.abs(base).max(initial=0.0)), self._least(name))
        if name.endswith("velocity") and self.history.past is None:
            self._check_given(column)
        try:
            values = [] if column.design else self._around(handle, component, LARGE * size)
            if values and not _disagreeing(values, POLYNOMIAL):
                return _slope(values, LARGE * size)
        except InputError:
            pass            # of small changes only
        try:
            values = self._around(handle, component, SHORT * size)
        except InputError as error:
            raise InputError(f"parameter {column.label}: the model cannot be changed by it alone, "
                             f"so there is no derivative: {error}") from error

        if rough := _disagreeing(values, SMOOTH, NOISE):
            raise InputError(f"parameter {column.label}: what the model has near its value is not "
                             f"smooth, so there is no derivative: {self._why(column, rough)}")
        return _slope(values, SHORT * size)

    def _why(self, column: Column, rough: str) -> str:
        """The reason why there is no derivative, as far as that is known, and what to do."""
        made = [name for name in column.bodies if self.model.bodies[name].reduced.modes]
        equal = {name: pair for name in made
                 if (pair := _equal_frequencies(self.model.bodies[name].reduced))}
        if equal:
            name, (first, second) = next(iter(equal.items()))
            return (f"frequencies {first:.5g} and {second:.5g} of body {name!r} are equal or "
                    "nearly so, where modes change places: make the frequencies differ, or hold "
                    "the modes, as sections(held_modes=True) does")
        return (f"differences of {ROUGH[rough]} over 0.1 % and 0.2 % of its size disagree: "
                + ("one of the modes of the bodies that are made anew may take the place of "
                   "another: keep more modes, or hold them" if made else
                   "the value may be where something begins or ends, as a contact or a limit: "
                   "give one to a side of it"))

    def _check_given(self, column: Column) -> None:
        """Refuse a velocity that the run solved for: where it is given, the run is another one."""
        try:
            given = self._at(column.handle, column.component, 0.0).rates
        except InputError:      # it contradicts others: refused with the reason where it is changed
            return
        solved = fitted_rates(self._made())
        if np.abs(given - solved).max(initial=0.0) > SOLVED * np.abs(solved).max(initial=0.0):
            raise InputError(f"parameter {column.label}: this velocity is not given, and the run "
                             f"begins with another than {inputs.shown(column.handle.base)}, which "
                             "was solved for as drives and other velocities ask for: give it by "
                             "model.initial_velocity")

    def _least(self, name: str) -> float:
        """Size of a parameter that may be zero."""
        return self.model.size() if name.endswith(".position") else 1.0

    def _around(self, handle: Handle, component: int, step: float) -> list[Value]:
        return [self._at(handle, component, at * step) for at in STEPS]

    def _at(self, handle: Handle, component: int, change: float) -> Value:
        value = np.array(handle.base, dtype=float)
        value.reshape(-1)[component] += change
        try:
            handle.set(value)
            return self._evaluated(self._made())
        finally:
            handle.reset()

    def _made(self) -> Simulation:
        """The model as it is now, at its start; of the run as it is, all was said."""
        with catch_warnings():
            simplefilter("ignore", LimitWarning)
            return Simulation(self.model, self.run.h, self.run.scheme)

    def by_load(self, port: int) -> Iterator[tuple[NDArray, NDArray, NDArray]]:
        """Derivatives of the residuals by the value of a power port, this value, and its times.

        Of index 2 by the value at the times of the events, and by that of look aheads.
        """
        made, ends = self._made(), self.history.ends
        start, values = made.state.now.copy(), np.zeros(len(ends))
        held, restarts = self.held, self.history.kinds == RESTART
        for ahead in (False, True) if held.unknowns > held.free else (False,):
            times = ends + held.second.aheads * restarts if ahead else ends
            port_values(made.system, made.state, port, times, self.history.besides, values)
            size = max(float(np.abs(values).max()), 1.0)
            found = []
            for change in (size, -size):
                made.state.now[:] = start
                load = port, change * (not ahead), change * ahead
                found.append(held.of(made, load, states=False).residuals)
            yield (found[0] - found[1]) / (2 * size), values.copy(), times

    def by_constants(self, place: int, rows: NDArray) -> NDArray:
        """Derivatives of the residuals by changes of a row of constants, (events, n, k).

        Parameters
        ----------
        place : int
            Where the row is in `System.constants`.
        rows : (k, numbers)
            Changes, of which residuals are linear functions.
        """
        made = self._made()
        start, own = made.state.now.copy(), slice(place, place + rows.shape[1])
        base = made.system.constants[own].copy()
        still = self.held.of(made).residuals
        found = np.zeros((*still.shape, len(rows)))
        for k, row in enumerate(rows):
            made.state.now[:] = start
            made.system.constants[own] = base + row
            found[..., k] = self.held.of(made).residuals - still
        made.system.constants[own] = base
        return found

    def _evaluated(self, made: Simulation) -> Value:
        if self.history.past is None:
            rates, motion = fitted_rates(made), self.held.turned(made.state)
        else:
            rates, motion = np.zeros(self.held.free), np.zeros(self.held.free)
        held = self.held.of(made)
        return Value(held.residuals, motion, rates,
                     self.objectives(made, held.states[self.history.recorded]),
                     ROUNDED * held.forces)


def _disagreeing(values: list[Value], closely: float, noise: float = 0.0) -> str:
    """Name of what has other differences over one step than over two, but for noise, or nothing.

    Residuals of a parameter that moves nothing, as the mass of a pendulum, are rounding.
    """
    for name in Slope._fields:
        f = [getattr(value, name) for value in values]
        one, two = (f[0] - f[1]) / 2, (f[2] - f[3]) / 4
        size = np.maximum(np.abs(one), np.abs(two)).max(initial=0.0)
        rounding = values[0].rounding if name == "residuals" else 0.0
        if np.abs(one - two).max(initial=0.0) > closely * size + rounding + noise * np.abs(
                f[0]).max(initial=0.0):
            return name
    return ""


def _equal_frequencies(body: ReducedBody) -> tuple[float, float] | None:
    """Two neighbouring frequencies of internal modes that are equal or nearly so."""
    own = slice(len(body.mass) - body.modes, None)
    squares = eigh(body.stiffness[own, own], body.mass[own, own], eigvals_only=True)
    omega = np.sqrt(np.maximum(squares, 0.0))
    close = np.flatnonzero(np.diff(omega) <= EQUAL * omega[1:])
    return (float(omega[close[0]]), float(omega[close[0] + 1])) if len(close) else None


def _slope(values: list[Value], step: float) -> Slope:
    return Slope(*(sum(w / step * getattr(value, name) for w, value in zip(
        WEIGHTS, values, strict=True)) for name in Slope._fields))
