"""The compiled time loop: generalized-alpha on the Lie group, modified Newton, step control.

One loop for every scene, resumable: it works on flat arrays and returns a code. Small systems are
solved inside; for large ones it returns FACTOR and SOLVE and is called again with the answer.

The unknowns of a step are the increments dq (rotations: R exp(dTheta)) and the multipliers. The
matrix is kept in body axes and reused until convergence asks for a new one.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

from . import elimination
from .abi import (
    ACCELERATION,
    ENERGY,
    POWERS,
    RESIDUAL,
    TANGENT,
    VELOCITY,
    at,
    call_kernel,
    pointer_to,
)
from .arrays import Arrays
from .dense import columns_times
from .histories import cubic_at
from .links import add_expanded, add_second_order, place_hanging, pull_back
from .rotations import tangent_operator, turn

DONE, CHUNK, FACTOR, SOLVE, FAILED = range(5)           # what the loop returns
BEGIN, ITERATE, FACTORED, SOLVED = range(4)             # where it goes on
FORCES, TURNED, RENEWED, START, RATES = range(5)        # what is assembled, see assemble
# why a step failed
NO_REASON, HALF_TURN, NO_FRAME, NOT_FINITE, SLOW = range(5)
FINEST = 4096           # a grid step is cut into at most this many parts
MAX_ITERATIONS = 12
YOUNG = 3               # steps with new matrices that tell how fast the iteration can be
WORTH = 30.0            # new matrices cost about so many iterations,
TURNED_WORTH = 4.0      # and one of the bodies' old ones
LONGEST_HABIT = 32      # steps that begin with a new matrix before reuse is tried again
ORTHOGONAL = 8          # rotations are made orthogonal again after so many steps
POOR = 0.3              # contraction so slow asks for a new matrix at once
MOST_MATRICES = 4       # of a step
STRICT = 100.0          # tolerance of what accelerations move, in that of the increment
MEMORY = 0.99           # for the size of the accelerations, a step
RELAXATION = 1e-7       # of redundant constraints, in the scaled iteration matrix alone


@dataclass(frozen=True, eq=False)
class State(Arrays):
    """Everything a restart needs, and scratch memory."""

    now: NDArray            # one block of what is recorded: the next seven are parts of it
    works: NDArray          # done by every item since the start
    q: NDArray              # positions, modes, angles, multipliers; rotations: step increments
    R: NDArray              # rotation matrices, nine numbers each
    v: NDArray
    a: NDArray              # true accelerations
    frames: NDArray         # of superelements, nine numbers each
    frames_old: NDArray     # of the last accepted step
    aux: NDArray            # auxiliary accelerations of the integrator
    q_start: NDArray        # at t = 0
    q_old: NDArray          # the last accepted step
    R_old: NDArray
    v_old: NDArray
    a_old: NDArray
    aux_old: NDArray
    dq: NDArray             # increment of the step
    T: NDArray              # tangent operators of the rotation increments
    loads: NDArray          # of every item its amplitude and two rates
    loads_old: NDArray      # at the last accepted step
    powers: NDArray         # of the items, there
    coefficients: NDArray   # (8,) of the matrix, then gravity: see sebody.abi
    g: NDArray              # element forces
    J: NDArray              # element matrices, of superelements in the axes of their frame
    turned: NDArray         # one of them, positions in the axes they are solved for in
    residual: NDArray       # in body axes
    forces: NDArray         # the same, of the last matrix and in global axes, for links
    correction: NDArray
    expansion: NDArray      # scratch of links
    matrix: NDArray         # entries by columns or in blocks, there its factors; in body axes
    scale: NDArray          # of the unknowns: the scaled matrix has a unit diagonal
    weight: NDArray         # its inverse: corrections are measured in it, multipliers included
    inverse: NDArray        # of small systems, by padded columns, scales included
    column: NDArray         # scratch of the elimination
    work: NDArray
    energy: NDArray
    clock: NDArray          # see the CLOCK indices
    control: NDArray        # see the CONTROL indices


# State.clock
(TIME, STEP, CURRENT_STEP, LAST_NORM, CONTRACTION, FACTOR_STEP, FLOOR, SPAN, YOUNG_RATE,
 EXCESS, BEND) = range(11)
CLOCKS = 11
# State.control
(PHASE, GRID, UNIT, LEVEL, ITERATION, FRESH, WANTED, REASON, ITERATIONS, MATRICES, STEPS, CUTS,
 RECORDED, AGE, PIVOTED, EAGER, EAGER_LEFT) = range(17)
CONTROLS = 17


@dataclass(frozen=True, eq=False)
class Record(Arrays):
    """What is kept of the output steps."""

    rows: NDArray           # a copy of State.now each
    every: NDArray          # (1,) grid steps between records


def recorded_parts(coordinates: int, rotations: int, bodies: int, items: int
                   ) -> dict[str, slice]:
    """Where things are in State.now and so in the rows of a record."""
    sizes = {"t": 1, "iterations": 1, "works": items, "q": coordinates, "R": 9 * rotations,
             "v": coordinates, "a": coordinates, "frames": 9 * bodies, "frames_old": 9 * bodies}
    parts, first = {}, 0
    for name, size in sizes.items():
        parts[name] = slice(first, first + size)
        first += size
    return parts


class Scheme(NamedTuple):
    """Parameters of generalized-alpha; HHT is ``alpha_m = 0``."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    tolerance: float
    geometric: float        # 1 for consistent tangents, 0 for the paper's


