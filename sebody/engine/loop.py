"""The compiled time loop: generalized-alpha on the Lie group, modified Newton, step control.

One loop for every scene, resumable: it works on flat arrays and returns a code. Small systems are
solved inside; for large ones it returns FACTOR and SOLVE and is called again with the answer.

The unknowns of a step are the increments dq (rotations: R exp(dTheta)) and the multipliers. The
matrix is kept in body axes and reused until convergence asks for a new one.
"""

import numpy as np

from sebody.engine.evaluate import (
    assemble,
    assemble_moved,
    move_prescribed,
    set_loads,
    set_powers,
    set_tangent_operators,
    take_rates,
    to_body_axes,
    turn_rotations,
)
from sebody.engine.matrix import renew, solve
from sebody.engine.state import (
    ADAPTIVE,
    AGE,
    AUX_STEP,
    BEGIN,
    BEND,
    CHOSEN,
    CHUNK,
    CONTRACTION,
    CURRENT_STEP,
    CUTS,
    DONE,
    EAGER,
    EAGER_LEFT,
    EXCESS,
    FACTOR,
    FACTOR_STEP,
    FACTORED,
    FAILED,
    FINEST,
    FLOOR,
    FORCES,
    FRESH,
    GRID,
    HELD,
    INACCURATE,
    ITERATE,
    ITERATION,
    ITERATIONS,
    LAST_NORM,
    LEVEL,
    MATRICES,
    NO_REASON,
    NOT_FINITE,
    PHASE,
    PIVOTED,
    PROJECT,
    PROJECTED,
    READY,
    REASON,
    RECORDED,
    RENEWED,
    SECANT,
    SLOW,
    SOLVE,
    SPAN,
    STEP,
    STEPS,
    TARGET,
    TIME,
    TURNED,
    UNIT,
    WANTED,
    YOUNG_RATE,
)
from sebody.engine.step_control import SHORTEST, accurate, choose_step, go_on, write_between
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.pipeline import compiled

MAX_ITERATIONS = 12
YOUNG = 3               # steps with new matrices that tell how fast the iteration can be
WORTH = 30.0            # new matrices cost about so many iterations,
TURNED_WORTH = 4.0      # and one of the bodies' old ones
LONGEST_HABIT = 32      # steps that begin with a new matrix before reuse is tried again
ORTHOGONAL = 8          # rotations are made orthogonal again after so many steps
POOR = 0.3              # contraction so slow asks for a new matrix at once
MOST_MATRICES = 4       # of a step
STRICT = 100.0          # tolerance of what accelerations move, in that of the increment
UNMOVED = 0.03          # of the tolerance: what all elements may move and keep their forces
QUICK = 0.05            # contraction so good needs no acceleration
MEMORY = 0.99           # for the size of the accelerations, a step


@compiled(forceinline=True)
def begin_step(system, state, scheme):
    """Remember the accepted state, predict the next one."""
    h = state.clock[CURRENT_STEP]
    for i in range(state.R.size):
        state.R_old[i] = state.R[i]
    for i in range(state.frames.size):
        state.frames_old[i] = state.frames[i]
    to_a = 1.0 / (1.0 - scheme.alpha_f)
    # auxiliary accelerations are those of a time (alpha_m - alpha_f) h later
    offset = h / state.clock[AUX_STEP]
    state.clock[AUX_STEP] = h
    for i in range(state.dq.size):      # the auxiliary acceleration is taken to stay
        q, v, a, aux = state.q[i], state.v[i], state.a[i], state.aux[i]
        if offset != 1.0:
            aux = a + offset * (aux - a)
            state.aux[i] = aux
        state.q_old[i], state.v_old[i], state.a_old[i], state.aux_old[i] = q, v, a, aux
        state.dq[i] = h * v + 0.5 * h * h * aux
        state.q[i] = q + state.dq[i]
        state.v[i] = v + h * aux
        state.a[i] = to_a * (aux - scheme.alpha_f * a)
    set_loads(system, state.loads, state.clock[TIME] + h)
    set_coefficients(state, scheme, h)
    move_prescribed(system, state)
    turn_rotations(system, state)
    state.control[ITERATION], state.control[SECANT] = 0, 0
    state.clock[LAST_NORM] = 0.0


