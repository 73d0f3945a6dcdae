"""Scenes on foundations: balances of momentum at the base, and the thrust of a moving axis."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

from sebody import simulate
from sebody.scenes import machine_bed, turbine_on_jacket


def test_the_seabed_takes_what_the_sea_gives():
    """Impulses of the sea's force and of the base's reaction make the momentum."""
    scene = turbine_on_jacket.build()
    result = simulate(scene.model, scene.h, scene.t_end)
    sea = turbine_on_jacket.sea(4e5, 60.0)
    forces = sea.at(result.t)[:, :2] + result["jacket.base.reaction"][:, :2]
    given = cumulative_simpson(forces, x=result.t, axis=0, initial=0)
    momentum = result["momentum"][:, :2]
    assert np.abs(momentum - given).max() < 2e-3 * np.abs(momentum).max()
    assert result["sea.work"][-1] > 0 > result["damping of jacket.work"][-1]
    assert 0.05 < np.abs(result["hub.position.x"]).max() < 0.5


def test_the_bed_takes_the_thrust_of_its_carriage():
    """The largest acceleration from rest to rest is ``10 / sqrt(3) d / T^2``."""
    scene = machine_bed.build()
    result = simulate(scene.model, scene.h, scene.t_end)
    largest = 10 / np.sqrt(3) * machine_bed.STROKE / machine_bed.DURATION**2
    assert result["drive.thrust"].max() == pytest.approx(machine_bed.CARRIAGE * largest, rel=5e-3)
    assert result["carriage.position.x"][-1] - result["carriage.position.x"][0] == pytest.approx(
        machine_bed.STROKE, abs=1e-5)
    swing = result["tool.position.x"] - result["tool.position.x"][0]
    assert 5e-6 < np.abs(swing).max() < 5e-5
    slow = machine_bed.build(2 * machine_bed.DURATION)
    slower = simulate(slow.model, slow.h, 0.8)["drive.thrust"].max()
    assert slower == pytest.approx(result["drive.thrust"].max() / 4, rel=2e-2)
