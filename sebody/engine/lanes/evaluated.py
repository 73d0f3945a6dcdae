"""Numbers of accepted states that kernels give, for quantities of eight members."""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import bits_of, spread
from sebody.contract.layout import ENERGY as ENERGIES, RESIDUAL
from sebody.contract.member_row import RUNNING
from sebody.contract.read_numbers import ENERGY, FORCE, TOTAL
from sebody.engine.evaluate import run_kernels, run_part, set_gravity, set_loads, sum_forces
from sebody.engine.lanes.apart import GAVE_UP
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to


@compiled
def write_evaluated(system, state, scratch, record, row):
    """Evaluate forces and energies, and store what is asked for; the state stays as it is.

    Sums of forces are left in `State.residual`, which every iteration sets anew.
    """
    copy(state.frames, scratch.frames)
    copy(state.loads, record.loads)
    set_loads(system, state.frames, state.loads, state.clock.time)
    set_gravity(system, state)
    scratch.table[RUNNING] = bits_of(state.control.reason != GAVE_UP)
    if record.needs[ENERGY] == 1:
        for i in range(state.energy.size):
            state.energy[i] = spread(0.0)
        run_kernels(ENERGIES, 0, system.address.size, system, state)
    if record.needs[TOTAL] == 1:
        run_kernels(RESIDUAL, 0, system.address.size, system, state)
        sum_forces(system, state, state.residual)
    else:
        for k in range(record.batches.shape[0]):
            run_part(RESIDUAL, record.batches[k, 0], record.batches[k, 1], record.batches[k, 2],
                     system, state, pointer_to(state.work))
    for k in range(record.evaluated.shape[0]):
        kind, place = record.evaluated[k, 0], record.evaluated[k, 1]
        to = record.places.size + k
        if kind == FORCE:
            record.rows[row, to] = state.g[place]
        elif kind == TOTAL:
            record.rows[row, to] = state.residual[place]
        elif kind == ENERGY:
            record.rows[row, to] = state.energy[place]
        else:
            record.rows[row, to] = state.loads[place]
    copy(scratch.frames, state.frames)
    copy(record.loads, state.loads)