@intrinsic
def _call_function(typingctx, address, t):
    def codegen(context, builder, sig, args):
        function = ir.FunctionType(ir.DoubleType(), [ir.DoubleType()])
        return builder.call(builder.inttoptr(args[0], function.as_pointer()), [args[1]])
    return types.float64(address, t), codegen


@njit(cache=True, error_model="numpy", forceinline=True)
def run_kernels(task, first, last, system, state):
    """Evaluate batches; returns the status of the first element that fails."""
    index, g, J = pointer_to(system.index), pointer_to(state.g), pointer_to(state.J)
    for b in range(first, last):
        status = call_kernel(
            system.address[b], task, system.count[b], system.stride[b], system.width[b],
            (at(index, system.at_index[b]), system.constants, state.q, state.R, state.v,
             state.a, state.frames_old, state.frames, state.T, state.loads, state.coefficients,
             at(g, system.at_g[b]), at(J, system.at_J[b]), state.work, state.energy))
        if status != 0:
            return status
    return 0


@njit(cache=True, error_model="numpy", forceinline=True)
def set_loads(system, loads, t):
    """Amplitudes of the items and their rates at a time."""
    for k in range(system.functions.shape[0]):
        if system.functions[k, 0] == 0:
            cubic_at(system.table_times, system.table_cubics, system.table_at[k],
                     system.table_at[k + 1] - 1, t, loads, 3 * k)
            continue
        for i in range(3):
            loads[3 * k + i] = (_call_function(system.functions[k, i], t)
                                if system.functions[k, i] != 0 else 0.0)


@njit(cache=True, error_model="numpy", forceinline=True)
def move_prescribed(system, state):
    """Motion of the prescribed coordinates; of rotations the increment of the step."""
    loads, old = state.loads, state.loads_old
    for k in range(system.prescribed.shape[0]):
        i = system.prescribed[k, 0]
        state.q[i], state.v[i], state.a[i], state.dq[i] = state.q_start[i], 0.0, 0.0, 0.0
    for k in range(system.prescribed.shape[0]):
        i, item, factor = (system.prescribed[k, 0], 3 * system.prescribed[k, 1],
                           system.prescribed_factor[k])
        if system.prescribed[k, 2] == 1:
            state.dq[i] += factor * (loads[item] - old[item])
        else:
            state.q[i] += factor * loads[item]
        state.v[i] += factor * loads[item + 1]
        state.a[i] += factor * loads[item + 2]


