"""Gradients that are refused, and runs that fail, with what to do."""

import differentiated as scenes
import pytest

from sebody import InputError, SimulationError
from sebody.analysis import final, gradient
from sebody.gradients import segments


@pytest.mark.parametrize(("objectives", "parameters", "words"), [
    ({"x": final("tip.position")}, ["torque.amplitud"], "torque.amplitude"),
    ({"x": final("tip.position")}, [], "parameters are missing"),
    ({"x": final("tip.position")}, ["gravity.y", "gravity"], "given twice"),
    ({"x": final("tip.position")}, ["beam.mass.x"], "beam.mass has one number"),
    ({"x": final("tip.position")}, ["beam.reduced"], "whole bodies"),
    ({"x": "tip.position"}, ["gravity"], "is a history: give final"),
    ({}, ["gravity"], "objectives is {}: give a dict such as"),
    ({"x": final("torque.work")}, ["gravity"], "give the integral of a power"),
    ({"x": final("top.position")}, ["gravity"], "top"),
])
def test_refused(objectives, parameters, words):
    with pytest.raises(InputError, match=words):
        gradient(scenes.hinged(), 0.01, 0.05, objectives, parameters)


def test_a_maximum_is_refused_with_what_to_take():
    from sebody.analysis import maximum

    with pytest.raises(InputError, match="soft_maximum"):
        gradient(scenes.hinged(), 0.01, 0.05, {"x": maximum("tip.position")}, ["gravity"])


def test_features_without_exact_derivatives_are_refused_by_name():
    m = scenes.hinged("b", frame="mean")
    with pytest.raises(InputError, match="'beam': frame 'mean'.*converged_mean"):
        gradient(m, 0.01, 0.05, {"x": final("tip.position")}, ["gravity"])
    with pytest.raises(InputError, match="not unique.*force or moment"):
        gradient(scenes.four_bar(), 0.01, 0.05, {"x": final("A.multipliers")}, ["gravity.x"])
    m = scenes.hinged()
    with pytest.raises(InputError, match="not a multiple of the step"):
        gradient(m, 0.01, 0.055, {"x": final("tip.position")}, ["gravity"])


def test_sensors_are_refused_with_the_quantity_to_take():
    m = scenes.hinged("b", modes=2)
    m.sensor("encoder", "hinge.angle", rate=100.0)
    with pytest.raises(InputError, match="sensor 'encoder'.*'hinge.angle' itself"):
        gradient(m, 0.01, 0.05, {"x": final("encoder.value")}, ["gravity"])


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
@pytest.mark.parametrize("states", [segments.STATES, 1.0])
def test_a_run_that_fails_says_where_and_keeps_what_it_computed(states, monkeypatch):
    """Of segments of two steps, too."""
    monkeypatch.setattr(segments, "STATES", states)
    m = scenes.hinged("b", modes=2)
    m.torque("base", 1e6 * scenes.Z, [(0, 0), (0.06, 0), (0.1, 1)], name="blow")
    with pytest.raises(SimulationError, match="stopped at t = 0.06") as caught:
        gradient(m, 0.02, 1.0, {"tip": final("tip.position")}, ["beam.mass"])
    assert caught.value.result["t"] == pytest.approx([0.0, 0.02, 0.04, 0.06])
