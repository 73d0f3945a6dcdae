"""Derivatives of loads that turn with bodies, in global axes, against differences of forces."""

import differentiated as scenes
import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Simulation
from sebody.assembly.evaluation import evaluate
from sebody.contract.layout import RESIDUAL
from sebody.runs.rotating_frame import summed
from sebody.runs.state_derivatives import derivative


def test_a_load_on_a_turned_body():
    run = Simulation(scenes.blown(), 0.005)
    run.run_to(0.15)
    derivative(run, 0.0, 0.0, 1.0)
    found, state = summed(run).toarray(), run.state
    step = 1e-4
    for k, first in enumerate(run.system.rotation_at):
        base = state.R[9 * k:9 * k + 9].reshape(3, 3).copy()
        for i in range(3 if first < run.numbering.free else 0):
            forces = []
            for at in (1, -1, 2, -2):
                turn = Rotation.from_rotvec(at * step * np.eye(3)[i]).as_matrix()
                state.R[9 * k:9 * k + 9] = (base @ turn).ravel()
                evaluate(run.system, state, RESIDUAL, RESIDUAL, "the state")
                forces.append(state.residual.copy())
            expected = (8 * (forces[0] - forces[1]) - forces[2] + forces[3]) / (12 * step)
            # rounding of forces over the step
            assert np.abs(found[:, first + i] - expected).max() < 1e-9 * np.abs(found).max()
        state.R[9 * k:9 * k + 9] = base.ravel()