@njit(cache=True, error_model="numpy", forceinline=True)
def assemble(level, system, state, residual):
    """Sum of the element forces in `residual`, and the matrix.

    `level` is FORCES for these alone, TURNED for a matrix of the bodies' old ones in their new
    places and of new ones of joints and loads, RENEWED for new ones of all; START is for forces and
    accelerations of the constraints, RATES for their velocities.
    """
    bodies, batches = system.first_joint[0], system.address.size
    status = run_kernels(TANGENT if level == RENEWED else RESIDUAL, 0, bodies, system, state)
    if status != 0:
        return status
    task = RESIDUAL if level == FORCES else TANGENT
    if level >= START:
        task = ACCELERATION if level == START else VELOCITY
    status = run_kernels(task, bodies, batches, system, state)
    if status != 0:
        return status
    sum_forces(system, state, residual)
    if level == TURNED or level == RENEWED:
        sum_matrices(system, state, residual)
    return 0


@njit(cache=True, error_model="numpy", forceinline=True)
def sum_forces(system, state, residual):
    """Sum of the element forces, those on rigid links pulled back."""
    for i in range(residual.size):
        residual[i] = 0.0
    sums, unknowns = pointer_to(residual), pointer_to(system.g_unknown)
    for k in range(system.g_unknown.size):
        sums[unknowns[k]] += state.g[k]
    if system.links.hanging.shape[0] > 0:
        pull_back(system.links, state.q, state.R, residual)


@njit(cache=True, error_model="numpy")
def sum_matrices(system, state, forces):
    """The matrix from the element matrices, which stay as they are."""
    for k in range(state.matrix.size):
        state.matrix[k] = 0.0
    for k in range(system.padding.size):
        state.matrix[system.padding[k]] = 1.0
    matrix, J = pointer_to(state.matrix), pointer_to(state.turned)
    block, blocks = 0, system.turned_blocks.shape[0]
    linked, links = 0, system.links.elements.shape[0]
    for b in range(system.address.size):
        width = system.width[b]
        for element in range(system.count[b]):
            start = system.at_J[b] + element * width * width
            own, entries = at(pointer_to(state.J), start), at(pointer_to(system.J_entry), start)
            for k in range(width * width):
                J[k] = own[k]
            while block < blocks and system.turned_blocks[block, 0] == start:
                _turn_block(system.turned_blocks[block], system.dimension[0], J, state.frames)
                block += 1
            if linked < links and system.links.elements[linked, 0] == start:
                add_expanded(system.links, linked, J, state.frames, state.q, state.R, state.T,
                             state.matrix, state.expansion)
                linked += 1
                continue
            for k in range(width * width):
                matrix[entries[k]] += J[k]
    if links > 0:
        add_second_order(system.links, state.coefficients[2], state.q, state.R, state.T, forces,
                         state.matrix)


@njit(cache=True, error_model="numpy")
def _turn_block(block, dimension, J, frames):
    """Rows and columns of a position in an element matrix, to the axes it is solved for in."""
    width, row = block[1], block[2]
    to, own = at(pointer_to(frames), 9 * block[3]), at(pointer_to(frames), 9 * block[4])
    turn = np.empty(9)
    for i in range(3):
        for k in range(3):
            turn[3 * i + k] = own[3 * i + k] if block[3] < 0 else to[3 * k + i] if (
                block[4] < 0) else (
                to[i] * own[k] + to[3 + i] * own[3 + k] + to[6 + i] * own[6 + k])
    for across in range(2):
        first, next_line, step = (row, width, 1) if across == 0 else (row * width, 1, width)
        for i in range(width):
            p = at(J, first + i * next_line)
            x, y = p[0], p[step]
            z = p[2 * step] if dimension == 3 else 0.0
            for k in range(dimension):
                p[k * step] = turn[3 * k] * x + turn[3 * k + 1] * y + turn[3 * k + 2] * z


