"""Work of the power ports: loads, springs, drives, prescribed motions and damped bodies.

Over a step a force f does the work ``(f_n + f_n+1) / 2 . dq`` with the increment dq of the step,
not the mean of the powers at both ends: so energies and works agree as they do in the scheme. With
the trapezoidal rule, ``M dv = h (F_n + F_n+1) / 2`` and ``dq = h (v_n + v_n+1) / 2``, the work of
all forces F is the change of the kinetic energy, exactly, and that of linear elastic forces the
change of strain energy. What numerical damping takes is left over.

Elements with a port leave its force, as a residual, in `State.g` when they are asked for ENERGY.
Bodies with damping tell its power alone: it is taken in the middle of the step, at the velocities
``dq / h``.

Gravity ``a(t) g`` has the potential ``V = -a g . m x`` with the first moment of mass ``m x``. Its
change with time supplies energy, over a step ``(V_n + V_n+1) / 2 da`` with potentials of unit
amplitude, which is what remains of the change of V and the work on the bodies.
"""

from sebody.compiler.decorators import compiled
from sebody.contract.layout import AT_PORT, ENERGY, FIELD, POTENTIAL, POWERS, RESIDUAL
from sebody.engine.evaluate import run_batches, run_kernels, sum_forces
from sebody.engine.vectors import copy
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.rotations import rotate


@compiled
def add_work(system, state, h):
    """Add the work of the power ports over a step that was accepted."""
    if state.works.size == 0:
        return
    copy(state.works, state.works_old)
    for k in range(system.links.dependent.shape[0]):
        first = system.links.dependent[k, 0]
        for i in range(first, first + system.dimension[0]):
            state.dq[i] = state.q[i] - state.q_old[i]
    _take_forces(system, state, 0.5)
    if system.damped[0] == 1:
        _add_damping(system, state, h)


@compiled
def unknown_work(state):
    """Work of the step that was added, times zero: no number where a function of users has a fault.

    Nothing else tells of one that acts on what is fixed or moved alone. Added member by member.
    """
    nothing = 0.0
    for k in range(state.works.size):
        nothing += 0.0 * state.works[k]
    return nothing


@compiled
def take_back_work(state):
    """Take back the work of a step that is rejected after all."""
    if state.works.size > 0:
        copy(state.works_old, state.works)
        copy(state.acting_old, state.acting)


@compiled
def set_acting(system, state):
    """Set the forces of the power ports in the current state: of elements, then of motions."""
    if state.works.size > 0:
        _take_forces(system, state, 0.0)


@compiled
def _take_forces(system, state, factor):
    """Evaluate the forces of the ports; add a factor times their work, with those before.

    One pass: in a plane a step takes half a microsecond, as much as three passes of this.
    """
    power, elements = system.first_power[0], forces_of_elements(system, state)
    if elements > 0:
        run_kernels(ENERGY, power, system.address.size, system, state)
    forces, unknowns = pointer_to(state.g), pointer_to(system.g_unknown)
    acting, old = pointer_to(state.acting), pointer_to(state.acting_old)
    dq, is_multiplier = pointer_to(state.dq), pointer_to(system.is_multiplier)
    first = system.at_g[power]
    for b in range(power, system.address.size):
        row = at(pointer_to(system.index), system.at_index[b] + AT_PORT)
        for element in range(system.count[b]):
            product = 0.0
            for k in range(first, first + system.width[b]):
                i, n = unknowns[k], k - system.at_g[power]
                product += (acting[n] + forces[k]) * dq[i] * (1.0 - is_multiplier[i])
                old[n], acting[n] = acting[n], forces[k]
            state.works[row[element * system.stride[b]]] -= factor * product
            first += system.width[b]
    if system.prescribed.shape[0] > 0:
        _take_reactions(system, state, elements, factor)
    if system.gravity_ports.size > 0:
        _take_weights(system, state, elements + system.prescribed.shape[0], factor)


@compiled
def forces_of_elements(system, state):
    """The number of forces of the ports that are of elements."""
    return state.acting.size - system.prescribed.shape[0] - system.gravity_ports.size


