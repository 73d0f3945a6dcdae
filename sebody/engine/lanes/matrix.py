"""Matrices of eight members: each is made alone, by the functions of single runs, or all at once.

Members want matrices at different times. A matrix made alone costs an eighth of eight made
together, so it pays for each that is not wanted. Large models of bodies that rotate against each
other want one in nearly every step: see `sebody.engine.lanes.together`.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import chosen_in, number_of, spread, with_number
from sebody.contract.counts import MEMBERS
from sebody.contract.layout import OK, TANGENT
from sebody.engine import iteration, step
from sebody.engine.arrays import Arrays
from sebody.engine.calls import call_refactorize, call_refactorize_together
from sebody.engine.evaluate import run_kernels, set_tangent_operators
from sebody.engine.lanes.apart import GAVE_UP
from sebody.engine.lanes.together import EVALUATED as NEW_BODIES, MADE, WANTED
from sebody.engine.newton import count_matrix
from sebody.engine.selection import either
from sebody.engine.state import EVALUATED, NO_REASON, NOT_FINITE, ROTATED, State
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


@in_lanes_of(iteration.make_matrix)
def make_matrix(system, state, members, wanted, dense):
    """Make the matrices of some members; returns why they have none, NO_REASON or GAVE_UP."""
    scratch, alone, together = members
    clock, found = state.clock, spread(0.0)
    evaluated = wanted & (state.control.wanted == EVALUATED)
    state.control.regularized = system.regularized[0]
    count_matrix(state, wanted, evaluated)
    if together.routine[0] != 0:
        return _factorize_all(system, state, together, wanted, evaluated)
    for member in range(MEMBERS):
        if chosen_in(wanted, member):
            kind = EVALUATED if chosen_in(evaluated, member) else ROTATED
            why = _factorize_one(state, alone, scratch.frames, dense, member, kind, True)
            found = with_number(found, member, why)
            clock.floor = with_number(clock.floor, member, alone.state.clock.floor)
    return found


@in_lanes_of(step.evaluate_bodies)
def evaluate_bodies(system, state, members, renewed):
    """Make element matrices of bodies of some members; returns who has them."""
    scratch, alone, together = members
    if together.routine[0] != 0:
        copy(state.frames, scratch.frames)      # which `Together.begun` are
        _ask(together, renewed & ~renewed, renewed)
        call_refactorize_together(together.routine[0], system, state, together)
        return renewed
    made = spread(0.0)
    for member in range(MEMBERS):
        if chosen_in(renewed, member) and _renew_one(state, alone, member):
            made = with_number(made, member, 1.0)
    return made > 0.0


@compiled(forceinline=True)
def _ask(together, wanted, evaluated):
    """Note who wants a matrix, and whose bodies' matrices are to be new."""
    together.asked[WANTED] = either(wanted, 1.0, 0.0)
    together.asked[NEW_BODIES] = either(evaluated, 1.0, 0.0)


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
    """Make the matrices of all members; returns why they have none, NO_REASON or GAVE_UP."""
    _ask(together, wanted, evaluated)
    call_refactorize_together(together.routine[0], system, state, together)
    size = spread(0.0)
    for i in range(state.residual.size):
        size = size + abs(state.residual[i])
    small = either(size < math.inf, GAVE_UP, NOT_FINITE)
    return either(wanted & (together.asked[MADE] == 0.0), small, NO_REASON)


@compiled
def factorize_masses(state, alone, begun, dense, wanted):
    """Make the matrices of masses and constraints of some members; returns those that have them.

    Matrices of bodies that belong to the steps are kept.
    """
    clock, made = state.clock, spread(0.0)
    for member in range(MEMBERS):
        if chosen_in(wanted, member):
            if _factorize_one(state, alone, begun, dense, member, EVALUATED, False) == NO_REASON:
                made = with_number(made, member, 1.0)
            clock.floor = with_number(clock.floor, member, alone.state.clock.floor)
    return made > 0.0


@compiled
def _factorize_one(state, alone, begun, dense, member, wanted, of_step):
    """Make the matrix of a member; returns why it has none, NO_REASON or GAVE_UP.

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
        return NOT_FINITE
    if wanted == EVALUATED and of_step:
        for k in range(kept):
            alone.J[member, k] = one.J[k]
    made = call_refactorize(system.routines[0], system, one, wanted, dense)
    if not made:
        return NOT_FINITE
    if ((not dense and one.control.pivoted == 1)
            or one.control.regularized != state.control.regularized):
        return GAVE_UP
    for k in range(alone.returned.size):
        numbers[alone.returned[k], member] = floats[alone.returned[k]]
    return NO_REASON
