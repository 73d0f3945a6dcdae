"""Corrections, convergence and when to refactorize, member by member: `sebody.engine.newton`."""

import math

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import some, spread, where
from sebody.engine.lanes.apart import AGAIN, CUT
from sebody.engine.newton import (
    ACCELERATION_TOLERANCE,
    BASELINE_STEPS,
    BENT,
    FASTEST,
    LONGEST_BACK_OFF,
    MAX_ITERATIONS,
    MOST_MATRICES,
    OLDEST,
    OLDEST_ROTATED,
    POOR,
    QUICK,
    REFACTORIZATION_COST,
    ROTATED_COST,
    ROUNDED,
    SLOWEST,
    UNSURE,
    leaves_gap,
    norms,
    strayed,
    subtract,
)
from sebody.engine.regularization import regularized_norms
from sebody.engine.state import EVALUATED, KEPT, RENEWED, ROTATED

HUGE = 1e300            # a norm above this is no number, or as good as none


@compiled(forceinline=True)
def correct(system, state, scheme, active, iteration, mixed):
    """Subtract the correction of the active members; returns those that have to go on."""
    clock, h, n = state.clock, state.clock.current_step, system.diagonal.size
    norm, size, accelerations = (
        regularized_norms(system, state, n) if state.control.regularized == 1 else
        norms(system, state, n))
    none = active & ~(norm < HUGE)
    if some(none):      # their step is made anew: nothing of them is kept
        active = active & ~none
        for i in range(n):
            state.correction[i] = where(none, spread(0.0), state.correction[i])
    left_norm = accelerate(system, state, active, norm) if mixed else norm
    subtract(system, state, scheme, n)
    accelerations = max(scheme.beta * h * h * accelerations, clock.acceleration_norm)
    target = min(scheme.tolerance * size,
                 ACCELERATION_TOLERANCE * scheme.tolerance * accelerations) + clock.floor
    clock.acceleration_norm = where(active, accelerations, clock.acceleration_norm)
    clock.target = target
    return _verdict(system, state, scheme, active, none, norm, left_norm, iteration)


@compiled(forceinline=True)
def _verdict(system, state, scheme, active, none, norm, left_norm, iteration):
    """Count the iteration; the active members that have to go on. Those whose norm is none fail."""
    clock, control, target = state.clock, state.control, state.clock.target
    rate, last = clock.contraction, clock.last_norm
    if iteration == 0:
        clock.span = where(active, norm / target, clock.span)
    else:
        rate = where(active & (last > 0.0), norm / last, rate)
        clock.contraction = rate
    count = where(active, spread(1.0), spread(0.0))
    control.iteration += count
    control.iterations += count
    clock.last_norm = where(active, left_norm, last)
    rate = min(max(rate, spread(UNSURE if iteration == 0 else FASTEST)), spread(SLOWEST))
    done, failed = active & (rate / (1.0 - rate) * left_norm <= target), none
    if iteration > 2:       # where new matrices do not help, what is left is rounding
        hopeless = active & ~done & (control.fresh > 2.0) & (rate > 0.9)
        rounded = left_norm <= ROUNDED * target
        failed = failed | (hopeless & ~rounded)
        done = done | (hopeless & rounded)
    if some(done):
        failed = failed | (done & strayed(system, state, scheme))
        if control.regularized == 1:
            failed = failed | (done & leaves_gap(system, state, norm, scheme.stabilized))
    left = active & ~done & ~failed
    if some(left):
        if iteration >= MAX_ITERATIONS - 1:
            failed = failed | left
        if iteration > 0:
            _want_matrices(system, state, left, rate, norm, target, iteration)
    shorter = none | (control.fresh > 0.0)
    control.reason = where(failed, where(shorter, spread(CUT), spread(AGAIN)), control.reason)
    return left & ~failed


