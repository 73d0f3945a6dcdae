"""What a run is judged by: energies, reactions, boundary forces, residuals of the constraints.

All of it is evaluated for the recorded states, after the loop.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.engine.evaluate import assemble, run_kernels, set_loads
from sebody.errors import InputError
from sebody.kernels.layout import ENERGY, RECORD_T, RESIDUAL, VELOCITY
from sebody.kernels.pipeline import compiled

if TYPE_CHECKING:
    from sebody.results.result import Result


class Forces(NamedTuple):
    """Forces in every recorded state."""

    elements: NDArray       # (n, forces of all elements), see Numbering.forces_at
    sums: NDArray           # (n, coordinates): zero where free, the support's where not


def energies(result: "Result") -> NDArray:
    """Energies and momenta of every recorded state, by the table ENERGIES.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    found = np.zeros((len(result.t), result.state.energy.size))
    _over_records(result, "energies", _evaluate_energies, found)
    return found


def forces(result: "Result") -> Forces:
    """Forces of all elements in every recorded state.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    count, state = len(result.t), result.state
    found = Forces(np.zeros((count, state.g.size)), np.zeros((count, state.residual.size)))
    _over_records(result, "forces", _evaluate_forces, *found)
    return found


def constraint_residuals(result: "Result") -> NDArray:
    """Largest residual of the constraints and of their rates in every recorded state, (n, 2).

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    found = np.zeros((len(result.t), 2))
    if result.numbering.multipliers:
        _over_records(result, "constraints", _evaluate_constraints, found)
    return found


def _over_records(result: "Result", what: str, evaluate, *out: NDArray) -> None:
    """Evaluate the recorded states; the state the run has reached stays."""
    now, loads = result.state.now.copy(), result.state.loads.copy()
    status = evaluate(result.system, result.state, result.rows, *out)
    result.state.now[:], result.state.loads[:] = now, loads
    if status:
        raise InputError(f"the {what} of a recorded state cannot be evaluated")


@compiled
def _evaluate_energies(system, state, rows, out):
    for k in range(len(rows)):
        state.now[:] = rows[k]
        state.energy[:] = 0.0
        status = run_kernels(ENERGY, 0, system.address.size, system, state)
        if status != 0:
            return status
        out[k] = state.energy
    return 0


@compiled
def _evaluate_forces(system, state, rows, elements, sums):
    for k in range(len(rows)):
        state.now[:] = rows[k]
        set_loads(system, state.loads, state.now[RECORD_T])
        status = assemble(RESIDUAL, RESIDUAL, system, state, state.residual)
        if status != 0:
            return status
        elements[k], sums[k] = state.g, state.residual
    return 0


@compiled
def _evaluate_constraints(system, state, rows, out):
    for k in range(len(rows)):
        state.now[:] = rows[k]
        set_loads(system, state.loads, state.now[RECORD_T])
        for j, task in enumerate((RESIDUAL, VELOCITY)):
            status = assemble(RESIDUAL, task, system, state, state.residual)
            if status != 0:
                return status
            for i in range(system.diagonal.size):
                if system.is_multiplier[i] > 0.0:
                    out[k, j] = max(out[k, j], abs(state.residual[i]))
    return 0
