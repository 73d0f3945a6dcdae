"""Elements in lanes: see `sebody.engine.iteration.run_wanted` and `sebody.engine.evaluate`.

All members are evaluated; those that are not active keep their frames. In large models an element
that has hardly moved keeps its forces. It is evaluated if it has moved in a member, and keeps its
forces and its frame in all others.
"""

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import bits_of, where
from sebody.contract.layout import AT_FRAME, OK, RESIDUAL
from sebody.contract.member_row import RUNNING
from sebody.engine import iteration
from sebody.engine.evaluate import find_moved, limit_of_moved, run_found, run_kernels
from sebody.engine.selection import either
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to


@in_lanes_of(iteration.run_wanted)
def run_wanted(system, state, members, active, wanted, of_moved):
    """Evaluate forces alone: matrices are made later, of one member or of all."""
    scratch, frames = members[0], state.frames
    copy(frames, scratch.frames)
    scratch.table[RUNNING] = bits_of(active)
    if of_moved:
        copy(state.g, scratch.unmoved)
        _run_moved(system, state, active, wanted)
        _keep_unmoved(system, state, scratch)
    else:
        run_kernels(RESIDUAL, 0, system.address.size, system, state)
    for k in range(frames.size):
        frames[k] = where(active, frames[k], scratch.frames[k])
    return OK


@compiled
def _run_moved(system, state, active, wanted):
    """Evaluate the forces of the elements that moved in an active member.

    All elements count as moved where members want matrices.
    """
    before, limit = 0, limit_of_moved(state)
    for b in range(system.address.size):
        count = system.count[b]
        find_moved(system, state, b, 0, count, before, limit)
        for element in range(before, before + count):
            moved = active & (wanted | (state.moved[element] > 0.0))
            state.moved[element] = either(moved, 1.0, 0.0)
        run_found(system, state, b, 0, count, before, pointer_to(state.work))
        before += count


@compiled
def _keep_unmoved(system, state, scratch):
    """Put back forces, frames and kept numbers of elements that have not moved."""
    g, first, bodies = state.g, 0, system.first_joint[0]
    for b in range(system.address.size):
        width, stride = system.width[b], system.stride[b]
        for element in range(system.count[b]):
            moved = state.moved[first + element] > 0.0
            start = system.at_g[b] + width * element
            for k in range(start, start + width):
                g[k] = where(moved, g[k], scratch.unmoved[k])
            place = system.index[system.at_index[b] + stride * element + AT_FRAME]
            kept, size = (9 * place, 9) if b < bodies else (place, scratch.kept[b])
            for k in range(kept, kept + size):
                state.frames[k] = where(moved, state.frames[k], scratch.frames[k])
        first += system.count[b]
