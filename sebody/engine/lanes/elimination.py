"""Elimination of large matrices of eight members: see `sebody.engine.elimination`."""

import math

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import every, spread, where
from sebody.contract.counts import LANES
from sebody.engine import elimination
from sebody.engine.elimination import BLOCK, SMALL_PIVOT
from sebody.kernels.abi import pointer_to


@compiled
def eliminate_large(system, state, kept, wanted):
    """Factorize large matrices; `kept` are the factors of the members that keep theirs.

    Returns the members whose pivots are large enough.
    """
    elimination.eliminate_columns(0, system.block_diagonal.size, system, state,
                                  pointer_to(state.column))
    good = spread(0.0) == 0.0
    for j in range(system.block_diagonal.size):
        good = good & (abs(state.matrix[BLOCK * system.block_diagonal[j]]) < math.inf)
    if every(wanted):
        return good
    for k in range(kept.size):
        state.matrix[k] = where(wanted, state.matrix[k], kept[k])
    return good


@in_lanes_of(elimination.invert_block)
def invert_block(D, inverse, unknowns, scale):
    """Invert a block; of members whose pivot is small it becomes no number."""
    for i in range(BLOCK):
        inverse[i] = D[i]
    for k in range(LANES):
        pivot = inverse[LANES * k + k]
        size = abs(pivot) * scale[unknowns[k]] * scale[unknowns[k]]
        r = where(size > SMALL_PIVOT, 1.0 / pivot, spread(math.nan))
        inverse[LANES * k + k] = spread(1.0)
        for j in range(LANES):
            inverse[LANES * j + k] *= r
        for i in range(LANES):
            if i != k:
                f = inverse[LANES * k + i]
                inverse[LANES * k + i] = spread(0.0)
                for j in range(LANES):
                    inverse[LANES * j + i] -= f * inverse[LANES * j + k]
    return True
