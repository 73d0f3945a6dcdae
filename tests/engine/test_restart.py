"""Loads that jump: steps end there with the left limit, then accelerations are solved for anew."""

from functools import cache

import numpy as np
import pytest
from helpers import order
from scipy.integrate import solve_ivp

from sebody import (
    LimitWarning,
    Model,
    Simulation,
    Tolerance,
    generalized_alpha,
    piecewise,
    simulate,
    trapezoidal,
    with_corners,
)

J = 0.1                                     # of a rotor
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
FINE = {index: generalized_alpha(index=index, tolerance=1e-11) for index in (2, 3)}


def stepped(t):
    return 1.0 if t >= 0.5 else 0.0


def pushing(t, x, v, force):
    if t >= 0.5:
        force[0] = 20.0


LOADS = {"profile": piecewise((0.0, 0.0), (0.5, 1.0)),
         "table": [(0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (2.0, 1.0)],
         "first rows": [(0.5, 0.0), (0.5, 1.0)],
         "function": with_corners(stepped, [0.5])}


def rotor(load, planar=True):
    """A rotor with a torque, and what the angle of its node is, from result to array."""
    model = Model(planar=planar)
    hub = model.node("hub", (0.3, -0.2) if planar else (0.3, -0.2, 0.1))
    model.rigid_body("rotor", hub, 2.0, J if planar else (J, J, J))
    model.revolute(hub, (0, 0, 1) if planar else AXIS, explicit=not planar)
    model.torque(hub, 1.0 if planar else AXIS, load, name="motor")
    return model


def angle(result):
    if result.model.planar:
        return result["hub.rotation"]
    R = result["hub.rotation"]
    sines = np.array([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]])
    return np.unwrap(np.arctan2(AXIS @ sines / 2, (np.trace(R, axis1=1, axis2=2) - 1) / 2))


@pytest.mark.parametrize("how", [{"h": 0.01}, {"h": 0.03125}, {"h": 0.0147}, {
    "h": 0.25, "tolerance": Tolerance(1e-5)}], ids=["on the grid", "long", "off it", "variable"])
@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("load", LOADS)
def test_a_torque_that_sets_in(load, planar, how):
    """``angle = (t - 0.5)^2 / (2 J)``: exact, for it is constant on either side."""
    run = Simulation(rotor(LOADS[load], planar), **how)
    result = run.run_to(1.0 if how["h"] != 0.0147 else 68 * 0.0147).result()
    behind = np.maximum(result.t - 0.5, 0.0)
    assert np.abs(angle(result) - behind**2 / (2.0 * J)).max() < 1e-10
    # at the time of the jump a row shows what is behind it, as the load itself does there
    spin = result["hub.angular_acceleration"] @ (1.0 if planar else AXIS) if not planar else (
        result["hub.angular_acceleration"])
    assert np.abs(np.ravel(spin) - (result.t >= 0.5) / J).max() < 1e-7
    assert result["motor.work"][-1] == pytest.approx(angle(result)[-1], rel=1e-9)
    assert result.steps <= 100


def test_forces_of_a_user_jump_at_their_corners():
    """Of a function of time, positions and velocities the corners are given with it."""
    for corners, error in (([0.5], 1e-12), ([], 0.02)):
        model = Model()
        node = model.node("mass", (1.0, 2.0, 3.0))
        model.point_mass("mass", node, 4.0)
        model.fix(node, "rotation")
        model.user_force("push", [node], pushing, corners=corners)
        x = simulate(model, 0.01, 1.0)["mass.position"][-1, 0] - 1.0
        assert abs(x - 0.625) < error and (corners or abs(x - 0.625) > 0.5 * error)


def test_a_jump_nobody_told_of_is_pointed_out():
    message = (r"function of motor jumps from 0 to 1 at t = 0.5, which is not declared: give it "
               r"as with_corners\(function, times\)")
    with pytest.warns(LimitWarning, match=message):
        simulate(rotor(stepped), 0.01, 1.0)


# a rigid body on a ball joint, in general position

CENTRE, ARM, MASS = np.array([0.2, 0.5, -0.3]), np.array([-0.4, 0.3, 0.6]), 3.0
INERTIA = np.array([[0.3, 0.02, -0.05], [0.02, 0.4, 0.03], [-0.05, 0.03, 0.25]])
PIVOT, TORQUE, FORCE = np.array([1.0, -2.0, 0.5]), np.array([0.6, -0.9, 0.4]), np.array([3., 2, -4])


def pulses(times):
    """Amplitudes of torque and force: both jump at the first time, one at the second."""
    return ([(0.0, 0.5), (times[0], 0.8), (times[0], -1.0), (9.0, -1.0)],
            piecewise((0.0, 0.2), (times[0], 1.0), (times[1], -0.5)))


def top(times, linked=True):
    model = Model()
    foot = model.node("foot", PIVOT)
    model.rigid_body("body", foot, MASS, INERTIA, centre=PIVOT + CENTRE)
    model.spherical(foot, name="ball")
    model.attach("end", PIVOT + ARM, foot)
    model.gravity((0.5, 0.0, -9.81))
    torque, force = pulses(times)
    model.torque(foot, TORQUE, torque)
    model.force("end", FORCE, force)
    return model


