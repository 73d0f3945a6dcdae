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
    generalized_alpha,
    simulate,
)
from sebody.analysis import Ensemble, equilibrium, modes, resume, save_state, state_space
from sebody.control import discrete, linear, state_feedback
from sebody.fem import StiffnessSection, straight_beam
from sebody.reduction import craig_bampton

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


# -- in general position -------------------------------------------------------------------------
SENSED = ("base.angle", "elbow.angle", "elbow.rate", "tip.velocity.x", "tip.angular_velocity.y",
          "beam.modes.0", "beam.mode_rates.1", "end.position.z", "slide.displacement",
          "groove.displacement", "groove.speed")
MOTORS = ("base motor", "elbow motor", "rope", "wind", "thrust")
GAIN = np.random.default_rng(3).uniform(-1.0, 1.0, (5, 11))
INNER = np.array([[-3.0, 1.0], [0.5, -4.0]])        # of the law's own states
ENTERS, LEAVES = (np.random.default_rng(4).uniform(-1.0, 1.0, shape) for shape in ((2, 11), (5, 2)))


def mechanism(start=None):
    """A flexible arm, a rigid one with a rigid link, and a slide: turned, shifted, moving."""
    model = Model()

    def node(name, *point, **options):
        return model.node(name, SHIFT + TURN @ point, **options)
    root, tip, arm = node("root", 0, 0, 0), node("tip", 1, 0, 0), node("arm", 1, 0, 0)
    car = node("car", -0.5, 0.2, 0.4, keeps="translation")
    reduced = craig_bampton(straight_beam(root.point, tip.point, SECTION, elements=4),
                            [(0, "full"), (4, "full")], modes=3)
    model.superelement("beam", reduced, [root, tip])
    model.rigid_body("forearm", arm, 0.7, np.diag([0.02, 0.03, 0.025]))
    end = model.attach("end", SHIFT + TURN @ (1.2, 0.7, 0.3), to="arm")
    model.point_mass("load", end, 0.3)
    model.point_mass("car", car, 1.3)
    axis = TURN @ (0.3, 0.5, 0.8)
    model.revolute(root, axis=axis, name="base")
    model.revolute(arm, to=tip, axis=TURN @ (0.0, 0.6, 0.8), name="elbow")
    model.slider(car, axis=TURN @ (0.8, 0.0, 0.6), name="slide")
    bead = node("bead", 1.25, 0.35, -0.2, keeps="translation")
    model.point_mass("bead", bead, 0.2)
    model.slider(bead, to=arm, axis=TURN @ (0.5, 0.7, -0.4), name="groove")
    model.rigid_velocity((0.0, 0.0, 0.0), 0.9 * axis, about=root.point,
                         nodes=["root", "tip", "arm", "end", "bead"])
    values = np.zeros(5) if start is None else start
    model.actuator("base motor", joint="base", ratio=2.0, start=values[0])
    model.actuator("elbow motor", joint="elbow", start=values[1])
    model.actuator("rope", between=("end", "car"), start=values[2])
    model.actuator("wind", node="tip", direction=(0.2, -1.0, 0.4), start=values[3])
    model.actuator("thrust", joint="groove", start=values[4])
    model.torque("tip", (1.0, 0.0, 0.0), 0.0, name="push")
    return model


def test_the_closed_loop_of_a_mechanism():
    """Matrices of the closed loop are ``A + B K C`` and so on of the open one.

    The open-loop matrices come from the actuators' pushes and from differences of the results'
    quantities, the closed ones from the law's own tangents.
    """
    offset = np.array([0.7, -0.4, 0.5, 0.3, -0.6])
    open_loop = state_space(Simulation(mechanism(offset), 1e-3), MOTORS, SENSED)
    y0 = open_loop.values

    def law(t, y, x, rates, u, parameters):
        for i in range(5):
            u[i] = offset[i]
            for j in range(11):
                gap = y[j] - y0[j]
                u[i] += parameters[0] * GAIN[i, j] * (gap + parameters[1] * gap**3)
            for j in range(2):
                u[i] += LEAVES[i, j] * x[j]
        for i in range(2):
            for j in range(11):
                rates[i] += ENTERS[i, j] * (y[j] - y0[j])
            for j in range(2):
                rates[i] += INNER[i, j] * x[j]
    model = mechanism(offset)
    model.controller("loop", law, SENSED, MOTORS, states=np.zeros(2),
                     parameters=[1.0, 3.0])
    run = Simulation(model, 1e-3)
    closed = state_space(run, ["push"], ["loop.states", *SENSED])
    A, B, C = open_loop[:3]
    names = [*open_loop.states, "loop.states.0", "loop.states.1"]
    order = [closed.states.index(name) for name in names]
    expected = np.block([[A + B @ GAIN @ C, B @ LEAVES], [ENTERS @ C, INNER]])
    # relative to the fastest pole: what differences leave of the readings
    assert_allclose(closed.A[np.ix_(order, order)], expected, rtol=0,
                    atol=1e-8 * np.abs(expected).max())
    assert_allclose(closed.C[2:, order[:len(A)]], C, rtol=0, atol=1e-8 * np.abs(C).max())
    found, values = modes(run).values, np.linalg.eigvals(expected)
    assert len(found) == np.sum(values.imag >= 0)
    for value in found:
        assert np.abs(values - value).min() < 1e-6 * np.abs(values).max()
    # T is that of long steps: the iteration converges as without the law
    plain = Simulation(mechanism(offset), 0.01).run_to(0.2).result()
    weak = mechanism(offset)
    weak.controller("loop", law, SENSED, MOTORS, states=np.zeros(2),
                    parameters=[0.02, 0.0])
    result = Simulation(weak, 0.01).run_to(0.2).result()
    assert result.iterations_per_step < plain.iterations_per_step + 1.0