@njit(cache=True, error_model="numpy", forceinline=True)
def to_body_axes(system, frames, vector, back):
    """Turn the free positions of a vector into body axes, or back."""
    turned, spatial = pointer_to(system.turned), system.dimension[0] == 3
    for k in range(system.turned.shape[0]):
        p = at(pointer_to(vector), turned[2 * k])
        R = at(pointer_to(frames), 9 * turned[2 * k + 1])
        x, y = p[0], p[1]
        if not spatial:
            c, s = R[0], -R[3] if back else R[3]
            p[0], p[1] = c * x + s * y, c * y - s * x
        elif back:
            z = p[2]
            p[0] = R[0] * x + R[1] * y + R[2] * z
            p[1] = R[3] * x + R[4] * y + R[5] * z
            p[2] = R[6] * x + R[7] * y + R[8] * z
        else:
            z = p[2]
            p[0] = R[0] * x + R[3] * y + R[6] * z
            p[1] = R[1] * x + R[4] * y + R[7] * z
            p[2] = R[2] * x + R[5] * y + R[8] * z


@njit(cache=True, error_model="numpy")
def equilibrate(system, state):
    """Scales that give the matrix a unit diagonal and unit constraint rows: free of units and h."""
    n = system.diagonal.size
    for i in range(n):
        diagonal = abs(state.matrix[system.diagonal[i]])
        state.scale[i] = 0.0 if system.is_multiplier[i] > 0.0 else (
            1.0 / np.sqrt(diagonal) if diagonal > 0.0 else 1.0)
    sums = state.correction
    sums[:] = 0.0
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
        size = system.magnitude[i] * state.weight[i]
        floor += size * size
    state.clock[FLOOR] = 8.0 * 2.2e-16 * np.sqrt(floor)     # what rounding of positions leaves


@njit(cache=True, error_model="numpy")
def relax(system, state):
    """Make the matrix of redundant constraints regular.

    Their residuals are consistent and so is the answer: multipliers of least norm. Iterations go on
    until the constraints hold, so nothing is changed but the way there.
    """
    for i in range(system.diagonal.size):
        if system.is_multiplier[i] > 0.0:
            state.matrix[system.diagonal[i]] -= RELAXATION * state.weight[i] * state.weight[i]


@njit(cache=True, error_model="numpy")
def invert_dense(system, state, n):
    """Inverse of a small system, by columns, scales included; False if it is singular."""
    dense = np.empty((n, n))
    size = inverse_size = 0.0
    for j in range(n):
        for i in range(n):
            dense[j, i] = state.scale[i] * state.matrix[j * n + i] * state.scale[j]
            size += abs(dense[j, i])
    if not np.isfinite(size):
        return False
    try:
        inverse = np.linalg.inv(dense)
    except Exception:  # noqa: BLE001  (LAPACK met a zero pivot; compiled code has no other kind)
        return False
    for j in range(n):
        for i in range(n):
            inverse_size += abs(inverse[j, i])
            state.inverse[j, i] = state.scale[i] * inverse[j, i] * state.scale[j]
    return size * inverse_size < 1e16 * n


@njit(cache=True, error_model="numpy", forceinline=True)
def factorize(system, state):
    """Factors of a large system in place of its matrix; False, and the matrix, at a small pivot."""
    done = elimination.eliminate(
        system.block_diagonal.size, pointer_to(system.block_starts), pointer_to(system.block_rows),
        pointer_to(system.block_diagonal), pointer_to(state.matrix), pointer_to(state.column),
        pointer_to(state.scale))
    if not done:
        sum_matrices(system, state, state.forces)
        if system.relaxed[0] == 1:
            relax(system, state)
    return done


