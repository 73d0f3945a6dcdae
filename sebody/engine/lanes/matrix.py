"""Matrices of eight members: each is made alone, by the functions of single runs, or all at once.

Members want matrices at different times. A matrix made alone costs an eighth of eight made
together, so it pays for each that is not wanted. Large models of bodies that rotate against each
other want one in nearly every step: see `sebody.engine.lanes.together`.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import chosen_in, number_of, some, spread, where, with_number
from sebody.contract.counts import MEMBERS
from sebody.contract.layout import OK, TANGENT
from sebody.engine.arrays import Arrays
from sebody.engine.calls import call_refactorize, call_refactorize_together
from sebody.engine.evaluate import run_kernels, set_tangent_operators
from sebody.engine.lanes.apart import CUT, GAVE_UP, RUNS
from sebody.engine.lanes.together import EVALUATED as NEW_BODIES, MADE, WANTED
from sebody.engine.newton import OLDEST_ROTATED
from sebody.engine.state import EVALUATED, KEPT, RENEWED, ROTATED, State
from sebody.engine.step import FIRST_RENEWED, set_coefficients
from sebody.engine.system import System
from sebody.engine.vectors import copy


@dataclass(frozen=True, eq=False)
class Alone(Arrays):
    """A single run, which gets the numbers of a member while its matrix is made.

    ==================  ============================================================================
    system, state       of the run
    floats              (size,) its numbers
    numbers             (size, members) those of all members
    taken, returned     places in both: of what matrices depend on, of what is made with them
    J                   (members, size) element matrices of bodies, where they are rotated later
    ==================  ============================================================================
    """

    system: System
    state: State
    floats: NDArray
    numbers: NDArray
    taken: NDArray
    returned: NDArray
    J: NDArray


@compiled
def factorize(system, state, alone, together, begun, dense, wanted, evaluated):
    """Make the matrices of some members; returns those that leave.

    Parameters
    ----------
    begun : (9 b,)
        Frames before the iterate was evaluated.
    wanted, evaluated : mask
        Members that want a matrix, and those among them whose bodies' matrices are to be new.
    """
    control, clock, zero = state.control, state.clock, spread(0.0)
    control.regularized = system.regularized[0]
    found = zero
    if together.routine[0] != 0:
        found = _factorize_all(system, state, together, wanted, evaluated)
    else:
        for member in range(MEMBERS):
            if chosen_in(wanted, member):
                kind = EVALUATED if chosen_in(evaluated, member) else ROTATED
                why = _factorize_one(state, alone, begun, dense, member, kind, True)
                found = with_number(found, member, why)
                clock.floor = with_number(clock.floor, member, alone.state.clock.floor)
    failed = found != RUNS
    _forget(state, evaluated)
    control.wanted = where(wanted, spread(float(KEPT)), control.wanted)
    one = where(wanted, spread(1.0), zero)
    control.secant = where(wanted, zero, control.secant)
    control.fresh += one
    control.matrices += one
    control.reason = where(failed, found, control.reason)
    return failed


@compiled(forceinline=True)
def _forget(state, evaluated):
    """Reset what some members know of the convergence with old element matrices."""
    clock, control, zero = state.clock, state.control, spread(0.0)
    clock.factor_step = where(evaluated, spread(clock.current_step), clock.factor_step)
    clock.baseline_contraction = where(evaluated, spread(0.5), clock.baseline_contraction)
    clock.excess = where(evaluated, zero, clock.excess)
    control.age = where(evaluated, zero, control.age)


@compiled
def renew_bodies(system, state, scratch, alone, together, scheme, running):
    """Make new element matrices of members before their step: see `sebody.engine.step`."""
    control, clock = state.control, state.clock
    if system.first_joint[0] == 0 or system.regularized[0] == 1 or state.spare.size > 0:
        return
    aged = ((control.wanted == float(KEPT)) & (control.back_off_left > 0.0)
            & (control.age >= float(OLDEST_ROTATED)))
    renewed = (running & (clock.factor_step == spread(clock.current_step))
               & (control.iteration > 0.0) & (control.steps >= float(FIRST_RENEWED))
               & (aged | (control.wanted == float(EVALUATED))))
    if not some(renewed):
        return
    set_coefficients(state, scheme, clock.current_step)
    if together.routine[0] != 0:
        asked, zero, one = together.asked, spread(0.0), spread(1.0)
        copy(state.frames, scratch.frames)      # which `Together.begun` are
        asked[WANTED], asked[NEW_BODIES] = zero, where(renewed, one, zero)
        call_refactorize_together(together.routine[0], system, state, together)
    else:
        made = spread(0.0)
        for member in range(MEMBERS):
            if chosen_in(renewed, member) and _renew_one(state, alone, member):
                made = with_number(made, member, 1.0)
        renewed = made > 0.0
    _forget(state, renewed)
    control.wanted = where(renewed, spread(float(RENEWED)), control.wanted)


@compiled
def _renew_one(state, alone, member):
    """Make the element matrices of a member; returns whether its bodies have frames."""
    system, one, floats, numbers = alone.system, alone.state, alone.floats, alone.numbers
    for k in range(alone.taken.size):
        floats[alone.taken[k]] = numbers[alone.taken[k], member]
    set_tangent_operators(system, one)
    if run_kernels(TANGENT, 0, system.first_joint[0], system, one) != OK:
        return False
    for k in range(alone.J.shape[1]):
        alone.J[member, k] = one.J[k]
    for k in range(one.T.size):
        state.T[k] = with_number(state.T[k], member, one.T[k])
    for k in range(one.frames.size):
        state.frames[k] = with_number(state.frames[k], member, one.frames[k])
    return True


@compiled(forceinline=True)
def _factorize_all(system, state, together, wanted, evaluated):
    """Make the matrices of all members; returns whether each goes on, or why it leaves."""
    asked, zero, one = together.asked, spread(0.0), spread(1.0)
    asked[WANTED], asked[NEW_BODIES] = where(wanted, one, zero), where(evaluated, one, zero)
    call_refactorize_together(together.routine[0], system, state, together)
    size = zero
    for i in range(state.residual.size):
        size = size + abs(state.residual[i])
    small = where(size < math.inf, spread(GAVE_UP), spread(CUT))
    return where(wanted & (asked[MADE] == 0.0), small, spread(RUNS))


@compiled
def factorize_masses(state, alone, begun, dense, wanted):
    """Make the matrices of masses and constraints of some members; returns those that have them.

    Matrices of bodies that belong to the steps are kept.
    """
    clock, made = state.clock, spread(0.0)
    for member in range(MEMBERS):
        if chosen_in(wanted, member):
            if _factorize_one(state, alone, begun, dense, member, EVALUATED, False) == RUNS:
                made = with_number(made, member, 1.0)
            clock.floor = with_number(clock.floor, member, alone.state.clock.floor)
    return made > 0.0


@compiled
def _factorize_one(state, alone, begun, dense, member, wanted, of_step):
    """Make the matrix of a member; returns whether it goes on, or why it leaves.

    It gives up where a run alone needs row exchanges.
    """
    system, one, floats, numbers = alone.system, alone.state, alone.floats, alone.numbers
    for k in range(alone.taken.size):
        floats[alone.taken[k]] = numbers[alone.taken[k], member]
    one.clock.floor = number_of(state.clock.floor, member)
    one.control.age = np.int64(number_of(state.control.age, member))
    first, kept = system.first_joint[0], alone.J.shape[1]
    if wanted == EVALUATED:
        first = 0
        if of_step:
            set_tangent_operators(system, one)
        for k in range(begun.size):
            one.frames[k] = number_of(begun[k], member)
    else:
        for k in range(kept):
            one.J[k] = alone.J[member, k]
    if run_kernels(TANGENT, first, system.address.size, system, one) != OK:
        return CUT
    if wanted == EVALUATED and of_step:
        for k in range(kept):
            alone.J[member, k] = one.J[k]
    made = call_refactorize(system.routines[0], system, one, wanted, dense)
    if not made:
        return CUT
    if ((not dense and one.control.pivoted == 1)
            or one.control.regularized != state.control.regularized):
        return GAVE_UP
    for k in range(alone.returned.size):
        numbers[alone.returned[k], member] = floats[alone.returned[k]]
    return RUNS
