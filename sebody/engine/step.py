"""One step of the loop: prediction and acceptance, output, and return to the last state.

The unknowns of a step are the increments dq (rotations: R exp(dTheta)) and the multipliers.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    C_CONSTRAINT,
    C_DAMPING,
    C_GEO,
    C_MASS,
    C_STIFFNESS,
    OK,
    RECORD_ITERATIONS,
    RECORD_T,
    TANGENT,
)
from sebody.engine.calls import call_share
from sebody.engine.evaluate import (
    move_prescribed,
    run_kernels,
    set_loads_beside,
    set_tangent_operators,
    update_rotations,
)
from sebody.engine.newton import OLDEST_ROTATED, SLOWEST, forget_matrix, watch_age
from sebody.engine.prediction import BEFORE, FITTED, LAST, look_back, ring_place, row
from sebody.engine.selection import any_true, either
from sebody.engine.state import (
    ASKED,
    CONTACT,
    EVALUATED,
    FINEST,
    JUMP,
    KEPT,
    RENEWED,
    SAMPLED,
)
from sebody.engine.step_control import LONGEST, NEAR, SHORTEST, forget_errors, go_on, set_end
from sebody.engine.vectors import copy
from sebody.kernels.abi import at, pointer_to

ORTHOGONAL = 8          # steps after which rotation matrices are made orthogonal again
MEMORY = 0.99           # factor of the largest norm of accelerations, in every step
FIRST_RENEWED = 2       # steps before the first whose matrices are made before it is predicted


@compiled
def renew_bodies(system, state, members, scheme, active):
    """Make new element matrices of bodies before the next step is predicted, if it wants new ones.

    The errors of a predicted state stretch stiff bodies, and the false axial forces would be in
    their geometric stiffness. Not where factors are kept for samples, whose matrices are others.
    `members` and `active` as in `sebody.engine.iteration`.
    """
    control, clock = state.control, state.clock
    if (system.first_joint[0] == 0 or control.pivoted == 1 or system.regularized[0] == 1
            or state.spare.size > 0):
        return
    aged = ((control.wanted == KEPT) & (control.back_off_left > 0)
            & (control.age >= OLDEST_ROTATED))
    renewed = (active & (clock.factor_step == clock.current_step) & (control.iteration > 0)
               & (control.steps >= FIRST_RENEWED) & (aged | (control.wanted == EVALUATED)))
    if not any_true(renewed):
        return
    set_coefficients(state, scheme, clock.current_step)     # a restart has others
    renewed = evaluate_bodies(system, state, members, renewed)
    forget_matrix(state, renewed)
    control.wanted = either(renewed, RENEWED, control.wanted)


@compiled
def evaluate_bodies(system, state, members, renewed):
    """Make element matrices of bodies; returns whether they have been made, in lanes of whom."""
    set_tangent_operators(system, state)
    if system.routines[3] != 0:
        return call_share(system.routines[3], system, state, RENEWED, 0) == OK
    return run_kernels(TANGENT, 0, system.first_joint[0], system, state) == OK


@compiled(forceinline=True)
def begin_step(system, state, scheme):
    """Remember the accepted state, predict the next one at the end of the step."""
    h, control = state.clock.current_step, state.control
    set_end(system, state)
    # auxiliary accelerations belong to a time that is later by (alpha_m - alpha_f) h
    offset = h / state.clock.aux_step
    # after rejected steps and new matrices, and in parts of steps, which come where a motion is
    # not smooth, nothing is predicted to change
    kept = (control.fresh == 0) & ((control.wanted == KEPT) | (control.wanted == RENEWED))
    follow = either(kept, 1.0, 0.0)
    if offset != 1.0 or control.level > 0:
        follow = 0.0 * follow
    if any_true((control.iteration > 0) & (control.steps > 0)):     # no step that is repeated
        look_back(system, state, scheme.beta * h * h)
    predict(system, state, scheme, follow, offset)
    control.iteration, control.secant = 0, 0
    state.clock.last_norm = 0.0


@compiled(forceinline=True)
def predict(system, state, scheme, follow, offset):
    """Remember the accepted state, predict the next one.

    Parameters
    ----------
    follow : float
        1 if accelerations and multipliers are predicted to change as `prediction` says, else 0.
    offset : float
        Length of the step over that of the last one.
    """
    h = state.clock.current_step
    for i in range(state.R.size):
        state.R_old[i] = state.R[i]
    for i in range(state.frames.size):
        state.frames_old[i] = state.frames[i]
    alpha_m, beta, gamma = scheme.alpha_m, scheme.beta, scheme.gamma
    state.clock.aux_step = h
    steps = ring_place(state.control.steps, state.control.grid)
    fitted = pointer_to(state.fitted)
    last, before = row(state, steps), row(state, steps - 1)
    of_last, of_before, of_fitted = (follow * state.fit[LAST], follow * state.fit[BEFORE],
                                     follow * state.fit[FITTED])
    _predict_all(state.dq.size, pointer_to(state.q), pointer_to(state.v), pointer_to(state.a),
                 pointer_to(state.aux), pointer_to(state.dq), pointer_to(state.q_old),
                 pointer_to(state.v_old), pointer_to(state.a_old), pointer_to(state.aux_old),
                 last, before, fitted, pointer_to(system.is_multiplier), of_last, of_before,
                 of_fitted, offset, h, alpha_m, scheme.alpha_f, beta, gamma)
    copy(state.loads, state.loads_old)
    set_loads_beside(system, state.frames, state.loads, state.clock.end, state.clock.beside)
    set_coefficients(state, scheme, h)
    move_prescribed(system, state)
    update_rotations(system, state)


@compiled(forceinline=True, apart=True)
def _predict_all(n, q, v, a, aux, dq, q_old, v_old, a_old, aux_old, last, before, fitted,
                 is_multiplier, of_last, of_before, of_fitted, offset, h, alpha_m, alpha_f, beta,
                 gamma):
    to_a = 1.0 / (1.0 - alpha_f)
    for i in range(n):
        x, y, z, b = q[i], v[i], a[i], aux[i]
        change = of_last * last[i] + of_before * before[i] + of_fitted * fitted[i]
        multiplier = is_multiplier[i] * change
        change -= multiplier
        b = b if offset == 1.0 else z + offset * (b - z)
        q_old[i], v_old[i], a_old[i], aux_old[i] = x, y, z, b
        increment = h * y + h * h * (0.5 * b + beta * change) + multiplier
        dq[i] = increment
        q[i] = x + increment
        v[i] = y + h * (b + gamma * change)
        a[i] = to_a * (b + (1.0 - alpha_m) * change - alpha_f * z)
        aux[i] = b + change


@compiled(forceinline=True)
def set_coefficients(state, scheme, h):
    """Set the derivatives of acceleration and velocity with respect to the increment."""
    c = state.coefficients
    c[C_MASS] = (1 - scheme.alpha_m) / ((1 - scheme.alpha_f) * scheme.beta * h * h)
    c[C_DAMPING] = scheme.gamma / (scheme.beta * h)
    c[C_STIFFNESS] = 1.0
    c[C_GEO] = scheme.geometric
    c[C_CONSTRAINT] = 1.0


@compiled(forceinline=True)
def accept(system, state, record):
    """End a converged step: orthogonal rotations, output."""
    control = state.control
    count_step(system, state, control.steps)
    if control.adaptive == 1:
        go_on(state)
    else:
        go_on_grid(state, record)


@compiled(forceinline=True)
def count_step(system, state, steps):
    """Count an accepted step; after some `steps` make rotations orthogonal.

    The norm of accelerations is forgotten slowly.
    """
    control = state.control
    if steps % ORTHOGONAL == 0:
        for r in range(system.rotation_at.size):
            orthogonalize(at(pointer_to(state.R), 9 * r))
    state.clock.acceleration_norm *= MEMORY
    watch_age(state)
    # a step without a new matrix: the old one may be tried again soon
    control.back_off = either(control.fresh == 0, 0, control.back_off)
    control.steps += 1


@compiled(forceinline=True)
def go_on_grid(state, record):
    """Write output, set time and length of the next step; steps are parts of grid steps.

    What a jump leaves of a step may be very short: accelerations of constraints of index 3 that
    have not settled in it would spoil the next step.
    """
    clock, control = state.clock, state.control
    short = clock.step / (1 << control.level) > LONGEST * clock.current_step
    if control.meets >= SAMPLED or (control.inside == 1 and short):
        control.restart = ASKED
    if control.split == 1:
        clock.time, control.inside = clock.end, 1
        # a jump inside a step: the next one ends where this would have
        control.unit = np.int64(FINEST * (clock.time / clock.step - control.grid) + NEAR)
        return
    # whole numbers: parts of steps meet the grid without rounding
    size = FINEST >> control.level
    control.unit, control.inside = (control.unit // size + 1) * size, 0
    if control.unit >= FINEST:             # back on the output grid
        control.unit = 0
        control.grid += 1
        control.due = np.int64(control.grid % record.every[0] == 0)
    clock.time = (control.grid + control.unit / FINEST) * clock.step
    if control.meets == JUMP:
        clock.time = clock.end
    if control.due == 1 and control.restart == 0:
        write_record(state, record)
    # no longer than the guard of energies allows
    least = int(state.guard.halved)
    while control.level > least and control.unit % (FINEST >> (control.level - 1)) == 0:
        control.level -= 1                 # try the longer step again
    clock.current_step = clock.step / (1 << control.level)


@compiled(forceinline=True)
def orthogonalize(R):
    """One Newton step ``R (3 I - R^T R) / 2`` towards the nearest rotation."""
    for i in range(3):
        a, b, c = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        s = 1.5 - 0.5 * (a * a + b * b + c * c)
        R[3 * i], R[3 * i + 1], R[3 * i + 2] = s * a, s * b, s * c
    for i in range(2):
        for j in range(i + 1, 3):
            dot = 0.0
            for k in range(3):
                dot += R[3 * i + k] * R[3 * j + k]
            for k in range(3):
                x = R[3 * i + k]
                R[3 * i + k] -= 0.5 * dot * R[3 * j + k]
                R[3 * j + k] -= 0.5 * dot * x


@compiled(forceinline=True)
def write_record(state, record):
    """Store the accepted state."""
    k = state.control.recorded
    state.now[RECORD_T] = state.clock.time
    state.now[RECORD_ITERATIONS] = state.control.iterations
    for i in range(state.now.size):     # one block: nine separate copies cost as much as a step
        record.rows[k, i] = state.now[i]
    state.control.recorded, state.control.due = k + 1, 0


@compiled
def back(state):
    """Return to the last accepted state; the next attempt evaluates all element matrices."""
    for i in range(state.q.size):       # loops: assigned slices compile slowly
        state.q[i] = state.q_old[i]
        state.v[i] = state.v_old[i]
        state.a[i] = state.a_old[i]
        state.aux[i] = state.aux_old[i]
    for i in range(state.R.size):
        state.R[i] = state.R_old[i]
    for i in range(state.frames.size):
        state.frames[i] = state.frames_old[i]
    copy(state.loads_old, state.loads)
    state.control.wanted = EVALUATED
    state.control.iteration = 0
    state.clock.contraction = SLOWEST      # nothing is known of the next attempt


@compiled
def cut_step(state):
    """Halve the step; False when no shorter step is allowed."""
    clock, control = state.clock, state.control
    control.cuts += 1
    if control.adaptive == 1:
        clock.chosen = 0.5 * clock.current_step
        control.held = 0
        # errors before a contact say nothing of those in it
        if control.reason == CONTACT:
            forget_errors(clock)
        return clock.chosen > SHORTEST * clock.step
    tried = clock.current_step
    while clock.current_step >= tried and (1 << control.level) <= FINEST:
        control.level += 1
        clock.current_step = clock.step / (1 << control.level)
    if (1 << control.level) <= FINEST:
        return True
    control.level -= 1         # of the finest parts, should the run be resumed
    return False