@compiled
def _take_reactions(system, state, first, factor):
    """The same for prescribed motions: the forces on their coordinates."""
    run_kernels(RESIDUAL, 0, system.address.size, system, state)
    sum_forces(system, state, state.residual)
    for k in range(system.prescribed.shape[0]):
        port, n = system.prescribed[k, 1], first + k
        force = -system.prescribed_factor[k] * state.residual[system.prescribed[k, 0]]
        state.works[port] -= factor * (state.acting[n] + force) * (state.loads[3 * port]
                                                                  - state.loads_old[3 * port])
        state.acting_old[n], state.acting[n] = state.acting[n], force


@compiled
def _take_weights(system, state, first, factor):
    """The same for gravity that changes with time: potentials of unit amplitude."""
    for k in range(system.gravity_ports.size):
        port, n = 3 * system.gravity_ports[k], first + k
        force = -unit_potential(system, state, k)
        state.works[system.gravity_ports[k]] -= factor * (state.acting[n] + force) * (
            state.loads[port] - state.loads_old[port])
        state.acting_old[n], state.acting[n] = state.acting[n], force


@compiled
def unit_potential(system, state, k):
    """Potential of gravity with the amplitude 1 of one port, and 0 of the others."""
    for i in range(system.dimension[0]):
        state.coefficients[FIELD + i] = system.gravity_fields[k, i]
    kept = state.energy[POTENTIAL]
    state.energy[POTENTIAL] = 0.0 * kept
    run_batches(ENERGY, 0, system.first_power[0], system, state)
    potential = state.energy[POTENTIAL]
    state.energy[POTENTIAL] = kept
    return potential


@compiled
def jump_gravity(system, state):
    """Add the work of a jump of gravity, before which loads were the old ones."""
    first = state.acting.size - system.gravity_ports.size
    for k in range(system.gravity_ports.size):
        port = system.gravity_ports[k]
        state.works[port] -= state.acting[first + k] * (
            state.loads[3 * port] - state.loads_old[3 * port])


@compiled
def _add_damping(system, state, h):
    """Add the work of the bodies' damping over a step."""
    copy(state.now, state.kept)
    for i in range(state.q.size):
        increment = state.q[i] - state.q_old[i]
        state.q[i], state.v[i] = state.q_old[i] + 0.5 * increment, increment / h
    q, dq = pointer_to(state.q), pointer_to(state.dq)
    for r in range(system.rotation_at.size):
        first = system.rotation_at[r]
        for i in range(first, first + 3):
            q[i], state.v[i] = 0.5 * dq[i], dq[i] / h
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
    for k in range(state.works.size):
        state.powers[k] = (state.works[k] - state.works_old[k]) / h
    for b in range(system.first_power[0], system.address.size):
        for element in range(system.count[b]):
            state.powers[_port(system, b, element)] = 0.0
    for k in range(system.prescribed.shape[0]):
        state.powers[system.prescribed[k, 1]] = 0.0
    for port in system.gravity_ports:
        if system.functions[port, 0] == 0:      # of functions the rate is not known
            state.powers[port] = 0.0
    copy(state.powers, state.powers_old)
    _subtract_powers(system, state.acting_old, state.v_old, state.loads_old, state.powers_old)
    _subtract_powers(system, state.acting, state.v, state.loads, state.powers)


@compiled
def _subtract_powers(system, acting, v, loads, powers):
    """Subtract products of forces, residuals, and velocities."""
    first = system.at_g[system.first_power[0]]
    for b in range(system.first_power[0], system.address.size):
        for element in range(system.count[b]):
            place = system.at_g[b] + element * system.width[b]
            for k in range(place, place + system.width[b]):
                i = system.g_unknown[k]
                powers[_port(system, b, element)] -= acting[k - first] * v[i]
    behind = system.prescribed.shape[0] + system.gravity_ports.size
    elements = acting.size - behind
    for k in range(behind):
        port = (system.prescribed[k, 1] if k < system.prescribed.shape[0] else
                system.gravity_ports[k - system.prescribed.shape[0]])
        powers[port] -= acting[elements + k] * loads[3 * port + 1]


@compiled
def _port(system, b, element):
    """Number of the power port of an element."""
    return system.index[system.at_index[b] + element * system.stride[b] + AT_PORT]
