"""Continuous controllers against closed forms, independent integration and open-loop matrices."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sebody import (
    InputError,
    Model,
    Simulation,
    SimulationError,
    Tolerance,
    simulate,
)
from sebody.analysis import Ensemble, equilibrium, resume, save_state
from sebody.control import discrete, linear, state_feedback
from sebody.fem import StiffnessSection

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
SHIFT = np.array([2.0, -1.0, 0.5])
SECTION = StiffnessSection(axial=1e4, bending_y=3.0, bending_z=2.0, torsion=1.5, mass=1.0,
                           inertia_x=0.02, inertia_y=0.01, inertia_z=0.01)
J = 0.1


def rotor(start=0.0, **options):
    """A rotor on a hinge with a motor."""
    model = Model(planar=True)
    hub = model.node("hub", (0.3, -0.2))
    model.rigid_body("rotor", hub, 1.0, J)
    model.revolute(hub, name="hinge")
    if start:
        model.initial_velocity(hub, angular=start)
    model.actuator("motor", joint="hinge", **options)
    return model


def filtered(t, y, x, rates, u, parameters):
    """A filtered angle, the integral of its error, and a nonlinear law."""
    rates[0] = (y[0] - x[0]) / parameters[0]
    rates[1] = x[0] - 0.3
    u[0] = -2.0 * (x[0] - 0.3) - 0.5 * x[1] - 0.4 * np.sin(y[1])


def with_filter():
    model = rotor(0.5)
    model.controller("loop", filtered, ["hub.rotation", "hinge.rate"], ["motor"],
                     states=[0.1, 0.0], parameters=[0.2])
    return model


def exact_filter(t):
    def rates(t, z):
        angle, rate, x, integral = z
        torque = -2.0 * (x - 0.3) - 0.5 * integral - 0.4 * np.sin(rate)
        return rate, torque / J, (angle - x) / 0.2, x - 0.3
    return solve_ivp(rates, (0.0, 2.0), (0.0, 0.5, 0.1, 0.0), rtol=1e-11, atol=1e-12, t_eval=t,
                     method="DOP853").y


def test_states_are_of_second_order():
    """Angle and states, against DOP853."""
    errors = []
    for h in (0.02, 0.01):
        result = simulate(with_filter(), h, 2.0)
        exact = exact_filter(result.t)
        errors.append([np.abs(result["hub.rotation"] - exact[0]).max(),
                       np.abs(result["loop.states"] - exact[2:].T).max()])
    ratio = np.array(errors[0]) / errors[1]
    assert np.all((ratio > 3.8) & (ratio < 4.2)) and np.max(errors[1]) < 2e-4
    # the input is that of the same instant, not of a step before
    torque = -2 * (exact[2] - 0.3) - 0.5 * exact[3] - 0.4 * np.sin(exact[1])
    assert_allclose(result["motor.value"], torque, rtol=0, atol=1e-3)
    assert result.iterations_per_step < 2.5


def test_variable_steps_interpolate_what_is_set():
    """On an output grid that steps do not meet, what is set is of the same instant, too."""
    result = Simulation(with_filter(), 0.05, tolerance=Tolerance(1e-7)).run_to(2.0).result()
    exact = exact_filter(result.t)
    torque = -2 * (exact[2] - 0.3) - 0.5 * exact[3] - 0.4 * np.sin(exact[1])
    assert_allclose(result["hub.rotation"], exact[0], rtol=0, atol=1e-4)
    assert_allclose(result["motor.value"], torque, rtol=0, atol=2e-3)


@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-6)])
def test_a_law_may_jump_at_corners(tolerance):
    """The reference jumps at 0.533, within a step; the motion is that of the two pieces."""
    def law(t, y, x, rates, u, parameters):
        u[0] = 2.0 * ((0.0 if t < 0.533 else 1.0) - y[0]) - 0.4 * y[1]
    errors = []
    for h in (0.02, 0.01):
        model = rotor()
        model.controller("loop", law, ["hinge.angle", "hinge.rate"], ["motor"], corners=[0.533])
        result = Simulation(model, h, tolerance=tolerance).run_to(2.0).result()
        d, w = 2.0, 4.0                     # s^2 + 4 s + 20
        t = np.maximum(result.t - 0.533, 0.0)
        exact = 1 - np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))
        errors.append(np.abs(result["hub.rotation"] - exact).max())
    assert errors[1] < 1e-3
    assert tolerance or 3.6 < errors[0] / errors[1] < 4.4


def test_angles_count_turns():
    """A spring of the law that a rotor winds up by several turns."""
    space = Model()
    hub = space.node("hub", (0.1, 0.2, 0.3))
    space.rigid_body("rotor", hub, 1.0, np.diag([0.1, 0.2, 0.15]))
    space.revolute(hub, axis=(0.6, 0.0, 0.8), name="hinge")
    space.actuator("motor", joint="hinge")
    space.initial_velocity(hub, angular=(0.6 * 20, 0.0, 0.8 * 20))

    def law(t, y, x, rates, u, parameters):
        u[0] = -0.1 * y[0]
    space.controller("loop", law, ["hinge.angle"], ["motor"])
    result = simulate(space, 2e-3, 3.0)
    inertia = 0.36 * 0.1 + 0.64 * 0.15
    w = np.sqrt(0.1 / inertia)
    assert_allclose(result["hinge.angle"], 20 / w * np.sin(w * result.t), rtol=0, atol=1e-3)
    assert result["hinge.angle"].max() > 3 * 2 * np.pi


def test_sampled_and_continuous_together():
    """A sampled reference that a continuous law follows: of second order, jumps included."""
    def steps(t, y, x, u, parameters):
        x[0] += 1.0
        u[0] = 0.1 * x[0]

    def follows(t, y, x, rates, u, parameters):
        u[0] = 2.0 * (y[1] - y[0]) - 0.4 * y[2]
    errors = []
    for h in (0.02, 0.01):
        model = rotor()
        model.controller("steps", steps, [], ["wanted"], period=0.1, states=[0.0])
        model.controller("loop", follows, ["hub.rotation", "wanted", "hinge.rate"], ["motor"])
        result = simulate(model, h, 1.0)
        exact = np.zeros(len(result.t))
        for k in range(11):             # superposed steps of 0.1 at every sample
            t = np.maximum(result.t - 0.1 * k, 0.0)
            exact += 0.1 * (1 - np.exp(-2 * t) * (np.cos(4 * t) + 0.5 * np.sin(4 * t)))
        errors.append(np.abs(result["hub.rotation"] - exact).max())
    assert errors[1] < 1e-4 and 3.6 < errors[0] / errors[1] < 4.4


def test_saved_resumed_and_in_ensembles(tmp_path):
    """The same bits; copies of an ensemble equal single runs."""
    whole = Simulation(with_filter(), 0.01).run_to(1.0)
    half = Simulation(with_filter(), 0.01).run_to(0.5)
    save_state(half, tmp_path / "half.npz")
    again = resume(with_filter(), tmp_path / "half.npz").run_to(1.0)
    for name in ("hub.rotation", "loop.states", "motor.value", "motor.work"):
        assert_array_equal(again.result()[name][-1], whole.result()[name][-1])
    speeds = np.array([0.5, -0.7])
    found = Ensemble(with_filter(), 0.01).run({"hub.angular_velocity": speeds[:, None]}, 1.0, {
        "angle": "hub.rotation", "torque": "motor.value", "states": "loop.states"})
    for name, quantity in (("angle", "hub.rotation"), ("torque", "motor.value"),
                           ("states", "loop.states")):
        assert_allclose(found[name][0], whole.result()[quantity], rtol=0, atol=1e-14)
        assert np.abs(found[name][1] - found[name][0]).max() > 0.1


def test_an_equilibrium_holds_laws_without_states():
    """A motor that acts as a spring holds an arm: ``k angle = m g l cos angle``."""
    model = Model(planar=True)
    hub = model.node("hub", (0.0, 0.0))
    model.rigid_body("rotor", hub, 1.0, J)
    model.point_mass("load", model.attach("tip", (0.5, 0.0), to=hub), 0.2)
    model.revolute(hub, name="hinge")
    model.gravity((0.0, -9.81))
    model.actuator("motor", joint="hinge")
    model.controller("loop", state_feedback([[3.0]]), ["hinge.angle"], ["motor"])
    angle = equilibrium(model)["hinge.angle"][-1]
    assert -3.0 * angle == pytest.approx(0.2 * 9.81 * 0.5 * np.cos(angle), abs=1e-9)


def refused(message, *arguments, build=rotor, **options):
    model = build()
    with pytest.raises(InputError, match=message):
        model.controller("loop", *arguments, **options)
    assert "loop" not in model.controllers and all(load.law is None for load in model.loads)


@pytest.mark.parametrize("name, message", [
    ("hinge.force.x", "controller 'loop' is continuous and cannot read 'hinge.force.x': .*rate="),
    ("hub.acceleration.x", "cannot read 'hub.acceleration.x'.*rate="),
    ("energy.kinetic", "cannot read 'energy.kinetic'.*rate="),
    ("motor.power", "cannot read 'motor.power'.*rate="),
    ("hub.position", "controller 'loop' reads 'hub.position', which is several numbers: give one"),
    ("hub.positoin.x", "controller 'loop': 'hub.positoin.x' is unknown: did you mean")])
def test_inputs_that_are_no_motion_are_refused_at_the_run(name, message):
    model = rotor()
    model.controller("loop", state_feedback([[1.0]]), [name], ["motor"])
    with pytest.raises(InputError, match=message):
        Simulation(model, 0.01)


def test_what_is_refused():
    """In words, with a remedy, and nothing is left in the model."""
    law = state_feedback([[1.0]])
    refused("discrete time: give period=", discrete(0.5, 1.0, 1.0, 0.0), ["hub.rotation"],
            ["motor"])
    refused("continuous time.*leave out period=", linear(-0.5, 1.0, 1.0, 0.0), ["hub.rotation"],
            ["motor"], period=0.1)
    refused("delay of 2 samples and no period", law, ["hub.rotation"], ["motor"], delay=2)
    refused("has a lag.*state of the law", law, ["hub.rotation"], ["motor"],
            build=lambda: rotor(lag=0.1))
    refused("has a largest rate", law, ["hub.rotation"], ["motor"], build=lambda: rotor(rate=2.0))
    refused(r"cannot be compiled: write a function \(t, y, x, rates, u, parameters\)",
            lambda t, y, x, rates, u, parameters: "a" + 1, ["hub.rotation"], ["motor"])
    refused(r"is that of a sampled one, .*: give period=.*function of \(t, y, x, rates",
            lambda t, y, x, u, parameters: None, ["hub.rotation"], ["motor"])
    model = rotor()
    model.sensor("noisy", "hub.rotation", noise=0.1)
    with pytest.raises(InputError, match="noise has no rate"):
        model.controller("loop", law, ["noisy"], ["motor"])
    model.controller("first", law, ["hub.rotation"], ["signal"])
    with pytest.raises(InputError, match="both are continuous"):
        model.controller("loop", law, ["signal"], ["motor"])
    with pytest.raises(InputError, match="has states, which an equilibrium"):
        equilibrium(with_filter())


def test_a_fault_keeps_what_was_computed():
    """The law has no value from the time 0.5 on; the run says so and what it was given."""
    def law(t, y, x, rates, u, parameters):
        u[0] = np.sqrt(0.5 - t) - y[0]
    model = rotor()
    model.controller("loop", law, ["hub.rotation"], ["motor"])
    with pytest.raises(SimulationError, match="controller 'loop' gave") as error:
        simulate(model, 0.01, 1.0)
    assert error.value.result.t[-1] == pytest.approx(0.5, abs=0.011)
