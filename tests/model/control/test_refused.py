"""Sampled controllers: summaries, faults of a run, and what is refused."""

import numpy as np
import pytest
from controlled_rotor import PERIOD, controlled, rotor

from sebody import InputError, Simulation, SimulationError
from sebody.basics.errors import LimitWarning
from sebody.control import computed_torque, pid, state_feedback


def test_a_model_shows_its_loop():
    model = controlled(2)
    model.sensor("angle", "hinge.angle", rate=50.0, noise=1e-3)
    shown = model.summary().splitlines()
    assert "pid   hub.rotation  motor    0.02      2       4" in shown
    assert "angle  hinge.angle             0.02      0  0.001" in shown
    assert repr(model.controllers["pid"]) == (
        "<Controller 'pid' from hub.rotation to motor: period 0.02, 4 states>")


def raising(t, y, x, u, parameters):
    u[0] = y[0] if t < 0.1 else np.sqrt(y[0] - 10.0)


def test_faults_of_a_run(tmp_path):
    """What was computed is kept; the message names controller, value and time."""
    model = rotor(start=0.1)
    model.controller("root", raising, ["hub.rotation"], ["motor"], PERIOD)
    with pytest.raises(SimulationError, match=r"stopped at t = 0\.1: controller 'root' gave u = "
                       r".*nan.* at t = 0\.1: correct it; results up to this time") as caught:
        Simulation(model, 0.01).run_to(1.0)
    assert caught.value.result["t"][-1] == pytest.approx(0.09, abs=0.011)

    def outside(t, y, x, u, parameters):
        u[3] = 1.0
    model = rotor()
    model.controller("wide", outside, [], ["motor"], PERIOD)
    with pytest.raises(InputError, match="the run cannot begin: controller 'wide' raised "
                       "IndexError: index 3 is out of bounds for axis 0 with size 1"):
        Simulation(model, 0.01)


@pytest.mark.parametrize(("rate", "output", "said"), [
    (np.nan, 1.0, r"gave rates = \[0.5, nan\] at t = 0"),
    (0.0, np.nan, r"gave u = \[nan\] at t = 0"),
    (np.inf, np.nan, r"gave rates = \[0.5, inf\] and u = \[nan\] at t = 0")])
def test_results_of_a_continuous_law_are_named(rate, output, said):
    """Its rates come before what is in u, and are not counted as u."""
    def law(t, y, x, rates, u, parameters):
        rates[0], rates[1], u[0] = 0.5, rate, output
    model = rotor()
    model.controller("law", law, ["hub.rotation"], ["motor"], states=(0.0, 0.0))
    with pytest.raises(InputError, match=f"controller 'law' {said}"):
        Simulation(model, 0.01)


def test_a_misspelt_output_is_named():
    """A name that no actuator has is a signal: one like that of an idle actuator is warned of."""
    def said(sets, **reader):
        model = rotor()
        model.actuator("brake", joint="hinge")
        model.controller("c", state_feedback([[1.0]] * len(sets)), ["hub.rotation"], sets,
                         PERIOD)
        if reader:
            model.controller("d", state_feedback([[1.0]]), **reader, period=PERIOD)
        return [one for one in Simulation(model, 0.01).result().warnings if "did you mean" in one]
    with pytest.warns(LimitWarning, match="controller 'c' sets 'moter', which no actuator is "
                      "called and no controller reads: did you mean 'motor'"):
        assert len(said(["moter"])) == 1
    assert len(said(["motor", "braek"])) == 1
    for quiet in (["motor"], ["motor", "motor_raw"], ["estimate"]):
        assert not said(quiet)
    assert not said(["moter"], inputs=["moter"], outputs=["motor"])


