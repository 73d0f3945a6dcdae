"""Impacts, stops, rolling and gears against closed forms and independent integration."""

import numpy as np
import pytest
from contact_models import G, angle_of, bar, restitution
from scipy.integrate import solve_ivp

from sebody import Model, Simulation, Tolerance, cylinder, plane, simulate, sphere
from sebody.model.impacts import damping_of
from sebody.model.variants import planar as planar_variant

LOOSE = pytest.mark.filterwarnings("ignore::sebody.LimitWarning")     # coarse steps are the point


def thrown(cv, stiffness=1e4, planar=True, radius=0.0):
    """A body of 1 kg thrown at a plane at the speed 1."""
    model = Model(planar=planar)
    up = np.eye(model.dimension)[-1]
    model.node("ball", (0.03 + radius) * up)
    model.rigid_body("body", "ball", 1.0, 0.1 if planar else (0.1,) * 3)
    model.initial_velocity("ball", -up)
    model.contact("ball", on=plane(up), radius=radius, stiffness=stiffness,
                  restitution=restitution(cv), at_speed=1.0, name="hit")
    return model


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_point_at_the_end_of_a_rigid_arm_hits_a_plane(planar, friction):
    """A bar on a hinge hits with the mass J / l^2 at its end: the restitution is that of a body."""
    model = Model(planar=planar)
    if planar:
        turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    else:
        turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    along, up = turn.T[:2]
    hinge = model.node("hinge", 2.0 * up)
    model.rigid_body("bar", hinge, 1.0, 0.4 if planar else 0.4 * np.eye(3))
    tip = model.attach("tip", 2.0 * up + 0.5 * along + 0.005 * up, hinge)
    if planar:
        model.revolute(hinge, name="pin")
        model.initial_velocity(hinge, angular=-2.0)
    else:
        model.revolute(hinge, axis=turn.T[2], name="pin")
        model.initial_velocity(hinge, angular=-2.0 * turn.T[2])
    model.contact(tip, on=plane(up, 2.0 * up), stiffness=1e5, restitution=restitution(0.5),
                  at_speed=1.0, friction=friction, name="hit")
    rate = simulate(model, 1e-4, 0.05)["pin.rate"]
    assert rate[0] == pytest.approx(-2.0)
    assert rate[-1] == pytest.approx(2.0 * restitution(0.5), rel=0.03 if friction else 2e-3)


@pytest.mark.parametrize("cv, value", [(0.1, 0.937475579949905), (0.5, 0.748434931597434),
                                       (1.0, 0.593624260040040)])
def test_restitution(cv, value):
    """Closed form: variable steps at 1e-6 to 1e-4, and forty steps in contact to 1e-3."""
    assert restitution(cv) == pytest.approx(value, abs=1e-13)
    assert damping_of(value, 2.0, "law") == pytest.approx(cv / 2.0, rel=1e-9)
    result = simulate(thrown(cv), 0.01, 0.2, tolerance=Tolerance(1e-6))
    assert result["ball.velocity"][-1, 1] == pytest.approx(value, rel=1.5e-4)
    fixed = simulate(thrown(cv, planar=False, radius=0.2), 0.002, 0.2)
    assert fixed["ball.velocity"][-1, 2] == pytest.approx(value, rel=1e-3)
    assert np.diff(fixed["hit.dissipation"]).min() >= 0.0
    lost = 0.5 * (1.0 - fixed["ball.velocity"][-1, 2]**2)
    assert fixed["hit.dissipation"][-1] == pytest.approx(lost, rel=2e-3)


@LOOSE
@pytest.mark.parametrize("stiffness, h", [(1e8, 0.01), (1e8, 1e-3), (1e6, 0.05), (1e4, 0.03)])
def test_stiff_contact_makes_no_energy(stiffness, h):
    """Up to twenty contact times a step: within 3 % where the scheme alone gives 1.90."""
    run = Simulation(thrown(0.5, stiffness), h).run_to(0.2 + h - 0.2 % h)
    assert run.result()["ball.velocity"][-1, 1] == pytest.approx(restitution(0.5), rel=0.03)
    assert 3 < run.state.control.cuts < 60


