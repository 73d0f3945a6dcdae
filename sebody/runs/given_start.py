"""A start from a state that was computed: an equilibrium, or the end of another run."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.layout import KINETIC, RECORD
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.extent import extent
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates, record_counts, stretch
from sebody.results.postprocessing import energies
from sebody.results.result import Result
from sebody.runs.taken_over import have_same_order, taken_over

APART = 1e-8        # of the extent, or rad: by which fixed and driven coordinates may differ
NOTHING: tuple[str, ...] = ()


def take(model: Mechanism, numbering: Numbering, state: State, given: Result) -> tuple[str, ...]:
    """Put positions, rotations and modes of the last state of a result in a state at t = 0.

    Velocities are those of that state, too, but for those the model gives. Of another model what
    has the same name is taken over, see `taken_over`.

    Returns
    -------
    tuple of str
        What could not be taken over, in words.

    Raises
    ------
    InputError
        No result, one of a model that has nothing in common with this one, or fixed and driven
        coordinates that are elsewhere.
    """
    inputs.instance(given, "start", Result, "give the Result of an equilibrium or of a run")
    row, parts, left = given.rows[-1], RECORD.slices(record_counts(numbering)), NOTHING
    if not have_same_order(model, numbering, given):
        row, left = taken_over(model, numbering, state.now, given)
    q, R, v = (row[parts[name]].copy() for name in ("q", "R", "v"))
    for dof_block in model.dof_blocks():
        if dof_block not in numbering.dof_blocks:
            continue
        at, k = stretch(numbering, dof_block), numbering.rotations.get(dof_block)
        is_given = dof_block.given or bool(dof_block.rate.any())
        if is_given or not dof_block.solved:
            v[at] = state.v[at]
        if k is not None:
            q[at] = 0.0        # in space R has the rotation, and q the increment in a step
            if is_given:        # in global axes
                v[at] = R[9 * k:9 * k + 9].reshape(3, 3).T @ state.v[at]
    for body in model.bodies.values():
        if np.any(body.mode_rates):
            at = slice(numbering.modes[body.name], numbering.modes[body.name] + body.reduced.modes)
            v[at] = body.mode_rates
    _check_held(model, numbering, state, q, R)
    state.q[:], state.R[:], state.v[:] = q, R, v
    state.q_old[:], state.R_old[:], state.v_old[:] = q, R, v
    state.frames[:] = state.frames_old[:] = row[parts["frames"]]
    return left


def energy_lost(system: System, numbering: Numbering, state: State, before: NDArray) -> float:
    """Kinetic energy that a change of velocities took, which were `before`."""
    rows = np.stack([state.now, state.now])
    rows[0, RECORD.slices(record_counts(numbering))["v"]] = before
    had, has = energies(system, state, rows)[:, KINETIC]
    return float(had - has)


def _check_held(model: Mechanism, numbering: Numbering, state: State, q: NDArray,
                R: NDArray) -> None:
    """Refuse a state whose fixed and driven positions and rotations are not those of t = 0."""
    length = extent(model)
    for dof_block in model.dof_blocks():
        if not dof_block.fixed or dof_block not in numbering.dof_blocks:
            continue
        own, k = coordinates(numbering, dof_block), numbering.rotations.get(dof_block)
        apart = np.abs(q[own] - state.q[own]).max() / (1.0 if dof_block.rotational else
                                                       max(length, 1e-300))
        if k is not None:
            apart = np.abs(R[9 * k:9 * k + 9] - state.R[9 * k:9 * k + 9]).max()
        if apart > APART:
            raise InputError(f"start: {dof_block.name} is not where the model holds or moves it at "
                             "t = 0: give a state at which drives have not moved yet, such as the "
                             "equilibrium at t = 0")
