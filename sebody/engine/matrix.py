"""The iteration matrix in compiled code: sum of the element matrices, scales, factors, solution."""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.contract.layout import C_MASS, C_STIFFNESS, OK
from sebody.engine import elimination
from sebody.engine.calls import call_share
from sebody.engine.condensation import are_condensed, condensed_matrix, element_matrix
from sebody.engine.elimination import BLOCK
from sebody.engine.inverse import invert
from sebody.engine.links import add_expanded, add_second_order
from sebody.engine.regularization import (
    EXCHANGED,
    REGULARIZATION,
    WEAKEST,
    project,
    project_inverse,
    regularize,
    spread,
)
from sebody.engine.state import EVALUATED, ROTATED, SHARE_FACTORS, SHARE_SOLUTION, SHARE_SUM
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.dense import columns_times

SUMMAND = 10            # numbers of an element in System.summands
ROUNDING = 8.0 * 2.2e-16        # left of a position by rounding, relative to its magnitude
THIN = 1e-6             # smallest moment of inertia that scales its axis, relative to the largest


@compiled
def sum_matrices(system, state, forces, condensed):
    """Sum the element matrices, which are not changed; links need the forces, too.

    `condensed` tells whether their internal unknowns are to be eliminated.
    """
    if system.routines[3] != 0:
        call_share(system.routines[3], system, state, SHARE_SUM, 0)
    else:
        clear_matrix(system, state)
        for k in range(system.summands.shape[0]):
            own = element_matrix(system, state, k)
            if condensed:
                own = condensed_matrix(system, state, k, own)
            sum_element(system, state, k, own, pointer_to(state.rotated_matrix))
    if system.links.elements.shape[0] > 0:
        add_second_order(system.links, state.coefficients[C_STIFFNESS], state.q, state.R, state.T,
                         state.turns, forces, state.matrix)


@compiled
def clear_matrix(system, state):
    """Zeros, but ones on the diagonal of free slots."""
    for k in range(state.matrix.size):
        state.matrix[k] = 0.0
    for k in range(system.padding.size):
        state.matrix[system.padding[k]] = 1.0


