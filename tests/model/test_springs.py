"""Springs, dampers, bushings and follower loads against solutions of their own equations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sebody import InputError, Model, generalized_alpha, simulate

FINE = generalized_alpha(0.95, 1e-11)


def solution(rate, start, t):
    return solve_ivp(rate, (0.0, t[-1]), start, t_eval=t, rtol=1e-10, atol=1e-12).y


def on_spring(planar, **coefficients):
    """A mass on a spring from the ground, pushed across it: it swings and stretches."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    anchor = model.node("anchor", np.zeros(d), keeps="translation")
    model.fix(anchor, "position")
    ball = model.node("ball", [1.0, 0.2, 0.0][:d], keeps="translation")
    model.point_mass("ball", ball, 0.5)
    model.spring(anchor, ball, **coefficients)
    model.initial_velocity(ball, [0.3, 1.0, 0.0][:d])
    return model


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_spring_and_damper(planar, damping):
    k, cubic, length = 40.0, 60.0, 0.8
    model = on_spring(planar, stiffness=k, cubic=cubic, damping=damping, length=length)
    result = simulate(model, 1e-3, 3.0, FINE)

    def rate(_, y):
        x, v = y[:2], y[2:]
        now = np.linalg.norm(x)
        u, du = now - length, x @ v / now
        return [*v, *(-(k * u + cubic * u**3 + damping * du) * x / now / 0.5)]
    exact = solution(rate, [1.0, 0.2, 0.3, 1.0], result.t)
    assert np.abs(result["ball.position"][:, :2] - exact[:2].T).max() < 5e-5
    assert result.energy_balance() < 2e-5
    lost = result["spring at anchor.work"]
    # a work of order one never comes back, but by the rounding of its sum
    assert (np.diff(lost) <= 1e-15).all() and (lost[-1] < -0.1) == (damping > 0)


@pytest.mark.parametrize("planar", [False, True])
def test_torsion_spring_and_damper(planar):
    d = 2 if planar else 3
    model = Model(planar=planar)
    hub = model.node("hub", np.zeros(d))
    model.rigid_body("wheel", hub, 1.0, 0.3 if planar else (0.2, 0.25, 0.3))
    model.revolute(hub)
    model.torsion_spring(hub, 2.0, 0.05, cubic=0.7, rest=0.4)
    model.initial_velocity(hub, angular=3.0 if planar else (0, 0, 3.0))
    result = simulate(model, 1e-3, 3.0, FINE)
    exact = solution(lambda _, y: [y[1], -(2.0 * (y[0] - 0.4) + 0.7 * (y[0] - 0.4)**3
                                          + 0.05 * y[1]) / 0.3], [0.0, 3.0], result.t)
    R = result["hub.rotation"]
    angle = R if planar else np.arctan2(R[:, 1, 0], R[:, 0, 0])
    assert np.abs(angle - exact[0]).max() < 5e-5
    assert result.energy_balance() < 2e-5


def test_bushing_between_two_bodies_keeps_momentum_and_loses_what_it_says():
    model = Model()
    for k, x in enumerate((0.0, 1.0)):
        node = model.node(f"body {k}", (x, 0.1, -0.2))
        model.rigid_body(f"body {k}", node, 1.0 + k, (0.2, 0.3, 0.4))
        model.attach(f"end {k}", (0.5, 0.0, 0.0), node)
    model.bushing("end 0", "end 1", stiffness=(500.0, 300.0, 200.0), damping=(1.0, 2.0, 3.0),
                  turning_stiffness=20.0, turning_damping=0.2)
    model.initial_velocity("body 0", (0.1, 0.3, -0.2), (0.5, 0.2, -0.4))
    result = simulate(model, 5e-4, 2.0, FINE)
    for name in ("momentum", "angular_momentum"):
        assert np.abs(result[name] - result[name][0]).max() < 1e-5
    assert result["bushing at end 0.work"][-1] < -0.01
    assert result.energy_balance() < 1e-5


