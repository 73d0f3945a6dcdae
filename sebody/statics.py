"""Static equilibrium under loads applied in steps, and small vibrations about any state."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space
from scipy.sparse import csc_matrix

from . import loop
from .errors import InputError, SimulationError
from .integrator import Simulation
from .linear import Scaled
from .model import Model
from .results import Result
from .start import REASONS, assembled

ITERATIONS = 25
SMALLEST = 1.0 / 1024       # share of the load, below which its step is not cut


def equilibrium(model: Model, steps: int = 10, t: float = 0.0,
                tolerance: float = 1e-11) -> Result:
    """Equilibrium under gravity and the loads of a time, applied in equal steps.

    Parameters
    ----------
    steps : int
        Load steps; cut where Newton's iteration does not converge.
    t : float
        Time at which the histories of the loads are read [time].
    tolerance : float
        Of the last correction, relative to the extent of the model or in radians.

    Returns
    -------
    Result
        One row a load step; its time is the share of the load, from 0 to 1.

    Raises
    ------
    InputError
        Not a positive number of steps.
    SimulationError
        No equilibrium is found; what was found before is in its `result`.
    """
    if steps != int(steps) or steps < 1:
        raise InputError(f"steps is {steps}: give a whole number >= 1")
    run = Simulation(model, 1.0)
    state, field = run.state, run.state.coefficients[5:].copy()
    state.v[:], state.a[:], state.aux[:] = 0.0, 0.0, 0.0
    state.q[run.system.is_multiplier[:state.q.size] > 0] = 0.0
    loop.set_loads(run.system, state.loads, t)
    loads = state.loads.copy()
    rows, share, step = [state.now.copy()], 0.0, 1.0 / steps
    while share < 1.0 - 1e-12:
        kept = state.now.copy()
        target = min(share + step, 1.0)
        state.loads[:], state.coefficients[5:] = target * loads, target * field
        if _balance(run, tolerance):
            share = target
            state.now[0] = share
            rows.append(state.now.copy())
            continue
        state.now[:] = kept
        step /= 2
        if step < SMALLEST:
            run.records[0] = replace(run.records[0], rows=np.array(rows))
            message = (f"no equilibrium was found above {share:.4g} of the load: the structure may "
                       "buckle there, or a mechanism is free to move; use more steps or supports")
            raise SimulationError(message, run.result())
    run.records[0] = replace(run.records[0], rows=np.array(rows))
    return run.result()


def _balance(run: Simulation, tolerance: float) -> bool:
    """Newton's iteration with the exact tangent; False where it does not converge."""
    system, state, n = run.system, run.state, run.numbering.free
    size = np.maximum(system.magnitude[:n], 1e-300)
    moving = system.is_multiplier[:n] == 0
    state.frames_old[:] = state.frames
    for _ in range(ITERATIONS):
        matrix = Scaled(stiffness(run))
        residual = state.residual.copy()
        loop.to_body_axes(system, state.frames, residual, False)
        correction = np.zeros(run.numbering.total)
        if matrix.factors is None:
            return False
        correction[:n] = matrix.solve(residual[:n])
        loop.to_body_axes(system, state.frames, correction, True)
        change = np.abs(correction[:n][moving] / size[moving]).max()
        if not np.isfinite(change) or change > 1.0:
            return False
        state.R_old[:], state.dq[:] = state.R, -correction
        state.q[:] -= correction
        loop.turn_rotations(system, state)
        if change < tolerance:
            return True
    return False


def _matrix(run: Simulation, mass: float, rate: float, place: float) -> csc_matrix:
    state = run.state
    state.coefficients[:5] = (mass, rate, place, 1.0, 1.0)
    state.T[:] = np.tile(np.eye(3).ravel(), len(state.T) // 9)
    status = loop.assemble(loop.RENEWED, run.system, state, state.residual)
    if status:
        raise InputError(f"the state cannot be evaluated: {REASONS[status]}")
    return assembled(run.system, state)


def stiffness(run: Simulation) -> csc_matrix:
    """Exact tangent stiffness in the state of a simulation, with the rows of the constraints."""
    return _matrix(run, 0.0, 0.0, 1.0)


class Vibrations(NamedTuple):
    """Small undamped vibrations."""

    omega: NDArray      # (m,) angular frequencies, ascending [1/time]
    shapes: NDArray     # (unknowns, m) mass-normalised, in the axes of the unknowns


def vibrations(run: Simulation, count: int | None = None) -> Vibrations:
    """Undamped vibrations about the state of a simulation at rest, constraints included.

    Raises
    ------
    InputError
        The state moves, or is not stable: a square of a frequency is negative.
    """
    if np.abs(run.state.v).max() > 0:
        raise InputError("the state moves: vibrations are about states at rest")
    K, M = stiffness(run).toarray(), _matrix(run, 1.0, 0.0, 0.0).toarray()
    multipliers = np.flatnonzero(run.system.is_multiplier[:len(K)])
    moving = np.setdiff1d(np.arange(len(K)), multipliers)
    free = null_space(K[np.ix_(multipliers, moving)]) if multipliers.size else np.eye(len(moving))
    K, M = (free.T @ A[np.ix_(moving, moving)] @ free for A in (K, M))
    squares, shapes = eigh((K + K.T) / 2, (M + M.T) / 2)
    if squares[0] < -100 * np.finfo(float).eps * squares[-1]:
        raise InputError(f"the state is not stable: the lowest square of a frequency is "
                         f"{squares[0]:.4g}")
    whole = np.zeros((run.numbering.free, len(squares)))
    whole[moving] = free @ shapes
    return Vibrations(np.sqrt(np.maximum(squares, 0.0))[:count], whole[:, :count])
