"""Static equilibrium under loads applied in steps, also in a steadily rotating frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import inputs, memory
from sebody.analysis import user_faults
from sebody.analysis.linearization import rotating
from sebody.analysis.simulation import Simulation
from sebody.analysis.sparse import Scaled
from sebody.analysis.turning import Spin
from sebody.engine.evaluate import set_loads, to_body_axes, update_rotations
from sebody.errors import SimulationError
from sebody.kernels.layout import FIELD, RECORD_T
from sebody.model.model import Model
from sebody.results.result import Result

ITERATIONS = 25
RESISTED = 100              # where motions are resisted
LARGEST = 0.5               # correction then, as a share of the extent or in radians
FAINTEST = 1e-4             # resistance that is left to motions without any stiffness
SMALLEST = 1.0 / 1024       # smallest load step, as a share of the load
PUSH = 1e-6                 # share of the forces that may act on a motion without stiffness


def equilibrium(model: Model, steps: int = 10, t: float = 0.0, tolerance: float = 1e-11,
                spin: ArrayLike | None = None) -> Result:
    """Equilibrium under gravity and the loads of a time, applied in equal steps.

    Parameters
    ----------
    steps : int
        Load steps; divided where Newton's iteration does not converge.
    t : float
        Time at which the time functions of the loads are evaluated [time].
    tolerance : float
        Of the last correction, relative to the model's characteristic length or in radians.
    spin : (3,) array_like or float, optional
        Angular velocity of a frame about the origin in which everything rests, fixed nodes,
        supports and loads included [1/time]; a number in a plane.

    Returns
    -------
    Result
        One row a load step; its time is the share of the load, from 0 to 1. Velocities and
        accelerations are those of the rotation.

    Raises
    ------
    InputError
        Not a positive number of steps, a spin of the wrong shape.
    SimulationError
        No equilibrium is found; what was found before is in its `result`.
    """
    steps = inputs.integer(steps, "steps", least=1)
    t = inputs.number(t, "t")
    tolerance = inputs.number(tolerance, "tolerance", above=0, below=1)
    run = Simulation(model, 1.0)
    memory.check(8.0 * steps * run.state.now.size, f"steps is {steps}: the record of all",
                 "give fewer")
    state, field = run.state, run.state.coefficients[FIELD:].copy()
    steady = Spin.of(run, spin)
    state.v[:], state.a[:], state.aux[:] = 0.0, 0.0, 0.0
    state.q[run.system.is_multiplier[:state.q.size] > 0] = 0.0
    set_loads(run.system, state.loads, t)
    loads = state.loads.copy()
    run.rows = [state.now[None].copy()]
    share, step = 0.0, 1.0 / steps
    while share < 1.0 - 1e-12:
        kept = state.now.copy()
        target = min(share + step, 1.0)
        state.loads[:], state.coefficients[FIELD:] = target * loads, target * field
        spinning = steady.times(np.sqrt(target))
        if _balance(run, tolerance, spinning) or _settle(run, tolerance, spinning, kept):
            share = target
            state.now[RECORD_T] = share
            run.rows.append(state.now[None].copy())
            continue
        state.now[:] = kept
        step /= 2
        if step < SMALLEST:
            message = (f"no equilibrium was found above {share:.4g} of the load: the structure may "
                       "buckle, or a mechanism may be free to move; use more steps or supports")
            if did := user_faults.fault(model, -np.inf):
                message = f"no equilibrium was found above {share:.4g} of the load: {did}"
            raise SimulationError(message, _result(run))
    return _result(run)


def _result(run: Simulation) -> Result:
    run.watch.look(run.model, run.numbering, np.concatenate(run.rows))
    return run.result()


def _settle(run: Simulation, tolerance: float, spin: Spin, start: NDArray) -> bool:
    """Again from the start of the load step, towards the least effective potential.

    Motions of a mechanism have no stiffness but that of the spin, which changes as they turn: at 45
    degrees to the spin an arm has none.
    """
    if not spin.rotates:
        return False
    run.state.now[:] = start
    return _balance(run, tolerance, spin, True)


def _balance(run: Simulation, tolerance: float, spin: Spin, resisted: bool = False) -> bool:
    """Newton's iteration with the exact tangent; False where it does not converge.

    Where it is `resisted`, the mass times the squared spin is added to the tangent, less of it the
    smaller the corrections get.
    """
    system, state, n = run.system, run.state, run.numbering.free
    state.frames_old[:] = state.frames
    resistance = float(resisted)
    for _ in range(RESISTED if resisted else ITERATIONS):
        spin.move(run)
        tangent, residual = rotating(run, spin, resistance)
        solver = Scaled(tangent)
        correction = np.zeros(run.numbering.total)
        correction[:n] = _solution(solver, residual)
        to_body_axes(system, state.frames, correction, True)
        change = _size(run, correction)
        if not np.isfinite(change) or change > 1.0 and not resisted:
            return False
        if resisted:
            resistance = max(min(change, 1.0), FAINTEST)
            correction *= min(1.0, LARGEST / max(change, tolerance))
        state.R_old[:], state.dq[:] = state.R, -correction
        state.q[:] -= correction
        update_rotations(system, state)
        if change < tolerance:
            spin.move(run)
            return True
    return False


def _size(run: Simulation, correction: NDArray) -> float:
    """Size of a correction, relative to magnitudes of positions and rotations.

    Modes and multipliers have no magnitude. Where nothing has one, as in a body that is held at all
    its nodes, the correction is compared with what it leads to.
    """
    n = run.numbering.free
    size, correction = run.system.magnitude[:n], correction[:n]
    if np.any(size > 0.0):
        return float(np.abs(correction[size > 0.0] / size[size > 0.0]).max())
    largest = np.abs(run.state.q[:n] - correction).max()
    return 0.0 if largest == 0.0 else float(np.abs(correction).max() / largest)


def _solution(solver: Scaled, residual: NDArray) -> NDArray:
    """Correction; motions without stiffness and load, such as the angle of a spin, are kept."""
    if solver.regular:
        return solver.solve(residual)
    answer, left = solver.least(residual)
    pushed = left.max() > PUSH * np.abs(solver.scale * residual).max() > 0.0
    return np.full(len(residual), np.nan) if pushed else answer