def flight(t_end, stiffness, damping):
    """Tops of a ball from 1 m, gravity in contact included, by DOP853: (t, height)."""
    def fall(t, y):
        d = max(-y[0], 0.0)
        return [y[1], -G + stiffness * d**1.5 * max(1.0 - damping * y[1], 0.0)]

    def touches(t, y):
        return y[0]

    def top(t, y):
        return y[1]
    touches.terminal, top.terminal = True, True
    touches.direction, top.direction = -1, -1
    tops, t, y = [], 0.0, [1.0, 0.0]
    while True:
        down = solve_ivp(fall, (t, 9.0), y, method="DOP853", rtol=1e-11, atol=1e-13,
                         events=touches, first_step=1e-3)
        t, y = down.t_events[0][0], [0.0, down.y_events[0][0][1]]
        up = solve_ivp(fall, (t, 9.0), y, method="DOP853", rtol=1e-11, atol=1e-13, events=top,
                       max_step=2e-3, first_step=1e-5)
        t, y = up.t_events[0][0], [up.y_events[0][0][0], 0.0]
        if t > t_end:
            return np.array(tops)
        tops.append((t, y[0]))


def test_bouncing_ball():
    v = np.sqrt(2 * G)
    tops = flight(1.6, 1e6, damping_of(0.8, v, "ball"))
    assert tops[:, 1] == pytest.approx([0.6347640868, 0.4378258678], abs=1e-8)
    model = Model()
    model.node("ball", (0.0, 0.0, 1.1))
    model.rigid_body("body", "ball", 1.0, (0.004,) * 3)
    model.gravity((0.0, 0.0, -G))
    model.contact("ball", on=plane((0.0, 0.0, 1.0)), radius=0.1, stiffness=1e6, restitution=0.8,
                  at_speed=v)
    result = simulate(model, 2e-3, 1.6, tolerance=Tolerance(1e-7))
    t, x = result["t"], result["ball.position"][:, 2] - 0.1
    for when, height in tops:
        near = np.abs(t - when) < 0.02
        p = np.polyfit(t[near] - when, x[near], 2)
        assert p[2] - p[1]**2 / (4 * p[0]) == pytest.approx(height, rel=1e-3)


@pytest.mark.parametrize("planar", [True, False])
def test_pendulum_on_a_stop(planar):
    """Angles at 1, 3 and 5 s against DOP853 with the same law."""
    cv, k, J = 0.2, 1e4, 1 / 12 + 0.25

    def rates(t, y):
        d = max(-0.3 - y[0], 0.0)
        return [y[1], (-0.5 * G * np.sin(y[0]) + k * d**1.5 * max(1 - cv * y[1], 0.0)) / J]
    exact = solve_ivp(rates, (0.0, 3.0), [np.pi / 3, 0.0], method="DOP853", rtol=1e-10, atol=1e-12,
                      max_step=2e-3, t_eval=[1.0, 3.0]).y[0]
    assert exact == pytest.approx([0.6849924560, -0.0231997118], abs=1e-8)
    model = bar(planar)
    model.stop("hinge", lower=-0.3 - np.pi / 3, stiffness=k, restitution=restitution(cv),
               at_speed=1.0, name="buffer")
    result = simulate(model, 1e-2, 3.0, tolerance=Tolerance(1e-7))
    found = angle_of(result) + np.pi / 3
    assert found[[100, 300]] == pytest.approx(exact, abs=6e-5)
    gap = np.minimum(found + 0.3, np.inf)
    free = gap > 0.05       # in contact the number is that of the end of a step
    assert result["buffer.gap"][free] == pytest.approx(gap[free], abs=0.1)


def test_stops_of_ways_and_distances():
    """A slide between two stops, and a rope: the speeds of rebound are those of the law."""
    for kind in ("slide", "rope"):
        model = Model()
        model.node("bead", (0.0, 0.0, 0.0))
        model.rigid_body("body", "bead", 2.0, (0.1,) * 3)
        model.initial_velocity("bead", (1.0, 0.0, 0.0))
        law = {"stiffness": 1e5, "restitution": 0.6, "at_speed": 1.0, "name": "end"}
        if kind == "slide":
            model.prismatic("bead", (-1.0, 0.0, 0.0), name="rail")
            model.stop("rail", lower=-0.3, upper=0.4, **law)     # against the axis
        else:
            model.fix(model.node("post", (-1.0, 0.0, 0.0), keeps="translation"), "position")
            model.stop(("post", "bead"), upper=1.3, **law)
        result = simulate(model, 1e-3, 0.6)
        x, v = result["bead.position"][:, 0], result["bead.velocity"][:, 0]
        assert 0.3 < x.max() < 0.32
        assert v[-1] == pytest.approx(-0.6, rel=2e-3)
        assert result["end.normal_force"].max() > 100.0 and result["end.gap"].min() < 0


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("steps", [{"h": 5e-3}, {"h": 1e-2, "tolerance": Tolerance(1e-5)}])
def test_sphere_slides_then_rolls(planar, steps):
    """v0 2, mu 0.3, J 0.4 m r^2: uniformly slower, then rolls at 5/7 of it."""
    r, k, v = 0.1, 1e6, 2.0
    deep = (G / k)**(2 / 3)
    model = Model(planar=planar)
    up = np.eye(model.dimension)[-1]
    along = np.array([1.0, 0.0]) if planar else np.array([0.6, 0.8, 0.0])
    model.node("ball", (r - deep) * up)
    model.rigid_body("body", "ball", 1.0, 0.004 if planar else (0.004,) * 3)
    model.initial_velocity("ball", v * along)
    model.gravity(-G * up)
    model.contact("ball", on=plane(up), radius=r, stiffness=k, friction=0.3, name="floor")
    result = simulate(model, t_end=0.5, **steps)
    found = result["ball.velocity"] @ along
    assert found[result["t"] == 0.1] == pytest.approx(v - 0.3 * G * 0.1, abs=1e-9)
    assert found[-1] == pytest.approx(v * 5 / 7, abs=1e-9)
    spin = result["ball.angular_velocity"][-1]
    assert np.linalg.norm(spin) == pytest.approx(v * 5 / 7 / r, rel=1e-9)
    assert result["floor.sticks"][-1] == 1.0 and result["floor.sticks"][5] == 0.0
    assert result["floor.normal_force"] == pytest.approx(G, rel=1e-6)


