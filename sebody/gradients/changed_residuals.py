"""Residuals of all events of a run by a changed model, in the recorded states of the run.

Motions that are prescribed, and positions that are fixed, are those of the changed model.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.layout import ACCELERATION, OK, RESIDUAL
from sebody.engine.evaluate import assemble, move_prescribed, set_loads, set_loads_beside
from sebody.engine.links import place_dependent
from sebody.engine.state import REASONS, State
from sebody.gradients.course import Course
from sebody.gradients.history import RESTART, History
from sebody.gradients.laws import in_changed
from sebody.gradients.second_residuals import of_restart, of_step
from sebody.gradients.stabilized import Second
from sebody.kernels.abi import pointer_to
from sebody.kernels.rotations import rotate
from sebody.results import rotations
from sebody.runs.simulation import Simulation

Load = tuple[int, float, float]     # a power port, a change of its value, one in look aheads
NO_LOAD = -1, 0.0, 0.0
NONE, NO_ROWS = np.zeros(0), np.zeros((0, 0))
NOTHING = Second(NONE, NONE, NO_ROWS, NONE, NO_ROWS, 0)     # of index 3


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


@compiled
def _largest(system, state, free):
    """The largest force of an element, on an accelerated inertia, or moment on one that turns."""
    largest = 0.0
    for k in range(state.g.size):
        largest = max(largest, abs(state.g[k]))
    for i in range(free):
        largest = max(largest, abs(system.inertias[i] * state.a[i]))
    for at in system.rotation_at:
        for i in range(at, at + 3 if at < free else at):
            largest = max(largest, system.inertias[i] * state.v[i] * state.v[i])
    return largest


@compiled(nogil=True)
def _residuals(system, state, rows, now, kinds, ends, besides, places, free, load, second, found,
               forces):
    """Residuals of all events but the first; fixed and prescribed coordinates are the model's own.

    `now` are states of this model, as many as are asked for: motion of the unknowns is that of the
    run. The load of a power port may be changed, `load` being the port, the change, and the change
    in look aheads. `second` are numbers of second residuals, of index 2, or `NOTHING`. `forces`
    (1,) becomes the largest of which residuals are sums.
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
        forces[0] = max(forces[0], _largest(system, state, free))
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
def port_values(system, state, port, ends, besides, found):
    """Value of a power port at all events."""
    for e in range(ends.size):
        set_loads_beside(system, state.frames, state.loads, ends[e], besides[e])
        found[e] = state.loads[3 * port]


class Held(NamedTuple):
    """Residuals of a model in the states of a run."""

    residuals: NDArray      # (events, unknowns)
    states: NDArray         # (events, recorded) of this model, or the first alone
    forces: float           # largest of an element or of an inertia, of which residuals are sums


class ChangedResiduals:
    """Residuals of changed models in the states of a run.

    Parameters
    ----------
    run : Simulation
    history : History
    course : Course, optional
        Of the run, if it is of index 2 or has laws.
    """

    def __init__(self, run: Simulation, history: History, course: Course | None = None):
        self.run, self.history, self.free = run, history, run.numbering.free
        parts = run.state.recorded_parts
        self.places = tuple(parts[name].start for name in ("q", "R", "v", "a", "frames",
                                                           "frames_old"))
        self.start = history.rows[0]        # of the run, or of a segment
        self.second = course.second if course and course.second else NOTHING
        self.unknowns = self.free if course is None else course.unknowns
        self.products, self.kept = (None, 0) if course is None else (course.products, course.kept)

    def of(self, made: Simulation, load: Load = NO_LOAD, states: bool = True) -> Held:
        """Residuals of all events, and the states of this model that they are of if asked for."""
        system, state, history = made.system, made.state, self.history
        found, forces = np.zeros((len(history.rows), self.unknowns + self.kept)), np.zeros(1)
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
                            history.besides, self.places, self.free, load, self.second,
                            found, forces)
        if status != OK:
            raise InputError(f"a state cannot be evaluated: {REASONS[status]}")
        if states:
            self._follow(made, now[1:], found, 1, len(now))
        return Held(found, now, float(forces[0]))

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

    def turned(self, state: State) -> NDArray:
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
