"""Frequencies about the state a model keeps: at rest, in equilibrium, or in steady rotation."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model.gravity_fields import gravity_at
from sebody.model.mechanism import Mechanism
from sebody.model.variants.copying import copied
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.runs.statics import equilibrium
from sebody.small_motion.linearization import modes

RIGID = 1e-6        # of the largest velocity: by which those of a rigid rotation may be off
PLACED = "coincident_ground", "planar_coincident_ground"        # joints to a point in space
STEP = 1.0          # of a model that is not run


def steady_frequencies(result: Result) -> NDArray:
    """Angular frequencies about the steady state that a run begins at, ascending.

    That is the start if nothing acts there and all is at rest; the equilibrium under gravity and
    the loads of t = 0; or the steady rotation, with its stresses, that initial velocities are.

    Raises
    ------
    InputError
        Velocities at the start that are no steady rotation.
    SimulationError
        No equilibrium.
    """
    model = result.model
    places, velocities = _start(result)
    if np.any(velocities):
        spin, centre = _rotation(places, velocities)
        model = model if centre is None else shifted(model, -centre)
        return modes(equilibrium(model, spin=spin), spin).omega
    loaded = any(one.time_function is not None and one.time_function.at(0.0)[0]
                 for one in model.loads)
    if loaded or gravity_at(model, 0.0).any():
        return modes(equilibrium(model)).omega
    return modes(Simulation(model, STEP)).omega


def _start(result: Result) -> tuple[NDArray, NDArray]:
    """Places and velocities of all nodes that have a position, (nodes, dimension) each."""
    names = [node.name for node in result.model.nodes.values() if node.position]
    return tuple(np.array([result[f"{name}.{what}"][0] for name in names])
                 for what in ("position", "velocity"))


def _rotation(places: NDArray, velocities: NDArray) -> tuple[NDArray | float, NDArray | None]:
    """The angular velocity that some velocities are, and a point of its axis; None: the origin.

    Raises
    ------
    InputError
        They are none.
    """
    d = places.shape[1]
    if d == 2:
        turning = np.stack([-places[:, 1], places[:, 0]], axis=1)[:, :, None]
    else:
        turning = np.stack([np.cross(axis, places) for axis in np.eye(3)], axis=2)
    moving = np.broadcast_to(np.eye(d), (len(places), d, d))
    most = np.abs(velocities).max()
    for columns in (turning, np.concatenate([turning, moving], axis=2)):
        solution = np.linalg.lstsq(columns.reshape(-1, columns.shape[2]), velocities.ravel())[0]
        spin, shift = np.split(solution, [turning.shape[2]])
        off = np.abs(columns @ solution - velocities).max()
        # of a shift along the axis, a screw
        off = max(off, abs(shift @ spin) / max(np.linalg.norm(spin), 1e-300)
                  if d == 3 and len(shift) else 0.0)
        if off <= RIGID * most and np.linalg.norm(spin) * np.ptp(places, axis=0).max() > 0.0:
            centre = _centre(spin, shift) if len(shift) else None
            return (float(spin[0]) if d == 2 else spin), centre
    raise InputError(
        f"the velocities at the start are no steady rotation (the nearest, "
        f"{np.array2string(spin, precision=4)}, leaves {off:.3g} of {most:.3g}): give all nodes "
        "the velocities of the rotation, with rigid_velocity, or start from rest")


def _centre(spin: NDArray, shift: NDArray) -> NDArray:
    """The point of an axis next to the origin, where ``shift = -spin x centre``."""
    if len(shift) == 2:
        return np.array([-shift[1], shift[0]]) / spin[0]
    return np.cross(spin, shift) / (spin @ spin)


def shifted(model: Mechanism, by: NDArray) -> Mechanism:
    """A model elsewhere.

    Raises
    ------
    InputError
        It is another one there: functions of users may read where they are.
    """
    if any(one.function is not None for one in (*model.constraints, *model.loads)):
        raise InputError("the steady rotation is about an axis that misses the origin, and a "
                         "user's function may read positions: build the model so that the axis "
                         "passes through the origin")
    moved = copied(model)
    for node in {one: one for one in (*moved.nodes.values(), *moved.grounds)}.values():
        node.point = node.point + by
    positions = [one for one in moved.dof_blocks() if not one.rotational]
    positions += [one.position for one in moved.grounds if one.position is not None]
    for dof_block in {one: one for one in positions}.values():
        dof_block.start = dof_block.start + by
    for joint in moved.constraints:
        if joint.kind in PLACED:
            joint.constants["c"] = joint.constants["c"] + by
    return moved
