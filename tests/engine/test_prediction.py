"""Prediction of steps: how many corrections are left to Newton's iteration, and what they leave."""

import numpy as np
import pytest

from sebody import Simulation, generalized_alpha
from sebody.engine.prediction import PERIOD
from sebody.scenes import four_bar, squeezer


def run(scene, periods, **scheme):
    return Simulation(scene.model, scene.h, generalized_alpha(**scheme)).run_to(
        periods * PERIOD * scene.h)


@pytest.mark.parametrize("build, parameters, most", [
    (four_bar.build, {}, 2.0), (four_bar.build, {"loops": 20}, 2.0), (squeezer.build, {}, 2.0)])
def test_corrections_and_what_they_leave(build, parameters, most):
    """Where nothing is predicted but lines of accelerations: 3.4, 2.8 and 3.0."""
    scene = build(**parameters)
    own, exact = run(scene, 16), run(scene, 16, tolerance=1e-12)
    assert own.state.control.iterations < most * own.state.control.steps
    moving = own.system.is_multiplier[:own.state.q.size] == 0.0
    for name in ("q", "v"):
        rows = [one.rows.all()[:, one.state.recorded_parts[name]][:, moving]
                for one in (own, exact)]
        # with a tolerance of 1e-8 in every step: found are 1e-8 at most
        assert np.abs(rows[0] - rows[1]).max() < 1e-7 * np.abs(rows[1]).max()


def test_resumed_runs_predict_as_whole_ones():
    """What is known of earlier steps belongs to the state."""
    scene = squeezer.build()
    whole = run(scene, 5)
    parts = Simulation(scene.model, scene.h)
    for end in (1.3, 2.5, 4.0, 5.0):
        parts.run_to(round(end * PERIOD) * scene.h)
    np.testing.assert_array_equal(parts.state.now, whole.state.now)