@njit(cache=True, error_model="numpy", forceinline=True)
def solve(system, state, dense):
    """Correction from the residual."""
    n, x = system.diagonal.size, pointer_to(state.correction)
    if dense:
        columns_times(pointer_to(state.inverse), pointer_to(state.residual), x, n, n)
        return
    for i in range(n):
        x[i] = state.residual[i]
    for i in range(system.padding.size):
        x[n + i] = 0.0
    elimination.substitute(system.block_diagonal.size, pointer_to(system.block_starts),
                           pointer_to(system.block_rows), pointer_to(system.block_diagonal),
                           pointer_to(state.matrix), x)


@njit(cache=True, error_model="numpy", forceinline=True)
def begin_step(system, state, scheme):
    """Remember the accepted state, predict the next one."""
    h = state.clock[CURRENT_STEP]
    for i in range(state.R.size):
        state.R_old[i] = state.R[i]
    for i in range(state.frames.size):
        state.frames_old[i] = state.frames[i]
    to_a = 1.0 / (1.0 - scheme.alpha_f)
    for i in range(state.dq.size):      # the auxiliary acceleration is taken to stay
        q, v, a, aux = state.q[i], state.v[i], state.a[i], state.aux[i]
        state.q_old[i], state.v_old[i], state.a_old[i], state.aux_old[i] = q, v, a, aux
        state.dq[i] = h * v + 0.5 * h * h * aux
        state.q[i] = q + state.dq[i]
        state.v[i] = v + h * aux
        state.a[i] = to_a * (aux - scheme.alpha_f * a)
    set_loads(system, state.loads, state.clock[TIME] + h)
    set_coefficients(state, scheme, h)
    move_prescribed(system, state)
    turn_rotations(system, state)
    state.control[ITERATION] = 0
    state.clock[LAST_NORM] = 0.0


@njit(cache=True, error_model="numpy", forceinline=True)
def set_coefficients(state, scheme, h):
    """Derivatives of acceleration and velocity by the increment."""
    state.coefficients[0] = (1 - scheme.alpha_m) / ((1 - scheme.alpha_f) * scheme.beta * h * h)
    state.coefficients[1] = scheme.gamma / (scheme.beta * h)
    state.coefficients[2] = 1.0
    state.coefficients[3] = scheme.geometric
    state.coefficients[4] = 1.0


@njit(cache=True, error_model="numpy", forceinline=True)
def turn_rotations(system, state):
    """Rotations from their increments of the step."""
    places, dq, q = pointer_to(system.rotation_at), pointer_to(state.dq), pointer_to(state.q)
    for r in range(system.rotation_at.size):
        first = places[r]
        x, y, z = dq[first], dq[first + 1], dq[first + 2]
        q[first], q[first + 1], q[first + 2] = x, y, z
        turn(pointer_to(state.R_old), 9 * r, x, y, z, pointer_to(state.R), 9 * r)
    if system.links.hanging.shape[0] > 0:
        place_hanging(system.links, state.q, state.v, state.a, state.R)


@njit(cache=True, error_model="numpy")
def set_tangent_operators(system, state):
    """``T(dTheta)`` of the rotation increments, for the columns of the matrix."""
    for r in range(system.rotation_at.size):
        at = system.rotation_at[r]
        (state.T[9 * r], state.T[9 * r + 1], state.T[9 * r + 2], state.T[9 * r + 3],
         state.T[9 * r + 4], state.T[9 * r + 5], state.T[9 * r + 6], state.T[9 * r + 7],
         state.T[9 * r + 8]) = tangent_operator(state.dq[at], state.dq[at + 1],
                                                state.dq[at + 2])


