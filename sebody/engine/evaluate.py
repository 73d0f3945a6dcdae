"""Forces and matrices of all elements in a state, for compiled code."""

from numba import types
from numba.extending import intrinsic

from sebody.compiler.decorators import compiled
from sebody.contract.layout import C_DAMPING, CLOCK, FIELD, INPUT, OK, RESIDUAL, VELOCITY
from sebody.engine.actuator_inputs import input_at
from sebody.engine.links import place_dependent, pull_back
from sebody.engine.load_amplitudes import set_series, time_function_at
from sebody.engine.selection import any_true, either
from sebody.kernels.abi import Arguments, at, call_kernel, called, pointer_to
from sebody.kernels.rotations import rotate, tangent_operator

SHARE = 64              # elements of a batch that are evaluated at a time, eights of equal bodies
UNMOVED = 0.03          # share of the tolerance that elements may move and keep their forces


@intrinsic
def _call_function(typingctx, address, t):
    return types.float64(address, t), called


@compiled(forceinline=True)
def run_kernels(task, first, last, system, state):
    """Evaluate batches under the loads set; returns the status of the first element that fails."""
    set_gravity(system, state)
    return run_batches(task, first, last, system, state)


@compiled(forceinline=True)
def set_gravity(system, state):
    """Set gravity that changes with time from the amplitudes of its ports."""
    fields, c = system.gravity_fields, state.coefficients
    for k in range(system.gravity_ports.size):
        amplitude = state.loads[3 * system.gravity_ports[k]]
        for i in range(system.dimension[0]):
            if k == 0:
                c[FIELD + i] = amplitude * fields[k, i]
            else:
                c[FIELD + i] += amplitude * fields[k, i]


@compiled(forceinline=True)
def run_batches(task, first, last, system, state):
    """The same under gravity as it is."""
    for b in range(first, last):
        for begin in range(0, system.count[b], SHARE):
            status = run_part(task, b, begin, min(SHARE, system.count[b] - begin), system, state,
                              pointer_to(state.work))
            if status != OK:
                return status
    return OK


@compiled(forceinline=True)
def run_part(task, b, first, count, system, state, work):
    """Evaluate some elements of a batch; `work` is scratch memory."""
    index, g, J = pointer_to(system.index), pointer_to(state.g), pointer_to(state.J)
    stride, width = system.stride[b], system.width[b]
    return call_kernel(
        system.address[b], task, count, stride, width,
        Arguments(index=at(index, system.at_index[b] + first * stride),
                  constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
                  references=state.frames_old, frames=state.frames, T=state.T, loads=state.loads,
                  coefficients=state.coefficients, forces=at(g, system.at_g[b] + first * width),
                  matrices=at(J, system.at_J[b] + first * width * width), work=work,
                  energies=state.energy))


@compiled(forceinline=True)
def set_loads(system, kept, loads, t):
    """Amplitudes of the power ports at a time, and their first two derivatives; of series of loads.

    `kept` is `State.frames`, which holds the inputs.
    """
    set_loads_beside(system, kept, loads, t, 0.0)


@compiled
def set_loads_beside(system, kept, loads, t, beside):
    """The same before a jump at t, with a short negative time `beside`, or after it."""
    for k in range(system.functions.shape[0]):
        if system.functions[k, 0] == 0:
            time_function_at(system.table_times, system.table_pieces, system.table_at[k],
                       system.table_at[k + 1] - 1, t, beside, loads, 3 * k)
            continue
        if system.functions[k, 0] == CLOCK:     # what is read at this time may jump
            loads[3 * k], loads[3 * k + 1], loads[3 * k + 2] = t + beside, 1.0, 0.0
            continue
        if system.functions[k, 0] == INPUT:
            loads[3 * k] = input_at(system.table_pieces, system.table_at[k], kept,
                                    system.functions[k, 1], t)
            loads[3 * k + 1], loads[3 * k + 2] = 0.0, 0.0
            continue
        for i in range(3):
            loads[3 * k + i] = (_call_function(system.functions[k, i], t + beside)
                                if system.functions[k, i] != 0 else 0.0)
        loads[3 * k] -= beside * loads[3 * k + 1]       # of a motion, which does not jump
    set_series(system.series, system.series_times, system.series_values, t, beside, loads)


@compiled(forceinline=True)
def move_prescribed(system, state):
    """Set prescribed coordinates, their rates, and the increments of the step."""
    loads, old = state.loads, state.loads_old
    for k in range(system.prescribed.shape[0]):
        i = system.prescribed[k, 0]
        state.q[i], state.v[i], state.a[i], state.dq[i] = state.q_start[i], 0.0, 0.0, 0.0
    for k in range(system.prescribed.shape[0]):
        i, port, factor = (system.prescribed[k, 0], 3 * system.prescribed[k, 1],
                           system.prescribed_factor[k])
        state.dq[i] += factor * (loads[port] - old[port])
        if system.prescribed[k, 2] == 0:
            state.q[i] += factor * loads[port]
        state.v[i] += factor * loads[port + 1]
        state.a[i] += factor * loads[port + 2]


