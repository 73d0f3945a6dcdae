"""Rotation matrices stay orthogonal."""

import numpy as np

from sebody import Model, Simulation
from sebody.engine.step import ORTHOGONAL


def test_rotations_are_made_orthogonal_again():
    """A disturbance far above rounding is squared by each Newton step towards a rotation."""
    model = Model()
    model.rigid_body("body", model.node("centre", (0, 0, 0)), 1.0, (1.0, 2.0, 2.5))
    model.initial_velocity("centre", angular=(0.3, -0.2, 0.5))
    run = Simulation(model, 1e-3).run_to(3e-3)

    def off():
        R = run.state.R.reshape(3, 3)
        return np.abs(R.T @ R - np.eye(3)).max()
    run.state.R[:] += 1e-6 * np.array([3.0, -1.0, 2.0, 1.0, 2.0, -2.0, 1.0, 3.0, -1.0])
    disturbed = off()
    assert disturbed > 2e-6
    run.run_to((3 + ORTHOGONAL) * 1e-3)
    assert off() < 3 * disturbed**2
    run.run_to((3 + 2 * ORTHOGONAL) * 1e-3)
    assert off() < 10 * np.finfo(float).eps     # of entries that are sums of three products
