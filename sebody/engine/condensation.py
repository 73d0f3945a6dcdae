"""Element matrices whose internal unknowns are eliminated, for matrices that steps refresh.

A column of blocks with unknowns of one superelement alone, such as internal modes, gets nothing
from other columns, and its elimination changes the matrix of this element alone. Both commute with
rotations of positions, so in the axes of the body these numbers stay as they are, however it
moves. Where steps refresh the matrix with the same element matrices, `State.condensed` keeps these
with such columns eliminated: they have factors in the place of their entries, and the elimination
of the system begins behind them. A first refresh is made without, since often there is no second.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.engine.elimination import BLOCK, invert_block
from sebody.kernels.abi import at, pointer_to

INTERNAL = 5            # numbers of a column in System.internal


@compiled
def are_condensed(system, state):
    """Tell if a refreshed matrix is made of `State.condensed`."""
    control = state.control
    return (system.internal.shape[0] > 0 and control.refreshed > 1 and control.pivoted == 0
            and system.regularized[0] == 0)


@compiled
def element_matrix(system, state, k):
    """The matrix of an element as it was evaluated, number k of `System.summands`."""
    return at(pointer_to(state.J), system.summands[k, 0])


@compiled
def condensed_matrix(system, state, k, evaluated):
    """The same, `evaluated`, with internal unknowns eliminated, which the second refresh does."""
    start, width, first, end = (system.summands[k, 0], system.summands[k, 1],
                                system.summands[k, 8], system.summands[k, 9])
    if first == end:
        return evaluated
    own = at(pointer_to(state.condensed), start)
    if state.control.refreshed == 2:
        for i in range(width * width):
            own[i] = evaluated[i]
        left = np.ones(width)       # zero for unknowns that are eliminated
        rows, blocks = np.empty(LANES * width), np.empty(2 * BLOCK)
        for j in range(first, end):
            _eliminate(at(pointer_to(system.internal), INTERNAL * j), width, own,
                       pointer_to(left), pointer_to(rows), pointer_to(blocks), system, state)
    return own


@compiled
def _eliminate(internal, width, own, left, rows, blocks, system, state):
    """Eliminate one column of `System.internal`; `rows` and `blocks` are scratch memory."""
    places, inverse = at(internal, 1), at(blocks, BLOCK)
    for p in range(LANES):
        for r in range(LANES):
            blocks[LANES * p + r] = (1.0 * (p == r) if places[p] < 0 or places[r] < 0 else
                                     own[width * places[r] + places[p]])
        if places[p] >= 0:
            left[places[p]] = 0.0
    invert_block(blocks, inverse, at(pointer_to(system.slot_unknowns), LANES * internal[0]),
                 pointer_to(state.scale))
    for p in range(LANES):
        for j in range(width):
            rows[width * p + j] = left[j] * own[width * places[p] + j] if places[p] >= 0 else 0.0
    for i in range(width):
        if left[i] > 0.0:
            _eliminate_row(places, width, at(own, width * i), inverse, rows)
    for p in range(LANES):
        for r in range(LANES):
            if places[p] >= 0 and places[r] >= 0:
                own[width * places[r] + places[p]] = inverse[LANES * p + r]


@compiled(apart=True)
def _eliminate_row(places, width, row, inverse, rows):
    """Factors of a row, and what is left of it."""
    a = row[places[0]] if places[0] >= 0 else 0.0
    b = row[places[1]] if places[1] >= 0 else 0.0
    c = row[places[2]] if places[2] >= 0 else 0.0
    d = row[places[3]] if places[3] >= 0 else 0.0
    for p in range(LANES):
        factor = (a * inverse[LANES * p] + b * inverse[LANES * p + 1]
                  + c * inverse[LANES * p + 2] + d * inverse[LANES * p + 3])
        for j in range(width):
            row[j] -= factor * rows[width * p + j]
        if places[p] >= 0:
            row[places[p]] = factor