@njit(cache=True, error_model="numpy", forceinline=True)
def apply_correction(system, state, scheme):
    """Add the solved correction; returns 1 converged, 0 go on, -1 new matrix, -2 give up."""
    n, h = system.diagonal.size, state.clock[CURRENT_STEP]
    norm = size = bend = 0.0
    for i in range(n):
        d = state.correction[i] * state.weight[i]
        x = state.dq[i] + system.is_multiplier[i] * state.q_old[i]      # a multiplier itself
        z = state.a[i] * state.weight[i]
        norm += d * d
        size += x * x * state.weight[i] * state.weight[i]
        bend += z * z
    norm, size = np.sqrt(norm), np.sqrt(size)
    bend = max(scheme.beta * h * h * np.sqrt(bend), state.clock[BEND])
    if not np.isfinite(norm):
        state.clock[LAST_NORM] = norm
        return -2
    to_body_axes(system, state.frames, state.correction, True)
    to_a, to_v, to_aux = state.coefficients[0], state.coefficients[1], 1 / (scheme.beta * h * h)
    for i in range(n):
        d = state.correction[i]
        moving = d * (1.0 - system.is_multiplier[i])
        state.dq[i] -= d
        state.q[i] -= d
        state.v[i] -= to_v * moving
        state.a[i] -= to_a * moving
        state.aux[i] -= to_aux * moving
    turn_rotations(system, state)
    iteration, last = state.control[ITERATION], state.clock[LAST_NORM]
    rate = state.clock[CONTRACTION]
    target = min(scheme.tolerance * size, STRICT * scheme.tolerance * bend) + state.clock[FLOOR]
    state.clock[BEND] = bend
    if iteration == 0:
        state.clock[SPAN] = np.log(norm / target)
    if iteration > 0 and last > 0.0:
        rate = norm / last
        state.clock[CONTRACTION] = rate
    state.control[ITERATION] = iteration + 1
    state.control[ITERATIONS] += 1
    state.clock[LAST_NORM] = norm
    rate = min(max(rate, 1e-3), 0.95)
    if rate / (1.0 - rate) * norm <= target:
        return 1
    left = MAX_ITERATIONS - iteration - 1
    if left <= 0 or (iteration > 2 and state.control[FRESH] > 2 and rate > 0.9):
        return -2
    if iteration == 0 or state.control[FRESH] >= MOST_MATRICES:
        return 0
    price = WORTH if next_matrix(system, state) == RENEWED else TURNED_WORTH
    return -1 if rate > POOR or np.log(target / norm) / np.log(rate) > min(price, left) else 0


@njit(cache=True, error_model="numpy", forceinline=True)
def next_matrix(system, state):
    """First the bodies' old matrices in their new places, where that helps, then new ones."""
    return TURNED if system.linked[0] == 1 and state.control[FRESH] == 0 else RENEWED


@njit(cache=True, error_model="numpy", forceinline=True)
def accept(system, state, record):
    """End a converged step: rotations stay orthogonal, work of the loads, output."""
    clock, control = state.clock, state.control
    h = clock[CURRENT_STEP]
    if control[STEPS] % ORTHOGONAL == 0:
        for r in range(system.rotation_at.size):
            _orthogonalize(at(pointer_to(state.R), 9 * r))
    add_work(system, state, h)
    watch_age(state)
    if control[FRESH] == 0:
        control[EAGER] = 0
    clock[BEND] *= MEMORY
    control[STEPS] += 1
    control[UNIT] += FINEST >> control[LEVEL]
    if control[UNIT] >= FINEST:             # back on the output grid
        control[UNIT] = 0
        control[GRID] += 1
        clock[TIME] = control[GRID] * clock[STEP]
        if control[GRID] % record.every[0] == 0:
            write_record(state, record)
    else:
        clock[TIME] = (control[GRID] + control[UNIT] / FINEST) * clock[STEP]
    while control[LEVEL] > 0 and control[UNIT] % (FINEST >> (control[LEVEL] - 1)) == 0:
        control[LEVEL] -= 1                 # try the longer step again
    clock[CURRENT_STEP] = clock[STEP] / (1 << control[LEVEL])


