"""Sensors, their noise and axes, and signals between controllers."""

import numpy as np
import pytest
from controlled_rotor import rotor
from numpy.testing import assert_allclose, assert_array_equal

from sebody import InputError, Model, Simulation
from sebody.control import discrete, lookup, low_pass, state_feedback


def test_noise_is_normal_and_independent():
    model = rotor()
    model.sensor("angle", "hub.rotation", noise=2.0, bias=0.5, seed=3)
    model.sensor("other", "hub.rotation", noise=2.0, seed=4)
    model.controller("none", state_feedback([[0.0, 0.0]]), ["angle", "other"], ["motor"], 0.01)
    result = Simulation(model, 0.01).run_to(100.0).result()
    one, other = result["angle.value"] - 0.5, result["other.value"]
    n = len(one)
    for values in (one, other):     # five standard deviations of the estimates
        assert abs(values.mean()) < 5 * 2.0 / np.sqrt(n)
        assert abs(values.var() / 4.0 - 1) < 5 * np.sqrt(2.0 / n)
        assert abs((values**4).mean() / 16.0 - 3.0) < 5 * np.sqrt(96.0 / n)
        assert abs((values[1:] * values[:-1]).mean() / 4.0) < 5 / np.sqrt(n)
    assert abs((one * other).mean() / 4.0) < 5 / np.sqrt(n)


def two_rates(model):
    """A filter, a table and a compensator between sensor and motor, of three periods."""
    model.controller("filter", low_pass(5.0), ["hub.rotation"], ["smooth"], 0.01)
    model.controller("table", lookup([-1.0, 0.0, 1.0], [-3.0, 0.0, 1.0]), ["smooth"], ["pull"],
                     0.02)
    model.controller("lead", discrete([[0.5]], [[1.0]], [[-0.2]], [[-1.0]]), ["pull"], ["motor"],
                     0.04)


def test_signals_pass_between_controllers():
    """In the order of the signals, whatever the order of creation; against a loop in Python."""
    from scipy.signal import butter, tf2ss

    model = rotor(start=0.7)
    two_rates(model)
    result = Simulation(model, 0.01).run_to(1.0).result()
    A, B, C, D = tf2ss(*butter(2, 2 * 5.0 * 0.01))
    x, z, angle, speed = np.zeros(2), 0.0, 0.0, 0.7
    smooth = pull = torque = 0.0
    for k in range(101):
        smooth = float((C @ x + D[0] * angle)[0])
        x = A @ x + B[:, 0] * angle
        if k % 2 == 0:
            pull = float(np.interp(smooth, [-1.0, 0.0, 1.0], [-3.0, 0.0, 1.0]))
        if k % 4 == 0:
            torque = -0.2 * z - pull
            z = 0.5 * z + pull
        assert_allclose([result["hub.rotation"][k], result["smooth.value"][k],
                         result["pull.value"][k], result["motor.value"][k]],
                        [angle, smooth, pull, torque], rtol=0, atol=1e-13)
        angle += 0.01 * speed + 0.5e-4 * torque / 0.1
        speed += 0.01 * torque / 0.1


def test_sensors_of_any_quantity():
    """Compiled channels and those Python reads give what the result has."""
    model = rotor(True, start=0.3)
    names = ["tip.position.y", "tip.velocity.x", "hub.angular_velocity", "hinge.angle",
             "hinge.rate", "beam.modes.1", "beam.mode_rates.0", "energy.kinetic",
             "hinge.force.x", "tip.position.norm"]
    model.controller("none", state_feedback(np.zeros((1, len(names)))), names, ["motor"], 0.02)
    run = Simulation(model, 0.01)
    run.run_to(0.2)
    result = run.result()
    for name in names:
        assert_allclose(run.read(name), result[name][-1], rtol=1e-14, atol=1e-18)
        # forces are those before the sample's restart, of the last iterate
        assert_allclose(result[f"{name}.value"][-1], result[name][-1], rtol=1e-6, atol=1e-9)
    assert_array_equal(run.read("tip.position"), result["tip.position"][-1])


@pytest.mark.parametrize("planar", [False, True])
def test_sensors_in_axes_of_a_node(planar):
    """Accelerometer and force sensor that turn with a body, compiled and by Python."""
    model = Model(planar=planar)
    size = 2 if planar else 3
    body = model.node("body", np.array([0.3, 0.1, -0.2])[:size])
    model.rigid_body("mass", body, 2.0, 0.3 if planar else np.diag([0.3, 0.4, 0.2]))
    model.attach("tip", np.array([0.8, 0.4, 0.1])[:size], body)
    model.rigid_velocity(np.array([0.4, -1.0, 0.3])[:size], 3.0 if planar else (2.0, 1.0, -3.0))
    model.gravity(np.array([0.0, -9.81, 0.0])[:size])
    model.actuator("push", node=body, direction=np.eye(size)[0])
    names = []
    for k, label in enumerate("xyz"[:size]):
        model.sensor(f"a{k}", f"tip.acceleration.{label}", axes="body")
        model.sensor(f"f{k}", f"body.position.{label}", axes="tip", rate=50.0)
        model.sensor(f"p{k}", f"push.force.{label}", axes=body)
        names += [f"a{k}", f"f{k}", f"p{k}"]
    model.controller("none", state_feedback(np.zeros((1, len(names))), offset=[1.7]), names,
                     ["push"], 0.02)
    result = Simulation(model, 0.01).run_to(0.3).result()
    R = result["body.rotation"]
    if planar:
        R = np.array([[[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]] for a in R])
    for k in range(size):
        for sensor, name in (("a", "tip.acceleration"), ("f", "body.position"),
                             ("p", "push.force")):
            expected = np.einsum("nji,nj->ni", R, result[name])[1:, k]
            assert_allclose(result[f"{sensor}{k}.value"][2::2], expected[1::2], rtol=1e-6,
                            atol=1e-6)
    with pytest.raises(InputError, match="has axes and measures 'energy.kinetic': name a compon"):
        model.sensor("e", "energy.kinetic", axes="body")
