"""What a parameter changes: of the residuals of all events in states that are held, of the start,
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

from sebody.compiler.decorators import compiled
from sebody.contract.layout import ACCELERATION, OK, RESIDUAL
from sebody.engine.evaluate import assemble, move_prescribed, set_loads, set_loads_beside
from sebody.engine.links import place_dependent
from sebody.engine.state import REASONS
from sebody.errors import InputError, LimitWarning
from sebody.explore.ensembles.changes import Handle
from sebody.gradients.history import RESTART, History
from sebody.gradients.laws import in_changed
from sebody.gradients.parameters import Column
from sebody.gradients.second_residuals import of_restart, of_step
from sebody.gradients.stabilized import Second
from sebody.gradients.start_rates import fitted_rates
from sebody.gradients.sweeps import Course
from sebody.kernels.abi import pointer_to
from sebody.kernels.rotations import rotate
from sebody.model.model import Model
from sebody.results import rotations
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import STEPS, WEIGHTS

LARGE, SHORT = 0.25, 1e-3       # steps of differences, relative to the size of a parameter
POLYNOMIAL = 1e-8               # differences over one and two steps that agree like this are exact
SMOOTH = 1e-2                   # that agree worse are no differences of a smooth function
NOISE = 1e-8                    # of values: velocities of the start have so much


Load = tuple[int, float, float]     # a power port, a change of its value, one in look aheads
NO_LOAD = -1, 0.0, 0.0
NONE, NO_ROWS = np.zeros(0), np.zeros((0, 0))
NOTHING = Second(NONE, NONE, NO_ROWS, NONE, NO_ROWS, 0)     # of index 3


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


@compiled
def _drive(system, state, kind, end, beside, free, load):
    """Loads at the next event, and the prescribed coordinates: rotations from the event before."""
    port, change, _ = load
    for i in range(state.loads.size):
        state.loads_old[i] = state.loads[i]
    set_loads_beside(system, state.frames, state.loads, end, beside)
    if port >= 0:
        state.loads[3 * port] += change
    move_prescribed(system, state)
    if kind == RESTART:
        return
    for r in range(system.rotation_at.size):
        at = system.rotation_at[r]
        if at >= free:
            for i in range(9):
                state.R_old[9 * r + i] = state.R[9 * r + i]
            rotate(pointer_to(state.R_old), 9 * r, state.dq[at], state.dq[at + 1],
                   state.dq[at + 2], pointer_to(state.R), 9 * r)


@compiled
def _drive_on(system, state, kinds, ends, besides, free, load):
    """The same over all events before a segment, whose states are not looked at."""
    for e in range(1, kinds.size):
        _drive(system, state, kinds[e], ends[e], besides[e], free, load)


@compiled(nogil=True)
def _residuals(system, state, rows, now, kinds, ends, besides, places, free, load, second, found):
    """Residuals of all events but the first; fixed and prescribed coordinates are the model's own.

    `now` are states of this model, as many as are asked for: motion of the unknowns is that of the
    run. The load of a power port may be changed, `load` being the port, the change, and the change
    in look aheads. `second` are numbers of second residuals, of index 2, or `NOTHING`.
    """
    q, R, v, a, frames, frames_old = places
    by_rates, by_seconds, shifts, aheads, corrections, restarts = second
    for e in range(1, rows.shape[0]):
        for i in range(state.frames.size):
            state.frames[i], state.frames_old[i] = rows[e, frames + i], rows[e, frames_old + i]
        _drive(system, state, kinds[e], ends[e], besides[e], free, load)
        for i in range(free):
            state.q[i], state.v[i], state.a[i] = rows[e, q + i], rows[e, v + i], rows[e, a + i]
        for r in range(system.rotation_at.size):
            if system.rotation_at[r] < free:
                for i in range(9):
                    state.R[9 * r + i] = rows[e, R + 9 * r + i]
        place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
        of_others = ACCELERATION if kinds[e] == RESTART else RESIDUAL
        status = assemble(RESIDUAL, of_others, system, state, state.residual)
        if status != OK:
            return status
        for i in range(q, now.shape[1] if e < now.shape[0] else 0):
            now[e, i] = state.now[i]
        for i in range(free):
            found[e, i] = state.residual[i]
        if by_rates.size > 0 and kinds[e] == RESTART:
            status = of_restart(system, state, corrections[restarts], aheads[e], ends[e],
                                besides[e], load, found[e, free:])
            restarts += 1
        elif by_rates.size > 0:
            status = of_step(system, state, shifts[e], by_rates[e], by_seconds[e], found[e])
        if status != OK:
            return status
    return OK


@compiled(nogil=True)
def _values(system, state, port, ends, besides, found):
    """Value of a power port at all events."""
    for e in range(ends.size):
        set_loads_beside(system, state.frames, state.loads, ends[e], besides[e])
        found[e] = state.loads[3 * port]


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
        self.free = run.numbering.free
        parts = run.state.recorded_parts
        self.places = tuple(parts[name].start for name in ("q", "R", "v", "a", "frames",
                                                           "frames_old"))
        self.start = history.rows[0]        # of the run, or of a segment
        self.second = course.second if course and course.second else NOTHING
        self.unknowns = self.free if course is None else course.unknowns
        self.products, self.kept = (None, 0) if course is None else (course.products, course.kept)

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
        try:
            values = [] if column.design else self._around(handle, component, LARGE * size)
            if values and _agree(values, POLYNOMIAL):
                return _slope(values, LARGE * size)
        except InputError:
            pass            # of small changes only
        try:
            values = self._around(handle, component, SHORT * size)
        except InputError as error:
            raise InputError(f"parameter {column.label}: the model cannot be changed by it alone, "
                             f"so there is no derivative: {error}") from error

        if not _agree(values, SMOOTH, NOISE):
            raise InputError(f"parameter {column.label}: what the model has near its value is not "
                             "smooth, as where frequencies of a body are equal and modes change "
                             "places, so there is no derivative: keep more modes, or make the "
                             "frequencies differ")
        return _slope(values, SHORT * size)

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
        for ahead in (False, True) if self.unknowns > self.free else (False,):
            times = ends + self.second.aheads * (self.history.kinds == RESTART) if ahead else ends
            _values(made.system, made.state, port, times, self.history.besides, values)
            size = max(float(np.abs(values).max()), 1.0)
            found = []
            for change in (size, -size):
                made.state.now[:] = start
                found.append(self._along(made, (port, change * (not ahead), change * ahead),
                                         False)[0])
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
        still = self._along(made)[0]
        found = np.zeros((*still.shape, len(rows)))
        for k, row in enumerate(rows):
            made.state.now[:] = start
            made.system.constants[own] = base + row
            found[..., k] = self._along(made)[0] - still
        made.system.constants[own] = base
        return found

    def _evaluated(self, made: Simulation) -> Value:
        if self.history.past is None:
            rates, motion = fitted_rates(made), self._turned(made.state)
        else:
            rates, motion = np.zeros(self.free), np.zeros(self.free)
        found, now = self._along(made)
        return Value(found, motion, rates, self.objectives(made, now[self.history.recorded]))

    def _along(self, made: Simulation, load: Load = NO_LOAD, states: bool = True
               ) -> tuple[NDArray, NDArray]:
        """Residuals of all events, and the states of this model that they are of if asked for."""
        system, state, history = made.system, made.state, self.history
        found = np.zeros((len(history.rows), self.unknowns + self.kept))
        now = history.rows[:len(history.rows) if states else 1].copy()
        if history.past is None:
            self._first(made, load, found[0])
            if states:
                self._follow(made, state.now[None].copy(), found, 0, 1)
            self._hold_start(made)
            now[0] = state.now
        else:
            set_loads(system, state.frames, state.loads, 0.0)
            _drive_on(system, state, history.past.kinds, history.past.ends, history.past.besides,
                      self.free, load)
        status = _residuals(system, state, history.rows, now, history.kinds, history.ends,
                            history.besides, self.places, self.free, load, self.second, found)
        if status != OK:
            raise InputError(f"a state cannot be evaluated: {REASONS[status]}")
        if states:
            self._follow(made, now[1:], found, 1, len(now))
        return found, now

    def _follow(self, made: Simulation, now: NDArray, found: NDArray, first: int, last: int
                ) -> None:
        """Let laws stay in the branches of the run: see `laws.in_changed`."""
        if not self.kept:
            return
        (system, state), history, piece = self.run.arrays_of_loop, self.history, slice(first, last)
        status = in_changed(system, state, self.products, made.system, made.state,
                            history.rows[piece], now, history.ends[piece], history.besides[piece],
                            found[piece])
        if status != OK:
            raise InputError(f"a state cannot be evaluated: {REASONS[status]}")

    def _first(self, made: Simulation, load: Load, found: NDArray) -> None:
        """Residual of the start with accelerations and multipliers of the run."""
        system, state, n = made.system, made.state, self.free
        q, _, v, a, *_ = self.places
        fixed = system.is_multiplier[:n] > 0
        state.a[:n] = self.start[a:a + n]
        state.q[:n][fixed] = self.start[q:q + n][fixed]
        set_loads(system, state.frames, state.loads, 0.0)
        if load[0] >= 0:
            state.loads[3 * load[0]] += load[1]
        state.loads_old[:] = state.loads
        kept = state.R.copy()
        move_prescribed(system, state)
        state.R[:] = kept
        place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
        status = assemble(RESIDUAL, ACCELERATION, system, state, state.residual)
        if status != OK:
            raise InputError(f"the start cannot be evaluated: {REASONS[status]}")
        found[:n] = state.residual[:n]
        if self.unknowns > n and of_restart(
                system, state, self.second.corrections[0], self.second.aheads[0], 0.0, 0.0, load,
                found[n:]) != OK:
            raise InputError("the start cannot be evaluated a short time later")

    def _hold_start(self, made: Simulation) -> None:
        """Put a changed model in the motion that the run starts with.

        What a parameter changes of that is in `Slope.motion` and `Slope.rates`.
        """
        system, state, n = made.system, made.state, self.free
        q, R, v, _, frames, frames_old = self.places
        state.q[:n], state.v[:n] = self.start[q:q + n], self.start[v:v + n]
        free = np.repeat(system.rotation_at < n, 9)
        state.R[free] = self.start[R:R + len(state.R)][free]
        state.frames[:] = self.start[frames:frames + len(state.frames)]
        state.frames_old[:] = self.start[frames_old:frames_old + len(state.frames_old)]
        place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
        status = assemble(RESIDUAL, ACCELERATION, system, state, state.residual)
        if status != OK:
            raise InputError(f"the start cannot be evaluated: {REASONS[status]}")

    def _turned(self, state) -> NDArray:
        """Motion from the start of the run to that of a changed model: of rotations a vector."""
        q, R, *_ = self.places
        n = self.free
        found = state.q[:n] - self.start[q:q + n]
        found[self.run.system.is_multiplier[:n] > 0] = 0.0
        for r, at in enumerate(self.run.system.rotation_at):
            if at < n:
                own, other = (x[9 * r:9 * r + 9].reshape(3, 3) for x in (
                    self.start[R:R + len(state.R)], state.R))
                found[at:at + 3] = rotations.vectors((own.T @ other)[None])[0]
        return found


def _agree(values: list[Value], closely: float, noise: float = 0.0) -> bool:
    """Whether differences over one and over two steps are the same, but for noise of the values."""
    for name in ("residuals", "motion", "rates", "objectives"):
        f = [getattr(value, name) for value in values]
        one, two = (f[0] - f[1]) / 2, (f[2] - f[3]) / 4
        size = np.maximum(np.abs(one), np.abs(two)).max(initial=0.0)
        if np.abs(one - two).max(initial=0.0) > closely * size + noise * np.abs(
                f[0]).max(initial=0.0):
            return False
    return True


def _slope(values: list[Value], step: float) -> Slope:
    return Slope(*(sum(w / step * getattr(value, name) for w, value in zip(
        WEIGHTS, values, strict=True)) for name in Value._fields))
