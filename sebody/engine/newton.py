"""Modified Newton iteration of a step: corrections, convergence, when to refactorize.

The factorized matrix is kept in body axes and reused until slow convergence asks for a new one.
"""

import math

from sebody.compiler.decorators import ANY_ORDER, compiled
from sebody.contract.layout import C_DAMPING, C_MASS
from sebody.engine.evaluate import to_body_axes, update_rotations
from sebody.engine.matrix import ROUNDING
from sebody.engine.regularization import regularized_norms
from sebody.engine.selection import any_true, either
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
HUGE = 1e300            # a norm above this is no number, or as good as none
QUICK = 0.05            # a contraction rate below this needs no acceleration by mixing


@compiled(forceinline=True)
def correct(system, state, scheme, active, iteration, mixed):
    """Subtract the solved correction; the verdict on the step, CONVERGED to GIVE_UP.

    In lanes, of the `active` members, whose corrections alone are not zero. A correction that is no
    number is not subtracted.
    """
    clock, n = state.clock, system.diagonal.size
    norm, size, accelerations = (regularized_norms(system, state, n)
                                 if state.control.regularized == 1 else norms(system, state, n))
    sound = active & (norm < HUGE)
    if any_true((norm >= HUGE) | (norm != norm)):
        for i in range(n):
            state.correction[i] = either(norm < HUGE, state.correction[i], 0.0)
    left_norm = accelerate(system, state, sound, norm) if mixed else norm
    subtract(system, state, scheme, n)
    accelerations = max(scheme.beta * clock.current_step * clock.current_step * accelerations,
                        clock.acceleration_norm)
    target = min(scheme.tolerance * size,
                 ACCELERATION_TOLERANCE * scheme.tolerance * accelerations) + clock.floor
    clock.acceleration_norm = either(sound, accelerations, clock.acceleration_norm)
    clock.target = either(sound, target, clock.target)
    return _verdict(system, state, scheme, sound, iteration, norm, left_norm, target)


@compiled
def strayed(system, state, scheme):
    """Tell if a step ends half a radian, or half the model's size, from where its rates led.

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
    """Tell if a residual is left that the corrections of a regularized matrix cannot remove.

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
def _verdict(system, state, scheme, sound, iteration, norm, left_norm, target):
    """Count the iteration; convergence or the next action from its contraction rate."""
    clock, control, last = state.clock, state.control, state.clock.last_norm
    if iteration == 0:
        clock.span = either(sound, norm / target, clock.span)
    else:
        clock.contraction = either(sound & (last > 0.0), norm / last, clock.contraction)
    control.iteration = either(sound, control.iteration + 1, control.iteration)
    control.iterations = either(sound, control.iterations + 1, control.iterations)
    clock.last_norm = left_norm
    rate = min(max(clock.contraction, UNSURE if iteration == 0 else FASTEST), SLOWEST)
    unsettled = sound & (rate / (1.0 - rate) * left_norm > target)
    verdict = either(unsettled, GO_ON, CONVERGED)
    if any_true(unsettled):
        verdict = _next_action(system, state, verdict, unsettled, iteration, rate, norm, left_norm,
                               target)
    converged = sound & (verdict == CONVERGED)
    if state.control.regularized == 1:
        ended = sound & ((verdict == CONVERGED) | (verdict == GIVE_UP))
        if any_true(ended):
            gap = ended & leaves_gap(system, state, norm, scheme.stabilized)
            verdict = either(gap, LEAVES_GAP, verdict)
    if any_true(converged):
        verdict = either(converged & strayed(system, state, scheme), GIVE_UP, verdict)
    return either(norm < HUGE, verdict, GIVE_UP)


@compiled(forceinline=True)
def _next_action(system, state, verdict, unsettled, iteration, rate, norm, left_norm, target):
    """The verdict, with that of what has not converged put in."""
    fresh, rest = state.control.fresh, MAX_ITERATIONS - iteration - 1
    if rest <= 0:
        verdict = either(unsettled, GIVE_UP, verdict)
    elif iteration > 0:
        slow = unsettled & (fresh < MOST_MATRICES) & (
            (rate > POOR) | (_left(system, state, rest, rate, norm) > target))
        if iteration == 1:      # what the first correction bends the second one stretches
            slow = slow & ((fresh < 1) | (rate >= BENT))
        verdict = either(slow, NEW_MATRIX, verdict)
    if iteration > 2:
        hopeless = unsettled & (fresh > 2) & (rate > 0.9)
        rounded = either(left_norm <= ROUNDED * target, CONVERGED, GIVE_UP)
        verdict = either(hopeless, rounded, verdict)
    return verdict


@compiled(forceinline=True)
def _left(system, state, rest, rate, norm):
    """Norm after as many further corrections as the next matrix costs, or as are allowed."""
    cost = ROTATED_COST if state.inverse.size > 1 else ROTATED_BLOCKS_COST
    few = norm_after(norm, rate, min(cost, rest))
    many = norm_after(norm, rate, min(REFACTORIZATION_COST, rest))
    return either(state.control.fresh < system.linked[0], few, many)


@compiled(forceinline=True)
def norm_after(norm, rate, corrections):
    """Norm after some corrections, a multiple of a half, that shrink it by the same rate."""
    for _ in range(int(corrections)):
        norm = norm * rate
    return norm if corrections == int(corrections) else norm * math.sqrt(rate)


