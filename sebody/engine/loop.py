"""The compiled time loop: generalized-alpha on the Lie group, modified Newton, step control.

One loop for every scene: it works on flat arrays, returns a code and can be called again to go on.
What it lacks, such as factors with row exchanges, it asks its aid for, see `sebody.engine.aid`.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK, RESIDUAL, TANGENT
from sebody.engine.aid import aided
from sebody.engine.calls import call_refactorize, call_restart, call_sample, call_share
from sebody.engine.control_data import NEXT
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
from sebody.engine.newton import (
    HUGE,
    begin_with_matrix,
    correct,
    count_matrix,
    take_shift,
    want_matrix,
)
from sebody.engine.state import (
    CHUNK,
    CONTACT,
    CONVERGED,
    DONE,
    EVALUATED,
    FACTORS,
    FAILED,
    GAP,
    GIVE_UP,
    GO_ON,
    GROWS,
    INACCURATE,
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
from sebody.engine.step import accept, back, begin_step, cut_step, renew_bodies, write_record
from sebody.engine.step_control import (
    NEAR,
    SHORTEST,
    accurate,
    choose_part,
    choose_step,
    write_between,
)
from sebody.engine.vectors import swap
from sebody.engine.work import add_work, take_back_work, unknown_work


@compiled
def lead(scheme):
    """By how much auxiliary accelerations of a restart are ahead of the state, in steps."""
    return scheme.alpha_m - scheme.alpha_f if scheme.stabilized else 0.0


@compiled(nogil=True)
def advance(system, state, record, scheme, last_grid, chunk, dense):
    """Run until `last_grid` or for at most `chunk` steps; returns DONE, CHUNK or FAILED.

    Other threads of Python run meanwhile: no two simulations write to the same memory.
    """
    control = state.control
    ahead = lead(scheme)
    steps = 0
    while True:
        if control.adaptive == 1:
            write_between(system, state, record, last_grid)
        if control.restart != 0:
            code = np.int64(DONE)
            if 0.0 <= state.memory[NEXT] <= state.clock.time + NEAR * state.clock.step:
                code = call_sample(system.routines[2], system, state)
            if code == DONE and control.restart != 0:
                code = call_restart(system.routines[1], system, state, ahead, dense)
            if code != DONE:
                return code
            if control.due == 1:
                write_record(state, record)
            continue
        if control.grid >= last_grid:
            return DONE
        if steps >= chunk:
            return CHUNK
        steps += 1
        if control.adaptive == 1:
            choose_step(system, state)
        elif system.corners.size > 0:
            choose_part(system, state)
        renew_bodies(system, state, scheme)
        begin_step(system, state, scheme)
        begin_with_matrix(state)
        reason = _iterate(system, state, record, scheme, dense)
        if reason != NO_REASON:
            control.reason = reason
            back(state)
            # an inaccurate step is cut already
            if reason == INACCURATE or reason == NO_AID or not cut_step(state):
                return FAILED


@compiled(forceinline=True)
def _iterate(system, state, record, scheme, dense):
    """Newton's iteration of a step; returns why it failed.

    With NO_REASON the step is accepted, or the state is back where it was to be made anew.
    """
    control = state.control
    mixed = not dense and not scheme.stabilized
    while True:
        wanted = control.wanted
        status = _evaluate(system, state, scheme, wanted, mixed)
        if status != NO_REASON:
            return np.int64(status)
        if wanted != KEPT:
            count_matrix(state, wanted)
            if not call_refactorize(system.routines[0], system, state, wanted, dense):
                return np.int64(NOT_FINITE)
            if control.pivoted == 1 and not aided(system, FACTORS):
                return np.int64(NO_AID)
        if not _solve(system, state, scheme.stabilized, dense):
            return np.int64(NO_AID)
        verdict = correct(system, state, scheme, True, control.iteration, mixed)
        reason = np.int64(_conclude(system, state, record, scheme, verdict))
        if verdict != GO_ON and verdict != NEW_MATRIX:
            return reason


@compiled(forceinline=True)
def _solve(system, state, shifts, dense):
    """Solve for the correction, with index 2 for the shift of positions first; False without aid.
    """
    if shifts:
        swap(state.residual, state.constraint_residuals)
    while True:
        if state.control.pivoted == 0:
            solve(system, state, dense)     # the only call: with two calls it would not be inlined
        elif not aided(system, SOLUTION):
            return False
        if not shifts:
            return True
        take_shift(system, state)
        shifts = False


@compiled(forceinline=True)
def _evaluate(system, state, scheme, wanted, mixed):
    """Evaluate forces and wanted element matrices of the iterate; returns the kernels' status."""
    if wanted == EVALUATED:
        set_tangent_operators(system, state)
    of_moved = (wanted == KEPT and state.control.iteration > 1 and mixed
                and system.links.dependent.shape[0] == 0
                and system.control.flowing.size == 0)       # which push what has not moved
    if system.routines[3] != 0:
        status = call_share(system.routines[3], system, state,
                            SHARE_MOVED if of_moved else wanted, 0)
    elif of_moved:
        status = run_moved(system, state)
    else:
        status = run_elements(TANGENT if wanted == EVALUATED else RESIDUAL,
                              RESIDUAL if wanted == KEPT else TANGENT, system, state)
    if status != OK:
        return status
    sum_forces(system, state, state.residual)
    if wanted != KEPT and system.links.dependent.shape[0] > 0:
        for i in range(state.residual.size):
            state.forces[i] = state.residual[i]
    if scheme.stabilized:
        status = take_rates(system, state)
        if status != OK:
            return status
        to_body_axes(system, state.frames, state.constraint_residuals, False)
    to_body_axes(system, state.frames, state.residual, False)
    return OK


@compiled(forceinline=True)
def _conclude(system, state, record, scheme, verdict):
    """Act on the verdict about a correction; returns the reason if the step fails."""
    control, clock = state.control, state.clock
    if verdict == CONVERGED:
        if system.guarded.size > 0 and contact_too_fast(system, state):
            return CONTACT
        if control.adaptive == 1 and not accurate(system, state, scheme):
            back(state)
            return INACCURATE if clock.chosen < SHORTEST * clock.step else NO_REASON
        add_work(system, state, clock.current_step)
        if unknown_work(state) != 0.0:
            take_back_work(state)
            return NOT_FINITE
        if grows(system, state):
            take_back_work(state)
            return GROWS
        accept(system, state, record)
    elif verdict == NEW_MATRIX:
        want_matrix(system, state, True)
    elif verdict == GIVE_UP or verdict == LEAVES_GAP:
        if not clock.last_norm < HUGE:
            return NOT_FINITE
        if control.fresh > 0:
            return SLOW if verdict == GIVE_UP else GAP
        back(state)         # perhaps because of the old matrix: repeat the step with a new one
    return NO_REASON
