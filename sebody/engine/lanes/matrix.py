"""Matrices of eight members: each is made alone, by the functions of single runs, or all at once.

A member's own arrays get its numbers for this, see `sebody.engine.lanes.apart`. Factors with row
exchanges stay there: its aid makes them, and solves with them.

Members want matrices at different times. A matrix made alone costs an eighth of eight made
together, so it pays for each that is not wanted. Large models of bodies that rotate against each
other want one in nearly every step: see `sebody.engine.lanes.together`.
"""

import math

import numpy as np

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import chosen_in, number_of, some, spread, with_number
from sebody.contract.counts import MEMBERS
from sebody.contract.layout import OK, TANGENT
from sebody.engine import iteration, step
from sebody.engine.aid import aided
from sebody.engine.calls import call_refactorize, call_refactorize_together
from sebody.engine.evaluate import run_kernels, set_tangent_operators
from sebody.engine.lanes.apart import GAVE_UP, give, of_member, take
from sebody.engine.lanes.together import EVALUATED as NEW_BODIES, MADE, WANTED
from sebody.engine.matrix import solve
from sebody.engine.newton import count_matrix
from sebody.engine.selection import either
from sebody.engine.state import EVALUATED, FACTORS, NO_REASON, NOT_FINITE, ROTATED, SOLUTION
from sebody.engine.vectors import copy


@in_lanes_of(iteration.make_matrix)
def make_matrix(system, state, members, wanted, dense):
    """Make the matrices of some members; returns why they have none, NO_REASON or GAVE_UP."""
    scratch, apart, together = members
    evaluated = wanted & (state.control.wanted == EVALUATED)
    state.control.regularized = system.regularized[0]
    count_matrix(state, wanted, evaluated)
    apart.exchanged[0] = either(wanted, 0.0, apart.exchanged[0])
    found, missing = spread(0.0), wanted
    if together.routine[0] != 0:
        found = _factorize_all(system, state, together, wanted, evaluated)
        missing = found == GAVE_UP
    for member in range(MEMBERS):
        if chosen_in(missing, member):
            take(apart, apart.carried, member)
            kind = EVALUATED if chosen_in(evaluated, member) else ROTATED
            why = _factorize_one(state, apart, scratch.frames, dense, member, kind, True)
            found = with_number(found, member, why)
    return found


@in_lanes_of(step.evaluate_bodies)
def evaluate_bodies(system, state, members, renewed):
    """Make element matrices of bodies of some members; returns who has them."""
    scratch, apart, together = members
    renewed = renewed & (apart.exchanged[0] == 0.0)
    if together.routine[0] != 0:
        copy(state.frames, scratch.frames)      # which `Together.begun` are
        _ask(together, renewed & ~renewed, renewed)
        call_refactorize_together(together.routine[0], system, state, together)
        return renewed
    made = spread(0.0)
    for member in range(MEMBERS):
        if chosen_in(renewed, member) and _renew_one(state, apart, member):
            made = with_number(made, member, 1.0)
    return made > 0.0


@in_lanes_of(iteration.solve_active)
def solve_active(system, state, members, active, dense):
    """Solve for corrections of the active members, those of others are zero."""
    apart = members[1]
    solve(system, state, dense)
    for i in range(system.diagonal.size):
        state.correction[i] = either(active, state.correction[i], 0.0)
    exchanged = active & (apart.exchanged[0] > 0.0)
    if some(exchanged):
        for member in range(MEMBERS):
            if chosen_in(exchanged, member):
                _solve_one(system, state, apart, member)
    return True


@compiled
def _solve_one(system, state, apart, member):
    """Solve for the correction of a member whose factors have row exchanges."""
    own_system, own = of_member(apart, member)
    for i in range(system.diagonal.size):
        own.residual[i] = number_of(state.residual[i], member)
    good = aided(own_system, SOLUTION)
    for i in range(system.diagonal.size):
        found = own.correction[i] if good else math.nan
        state.correction[i] = with_number(state.correction[i], member, found)


@compiled(forceinline=True)
def _ask(together, wanted, evaluated):
    """Note who wants a matrix, and whose bodies' matrices are to be new."""
    together.asked[WANTED] = either(wanted, 1.0, 0.0)
    together.asked[NEW_BODIES] = either(evaluated, 1.0, 0.0)


@compiled
def _renew_one(state, apart, member):
    """Make the element matrices of a member; returns whether its bodies have frames."""
    system, one = of_member(apart, member)
    take(apart, apart.taken, member)
    set_tangent_operators(system, one)
    if run_kernels(TANGENT, 0, system.first_joint[0], system, one) != OK:
        return False
    for k in range(one.T.size):
        state.T[k] = with_number(state.T[k], member, one.T[k])
    for k in range(one.frames.size):
        state.frames[k] = with_number(state.frames[k], member, one.frames[k])
    return True


@compiled(forceinline=True)
def _factorize_all(system, state, together, wanted, evaluated):
    """Make the matrices of all members; returns why they have none, NO_REASON or GAVE_UP."""
    _ask(together, wanted, evaluated)
    call_refactorize_together(together.routine[0], system, state, together)
    size = spread(0.0)
    for i in range(state.residual.size):
        size = size + abs(state.residual[i])
    small = either(size < math.inf, GAVE_UP, NOT_FINITE)
    return either(wanted & (together.asked[MADE] == 0.0), small, NO_REASON)


@compiled
def factorize_masses(state, apart, begun, dense, wanted):
    """Make the matrices of masses and constraints of some members; returns those that have them.

    Matrices of bodies that belong to the steps are kept.
    """
    made = spread(0.0)
    for member in range(MEMBERS):
        if chosen_in(wanted, member):
            if _factorize_one(state, apart, begun, dense, member, EVALUATED, False) == NO_REASON:
                made = with_number(made, member, 1.0)
    return made > 0.0


@compiled
def _factorize_one(state, apart, begun, dense, member, wanted, of_step):
    """Make the matrix of a member; returns why it has none, NO_REASON or GAVE_UP.

    Accelerations at samples are given up where a run alone needs row exchanges.
    """
    system, one = of_member(apart, member)
    take(apart, apart.taken, member)
    one.clock.floor = number_of(state.clock.floor, member)
    one.control.age = np.int64(number_of(state.control.age, member))
    one.control.refreshed = one.control.restart = 0
    first = system.first_joint[0]
    if wanted == EVALUATED:
        first = 0
        if of_step:
            set_tangent_operators(system, one)
        for k in range(begun.size):
            one.frames[k] = number_of(begun[k], member)
    if not of_step:
        _swap_bodies(system, one)
    status = run_kernels(TANGENT, first, system.address.size, system, one)
    made = status == OK and call_refactorize(system.routines[0], system, one, wanted, dense)
    if not of_step:
        _swap_bodies(system, one)
    state.clock.floor = with_number(state.clock.floor, member, one.clock.floor)
    if not made:
        return NOT_FINITE
    if not dense and one.control.pivoted == 1:
        if not of_step or not aided(system, FACTORS):
            return GAVE_UP
        apart.exchanged[0] = with_number(apart.exchanged[0], member, 1.0)
    if one.control.regularized != state.control.regularized:
        return GAVE_UP
    give(apart, apart.returned, member)
    return NO_REASON


@compiled
def _swap_bodies(system, state):
    """Put element matrices of bodies aside where factors are kept, or take them back."""
    if state.spare.size > 0:
        of_bodies = system.at_J[system.first_joint[0]]
        first = state.spare.size - of_bodies
        for k in range(of_bodies):
            state.spare[first + k], state.J[k] = state.J[k], state.spare[first + k]
