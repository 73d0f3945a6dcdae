"""Newton's iteration in a step: corrections, when they are good enough, when matrices are renewed.

The matrix is kept in body axes and reused until convergence asks for a new one.
"""

import numpy as np

from sebody.engine.evaluate import to_body_axes, turn_rotations
from sebody.engine.state import (
    AGE,
    BEND,
    CONTRACTION,
    CONVERGED,
    CURRENT_STEP,
    EAGER,
    EAGER_LEFT,
    EXCESS,
    FACTOR_STEP,
    FLOOR,
    FRESH,
    GIVE_UP,
    GO_ON,
    ITERATION,
    ITERATIONS,
    KEPT,
    LAST_NORM,
    MATRICES,
    NEW_MATRIX,
    RENEWED,
    SECANT,
    SPAN,
    TARGET,
    TURNED,
    WANTED,
    YOUNG_RATE,
)
from sebody.kernels.layout import C_MASS, C_RATE
from sebody.kernels.pipeline import compiled

MAX_ITERATIONS = 12
SLOWEST = 0.95          # contraction that is assumed where nothing is known, and believed at most
FASTEST = 1e-3          # and at least
YOUNG = 3               # steps with new matrices that tell how fast the iteration can be
WORTH = 30.0            # new matrices cost about so many iterations,
TURNED_WORTH = 4.0      # and one of the bodies' old ones
LONGEST_HABIT = 32      # steps that begin with a new matrix before reuse is tried again
POOR = 0.3              # contraction so slow asks for a new matrix at once
MOST_MATRICES = 4       # of a step
STRICT = 100.0          # tolerance of what accelerations move, in that of the increment
QUICK = 0.05            # contraction so good needs no acceleration


@compiled(forceinline=True)
def apply_correction(system, state, scheme, mixed):
    """Subtract the solved correction; returns what it says of the step, CONVERGED to GIVE_UP."""
    n = system.diagonal.size
    norm, size, bend = _norms(system, state, n)
    if not np.isfinite(norm):
        state.clock[LAST_NORM] = norm
        return GIVE_UP
    left_norm = accelerate(state, n, norm) if mixed else norm
    _subtract(system, state, scheme, n)
    bend = max(scheme.beta * state.clock[CURRENT_STEP] * state.clock[CURRENT_STEP] * bend,
               state.clock[BEND])
    target = min(scheme.tolerance * size, STRICT * scheme.tolerance * bend) + state.clock[FLOOR]
    state.clock[BEND], state.clock[TARGET] = bend, target
    return _verdict(system, state, norm, left_norm, target)


@compiled(forceinline=True)
def _norms(system, state, n):
    """Of the correction, of the increment with the multipliers, and of the accelerations."""
    norm = size = bend = 0.0
    for i in range(n):
        d = state.correction[i] * state.weight[i]
        x = state.dq[i] + system.is_multiplier[i] * state.q_old[i]      # a multiplier itself
        z = state.a[i] * state.weight[i]
        s = state.shift[i] * state.weight[i]
        norm += d * d + s * s
        size += x * x * state.weight[i] * state.weight[i]
        bend += z * z
    return np.sqrt(norm), np.sqrt(size), np.sqrt(bend)


@compiled(forceinline=True)
def _subtract(system, state, scheme, n):
    """Subtract the correction, in global axes, and the shift that moves positions alone."""
    h = state.clock[CURRENT_STEP]
    to_body_axes(system, state.frames, state.correction, True)
    if scheme.stabilized:
        to_body_axes(system, state.frames, state.shift, True)
    to_a, to_v = state.coefficients[C_MASS], state.coefficients[C_RATE]
    to_aux = 1 / (scheme.beta * h * h)
    for i in range(n):
        d = state.correction[i]
        moving = d * (1.0 - system.is_multiplier[i])
        state.dq[i] -= d + state.shift[i]
        state.q[i] -= d + state.shift[i]
        state.v[i] -= to_v * moving
        state.a[i] -= to_a * moving
        state.aux[i] -= to_aux * moving
    turn_rotations(system, state)


@compiled(forceinline=True)
def _verdict(system, state, norm, left_norm, target):
    """Count the iteration and judge its contraction."""
    clock, control = state.clock, state.control
    iteration, last, rate = control[ITERATION], clock[LAST_NORM], clock[CONTRACTION]
    if iteration == 0:
        clock[SPAN] = np.log(norm / target)
    if iteration > 0 and last > 0.0:
        rate = norm / last
        clock[CONTRACTION] = rate
    control[ITERATION] = iteration + 1
    control[ITERATIONS] += 1
    clock[LAST_NORM] = left_norm
    rate = min(max(rate, FASTEST), SLOWEST)
    if rate / (1.0 - rate) * left_norm <= target:
        return CONVERGED
    left = MAX_ITERATIONS - iteration - 1
    if left <= 0 or (iteration > 2 and control[FRESH] > 2 and rate > 0.9):
        return GIVE_UP
    if iteration == 0 or control[FRESH] >= MOST_MATRICES:
        return GO_ON
    price = WORTH if next_matrix(system, state) == RENEWED else TURNED_WORTH
    slow = rate > POOR or np.log(target / norm) / np.log(rate) > min(price, left)
    return NEW_MATRIX if slow else GO_ON


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
def begin_with_matrix(state):
    """Which matrices a step makes anew before its first iteration."""
    clock, control = state.clock, state.control
    control[FRESH] = 0
    if clock[FACTOR_STEP] != clock[CURRENT_STEP]:
        control[WANTED] = RENEWED
    if control[WANTED] == KEPT and control[EAGER_LEFT] > 0:
        control[EAGER_LEFT] -= 1
        control[WANTED] = TURNED


@compiled(forceinline=True)
def want_matrix(system, state):
    """Ask for a new matrix within a step; where turned ones help, the next steps begin with one."""
    control = state.control
    control[WANTED] = next_matrix(system, state)
    if control[WANTED] == TURNED:
        control[EAGER] = min(2 * control[EAGER] + 1, LONGEST_HABIT)
        control[EAGER_LEFT] = control[EAGER]


@compiled(forceinline=True)
def count_matrix(state, wanted):
    """What changes with a new matrix, before it is made."""
    clock, control = state.clock, state.control
    if wanted == RENEWED:
        control[AGE], clock[YOUNG_RATE], clock[EXCESS] = 0, 0.5, 0.0
        clock[FACTOR_STEP] = clock[CURRENT_STEP]
    control[WANTED] = KEPT
    control[SECANT] = 0
    control[FRESH] += 1
    control[MATRICES] += 1


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
        clock[YOUNG_RATE] = min(clock[YOUNG_RATE], max(clock[CONTRACTION], FASTEST))
        return
    needed = 1.0 + max(clock[SPAN], 0.0) / -np.log(clock[YOUNG_RATE])
    clock[EXCESS] += max(control[ITERATION] - np.ceil(needed), 0.0)
    if clock[EXCESS] > WORTH:
        control[WANTED] = RENEWED