@njit(cache=True, error_model="numpy", forceinline=True)
def watch_age(state):
    """Ask for new matrices once the old ones have cost as many extra iterations as these would.

    Extra is what exceeds the iterations that the contraction of their youth would have needed.
    """
    clock, control = state.clock, state.control
    control[AGE] += 1
    if control[ITERATION] < 2:
        return
    if control[AGE] <= YOUNG:
        clock[YOUNG_RATE] = min(clock[YOUNG_RATE], max(clock[CONTRACTION], 1e-3))
        return
    needed = 1.0 + max(clock[SPAN], 0.0) / -np.log(clock[YOUNG_RATE])
    clock[EXCESS] += max(control[ITERATION] - np.ceil(needed), 0.0)
    if clock[EXCESS] > WORTH:
        control[WANTED] = RENEWED


@njit(cache=True, error_model="numpy", forceinline=True)
def add_work(system, state, h):
    """Work of the items over a step, by the trapezoidal rule."""
    for k in range(state.powers.size):
        state.works[k] += 0.5 * h * state.powers[k]
    set_powers(system, state)
    for k in range(state.powers.size):
        state.works[k] += 0.5 * h * state.powers[k]
    for k in range(state.loads.size):
        state.loads_old[k] = state.loads[k]


@njit(cache=True, error_model="numpy", forceinline=True)
def set_powers(system, state):
    """Rate of work of the items in the current state."""
    if state.powers.size == 0:
        return
    if system.damped[0] == 1:
        run_kernels(ENERGY, 0, system.first_joint[0], system, state)
    run_kernels(ENERGY, system.first_power[0], system.address.size, system, state)
    for k in range(state.powers.size):
        state.powers[k] = state.energy[POWERS + k]
    if system.prescribed.shape[0] > 0:
        add_prescribed_powers(system, state)


@njit(cache=True, error_model="numpy")
def add_prescribed_powers(system, state):
    """What moves coordinates in a prescribed way bears the forces on them."""
    run_kernels(RESIDUAL, 0, system.address.size, system, state)
    sum_forces(system, state, state.residual)
    for k in range(system.prescribed.shape[0]):
        state.powers[system.prescribed[k, 1]] = 0.0
    for k in range(system.prescribed.shape[0]):
        item = system.prescribed[k, 1]
        state.powers[item] += (state.residual[system.prescribed[k, 0]]
                               * system.prescribed_factor[k] * state.loads[3 * item + 1])


@njit(cache=True, error_model="numpy", forceinline=True)
def _orthogonalize(R):
    """One Newton step ``R (3 I - R^T R) / 2`` towards the nearest rotation."""
    for i in range(3):
        a, b, c = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        s = 1.5 - 0.5 * (a * a + b * b + c * c)
        R[3 * i], R[3 * i + 1], R[3 * i + 2] = s * a, s * b, s * c
    for i in range(2):
        for j in range(i + 1, 3):
            dot = 0.0
            for k in range(3):
                dot += R[3 * i + k] * R[3 * j + k]
            for k in range(3):
                x = R[3 * i + k]
                R[3 * i + k] -= 0.5 * dot * R[3 * j + k]
                R[3 * j + k] -= 0.5 * dot * x


@njit(cache=True, error_model="numpy", forceinline=True)
def write_record(state, record):
    """Store the accepted state."""
    k = state.control[RECORDED]
    state.now[0], state.now[1] = state.clock[TIME], state.control[ITERATIONS]
    for i in range(state.now.size):     # one block: nine separate ones cost as much as a step
        record.rows[k, i] = state.now[i]
    state.control[RECORDED] = k + 1


