"""Modified Newton iteration of a step: corrections, convergence, when to refactorize.

The factorized matrix is kept in body axes and reused until slow convergence asks for a new one.
"""

import math

import numpy as np

from sebody.compiler.decorators import ANY_ORDER, compiled
from sebody.contract.layout import C_DAMPING, C_MASS
from sebody.engine.evaluate import to_body_axes, update_rotations
from sebody.engine.matrix import ROUNDING
from sebody.engine.regularization import regularized_norms
from sebody.engine.state import (
    CONVERGED,
    EVALUATED,
    GIVE_UP,
    GO_ON,
    KEPT,
    LEAVES_GAP,
    NEW_MATRIX,
    RENEWED,
    ROTATED,
)
from sebody.engine.vectors import swap
from sebody.kernels.abi import pointer_to

MAX_ITERATIONS = 12     # of a step
SLOWEST = 0.95          # contraction rate assumed where none is known, and upper bound of estimates
UNSURE = 0.5            # lower bound of the rate in the first iteration, which only others tell
FASTEST = 1e-3          # lower bound of estimated contraction rates
BASELINE_STEPS = 3      # steps after a refactorization whose best contraction rate is the baseline
REFACTORIZATION_COST = 10.0     # of a matrix with new element matrices, in iterations
ROTATED_COST = 4.0      # of an inverse with old element matrices of bodies, rotated, in iterations
ROTATED_BLOCKS_COST = 1.5       # the same of a matrix that is factorized by blocks
BENT = 0.9              # a rate of the second correction below this is no fault of a new matrix
LONGEST_BACK_OFF = 32   # at most so many steps refresh the matrix before reuse is tried again
OLDEST_ROTATED = 32     # steps with the same ones, after which a refreshed matrix takes new ones
OLDEST = 3000           # steps with the same element matrices: see `watch_age`
POOR = 0.3              # a contraction rate above this asks for a new matrix at once
MOST_MATRICES = 4       # factorizations in a step
ACCELERATION_TOLERANCE = 100.0  # tolerance relative to accelerations, over that of the increment
WIDEST_GAP = 1e-5       # between what joints demand, relative to the extent of the model
ROUNDED = 100.0         # of the target: where new matrices do not help, what is left is rounding
ASTRAY = 0.5            # sizes of a coordinate, that it may end from where its rates lead
QUICK = 0.05            # a contraction rate below this needs no acceleration by mixing


@compiled(forceinline=True)
def apply_correction(system, state, scheme, mixed):
    """Subtract the solved correction; returns the verdict on the step, CONVERGED to GIVE_UP."""
    n = system.diagonal.size
    regularized = state.control.regularized == 1
    norm, size, accelerations = (regularized_norms(system, state, n) if regularized else
                                 norms(system, state, n))
    if not np.isfinite(norm):
        state.clock.last_norm = norm
        return GIVE_UP
    left_norm = accelerate(system, state, n, norm) if mixed else norm
    subtract(system, state, scheme, n)
    accelerations = max(
        scheme.beta * state.clock.current_step * state.clock.current_step * accelerations,
        state.clock.acceleration_norm)
    target = min(scheme.tolerance * size,
                 ACCELERATION_TOLERANCE * scheme.tolerance * accelerations) + state.clock.floor
    state.clock.acceleration_norm, state.clock.target = accelerations, target
    verdict = _verdict(system, state, norm, left_norm, target)
    if verdict == CONVERGED and strayed(system, state, scheme):
        return GIVE_UP
    ended = verdict == CONVERGED or verdict == GIVE_UP
    if ended and regularized and leaves_gap(system, state, norm, scheme.stabilized):
        return LEAVES_GAP
    return verdict


@compiled
def strayed(system, state, scheme):
    """Whether a step ends half a radian, or half the model's size, from where its rates led.

    In lanes, of which members.

    A step that is too long may have such roots: the tolerance is relative to the increment, so
    however far the iteration goes astray, it converges there.
    """
    reach = ASTRAY / (scheme.beta * state.clock.current_step * state.clock.current_step)
    far = 0.0 * state.clock.floor > 1.0
    for i in range(system.diagonal.size):
        far = far | ((system.magnitude[i] > 0.0) & (
            abs(state.aux[i] - state.aux_old[i]) > reach * system.magnitude[i]))
    return far