@compiled
def sum_columns(system, state, first, end, part, condensed, J):
    """Some columns of blocks, those of a part of the elimination; J as in `sum_element`.

    `condensed` tells whether internal unknowns are to be eliminated.
    """
    starts, across = pointer_to(system.block_starts), system.block_diagonal.size
    for k in range(BLOCK * starts[first],
                   BLOCK * starts[end] if end < across else state.matrix.size):
        state.matrix[k] = 0.0
    for slot in range(LANES * first, LANES * end):
        if system.slot_unknowns[slot] == system.diagonal.size:
            state.matrix[BLOCK * system.block_diagonal[slot // LANES]
                         + (LANES + 1) * (slot % LANES)] = 1.0
    last = system.part_summands.size - 1
    for k in range(system.part_summands[part],
                   system.part_summands[part + 1] if part < last else system.summands.shape[0]):
        own = element_matrix(system, state, k)
        if condensed:
            own = condensed_matrix(system, state, k, own)
        sum_element(system, state, k, own, J)


@compiled
def sum_element(system, state, k, own, J):
    """Add the matrix `own` of an element, its positions rotated to the axes they are solved for in.

    The element is number k of `System.summands`; `J` is scratch memory for a matrix like its own.
    """
    summand = at(pointer_to(system.summands), SUMMAND * k)
    width, first_rotated, end_rotated, linked, first, end, shift = (
        summand[1], summand[2], summand[3], summand[4], summand[5], summand[6], summand[7])
    if first_rotated < end_rotated or linked >= 0:
        for i in range(width * width):
            J[i] = own[i]
        for r in range(first_rotated, end_rotated):
            _rotate_block(system.rotated_blocks[r], system.dimension[0], J, state.frames)
        own = J
    if linked >= 0:
        add_expanded(system.links, linked, J, state.frames, state.q, state.R, state.T,
                     state.turns, state.matrix, state.expansion)
        return
    matrix, places, entries = (at(pointer_to(state.matrix), shift), pointer_to(system.J_place),
                               pointer_to(system.J_entry))
    for i in range(first, end):
        matrix[entries[i]] += own[places[i]]


@compiled(forceinline=True)
def _product_row(to, own, block, i):
    """Row i of ``to^T own``; either frame may be global axes (-1)."""
    if block[3] < 0:
        return own[3 * i], own[3 * i + 1], own[3 * i + 2]
    x, y, z = to[i], to[3 + i], to[6 + i]
    if block[4] < 0:
        return x, y, z
    return (x * own[0] + y * own[3] + z * own[6], x * own[1] + y * own[4] + z * own[7],
            x * own[2] + y * own[5] + z * own[8])


@compiled
def _rotate_block(block, dimension, J, frames):
    """Rotate rows and columns of a position in J to the axes the position is solved for in."""
    width, row = block[1], block[2]
    to, own = at(pointer_to(frames), 9 * block[3]), at(pointer_to(frames), 9 * block[4])
    a, b, c = _product_row(to, own, block, 0)
    d, e, f = _product_row(to, own, block, 1)
    g, h, k = _product_row(to, own, block, 2)
    for across in range(2):
        first, next_line, step = (row, width, 1) if across == 0 else (row * width, 1, width)
        for i in range(width):
            p = at(J, first + i * next_line)
            x, y = p[0], p[step]
            if dimension == 2:
                p[0], p[step] = a * x + b * y, d * x + e * y
            else:
                z = p[2 * step]
                p[0], p[step] = a * x + b * y + c * z, d * x + e * y + f * z
                p[2 * step] = g * x + h * y + k * z


@compiled
def equilibrate(system, state):
    """Scale the matrix to a unit diagonal and unit constraint rows: free of units and of h."""
    n, mass = system.diagonal.size, state.coefficients[C_MASS]
    for i in range(n):
        diagonal = max(abs(state.matrix[system.diagonal[i]]), THIN * mass * system.inertias[i])
        state.scale[i] = 0.0 if system.is_multiplier[i] > 0.0 else 1.0 / np.sqrt(diagonal)
    sums = state.correction
    for i in range(sums.size):      # a loop: an assigned slice compiles slowly
        sums[i] = 0.0
    for k in range(system.rows.size):
        if system.is_multiplier[system.rows[k]] > 0.0:
            entry = state.matrix[k] * state.scale[system.columns[k]]
            sums[system.rows[k]] += entry * entry
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            state.scale[i] = 1.0 / np.sqrt(sums[i]) if sums[i] > 0.0 else 1.0
    floor = 0.0
    for i in range(n):
        state.weight[i] = 1.0 / state.scale[i]
        size = max(system.magnitude[i], abs(state.q[i])) * state.weight[i]
        floor += size * size * (1.0 if system.magnitude[i] > 0.0 else 0.0)
    state.clock.floor = ROUNDING * np.sqrt(floor)      # left by rounding of positions


@compiled
def invert_dense(system, state, n, regularized, wanted):
    """Invert a small matrix, by columns, scales included; False if it is singular."""
    dense = np.empty((n, n))
    size = inverse_size = 0.0
    for j in range(n):
        for i in range(n):
            dense[j, i] = state.scale[i] * state.matrix[j * n + i] * state.scale[j]
            size += abs(dense[j, i])
    if not np.isfinite(size):
        return False
    if not invert(dense):
        return False
    for j in range(n):
        for i in range(n):
            inverse_size += abs(dense[j, i])
    if not size * inverse_size < 1e16 * n:
        return False
    if regularized:
        if wanted == EVALUATED:
            spread(system, state, dense, True)
        project_inverse(system, state, dense, n)
    for j in range(n):
        if (not regularized and system.is_multiplier[j] > 0.0
                and WEAKEST * abs(dense[j, j]) > 1.0):
            return False
        for i in range(n):
            state.inverse[j, i] = state.scale[i] * dense[j, i] * state.scale[j]
    return True


@compiled
def refactorize(system, state, wanted, dense):
    """Sum the element matrices and factorize the sum, or invert it if it is small (dense).

    Returns False if a small matrix is singular. Where elimination meets a small pivot, PIVOTED is
    set and `State.matrix` holds the sum, for a factorization with row exchanges. The scales are
    those of the first matrix of the last new element matrices.
    """
    regularized = system.regularized[0] == 1
    condensed = wanted == ROTATED and are_condensed(system, state)
    state.control.condensed = condensed
    sum_matrices(system, state, state.forces, condensed)
    if wanted == ROTATED and not condensed:     # the next one condenses
        state.control.refreshed = 1
    if wanted == EVALUATED or state.control.age == 0:
        equilibrate(system, state)
    state.control.regularized = 0
    if dense:
        n = system.diagonal.size
        if not regularized and invert_dense(system, state, n, False, wanted):
            return True
        regularize(system, state, EXCHANGED)
        return invert_dense(system, state, n, True, wanted)
    if regularized:
        regularize(system, state, REGULARIZATION)
    if system.routines[3] != 0:
        done = call_share(system.routines[3], system, state, SHARE_FACTORS, 0) == OK
    else:
        done = elimination.eliminate_columns(0, system.block_diagonal.size, system, state,
                                             condensed, pointer_to(state.column))
    state.control.condensed = 0
    state.control.pivoted = 0 if done else 1
    if not done:
        sum_matrices(system, state, state.forces, False)
        if regularized:
            regularize(system, state, REGULARIZATION)
    elif regularized and wanted == EVALUATED:
        spread(system, state, state.inverse, False)
    return True


@compiled(forceinline=True)
def solve(system, state, dense):
    """Solve for the correction from the residual."""
    if dense:
        n = system.diagonal.size
        columns_times(pointer_to(state.inverse), pointer_to(state.residual),
                      pointer_to(state.correction), n, n)
    else:
        if system.routines[3] != 0:
            call_share(system.routines[3], system, state, SHARE_SOLUTION, 0)
        else:
            elimination.solve(system, state, state.residual, state.correction)
        if state.control.regularized == 1:
            project(system, state)
