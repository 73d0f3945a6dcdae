"""Forces and matrices of one state, outside the loop."""

import numpy as np
from scipy.sparse import csc_matrix

from sebody.basics.errors import InputError
from sebody.contract.layout import TANGENT
from sebody.engine.evaluate import assemble
from sebody.engine.matrix import sum_matrices
from sebody.engine.state import REASONS, State
from sebody.engine.system import System


def evaluate(system: System, state: State, of_bodies: int, of_others: int, what: str) -> None:
    """Evaluate the elements; their forces go to `state.residual`.

    Kernels of superelements are given one task, all others another one.

    Raises
    ------
    InputError
        The state cannot be evaluated; `what` names it in the message.
    """
    status = assemble(of_bodies, of_others, system, state, state.residual)
    if status:
        raise InputError(f"{what} cannot be evaluated: {REASONS[status]}")


def matrix(system: System, state: State, what: str, *, mass: float, damping: float,
           stiffness: float, constraint: float) -> csc_matrix:
    """Weighted sum of the exact derivatives of the forces, in body axes.

    Parameters
    ----------
    what : str
        Name of the state in the message of an error.
    mass, damping, stiffness, constraint : float
        Weights of the derivatives with respect to accelerations, velocities, positions and
        rotations, and of constraints and multipliers.

    Raises
    ------
    InputError
        The state cannot be evaluated.
    """
    state.set_coefficients(c_mass=mass, c_damping=damping, c_stiffness=stiffness, c_geo=1.0,
                           c_constraint=constraint)
    evaluate(system, state, TANGENT, TANGENT, what)
    sum_matrices(system, state, state.residual, False)
    return assembled(system, state)


def assembled(system: System, state: State) -> csc_matrix:
    """The matrix in `State.matrix` as a sparse one, without padding.

    Zeros are left out except on the diagonal, see `sebody.runs.kkt_solver.factors`.
    """
    n, entries = system.diagonal.size, state.matrix[:-1]
    stored = entries != 0.0
    stored[system.diagonal] = True
    chosen = np.flatnonzero(stored & (system.rows < n))
    chosen = chosen[np.lexsort((system.rows[chosen], system.columns[chosen]))]
    starts = np.searchsorted(system.columns[chosen], np.arange(n + 1)).astype(np.int32)
    # in SciPy's own order: sorting it out takes SciPy three times as long
    return csc_matrix((entries[chosen], system.rows[chosen], starts), shape=(n, n))