@compiled(forceinline=True)
def set_coefficients(state, scheme, h):
    """Derivatives of acceleration and velocity by the increment."""
    state.coefficients[0] = (1 - scheme.alpha_m) / ((1 - scheme.alpha_f) * scheme.beta * h * h)
    state.coefficients[1] = scheme.gamma / (scheme.beta * h)
    state.coefficients[2] = 1.0
    state.coefficients[3] = scheme.geometric
    state.coefficients[4] = 1.0


@compiled(forceinline=True)
def apply_correction(system, state, scheme, mixed):
    """Add the solved correction; returns 1 converged, 0 go on, -1 new matrix, -2 give up."""
    n, h = system.diagonal.size, state.clock[CURRENT_STEP]
    norm = size = bend = 0.0
    for i in range(n):
        d = state.correction[i] * state.weight[i]
        x = state.dq[i] + system.is_multiplier[i] * state.q_old[i]      # a multiplier itself
        z = state.a[i] * state.weight[i]
        s = state.shift[i] * state.weight[i]
        norm += d * d + s * s
        size += x * x * state.weight[i] * state.weight[i]
        bend += z * z
    norm, size = np.sqrt(norm), np.sqrt(size)
    bend = max(scheme.beta * h * h * np.sqrt(bend), state.clock[BEND])
    if not np.isfinite(norm):
        state.clock[LAST_NORM] = norm
        return -2
    left_norm = accelerate(state, n, norm) if mixed else norm
    to_body_axes(system, state.frames, state.correction, True)
    if scheme.stabilized:
        to_body_axes(system, state.frames, state.shift, True)
    to_a, to_v, to_aux = state.coefficients[0], state.coefficients[1], 1 / (scheme.beta * h * h)
    for i in range(n):
        d = state.correction[i]
        moving = d * (1.0 - system.is_multiplier[i])
        state.dq[i] -= d + state.shift[i]
        state.q[i] -= d + state.shift[i]
        state.v[i] -= to_v * moving
        state.a[i] -= to_a * moving
        state.aux[i] -= to_aux * moving
    turn_rotations(system, state)
    iteration, last = state.control[ITERATION], state.clock[LAST_NORM]
    rate = state.clock[CONTRACTION]
    target = min(scheme.tolerance * size, STRICT * scheme.tolerance * bend) + state.clock[FLOOR]
    state.clock[BEND], state.clock[TARGET] = bend, target
    if iteration == 0:
        state.clock[SPAN] = np.log(norm / target)
    if iteration > 0 and last > 0.0:
        rate = norm / last
        state.clock[CONTRACTION] = rate
    state.control[ITERATION] = iteration + 1
    state.control[ITERATIONS] += 1
    state.clock[LAST_NORM] = left_norm
    rate = min(max(rate, 1e-3), 0.95)
    if rate / (1.0 - rate) * left_norm <= target:
        return 1
    left = MAX_ITERATIONS - iteration - 1
    if left <= 0 or (iteration > 2 and state.control[FRESH] > 2 and rate > 0.9):
        return -2
    if iteration == 0 or state.control[FRESH] >= MOST_MATRICES:
        return 0
    price = WORTH if next_matrix(system, state) == RENEWED else TURNED_WORTH
    return -1 if rate > POOR or np.log(target / norm) / np.log(rate) > min(price, left) else 0


@compiled
def accelerate(state, n, norm):
    """Anderson's mixing with the last correction; returns the norm of what is left to iterate.

    Matrices of the predicted state leave one slow direction where links of a taut chain turn.
    """
    correction, last, change = state.correction, state.last_correction, state.last_change
    along = square = mix = 0.0
    if state.control[SECANT] == 1 and norm > QUICK * state.clock[LAST_NORM]:
        for i in range(n):
            w = state.weight[i]
            difference = (correction[i] - last[i]) * w
            along += difference * correction[i] * w
            square += difference * difference
        if square > 0.0 and abs(along) < square:
            mix = along / square
            norm = np.sqrt(max(norm * norm - along * mix, 0.0))
    state.control[SECANT] = 1
    for i in range(n):
        d = correction[i]
        change[i] = correction[i] = d - mix * (change[i] + d - last[i])
        last[i] = d
    return norm


@compiled(forceinline=True)
def next_matrix(system, state):
    """First the bodies' old matrices in their new places, where that helps, then new ones."""
    return TURNED if system.linked[0] == 1 and state.control[FRESH] == 0 else RENEWED


