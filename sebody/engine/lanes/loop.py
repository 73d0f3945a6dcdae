"""The compiled loop for eight members with fixed steps: `sebody.engine.loop` with masks.

Predictions, forces, matrices and corrections are the functions of the loop, compiled for lanes.
What a member does next follows from its own numbers alone, so results do not depend on which
members are run together: a member that has converged, or keeps its matrix, keeps its numbers while
others go on. Members with a rejected step go alone until they can come back, see
`engine.lanes.apart`. One that would have to ask Python gives up, and is run alone from its start.
"""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import bits_of, every, some, spread, where
from sebody.contract.layout import RECORD_ITERATIONS, RECORD_T, RESIDUAL
from sebody.contract.member_row import RUNNING
from sebody.engine.calls import call_samples
from sebody.engine.control_data import NEXT
from sebody.engine.evaluate import run_kernels, sum_forces, take_rates, to_body_axes
from sebody.engine.guard import contact_too_fast
from sebody.engine.lanes.apart import (
    AGAIN,
    APART,
    CUT,
    GAVE_UP,
    JUDGED,
    JUMPS,
    RUNS,
    jump_is_ahead,
    run_apart,
    show,
    take_apart,
)
from sebody.engine.lanes.evaluated import write_evaluated
from sebody.engine.lanes.growth import grows
from sebody.engine.lanes.matrix import factorize, renew_bodies
from sebody.engine.lanes.moved import find_moved, keep_unmoved, run_moved
from sebody.engine.matrix import solve
from sebody.engine.newton import (
    HUGE,
    begin_with_matrix,
    correct,
    take_shift,
    want_matrix,
    watch_age,
)
from sebody.engine.prediction import look_back
from sebody.engine.state import CONVERGED, EVALUATED, GO_ON, KEPT, NEW_MATRIX, RENEWED, ROTATED
from sebody.engine.step import predict, settle
from sebody.engine.step_control import NEAR, set_end
from sebody.engine.vectors import swap
from sebody.engine.work import add_work, unknown_work


@compiled(nogil=True)
def advance(system, state, scratch, alone, together, apart, record, scheme, last_grid, dense):
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
            renew_bodies(system, state, scratch, alone, together, scheme, running)
            _begin_step(system, state, scheme)
            _iterate(system, state, scratch, alone, together, scheme, running, dense)
            _look_at_step(system, state, scratch)
        if some(control.reason > APART):
            take_apart(state, apart, alone.J)
        _accept(system, state)
        if 0.0 <= state.memory[NEXT] <= state.clock.time + NEAR * state.clock.step:
            call_samples(apart.routines[1], system, state, scratch, alone, apart, dense)
        if some(control.reason == APART):
            run_apart(state, apart, alone.J, scheme, dense)
        if control.grid % record.every[0] == 0:
            _write(system, state, scratch, apart, record)
    return control.grid


@compiled(forceinline=True)
def _look_at_step(system, state, scratch):
    """Find members whose step is rejected though it has converged; add works."""
    control = state.control
    running = control.reason == RUNS
    if system.guarded.size > 0:
        control.reason = where(running & contact_too_fast(system, state), spread(CUT),
                               control.reason)
        running = control.reason == RUNS
    scratch.table[RUNNING] = bits_of(running)
    add_work(system, state, state.clock.current_step)
    control.reason = where(running & (unknown_work(state) != 0.0), spread(CUT), control.reason)
    running = control.reason == RUNS
    control.reason = where(grows(system, state, scratch, running), spread(JUDGED), control.reason)


@compiled(forceinline=True)
def _begin_step(system, state, scheme):
    control, clock = state.control, state.clock
    set_end(system, state)
    offset = clock.current_step / clock.aux_step
    if control.grid > 0:
        look_back(system, state, scheme.beta * clock.current_step * clock.current_step)
    kept = (control.fresh == 0.0) & (
        (control.wanted == float(KEPT)) | (control.wanted == float(RENEWED)))
    predict(system, state, scheme, where(kept, spread(1.0), spread(0.0)), offset)
    begin_with_matrix(state)
    control.iteration = control.secant = spread(0.0)
    clock.last_norm = spread(0.0)


@compiled(forceinline=True)
def _iterate(system, state, scratch, alone, together, scheme, active, dense):
    """Newton's iteration of a step, until every member has converged or given up."""
    control = state.control
    mixed = not dense and not scheme.stabilized
    iteration = 0
    while some(active):
        evaluated = active & (control.wanted == float(EVALUATED))
        wanted = evaluated | (active & (control.wanted == float(ROTATED)))
        moved = (mixed and iteration > 1 and system.links.dependent.shape[0] == 0
                 and system.control.flowing.size == 0)
        if moved:
            find_moved(system, state, scratch, active, wanted)
        _evaluate(system, state, scratch, active, moved)
        if some(wanted):
            if system.links.dependent.shape[0] > 0:
                for i in range(state.residual.size):
                    state.forces[i] = state.residual[i]
            active = active & ~factorize(system, state, alone, together, scratch.frames, dense,
                                         wanted, evaluated)
        if scheme.stabilized:
            take_rates(system, state)
            to_body_axes(system, state.frames, state.constraint_residuals, False)
        to_body_axes(system, state.frames, state.residual, False)
        _solve(system, state, active, scheme.stabilized, dense)
        verdict = correct(system, state, scheme, active, iteration, mixed)
        active = _conclude(system, state, active, verdict)
        iteration += 1


@compiled(forceinline=True)
def _conclude(system, state, active, verdict):
    """Act on the verdicts about corrections; returns the members that go on."""
    control = state.control
    want_matrix(system, state, active & (verdict == NEW_MATRIX))
    goes_on = (verdict == GO_ON) | (verdict == NEW_MATRIX)
    failed = active & ~goes_on & (verdict != CONVERGED)
    shorter = (control.fresh > 0.0) | ~(state.clock.last_norm < HUGE)
    control.reason = where(failed, where(shorter, spread(CUT), spread(AGAIN)), control.reason)
    return active & goes_on


@compiled(forceinline=True)
def _solve(system, state, active, stabilized, dense):
    """Solve for corrections of the active members, with index 2 for shifts of positions first."""
    shifts = stabilized
    while True:
        if shifts:
            swap(state.residual, state.constraint_residuals)
        solve(system, state, dense)
        for i in range(system.diagonal.size):
            state.correction[i] = where(active, state.correction[i], spread(0.0))
        if not shifts:
            return
        take_shift(system, state)
        shifts = False


@compiled(forceinline=True)
def _evaluate(system, state, scratch, active, moved):
    """Evaluate forces; members that have converged keep their frames."""
    frames, begun = state.frames, scratch.frames
    for k in range(frames.size):
        begun[k] = frames[k]
    scratch.table[RUNNING] = bits_of(active)
    if moved:
        run_moved(system, state, scratch)
        keep_unmoved(system, state, scratch)
    else:
        run_kernels(RESIDUAL, 0, system.address.size, system, state)
    for k in range(frames.size):
        frames[k] = where(active, frames[k], begun[k])
    sum_forces(system, state, state.residual)


@compiled(forceinline=True)
def _accept(system, state):
    """End a step. Rotations of all members become orthogonal at the same steps of the grid."""
    clock, control = state.clock, state.control
    settle(system, state, control.grid)
    watch_age(state)
    control.back_off = where(control.fresh == 0.0, spread(0.0), control.back_off)
    control.steps += 1.0
    control.grid += 1
    clock.time = control.grid * clock.step


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
