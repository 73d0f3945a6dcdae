"""Frequencies about the state a model keeps: at rest, in equilibrium, or in steady rotation."""

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.results.result import Result
from sebody.runs.simulation import Simulation
from sebody.runs.statics import equilibrium
from sebody.small_motion.linearization import modes

RIGID = 1e-6        # of the largest velocity: by which those of a rigid rotation may be off
STEP = 1.0          # of a model that is not run


def steady_frequencies(result: Result) -> NDArray:
    """Angular frequencies about the steady state that a run begins at, ascending.

    That is the start if nothing acts there and all is at rest; the equilibrium under gravity and
    the loads of t = 0; or the steady rotation, with its stresses, that initial velocities are.

    Raises
    ------
    InputError
        Velocities at the start that are no rotation about the origin.
    SimulationError
        No equilibrium.
    """
    model = result.model
    places, velocities = _start(result)
    if np.any(velocities):
        spin = _spin(places, velocities)
        return modes(equilibrium(model, spin=spin), spin).omega
    loaded = any(one.time_function is not None and one.time_function.at(0.0)[0]
                 for one in model.loads)
    if loaded or np.any(model.gravity_field):
        return modes(equilibrium(model)).omega
    return modes(Simulation(model, STEP)).omega


def _start(result: Result) -> tuple[NDArray, NDArray]:
    """Places and velocities of all nodes that have a position, (nodes, dimension) each."""
    names = [node.name for node in result.model.nodes.values() if node.position]
    return tuple(np.array([result[f"{name}.{what}"][0] for name in names])
                 for what in ("position", "velocity"))


def _spin(places: NDArray, velocities: NDArray) -> NDArray | float:
    """The angular velocity about the origin that some velocities are.

    Raises
    ------
    InputError
        They are none.
    """
    if places.shape[1] == 2:
        columns = np.stack([-places[:, 1], places[:, 0]], axis=1)[:, :, None]
    else:
        columns = np.stack([np.cross(axis, places) for axis in np.eye(3)], axis=2)
    spin = np.linalg.lstsq(columns.reshape(-1, columns.shape[2]), velocities.ravel())[0]
    off = np.abs(columns @ spin - velocities).max()
    if off > RIGID * np.abs(velocities).max():
        raise InputError(
            "the velocities at the start are not a steady rotation about the origin (the nearest, "
            f"{np.array2string(spin, precision=4)}, leaves {off:.3g} of "
            f"{np.abs(velocities).max():.3g}): shift the model so that the axis passes through the "
            "origin and give all nodes the velocities of the rotation, with rigid_velocity, or "
            "start from rest")
    return float(spin[0]) if len(spin) == 1 else spin