@compiled
def accelerate(system, state, sound, norm):
    """Anderson mixing with the last correction; returns the norm of the mixed correction.

    With matrices of the predicted state the error of a taut chain that rotates decays slowly in
    one direction, which mixing with one correction removes. The multipliers of a regularized
    matrix are too uncertain to be asked.
    """
    n, control = system.diagonal.size, state.control
    correction, last, change = state.correction, state.last_correction, state.last_change
    along = square = mix = 0.0 * state.clock.floor
    mixing = sound & (control.secant == 1) & (norm > QUICK * state.clock.last_norm)
    if any_true(mixing):
        for i in range(n):
            if control.regularized == 1 and system.is_multiplier[i] > 0.0:
                continue
            w = state.weight[i]
            difference = (correction[i] - last[i]) * w
            along += difference * correction[i] * w
            square += difference * difference
        mixing = mixing & (square > 0.0) & (abs(along) < square)
        mix = either(mixing, along / square, 0.0)
        norm = either(mixing, math.sqrt(max(norm * norm - along * mix, 0.0)), norm)
    control.secant = 1
    for i in range(n):
        d = correction[i]
        # a step that ended astray may have left no numbers in `change`
        mixed = either(mix != 0.0, d - mix * (change[i] + d - last[i]), d)
        change[i] = correction[i] = mixed
        last[i] = d
    return norm


@compiled(forceinline=True)
def begin_with_matrix(state):
    """Choose whether a step refactorizes before its first iteration, and from which matrices.

    Where every step takes a matrix, old element matrices cost a chain up to one iteration a step.
    In lanes members choose for themselves.
    """
    clock, control = state.clock, state.control
    control.fresh = 0
    control.wanted = either(clock.factor_step == clock.current_step, control.wanted, EVALUATED)
    renewed = control.wanted == RENEWED
    refreshed = (control.back_off_left > 0) & (renewed | (control.wanted == KEPT))
    control.back_off_left = either(refreshed, control.back_off_left - 1, control.back_off_left)
    control.wanted = either(refreshed, EVALUATED, control.wanted)
    rotated = renewed | (refreshed & (control.age < OLDEST_ROTATED))
    control.wanted = either(rotated, ROTATED, control.wanted)


@compiled(forceinline=True)
def want_matrix(system, state, wanting):
    """Ask for a refactorization within a step: with rotated matrices first, if they help, then new.

    If rotated body matrices are enough, the next steps begin with such a refresh. The back-off,
    their number, doubles until a step converges without any refactorization. In lanes, of the
    members that are `wanting`.
    """
    control = state.control
    rotated = wanting & (control.fresh < system.linked[0])
    control.wanted = either(wanting, either(rotated, ROTATED, EVALUATED), control.wanted)
    longer = min(2 * control.back_off + 1, LONGEST_BACK_OFF)
    control.back_off = either(rotated, longer, control.back_off)
    control.back_off_left = either(rotated, control.back_off, control.back_off_left)


@compiled(forceinline=True)
def forget_matrix(state, renewed):
    """Reset what is known of the convergence with the bodies' old element matrices.

    In lanes, of the members whose matrices are `renewed`.
    """
    clock, control = state.clock, state.control
    control.age = either(renewed, 0, control.age)
    control.refreshed = either(renewed, 0, control.refreshed)
    clock.baseline_contraction = either(renewed, 0.5, clock.baseline_contraction)
    clock.excess = either(renewed, 0.0, clock.excess)
    clock.factor_step = either(renewed, clock.current_step, clock.factor_step)


@compiled(forceinline=True)
def count_matrix(state, wanted, evaluated):
    """Reset what belongs to the old matrix, before the new one is factorized.

    In lanes, of the members that have `wanted` one; whose bodies' matrices are new, are among them.
    """
    control = state.control
    control.refreshed = either(wanted, control.refreshed + 1, control.refreshed)
    forget_matrix(state, evaluated)
    control.wanted = either(wanted, KEPT, control.wanted)
    control.secant = either(wanted, 0, control.secant)
    control.fresh = either(wanted, control.fresh + 1, control.fresh)
    control.matrices = either(wanted, control.matrices + 1, control.matrices)


@compiled(forceinline=True)
def watch_age(state):
    """Ask for new element matrices once the old ones have cost as much as a refactorization.

    Counted are the iterations beyond those that the baseline contraction would have needed. Very
    old ones go even if they cost nothing: what they leave of the error, within the tolerance, has
    the same sign in every step of a steady motion, and the energy drifts. Every 3000 steps new
    matrices take half a percent of the time. In lanes members count for themselves.
    """
    clock, control = state.clock, state.control
    control.age += 1
    counted = control.iteration > 1
    best = min(clock.baseline_contraction, max(clock.contraction, FASTEST))
    clock.baseline_contraction = either(counted & (control.age <= BASELINE_STEPS), best,
                                        clock.baseline_contraction)
    # one correction is needed, and one for every factor of the baseline that is left
    lost, left = control.iteration - 1.0, clock.span
    counted = counted & (control.age > BASELINE_STEPS)
    more = counted & (left > 1.0)
    while any_true(more):
        lost = either(more, lost - 1.0, lost)
        left = left * clock.baseline_contraction
        more = more & (lost > 0.0) & (left > 1.0)
    clock.excess = either(counted, clock.excess + lost, clock.excess)
    old = (control.age > OLDEST) | (counted & (clock.excess > REFACTORIZATION_COST))
    control.wanted = either(old, EVALUATED, control.wanted)