def test_what_is_refused():
    def add(**given):
        model = rotor()
        model.sensor("angle", "hub.rotation")
        options = {"name": "c", "law": pid(1.0), "inputs": ["angle"], "outputs": ["motor"],
                   "period": PERIOD}
        model.controller(**options | given)
        return Simulation(model, 0.01)
    add()
    for given, message in (
            ({"period": 0.015}, "controller 'c' has the period 0.015, which the step 0.01 does not "
             "divide: give a step that does, such as 0.0075"),
            ({"inputs": ["angel"]}, "controller 'c': input 'angel' is unknown: give a sensor"),
            ({"inputs": ["hub.rotatoin"]}, "sensor 'hub.rotatoin': .*did you mean 'hub.rotation'"),
            ({"inputs": ["hub.position"]}, "measures 'hub.position', which is several numbers: "
             "give one of them, such as hub.position.x"),
            ({"outputs": ["motor", "other"]}, "controller 'c' has 2 outputs, but pid has 1"),
            ({"inputs": []}, "controller 'c' has 0 inputs, but pid takes 1 or 2"),
            ({"outputs": ["angle"]}, "output 'angle' is a sensor: name an actuator, or a signal"),
            ({"inputs": ["echo"], "outputs": ["echo"]},
             "algebraic loop: controllers c -> c wait for each other's signals"),
            ({"period": -1.0}, "controller 'c': period is -1"),
            ({"law": lambda t, y: None}, r"controller 'c' has the arguments \(t, y\): give a "
             "function of"),
            ({"law": 3}, "controller 'c' is 3: give a function of"),
            ({"states": [1.0]}, "is given 1 states, and its law has 4"),
            ({"name": "angle"}, "controller 'angle' cannot be called 'angle': a sensor has"),
            ({"name": "hub"}, "cannot be called 'hub': a node has that name"),
            ({"outputs": ["hub"]}, "a signal cannot be called 'hub': a node has that name"),
            ({"outputs": ["hinge"]}, "a signal cannot be called 'hinge': a joint has that")):
        with pytest.raises(InputError, match=message):
            add(**given)
    model = rotor()
    model.controller("a", state_feedback([[1.0]]), ["q"], ["p"], PERIOD)
    with pytest.raises(InputError, match="algebraic loop: controllers a -> b -> a wait for each "
                       "other's signals in the same sample; give one of them delay=1"):
        model.controller("b", state_feedback([[1.0]]), ["p"], ["q"], PERIOD)
    model.controller("b", state_feedback([[1.0]]), ["p"], ["q"], PERIOD, delay=1)
    model.controller("m", state_feedback([[1.0]]), ["p"], ["motor"], PERIOD)
    with pytest.raises(InputError, match="controller 'n' sets 'motor', which controller 'm' sets"):
        model.controller("n", state_feedback([[1.0]]), ["p"], ["motor"], PERIOD)
    run = Simulation(model, 0.01)
    for call, message in ((lambda: run.set_input("moter", 1.0), "input 'moter' is unknown: use "
                           "'motor'"),
                          (lambda: run.set_input("motor", np.nan), "input 'motor' is nan"),
                          (lambda: run.read("tip"), "'tip' is unknown")):
        with pytest.raises(InputError, match=message):
            call()
    for given, message in (
            ({"joint": "hing"}, "joint 'hing' is unknown: did you mean 'hinge'|'hing' is unknown"),
            ({}, "acts on nothing, or on several things: give joint="),
            ({"node": "hub"}, "has no direction: give direction="),
            ({"joint": "hinge", "limit": -1.0}, "limit is -1"),
            ({"joint": "hinge", "limit": 1.0, "start": 2.0}, "start is 2.*give one from -1 to 1"),
            ({"between": ("hub", "hub")}, "node 'hub' is joined to itself"),
            ({"node": "hub", "direction": (1.0, 0.0), "inertia": 1.0}, "no rotor turns with")):
        with pytest.raises(InputError, match=message):
            rotor().actuator("a", **given)


def _arm(*arguments):
    """Two functions of an arm that is never run."""


@pytest.mark.parametrize("make, message", [
    (lambda: state_feedback([[1.0], [1.0, 2.0]]), "state_feedback: gain is .*: give a row for each "
                                                  "output, with a gain for each input"),
    (lambda: state_feedback([]), r"state_feedback: gain is \[\]: give a row for each output"),
    (lambda: state_feedback([[np.nan]]), "state_feedback: gain has the entry nan"),
    (lambda: computed_torque(_arm, _arm, 2, [1.0, 2.0, 3.0], 1.0),
     r"computed_torque: kp is \[1.0, 2.0, 3.0\]: give a number, or 2, one for each joint"),
    (lambda: computed_torque(_arm, _arm, 2, 1.0, [[1.0], [2.0]]), "computed_torque: kd is .*or 2"),
    (lambda: computed_torque(_arm, _arm, 2, np.inf, 1.0), "computed_torque: kp is inf: give a")])
def test_gains_that_fit_no_law(make, message):
    with pytest.raises(InputError, match=message):
        make()
