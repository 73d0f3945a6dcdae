"""Elimination of large sparse systems inside the loop, block by block in the order of the unknowns.

Multipliers are numbered after the unknowns they act on, so no row exchanges between blocks are
needed and the pattern of the factors, fill included, is known beforehand. The cost of a chain is
linear in its number of bodies. If a pivot is small nevertheless, the loop asks for a factorization
with row exchanges (`row_exchanges.py`).

Blocks have `LANES` rows and columns, stored by columns. Every unknown has a slot, a row and column
of the blocks; free slots have ones on the diagonal.

Blocks on the diagonal are replaced by their inverses. Those of regularized matrices have pivots of
the size of the regularization: entries of an inverse are one over that, and their rounding would
spoil what is left of later blocks. So their triangular factors are inverted one by one, and L
times a vector without force is rounding before it is divided by the pivot.
"""


from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.blocks import (
    multiply_and_subtract,
    subtract_blocks_times,
    subtract_product,
)

BLOCK = LANES * LANES
SMALL_PIVOT = 1e-11     # relative to the scaled matrix, whose diagonal is one


@compiled
def eliminate(first_column, end_column, regularized, starts, rows, diagonal, ends, unknowns, matrix,
              column, scale):
    """Factorize some columns of blocks in place: L with unit diagonal blocks, U with inverted ones.

    All arguments from `starts` on are pointers; `column` is scratch memory for one column of
    blocks, `scale` the scales of the unknowns. `ends` has the end of the blocks of every column;
    the beginning of columns that are eliminated already. Returns False at a small pivot.
    """
    for j in range(first_column, end_column):
        first, middle, end = starts[j], diagonal[j], ends[j]
        if end == first:
            continue
        for p in range(first, end):
            source, target = at(matrix, BLOCK * p), at(column, BLOCK * rows[p])
            for i in range(BLOCK):
                target[i] = source[i]
        for p in range(first, middle):
            k = rows[p]
            u, target = at(column, BLOCK * k), at(matrix, BLOCK * p)
            for i in range(BLOCK):
                target[i] = u[i]
            for t in range(diagonal[k] + 1, ends[k]):
                subtract_product(at(column, BLOCK * rows[t]), at(matrix, BLOCK * t), target)
        inverse = at(matrix, BLOCK * middle)
        if regularized:
            if not invert_factors(at(column, BLOCK * j), inverse, at(unknowns, LANES * j), scale):
                return False
            for p in range(middle + 1, end):
                _divide(at(column, BLOCK * rows[p]), inverse, at(matrix, BLOCK * p))
            continue
        if not invert_block(at(column, BLOCK * j), inverse, at(unknowns, LANES * j), scale):
            return False
        for p in range(middle + 1, end):
            target = at(matrix, BLOCK * p)
            for i in range(BLOCK):
                target[i] = 0.0
            _subtract_negative(target, at(column, BLOCK * rows[p]), inverse)
    return True


@compiled(forceinline=True)
def _subtract_negative(C, A, B):
    """``C = -(C - A B)``: the product A B for a C of zeros."""
    subtract_product(C, A, B)
    for i in range(BLOCK):
        C[i] = -C[i]


@compiled
def invert_block(D, inverse, unknowns, scale):
    """Invert a block by Gauss-Jordan elimination without exchanges; False at a small pivot."""
    for i in range(BLOCK):
        inverse[i] = D[i]
    for k in range(LANES):
        pivot = inverse[LANES * k + k]
        if not abs(pivot) * scale[unknowns[k]] * scale[unknowns[k]] > SMALL_PIVOT:
            return False
        r = 1.0 / pivot
        inverse[LANES * k + k] = 1.0
        for j in range(LANES):
            inverse[LANES * j + k] *= r
        for i in range(LANES):
            if i != k:
                f = inverse[LANES * k + i]
                inverse[LANES * k + i] = 0.0
                for j in range(LANES):
                    inverse[LANES * j + i] -= f * inverse[LANES * j + k]
    return True


@compiled
def invert_factors(D, factors, unknowns, scale):
    """Inverses of the triangular factors of a block, without exchanges; False at a small pivot.

    That of U is on and above the diagonal, that of L, whose diagonal is one, below.
    """
    f = factors
    for i in range(BLOCK):
        f[i] = D[i]
    for k in range(LANES):
        pivot = f[LANES * k + k]
        if not abs(pivot) * scale[unknowns[k]] * scale[unknowns[k]] > SMALL_PIVOT:
            return False
        for i in range(k + 1, LANES):
            f[LANES * k + i] /= pivot
            for j in range(k + 1, LANES):
                f[LANES * j + i] -= f[LANES * k + i] * f[LANES * j + k]
    for j in range(LANES):
        for i in range(j + 1, LANES):
            total = f[LANES * j + i]
            for k in range(j + 1, i):
                total += f[LANES * k + i] * f[LANES * j + k]
            f[LANES * j + i] = -total
    for back in range(LANES):
        j = LANES - 1 - back
        last = f[LANES * j + j] = 1.0 / f[LANES * j + j]
        for up in range(j):
            i = j - 1 - up
            total = f[LANES * j + i] * last
            for k in range(i + 1, j):
                total += f[LANES * k + i] * f[LANES * j + k]
            f[LANES * j + i] = -total / f[LANES * i + i]
    return True


