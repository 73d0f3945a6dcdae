"""Work of the power ports: loads, springs, drives, prescribed motions and damped bodies.

Over a step a force f does the work ``(f_n + f_n+1) / 2 . dq`` with the increment dq of the step,
not the mean of the powers at both ends: so energies and works agree as they do in the scheme. With
the trapezoidal rule, ``M dv = h (F_n + F_n+1) / 2`` and ``dq = h (v_n + v_n+1) / 2``, the work of
all forces F is the change of the kinetic energy, exactly, and that of linear elastic forces the
change of strain energy. What numerical damping takes is left over.

Elements with a port leave its force, as a residual, in `State.g` when they are asked for ENERGY.
Bodies with damping tell its power alone: it is taken in the middle of the step, at the velocities
``dq / h``.
"""

from sebody.engine.evaluate import run_kernels, sum_forces
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to
from sebody.kernels.layout import AT_PORT, ENERGY, POWERS, RESIDUAL
from sebody.kernels.pipeline import compiled
from sebody.kernels.rotations import rotate


@compiled
def set_acting(system, state):
    """Set the forces of the power ports in the current state: of elements, then of motions."""
    if state.works.size == 0:
        return
    first, power = system.first_power[0], system.at_g[system.first_power[0]]
    elements = state.g.size - power
    run_kernels(ENERGY, first, system.address.size, system, state)
    for k in range(elements):
        state.acting[k] = state.g[power + k]
    if system.prescribed.shape[0] > 0:
        run_kernels(RESIDUAL, 0, system.address.size, system, state)
        sum_forces(system, state, state.residual)
        for k in range(system.prescribed.shape[0]):
            state.acting[elements + k] = -system.prescribed_factor[k] * (
                state.residual[system.prescribed[k, 0]])


@compiled
def add_work(system, state, h):
    """Add the work of the power ports over a step that was accepted."""
    if state.works.size == 0:
        return
    copy(state.acting, state.acting_old)
    copy(state.works, state.works_old)
    set_acting(system, state)
    _set_increments(system, state)
    for k in range(state.works.size):
        state.change[k] = state.loads[3 * k] - state.loads_old[3 * k]
    _subtract_products(system, 0.5, state.acting_old, state.increments, state.change, state.works)
    _subtract_products(system, 0.5, state.acting, state.increments, state.change, state.works)
    if system.damped[0] == 1:
        _add_damping(system, state, h)


@compiled
def _set_increments(system, state):
    """Set the increments of the step; of rotations in space they are unknowns themselves."""
    for i in range(state.q.size):
        state.increments[i] = state.q[i] - state.q_old[i]
    for r in range(system.rotation_at.size):
        first = system.rotation_at[r]
        for i in range(first, first + 3):
            state.increments[i] = state.dq[i]


@compiled
def _subtract_products(system, factor, acting, ways, motions, sums):
    """Subtract products of forces and ways, or velocities, from sums by power ports.

    Parameters
    ----------
    acting
        As `set_acting` sets them.
    ways : (coordinates,)
    motions : (ports,)
        Of prescribed coordinates.
    """
    power, unknowns = system.at_g[system.first_power[0]], pointer_to(system.g_unknown)
    for b in range(system.first_power[0], system.address.size):
        width = system.width[b]
        for element in range(system.count[b]):
            first = system.at_g[b] + element * width
            product = 0.0
            for k in range(first, first + width):
                i = unknowns[k]
                product += acting[k - power] * ways[i] * (1.0 - system.is_multiplier[i])
            port = system.index[system.at_index[b] + element * system.stride[b] + AT_PORT]
            sums[port] -= factor * product
    elements = acting.size - system.prescribed.shape[0]
    for k in range(system.prescribed.shape[0]):
        port = system.prescribed[k, 1]
        sums[port] -= factor * acting[elements + k] * motions[port]


@compiled
def _add_damping(system, state, h):
    """Add the work of the bodies' damping over a step."""
    copy(state.now, state.kept)
    for i in range(state.q.size):
        state.q[i] = state.q_old[i] + 0.5 * state.increments[i]
        state.v[i] = state.increments[i] / h
    q = pointer_to(state.q)
    for r in range(system.rotation_at.size):
        first = system.rotation_at[r]
        for i in range(first, first + 3):
            q[i] = 0.5 * state.dq[i]
        rotate(pointer_to(state.R_old), 9 * r, q[first], q[first + 1], q[first + 2],
               pointer_to(state.R), 9 * r)
    for k in range(state.works.size):
        state.energy[POWERS + k] = 0.0
    run_kernels(ENERGY, 0, system.first_joint[0], system, state)
    copy(state.kept, state.now)
    for k in range(state.works.size):
        state.works[k] += h * state.energy[POWERS + k]


@compiled
def set_powers(system, state, h):
    """Set the powers at the begin and end of the last step; of bodies' damping the mean one."""
    rates, ports = state.change, state.works.size
    for k in range(ports):
        state.powers[k] = (state.works[k] - state.works_old[k]) / h
    for b in range(system.first_power[0], system.address.size):
        for element in range(system.count[b]):
            state.powers[system.index[system.at_index[b] + element * system.stride[b]
                                      + AT_PORT]] = 0.0
    for k in range(system.prescribed.shape[0]):
        state.powers[system.prescribed[k, 1]] = 0.0
    copy(state.powers, state.powers_old)
    for k in range(ports):
        rates[k] = state.loads_old[3 * k + 1]
    _subtract_products(system, 1.0, state.acting_old, state.v_old, rates, state.powers_old)
    for k in range(ports):
        rates[k] = state.loads[3 * k + 1]
    _subtract_products(system, 1.0, state.acting, state.v, rates, state.powers)
