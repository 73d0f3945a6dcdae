"""Quantities in states moved a little: their derivatives along small motions.

Forces of the elements change by the exact element matrices, and a quantity of motions and forces by
its tape. Others, such as energies and stresses, follow from their values in states moved forth and
back along a motion, in positions, velocities and accelerations.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import RECORD_T
from sebody.contract.read_numbers import FORCE, LOAD, NOW, OF_A, OF_FORCE, OF_R
from sebody.engine.evaluate import set_loads
from sebody.engine.links import pull_back
from sebody.kernels.tapes import play_along
from sebody.model.numbering import coordinates
from sebody.quantities.reading import evaluate_loaded
from sebody.quantities.symbols import NoTape
from sebody.results import rotations
from sebody.results.postprocessing import Forces
from sebody.results.result import Result
from sebody.results.tapes import States
from sebody.runs.rotating_frame import by_element, motion
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import derivative
from sebody.small_motion.rotation.views import View

MOVING = {NOW, FORCE, LOAD}     # kinds of numbers whose change along a motion is exact
UNMOVED, ADDED_UP = ("t", "energy.external_work"), ".work"     # quantities that do not answer
# motion of the states that are compared, of the extent or in radians: of its fourth power is the
# error of differences over steps of one and two, and rounding is divided by it
SMALL = 1e-3
STEPS, WEIGHTS = (1.0, -1.0, 2.0, -2.0), np.array([8.0, -8.0, -1.0, 1.0]) / 12.0


class Moves(NamedTuple):
    """Small motions of all coordinates, (k, coordinates) each, in global axes."""

    positions: NDArray
    velocities: NDArray
    accelerations: NDArray

    def plus(self, *others: NDArray) -> "Moves":
        """The sum of these motions and others, of positions, velocities and accelerations."""
        return Moves(*(own + other for own, other in zip(self, others, strict=True)))


def refuse_unmoved(names: Iterable[str], what: str) -> None:
    """Refuse quantities that add up over time.

    Raises
    ------
    InputError
        The message ends with `what` they do not have, and why.
    """
    for name in names:
        if name in UNMOVED or name.endswith(ADDED_UP):
            raise InputError(f"quantity {name!r} has no {what}: time and work are not "
                             "periodic; name a position, a force or a power")


def moves(run: Simulation | Result, axes: View, unknowns: NDArray, rates: NDArray,
          seconds: NDArray) -> Moves:
    """Motion of all coordinates by that of the unknowns (k, n) and its rates, in their own axes.

    The unknowns are told in the axes of an analysis.
    """
    unknowns, rates, seconds = axes.base(run, unknowns, rates, seconds)
    G = motion(run)
    q, v, a = (one @ G.T for one in (unknowns, rates, seconds))
    if axes.spin.rotates:
        velocity, place, turning = axes.spin.moved(run, G)
        a = a + rates @ turning.T + unknowns @ place.T
        v = v + unknowns @ velocity.T
    return Moves(q, v, a)


def differences(run: Simulation | Result, names: Sequence[str], along: Moves, pushed: NDArray,
                small: float = SMALL) -> dict[str, NDArray]:
    """Derivatives of quantities along some motions, (k, ...) of each.

    Parameters
    ----------
    along : Moves
    pushed : (k, forces of all elements)
        Change of the forces of elements beside what the motions make.
    small : float
        Motion of the states that are compared, of the characteristic length or in radians.
    """
    found, change = {}, None
    for name in names:
        if (tape := _tape(run, name)) is not None:
            change = pushed + _forces(run, along) if change is None else change
            found[name] = _by_tape(run, *tape, along, change)
    if rest := [name for name in names if name not in found]:
        found |= _compared(run, rest, along, pushed, small)
    return found


def _tape(run: Simulation | Result, name: str) -> tuple[States, tuple[int, ...]] | None:
    """The tape of a quantity of motions and forces, and its shape; None of others."""
    states = States(run.model, run.numbering, run.system, run.state, run.state.now)
    try:
        shape = None if states.is_inside(name) else states.put(name)
    except NoTape:
        shape = None
    return None if shape is None or not states.kinds <= MOVING else (states, shape)


def _by_tape(run: Simulation | Result, states: States, shape: tuple[int, ...], along: Moves,
             change: NDArray) -> NDArray:
    """Derivatives along some motions, (k, ...), with changes of the forces of all elements."""
    state, reading = run.state, states.reading()
    loads = state.loads.copy()
    set_loads(run.system, state.frames, state.loads, state.now[RECORD_T])
    status = evaluate_loaded(run.system, state, reading)
    state.loads[:] = loads
    if status:
        raise InputError("the state cannot be evaluated")
    tape = reading.steps, reading.factors, reading.weights, reading.numbers
    found = np.zeros((len(change), len(reading.outputs)))
    for k, row in enumerate(found):
        rates = np.zeros(len(reading.numbers))
        for place, (kind, i, entry) in zip(reading.inputs[:, 0], states.depends(), strict=True):
            if kind <= OF_A:
                rates[place] = along[kind][k, i]
            elif kind == OF_FORCE:
                rates[place] = change[k, i]
            elif kind == OF_R:      # of R skew(theta)
                first, theta = entry // 3 * 3, along.positions[k, i:i + 3]
                one, other = (entry + 1) % 3, (entry + 2) % 3
                rates[place] = (state.R[first + one] * theta[other]
                                - state.R[first + other] * theta[one])
        play_along(*tape, rates)
        row[:] = rates[reading.outputs]
    return found.reshape(-1, *shape)


def _compared(run: Simulation | Result, names: Sequence[str], along: Moves, pushed: NDArray,
              small: float) -> dict[str, NDArray]:
    """Derivatives of quantities without such a tape, from their values in moved states."""
    rows, scale = _moved_rows(run, along, small)
    recording = Result(run.model, run.numbering, run.system, run.state, rows, 0.0)
    base = Result(run.model, run.numbering, run.system, run.state, run.state.now[None].copy(), 0.0)
    unique = along
    if run.system.regularized[0]:       # multipliers of least norm
        q = recording.unique_rows[:, run.state.recorded_parts["q"]]
        unique = along._replace(positions=np.where(
            run.system.is_multiplier[:q.shape[1]] > 0, _derivative(q, scale), along.positions))
    change = pushed + _forces(run, unique)
    elements = base.forces.elements + _steps(scale[:, None] * change)
    recording.forces = Forces(elements, _sums(run, elements, rows))
    return {name: _derivative(np.asarray(recording[name]), scale) for name in names}


def _moved_rows(run: Simulation | Result, along: Moves, small: float
                ) -> tuple[NDArray, NDArray]:
    """States moved forth and back along every motion, and by how much of it, (k,)."""
    numbering, state = run.numbering, run.state
    extent = np.full(numbering.total, np.inf)   # of what has no size of its own: any
    rotated = {}
    for dof_block in numbering.dof_blocks:
        columns = coordinates(numbering, dof_block)
        extent[columns] = 1.0 if dof_block.rotational else run.model.size()
        if dof_block.rotational and not run.model.planar:
            rotated[numbering.rotations[dof_block]] = columns
    largest = (np.abs(along.positions) / extent).max(axis=1)
    scale = small / np.where(largest > 0, largest, 1.0)
    parts = state.recorded_parts
    rows = np.tile(state.now, (len(STEPS) * len(scale), 1))
    for name, values in zip("qva", along, strict=True):
        rows[:, parts[name]] += _steps(scale[:, None] * values)
    turns = _steps(scale[:, None] * along.positions)
    for number, columns in rotated.items():
        first = parts["R"].start + 9 * number
        R = rows[:, first:first + 9].reshape(-1, 3, 3)
        rows[:, first:first + 9] = (R @ rotations.matrices(turns[:, columns])).reshape(-1, 9)
    return rows, scale


def _forces(run: Simulation | Result, along: Moves) -> NDArray:
    """Change of the forces of all elements along some motions, by the exact matrices."""
    forces = np.zeros((len(along.positions), run.state.g.size))
    for values, weights in zip(along, ((0, 0, 1), (0, 1, 0), (1, 0, 0)), strict=True):
        derivative(run, *map(float, weights))
        forces += (by_element(run) @ values.T).T
    return forces


def _sums(run: Simulation | Result, elements: NDArray, rows: NDArray) -> NDArray:
    """Sums of the forces of elements; those on ends of rigid links act on roots and rotations."""
    system, parts = run.system, run.state.recorded_parts
    totals = np.zeros((len(rows), run.numbering.total))
    for row, forces, sums in zip(rows, elements, totals, strict=True):
        np.add.at(sums, system.g_unknown, forces)
        if system.links.dependent.shape[0]:
            pull_back(system.links, row[parts["q"]], row[parts["R"]], run.state.turns, sums)
    return totals


def _steps(values: NDArray) -> NDArray:
    """Rows times the steps, those of one row one behind the other."""
    steps = np.multiply.outer(STEPS, values)
    return np.swapaxes(steps, 0, 1).reshape(-1, *values.shape[1:])


def _derivative(values: NDArray, scale: NDArray) -> NDArray:
    """Derivatives from values in states moved by steps of these scales."""
    differences = values.reshape(len(scale), len(STEPS), *values.shape[1:])
    return np.einsum("j,kj...->k...", WEIGHTS, differences) / scale.reshape(
        -1, *[1] * (values.ndim - 1))
