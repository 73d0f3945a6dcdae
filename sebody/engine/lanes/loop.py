"""The compiled loop for eight members with fixed steps: `sebody.engine.loop` with masks.

Predictions, forces, matrices and corrections are the functions of the loop, compiled for lanes.
What a member does next follows from its own numbers alone, so results do not depend on which
members are run together: a member that has converged, or keeps its matrix, keeps its numbers while
others go on. Members whose step is cut go alone until they can come back, see `engine.lanes.apart`.
One that would have to ask Python gives up, and is run alone from its start.
"""


from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import bits_of, every, some, spread, where
from sebody.contract.layout import RECORD_ITERATIONS, RECORD_T, RESIDUAL, TANGENT
from sebody.contract.member_row import RUNNING
from sebody.engine.evaluate import run_kernels, set_tangent_operators, sum_forces, to_body_axes
from sebody.engine.lanes.apart import (
    ALONE,
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
from sebody.engine.lanes.growth import grows
from sebody.engine.lanes.guard import contact_too_fast
from sebody.engine.lanes.matrix import factorize
from sebody.engine.lanes.moved import find_moved, keep_unmoved, run_moved
from sebody.engine.lanes.newton import begin_with_matrix, correct, watch_age
from sebody.engine.matrix import solve
from sebody.engine.prediction import look_back
from sebody.engine.state import EVALUATED, KEPT, ROTATED
from sebody.engine.step import MEMORY, ORTHOGONAL, orthogonalize, predict
from sebody.engine.step_control import set_end
from sebody.engine.work import add_work
from sebody.kernels.abi import at, pointer_to


@compiled(nogil=True)
def advance(system, state, scratch, apart, record, scheme, last_grid, dense):
    """Run until `last_grid`, or until no member is left that has not given up."""
    control = state.control
    if control.grid == 0:
        _write(state, apart, record)
    while control.grid < last_grid:
        if every(control.reason == GAVE_UP):
            return
        if system.corners.size > 0 and jump_is_ahead(system, state):
            control.reason = where(control.reason == RUNS, spread(JUMPS), control.reason)
        running = control.reason == RUNS
        if some(running):
            _begin_step(system, state, scheme)
            _iterate(system, state, scratch, scheme, running, dense)
            _look_at_step(system, state, scratch)
        if some(control.reason > ALONE):
            take_apart(state, apart)
        _accept(system, state)
        if some(control.reason == ALONE):
            run_apart(state, apart, scheme, dense)
        if control.grid % record.every[0] == 0:
            _write(state, apart, record)


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
    control.reason = where(grows(system, state, scratch, running), spread(JUDGED), control.reason)


@compiled(forceinline=True)
def _begin_step(system, state, scheme):
    control, clock = state.control, state.clock
    set_end(system, state)
    offset = clock.current_step / clock.aux_step
    if control.grid > 0:
        look_back(system, state, scheme.beta * clock.current_step * clock.current_step)
    kept = (control.fresh == 0.0) & (control.wanted == float(KEPT))
    predict(system, state, scheme, where(kept, spread(1.0), spread(0.0)), offset)
    begin_with_matrix(state)
    control.iteration = control.secant = spread(0.0)
    clock.last_norm = spread(0.0)


@compiled(forceinline=True)
def _iterate(system, state, scratch, scheme, active, dense):
    """Newton's iteration of a step, until every member has converged or given up."""
    control = state.control
    n = system.diagonal.size
    iteration = 0
    while some(active):
        evaluated = active & (control.wanted == float(EVALUATED))
        wanted = evaluated | (active & (control.wanted == float(ROTATED)))
        moved = (not dense and iteration > 1 and system.links.dependent.shape[0] == 0)
        if moved:
            find_moved(system, state, scratch, active, wanted)
        _evaluate(system, state, scratch, active, wanted, evaluated, moved)
        to_body_axes(system, state.frames, state.residual, False)
        if some(wanted):
            active = active & ~factorize(system, state, scratch, dense, wanted, evaluated)
        solve(system, state, dense)
        for i in range(n):
            state.correction[i] = where(active, state.correction[i], spread(0.0))
        active = correct(system, state, scheme, active, iteration, not dense)
        iteration += 1


@compiled(forceinline=True)
def _evaluate(system, state, scratch, active, wanted, evaluated, moved):
    """Evaluate forces, and the element matrices that members want.

    Those that want their matrix rotated keep the matrices of the bodies. Members that have
    converged keep their frames.
    """
    bodies, batches = system.first_joint[0], system.address.size
    frames, T, J, old_J = state.frames, state.T, state.J, scratch.J
    if some(evaluated):
        for k in range(T.size):
            scratch.T[k] = T[k]
        set_tangent_operators(system, state)
        for k in range(T.size):
            T[k] = where(evaluated, T[k], scratch.T[k])
        if system.linked[0] == 1:
            for k in range(old_J.size):
                old_J[k] = J[k]
    for k in range(frames.size):
        scratch.frames[k] = frames[k]
    _evaluate_part(system, state, scratch, active, evaluated, 0, bodies, moved)
    _evaluate_part(system, state, scratch, active, wanted, bodies, batches, moved)
    if moved:
        keep_unmoved(system, state, scratch)
    for k in range(frames.size):
        frames[k] = where(active, frames[k], scratch.frames[k])
    if some(evaluated) and system.linked[0] == 1:
        for k in range(old_J.size):
            J[k] = where(evaluated, J[k], old_J[k])
    sum_forces(system, state, state.residual)
    if some(wanted) and system.links.dependent.shape[0] > 0:
        for i in range(state.residual.size):
            state.forces[i] = state.residual[i]


@compiled
def _evaluate_part(system, state, scratch, active, wanted, first, last, moved):
    """Evaluate some batches, with matrices where they are wanted.

    Forces beside matrices are rounded differently from forces alone, so members that want no matrix
    have theirs evaluated alone.
    """
    frames, begun, g, kept = state.frames, scratch.frames, state.g, scratch.g
    if some(wanted):
        scratch.table[RUNNING] = bits_of(wanted)
        run_kernels(TANGENT, first, last, system, state)
    if every(wanted | ~active):
        return
    scratch.table[RUNNING] = bits_of(active & ~wanted)
    if not some(wanted):
        if moved:
            run_moved(system, state, scratch, first, last)
        else:
            run_kernels(RESIDUAL, first, last, system, state)
        return
    for k in range(system.at_g[first], system.at_g[last]):
        kept[k] = g[k]
    of_bodies = frames.size if first == 0 else 0        # others do not change them
    for k in range(of_bodies):
        scratch.found[k] = frames[k]
        frames[k] = begun[k]
    run_kernels(RESIDUAL, first, last, system, state)
    for k in range(system.at_g[first], system.at_g[last]):
        g[k] = where(wanted, kept[k], g[k])
    for k in range(of_bodies):
        frames[k] = where(wanted, scratch.found[k], frames[k])


@compiled(forceinline=True)
def _accept(system, state):
    """End a step: orthogonal rotations."""
    clock, control = state.clock, state.control
    if control.grid % ORTHOGONAL == 0:
        for r in range(system.rotation_at.size):
            orthogonalize(at(pointer_to(state.R), 9 * r))
    watch_age(state)
    control.back_off = where(control.fresh == 0.0, spread(0.0), control.back_off)
    clock.acceleration_norm *= MEMORY
    control.steps += 1.0
    control.grid += 1
    clock.time = control.grid * clock.step


@compiled(forceinline=True)
def _write(state, apart, record):
    """Store the numbers of the accepted state that are asked for."""
    row = state.control.recorded
    if some(state.control.reason == ALONE):
        show(state, apart, record.places)
    state.now[RECORD_T] = spread(state.clock.time)
    state.now[RECORD_ITERATIONS] = state.control.iterations
    for k in range(record.places.size):
        record.rows[row, k] = state.now[record.places[k]]
    state.control.recorded = row + 1


@compiled(nogil=True)
def rows_of(table, member, rows):
    """Recorded states of one member from those of all, (records, numbers, members)."""
    for k in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            rows[k, i] = table[k, i, member]
