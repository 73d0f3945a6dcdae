"""Accelerations and multipliers solved anew for some of eight members: `sebody.engine.restart`.

The others keep their numbers. Members that would have to ask Python, or find no accelerations, give
up. Both inverses are kept where single runs keep both, see `sebody.engine.kept_factors`.
"""

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import bits_of, some, spread, where
from sebody.contract.layout import ACCELERATION, RESIDUAL
from sebody.contract.member_row import RUNNING
from sebody.engine.evaluate import run_kernels, sum_forces, to_body_axes
from sebody.engine.kept_factors import EXCESS, FEWEST, VALID, swap_factors
from sebody.engine.lanes.apart import GAVE_UP
from sebody.engine.lanes.matrix import factorize_masses
from sebody.engine.matrix import solve
from sebody.engine.newton import REFACTORIZATION_COST, SLOWEST
from sebody.engine.restart import correct, set_masses
from sebody.engine.state import EVALUATED, FAILED, GO_ON, KEPT
from sebody.engine.vectors import copy
from sebody.engine.work import set_acting


@compiled
def restart(system, state, scratch, apart, active, dense):
    """Solve for accelerations and multipliers of the active members, at the time reached."""
    control, clock, spare = state.control, state.clock, state.spare
    keeps = spare.size > 0 and system.regularized[0] == 0
    before, corrections, fresh = control.wanted, control.iteration, control.fresh
    copy(state.now, state.kept)
    copy(state.loads, state.loads_old)
    copy(state.T, scratch.T)
    control.regularized = system.regularized[0]
    set_masses(system, state)
    control.wanted = where(active, spread(float(EVALUATED)), spread(float(KEPT)))
    if keeps:
        swap_factors(system, state)
        control.wanted = where(spare[VALID] == 1.0, spread(float(KEPT)), control.wanted)
    control.fresh = control.iteration = clock.last_norm = spread(0.0)
    going = active
    while some(going):
        evaluated = going & (control.wanted == float(EVALUATED))
        _evaluate(system, state, scratch, going)
        if some(evaluated):
            going = going & ~_factorize(state, apart, scratch.frames, dense, evaluated)
        solve(system, state, dense)
        for i in range(system.diagonal.size):
            state.correction[i] = where(going, state.correction[i], spread(0.0))
        verdict = correct(system, state, going)
        control.reason = where(going & (verdict == FAILED), spread(GAVE_UP), control.reason)
        going = going & (verdict == GO_ON)
    if keeps:
        swap_factors(system, state)
        _count_excess(state, active)
        control.wanted = before
    else:
        control.wanted = where(active, spread(float(EVALUATED)), before)
        clock.contraction = where(active, spread(SLOWEST), clock.contraction)
    control.iteration = where(active, control.iteration, corrections)
    control.fresh = where(active, spread(1.0), fresh)
    _keep_the_others(system, state, scratch, active)


@compiled
def _factorize(state, apart, begun, dense, wanted):
    """Make the matrices of some members; returns those that have none, and give up."""
    control = state.control
    failed = wanted & ~factorize_masses(state, apart, begun, dense, wanted)
    one = where(wanted, spread(1.0), spread(0.0))
    control.wanted = where(wanted, spread(float(KEPT)), control.wanted)
    control.fresh += one
    control.matrices += one
    control.reason = where(failed, spread(GAVE_UP), control.reason)
    return failed


@compiled
def _evaluate(system, state, scratch, going):
    """Evaluate forces and the constraints' second rates."""
    bodies, batches = system.first_joint[0], system.address.size
    frames = state.frames
    copy(frames, scratch.frames)
    scratch.table[RUNNING] = bits_of(going)
    run_kernels(RESIDUAL, 0, bodies, system, state)
    run_kernels(ACCELERATION, bodies, batches, system, state)
    for k in range(frames.size):
        frames[k] = where(going, frames[k], scratch.frames[k])
    sum_forces(system, state, state.residual)
    to_body_axes(system, state.frames, state.residual, False)


@compiled
def _count_excess(state, active):
    """Count corrections beyond those with new factors, see `kept_factors.give_back`."""
    control, spare = state.control, state.spare
    more = spare[EXCESS] + max(control.iteration - float(FEWEST), spread(0.0))
    excess = where(control.fresh > 0.0, spread(0.0), more)
    spare[EXCESS] = where(active, excess, spare[EXCESS])
    spare[VALID] = where(active, where(excess <= REFACTORIZATION_COST, spread(1.0), spread(0.0)),
                         spare[VALID])


@compiled
def _keep_the_others(system, state, scratch, active):
    """Let the next step of the active members begin from here; the others have their state back."""
    for i in range(state.aux.size):
        state.aux[i] = where(active, state.a[i], state.aux[i])
    scratch.table[RUNNING] = bits_of(active)
    set_acting(system, state)
    for k in range(state.acting.size):
        state.acting[k] = where(active, state.acting[k], state.acting_old[k])
    for k in range(state.now.size):
        state.now[k] = where(active, state.now[k], state.kept[k])
    for k in range(state.T.size):
        state.T[k] = where(active, state.T[k], scratch.T[k])
    for k in range(state.loads.size):
        state.loads[k] = where(active, state.loads[k], state.loads_old[k])