def test_planar_bushing_is_the_spatial_one_in_its_plane():
    results = []
    for planar in (True, False):
        d = 2 if planar else 3
        model = Model(planar=planar)
        node = model.node("body", np.zeros(d))
        model.rigid_body("body", node, 1.0, 0.2 if planar else (0.1, 0.1, 0.2))
        model.bushing(node, None, 50.0, 0.5, 4e3, 0.3)      # stiff in turning: sine is angle
        model.force(node, [1.0, 2.0, 0.0][:d])
        model.torque(node, 3.0 if planar else (0, 0, 3.0))
        results.append(simulate(model, 1e-3, 1.0, FINE)["body.position"][:, :2])
    assert np.abs(results[0] - results[1]).max() < 1e-9


@pytest.mark.parametrize("planar", [False, True])
def test_follower_force_turns_with_its_body(planar):
    """A rocket: thrust along the body, turning at constant rate; its path is a Fresnel spiral."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    node = model.node("rocket", np.zeros(d))
    model.rigid_body("rocket", node, 2.0, 0.3 if planar else (0.2, 0.3, 0.3))
    model.force(node, [4.0, 0.0, 0.0][:d], follower=True)
    model.initial_velocity(node, angular=1.5 if planar else (0, 0, 1.5))
    result = simulate(model, 1e-3, 2.0, FINE)
    exact = solution(lambda t, y: [*y[2:], 2.0 * np.cos(1.5 * t), 2.0 * np.sin(1.5 * t)],
                     np.zeros(4), result.t)
    assert np.abs(result["rocket.position"][:, :2] - exact[:2].T).max() < 1e-5
    assert result.energy_balance() < 1e-5


def test_follower_torque_stays_in_the_body():
    """About a principal axis that turns: Euler's equations with a torque in body axes."""
    model = Model()
    node = model.node("body", (0, 0, 0))
    J = np.array([0.2, 0.3, 0.4])
    model.rigid_body("body", node, 1.0, J)
    model.torque(node, (0.3, -0.1, 0.2), follower=True)
    model.initial_velocity(node, angular=(0.5, 1.0, -0.3))
    result = simulate(model, 1e-3, 2.0, FINE)
    exact = solution(lambda _, w: (np.array([0.3, -0.1, 0.2]) - np.cross(w, J * w)) / J,
                     [0.5, 1.0, -0.3], result.t)
    rates = np.einsum("nji,nj->ni", result["body.rotation"], result["body.angular_velocity"])
    assert np.abs(rates - exact.T).max() < 2e-5


@pytest.mark.parametrize("action, message", [
    (lambda m: m.spring("a", "a"), "spring: node 'a' is joined to itself"),
    (lambda m: m.spring("a", "b", -1.0), "spring: stiffness is -1.0: give a finite number >= 0"),
    (lambda m: m.spring("a", "b", 1.0, np.nan), "spring: damping is nan: give a finite number"),
    (lambda m: m.spring("a", "c", 1.0), "nodes 'a' and 'c' coincide, so it has no direction"),
    (lambda m: m.torsion_spring("a", 1.0, rest=np.inf), "torsion spring at 'a': rest is inf"),
    (lambda m: m.bushing("a", "b", 1.0), "bushing: nodes 'a' and 'b' do not coincide"),
    (lambda m: m.bushing("a", "c", -1.0), "bushing at 'a' has a coefficient that is negative"),
    (lambda m: m.torsion_spring("half", 1.0), "node 'half' has no rotation"),
])
def test_wrong_springs(action, message):
    model = Model()
    for name, x in (("a", 0.0), ("b", 1.0), ("c", 0.0)):
        model.node(name, (x, 0, 0))
    model.node("half", (0, 1, 0), keeps="translation")
    with pytest.raises(InputError, match=message):
        action(model)
    assert not model.loads