@compiled
def leaves_gap(system, state, norm, stabilized):
    """Whether a residual is left that the corrections of a regularized matrix cannot remove.

    In lanes, of which members.

    That of the iterate before the last correction is at most the correction times the matrix, whose
    scaled entries are at most one.
    """
    n, left = system.diagonal.size, 0.0 * norm
    for i in range(n):
        residual = state.residual[i]
        if stabilized:
            residual += state.constraint_residuals[i]
        left += residual * residual * state.scale[i] * state.scale[i]
    return math.sqrt(left) > n * norm + WIDEST_GAP / ROUNDING * state.clock.floor


@compiled(forceinline=True)
def norms(system, state, n):
    """Norms of the correction, of the increment with the multipliers, and of the accelerations."""
    norm, size, accelerations = _squares(
        n, pointer_to(state.correction), pointer_to(state.shift), pointer_to(state.dq),
        pointer_to(state.q_old), pointer_to(state.a), pointer_to(state.weight),
        pointer_to(system.is_multiplier))
    return math.sqrt(norm), math.sqrt(size), math.sqrt(accelerations)


@compiled(forceinline=True, fastmath=ANY_ORDER)
def _squares(n, correction, shift, dq, q_old, a, weight, is_multiplier):
    """Sums in any order, which only tell when the iteration ends."""
    norm = size = accelerations = 0.0
    for i in range(n):
        w = weight[i]
        d, s, z = correction[i] * w, shift[i] * w, a[i] * w
        x = (dq[i] + is_multiplier[i] * q_old[i]) * w       # of a multiplier itself
        norm += d * d + s * s
        size += x * x
        accelerations += z * z
    return norm, size, accelerations


@compiled(forceinline=True)
def take_shift(system, state):
    """Take the correction for the constraints as a shift of positions; the rates are next."""
    swap(state.residual, state.constraint_residuals)
    for i in range(system.diagonal.size):
        state.shift[i] = state.correction[i] * (1.0 - system.is_multiplier[i])


@compiled(forceinline=True)
def subtract(system, state, scheme, n):
    """Subtract the correction, in global axes, and the shift that moves positions alone."""
    h = state.clock.current_step
    to_body_axes(system, state.frames, state.correction, True)
    if scheme.stabilized:
        to_body_axes(system, state.frames, state.shift, True)
    _subtract_from_all(n, pointer_to(state.correction), pointer_to(state.shift),
                       pointer_to(system.is_multiplier), state.coefficients[C_DAMPING],
                       state.coefficients[C_MASS], 1 / (scheme.beta * h * h), pointer_to(state.dq),
                       pointer_to(state.q), pointer_to(state.v), pointer_to(state.a),
                       pointer_to(state.aux))
    update_rotations(system, state)


@compiled(forceinline=True, apart=True)
def _subtract_from_all(n, correction, shift, is_multiplier, to_v, to_a, to_aux, dq, q, v, a, aux):
    for i in range(n):
        d, s = correction[i], shift[i]
        moving = d * (1.0 - is_multiplier[i])
        dq[i] -= d + s
        q[i] -= d + s
        v[i] -= to_v * moving
        a[i] -= to_a * moving
        aux[i] -= to_aux * moving


@compiled(forceinline=True)
def _verdict(system, state, norm, left_norm, target):
    """Count the iteration; convergence or the next action from its contraction rate."""
    clock, control = state.clock, state.control
    iteration, last, rate = control.iteration, clock.last_norm, clock.contraction
    if iteration == 0:
        clock.span = norm / target
    if iteration > 0 and last > 0.0:
        rate = norm / last
        clock.contraction = rate
    control.iteration = iteration + 1
    control.iterations += 1
    clock.last_norm = left_norm
    rate = min(max(rate, UNSURE if iteration == 0 else FASTEST), SLOWEST)
    if rate / (1.0 - rate) * left_norm <= target:
        return CONVERGED
    left = MAX_ITERATIONS - iteration - 1
    if iteration > 2 and control.fresh > 2 and rate > 0.9:
        return CONVERGED if left_norm <= ROUNDED * target else GIVE_UP
    if left <= 0:
        return GIVE_UP
    if iteration == 0 or control.fresh >= MOST_MATRICES:
        return GO_ON
    if iteration == 1 and control.fresh > 0 and rate < BENT:
        return GO_ON        # what the first correction bends the second one stretches
    cost = REFACTORIZATION_COST
    if next_matrix(system, state) == ROTATED:
        cost = ROTATED_COST if state.inverse.size > 1 else ROTATED_BLOCKS_COST
    slow = rate > POOR or np.log(target / norm) / np.log(rate) > min(cost, left)
    return NEW_MATRIX if slow else GO_ON