@pytest.mark.parametrize("planar", [True, False])
def test_oblique_spheres(planar):
    """Momentum along the line of centres by the restitution there; frictionless across."""
    cv, gap = 0.5, np.array([0.3, 0.05, 0.0 if planar else 0.02])
    model = Model(planar=planar)
    d = model.dimension
    for name, mass, place in (("a", 1.0, 0 * gap), ("b", 2.0, gap)):
        model.node(name, place[:d])
        model.rigid_body(name + " ball", name, mass, 0.004 if planar else (0.004,) * 3)
    model.initial_velocity("a", np.eye(d)[0])
    across = np.sqrt(gap[1]**2 + gap[2]**2)
    n = np.array([np.sqrt(0.2**2 - across**2), gap[1], gap[2]])[:d] / 0.2
    closing = n[0]
    e = restitution(cv * closing)
    model.contact("a", on=sphere(0.1, node="b"), radius=0.1, stiffness=1e10,
                  restitution=restitution(cv), at_speed=1.0)
    result = simulate(model, 5e-3, 0.25, tolerance=Tolerance(1e-8))
    push = (1 + e) * closing / 1.5
    exact = [np.eye(d)[0] - push * n, 0.5 * push * n]
    for name, velocity in zip("ab", exact, strict=True):
        assert result[f"{name}.velocity"][-1] == pytest.approx(velocity, abs=3e-4)
    assert np.ptp(result["momentum"], axis=0).max() < 1e-12


def test_ball_in_a_bore():
    """A ball rolls in a horizontal cylinder without slip: its period, ``2 pi sqrt(7 a/(5 g))``."""
    a, r, k = 0.5, 0.1, 1e8
    start = 0.01
    deep = (G / k)**(2 / 3)
    model = Model()
    centre = (a + deep) * np.array([np.sin(start), 0.0, -np.cos(start)])
    model.node("ball", centre)
    model.rigid_body("body", "ball", 1.0, (0.4 * r * r,) * 3)
    model.gravity((0.0, 0.0, -G))
    model.contact("ball", on=cylinder((0.0, 1.0, 0.0), a + r, inside=True), radius=r,
                  stiffness=k, friction=0.5, bristle=1e5)
    result = simulate(model, 2e-3, 2.5)
    angle = np.arctan2(result["ball.position"][:, 0], -result["ball.position"][:, 2])
    down = np.flatnonzero((angle[:-1] > 0) & (angle[1:] <= 0))
    times = result["t"][down] + angle[down] / (angle[down] - angle[down + 1]) * 2e-3
    assert np.diff(times)[0] == pytest.approx(2 * np.pi * np.sqrt(7 * a / (5 * G)), rel=2e-3)
    flat = planar_variant(model).model
    found = simulate(flat, 2e-3, 0.5)
    assert flat.plane.to_space("ball.position", found["ball.position"]) == pytest.approx(
        result["ball.position"][:251], abs=1e-9)


