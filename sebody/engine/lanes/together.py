"""Matrices of eight members at once, for large models of bodies that rotate against each other.

Such members want a matrix in nearly every step, and to gather and scatter their numbers for each
takes longer than to make eight at once: see `sebody.engine.matrix` for what is made.
"""

import math
from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import some, spread, where
from sebody.contract.counts import LANES
from sebody.contract.layout import C_MASS, OK, TANGENT
from sebody.engine import condensation, elimination
from sebody.engine.arrays import Arrays
from sebody.engine.elimination import BLOCK, SMALL_PIVOT
from sebody.engine.evaluate import run_kernels, set_tangent_operators
from sebody.engine.matrix import ROUNDING, THIN, sum_matrices
from sebody.engine.state import State
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to

WANTED, EVALUATED, MADE = range(3)      # of `Together.asked`


@dataclass(frozen=True, eq=False)
class Together(Arrays):
    """Memory in which matrices are made: members that want none keep theirs.

    ==================  ============================================================================
    routine             (1,) address of `refactorize`; zero where matrices are made one by one
    state               of the members, but with forces, frames and the sum of the element matrices
                        in memory of its own
    T, J                tangent operators and element matrices of members that keep theirs
    begun               (9 b,) frames before the iterate was evaluated
    asked               (3,) one of members that want a matrix, of those whose bodies' matrices are
                        to be new, and of those whose matrix was made; else zero
    ==================  ============================================================================
    """

    routine: NDArray
    state: State
    T: NDArray
    J: NDArray
    begun: NDArray
    asked: NDArray


@compiled
def refactorize(system, state, together):
    """Make the matrices that are asked for; if none is, those of bodies and their frames alone."""
    own, asked = together.state, together.asked
    wanted, evaluated = asked[WANTED] > 0.0, asked[EVALUATED] > 0.0
    if some(evaluated):
        _evaluate_bodies(system, state, together, evaluated)
    if not some(wanted):
        for k in range(state.frames.size):
            state.frames[k] = where(evaluated, own.frames[k], state.frames[k])
        return OK
    copy(state.frames, own.frames)
    run_kernels(TANGENT, system.first_joint[0], system.address.size, system, own)
    sum_matrices(system, own, state.forces, False)
    scaled = evaluated | (wanted & (state.control.age == 0.0))
    if some(scaled):
        _equilibrate(system, own, scaled)
    elimination.eliminate_columns(0, system.block_diagonal.size, system, own, False,
                                  pointer_to(own.column))
    made = wanted
    for j in range(system.block_diagonal.size):
        made = made & (abs(own.matrix[BLOCK * system.block_diagonal[j]]) < math.inf)
    for k in range(own.matrix.size):
        state.matrix[k] = where(wanted, own.matrix[k], state.matrix[k])
    asked[MADE] = where(made, spread(1.0), spread(0.0))
    return OK


@compiled(forceinline=True)
def _evaluate_bodies(system, state, together, evaluated):
    """Evaluate tangent operators and element matrices of bodies; some members keep theirs."""
    own, T, J = together.state, together.T, together.J
    bodies = system.first_joint[0]
    of_bodies = system.at_J[bodies]
    copy(state.T, T)
    for k in range(of_bodies):
        J[k] = state.J[k]
    copy(together.begun, own.frames)
    set_tangent_operators(system, own)
    for k in range(T.size):
        state.T[k] = where(evaluated, state.T[k], T[k])
    run_kernels(TANGENT, 0, bodies, system, own)
    for k in range(of_bodies):
        state.J[k] = where(evaluated, state.J[k], J[k])


@compiled(forceinline=True)
def _equilibrate(system, state, evaluated):
    """Scales of some members, and what rounding leaves of their positions."""
    n, mass = system.diagonal.size, state.coefficients[C_MASS]
    sums, zero = state.correction, spread(0.0)
    for i in range(n):
        sums[i] = zero
        if system.is_multiplier[i] == 0.0:
            diagonal = max(abs(state.matrix[system.diagonal[i]]), THIN * mass * system.inertias[i])
            state.scale[i] = where(evaluated, 1.0 / math.sqrt(diagonal), state.scale[i])
    for k in range(system.rows.size):
        row, column = system.rows[k], system.columns[k]
        if system.is_multiplier[row] > 0.0 and system.is_multiplier[column] == 0.0:
            entry = state.matrix[k] * state.scale[column]
            sums[row] += entry * entry
    floor = zero
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            scale = where(sums[i] > 0.0, 1.0 / math.sqrt(sums[i]), spread(1.0))
            state.scale[i] = where(evaluated, scale, state.scale[i])
        state.weight[i] = where(evaluated, 1.0 / state.scale[i], state.weight[i])
        size = max(system.magnitude[i], abs(state.q[i])) * state.weight[i]
        floor += where(system.magnitude[i] > 0.0, size * size, zero)
    state.clock.floor = where(evaluated, ROUNDING * math.sqrt(floor), state.clock.floor)


@in_lanes_of(condensation.condensed_matrix)
def condensed_matrix(system, state, k, evaluated):
    """The matrix as it was evaluated: in lanes none is condensed."""
    return evaluated


@in_lanes_of(elimination.invert_factors)
def invert_factors(D, factors, unknowns, scale):
    """`elimination.invert_factors` in lanes, where regularized matrices are never made."""
    return False


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