@cache
def swung(times, t_end):
    """Position of the end, by Euler's equations, piece by piece."""
    about = INERTIA + MASS * (CENTRE @ CENTRE * np.eye(3) - np.outer(CENTRE, CENTRE))

    def rate(t, y, piece):
        R, spin = y[:9].reshape(3, 3), y[9:]
        first = 0.5 + 0.3 * t / times[0] if piece == 0 else -1.0
        moment = first * TORQUE + np.cross(R @ ARM, (0.2, 1.0, -0.5)[piece] * FORCE) + np.cross(
            R @ CENTRE, MASS * np.array([0.5, 0.0, -9.81]))
        W = np.array([[0, -spin[2], spin[1]], [spin[2], 0, -spin[0]], [-spin[1], spin[0], 0]])
        return np.concatenate([(R @ W).ravel(), np.linalg.solve(
            about, R.T @ moment - np.cross(spin, about @ spin))])
    y, begin = np.concatenate([np.eye(3).ravel(), np.zeros(3)]), 0.0
    for piece, end in enumerate((*times, t_end)):
        y = solve_ivp(rate, (begin, end), y, args=(piece,), method="DOP853", rtol=1e-12,
                      atol=1e-13).y[:, -1]
        begin = end
    return PIVOT + y[:9].reshape(3, 3) @ ARM


@pytest.mark.parametrize("index", [2, 3])
@pytest.mark.parametrize("times", [(0.2, 0.4), (0.21237, 0.39901), (0.2, 0.2000003)],
                         ids=["on the grid", "off it", "at nearly one time"])
def test_order_two_in_general_position(times, index):
    """Jumps of several loads at once, on a node and on the end of a rigid link."""
    steps, exact = (0.02, 0.01, 0.005), swung(times, 0.6)
    errors = [np.abs(simulate(top(times), h, 0.6, FINE[index])["end.position"][-1] - exact).max()
              for h in steps]
    assert 1.8 < order(steps, errors) < 2.2 and errors[1] < 2e-4
    variable = simulate(top(times), 0.3, 0.6, tolerance=Tolerance(1e-6))
    assert np.abs(variable["end.position"][-1] - exact).max() < 1e-4


def test_pieces_of_a_step_however_short():
    """A jump just before or behind a grid point: forces of the joint do not show it."""
    def run(when, h, index):
        scheme = FINE[index]
        return simulate(top((when, 0.4)), h, 0.3, scheme, output_every=round(0.01 / h))
    for share in (1e-5, 1e-2, 0.5, 0.99, 1.0 - 1e-5):
        when = 0.2 + 0.01 * share
        fine = run(when, 0.01 / 16, 2)["ball.multipliers"]
        for index in (2, 3):
            apart = np.abs(run(when, 0.01, index)["ball.multipliers"] - fine).max(axis=1)
            # of the order of the step: a twentieth of what forces change by at the jump
            assert apart.max() < 0.05 * np.linalg.norm(FORCE) + (index == 3) * 0.3, (share, index)


def test_redundant_constraints():
    """A weight on two hinges of one axis: as on one of them, when a force jumps."""
    def swing(redundant):
        model = Model()
        a = model.node("a", (0.1, 0.2, 0.3))
        model.rigid_body("door", a, 3.0, (0.1, 0.2, 0.3), centre=(0.5, 0.1, 0.2))
        model.revolute(a, AXIS, explicit=True)
        if redundant:
            model.revolute(model.attach("b", a.point + 0.7 * AXIS, a), AXIS, explicit=True)
        model.torque(a, AXIS, piecewise((0.0, 1.0), (0.1037, -2.0)))
        run = Simulation(model, 5e-3, FINE[3])
        assert bool(run.start.redundant) == redundant
        return run.run_to(0.3).result()["a.rotation"]
    assert np.abs(swing(True) - swing(False)).max() < 1e-8


# drives

@pytest.mark.parametrize("how", [{"h": 0.01}, {"h": 0.0147}, {
    "h": 0.05, "tolerance": Tolerance(1e-6)}], ids=["on the grid", "off it", "variable"])
@pytest.mark.parametrize("moved", [False, True])
def test_drives_whose_acceleration_jumps(moved, how):
    """The torque is ``J s''``, at once behind every corner of the rate; its work ``J s'^2 / 2``."""
    profile = trapezoidal(1.0, 2.0, 10.0, start=0.1)        # corners at 0.1, 0.3, 0.6, 0.8
    model = Model()
    hub = model.node("hub", (0.3, -0.2, 0.1))
    model.rigid_body("rotor", hub, 2.0, (J, J, J))
    model.fix(hub, "position")
    if moved:
        model.move(hub, AXIS, profile, "rotation", name="motor")
        model.point_mass("dust", model.node("dust", (5.0, 0, 0), keeps="translation"), 1.0)
    else:
        model.revolute(hub, AXIS, explicit=True)
        model.drive_angle(hub, profile, AXIS, name="motor")
    result = Simulation(model, **how).run_to(69 * 0.0147 if how["h"] == 0.0147 else 1.0).result()
    exact = np.array([profile.at(t) for t in result.t])
    near = np.min(np.abs(result.t[:, None] - profile.times), axis=1) < 1e-9     # rounding decides
    assert np.abs(angle(result) - exact[:, 0]).max() < 1e-9
    assert np.abs(result["motor.torque"] - J * exact[:, 2])[~near].max() < 1e-5
    assert np.abs(result["motor.work"] - 0.5 * J * exact[:, 1]**2).max() < 1e-6


def test_corners_that_do_not_jump_cost_nothing():
    """Bends of a table off the grid leave fixed steps as they are, unless they are closer."""
    times = 0.02 * np.arange(50) + np.random.default_rng(1).uniform(0.0, 0.009, 50)
    table = np.column_stack([times, np.sin(20.0 * times)])
    result = simulate(rotor(table), 0.01, 1.0)
    assert result.steps == 100 and result.state.control.matrices == 1
