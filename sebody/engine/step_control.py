"""Step lengths chosen by the local error or planned, and output within a step, for compiled code.

All steps are allowed the same error, which minimizes the sum of the errors for a given number of
steps. Another step length needs a refactorization, which costs many iterations: the length changes
only where much is gained.

Steps that change at the same phase of every swing make energy drift, however small their errors. So
steps that are chosen one by one follow the largest error in a window that grows with the run. It
begins anew at events: corners of loads, impacts and errors far above the allowed one, which say
nothing of the motion after them. Runs whose end is known plan their steps instead, see
`sebody.runs.planning`.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    A_PART,
    Q_PART,
    R_PART,
    RECORD_ITERATIONS,
    RECORD_T,
    RECORD_WORKS,
    V_PART,
)
from sebody.engine.control_data import NEXT
from sebody.engine.links import place_dependent
from sebody.engine.state import (
    ASKED,
    BEND,
    FINEST,
    JUMP,
    NOTHING,
    SAMPLED,
)
from sebody.engine.vectors import copy
from sebody.engine.work import set_powers
from sebody.kernels.abi import pointer_to
from sebody.kernels.rotations import inverse_tangent_coefficients, rotate

AIM = 0.5               # share of the allowed error that a new step length aims at
GAIN = 1.4              # smallest factor by which steps are lengthened
LONGEST = 4.0           # largest factor by which steps are lengthened
SHORT = 0.2             # smallest factor by which a rejected step is shortened
PATIENCE = 10           # steps before the next lengthening, unless by the largest factor
SLOWLY = 35             # the same while steps are halved because energy grew
WINDOW = 0.5            # of the time since the last event: what a window of errors lasts at least
LEAST = 50.0            # steps that it lasts at least
EVENT = 8.0             # error that is an event
CALM = 1e-6             # largest error in a window that tells nothing: the next one begins
SLIVER = 0.1            # of the chosen length: errors of shorter steps, at corners, are rounding
REGROWN = 2.0           # factor from step to step after a planned one was cut
FAR = 1e3               # steps before a corner from which on they are made to meet it
NEAR = 1e-6             # of a step: nearer times are one
BEFORE = 3.0            # times this: how far before a jump loads are read
SHORTEST = 1e-9         # shortest step, relative to an output interval


@compiled
def accurate(system, state, scheme):
    """Tell if the error of a step is allowed; choose the length of the next attempt."""
    clock, control = state.clock, state.control
    h = clock.current_step
    error = _local_error(system, state, scheme)
    least = max(h, SLIVER * clock.chosen)
    rate = error / (least * least * least)
    if not error <= clock.allowed:
        if not error <= EVENT:
            forget_errors(clock)
        else:
            clock.rate = max(clock.rate, rate)
        clock.chosen = h * max(SHORT, (AIM / error) ** (1.0 / 3.0))
        control.held = 0
        control.rejected += 1
        return False
    rows = state.step_log.shape[0]
    if rows > 0:
        row = control.steps % rows
        whole = h * 2.0 ** state.guard.halved       # a plan is halved anew where energy grows
        state.step_log[row, 0], state.step_log[row, 1] = clock.end, whole
        state.step_log[row, 2] = rate
    if state.schedule.shape[0] > 0:
        if control.held == 0:
            clock.chosen = REGROWN * h
    else:
        _choose_by_window(state, rate)
    return True


@compiled
def _local_error(system, state, scheme):
    """Largest error of an increment over the allowed one.

    It is ``|beta + (alpha_m - alpha_f)/2 - 1/6| h^3`` times the rate of the acceleration,
    estimated from the change of the auxiliary acceleration in the step.
    """
    h, error = state.clock.current_step, 0.0
    aux, old = pointer_to(state.aux), pointer_to(state.aux_old)
    error_weights = pointer_to(state.error_weights)
    for i in range(system.diagonal.size):
        e = abs(aux[i] - old[i]) * error_weights[i]
        if e > error:
            error = e
    return error * abs(scheme.beta + 0.5 * (scheme.alpha_m - scheme.alpha_f) - 1.0 / 6.0) * h * h


@compiled
def _choose_by_window(state, rate):
    """Lengthen steps if the largest error over h^3 of the window under way, and of the one before,
    allows it.

    Steps that were halved because energy grew are lengthened slowly.
    """
    clock, control, guard = state.clock, state.control, state.guard
    control.held += 1
    clock.rate = max(clock.rate, rate)
    largest = max(clock.rate, clock.rate_before)
    chosen = clock.chosen
    if largest * chosen * chosen * chosen < CALM or clock.end - clock.begun > max(
            WINDOW * (clock.end - clock.origin), LEAST * chosen):
        clock.rate_before, clock.rate, clock.begun = clock.rate, rate, clock.end
    wanted = (AIM / max(largest, 1e-300)) ** (1.0 / 3.0)
    if guard.halved > 0.0:
        wanted = min(wanted, GAIN * chosen) if control.held >= SLOWLY else 0.0
    if wanted >= (GAIN if control.held >= PATIENCE else LONGEST) * chosen:
        clock.chosen = min(wanted, LONGEST * chosen)
        control.held = 0


@compiled
def forget_errors(clock):
    """Let the window of errors begin anew: what happens now need not come again."""
    clock.origin = clock.begun = clock.time
    clock.rate = clock.rate_before = 0.0


@compiled
def choose_step(system, state):
    """Set the length of a step: as the error allows or as planned, but so that it meets corners."""
    clock = state.clock
    if state.schedule.shape[0] > 0:
        _follow_schedule(state)
    last, h = clock.current_step, clock.chosen
    left = next_corner(system, state) - clock.time
    if state.memory[NEXT] >= 0.0:
        left = min(left, state.memory[NEXT] - clock.time)
    if left < np.inf:
        parts = max(np.ceil(left / h - 1e-6), 1.0)
        if parts < FAR:         # equal steps share a matrix, so rounding must not change h
            h = last if abs(parts * last - left) < 1e-9 * left else left / parts
    clock.current_step = h


@compiled
def _follow_schedule(state):
    """Take the planned length at the time reached; after a cut, lengths return to it by and by.

    Steps stay halved while energy would grow otherwise.
    """
    clock, control = state.clock, state.control
    reached = clock.time + NEAR * clock.chosen
    while control.piece < state.schedule.shape[0] - 1 and (
            state.schedule[control.piece, 0] <= reached):
        control.piece += 1
    planned = state.schedule[control.piece, 1] * 0.5 ** state.guard.halved
    if control.held > 0 or clock.chosen >= planned:
        clock.chosen, control.held = planned, 1


@compiled
def choose_part(system, state):
    """Set the length of a fixed step: a part of an output step, or what a jump leaves of it."""
    clock, control = state.clock, state.control
    corner, size = next_corner(system, state), FINEST >> control.level
    h = clock.step / (1 << control.level)
    end, near = clock.time + h, NEAR * h
    if control.inside == 1:
        end = (control.grid + (control.unit // size + 1) * size / FINEST) * clock.step
        h = end - clock.time
    control.split = np.int64(corner < end - near)
    clock.current_step = corner - clock.time if control.split == 1 else h


@compiled
def next_corner(system, state):
    """The next time at which steps end, fixed ones where accelerations jump; if none, infinity."""
    control, corners = state.control, system.corners
    fixed = control.adaptive == 0
    while control.corner < corners.size and (corners[control.corner] <= state.clock.time or (
            fixed and system.jumps[control.corner] == 0)):
        control.corner += 1
    return corners[control.corner] if control.corner < corners.size else np.inf


@compiled
def set_end(system, state):
    """Set the time at the end of a step; corners that are as near as rounding are one.

    A step that ends at a jump reads its loads before that.
    """
    clock, control, corners = state.clock, state.control, system.corners
    end = clock.time + clock.current_step
    near = NEAR * min(clock.current_step, clock.step)   # of long steps corners would be passed over
    clock.end, clock.beside, control.meets = end, 0.0, NOTHING
    k = control.corner
    while k < corners.size and corners[k] < end + near:
        clock.end = corners[k]
        control.meets = max(control.meets, JUMP if system.jumps[k] == 1 else BEND)
        k += 1
    if 0.0 <= state.memory[NEXT] < end + near:
        if control.adaptive == 1:      # fixed steps end there anyway
            clock.end = state.memory[NEXT]
        control.meets = max(control.meets, SAMPLED)
    if control.meets == JUMP:
        clock.beside = -BEFORE * near


@compiled
def go_on(state):
    """Set the time after an accepted step.

    Rates of accelerations jump at a corner: auxiliary accelerations, which are ahead by a part of
    the step, start there from the accelerations themselves. A longer step would otherwise carry
    the rate of a short pulse on.
    """
    clock, control = state.clock, state.control
    clock.time = clock.end
    if control.meets != NOTHING:
        clock.aux_step = np.inf
    if control.meets == BEND or control.meets == JUMP:      # samples come again and again
        forget_errors(clock)
    if control.meets >= SAMPLED:
        control.restart = ASKED


@compiled
def write_between(system, state, record, last_grid):
    """Write output at the grid times within the last step; at its end after a restart."""
    clock, control = state.clock, state.control
    h = clock.current_step
    while control.grid < last_grid:
        t = (control.grid + 1) * clock.step
        if t > clock.time or (t == clock.time and control.restart != 0):
            return
        control.grid += 1
        if control.grid % record.every[0] == 0:
            _write_row(system, state, record.rows[control.recorded], record.at, t,
                       1.0 - (clock.time - t) / h, h)
            control.recorded += 1


@compiled
def _write_row(system, state, row, at, t, s, h):
    """Interpolate the state at a share `s` of the last step, by cubics through values and rates."""
    copy(state.now, row)
    row[RECORD_T], row[RECORD_ITERATIONS] = t, state.control.iterations
    if s == 1.0:
        return
    set_powers(system, state, h)
    for k in range(state.works.size):
        row[RECORD_WORKS + k] = _cubic(s, state.works_old[k], h * state.powers_old[k],
                                       state.works[k], h * state.powers[k])
    total, frames = state.q.size, row.size - 2 * state.frames.size
    for k in system.control.flowing:
        row[frames + k] = state.frames_old[k] + s * (state.frames[k] - state.frames_old[k])
    q, v, a = (row[at[Q_PART]:at[Q_PART] + total], row[at[V_PART]:at[V_PART] + total],
               row[at[A_PART]:at[A_PART] + total])
    R = row[at[R_PART]:at[R_PART] + state.R.size]
    for i in range(total):
        q[i] = _cubic(s, state.q_old[i], h * state.v_old[i], state.q[i], h * state.v[i])
        v[i] = _cubic(s, state.v_old[i], h * state.a_old[i], state.v[i], h * state.a[i])
        a[i] = state.a_old[i] + s * (state.a[i] - state.a_old[i])
        if system.is_multiplier[i] > 0.0:
            q[i] = state.q_old[i] + s * (state.q[i] - state.q_old[i])
    for r in range(system.rotation_at.size):
        i = system.rotation_at[r]
        x, y, z = state.dq[i], state.dq[i + 1], state.dq[i + 2]
        u, w, p = _rate_of_increment(x, y, z, state.v[i], state.v[i + 1], state.v[i + 2])
        q[i] = _cubic(s, 0.0, h * state.v_old[i], x, h * u)
        q[i + 1] = _cubic(s, 0.0, h * state.v_old[i + 1], y, h * w)
        q[i + 2] = _cubic(s, 0.0, h * state.v_old[i + 2], z, h * p)
        rotate(pointer_to(state.R_old), 9 * r, q[i], q[i + 1], q[i + 2], pointer_to(R), 9 * r)
    if system.links.dependent.shape[0] > 0:
        place_dependent(system.links, q, v, a, R, state.turns)


@compiled
def _cubic(s, start, rate, end, end_rate):
    """Hermite's cubic; rates are derivatives with respect to the share `s`."""
    d = end - start
    return start + s * (rate + s * (3.0 * d - 2.0 * rate - end_rate
                                    + s * (rate + end_rate - 2.0 * d)))


@compiled
def _rate_of_increment(x, y, z, p, q, r):
    """``T^-1`` of a rotation increment times an angular velocity."""
    e = inverse_tangent_coefficients(x * x + y * y + z * z)[0]
    u, v, w = y * r - z * q, z * p - x * r, x * q - y * p
    return (p + 0.5 * u + e * (y * w - z * v), q + 0.5 * v + e * (z * u - x * w),
            r + 0.5 * w + e * (x * v - y * u))
