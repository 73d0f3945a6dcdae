"""Newton's iteration of a step, and why a step that has converged is refused.

One text for a member and for eight. `active` is a truth, or that of each member; what members in
lanes need beside their system and state is in `members`, which is None in single runs. Elements are
evaluated, and matrices made, by other functions in lanes: see `sebody.engine.lanes`.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK, RESIDUAL, TANGENT
from sebody.engine.aid import aided
from sebody.engine.calls import call_refactorize, call_share
from sebody.engine.evaluate import (
    run_elements,
    run_moved,
    set_tangent_operators,
    sum_forces,
    take_rates,
    to_body_axes,
)
from sebody.engine.growth import grows
from sebody.engine.guard import contact_too_fast
from sebody.engine.matrix import solve
from sebody.engine.newton import HUGE, correct, count_matrix, take_shift, want_matrix
from sebody.engine.selection import any_true, either
from sebody.engine.state import (
    ANEW,
    CONTACT,
    EVALUATED,
    FACTORS,
    GAP,
    GIVE_UP,
    GO_ON,
    GROWS,
    KEPT,
    LEAVES_GAP,
    NEW_MATRIX,
    NO_AID,
    NO_REASON,
    NOT_FINITE,
    SHARE_MOVED,
    SLOW,
    SOLUTION,
)
from sebody.engine.vectors import swap
from sebody.engine.work import add_work, unknown_work


@compiled(forceinline=True)
def iterate(system, state, members, scheme, active, dense):
    """Newton's iteration of a step; returns why it failed, NO_REASON where it has converged.

    With ANEW the step is to be made once more, with new matrices.
    """
    control, iteration = state.control, 0
    mixed = not dense and not scheme.stabilized
    reason = 0 * control.iteration
    while any_true(active):
        wanted = active & (control.wanted != KEPT)
        status = _evaluate(system, state, members, scheme, active, wanted,
                           mixed and iteration > 1)
        if status != OK:
            return either(active, status, reason)
        if any_true(wanted):
            reason = either(wanted, make_matrix(system, state, members, wanted, dense), reason)
            active = active & (reason == NO_REASON)
            if not any_true(active):
                break
        if not _solve(system, state, members, active, scheme.stabilized, dense):
            return either(active, NO_AID, reason)
        verdict = correct(system, state, scheme, active, iteration, mixed)
        reason = _conclude(system, state, active, verdict, reason)
        active = active & ((verdict == GO_ON) | (verdict == NEW_MATRIX))
        iteration += 1
    return reason


@compiled(forceinline=True)
def _evaluate(system, state, members, scheme, active, wanted, settled):
    """Evaluate forces and wanted element matrices of the iterate; returns the kernels' status.

    `settled` tells whether corrections are small, so that some elements may keep their forces.
    """
    of_moved = (settled and system.links.dependent.shape[0] == 0
                and system.control.flowing.size == 0)       # which push what has not moved
    status = run_wanted(system, state, members, active, wanted, of_moved)
    if status != OK:
        return status
    sum_forces(system, state, state.residual)
    if any_true(wanted) and system.links.dependent.shape[0] > 0:
        for i in range(state.residual.size):
            state.forces[i] = state.residual[i]
    if scheme.stabilized:
        status = take_rates(system, state)
        if status != OK:
            return status
        to_body_axes(system, state.frames, state.constraint_residuals, False)
    to_body_axes(system, state.frames, state.residual, False)
    return np.int64(OK)


@compiled(forceinline=True)
def run_wanted(system, state, members, active, wanted, of_moved):
    """Evaluate elements, perhaps those that moved alone; returns the kernels' status."""
    kind = state.control.wanted
    if kind == EVALUATED:
        set_tangent_operators(system, state)
    of_moved = of_moved and not wanted
    if system.routines[3] != 0:
        return call_share(system.routines[3], system, state, SHARE_MOVED if of_moved else kind, 0)
    if of_moved:
        return run_moved(system, state)
    return run_elements(TANGENT if kind == EVALUATED else RESIDUAL,
                        RESIDUAL if kind == KEPT else TANGENT, system, state)


@compiled(forceinline=True)
def make_matrix(system, state, members, wanted, dense):
    """Make and factorize the matrix of the iteration; returns why there is none, or NO_REASON."""
    kind = state.control.wanted
    count_matrix(state, wanted, kind == EVALUATED)
    if not call_refactorize(system.routines[0], system, state, kind, dense):
        return NOT_FINITE
    if state.control.pivoted == 1 and not aided(system, FACTORS):
        return NO_AID
    return NO_REASON


@compiled(forceinline=True)
def _solve(system, state, members, active, shifts, dense):
    """Solve for the correction, with index 2 for the shift of positions first; False without aid.
    """
    if shifts:
        swap(state.residual, state.constraint_residuals)
    while True:
        # the only call: with two calls it would not be inlined
        if not solve_active(system, state, members, active, dense):
            return False
        if not shifts:
            return True
        take_shift(system, state)
        shifts = False


@compiled(forceinline=True)
def solve_active(system, state, members, active, dense):
    """Solve for the correction; False without aid."""
    if state.control.pivoted == 0:
        solve(system, state, dense)
        return True
    return aided(system, SOLUTION)


@compiled(forceinline=True)
def _conclude(system, state, active, verdict, reason):
    """Ask for the matrix that a verdict demands; returns why steps have failed."""
    wanting = active & (verdict == NEW_MATRIX)
    if any_true(wanting):
        want_matrix(system, state, wanting)
    failed = active & ((verdict == GIVE_UP) | (verdict == LEAVES_GAP))
    # perhaps because of the old matrix: then the step is made once more, with a new one
    why = either(state.control.fresh > 0, either(verdict == GIVE_UP, SLOW, GAP), ANEW)
    why = either(state.clock.last_norm < HUGE, why, NOT_FINITE)
    return either(failed, why, reason)


@compiled(forceinline=True)
def guard_contacts(system, state, reason):
    """The reason why a step fails: one that has converged may be too long for a contact."""
    if system.guarded.size == 0:
        return reason
    return either((reason == NO_REASON) & contact_too_fast(system, state), CONTACT, reason)


@compiled(forceinline=True)
def guard_works(system, state, members, converged):
    """Add the works of a step; why it is refused for them or for its energies, or NO_REASON."""
    add_work(system, state, state.clock.current_step)
    unknown = unknown_work(state)
    growing = grows(system, state, members, converged & (unknown == 0.0))
    return either(converged & (unknown != 0.0), NOT_FINITE, either(growing, GROWS, NO_REASON))
