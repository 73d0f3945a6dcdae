"""The estimated error of a run against the true one."""

import numpy as np
import pytest

from sebody import Model
from sebody.analysis.accuracy import simulate_within
from sebody.analysis.tolerance import Tolerance


@pytest.mark.parametrize("allowed", [1e-3, 1e-4])
def test_the_estimated_error_is_the_true_one(allowed):
    """A mass on a spring, ``x = 1 + u sin(w t)``; errors fall with the square of the steps.

    So the error of the finer of two runs is their difference over ``n^2 - 1``, but for terms of
    third order. Their share is about ``w h``, 0.05 in the coarser of the two runs of 1e-3.
    """
    omega, amplitude = 5.0, 0.5
    model = Model(planar=True)
    model.node("wall", (0.0, 0.0), keeps="translation")
    model.fix("wall", "position")
    model.point_mass("ball", model.node("ball", (1.0, 0.0), keeps="translation"), 1.0)
    model.spring("ball", "wall", omega**2)
    model.initial_velocity("ball", (amplitude * omega, 0.0))
    result = simulate_within(model, 0.05, 10.0, Tolerance(allowed))
    exact = 1.0 + amplitude * np.sin(omega * result.t)
    true = np.sqrt(np.mean((result["ball.position"][:, 0] - exact)**2)) / allowed
    assert result.error == pytest.approx(true, rel=0.05)
