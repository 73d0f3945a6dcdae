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
    RECORD_ITERATIONS,
    RECORD_T,
)
from sebody.engine.evaluate import move_prescribed, set_loads_beside, update_rotations
from sebody.engine.growth import HALVED
from sebody.engine.newton import SLOWEST, watch_age
from sebody.engine.state import (
    ACCELERATION_NORM,
    ADAPTIVE,
    ASKED,
    AUX_STEP,
    BACK_OFF,
    BEGIN,
    BESIDE,
    CHOSEN,
    CONTRACTION,
    CURRENT_STEP,
    CUTS,
    DUE,
    END,
    EVALUATED,
    FINEST,
    FRESH,
    GRID,
    HELD,
    INSIDE,
    ITERATION,
    ITERATIONS,
    JUMP,
    KEPT,
    LAST_NORM,
    LEVEL,
    MEETS,
    PHASE,
    RECORDED,
    RESTART,
    SECANT,
    SPLIT,
    STEP,
    STEPS,
    TIME,
    UNIT,
    WANTED,
)
from sebody.engine.step_control import LONGEST, NEAR, SHORTEST, go_on, set_end
from sebody.engine.vectors import copy
from sebody.kernels.abi import at, pointer_to

ORTHOGONAL = 8          # steps after which rotation matrices are made orthogonal again
STEADY = 0.5            # share of a change by which the next one may differ
MEMORY = 0.99           # factor of the largest norm of accelerations, in every step


@compiled(forceinline=True)
def begin_step(system, state, scheme):
    """Remember the accepted state, predict the next one at the end of the step."""
    h = state.clock[CURRENT_STEP]
    set_end(system, state)
    for i in range(state.R.size):
        state.R_old[i] = state.R[i]
    for i in range(state.frames.size):
        state.frames_old[i] = state.frames[i]
    alpha_m, beta, gamma = scheme.alpha_m, scheme.beta, scheme.gamma
    to_a = 1.0 / (1.0 - scheme.alpha_f)
    # auxiliary accelerations belong to a time that is later by (alpha_m - alpha_f) h
    offset = h / state.clock[AUX_STEP]
    state.clock[AUX_STEP] = h
    kept = state.control[FRESH] == 0 and state.control[WANTED] == KEPT and offset == 1.0
    follow = 1.0 if _steady(system, state) and kept else 0.0
    for i in range(state.dq.size):
        q, v, a, aux = state.q[i], state.v[i], state.a[i], state.aux[i]
        change = follow * state.aux_change[i]
        if offset != 1.0:
            aux = a + offset * (aux - a)
        state.q_old[i], state.v_old[i], state.a_old[i], state.aux_old[i] = q, v, a, aux
        state.dq[i] = h * v + h * h * (0.5 * aux + beta * change)
        state.q[i] = q + state.dq[i]
        state.v[i] = v + h * (aux + gamma * change)
        state.a[i] = to_a * (aux + (1.0 - alpha_m) * change - scheme.alpha_f * a)
        state.aux[i] = aux + change
    copy(state.loads, state.loads_old)
    set_loads_beside(system, state.loads, state.clock[END], state.clock[BESIDE])
    set_coefficients(state, scheme, h)
    move_prescribed(system, state)
    update_rotations(system, state)
    state.control[ITERATION], state.control[SECANT] = 0, 0
    state.clock[LAST_NORM] = 0.0


@compiled(forceinline=True)
def _steady(system, state):
    """Whether auxiliary accelerations changed in the last step as in the step before, roughly.

    If so, they are predicted to go on changing like that, else to stay as they are: after rejected
    steps and new matrices, too, which come where a motion is not smooth. The error that Newton's
    iteration with old matrices leaves is proportional to the error of the prediction.
    """
    constant = linear = 0.0
    for i in range(system.diagonal.size):
        w, change = state.weight[i], state.aux[i] - state.aux_old[i]
        bend = change - state.aux_change[i]
        state.aux_change[i] = change
        constant += change * change * w * w
        linear += bend * bend * w * w
    return linear < STEADY * STEADY * constant


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
    clock, control = state.clock, state.control
    if control[STEPS] % ORTHOGONAL == 0:
        for r in range(system.rotation_at.size):
            _orthogonalize(at(pointer_to(state.R), 9 * r))
    watch_age(state)
    if control[FRESH] == 0:
        control[BACK_OFF] = 0
    clock[ACCELERATION_NORM] *= MEMORY
    control[STEPS] += 1
    if control[ADAPTIVE] == 1:
        go_on(state)
    else:
        go_on_grid(state, record)


@compiled(forceinline=True)
def go_on_grid(state, record):
    """Write output, set time and length of the next step; steps are parts of grid steps.

    What a jump leaves of a step may be very short: accelerations of constraints of index 3 that
    have not settled in it would spoil the next step.
    """
    clock, control = state.clock, state.control
    short = clock[STEP] / (1 << control[LEVEL]) > LONGEST * clock[CURRENT_STEP]
    if control[MEETS] == JUMP or (control[INSIDE] == 1 and short):
        control[RESTART] = ASKED
    if control[SPLIT] == 1:
        clock[TIME], control[INSIDE] = clock[END], 1
        control[UNIT] = np.int64(FINEST * (clock[TIME] / clock[STEP] - control[GRID]) + NEAR)
        return
    size = FINEST >> control[LEVEL]
    control[UNIT], control[INSIDE] = (control[UNIT] // size + 1) * size, 0
    if control[UNIT] >= FINEST:             # back on the output grid
        control[UNIT] = 0
        control[GRID] += 1
        control[DUE] = np.int64(control[GRID] % record.every[0] == 0)
    clock[TIME] = (control[GRID] + control[UNIT] / FINEST) * clock[STEP]
    if control[MEETS] == JUMP:
        clock[TIME] = clock[END]
    if control[DUE] == 1 and control[RESTART] == 0:
        write_record(state, record)
    least = int(state.guard[HALVED])
    while control[LEVEL] > least and control[UNIT] % (FINEST >> (control[LEVEL] - 1)) == 0:
        control[LEVEL] -= 1                 # try the longer step again
    clock[CURRENT_STEP] = clock[STEP] / (1 << control[LEVEL])


@compiled(forceinline=True)
def _orthogonalize(R):
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
    k = state.control[RECORDED]
    state.now[RECORD_T] = state.clock[TIME]
    state.now[RECORD_ITERATIONS] = state.control[ITERATIONS]
    for i in range(state.now.size):     # one block: nine separate copies cost as much as a step
        record.rows[k, i] = state.now[i]
    state.control[RECORDED], state.control[DUE] = k + 1, 0


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
    state.control[PHASE] = BEGIN
    state.control[WANTED] = EVALUATED
    state.clock[CONTRACTION] = SLOWEST      # nothing is known of the next attempt


@compiled
def cut_step(state):
    """Halve the step; False when no shorter step is allowed."""
    clock, control = state.clock, state.control
    control[CUTS] += 1
    if control[ADAPTIVE] == 1:
        clock[CHOSEN] = 0.5 * clock[CURRENT_STEP]
        control[HELD] = 0
        return clock[CHOSEN] > SHORTEST * clock[STEP]
    tried = clock[CURRENT_STEP]
    while clock[CURRENT_STEP] >= tried and (1 << control[LEVEL]) <= FINEST:
        control[LEVEL] += 1
        clock[CURRENT_STEP] = clock[STEP] / (1 << control[LEVEL])
    if (1 << control[LEVEL]) <= FINEST:
        return True
    control[LEVEL] -= 1         # of the finest parts, should the run be resumed
    return False