@compiled
def _divide(A, factors, target):
    """A block of L: A over U, then over L, of `invert_factors`."""
    for j in range(LANES):
        for i in range(LANES):
            total = A[i] * factors[LANES * j]
            for k in range(1, j + 1):
                total += A[LANES * k + i] * factors[LANES * j + k]
            target[LANES * j + i] = total
    for j in range(LANES):          # the diagonal is one; columns behind j are as they were
        for k in range(j + 1, LANES):
            for i in range(LANES):
                target[LANES * j + i] += target[LANES * k + i] * factors[LANES * j + k]


@compiled
def substitute(first, end, ends, rows, diagonal, factors, x):
    """Solve for some columns of blocks with L, in place; x is in the order of the slots.

    `ends` has the end of the blocks of every column that are used.
    """
    for j in range(first, end):
        subtract_blocks_times(x, rows, factors, at(x, LANES * j), diagonal[j] + 1, ends[j])


@compiled
def substitute_back(first, end, regularized, starts, rows, diagonal, factors, x):
    """The same with U."""
    for k in range(end - first):
        j = end - 1 - k
        y = at(x, LANES * j)
        if regularized:
            _divide_vector(y, at(factors, BLOCK * diagonal[j]))
            subtract_blocks_times(x, rows, factors, y, starts[j], diagonal[j])
        else:
            multiply_and_subtract(x, rows, factors, y, starts[j], diagonal[j])


@compiled
def _divide_vector(y, factors):
    """Solve with a block on the diagonal, by `invert_factors`."""
    for back in range(LANES):
        i = LANES - 1 - back
        for k in range(i):
            y[i] += factors[LANES * k + i] * y[k]
    for i in range(LANES):
        total = factors[LANES * i + i] * y[i]
        for k in range(i + 1, LANES):
            total += factors[LANES * k + i] * y[k]
        y[i] = total


@compiled
def eliminate_columns(first, end, system, state, condensed, column):
    """Factorize some columns of blocks of `State.matrix`; `column` is scratch memory.

    `condensed` tells whether it is a sum of `State.condensed`.
    """
    starts = pointer_to(system.block_starts)
    ends = pointer_to(system.condensed_ends) if condensed else at(starts, 1)
    return eliminate(first, end, system.regularized[0] == 1, starts, pointer_to(system.block_rows),
                     pointer_to(system.block_diagonal), ends, pointer_to(system.slot_unknowns),
                     pointer_to(state.matrix), column, pointer_to(state.scale))


@compiled
def solve(system, state, right, x):
    """Solve for all unknowns with the factors in `State.matrix`; `x` may be `right`."""
    across, starts, slots = (system.block_diagonal.size, pointer_to(system.block_starts),
                             pointer_to(state.solution))
    _take(system, state, right, 0, across)
    substitute(0, across, at(starts, 1), pointer_to(system.block_rows),
               pointer_to(system.block_diagonal), pointer_to(state.matrix), slots)
    substitute_back(0, across, system.regularized[0] == 1, starts, pointer_to(system.block_rows),
                    pointer_to(system.block_diagonal), pointer_to(state.matrix), slots)
    _put(system, state, x, 0, across)


@compiled
def _take(system, state, right, first, end):
    """Put the right side into the slots of some columns."""
    unknowns, slots = pointer_to(system.slot_unknowns), pointer_to(state.solution)
    for slot in range(LANES * first, LANES * end):
        slots[slot] = right[unknowns[slot]] if unknowns[slot] < system.diagonal.size else 0.0


@compiled
def _put(system, state, x, first, end):
    """Put the solution in the slots of some columns where its unknowns are."""
    unknowns, slots = pointer_to(system.slot_unknowns), pointer_to(state.solution)
    for slot in range(LANES * first, LANES * end):
        if unknowns[slot] < system.diagonal.size:
            x[unknowns[slot]] = slots[slot]


@compiled
def begin_part(system, state, first, end):
    """Begin to solve for the correction: a part, without what it adds to the rest."""
    _take(system, state, state.residual, first, end)
    substitute(first, end, pointer_to(system.block_ends), pointer_to(system.block_rows),
               pointer_to(system.block_diagonal), pointer_to(state.matrix),
               pointer_to(state.solution))


@compiled
def solve_rest(system, state):
    """Solve for the correction in the rest, once all parts have begun."""
    rest, across = system.part_blocks[system.part_blocks.size - 1], system.block_diagonal.size
    starts, rows, slots = (pointer_to(system.block_starts), pointer_to(system.block_rows),
                           pointer_to(state.solution))
    factors = pointer_to(state.matrix)
    _take(system, state, state.residual, rest, across)
    for j in range(rest):
        subtract_blocks_times(slots, rows, factors, at(slots, LANES * j), system.block_ends[j],
                              starts[j + 1])
    substitute(rest, across, at(starts, 1), rows, pointer_to(system.block_diagonal), factors, slots)
    substitute_back(rest, across, system.regularized[0] == 1, starts, rows,
                    pointer_to(system.block_diagonal), factors, slots)
    _put(system, state, state.correction, rest, across)


@compiled
def end_part(system, state, first, end):
    """Solve for the correction in a part, once the rest is known."""
    substitute_back(first, end, system.regularized[0] == 1, pointer_to(system.block_starts),
                    pointer_to(system.block_rows), pointer_to(system.block_diagonal),
                    pointer_to(state.matrix), pointer_to(state.solution))
    _put(system, state, state.correction, first, end)
