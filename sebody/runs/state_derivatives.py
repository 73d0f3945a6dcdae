"""Exact derivatives of the forces in a state of a run, in axes at rest or that rotate."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from sebody.engine.evaluate import to_body_axes
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin, motion, of_levers, summed
from sebody.runs.simulation import Simulation
from sebody.runs.tangents import tangent


def derivative(run: Simulation | Result, mass: float, damping: float,
               stiffness: float) -> csc_matrix:
    """Weighted sum of the exact derivatives, in body axes.

    Weights are those of the derivatives with respect to accelerations, velocities, and positions
    and rotations. Constraints go with the last.
    """
    return tangent(*run.arrays_of_loop, mass, damping, stiffness)


def rotating(run: Simulation | Result, spin: Spin) -> tuple[csc_matrix, NDArray]:
    """Tangent stiffness in axes that rotate with the spin, and the residual."""
    stiffness = turning(run, spin)[2] if spin.rotates else derivative(run, 0.0, 0.0, 1.0)
    system, state = run.arrays_of_loop
    state.control.iterations += 1
    residual = state.residual.copy()
    to_body_axes(system, state.frames, residual, False)
    return csc_matrix(stiffness), residual[:run.numbering.free]


def turning(run: Simulation | Result, spin: Spin) -> tuple[csc_matrix, csc_matrix, csc_matrix]:
    """Mass, damping and stiffness in axes that rotate with the spin; see `rotating_frame`."""
    mass, damping, stiffness = (weighted(run, *weights) for weights in np.eye(3))
    G = motion(run)
    velocity, place, rate = spin.moved(run, G)
    return (G.T @ mass @ G, G.T @ (damping @ G + mass @ rate),
            G.T @ (stiffness @ G + damping @ velocity + mass @ place)
            + of_levers(run, run.arrays_of_loop[1].residual))


def weighted(run: Simulation | Result, *weights: float) -> csc_matrix:
    derivative(run, *weights)
    return summed(run)
