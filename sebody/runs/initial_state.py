"""A consistent start: positions and velocities that fit the joints."""

from collections.abc import Callable
from copy import copy
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from sebody.assembly.evaluation import evaluate, matrix
from sebody.basics.errors import InputError
from sebody.contract.layout import ACCELERATION, RESIDUAL, VELOCITY
from sebody.engine.evaluate import move_prescribed, set_loads, to_body_axes
from sebody.engine.links import place_dependent
from sebody.engine.state import ASKED, State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates
from sebody.results.recording import Start
from sebody.runs.redundancy import Solver, least, part_sizes, parties_of
from sebody.runs.rigid_start import follow_drives
from sebody.runs.slips import begin_slips
from sebody.runs.tuning import LoadedBristles, tune
from sebody.runs.user_faults import fault

WHAT = "the initial state"
SMALL = 1e-8            # largest residual of constraints, relative to positions or velocities
ROUNDED = 1e-12         # of positions or a radian in a step, that is rounding: nothing moves
HEAVY = 1e10            # added mass, relative, that keeps velocities the user gave


def begin(model: Mechanism, system: System, numbering: Numbering, state: State,
          goes_on: bool = False) -> Start:
    """Fit the velocities to the constraints, and ask for accelerations and multipliers.

    The time loop solves for these before its first step, see `sebody.engine.restart`.

    Parameters
    ----------
    goes_on : bool
        Whether a run goes on, of which initial velocities and speeds of drives are past.

    Raises
    ------
    InputError
        Initial positions violate a joint, given velocities do not fit, constraints contradict
        each other, or an unknown has no mass.
    """
    time = float(state.clock.time)
    set_loads(system, state.frames, state.loads, time)
    state.loads_old[:] = state.loads
    move_prescribed(system, state)
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    multipliers = np.flatnonzero(system.is_multiplier)
    masses = _masses(system, state)
    if did := fault(model, time):
        raise InputError(f"{WHAT} cannot be evaluated: {did}")
    _refuse_overflow(state.residual, masses, numbering)
    residuals = state.residual[multipliers]
    _check(residuals, _lengths(model, system, numbering, state)[multipliers], "position",
           multipliers, numbering, "start from a state the joints allow")
    system.inertias[:numbering.free] = part_sizes(masses, system)
    solver = Solver(masses, system, numbering, partial(_resisting, system, state))
    system.regularized[0], system.massless[0] = int(bool(solver.redundant)), int(solver.massless)
    tune(model, system, numbering, state,
         _resisting(system, state) if solver.massless else masses)
    changed = {} if goes_on else follow_drives(model, system, numbering, state, masses,
                                               _rates(system, state, multipliers))
    changed |= _fit_velocities(model, system, numbering, state, masses, solver, multipliers,
                               not goes_on)
    if not goes_on:
        begin_slips(model, numbering, state)
    if solver.redundant:
        _check_accelerations(system, numbering, state, solver)
    state.frames_old[:] = state.frames
    state.control.restart = ASKED
    return Start(changed, solver.redundant, solver.shared)


def hold(model: Mechanism, system: System, numbering: Numbering, state: State,
         solve_again: Callable[[], None]) -> bool:
    """Bend the bristles of joints at rest as far as what they hold needs.

    Where motions have no mass no acceleration says what they need: bristles begin straight.

    Parameters
    ----------
    solve_again : callable
        Solves for accelerations and multipliers, as `begin` asks for.

    Returns
    -------
    bool
        Whether there are such joints.
    """
    if system.massless[0]:
        return False
    bristles = LoadedBristles(model, system, numbering, state)
    if bristles.held:
        loaded, now = state.coefficients.copy(), state.now.copy()
        masses = _masses(system, state)
        state.coefficients[:], state.now[:] = loaded, now
        bristles.load(masses, solve_again)
    return bool(bristles.held)


def _check_accelerations(system: System, numbering: Numbering, state: State,
                         solver: Solver) -> None:
    """Refuse redundant constraints that demand different accelerations of the same thing."""
    moving = system.is_multiplier[:numbering.total] == 0
    solved = np.arange(numbering.total) < numbering.free
    state.a[solved & moving], state.q[~moving] = 0.0, 0.0
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    evaluate(system, state, RESIDUAL, ACCELERATION, WHAT)
    to_body_axes(system, state.frames, state.residual, False)
    solver.check(state.residual[:numbering.free].copy(), float(np.abs(state.v).max()))


def _masses(system: System, state: State) -> csc_matrix:
    """Matrix of masses and constraints; the forces are left in `state.residual`."""
    return matrix(system, state, WHAT, mass=1.0, damping=0.0, stiffness=0.0, constraint=1.0)


def _resisting(system: System, state: State) -> csc_matrix:
    """Masses with what stiffness adds to them in a step: it resists where mass is missing."""
    return matrix(system, state, WHAT, mass=1.0, damping=0.0, stiffness=state.clock.step**2,
                  constraint=1.0)


def _refuse_overflow(residual: NDArray, masses: csc_matrix, numbering: Numbering) -> None:
    """Refuse forces or masses that are too large for a number; eigenvalues would not converge."""
    finite = np.isfinite(residual[:numbering.free])
    finite[masses.indices[~np.isfinite(masses.data)]] = False
    if not finite.all():
        raise InputError(f"the force on {numbering.names[int(np.argmin(finite))]!r} is too large "
                         f"for a number in {WHAT}: check loads, gravity, stiffness, masses and "
                         "their units")


