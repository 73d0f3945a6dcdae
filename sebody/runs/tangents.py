"""The weighted sum of the exact derivatives of the forces in a state."""

import numpy as np
from scipy.sparse import csc_matrix

from sebody.assembly.evaluation import matrix
from sebody.engine.state import EVALUATED, State
from sebody.engine.system import System


def tangent(system: System, state: State, mass: float, damping: float, stiffness: float
            ) -> csc_matrix:
    """Sum of the derivatives with respect to accelerations, velocities and places, in body axes.

    Constraints go with the last. A run that goes on needs its own matrix again.
    """
    state.control.wanted = EVALUATED
    state.T[:] = np.tile(np.eye(3).ravel(), len(state.T) // 9)
    return matrix(system, state, "the state", mass=mass, damping=damping,
                  stiffness=stiffness, constraint=stiffness)
