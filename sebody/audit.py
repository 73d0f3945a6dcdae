"""What a run is judged by: reactions, forces on boundary nodes, residuals of the constraints.

All of it is evaluated for the recorded states, after the loop.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from . import loop
from .errors import InputError

if TYPE_CHECKING:
    from .results import Result


class Forces(NamedTuple):
    """Forces in every recorded state."""

    elements: NDArray       # (n, forces of all elements), see Numbering.forces_at
    sums: NDArray           # (n, coordinates): zero where free, the support's where not
    rates: NDArray          # (n, coordinates): constraints differentiated in time at multipliers


def forces(result: "Result") -> Forces:
    """Evaluate the forces of all elements in every recorded state.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    system, state, count = result.system, result.state, len(result.t)
    found = Forces(np.zeros((count, state.g.size)), np.zeros((count, state.residual.size)),
                   np.zeros((count, state.residual.size)))
    now, loads = state.now.copy(), state.loads.copy()
    status = _evaluate(system, state, result.rows, found.elements, found.sums, found.rates)
    state.now[:], state.loads[:] = now, loads
    if status:
        raise InputError("the forces of a recorded state cannot be evaluated")
    return found


def constraint_residuals(result: "Result", found: Forces) -> tuple[NDArray, NDArray]:
    """Largest residual of the constraints and of their rates in every recorded state, (n,)."""
    rows = np.flatnonzero(result.system.is_multiplier)
    if not rows.size:
        return (np.zeros(len(result.t)),) * 2
    return np.abs(found.sums[:, rows]).max(axis=1), np.abs(found.rates[:, rows]).max(axis=1)


@njit(cache=True, error_model="numpy")
def _evaluate(system, state, rows, elements, sums, rates):
    for k in range(len(rows)):
        state.now[:] = rows[k]
        loop.set_loads(system, state.loads, state.now[0])
        status = loop.assemble(loop.RATES, system, state, state.residual)
        if status != 0:
            return status
        rates[k] = state.residual
        status = loop.assemble(loop.FORCES, system, state, state.residual)
        if status != 0:
            return status
        elements[k], sums[k] = state.g, state.residual
    return 0