@compiled
def accelerate(system, state, n, norm):
    """Anderson mixing with the last correction; returns the norm of the mixed correction.

    With matrices of the predicted state the error of a taut chain that rotates decays slowly in
    one direction, which mixing with one correction removes. The multipliers of a regularized
    matrix are too uncertain to be asked.
    """
    correction, last, change = state.correction, state.last_correction, state.last_change
    along = square = mix = 0.0
    regularized = state.control.regularized == 1
    if state.control.secant == 1 and norm > QUICK * state.clock.last_norm:
        for i in range(n):
            if regularized and system.is_multiplier[i] > 0.0:
                continue
            w = state.weight[i]
            difference = (correction[i] - last[i]) * w
            along += difference * correction[i] * w
            square += difference * difference
        if square > 0.0 and abs(along) < square:
            mix = along / square
            norm = np.sqrt(max(norm * norm - along * mix, 0.0))
    state.control.secant = 1
    for i in range(n):
        d = correction[i]
        change[i] = correction[i] = d - mix * (change[i] + d - last[i])
        last[i] = d
    return norm


@compiled(forceinline=True)
def next_matrix(system, state):
    """Matrices of a refactorization within a step: rotated ones first, if they help, then new."""
    return ROTATED if system.linked[0] == 1 and state.control.fresh == 0 else EVALUATED


@compiled(forceinline=True)
def begin_with_matrix(state):
    """Choose whether a step refactorizes before its first iteration, and from which matrices.

    Where every step takes a matrix, old element matrices cost a chain up to one iteration a step.
    """
    clock, control = state.clock, state.control
    control.fresh = 0
    if clock.factor_step != clock.current_step:
        control.wanted = EVALUATED
    renewed, left = control.wanted == RENEWED, control.back_off_left > 0
    if left and (renewed or control.wanted == KEPT):
        control.back_off_left -= 1
        control.wanted = EVALUATED if control.age >= OLDEST_ROTATED else ROTATED
    if renewed:
        control.wanted = ROTATED


@compiled(forceinline=True)
def want_matrix(system, state):
    """Ask for a refactorization within a step.

    If rotated body matrices are enough, the next steps begin with such a refresh. The back-off,
    their number, doubles until a step converges without any refactorization.
    """
    control = state.control
    control.wanted = next_matrix(system, state)
    if control.wanted == ROTATED:
        control.back_off = min(2 * control.back_off + 1, LONGEST_BACK_OFF)
        control.back_off_left = control.back_off


@compiled(forceinline=True)
def forget_matrix(state):
    """Reset what is known of the convergence with the bodies' old element matrices."""
    clock, control = state.clock, state.control
    control.age, clock.baseline_contraction, clock.excess = 0, 0.5, 0.0
    clock.factor_step, control.refreshed = clock.current_step, 0


@compiled(forceinline=True)
def count_matrix(state, wanted):
    """Reset what belongs to the old matrix, before the new one is factorized."""
    control = state.control
    if wanted == EVALUATED:
        forget_matrix(state)
    else:
        control.refreshed += 1
    control.wanted = KEPT
    control.secant = 0
    control.fresh += 1
    control.matrices += 1


@compiled(forceinline=True)
def watch_age(state):
    """Ask for new element matrices once the old ones have cost as much as a refactorization.

    Counted are the iterations beyond those that the baseline contraction would have needed. Very
    old ones go even if they cost nothing: what they leave of the error, within the tolerance, has
    the same sign in every step of a steady motion, and the energy drifts. Every 3000 steps new
    matrices take half a percent of the time.
    """
    clock, control = state.clock, state.control
    control.age += 1
    if control.age > OLDEST:
        control.wanted = EVALUATED
    if control.iteration < 2:
        return
    if control.age <= BASELINE_STEPS:
        clock.baseline_contraction = min(clock.baseline_contraction,
                                          max(clock.contraction, FASTEST))
        return
    needed, left = 1, clock.span        # one, and one for every factor that is left
    while needed < control.iteration and left > 1.0:
        needed, left = needed + 1, left * clock.baseline_contraction
    clock.excess += control.iteration - needed
    if clock.excess > REFACTORIZATION_COST:
        control.wanted = EVALUATED
