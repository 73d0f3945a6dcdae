"""Energies, reactions, boundary forces and residuals of the constraints of a run.

They are evaluated for the recorded states after the loop; `rows` are rows of `layout.RECORD`.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.layout import ENERGY, RECORD_T, RESIDUAL, VELOCITY
from sebody.engine.evaluate import assemble, run_kernels, set_loads
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.engine.vectors import copy
from sebody.engine.work import unit_potential


class Forces(NamedTuple):
    """Forces in every recorded state."""

    elements: NDArray       # (n, forces of all elements), see Numbering.forces_at
    sums: NDArray           # (n, coordinates) sums: zero at free ones, forces of supports at others


def energies(system: System, state: State, rows: NDArray) -> NDArray:
    """Energies and momenta of every recorded state, rows of `layout.ENERGIES`.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    values = np.zeros((len(rows), state.energy.size))
    _over_records("energies", _evaluate_energies, system, state, rows, values)
    return values


def forces(system: System, state: State, rows: NDArray) -> Forces:
    """Forces of all elements in every recorded state.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    recorded = Forces(np.zeros((len(rows), state.g.size)),
                      np.zeros((len(rows), state.residual.size)))
    _over_records("forces", _evaluate_forces, system, state, rows, *recorded)
    return recorded


def prescribed_powers(system: System, t: NDArray, kept: NDArray, sums: NDArray,
                      powers: NDArray) -> NDArray:
    """Powers of the power ports, (n, ports), with those of prescribed motions filled in.

    A prescribed motion gives the sum of the forces on its coordinates times its rate.

    Parameters
    ----------
    t : (n,)
        Times of the recorded states.
    kept : (n, numbers of `State.frames`)
    sums : (n, coordinates)
        See `Forces`.
    powers : (n, ports)
        Those of elements.
    """
    with_prescribed = powers.copy()
    ports = np.unique(system.prescribed[:, 1])
    with_prescribed[:, ports] = 0.0
    loads = np.zeros((len(t), 3 * powers.shape[1]))
    for k in range(len(t) if ports.size else 0):
        set_loads(system, kept[k], loads[k], t[k])
    for (coordinate, port, _), factor in zip(system.prescribed, system.prescribed_factor,
                                             strict=True):
        with_prescribed[:, port] += sums[:, coordinate] * factor * loads[:, 3 * port + 1]
    return with_prescribed


def unit_potentials(system: System, state: State, rows: NDArray) -> NDArray:
    """Potentials of gravity with the amplitude 1, of all its ports in recorded states, (n, ports).

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    potentials = np.zeros((len(rows), len(system.gravity_ports)))
    _over_records("potentials", _evaluate_potentials, system, state, rows, potentials)
    return potentials


def constraint_residuals(system: System, state: State, rows: NDArray) -> NDArray:
    """Largest residual of the constraints and of their rates in every recorded state, (n, 2).

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    residuals = np.zeros((len(rows), 2))
    if system.is_multiplier.any():
        _over_records("constraints", _evaluate_constraints, system, state, rows, residuals)
    return residuals


def _over_records(what: str, evaluate: Callable[..., int], system: System, state: State,
                  rows: NDArray, *out: NDArray) -> None:
    """Evaluate the recorded states, then restore the state the run has reached."""
    now, loads = state.now.copy(), state.loads.copy()
    status = evaluate(system, state, rows, *out)
    state.now[:], state.loads[:] = now, loads
    if status:
        raise InputError(f"the {what} of a recorded state cannot be evaluated")


@compiled
def _evaluate_energies(system, state, rows, out):
    for k in range(len(rows)):
        copy(rows[k], state.now)
        set_loads(system, state.frames, state.loads, state.now[RECORD_T])
        for i in range(state.energy.size):
            state.energy[i] = 0.0
        status = run_kernels(ENERGY, 0, system.address.size, system, state)
        if status != 0:
            return status
        copy(state.energy, out[k])
    return 0


@compiled
def _evaluate_potentials(system, state, rows, out):
    for k in range(len(rows)):
        copy(rows[k], state.now)
        for j in range(system.gravity_ports.size):
            out[k, j] = unit_potential(system, state, j)
    return 0


@compiled
def _evaluate_forces(system, state, rows, elements, sums):
    for k in range(len(rows)):
        copy(rows[k], state.now)
        set_loads(system, state.frames, state.loads, state.now[RECORD_T])
        status = assemble(RESIDUAL, RESIDUAL, system, state, state.residual)
        if status != 0:
            return status
        copy(state.g, elements[k])
        copy(state.residual, sums[k])
    return 0


@compiled
def _evaluate_constraints(system, state, rows, out):
    for k in range(len(rows)):
        copy(rows[k], state.now)
        set_loads(system, state.frames, state.loads, state.now[RECORD_T])
        for j, task in enumerate((RESIDUAL, VELOCITY)):
            status = assemble(RESIDUAL, task, system, state, state.residual)
            if status != 0:
                return status
            for i in range(system.diagonal.size):
                if system.is_multiplier[i] > 0.0:
                    out[k, j] = max(out[k, j], abs(state.residual[i]))
    return 0
