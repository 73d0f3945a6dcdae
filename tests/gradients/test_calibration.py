"""Calibration beside SciPy's weighted fit of a motion in closed form."""

import numpy as np
import pytest
from scipy.optimize import curve_fit

from sebody import Model
from sebody.analysis import calibrate
from sebody.gradients.calibration import _between

MASS, STIFFNESS, DAMPING, START = 2.0, 50.0, 3.0, 0.3
PLACE = np.array([0.4, -1.0, 0.7])
DIRECTION = np.array([2.0, -1.0, 2.0]) / 3.0


def oscillator() -> Model:
    """A mass on a spring and damper to the ground, along a line in general position."""
    model = Model()
    node = model.node("mass", PLACE + START * DIRECTION, keeps="translation")
    model.point_mass("weight", node, MASS)
    model.slider(node, DIRECTION, name="rail")
    wall = model.node("wall", PLACE - 5.0 * DIRECTION, keeps="translation")
    model.fix(wall, "position")
    model.spring(node, wall, STIFFNESS, length=5.0, damping=DAMPING, name="spring")
    return model


def closed_form(t, stiffness, damping):
    """Way and speed of the oscillator."""
    decay = damping / 2.0 / MASS
    w = np.sqrt(stiffness / MASS - decay**2)
    way = START * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    speed = -START * np.exp(-decay * t) * (decay**2 / w + w) * np.sin(w * t)
    return way, speed


def test_values_and_covariance_are_those_of_a_weighted_fit():
    """Ways and speeds at uneven times between the states, whose errors differ by a factor of 40.

    Five numbers for two parameters: the covariance counts the three that are left over.
    """
    rng = np.random.default_rng(5)
    t_way, t_speed = np.array([0.1137, 0.3819, 0.7043]), np.array([0.2571, 0.9188])
    deviations = {"rail.displacement": 1e-3, "rail.speed": 4e-2}
    way = closed_form(t_way, 1.02 * STIFFNESS, 0.95 * DAMPING)[0] - START + rng.normal(0, 1e-3, 3)
    speed = closed_form(t_speed, 1.02 * STIFFNESS, 0.95 * DAMPING)[1] + rng.normal(0, 4e-2, 2)
    found = calibrate(oscillator(), 1e-3, {"rail.displacement": np.column_stack([t_way, way]),
                                           "rail.speed": np.column_stack([t_speed, speed])},
                      ["spring.stiffness", "spring.damping"], deviations)

    def both(_, stiffness, damping):
        return np.concatenate([closed_form(t_way, stiffness, damping)[0] - START,
                               closed_form(t_speed, stiffness, damping)[1]])
    value, covariance = curve_fit(both, np.arange(5), np.concatenate([way, speed]),
                                  (STIFFNESS, DAMPING), sigma=np.repeat([1e-3, 4e-2], (3, 2)))
    assert found.value == pytest.approx(value, rel=1e-4)
    assert found.covariance == pytest.approx(covariance, rel=2e-3)


def test_values_between_states_are_those_of_their_own_interval():
    t = np.array([0.0, 0.1, 0.25, 0.3, 0.7])
    values = np.stack([t**2, np.cos(5 * t)], axis=1)
    times = np.array([0.0, 0.03, 0.1, 0.2, 0.27, 0.69, 0.7])
    expected = np.stack([np.interp(times, t, own) for own in values.T], axis=1)
    assert _between(t, values, times) == pytest.approx(expected, abs=1e-15)
