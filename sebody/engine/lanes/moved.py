"""Elements that the last correction moved, member by member: see `sebody.engine.evaluate`.

In large models an element that has hardly moved keeps its forces. It is evaluated if it has moved
in a member, and keeps its forces and its frame in all others.
"""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import some, spread, where
from sebody.contract.layout import AT_FRAME, RESIDUAL
from sebody.engine.evaluate import limit_of_moved, run_part
from sebody.kernels.abi import pointer_to


@compiled
def find_moved(system, state, scratch, active, wanted):
    """Find the elements of active members that the last correction moved.

    All elements count as moved where members want matrices. Forces are remembered.
    """
    k, first, yes, no = 0, 0, spread(1.0), spread(0.0)
    limit = limit_of_moved(state)
    for b in range(system.address.size):
        for element in range(system.count[b]):
            size = no
            for _ in range(system.width[b]):
                i = system.g_unknown[k]
                change = state.last_change[i] * state.weight[i]
                size += change * change
                k += 1
            scratch.moved[first + element] = where(active & (wanted | (size > limit)), yes, no)
        first += system.count[b]
    for i in range(state.g.size):
        scratch.unmoved[i] = state.g[i]


@compiled
def run_moved(system, state, scratch):
    """Evaluate the forces of the elements that moved in a member."""
    first = 0
    for b in range(system.address.size):
        begin = 0
        while begin < system.count[b]:
            if not some(scratch.moved[first + begin] > 0.0):
                begin += 1
                continue
            end = begin + 1
            while end < system.count[b] and some(scratch.moved[first + end] > 0.0):
                end += 1
            run_part(RESIDUAL, b, begin, end - begin, system, state, pointer_to(state.work))
            begin = end
        first += system.count[b]


@compiled
def keep_unmoved(system, state, scratch):
    """Put back forces, frames and kept numbers of elements that have not moved."""
    g, first, bodies = state.g, 0, system.first_joint[0]
    for b in range(system.address.size):
        width, stride = system.width[b], system.stride[b]
        for element in range(system.count[b]):
            moved = scratch.moved[first + element] > 0.0
            start = system.at_g[b] + width * element
            for k in range(start, start + width):
                g[k] = where(moved, g[k], scratch.unmoved[k])
            place = system.index[system.at_index[b] + stride * element + AT_FRAME]
            kept, size = (9 * place, 9) if b < bodies else (place, scratch.kept[b])
            for k in range(kept, kept + size):
                state.frames[k] = where(moved, state.frames[k], scratch.frames[k])
        first += system.count[b]
