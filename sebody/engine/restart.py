"""Restart: accelerations and multipliers solved anew, at the start and where loads jump.

Positions and velocities stay. Newton's iteration solves the equations of motion together with the
constraints, differentiated twice in time, for accelerations a and multipliers; forces may depend on
multipliers. The step that ended here saw the loads before the jump, the next one begins from what
follows after it: auxiliary accelerations are set from a.

Of constraints that hold for velocities, too (index 2), multipliers are of second order from the
first step on if auxiliary accelerations are those of the later time they belong to. The rates of
the accelerations come from a look ahead: one more correction, in the state a short time later.
"""

import math

from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    ACCELERATION,
    C_CONSTRAINT,
    C_DAMPING,
    C_GEO,
    C_MASS,
    C_STIFFNESS,
    OK,
    RESIDUAL,
    TANGENT,
)
from sebody.engine.aid import aided
from sebody.engine.calls import call_refactorize
from sebody.engine.evaluate import (
    move_prescribed,
    run_kernels,
    set_loads_beside,
    sum_forces,
    to_body_axes,
    update_rotations,
)
from sebody.engine.kept_factors import exchange, give_back, keep_matrices_of_bodies
from sebody.engine.links import place_dependent
from sebody.engine.matrix import solve
from sebody.engine.newton import FASTEST, HUGE, REFACTORIZATION_COST, norm_after
from sebody.engine.selection import any_true, either
from sebody.engine.state import (
    AHEAD,
    ASKED,
    DONE,
    EVALUATED,
    FACTORS,
    FAILED,
    GO_ON,
    KEPT,
    NO_AID,
    NO_START,
    SOLUTION,
)
from sebody.engine.vectors import copy
from sebody.engine.work import jump_gravity, set_acting

MOST_CORRECTIONS = 30   # of a restart
MOST_MATRICES = 6       # likewise
ACCURATE = 1e-10        # correction, relative to accelerations and multipliers, that is none
ROUNDED = 1e-6          # the same that may be left where new matrices do not help
POOR = 0.3              # a contraction rate above this asks for a new matrix
HARDLY = 0.5            # and above this rounding is all that is left, if little is
FASTER = 100.0          # square of a frequency, of the largest stiffness over mass of a coordinate
STIFF = 1e3             # of rounding, the same: stiff bodies at rest have forces of rounding alone
SUMMANDS = 10.0         # roundings in what velocities make of accelerations
CONTRADICTION = 1e-7    # residual, relative to the solution, of constraints that contradict others
SHORT = 1e-3            # of a step: how far to look ahead


@compiled
def restart(system, state, lead, dense):
    """Solve for accelerations and multipliers of the state reached.

    Parameters
    ----------
    lead : float
        By how much auxiliary accelerations are ahead of the state, in steps; with 0 they are the
        accelerations themselves, as the first step takes them for.

    Returns
    -------
    int
        DONE, or FAILED with a reason.
    """
    control = state.control
    _begin(system, state, lead)
    while True:
        wanted = control.wanted
        status = _evaluate(system, state, wanted)
        if status != OK:
            return _fail(system, state, status)
        if wanted != KEPT and not _factorize(system, state, dense):
            return _fail(system, state, NO_AID)
        if control.pivoted == 0:
            solve(system, state, dense)
        elif not aided(system, SOLUTION):
            return _fail(system, state, NO_AID)
        if control.restart == AHEAD:
            _take_rates(system, state, lead)
            return _end(system, state)
        verdict = correct(system, state, True)
        if verdict == FAILED:
            return _fail(system, state, NO_START)
        if verdict == DONE:
            # the first step takes these accelerations for auxiliary ones as they are
            if lead == 0.0:
                copy(state.a, state.aux)
                state.clock.aux_step = state.clock.current_step
                return _end(system, state)
            _look_ahead(system, state)


@compiled
def _factorize(system, state, dense):
    """Factorize masses and constraints; False where there is no aid for row exchanges."""
    control = state.control
    control.wanted = KEPT
    control.fresh += 1
    control.matrices += 1
    done = call_refactorize(system.routines[0], system, state, EVALUATED, dense)
    if not done or system.massless[0] == 1:
        control.pivoted = 1
    return control.pivoted == 0 or aided(system, FACTORS)


