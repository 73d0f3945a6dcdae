"""Actuators against other models of the same: pairs of torques, gears, closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation, generalized_alpha
from sebody.analysis import resume, save_state
from sebody.control import state_feedback
from sebody.model.variants import copied

TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()
AXIS = TURN @ (0.2, -0.4, 1.0) / np.linalg.norm((0.2, -0.4, 1.0))


def bodies(**start):
    """Two bodies in space that share a hinge, both free to move."""
    model = Model()
    a, b = model.node("a", TURN @ (0.1, 0.2, 0.3)), model.node("b", TURN @ (0.1, 0.2, 0.3))
    model.rigid_body("one", a, 2.0, TURN @ np.diag([0.2, 0.3, 0.4]) @ TURN.T)
    model.rigid_body("other", b, 3.0, np.diag([0.5, 0.3, 0.6]))
    model.revolute(a, axis=AXIS, to=b, name="hinge")
    model.rigid_velocity(TURN @ (0.3, 0.1, -0.2), TURN @ (0.4, 0.9, -0.3), about=TURN @ (0, 0, 1.0))
    return model


def test_a_motor_in_a_hinge_is_a_pair_of_torques():
    """Equal and opposite, about the axis as it moves; momentum stays, work becomes energy."""
    motor, pair = bodies(), bodies()
    motor.actuator("motor", joint="hinge", start=0.7)
    for node, sign in (("a", 1.0), ("b", -1.0)):
        pair.torque(node, sign * 0.7 * AXIS, follower=True)
    found, expected = (Simulation(model, 2e-3, generalized_alpha(tolerance=1e-10)).run_to(1.0)
                       .result() for model in (motor, pair))
    for name in ("a.rotation", "b.rotation", "a.position"):
        # the axis of one follows body a alone, that of the pair both: constraints of 1e-12
        assert_allclose(found[name], expected[name], rtol=0, atol=1e-9)
    assert np.abs(found["hinge.angle"]).max() > 1.0
    assert_allclose(found["angular_momentum"], found["angular_momentum"][[0]] * np.ones((501, 1)),
                    rtol=0, atol=1e-5)      # as the scheme keeps it, of second order
    energy = found["energy.kinetic"] - found["energy.kinetic"][0]
    assert_allclose(found["motor.work"], energy, atol=1e-5)
    assert_allclose(found["motor.work"], 0.7 * found["hinge.angle"], atol=1e-5)
    along = np.einsum("ni,nij,j->n", found["hinge.moment"], found["a.rotation"], AXIS)
    assert np.abs(along).max() < 1e-9       # the joint itself exerts no moment about its axis


def test_a_rotor_turns_with_its_gear():
    """A motor with a rotor against a rotor of its own on the axis, held to the gear by torques.

    Of a carrier that spins, by the equations of two coaxial bodies: J the rotor's inertia, n the
    ratio, ``(J_a + n^2 J) u'' + (J_a + n J) w' = n f``, ``(J_a + J_b) w' + (J_a + n J) u'' = 0``.
    """
    J, ratio, J_a, J_b, torque = 0.01, -7.0, 0.3, 0.8, 0.4
    model = Model()
    a, b = model.node("a", (0.0, 0.0, 0.0)), model.node("b", (0.0, 0.0, 0.0))
    # inertia about the axis alone matters: both turn about it
    for name, node, size in (("one", a, J_a), ("other", b, J_b)):
        model.rigid_body(name, node, 1.0, np.eye(3) * size)
    model.revolute(a, axis=AXIS, to=b, name="hinge")
    model.rigid_velocity((0, 0, 0), 0.7 * AXIS)
    model.actuator("motor", joint="hinge", inertia=J, ratio=ratio, start=torque)
    result = Simulation(model, 1e-3).run_to(0.5).result()
    M = np.array([[J_a + ratio**2 * J, J_a + ratio * J], [J_a + ratio * J, J_a + J_b]])
    u, w = np.linalg.solve(M, [ratio * torque, 0.0])
    t = result["t"]
    assert_allclose(result["hinge.rate"], u * t, atol=1e-9)
    assert_allclose(result["b.angular_velocity"] @ AXIS, 0.7 + w * t, atol=1e-9)
    assert result.energy_balance() < 1e-9


def test_gyroscopic_moment_of_a_rotor():
    """A carrier about a fixed axis normal to the motor's: the rotor's momentum turns with it.

    The spinning rotor's moment ``J n u' w`` is about the third axis, where the hinge carries it.
    """
    J, ratio, speed, spin = 0.02, 5.0, 30.0, 2.0
    model = Model()
    a, b = model.node("a", (0.0, 0.0, 0.0)), model.node("b", (0.0, 0.0, 0.0))
    model.rigid_body("wheel", a, 1.0, np.eye(3) * 1e-3)
    model.rigid_body("carrier", b, 1.0, np.eye(3))
    model.revolute(a, axis=(1.0, 0.0, 0.0), to=b, name="hinge")
    model.revolute(b, axis=(0.0, 0.0, 1.0), name="base")
    model.initial_velocity(b, angular=(0.0, 0.0, spin))
    model.initial_velocity(a, angular=(speed, 0.0, spin))
    model.actuator("motor", joint="hinge", inertia=J, ratio=ratio)
    result = Simulation(model, 1e-4).run_to(0.01).result()
    # momentum about x of rotor and wheel turns with the spin: a moment about y
    expected = (J * ratio * speed + 1e-3 * speed) * spin
    assert_allclose(np.linalg.norm(result["base.moment"][-1]), expected, rtol=2e-4)


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("kind", ["prismatic", "slider", "between", "node"])
def test_a_force_along_an_axis(planar, kind):
    """A mass pushed along a line by each kind of actuator: with a rotor a = n f / (m + n^2 J)."""
    model = Model(planar=planar)
    turn = TURN[:2, :2] / np.linalg.norm(TURN[:2, 0]) if planar else TURN
    e = turn[:, 0] / np.linalg.norm(turn[:, 0])
    size = 2 if planar else 3
    foot = model.node("foot", np.zeros(size))
    mass = model.node("mass", 0.5 * e)
    model.fix(foot)
    model.rigid_body("m", mass, 2.0, 0.1 if planar else 0.1 * np.eye(3))
    ratio, J, force = (1.0, 0.0, 3.0) if kind == "node" else (10.0, 0.03, 0.3)
    if kind == "slider":
        model.slider(mass, axis=e, to=foot, name="rail")
        model.fix(mass, "rotation")
    else:
        model.prismatic(mass, axis=e, to=foot, name="rail")
    options = {"prismatic": {"joint": "rail"}, "slider": {"joint": "rail"},
               "between": {"between": (foot, mass)},
               "node": {"node": mass, "direction": e}}[kind]
    model.actuator("motor", start=force, ratio=ratio, inertia=J, **options)
    scheme = generalized_alpha(tolerance=1e-12)
    result = Simulation(model, 1e-3, scheme).run_to(1.0).result()
    a = 3.0 / (2.0 + ratio**2 * J)
    assert_allclose(result["rail.displacement"], 0.5 * a * result["t"]**2, rtol=1e-9, atol=1e-12)
    assert_allclose(result["rail.speed"], a * result["t"], rtol=1e-9, atol=1e-12)
    assert_allclose(result["motor.work"][-1], 0.5 * (2.0 + ratio**2 * J) * a**2, rtol=1e-6)
    assert np.abs(result["rail.force"]).max() < 1e-6        # rounding of positions over h^2


def test_a_cylinder_between_two_levers():
    """A hydraulic cylinder with a rotor on two rods, against their equation by SciPy."""
    model = Model(planar=True)
    rods = []
    for k, sign in enumerate((1.0, -1.0)):
        node = model.node(f"rod{k}", (sign * 0.5, 0.0))
        model.rigid_body(f"r{k}", node, 1.0, 1.0 / 12.0)
        hinge = model.attach(f"hinge{k}", (sign * 0.2, 0.0), node)
        model.revolute(hinge, name=f"h{k}")
        rods.append(model.attach(f"end{k}", (sign * 1.0, 0.3), node))
    J, ratio = 0.002, 8.0
    model.actuator("cylinder", between=rods, inertia=J, ratio=ratio, start=0.25)
    result = Simulation(model, 5e-4).run_to(1.0).result()
    r, inertia = np.array([0.8, 0.3]), 1.0 / 12.0 + 0.3**2

    def length(q):
        """Length of the cylinder and its derivative: rods turn by q and -q."""
        c, s = np.cos(q), np.sin(q)
        x, dx = 0.2 + c * r[0] - s * r[1], -s * r[0] - c * r[1]
        return 2 * x, 2 * dx, 2 * (-c * r[0] + s * r[1])

    def rates(t, y):
        _, d, dd = length(y[0])
        m = 2 * inertia + J * ratio**2 * d * d
        return [y[1], (ratio * 0.25 * d - J * ratio**2 * d * dd * y[1]**2) / m]
    exact = solve_ivp(rates, (0, 1), [0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-12)
    assert_allclose(result["rod0.rotation"][-1], exact.y[0, -1], rtol=2e-6)
    assert_allclose(result["rod1.rotation"][-1], -exact.y[0, -1], rtol=2e-6)


def test_a_resumed_run_may_get_other_torques(tmp_path):
    """What is set is no part of the model: a saved run goes on with another torque."""
    def build():
        model = bodies()
        model.actuator("motor", joint="hinge", limit=2.0, lag=0.02)
        return Simulation(model, 0.01)
    run = build().run_to(0.2)
    path = save_state(run, tmp_path / "run.npz")
    other = resume(run.model, path)
    for one in (run, other):
        one.set_input("motor", 5.0)
        one.run_to(0.5)
    assert np.array_equal(run.result().rows[-1], other.result().rows[-1])
    assert run.read("motor") == 2.0         # the limit
    third = resume(run.model, path)
    third.run_to(0.5)
    assert abs(third.read("hinge.angle") - run.read("hinge.angle")) > 1e-3


def test_an_angle_counts_turns_in_space():
    """Compiled reading and result, of a hinge that turns three times."""
    model = bodies()
    model.actuator("motor", joint="hinge")
    model.sensor("angle", "hinge.angle")
    model.initial_velocity("a", angular=20.0 * AXIS)
    model.controller("none", state_feedback([[0.0]]), ["angle"], ["motor"], 0.01)
    result = Simulation(model, 0.01).run_to(1.0).result()
    assert_allclose(result["angle.value"], result["hinge.angle"], atol=1e-10)
    assert np.abs(result["hinge.angle"]).max() > 6 * np.pi


def test_a_copy_has_the_same_inputs():
    model = Model()
    node = model.node("a", (0.0, 0.0, 0.0))
    model.rigid_body("one", node, 1.0, np.eye(3))
    model.revolute(node, name="hinge")
    model.actuator("motor", joint="hinge")
    assert copied(model).loads[0].time_function is model.loads[0].time_function