def test_a_law_equals_springs_and_dampers():
    """Torques of a joint between two moving bodies, against the kernel of torsion springs."""
    def law(t, y, x, rates, u, parameters):
        u[0] = -parameters[0] * y[0] - parameters[1] * y[1]

    def derivatives(t, y, x, D, parameters):
        D[0, 0], D[0, 1] = -parameters[0], -parameters[1]
    found = []
    for case in range(3):
        model = mechanism()
        if case == 0:
            model.torsion_spring("arm", to="tip", axis=TURN @ (0.0, 0.6, 0.8), stiffness=4.0,
                                 damping=0.3)
        else:
            model.controller("loop", law, ["elbow.angle", "elbow.rate"], ["elbow motor"],
                             parameters=[4.0, 0.3],
                             derivatives=derivatives if case == 2 else None)
        model.gravity((0.0, -9.81, 0.0))
        found.append(simulate(model, 2e-3, 0.6, generalized_alpha(tolerance=1e-12)))
    for name in ("end.position", "tip.velocity", "elbow.moment"):
        for own in found[1:]:
            # reactions are left with some thousand times the tolerance of the increments
            assert_allclose(own[name], found[0][name], rtol=0,
                            atol=1e-7 * np.abs(found[0][name]).max())
    assert abs(found[1].iterations_per_step - found[0].iterations_per_step) < 0.3
    work = found[1]["elbow motor.work"][-1]
    assert work == pytest.approx(-np.trapezoid(
        found[1]["elbow motor.value"] * -found[1]["elbow.rate"], found[1].t), rel=1e-3)


@pytest.mark.parametrize("planar", [True, False])
def test_a_sensor_in_axes_that_turn(planar):
    """Velocity in the axes of a hinged node, against a law that turns it by the angle itself."""
    e = np.array((0.0, 0.0, 1.0)) if planar else TURN @ (0.48, 0.6, 0.64)

    def turns(t, y, x, rates, u, parameters):
        u[0] = 0.5 - 0.8 * y[0]

    def by_angle(t, y, x, rates, u, parameters):
        c, s = np.cos(y[0]), np.sin(y[0])
        v = y[1:]
        across = e[1] * v[2 % v.size] * (v.size == 3) - e[2] * v[1]
        along = e[0] * v[0] + e[1] * v[1] + (e[2] * v[2 % v.size] if v.size == 3 else 0.0)
        u[0] = 0.5 - 0.8 * (c * v[0] - s * across + (1 - c) * along * e[0])
    found, matrices = [], []
    for own in (True, False):
        model = Model(planar=planar)
        size = model.dimension
        hub = model.node("hub", SHIFT[:size])
        tip = model.attach("tip", SHIFT[:size] + np.array((0.6, -0.5, 0.7))[:size], to=hub)
        model.rigid_body("arm", hub, 1.0, J if planar else np.diag([0.1, 0.2, 0.15]))
        model.point_mass("load", tip, 0.4)
        model.revolute(hub, **({} if planar else {"axis": e}), name="hinge")
        model.actuator("motor", joint="hinge")
        model.torque(hub, 1.0 if planar else e, 0.0, name="push")
        model.sensor("own", "tip.velocity.x", axes="hub")
        inputs = ["own"] if own else ["hinge.angle", *(f"tip.velocity.{i}" for i in "xyz"[:size])]
        model.controller("loop", turns if own else by_angle, inputs, ["motor"])
        found.append(Simulation(model, 0.01).run_to(1.5))
        matrices.append(state_space(found[-1], "push", "hinge.angle").A)
    rows = [run.result() for run in found]
    assert np.ptp(rows[0]["hinge.angle"]) > 0.5
    assert_allclose(rows[0]["tip.position"], rows[1]["tip.position"], rtol=0, atol=1e-7)
    assert_allclose(matrices[0], matrices[1], rtol=0, atol=1e-6 * np.abs(matrices[0]).max())


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


# -- with everything else -------------------------------------------------------------------------
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


def test_what_is_refused():
    """In words, with a remedy, and nothing is left in the model."""
    law = state_feedback([[1.0]])
    refused("cannot read 'hinge.force.x'.*rate=", law, ["hinge.force.x"], ["motor"])
    refused("cannot read 'hub.acceleration.x'.*rate=", law, ["hub.acceleration.x"], ["motor"])
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