@compiled(forceinline=True)
def accept(system, state, record):
    """End a converged step: rotations stay orthogonal, work of the loads, output."""
    clock, control = state.clock, state.control
    h = clock[CURRENT_STEP]
    if control[STEPS] % ORTHOGONAL == 0:
        for r in range(system.rotation_at.size):
            _orthogonalize(at(pointer_to(state.R), 9 * r))
    add_work(system, state, h)
    watch_age(state)
    if control[FRESH] == 0:
        control[EAGER] = 0
    clock[BEND] *= MEMORY
    control[STEPS] += 1
    if control[ADAPTIVE] == 1:
        go_on(system, state)
    else:
        go_on_grid(state, record)


@compiled(forceinline=True)
def go_on_grid(state, record):
    """Time and length of the next step where steps are parts of a grid, output on it."""
    clock, control = state.clock, state.control
    control[UNIT] += FINEST >> control[LEVEL]
    if control[UNIT] >= FINEST:             # back on the output grid
        control[UNIT] = 0
        control[GRID] += 1
        clock[TIME] = control[GRID] * clock[STEP]
        if control[GRID] % record.every[0] == 0:
            write_record(state, record)
    else:
        clock[TIME] = (control[GRID] + control[UNIT] / FINEST) * clock[STEP]
    while control[LEVEL] > 0 and control[UNIT] % (FINEST >> (control[LEVEL] - 1)) == 0:
        control[LEVEL] -= 1                 # try the longer step again
    clock[CURRENT_STEP] = clock[STEP] / (1 << control[LEVEL])


@compiled(forceinline=True)
def watch_age(state):
    """Ask for new matrices once the old ones have cost as many extra iterations as these would.

    Extra is what exceeds the iterations that the contraction of their youth would have needed.
    """
    clock, control = state.clock, state.control
    control[AGE] += 1
    if control[ITERATION] < 2:
        return
    if control[AGE] <= YOUNG:
        clock[YOUNG_RATE] = min(clock[YOUNG_RATE], max(clock[CONTRACTION], 1e-3))
        return
    needed = 1.0 + max(clock[SPAN], 0.0) / -np.log(clock[YOUNG_RATE])
    clock[EXCESS] += max(control[ITERATION] - np.ceil(needed), 0.0)
    if clock[EXCESS] > WORTH:
        control[WANTED] = RENEWED


@compiled(forceinline=True)
def add_work(system, state, h):
    """Work of the items over a step, by the trapezoidal rule."""
    for k in range(state.powers.size):
        state.powers_old[k] = state.powers[k]
        state.works[k] += 0.5 * h * state.powers[k]
    set_powers(system, state)
    for k in range(state.powers.size):
        state.works[k] += 0.5 * h * state.powers[k]
    for k in range(state.loads.size):
        state.loads_old[k] = state.loads[k]


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
    state.now[0], state.now[1] = state.clock[TIME], state.control[ITERATIONS]
    for i in range(state.now.size):     # one block: nine separate ones cost as much as a step
        record.rows[k, i] = state.now[i]
    state.control[RECORDED] = k + 1


@compiled
def back(state):
    """Back to the accepted state."""
    for i in range(state.q.size):       # loops: assigned slices compile slowly
        state.q[i] = state.q_old[i]
        state.v[i] = state.v_old[i]
        state.a[i] = state.a_old[i]
        state.aux[i] = state.aux_old[i]
    for i in range(state.R.size):
        state.R[i] = state.R_old[i]
    for i in range(state.frames.size):
        state.frames[i] = state.frames_old[i]
    state.control[PHASE] = BEGIN
    state.control[WANTED] = RENEWED
    state.clock[CONTRACTION] = 0.95     # nothing is known of the next attempt


@compiled
def cut_step(state, reason):
    """Half the step; False when it cannot be cut further."""
    clock, control = state.clock, state.control
    control[REASON] = reason
    control[CUTS] += 1
    if control[ADAPTIVE] == 1:
        clock[CHOSEN] = 0.5 * clock[CURRENT_STEP]
        control[HELD] = 0
        return clock[CHOSEN] > SHORTEST * clock[STEP]
    control[LEVEL] += 1
    clock[CURRENT_STEP] = clock[STEP] / (1 << control[LEVEL])
    return (1 << control[LEVEL]) <= FINEST