@compiled(forceinline=True)
def update_rotations(system, state):
    """Set rotation matrices from the increments of the step, then the dependent positions."""
    places, dq, q = pointer_to(system.rotation_at), pointer_to(state.dq), pointer_to(state.q)
    for r in range(system.rotation_at.size):
        first = places[r]
        x, y, z = dq[first], dq[first + 1], dq[first + 2]
        q[first], q[first + 1], q[first + 2] = x, y, z
        rotate(pointer_to(state.R_old), 9 * r, x, y, z, pointer_to(state.R), 9 * r)
    if system.links.dependent.shape[0] > 0:
        place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)


@compiled
def set_tangent_operators(system, state):
    """Set ``T(dTheta)`` of the rotation increments, for the columns of the matrix."""
    for r in range(system.rotation_at.size):
        at = system.rotation_at[r]
        (state.T[9 * r], state.T[9 * r + 1], state.T[9 * r + 2], state.T[9 * r + 3],
         state.T[9 * r + 4], state.T[9 * r + 5], state.T[9 * r + 6], state.T[9 * r + 7],
         state.T[9 * r + 8]) = tangent_operator(state.dq[at], state.dq[at + 1],
                                                state.dq[at + 2])


@compiled(forceinline=True)
def run_elements(of_bodies, of_others, system, state):
    """Evaluate the elements; kernels of superelements are given one task, all others another."""
    bodies, batches = system.first_joint[0], system.address.size
    status = run_kernels(of_bodies, 0, bodies, system, state)
    if status != OK:
        return status
    return run_kernels(of_others, bodies, batches, system, state)


@compiled(forceinline=True)
def assemble(of_bodies, of_others, system, state, residual):
    """Evaluate the elements and sum their forces in `residual`; `matrix` sums their matrices.

    Kernels of superelements are given one task, all others another one: VELOCITY and ACCELERATION
    of the constraints are combined with the RESIDUAL of the superelements.
    """
    status = run_elements(of_bodies, of_others, system, state)
    if status != OK:
        return status
    sum_forces(system, state, residual)
    return OK


@compiled(forceinline=True)
def sum_forces(system, state, residual):
    """Sum the element forces; those on dependent positions are pulled back."""
    for i in range(residual.size):
        residual[i] = 0.0
    sums, unknowns = pointer_to(residual), pointer_to(system.g_unknown)
    for k in range(system.g_unknown.size):
        sums[unknowns[k]] += state.g[k]
    if system.links.dependent.shape[0] > 0:
        pull_back(system.links, state.q, state.R, state.turns, residual)


@compiled
def limit_of_moved(state):
    """The square of what an element may move and keep its forces: a share of the tolerance."""
    limit = UNMOVED * state.clock.target
    return limit * limit / float(state.moved.size)


@compiled
def run_moved(system, state):
    """Evaluate the forces of the elements that the last correction moved; others keep theirs."""
    before, limit = 0, limit_of_moved(state)
    for b in range(system.address.size):
        for first in range(0, system.count[b], SHARE):
            count = min(SHARE, system.count[b] - first)
            find_moved(system, state, b, first, count, before, limit)
            status = run_found(system, state, b, first, count, before, pointer_to(state.work))
            if status != OK:
                return status
        before += system.count[b]
    return OK


@compiled
def find_moved(system, state, b, first, count, before, limit):
    """Find what moved of some elements of a batch, which `before` elements of others precede."""
    unknowns = pointer_to(system.g_unknown)
    k = system.at_g[b] + first * system.width[b]
    for element in range(before + first, before + first + count):
        size = 0.0 * limit
        for _ in range(system.width[b]):
            i = unknowns[k]
            change = state.last_change[i] * state.weight[i]
            size += change * change
            k += 1
        state.moved[element] = either(size > limit, 1.0, 0.0)


@compiled
def run_found(system, state, b, first, count, before, work):
    """Evaluate the forces of those that were found, in lanes in any member."""
    begin, last = first, first + count
    while begin < last:
        if not any_true(state.moved[before + begin] > 0.0):
            begin += 1
            continue
        end = begin + 1
        while end < last and any_true(state.moved[before + end] > 0.0):
            end += 1
        status = run_part(RESIDUAL, b, begin, end - begin, system, state, work)
        if status != OK:
            return status
        begin = end
    return OK


@compiled
def take_rates(system, state):
    """Put residuals of the constraints' rates in the place of those of the constraints.

    Rates are divided by their derivative with respect to an increment, so the same matrix serves
    for both. `constraint_residuals` gets the residuals of the constraints themselves that the
    correction of their rates leaves.
    """
    status = run_kernels(VELOCITY, system.first_joint[0], system.address.size, system, state)
    n, residual = system.diagonal.size, state.residual
    for i in range(n):
        state.constraint_residuals[i] = residual[i] * system.is_multiplier[i]
        residual[i] -= state.constraint_residuals[i]
    for k in range(system.g_unknown.size):
        unknown = system.g_unknown[k]
        if system.is_multiplier[unknown] > 0.0:
            residual[unknown] += state.g[k] / state.coefficients[C_DAMPING]
    for i in range(n):
        state.constraint_residuals[i] -= residual[i] * system.is_multiplier[i]
    return status


@compiled(forceinline=True)
def to_body_axes(system, frames, vector, back):
    """Rotate the free positions of a vector into body axes, or back."""
    rotated, spatial = pointer_to(system.rotated), system.dimension[0] == 3
    for k in range(system.rotated.shape[0]):
        p = at(pointer_to(vector), rotated[2 * k])
        R = at(pointer_to(frames), 9 * rotated[2 * k + 1])
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