@compiled
def _begin(system, state, lead):
    """Set what belongs to accelerations; choose the factors to begin with."""
    control = state.control
    set_masses(system, state)
    exchange(system, state, lead)
    control.restart = ASKED
    control.fresh = control.iteration = 0
    state.clock.last_norm = 0.0


@compiled
def set_masses(system, state):
    """Set the loads after the jump and the coefficients of masses and constraints."""
    clock, c = state.clock, state.coefficients
    copy(state.loads, state.loads_old)
    set_loads_beside(system, state.frames, state.loads, clock.time, -clock.beside)
    jump_gravity(system, state)
    # set to zero first: several motions may add up in one coordinate
    for k in range(system.prescribed.shape[0]):
        state.a[system.prescribed[k, 0]] = 0.0
    for k in range(system.prescribed.shape[0]):
        state.a[system.prescribed[k, 0]] += (system.prescribed_factor[k]
                                             * state.loads[3 * system.prescribed[k, 1] + 2])
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    c[C_MASS], c[C_DAMPING], c[C_STIFFNESS], c[C_GEO], c[C_CONSTRAINT] = 1.0, 0.0, 0.0, 1.0, 1.0
    for i in range(state.T.size):       # the unknowns are accelerations, not increments
        state.T[i] = 1.0 if i % 9 % 4 == 0 else 0.0


@compiled
def _evaluate(system, state, wanted):
    """Evaluate forces and the constraints' second rates; returns the kernels' status."""
    bodies, batches = system.first_joint[0], system.address.size
    # element matrices of the steps stand where those of the restart are made
    if wanted != KEPT:
        keep_matrices_of_bodies(system, state)
    status = run_kernels(RESIDUAL if wanted == KEPT else TANGENT, 0, bodies, system, state)
    if status == OK and wanted != KEPT:
        status = run_kernels(TANGENT, bodies, batches, system, state)
    if status == OK:
        status = run_kernels(ACCELERATION, bodies, batches, system, state)
    sum_forces(system, state, state.residual)
    to_body_axes(system, state.frames, state.residual, False)
    return status


@compiled
def subtract(system, state):
    """Subtract a correction; returns the norms of it, of the solution and of the residual.

    Where a body has no inertia about an axis, its residual is compared with what the regularization
    adds there: beside nothing but a thousandth of that, rounding would count as a contradiction.
    The norm of the residual is of use with regularized matrices alone.
    """
    norm = size = left = 0.0
    for i in range(system.diagonal.size):
        d, r = state.correction[i] * state.weight[i], state.residual[i] * state.scale[i]
        x = (state.q[i] if system.is_multiplier[i] > 0.0 else state.a[i]) * state.weight[i]
        norm += d * d
        size += x * x
        added = max(state.regularization[i], 0.0)       # of multipliers it is negative
        left += r * r / (1.0 + state.scale[i] * state.scale[i] * added)
    norm = math.sqrt(norm)
    to_body_axes(system, state.frames, state.correction, True)
    for i in range(system.diagonal.size):
        if system.is_multiplier[i] > 0.0:
            state.q[i] -= state.correction[i]
        else:
            state.a[i] -= state.correction[i]
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    return norm, max(math.sqrt(size), norm), math.sqrt(left)