def _lengths(model: Mechanism, system: System, numbering: Numbering, state: State) -> NDArray:
    """Sizes that residuals of constraints are compared with: sizes of positions, or one radian."""
    lengths = np.full(numbering.total, max(np.abs(state.q).max(), system.magnitude.max()))
    for equation in model.constraints:
        if all(dof_block.rotational for dof_block in equation.dof_blocks):
            first = numbering.multipliers[equation]
            lengths[first:first + equation.multipliers] = 1.0
    return lengths


def _check(values: NDArray, size: NDArray | float, what: str, multipliers: NDArray,
           numbering: Numbering, remedy: str) -> None:
    if values.size:
        excess = np.abs(values) / np.maximum(size, 1e-300)
        worst = int(np.argmax(excess))
        if not excess[worst] <= SMALL:
            of = numbering.names[multipliers[worst]].partition(" of ")[2]
            raise InputError(f"the initial {what} violates {of!r} by {abs(values[worst]):.3g}: "
                             f"{remedy}")


def _check_rates(rates: NDArray, size: NDArray, multipliers: NDArray, model: Mechanism,
                 numbering: Numbering) -> None:
    """Refuse velocities that joints do not allow; drives that differ are named as such."""
    excess = np.zeros(numbering.total)
    excess[multipliers] = np.abs(rates) / size
    if excess.max() > SMALL:
        drives = [joint.name for joint in model.joints if joint.kind == "drive"]
        parties = parties_of(numbering.names, excess).split(", ")
        if len(named := [party for party in parties if party in drives]) > 1:
            raise InputError(f"the drives {', '.join(named)} contradict each other: they begin "
                             "with different speeds of the same motion; remove one, or give them "
                             "the same motion")
    _check(rates, size, "velocity", multipliers, numbering,
           "no velocities satisfy all joints, drives and initial velocities; change one of them")


def _fit_velocities(model: Mechanism, system: System, numbering: Numbering, state: State,
                    masses: csc_matrix, solver: Solver,
                    multipliers: NDArray, keeps_given: bool) -> dict[str, float]:
    """Fit velocities by the smallest change in the norm of kinetic energy; given ones are kept.

    Returns the DOF blocks whose velocity changed, and by how much.
    """
    if not multipliers.size:
        return {}
    size = max(np.abs(state.v).max(), 1e-300)
    rates = _rates(system, state, multipliers)
    if np.abs(rates).max() <= SMALL * size:
        return {}
    dof_blocks = [t for t in model.dof_blocks() if t.solved and t in numbering.dof_blocks]
    given = [t for t in dof_blocks if t.given and keeps_given]
    held = np.array([i for dof_block in given for i in coordinates(numbering, dof_block)],
                    dtype=int)
    demand = np.zeros(numbering.free)
    demand[multipliers] = -rates
    to_body_axes(system, state.frames, demand, False)
    answer = np.zeros(numbering.total)
    solve = (least(_with_mass(masses, held), system) if held.size else
             least(masses, system, solver.system))
    answer[:numbering.free] = solve(demand)
    answer[multipliers] = 0.0
    to_body_axes(system, state.frames, answer, True)
    state.v[:] += answer
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    size = max(size, np.abs(state.v).max())     # everything may have been at rest before
    for dof_block in given:
        change = np.abs(answer[coordinates(numbering, dof_block)]).max()
        if change > 1e-6 * size:
            demanded = _shown(state.v[coordinates(numbering, dof_block)])
            raise InputError(f"the given initial velocity of {dof_block.name}, "
                             f"{_shown(dof_block.rate)}, contradicts joints, drives or other "
                             f"initial velocities, which demand {demanded}: leave some of them "
                             "out, they are solved for")
    lengths = _lengths(model, system, numbering, state)[multipliers]
    _check_rates(_rates(system, state, multipliers),
                 np.maximum(size, ROUNDED / SMALL / state.clock.step * lengths), multipliers,
                 model, numbering)
    changes = {t.name: float(np.abs(answer[coordinates(numbering, t)]).max()) for t in dof_blocks}
    return {name: change for name, change in changes.items() if change > SMALL * size}


def _shown(value: NDArray) -> str:
    return "(" + ", ".join(f"{number:.6g}" for number in value) + ")"


def _with_mass(masses: csc_matrix, held: NDArray) -> csc_matrix:
    """Masses with so much more at some coordinates that these keep their velocities."""
    across = masses.shape[0]
    diagonal = np.flatnonzero(       # all of it is stored, see `assembled`
        masses.indices == np.repeat(np.arange(across), np.diff(masses.indptr)))
    matrix = copy(masses)        # shares the pattern: SciPy's own copy verifies it once more
    matrix.data = masses.data.copy()
    matrix.data[diagonal[held]] += HEAVY * np.abs(masses.data[diagonal]).max()
    return matrix


def _rates(system: System, state: State, multipliers: NDArray) -> NDArray:
    evaluate(system, state, RESIDUAL, VELOCITY, WHAT)
    return state.residual[multipliers]