@compiled
def accelerate(system, state, active, norm):
    """Anderson mixing with the last correction; returns the norms of the mixed corrections."""
    n, control, zero = system.diagonal.size, state.control, spread(0.0)
    correction, last, change = state.correction, state.last_correction, state.last_change
    along = square = zero
    for i in range(n):
        if state.control.regularized == 1 and system.is_multiplier[i] > 0.0:
            continue
        w = state.weight[i]
        difference = (correction[i] - last[i]) * w
        along += difference * correction[i] * w
        square += difference * difference
    mixing = active & (control.secant == 1.0) & (norm > QUICK * state.clock.last_norm) & (
        square > 0.0) & (abs(along) < square)
    mix = where(mixing, along / square, zero)
    control.secant = spread(1.0)
    for i in range(n):
        d = correction[i]
        change[i] = correction[i] = where(mixing, d - mix * (change[i] + d - last[i]), d)
        last[i] = d
    return where(mixing, math.sqrt(max(norm * norm - along * mix, zero)), norm)


@compiled(forceinline=True)
def begin_with_matrix(state):
    """Choose which members factorize before their first iteration, and from which matrices."""
    control = state.control
    control.fresh = spread(0.0)
    control.wanted = where(state.clock.factor_step == spread(state.clock.current_step),
                           control.wanted, spread(float(EVALUATED)))
    renewed, left = control.wanted == float(RENEWED), control.back_off_left > 0.0
    rotated = left & (renewed | (control.wanted == float(KEPT)))
    control.back_off_left = where(rotated, control.back_off_left - 1.0, control.back_off_left)
    kind = where(control.age >= float(OLDEST_ROTATED), spread(float(EVALUATED)),
                 spread(float(ROTATED)))
    control.wanted = where(renewed, spread(float(ROTATED)),
                           where(rotated, kind, control.wanted))


@compiled(forceinline=True)
def _want_matrices(system, state, left, rate, norm, target, iteration):
    """Ask for matrices where the iterations to come cost more: the loop compares logarithms."""
    control, rest = state.control, MAX_ITERATIONS - iteration - 1
    rotated = left & (control.fresh == 0.0) & (spread(float(system.linked[0])) == 1.0)
    few = many = norm
    if state.inverse.size > 1:
        for _ in range(min(int(ROTATED_COST), rest)):
            few = few * rate
    elif rest > 0:
        few = few * rate * (math.sqrt(rate) if rest > 1 else 1.0)   # ROTATED_BLOCKS_COST
    for _ in range(min(int(REFACTORIZATION_COST), rest)):
        many = many * rate
    slow = left & (control.fresh < float(MOST_MATRICES)) & (
        (rate > POOR) | (where(rotated, few, many) > target))
    if iteration == 1:
        slow = slow & ~((control.fresh > 0.0) & (rate < BENT))
    rotated = slow & rotated
    control.back_off = where(rotated, min(2.0 * control.back_off + 1.0,
                                          spread(float(LONGEST_BACK_OFF))), control.back_off)
    control.back_off_left = where(rotated, control.back_off, control.back_off_left)
    control.wanted = where(slow, where(rotated, spread(float(ROTATED)), spread(float(EVALUATED))),
                           control.wanted)


@compiled(forceinline=True)
def watch_age(state):
    """Ask for new element matrices once the old ones have cost as much as a refactorization."""
    clock, control = state.clock, state.control
    control.age += 1.0
    old = control.age > float(OLDEST)
    counted = control.iteration >= 2.0
    young = counted & (control.age <= float(BASELINE_STEPS))
    clock.baseline_contraction = where(
        young, min(clock.baseline_contraction, max(clock.contraction, spread(FASTEST))),
        clock.baseline_contraction)
    grown = counted & ~young
    if some(grown):
        # iterations that the baseline rate would have needed: one, and one for every factor
        needed, left = spread(1.0), clock.span
        for _ in range(MAX_ITERATIONS):
            more = left > 1.0
            if not some(more & grown):
                break
            needed, left = where(more, needed + 1.0, needed), left * clock.baseline_contraction
        lost = max(control.iteration - needed, spread(0.0))
        clock.excess = where(grown, clock.excess + lost, clock.excess)
        old = old | (grown & (clock.excess > REFACTORIZATION_COST))
    control.wanted = where(old, spread(float(EVALUATED)), control.wanted)
