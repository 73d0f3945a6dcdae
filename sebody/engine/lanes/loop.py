"""The compiled loop for eight members with fixed steps: see `sebody.engine.loop`.

Predictions, iterations and guards are the functions of that loop, compiled for lanes.
What a member does next follows from its own numbers alone, so results do not depend on which
members are run together: a member that has converged, or keeps its matrix, keeps its numbers while
others go on. Members with a rejected step go alone until they can come back, see
`engine.lanes.apart`. One that fails there gives up, and is run alone from its start.
"""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import bits_of, every, some, spread, where
from sebody.contract.layout import RECORD_ITERATIONS, RECORD_T
from sebody.contract.member_row import RUNNING
from sebody.engine.calls import call_samples
from sebody.engine.control_data import NEXT
from sebody.engine.iteration import guard_contacts, guard_works, iterate
from sebody.engine.lanes.apart import (
    APART,
    GAVE_UP,
    JUMPS,
    RUNS,
    jump_is_ahead,
    run_apart,
    show,
    take_apart,
)
from sebody.engine.lanes.evaluated import write_evaluated
from sebody.engine.newton import begin_with_matrix
from sebody.engine.step import begin_step, count_step, renew_bodies
from sebody.engine.step_control import NEAR


@compiled(nogil=True)
def advance(system, state, scratch, together, apart, record, scheme, last_grid, dense):
    """Run until `last_grid`, or until no member is left that has not given up; the step reached."""
    control = state.control
    if control.grid == 0:
        _write(system, state, scratch, apart, record)
    while control.grid < last_grid:
        if every(control.reason == GAVE_UP):
            return control.grid
        if system.corners.size > 0 and jump_is_ahead(system, state):
            control.reason = where(control.reason == RUNS, spread(JUMPS), control.reason)
        running = control.reason == RUNS
        if some(running):
            reason = _attempt(system, state, (scratch, apart, together), scheme, running, dense)
            control.reason = where(running, reason, control.reason)
        if some(control.reason > RUNS):
            take_apart(state, apart)
        # rotations of all members become orthogonal at the same steps of the grid
        count_step(system, state, control.grid)
        control.grid += 1
        state.clock.time = control.grid * state.clock.step
        if 0.0 <= state.memory[NEXT] <= state.clock.time + NEAR * state.clock.step:
            call_samples(apart.routines[1], system, state, scratch, apart, dense)
        if some(control.reason == APART):
            run_apart(state, apart, scheme, dense)
        if control.grid % record.every[0] == 0:
            _write(system, state, scratch, apart, record)
    return control.grid


@compiled(forceinline=True)
def _attempt(system, state, members, scheme, running, dense):
    """Make a step; returns why it is refused for members that are running: see `loop._attempt`."""
    renew_bodies(system, state, members, scheme, running)
    begin_step(system, state, scheme)
    begin_with_matrix(state)
    reason = guard_contacts(system, state, iterate(system, state, members, scheme, running, dense))
    converged = running & (reason == RUNS)
    members[0].table[RUNNING] = bits_of(converged)
    return reason + guard_works(system, state, members, converged)


@compiled(forceinline=True)
def _write(system, state, scratch, apart, record):
    """Store the numbers of the accepted state that are asked for."""
    row = state.control.recorded
    if some(state.control.reason == APART):
        show(state, apart, record.shown)
    state.now[RECORD_T] = spread(state.clock.time)
    state.now[RECORD_ITERATIONS] = state.control.iterations
    for k in range(record.places.size):
        record.rows[row, k] = state.now[record.places[k]]
    if record.evaluated.shape[0] > 0:
        write_evaluated(system, state, scratch, record, row)
    state.control.recorded = row + 1


@compiled(nogil=True)
def rows_of(table, member, rows):
    """Recorded states of one member from those of all, (records, numbers, members)."""
    for k in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            rows[k, i] = table[k, i, member]
