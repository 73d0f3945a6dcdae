"""The compiled loop for eight members with fixed steps: `sebody.engine.loop` with masks.

Predictions, forces, matrices and corrections are the functions of the loop, compiled for lanes.
What a member does next follows from its own numbers alone, so results do not depend on which
members are run together: a member that has converged, or keeps its matrix, keeps its numbers while
others go on. A member that the loop would have to cut the step for, or to ask Python, gives up: its
`control.reason` is set, and it is run alone from its start.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import every, some, spread, where
from sebody.contract.layout import RESIDUAL, TANGENT
from sebody.engine.evaluate import run_kernels, set_tangent_operators, sum_forces, to_body_axes
from sebody.engine.lanes.growth import grows
from sebody.engine.lanes.matrix import factorize
from sebody.engine.lanes.newton import correct, watch_age
from sebody.engine.matrix import solve
from sebody.engine.state import EVALUATED, KEPT
from sebody.engine.step import (
    MEMORY,
    ORTHOGONAL,
    STEADY,
    changes,
    orthogonalize,
    predict,
    write_record,
)
from sebody.engine.step_control import choose_part, set_end
from sebody.engine.work import add_work
from sebody.kernels.abi import at, pointer_to


@compiled(nogil=True)
def advance(system, state, scratch, record, scheme, last_grid):
    """Run until `last_grid`, or until no member is left that has not given up."""
    control = state.control
    if control.steps == 0:
        write_record(state, record)
    while control.grid < last_grid:
        running = control.reason == 0.0
        if not some(running):
            return
        if system.corners.size > 0:
            choose_part(system, state)
        _begin_step(system, state, scheme)
        _iterate(system, state, scratch, scheme, running)
        add_work(system, state, state.clock.current_step)
        control.reason = where(grows(system, state) & (control.reason == 0.0), spread(1.0),
                               control.reason)
        _accept(system, state, record)


@compiled(forceinline=True)
def _begin_step(system, state, scheme):
    control, clock = state.control, state.clock
    set_end(system, state)
    offset = clock.current_step / clock.aux_step
    constant, bend = changes(system, state)
    kept = (control.fresh == 0.0) & (control.wanted == float(KEPT))
    steady = kept & (bend < STEADY * STEADY * constant)
    follow = where(steady, spread(1.0), spread(0.0))
    predict(system, state, scheme, follow, offset)
    control.iteration = control.fresh = spread(0.0)
    clock.last_norm = spread(0.0)


@compiled(forceinline=True)
def _iterate(system, state, scratch, scheme, active):
    """Newton's iteration of a step, until every member has converged or given up."""
    control = state.control
    n = system.diagonal.size
    iteration = 0
    while some(active):
        wanted = active & (control.wanted == float(EVALUATED))
        _evaluate(system, state, scratch, active, wanted)
        sum_forces(system, state, state.residual)
        to_body_axes(system, state.frames, state.residual, False)
        if some(wanted):
            active = active & ~factorize(system, state, scratch.dense, wanted)
        solve(system, state, True)
        for i in range(n):
            state.correction[i] = where(active, state.correction[i], spread(0.0))
        active = correct(system, state, scheme, active, iteration)
        iteration += 1


@compiled(forceinline=True)
def _evaluate(system, state, scratch, active, wanted):
    """Evaluate forces, and the element matrices of the members that want them.

    Forces beside matrices are rounded differently from forces alone, so members that want no matrix
    have theirs evaluated alone. Those that have converged keep their frames.
    """
    batches = system.address.size
    frames, old, g, kept = state.frames, scratch.frames, state.g, scratch.g
    for k in range(frames.size):
        old[k] = frames[k]
    if some(wanted):
        set_tangent_operators(system, state)
        run_kernels(TANGENT, 0, batches, system, state)
    if not every(wanted | ~active):
        if some(wanted):
            for k in range(g.size):
                kept[k] = g[k]
            for k in range(frames.size):
                found = frames[k]
                frames[k], old[k] = old[k], where(wanted, found, old[k])
            run_kernels(RESIDUAL, 0, batches, system, state)
            for k in range(g.size):
                g[k] = where(wanted, kept[k], g[k])
            active = active & ~wanted
        else:
            run_kernels(RESIDUAL, 0, batches, system, state)
    for k in range(frames.size):
        frames[k] = where(active, frames[k], old[k])


@compiled(forceinline=True)
def _accept(system, state, record):
    """End a step: orthogonal rotations, output."""
    clock, control = state.clock, state.control
    if control.steps % ORTHOGONAL == 0:
        for r in range(system.rotation_at.size):
            orthogonalize(at(pointer_to(state.R), 9 * r))
    watch_age(state)
    clock.acceleration_norm *= MEMORY
    control.steps += 1
    control.grid += 1
    clock.time = control.grid * clock.step
    if control.grid % record.every[0] == 0:
        write_record(state, record)


@compiled(nogil=True)
def take_member(floats, places, member, lanes):
    """Set the numbers of one member at some places of a buffer of lanes, (size, members)."""
    for k in range(places.size):
        lanes[places[k], member] = floats[places[k]]


@compiled(nogil=True)
def rows_of(table, member, rows):
    """Recorded states of one member from those of all, (records, numbers, members)."""
    for k in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            rows[k, i] = table[k, i, member]
