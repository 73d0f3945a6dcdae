"""Forces and matrices of one state, outside the loop, and the reasons for which there are none."""

import numpy as np
from scipy.sparse import csc_matrix

from sebody.engine.evaluate import assemble
from sebody.engine.matrix import sum_matrices
from sebody.engine.state import HALF_TURN, INACCURATE, NO_FRAME, NOT_FINITE, RENEWED, SLOW, State
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.kernels.layout import COEFFICIENTS, FIELD

REASONS = {
    HALF_TURN: "a node is turned by nearly half a turn against its body's frame",
    NO_FRAME: "the search for a body's frame did not end",
    NOT_FINITE: "the iteration matrix is singular or the iterate is not finite",
    SLOW: "Newton's iteration did not converge",
    INACCURATE: "the error of a step is above the tolerance",
}


def evaluate(system: System, state: State, level: int, what: str) -> None:
    """Assemble what a level of `assemble` asks for; forces go to `state.residual`.

    Raises
    ------
    InputError
        The state cannot be evaluated; `what` names it in the message.
    """
    status = assemble(level, system, state, state.residual)
    if status:
        raise InputError(f"{what} cannot be evaluated: {REASONS[status]}")


def matrix(system: System, state: State, what: str, *, mass: float, rate: float, place: float,
           constraint: float) -> csc_matrix:
    """Weighted sum of the exact derivatives of the forces, in body axes.

    Parameters
    ----------
    what : str
        Name of the state in the message of an error.
    mass, rate, place, constraint : float
        Weights of the derivatives by accelerations, velocities, positions and rotations, and of
        constraints and multipliers.

    Raises
    ------
    InputError
        The state cannot be evaluated.
    """
    state.coefficients[:] = COEFFICIENTS.pack({}, {
        "c_mass": mass, "c_rate": rate, "c_place": place, "c_geo": 1.0, "c_constraint": constraint,
        "field": state.coefficients[FIELD:]})
    evaluate(system, state, RENEWED, what)
    sum_matrices(system, state, state.residual)
    return assembled(system, state)


def assembled(system: System, state: State) -> csc_matrix:
    """The assembled matrix, without padding."""
    n, entries = system.diagonal.size, state.matrix[:-1]
    kept = np.flatnonzero((entries != 0.0) & (system.rows < n))
    return csc_matrix((entries[kept], (system.rows[kept], system.columns[kept])), shape=(n, n))
