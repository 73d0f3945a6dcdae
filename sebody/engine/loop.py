"""The compiled time loop: generalized-alpha on the Lie group, modified Newton, step control.

One loop for every scene: it works on flat arrays, returns a code and can be called again to go on.
What it lacks, such as factors with row exchanges, it asks its aid for, see `sebody.engine.aid`.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.engine.calls import call_restart, call_sample
from sebody.engine.control_data import NEXT
from sebody.engine.iteration import guard_contacts, guard_works, iterate
from sebody.engine.newton import begin_with_matrix
from sebody.engine.state import ANEW, CHUNK, DONE, FAILED, INACCURATE, NO_AID, NO_REASON
from sebody.engine.step import accept, back, begin_step, cut_step, renew_bodies, write_record
from sebody.engine.step_control import (
    NEAR,
    SHORTEST,
    accurate,
    choose_part,
    choose_step,
    write_between,
)
from sebody.engine.work import take_back_work


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
        # rows lie on the grid of output, not at the ends of chosen steps
        if control.adaptive == 1:
            write_between(system, state, record, last_grid)
        # a sample sets inputs, and what it sets may jump: the restart comes after it
        if control.restart != 0:
            code = np.int64(DONE)
            if 0.0 <= state.memory[NEXT] <= state.clock.time + NEAR * state.clock.step:
                code = call_sample(system.routines[2], system, state)
            if code == DONE and control.restart != 0:
                code = call_restart(system.routines[1], system, state, ahead, dense)
            if code != DONE:
                return code
            # a row that is due at a jump has waited for the accelerations after it
            if control.due == 1:
                write_record(state, record)
            continue
        if control.grid >= last_grid:
            return DONE
        # the caller looks at signals and makes room for rows now and then
        if steps >= chunk:
            return CHUNK
        steps += 1
        if control.adaptive == 1:
            choose_step(system, state)
        elif system.corners.size > 0:
            choose_part(system, state)
        reason = _attempt(system, state, scheme, dense)
        if reason == NO_REASON:
            accept(system, state, record)
            continue
        back(state)
        if reason != ANEW:
            control.reason = reason
            # an inaccurate step is cut already
            if reason == INACCURATE or reason == NO_AID or not cut_step(state):
                return FAILED


@compiled(forceinline=True)
def _attempt(system, state, scheme, dense):
    """Make a step; returns why it is refused, with ANEW to be made once more, or NO_REASON."""
    renew_bodies(system, state, None, scheme, True)
    begin_step(system, state, scheme)
    begin_with_matrix(state)
    reason = guard_contacts(system, state, iterate(system, state, None, scheme, True, dense))
    if reason != NO_REASON:
        return reason
    if state.control.adaptive == 1 and not accurate(system, state, scheme):
        return INACCURATE if state.clock.chosen < SHORTEST * state.clock.step else ANEW
    reason = guard_works(system, state, None, True)
    if reason != NO_REASON:
        take_back_work(state)
    return reason