@compiled
def swap(a, b):
    """Exchange the contents of two vectors."""
    for i in range(a.size):
        a[i], b[i] = b[i], a[i]


@compiled
def advance(system, state, record, scheme, last_grid, chunk, dense):
    """Run until `last_grid`, for at most `chunk` steps, or until Python is asked for something."""
    control, clock = state.control, state.clock
    n = system.diagonal.size
    mixed = not dense and not scheme.stabilized
    selective = mixed and system.links.hanging.shape[0] == 0
    steps = 0
    reason = np.int64(NO_REASON)
    while True:
        if reason != NO_REASON:
            back(state)
            if not cut_step(state, reason):
                return FAILED
            reason = np.int64(NO_REASON)
        if control[PHASE] == BEGIN:
            if control[ADAPTIVE] == 1:
                write_between(system, state, record, last_grid)
            if control[GRID] >= last_grid:
                return DONE
            if steps >= chunk:
                return CHUNK
            steps += 1
            if control[ADAPTIVE] == 1:
                choose_step(system, state)
            begin_step(system, state, scheme)
            control[FRESH] = 0
            if clock[FACTOR_STEP] != clock[CURRENT_STEP]:
                control[WANTED] = RENEWED
            if control[WANTED] == FORCES and control[EAGER_LEFT] > 0:
                control[EAGER_LEFT] -= 1
                control[WANTED] = TURNED
            control[PHASE] = ITERATE
        if control[PHASE] == ITERATE:
            level = control[WANTED]
            if level == RENEWED:
                set_tangent_operators(system, state)
            if level == FORCES and control[ITERATION] > 1 and selective:
                reason = assemble_moved(system, state, UNMOVED * clock[TARGET])
            else:
                reason = assemble(level, system, state, state.residual)
            if reason != NO_REASON:
                continue
            if level != FORCES and system.links.hanging.shape[0] > 0:
                for i in range(state.residual.size):
                    state.forces[i] = state.residual[i]
            if scheme.stabilized:
                reason = take_rates(system, state)
                if reason != NO_REASON:
                    continue
            to_body_axes(system, state.frames, state.residual, False)
            control[PHASE] = FACTORED
            if level != FORCES:
                if level == RENEWED:
                    control[AGE], clock[YOUNG_RATE], clock[EXCESS] = 0, 0.5, 0.0
                    clock[FACTOR_STEP] = clock[CURRENT_STEP]
                control[WANTED] = FORCES
                control[SECANT] = 0
                control[FRESH] += 1
                control[MATRICES] += 1
                if not renew(system, state, level, dense):
                    reason = np.int64(NOT_FINITE)
                    continue
                if control[PIVOTED] == 1:
                    return FACTOR
        if control[PHASE] == FACTORED:
            control[PHASE] = READY
            if scheme.stabilized:
                swap(state.residual, state.gaps)
                control[PHASE] = PROJECT
        if control[PHASE] == PROJECT or control[PHASE] == READY:
            control[PHASE] += 1
            if control[PIVOTED] == 1:
                return SOLVE
            solve(system, state, dense)     # the one place: where there are two it is not inlined
        if control[PHASE] == PROJECTED:
            swap(state.residual, state.gaps)
            for i in range(n):
                state.shift[i] = state.correction[i] * (1.0 - system.is_multiplier[i])
            control[PHASE] = READY
            continue
        verdict = apply_correction(system, state, scheme, mixed)
        control[PHASE] = ITERATE
        if verdict == 1:
            if control[ADAPTIVE] == 1 and not accurate(system, state, scheme):
                back(state)
                if clock[CHOSEN] < SHORTEST * clock[STEP]:
                    control[REASON] = INACCURATE
                    return FAILED
                continue
            accept(system, state, record)
            control[PHASE] = BEGIN
        elif verdict == -1:
            control[WANTED] = next_matrix(system, state)
            if control[WANTED] == TURNED:
                control[EAGER] = min(2 * control[EAGER] + 1, LONGEST_HABIT)
                control[EAGER_LEFT] = control[EAGER]
        elif verdict == -2:
            if control[FRESH] == 0 and np.isfinite(clock[LAST_NORM]):
                # the old matrix may be to blame: the same step again with a new one
                back(state)
                continue
            reason = np.int64(SLOW if np.isfinite(clock[LAST_NORM]) else NOT_FINITE)
