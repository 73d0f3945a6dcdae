"""Multipliers of least norm in a state: what redundant constraints leave open.

Multipliers that exert no force, ``G^T l = 0`` with the constraint Jacobian G, change as the
constraints turn. The time loop takes them out when it evaluates new matrices; between two of these
they drift. Here they are taken out of any one state, by factors of

    [ D   G^T          ]
    [ G   -REGULARIZATION W ]

with the squared norms W of the multipliers. The diagonal D of the coordinates only makes all
constraints about equally strong. See `sebody.engine.regularization`.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    C_CONSTRAINT,
    C_DAMPING,
    C_GEO,
    C_MASS,
    C_STIFFNESS,
    RECORD_T,
    TANGENT,
)
from sebody.engine import elimination
from sebody.engine.evaluate import run_kernels, set_loads, set_tangent_operators
from sebody.engine.inverse import invert
from sebody.engine.matrix import clear_matrix, element_matrix, sum_element
from sebody.engine.regularization import REGULARIZATION, spread
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to

PASSES = 2          # the first leaves rounding over REGULARIZATION, the second its square


@compiled
def take_least_norm(system, state, rows, norms, dense):
    """Put multipliers of least norm in recorded states; returns the status of the kernels.

    Overwrites the state, scratch memory and matrix included.

    Parameters
    ----------
    rows : (n, numbers of `layout.RECORD`)
        Changed in place.
    norms : (unknowns,)
        W and D.
    """
    c = state.coefficients
    c[C_MASS] = c[C_DAMPING] = c[C_STIFFNESS] = c[C_GEO] = 0.0
    c[C_CONSTRAINT] = 1.0
    for i in range(state.dq.size):
        state.dq[i] = 0.0
    set_tangent_operators(system, state)
    for k in range(len(rows)):
        copy(rows[k], state.now)
        set_loads(system, state.frames, state.loads, state.now[RECORD_T])
        status = run_kernels(TANGENT, system.first_joint[0], system.address.size, system, state)
        if status != 0:
            return status
        _factorize(system, state, norms, dense)
        for _ in range(PASSES):
            spread(system, state, state.inverse, dense)
        copy(state.now, rows[k])
    return 0


@compiled
def _factorize(system, state, norms, dense):
    """Factors of constraints, W and D; scaled by W and D, small ones as an inverse."""
    n = system.diagonal.size
    clear_matrix(system, state)
    for k in range(system.summands.shape[0]):
        if system.summands[k, 0] >= system.at_J[system.first_joint[0]]:     # no body
            sum_element(system, state, k, element_matrix(system, state, k),
                        pointer_to(state.rotated_matrix))
    for i in range(n):
        state.scale[i] = 1.0 / np.sqrt(norms[i])
        state.regularization[i] = -REGULARIZATION * norms[i] * system.is_multiplier[i]
        state.matrix[system.diagonal[i]] += (state.regularization[i]
                                             if system.is_multiplier[i] > 0.0
                                             else norms[i])
    if not dense:
        elimination.eliminate_columns(0, system.block_diagonal.size, system, state, False,
                                      pointer_to(state.column))
        return
    scaled = np.empty((n, n))
    for j in range(n):
        for i in range(n):
            scaled[j, i] = state.scale[i] * state.matrix[j * n + i] * state.scale[j]
    invert(scaled)
    for j in range(n):
        for i in range(n):
            state.inverse[j, i] = scaled[j, i]