def test_point_sticks_and_slides_in_any_direction():
    """A mass on a slope without rotation: along the slope's steepest line, or not at all."""
    for mu, moves in ((0.2, True), (0.6, False)):
        n = np.array([0.3, -0.2, 1.0])
        n /= np.linalg.norm(n)
        model = Model()
        model.node("mass", -(1.0 * G * n[2] / 1e6)**(2 / 3) * n, keeps="translation")
        model.point_mass("body", "mass", 1.0)
        model.gravity((0.0, 0.0, -G))
        model.contact("mass", on=plane(n), stiffness=1e6, friction=mu, name="slope")
        end = simulate(model, 1e-3, 1.0)["mass.position"][-1]
        down = np.array([0.0, 0.0, -1.0]) + n[2] * n
        slope = np.linalg.norm(down)
        way = 0.5 * G * max(slope - mu * n[2], 0.0)
        assert end @ down / slope == pytest.approx(way, abs=1e-9)
        assert (way > 0) == moves


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("play", [0.0, 1e-3])
def test_gears(planar, play):
    """A torque on the first: both turn as one inertia ``J1 + J2/ratio^2``, but for the play."""
    model = Model(planar=planar)
    for name, x, J in (("a", 0.0, 0.1), ("b", 1.0, 0.4)):
        model.node(name, np.array([x, 0.0, 0.0])[:model.dimension])
        model.rigid_body(name + " wheel", name, 1.0, J if planar else (J,) * 3)
        model.revolute(name, name="shaft " + name)
    model.torque("a", 1.0 if planar else (0.0, 0.0, 1.0), 1.0)
    model.gear("shaft a", "shaft b", ratio=-2, backlash=play, name="teeth")
    result = simulate(model, 1e-3, 1.0)
    first, second = angle_of(result, "a"), angle_of(result, "b")
    assert first[-1] == pytest.approx(0.5 / 0.2, abs=2e-3)
    slack = first + 2 * second
    # half a millisecond of free flight ends in an impact of 0.1 rad/s, of 2e-3 rad in the teeth
    assert slack.max() < play / 2 + 2e-3 and slack.min() >= -play / 2 - 2e-3
    assert slack[-1] == pytest.approx(play / 2, abs=1e-3)


@pytest.mark.parametrize("planar", [True, False])
def test_teeth_rebound(planar):
    """Wheels meet through half their play: teeth part at 0.6 of the speed at which they met."""
    model = Model(planar=planar)
    for name, x, J in (("a", 0.3, 0.1), ("b", 1.0, 0.4)):
        model.node(name, np.array([x, -0.2, 0.1])[:model.dimension])
        model.rigid_body(name + " wheel", name, 1.0, J if planar else (J,) * 3)
        model.revolute(name, name="shaft " + name)
    model.initial_velocity("a", angular=1.0 if planar else (0.0, 0.0, 1.0))
    model.gear("shaft a", "shaft b", ratio=-2, backlash=0.02, stiffness=1e5, restitution=0.6,
               name="teeth")
    result = simulate(model, 1e-4, 0.026)
    first, second = (result[f"{name}.angular_velocity"].reshape(len(result.t), -1)[:, -1]
                     for name in "ab")
    assert (first + 2 * second)[[0, -1]] == pytest.approx([1.0, -0.6], rel=5e-3)


@pytest.mark.parametrize("planar", [True, False])
def test_a_carried_plane_is_where_its_point_is(planar):
    """At the start the force is that of the depth, wherever the body is that carries the plane."""
    normal = np.array([0.6, 0.8, 0.0])[:2 if planar else 3]
    at = np.array([3.0, -2.0, 1.0])[:len(normal)]
    model = Model(planar=planar)
    model.fix(model.node("floor", at))
    model.node("ball", at + 0.34 * normal)
    model.rigid_body("body", "ball", 1.0, 0.004 if planar else (0.004,) * 3)
    model.contact("ball", on=plane(normal, point=at + 0.25 * normal, node="floor"), radius=0.1,
                  stiffness=1e4, name="touch")
    result = simulate(model, 1e-4, 2e-4)
    assert result["touch.normal_force"][0] == pytest.approx(1e4 * 0.01**1.5, rel=1e-6)
    assert result["ball.acceleration"][0] == pytest.approx(1e4 * 0.01**1.5 * normal, rel=1e-6)


@LOOSE
@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("speed, looked_at", [(5e-4, False), (2e-3, True)])
def test_steps_look_at_impacts_above_a_thousandth_of_the_given_speed(planar, speed, looked_at):
    model = Model(planar=planar)
    up = np.eye(model.dimension)[-1]
    model.node("ball", (1e-6 - 0.2) * up)
    model.rigid_body("body", "ball", 1.0, 0.1 if planar else (0.1,) * 3)
    model.initial_velocity("ball", -speed * up)
    model.contact("ball", on=plane(up, point=-0.2 * up), stiffness=1e6, exponent=1.0,
                  restitution=0.6, at_speed=1.0)
    result = simulate(model, 3e-3, 0.06)
    assert result["ball.velocity"][-1] @ up > 0.5 * speed
    assert (result.cuts > 0) == looked_at