@compiled
def correct(system, state, going):
    """Subtract a correction; returns DONE, FAILED or, to go on, GO_ON. In lanes, of some members.
    """
    control, clock, n = state.control, state.clock, system.diagonal.size
    norm, size, left = subtract(system, state)
    rate = either(control.iteration > 0, norm / clock.last_norm, 0.0)
    clock.last_norm = either(going, norm, clock.last_norm)
    control.iteration = either(going, control.iteration + 1, control.iteration)
    # a correction that hardly shrinks is rounding, if it is small; if not, the matrix is wrong
    stays, poor, old = rate > HARDLY, rate > POOR, (control.fresh < 1) & (rate > 0.0)
    none = (either(stays, ROUNDED, ACCURATE) * size
            + either(stays, STIFF, 1.0) * _rounding(system, state))
    settles = (rate <= POOR) & (max(rate, FASTEST) / (1.0 - rate) * norm <= none)
    verdict = either((norm <= none) | (old & settles), DONE, GO_ON)
    many = norm_after(norm, rate, REFACTORIZATION_COST)
    # a new matrix is made where it is cheaper than the corrections that the old one would take
    renew = going & (verdict == GO_ON) & (poor | (old & (many > none)))
    control.wanted = either(renew, EVALUATED, control.wanted)
    ended = (verdict == GO_ON) & ((control.iteration >= MOST_CORRECTIONS) | (
        poor & (control.fresh >= MOST_MATRICES)))
    if control.regularized == 1 and system.massless[0] == 0:
        # what the corrections of a regularized matrix leave is a contradiction, or a force on
        # something without mass
        gap = (verdict == DONE) & (left > n * norm + CONTRADICTION * size)
        verdict = either(gap, FAILED, verdict)
    if any_true(ended):     # frames of bodies are found to rounding, and so are their forces
        exact = norm <= clock.floor * _fastest(system, state)
        verdict = either(ended, either(exact, DONE, FAILED), verdict)
    return either(norm < HUGE, verdict, FAILED)


@compiled
def _fastest(system, state):
    """Bound of the squares of frequencies that bodies hold: `FASTER` than a coordinate alone."""
    largest = 0.0 * state.clock.floor
    for i in range(system.body_mass.size):
        square = system.body_stiffness[i] / system.body_mass[i]
        largest = either(system.body_mass[i] > 0.0, max(largest, square), largest)
    return FASTER * largest


@compiled
def _rounding(system, state):
    """Norm of accelerations that are rounding.

    They move positions by less than their rounding in a step, or are rounding of what the
    velocities make.
    """
    speed, h = 0.0 * state.clock.floor, state.clock.current_step
    for i in range(state.v.size):
        own = max(speed, abs(state.v[i]) / system.magnitude[i])
        speed = either(system.magnitude[i] > 0.0, own, speed)
    return state.clock.floor * (1.0 / (h * h) + SUMMANDS * speed * speed)


@compiled
def _look_ahead(system, state):
    """Move the state by a short time, for one more correction."""
    clock = state.clock
    move_ahead(system, state, SHORT * clock.current_step, clock.time, -clock.beside)
    state.control.restart = AHEAD


@compiled
def move_ahead(system, state, dt, time, beside):
    """Move a state by a short time from a time on; `kept` and `loads_old` are as before."""
    copy(state.now, state.kept)
    copy(state.R, state.R_old)
    copy(state.frames, state.frames_old)
    copy(state.loads, state.loads_old)
    for i in range(state.q.size):
        state.dq[i] = dt * (state.v[i] + 0.5 * dt * state.a[i]) * (1.0 - system.is_multiplier[i])
        state.q[i] += state.dq[i]
        state.v[i] += dt * state.a[i]
    set_loads_beside(system, state.frames, state.loads, time + dt, beside)
    move_prescribed(system, state)
    update_rotations(system, state)


@compiled
def _take_rates(system, state, lead):
    """Return to the state reached; set auxiliary accelerations to those of a later time."""
    h = state.clock.current_step
    to_body_axes(system, state.frames, state.correction, True)
    copy(state.kept, state.now)
    copy(state.loads_old, state.loads)
    copy(state.a, state.aux)
    # the correction is minus the change of accelerations in `SHORT` of a step
    for i in range(system.diagonal.size):
        if system.is_multiplier[i] == 0.0:
            state.aux[i] -= lead / SHORT * state.correction[i]
    state.clock.aux_step = h


@compiled
def _end(system, state):
    """Let the next step begin from here."""
    control = state.control
    set_acting(system, state)
    give_back(system, state)
    control.pivoted, control.fresh = 0, 1       # nothing is predicted, see `step.begin_step`
    control.restart = 0
    return DONE


@compiled
def _fail(system, state, reason):
    """Give up: a later call begins anew."""
    control = state.control
    give_back(system, state)
    control.reason, control.restart = reason, ASKED
    control.wanted = EVALUATED
    return FAILED
