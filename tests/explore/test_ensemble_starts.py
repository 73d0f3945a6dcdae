"""Runs of an ensemble that begin with other velocities, and drives with waves."""

import numpy as np
import pytest
from lane_models import linkage, single
from noise import TRIALS, spread
from numpy.testing import assert_allclose

from sebody import Model, Simulation, generalized_alpha, harmonic, ramp, simulate
from sebody.analysis import Ensemble, final
from sebody.control import pid
from sebody.parameters.table import handle

H, T_END = 2e-3, 0.03


def pushed_apart(mass: float = 1.0) -> Model:
    """Two bodies at rest that a drive moves apart, so that they begin with fitted velocities."""
    model = Model(planar=True)
    direction = np.array([0.6, 0.8])
    for name, point, own in (("a", np.array([1.0, -2.0]), 0.5 * mass),
                             ("b", np.array([1.0, -2.0]) + 2.0 * direction, 0.8)):
        model.rigid_body(f"body {name}", model.node(name, point), own, 0.3 * own)
    model.prismatic("b", direction, to="a", name="rail")
    model.drive_slide("b", ramp(1.5), direction, to="a",
                      name="piston")
    return model


def test_velocities_are_fitted_anew_where_a_mass_changes():
    """They are of least kinetic energy: momentum stays zero, so the lighter body is the faster."""
    factors = [1.0, 0.1, 5.0]
    ensemble = Ensemble(pushed_apart(), H)
    outcome = ensemble.run({"body a.mass": factors}, T_END, {
        "a": "a.velocity", "b": "b.velocity", "place": final("a.position")})
    assert Simulation(pushed_apart(), H).start.changed
    for k, factor in enumerate(factors):
        momentum = 0.5 * factor * outcome["a"][k] + 0.8 * outcome["b"][k]
        assert_allclose(momentum, 0.0, atol=1e-9)
        assert np.linalg.norm(outcome["a"][k][0]) > 0.01
        alone = simulate(pushed_apart(factor), H, T_END)
        assert_allclose(outcome["place"][k], alone["a.position"][-1], rtol=0, atol=1e-9)


@pytest.mark.parametrize("index", [2, 3])
def test_starts_with_other_masses_are_those_of_single_runs(index):
    """Within rounding of places, times the rod's stiffness over its mass: 2e-9 of accelerations.

    Of forces with multipliers of second order 2e-8.
    """
    scheme, made = generalized_alpha(tolerance=1e-13, index=index), linkage()
    given = {"rod.mass": 1.04, "arm.mass": 1.03}
    outputs = {"tip": "tip.acceleration", "elbow": f"{made.joints[-1].name}.force"}
    found = Ensemble(made, H, scheme).run({name: [factor] for name, factor in given.items()},
                                          2 * H, outputs)
    for name, quantity in outputs.items():
        def alone(model, quantity=quantity):
            return single(model, given, H, 2 * H, scheme)[quantity]
        expected = alone(made)
        shifts = np.random.default_rng(3).uniform(-1.0, 1.0, (TRIALS, 2))
        rounded = spread(expected, (alone(linkage(tuple(shift))) for shift in shifts), most=1e-6)
        assert_allclose(found[name][0], expected, rtol=0, atol=rounded.max())


def test_first_samples_are_made_with_the_parameters_of_the_run():
    """The first output of a proportional controller is its own gain times the error at the start.
    """
    made = linkage()
    made.actuator("servo", node="crank", direction=1.0, what="torque")
    made.sensor("place", "tip.position.x")
    made.controller("loop", pid(kp=2.0, reference=1.0), ["place"], ["servo"], 2 * H)
    period, kp, *others = handle(made, "loop.parameters").base
    gains = np.array([0.5, 3.0, 7.0])
    found = Ensemble(made, H).run({"loop.parameters": [[period, gain, *others] for gain in gains]},
                                  T_END, {"servo": "servo.value"})
    error = 1.0 - made.nodes["tip"].point[0]
    assert_allclose(found["servo"][:, 0], gains * error, rtol=1e-12)


@pytest.mark.parametrize("mean", [0.0, 0.3])
def test_the_amplitude_of_a_drive_is_that_of_its_waves_too(mean):
    """A crank that is turned to and fro, and a point that is moved, by twice the amplitude."""
    def cranks(factor: float) -> Model:
        model = Model(planar=True)
        model.node("base", (1.0, 2.0))
        model.rigid_body("crank", "base", 2.0, 0.4, centre=(1.5, 2.2))
        model.revolute("base", name="hinge")
        shift = -mean - 0.2 * np.sin(0.4)       # at the start the drive is where the crank is
        model.drive_angle("base", harmonic(0.2 * factor, 7.0, phase=0.4,
                                           mean=(mean + shift) * factor), name="motor")
        slide = model.node("slide", (4.0, -1.0), keeps="translation")
        model.move(slide, (0.6, 0.8), harmonic(0.5 * factor, 5.0), name="shaker")
        weight = model.node("weight", (4.5, -1.2), keeps="translation")
        model.point_mass("ball", weight, 0.6)
        model.spring(weight, slide, 30.0, damping=0.1)
        return model
    outputs = {"angle": "base.rotation", "torque": "motor.torque", "place": "slide.position",
               "ball": "weight.position"}
    outcome = Ensemble(cranks(1.0), H).run({"motor.amplitude": [1.0, 2.0, -0.5],
                                            "shaker.amplitude": [1.0, 2.0, -0.5]}, T_END, outputs)
    for k, factor in enumerate((1.0, 2.0, -0.5)):
        alone = simulate(cranks(factor), H, T_END)
        for name, quantity in outputs.items():
            assert_allclose(outcome[name][k], alone[quantity], rtol=0,
                            atol=1e-8 * max(1.0, np.abs(alone[quantity]).max()))
    t = alone.t
    assert_allclose(outcome["place"][1], np.array([4.0, -1.0]) + np.outer(
        np.sin(5.0 * t), (0.6, 0.8)), rtol=0, atol=1e-12)
