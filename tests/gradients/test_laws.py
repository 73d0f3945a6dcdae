"""Gradients of runs with friction, contacts, gears, actuators and controllers."""


import differentiated as scenes
import numpy as np
import pytest
from readings import TABLE

from sebody import InputError, simulate
from sebody.analysis import Ensemble, calibrate, final, gradient, integral
from sebody.gradients import segments
from sebody.gradients.gradient import Differentiated
from sebody.gradients.point import Point
from sebody.runs.schemes import generalized_alpha

EXACT = generalized_alpha(tolerance=1e-13)


def rows(matrix):
    """Largest entry of each row."""
    return np.maximum(np.abs(matrix).max(axis=1, keepdims=True), 1e-300)


def test_steps_in_which_friction_turns_round_are_differentiated_as_they_are():
    """Three returns, in two of which it sticks; differences within the branches."""
    m = scenes.journal(coefficient=3.0)
    run = 0.005, 2.0, {"x": final("a.rotation"), "s": integral("a.rotation")}, [
        "dry.coefficient", "gravity", "a.angular_velocity"]
    result = simulate(m, *run[:2], scheme=EXACT)
    assert (np.diff(np.sign(result["a.angular_velocity"])) != 0).sum() == 3
    assert result["dry.sticks"].sum() >= 2
    found = gradient(m, *run, scheme=EXACT)
    expected = scenes.differences(m, *run, relative=1e-5)
    assert (np.abs(found.matrix - expected) / rows(expected)).max() < 1e-6


def test_the_coefficient_of_friction_of_a_measured_decay():
    """A pendulum with noise of a milliradian: within three standard deviations."""
    run = simulate(scenes.journal(coefficient=0.21), 0.005, 1.0)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(len(run["t"]))
    found = calibrate(scenes.journal(), 0.005, {"a.rotation": np.column_stack(
        [run["t"], run["a.rotation"] + noise])}, ["dry.coefficient"])
    assert abs(found.value[0] - 0.21) < 3 * found.deviation[0] < 0.02


def test_parameters_of_a_law_in_an_ensemble():
    values = np.array([[20.0, 5.0, 2.0, 80.0, 0.7], [25.0, 4.0, 1.0, 70.0, 0.6]])
    found = Ensemble(scenes.arm(), 0.005).run({"loop.parameters": values}, 0.1, {
        "tip": final("tip.position")})["tip"]
    with Point(scenes.arm(), ["loop.parameters"]).at(values[1]):
        alone = simulate(scenes.arm(), 0.005, 0.1)["tip.position"][-1]
    assert found[1] == pytest.approx(alone, rel=1e-9)
    assert abs(found[0] - found[1]).max() > 1e-3


def _law(t, y, x, rates, u, parameters):
    rates[0] = y[0]
    u[0] = -parameters[0] * y[0] - x[0]


def _samples(t, y, x, u, parameters):
    u[0] = -parameters[0] * y[0]


@pytest.mark.parametrize("sampled", [True, False])
def test_controllers_without_derivatives_are_refused_by_their_names(sampled):
    m = scenes.hinged("b", modes=2)
    m.actuator("motor", joint="hinge")
    with pytest.raises(InputError, match="actuator 'motor'.*table"):
        gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity"])
    m.controller("loop", _samples if sampled else _law, ["hinge.angle"], ["motor"],
                 period=0.01 if sampled else None, states=[] if sampled else [0.1],
                 parameters=[2.0])
    words = "is sampled.*period=" if sampled else "without derivatives: give derivatives="
    with pytest.raises(InputError, match=f"controller 'loop'.*{words}"):
        gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity"])


def test_what_jumps_or_is_kept_is_refused():
    m = scenes.journal(coefficient=3.0, static=4.0)
    with pytest.raises(InputError, match="'dry' breaks away at t = .*4 to 3.*speed="):
        gradient(m, 0.005, 2.0, {"x": final("a.rotation")}, ["gravity"])
    with pytest.raises(InputError, match="'dry.normal_force' depends on what friction.*keep"):
        gradient(m, 0.005, 0.02, {"f": final("dry.normal_force")}, ["gravity"])
    with pytest.raises(InputError, match="'dry' keeps numbers.*index=3"):
        gradient(m, 0.005, 0.02, {"x": final("a.rotation")}, ["gravity"],
                 scheme=generalized_alpha(index=2))


@pytest.mark.parametrize("mode", ["adjoint", "forward"])
def test_what_laws_keep_goes_on_from_segment_to_segment(mode, monkeypatch):
    m, run = scenes.journal(), TABLE["bearing"].run
    whole = gradient(m, *run, mode, scheme=EXACT)
    row = Differentiated(m, *run[:2], EXACT).history.rows[0]
    monkeypatch.setattr(segments, "STATES", 7 * row.nbytes)
    parts = gradient(m, *run, mode, scheme=EXACT)
    assert np.array_equal(parts.value, whole.value)
    assert (np.abs(parts.matrix - whole.matrix) / rows(whole.matrix)).max() < 1e-11