@njit(cache=True, error_model="numpy")
def cut_step(state, reason):
    """Back to the accepted state with half the step; False when it cannot be cut further."""
    for i in range(state.q.size):       # loops: assigned slices compile slowly
        state.q[i] = state.q_old[i]
        state.v[i] = state.v_old[i]
        state.a[i] = state.a_old[i]
        state.aux[i] = state.aux_old[i]
    for i in range(state.R.size):
        state.R[i] = state.R_old[i]
    for i in range(state.frames.size):
        state.frames[i] = state.frames_old[i]
    state.control[REASON] = reason
    state.control[CUTS] += 1
    state.control[LEVEL] += 1
    if (1 << state.control[LEVEL]) > FINEST:
        return False
    state.clock[CURRENT_STEP] = state.clock[STEP] / (1 << state.control[LEVEL])
    state.control[WANTED] = RENEWED
    state.clock[CONTRACTION] = 0.95     # nothing is known of the shorter step
    return True


@njit(cache=True, error_model="numpy")
def advance(system, state, record, scheme, last_grid, chunk, dense):
    """Run until `last_grid`, for at most `chunk` steps, or until Python is asked for something."""
    control, clock = state.control, state.clock
    n = system.diagonal.size
    steps = 0
    reason = np.int64(NO_REASON)
    while True:
        if reason != NO_REASON:         # back to the accepted state, with half the step
            control[PHASE] = BEGIN
            if not cut_step(state, reason):
                return FAILED
            reason = np.int64(NO_REASON)
        if control[PHASE] == BEGIN:
            if control[GRID] >= last_grid:
                return DONE
            if steps >= chunk:
                return CHUNK
            steps += 1
            begin_step(system, state, scheme)
            control[FRESH] = 0
            if clock[FACTOR_STEP] != clock[CURRENT_STEP]:
                control[WANTED] = RENEWED
            if control[WANTED] == FORCES and control[EAGER_LEFT] > 0:
                control[EAGER_LEFT] -= 1
                control[WANTED] = TURNED
            control[PHASE] = ITERATE
        if control[PHASE] == ITERATE:
            level = control[WANTED]
            if level == RENEWED:
                set_tangent_operators(system, state)
            reason = assemble(level, system, state, state.residual)
            if reason != NO_REASON:
                continue
            if level != FORCES and system.links.hanging.shape[0] > 0:
                for i in range(state.residual.size):
                    state.forces[i] = state.residual[i]
            to_body_axes(system, state.frames, state.residual, False)
            control[PHASE] = FACTORED
            if level != FORCES:
                if level == RENEWED:
                    equilibrate(system, state)
                    control[AGE], clock[YOUNG_RATE], clock[EXCESS] = 0, 0.5, 0.0
                    clock[FACTOR_STEP] = clock[CURRENT_STEP]
                if system.relaxed[0] == 1:
                    relax(system, state)
                control[WANTED] = FORCES
                control[FRESH] += 1
                control[MATRICES] += 1
                if dense:
                    if not invert_dense(system, state, n):
                        reason = np.int64(NOT_FINITE)
                        continue
                else:
                    control[PIVOTED] = 0
                    if not factorize(system, state):
                        control[PIVOTED] = 1
                        return FACTOR
        if control[PHASE] == FACTORED:
            control[PHASE] = SOLVED
            if control[PIVOTED] == 1:
                return SOLVE
            solve(system, state, dense)
        verdict = apply_correction(system, state, scheme)
        control[PHASE] = ITERATE
        if verdict == 1:
            accept(system, state, record)
            control[PHASE] = BEGIN
        elif verdict == -1:
            control[WANTED] = next_matrix(system, state)
            if control[WANTED] == TURNED:
                control[EAGER] = min(2 * control[EAGER] + 1, LONGEST_HABIT)
                control[EAGER_LEFT] = control[EAGER]
        elif verdict == -2:
            if control[FRESH] == 0 and np.isfinite(clock[LAST_NORM]):
                # the old matrix may be to blame: the same step again with a new one
                control[LEVEL] -= 1
                control[CUTS] -= 1
            reason = np.int64(SLOW if np.isfinite(clock[LAST_NORM]) else NOT_FINITE)
