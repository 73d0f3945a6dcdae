"""Second residuals of events in index 2, see `stabilized`, evaluated in states that are held."""

from sebody.compiler.decorators import compiled
from sebody.contract.layout import ACCELERATION, C_DAMPING, OK, RESIDUAL
from sebody.engine.evaluate import assemble, take_rates
from sebody.engine.links import place_dependent
from sebody.engine.restart import move_ahead
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to
from sebody.kernels.rotations import rotate


@compiled
def of_step(system, state, shift, cd, cm, found):
    """Both residuals of a step, (2 n,): that of forces is in `State.residual`; a status.

    Constraints are those of rates, over cd, in the first, and of positions in the second.
    """
    n = shift.size
    state.coefficients[C_DAMPING] = cd
    status = take_rates(system, state)
    if status != OK:
        return status
    for i in range(n):
        found[i] = state.residual[i]
        found[n + i] = system.is_multiplier[i] * (state.constraint_residuals[i]
                                                  + state.residual[i])
    _move(system, state, shift, cd, cm)
    status = assemble(RESIDUAL, RESIDUAL, system, state, state.residual)
    for i in range(n):
        if system.is_multiplier[i] == 0.0:
            found[n + i] = state.residual[i] - found[i]
    return status


@compiled
def _move(system, state, shift, cd, cm):
    """Add a shift to the increments of a step."""
    for i in range(shift.size):
        state.v[i] += cd * shift[i]
        state.a[i] += cm * shift[i]
    for r in range(system.rotation_at.size):
        i = system.rotation_at[r]
        if i < shift.size:
            x, y, z = state.q[i], state.q[i + 1], state.q[i + 2]
            _turn(state, r, -x, -y, -z)
            _turn(state, r, x + shift[i], y + shift[i + 1], z + shift[i + 2])
    for i in range(shift.size):
        state.q[i] += shift[i]
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)


@compiled
def _turn(state, r, x, y, z):
    """Turn rotation r on."""
    for k in range(9 * r, 9 * r + 9):
        state.R_old[k] = state.R[k]
    rotate(pointer_to(state.R_old), 9 * r, x, y, z, pointer_to(state.R), 9 * r)


@compiled
def of_restart(system, state, correction, dt, end, beside, load, found):
    """Left less right side of (29), in the state at hand, which is as before; a status.

    `load` is a power port, or -1, and what its value is changed by, now and in the look ahead.
    """
    port, _, change = load
    n, is_multiplier = correction.size, system.is_multiplier
    for sign in (1.0, -1.0):
        for i in range(n):
            if is_multiplier[i] > 0.0:
                state.q[i] += sign * correction[i]
            else:
                state.a[i] += sign * correction[i]
        place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
        if sign < 0.0:
            break
        status = assemble(RESIDUAL, ACCELERATION, system, state, state.residual)
        if status != OK:
            return status
        for i in range(n):
            found[i] = state.residual[i]
    move_ahead(system, state, dt, end, beside)
    if port >= 0:
        state.loads[3 * port] += change
    status = assemble(RESIDUAL, ACCELERATION, system, state, state.residual)
    for i in range(n):
        found[i] -= state.residual[i]
    copy(state.kept, state.now)
    copy(state.loads_old, state.loads)
    return status
