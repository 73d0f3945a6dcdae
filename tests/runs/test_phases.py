"""Parts that let go and lock at given times: dropped payloads, clutches, latches."""

from functools import cache

import numpy as np
import pytest
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
    simulate_within,
)
from sebody.analysis import Ensemble, equilibrium, linearize
from sebody.model.variants.planar import planar as planar_variant
from sebody.results.result import Result
from tests.runs.test_taken_over import DOWN, FOOT, HOW, SPACES, H, crane

TURN = Rotation.from_rotvec((0.4, -0.7, 1.1))
Z = TURN.apply((0.0, 0.0, 1.0))
INERTIAS, SPEEDS = (0.7, 1.9), (5.0, -2.0)


def holding(planar, **acting):
    """The flexible arm with its payload, which is held by a weld of its own."""
    model = crane(planar, False)
    model.weld("hook", to="tip", explicit=True, name="grip", **acting)
    return model


@SPACES
@pytest.mark.parametrize("scheme", [None, generalized_alpha(index=2)], ids=["3", "2"])
def test_a_dropped_payload_is_two_models_in_sequence(planar, scheme):
    run = simulate(holding(planar, until=0.1), H, 0.2, scheme)
    before = simulate(holding(planar), H, 0.1, scheme)
    after = simulate(crane(planar, False), H, 0.1, scheme, start=before)
    assert len(run.t) == 101
    for name in ("hook.position", "tip.velocity", "tip.rotation", "arm.modes", "hinge.angle"):
        np.testing.assert_allclose(run[name][:50], before[name][:-1], atol=1e-10)
        np.testing.assert_allclose(run[name][50:], after[name], atol=1e-10)
    assert np.linalg.norm(run["grip.force"][10:50], axis=1).min() > 1e-2
    assert not run["grip.force"][50:].any() and not run["grip.multipliers"][50:].any()
    assert not run["grip.moment"][50:].any()
    assert run["constraints.position"].max() < 1e-9 and run.energy_balance() < 1e-4
    (event,) = run.events
    assert event[:2] == (0.1, "grip let go") and abs(event.lost) < 1e-9
    assert "at t = 0.1            grip let go; energy lost" in run.summary()


@SPACES
@HOW
def test_a_payload_is_dropped_between_two_steps(planar, how):
    """From there on it flies on a parabola."""
    t = 0.1 + 0.37 * H
    run = simulate(holding(planar, until=t), H, 0.2, **how)
    flies = run.t > t
    down = np.array([0.0, -9.81]) if planar else DOWN
    x, v, s = run["hook.position"][flies], run["hook.velocity"][flies], run.t[flies][:, None]
    np.testing.assert_allclose(v, v[0] + down * (s - s[0]), atol=1e-10)
    np.testing.assert_allclose(x, x[0] + v[0] * (s - s[0]) + down * (s - s[0])**2 / 2, atol=1e-10)
    assert run.events[0].time == pytest.approx(t, abs=1e-12)
    spin = run["hook.angular_velocity"][flies]
    if planar:
        np.testing.assert_allclose(spin, spin[0], atol=1e-10)


def test_a_latch_in_a_flexible_mechanism_is_of_order_2():
    """Released, and engaged again wherever it is, at times between the steps."""
    runs = [simulate(holding(True, until=0.0513, from_=0.1207), 0.16 / n, 0.16, output_every=n)
            for n in (8000, 16_000, 64_000)]
    for name in ("hook.position", "hinge.angle", "tip.velocity", "hook.velocity"):
        one, other, fine = (run[name][-1] for run in runs)
        order = np.log2(np.abs(one - fine).max() / np.abs(other - fine).max())
        assert 1.7 < order < 2.4, name


def clutch(planar, **acting):
    """Two discs on one shaft, each turning at its own speed."""
    model = Model(planar=planar)
    for k, name in enumerate("ab"):
        model.node(name, FOOT[:2] if planar else FOOT)
        spatial = TURN.as_matrix() @ np.diag([0.6, 0.6, 1.0]) @ TURN.as_matrix().T
        model.rigid_body(f"disc {name}", name, 1.0 + k, INERTIAS[k] * (1.0 if planar else spatial))
        model.revolute(name, name=f"hinge {name}", **({} if planar else {"axis": Z}))
        model.initial_velocity(name, angular=SPEEDS[k] * (1.0 if planar else Z))
    model.weld("a", to="b", name="clutch", **acting)
    return model


@SPACES
@HOW
@pytest.mark.parametrize("t", [0.1, 0.1037])
def test_a_locking_clutch_is_a_plastic_impact(planar, how, t):
    """Speed of both ``(J w + J' w') / (J + J')``, energy ``J J' / (J + J') (w - w')^2 / 2``."""
    run = simulate(clutch(planar, from_=t, until=0.3), 0.01, 0.4, **how)
    (J, K), (w, u) = INERTIAS, SPEEDS
    common, lost = (J * w + K * u) / (J + K), J * K / (J + K) * (w - u)**2 / 2
    locked = run.t > t - 1e-9
    for name in "ab":
        speed = run[f"hinge {name}.rate"]
        start = SPEEDS["ab".index(name)]
        bound = 1e-10 if "tolerance" not in how else 1e-8
        np.testing.assert_allclose(speed, np.where(locked, common, start), atol=bound)
        angle = np.where(locked, start * t + common * (run.t - t), start * run.t)
        np.testing.assert_allclose(run[f"hinge {name}.angle"], angle, atol=bound)
    assert [event.what for event in run.events] == ["clutch locked", "clutch let go"]
    assert run.events[0].time == pytest.approx(t, abs=1e-12)
    assert run.events[0].lost == pytest.approx(lost, rel=1e-10)
    assert abs(run.events[1].lost) < 1e-8 and run.energy_balance() < 1e-9
    momentum = run["angular_momentum"]
    np.testing.assert_allclose(momentum, np.broadcast_to(momentum[0], momentum.shape), atol=1e-11)
    k = int(np.flatnonzero(locked)[0])      # the impulse itself
    np.testing.assert_allclose(momentum[k], momentum[k - 1], atol=1e-12)
    assert not run["clutch.moment"][~locked].any()


def fliers(planar, **acting):
    """Two bodies that fly apart, turning, and lock where they are."""
    model, D = Model(planar=planar), 2 if planar else 3
    rng = np.random.default_rng(3)
    for name, mass in (("a", 0.8), ("b", 2.1)):
        model.node(name, rng.normal(size=D))
        inertia = mass if planar else mass * np.diag([0.5, 0.7, 0.9])
        model.rigid_body(f"body {name}", name, mass, inertia)
        model.initial_velocity(name, rng.normal(size=D), rng.normal(size=3)[0 if planar else
                                                                          slice(3)])
    model.weld("a", to="b", name="latch", **acting)
    return model


@SPACES
@HOW
def test_a_latch_locks_any_pose(planar, how):
    """Momenta are what they were, and the relative pose stays what it is when it locks."""
    run = simulate(fliers(planar, from_=0.0517, until=0.153), 0.01, 0.2, **how)
    locked = (run.t > 0.0517) & (run.t < 0.153)
    R, S = (run[f"{name}.rotation"] for name in "ab")
    if planar:
        turned, S = R - S, Rotation.from_rotvec(S[:, None] * [0.0, 0.0, 1.0]).as_matrix()[:, :2, :2]
    else:
        turned = np.einsum("nji,njk->nik", R, S)
    apart = np.einsum("nji,nj->ni", S, run["a.position"] - run["b.position"])
    for pose in (turned, apart):
        assert np.abs(pose[locked] - pose[locked][0]).max() < 1e-8
        assert np.abs(pose[0] - pose[locked][0]).max() > 1e-3
    k = int(np.flatnonzero(locked)[0])
    for name in ("momentum", "angular_momentum"):
        atol = 1e-12 if planar else 1e-6        # before it, steps have their own error in space
        np.testing.assert_allclose(run[name][k], run[name][k - 1], atol=atol)
    assert run.events[0].lost > 0.01
    assert not run["latch.force"][~locked].any() and run["latch.force"][locked].any()


@SPACES
def test_a_spring_that_is_let_go_has_no_force(planar):
    """Its energy goes with it; before and after, the mass moves as without and with it."""
    model = Model(planar=planar)
    D = 2 if planar else 3
    model.node("wall", np.zeros(D))
    model.fix("wall")
    model.node("mass", np.eye(D)[0] * 2.0, keeps="translation")
    model.point_mass("mass", "mass", 0.5)
    model.spring("mass", "wall", 50.0, length=1.5, name="spring", until=0.1, from_=0.25)
    run = simulate(model, 1e-4, 0.3)
    t, w = run.t, 10.0
    on = t < 0.1
    np.testing.assert_allclose(run["mass.position"][on][:, 0], 1.5 + 0.5 * np.cos(w * t[on]),
                               atol=1e-5)
    off = (t >= 0.1) & (t < 0.25)
    assert not run["spring.force"][off].any()
    np.testing.assert_allclose(run["mass.velocity"][off][:, 0], run["mass.velocity"][off][0, 0],
                               atol=1e-12)
    again = t >= 0.25
    np.testing.assert_allclose(run["spring.force"][again][:, 0],
                               -50.0 * (run["mass.position"][again][:, 0] - 1.5), rtol=1e-9)
    stored = 25.0 * (0.5 * np.cos(w * 0.1))**2
    assert run.events[0].lost == pytest.approx(stored, rel=1e-3)
    assert run.events[1].lost == pytest.approx(
        -25.0 * (run["mass.position"][again][0, 0] - 1.5)**2, rel=1e-9)
    assert run.energy_balance() < 1e-5


def test_results_are_saved(tmp_path):
    run = simulate(holding(False, until=0.05, from_=0.1), H, 0.15)
    read = Result.load(run.save(tmp_path / "run.npz"))
    assert read.events == run.events and len(run.events) == 2
    assert read.summary() == run.summary()
    assert read.energy_balance() == run.energy_balance()
    for name in ("grip.force", "hook.position", "tip.acceleration", "energy.strain"):
        np.testing.assert_array_equal(read[name], run[name])


def test_friction_goes_with_its_joint():
    """A block slides on a rail until it leaves it; order of creation and friction are no matter."""
    model = Model(planar=True)
    model.node("block", (0.0, 0.0))
    model.rigid_body("block", "block", 2.0, 1.0)
    rail = model.prismatic("block", (1.0, 0.0), name="rail", until=0.2)
    model.friction(rail, 0.1, name="rubbing")
    model.gravity((0.0, -10.0))
    model.initial_velocity("block", (1.0, 0.0))
    run = simulate(model, 1e-3, 0.3)
    after = run.t > 0.2
    np.testing.assert_allclose(run["block.velocity"][after][:, 0], 0.8, atol=1e-3)
    np.testing.assert_allclose(run["block.velocity"][after][:, 1], -10.0 * (run.t[after] - 0.2),
                               atol=1e-9)
    assert not run["rubbing.normal_force"][after].any()


FORCE, LOAD, INERTIA = 6.0, 0.5, 0.4 + 0.5 + 0.01


@cache
def breaks_at():
    """The time at which the force on the load of the pendulum below is `FORCE`, and its state."""
    def force(y):
        along, across = np.array([np.cos(y[0]), np.sin(y[0])]), np.array([-np.sin(y[0]),
                                                                          np.cos(y[0])])
        turning = -LOAD * 9.81 * np.cos(y[0]) / INERTIA
        return np.linalg.norm(LOAD * (turning * across - y[1]**2 * along) + [0.0, LOAD * 9.81])

    def passes(t, y):
        return force(y) - FORCE

    passes.terminal = True
    found = solve_ivp(lambda t, y: (y[1], -LOAD * 9.81 * np.cos(y[0]) / INERTIA), (0.0, 2.0),
                      (0.0, 0.0), "DOP853", events=passes, rtol=1e-13, atol=1e-13)
    return float(found.t_events[0][0]), found.y_events[0][0]


def pendulum(planar, **acting):
    """A load at the end of a swinging arm, held by a weld."""
    turned = (lambda v: np.array(v)[:2]) if planar else TURN.apply
    model = Model(planar=planar)
    model.node("pivot", turned([0.0, 0.0, 0.0]))
    spatial = TURN.as_matrix() @ np.diag([0.3, 0.3, 0.4]) @ TURN.as_matrix().T
    model.rigid_body("arm", "pivot", 1.0, 0.4 if planar else spatial)
    model.attach("tip", turned([1.0, 0.0, 0.0]), "pivot")
    model.node("load", turned([1.0, 0.0, 0.0]))
    model.rigid_body("load", "load", LOAD, 0.01 if planar else 0.01 * np.eye(3))
    model.revolute("pivot", name="hinge", **({} if planar else {"axis": Z}))
    model.weld("load", to="tip", explicit=True, name="weld", **acting)
    model.gravity(turned([0.0, -9.81, 0.0]))
    return model


@SPACES
def test_a_weld_breaks_at_a_force(planar):
    """At the time that the equation of the pendulum gives; the load flies on a parabola."""
    time, (angle, rate) = breaks_at()
    run = simulate(pendulum(planar, breaks_at=FORCE), 0.01, 0.6, tolerance=Tolerance(1e-11))
    (event,) = run.events
    assert event.what == "weld broke" and event.time == pytest.approx(time, abs=1e-8)
    assert run["hinge.angle"][-1] == pytest.approx(angle + rate * (0.6 - time), abs=1e-7)
    broken = run.t > time
    assert not run["weld.force"][broken].any() and not run["weld.moment"][broken].any()
    force = np.linalg.norm(run["weld.force"], axis=1)
    assert 0.9 * FORCE < force.max() < FORCE
    assert "weld broke; energy lost" in run.summary()


@pytest.mark.parametrize("scheme", [None, generalized_alpha(index=2)], ids=["3", "2"])
def test_fixed_steps_end_where_it_breaks(scheme):
    """The time of the threshold, and states beside it, are of order 2."""
    time, (angle, rate) = breaks_at()
    errors = []
    for h in (0.01, 0.005, 0.0025):
        run = simulate(pendulum(True, breaks_at={"force": FORCE, "moment": 1e3}), h, 0.6, scheme)
        errors.append((run.events[0].time - time,
                       run["hinge.angle"][-1] - angle - rate * (0.6 - time)))
    orders = np.log2(np.abs(np.array(errors[:-1]) / np.array(errors[1:])))
    assert np.abs(orders - 2.0).max() < 0.25


def test_a_time_of_what_broke_is_past():
    run = simulate(pendulum(True, breaks_at=FORCE, until=0.55), 0.01, 0.6)
    assert [event.what for event in run.events] == ["weld broke"]


def test_a_latch_lets_go_at_an_angle():
    """As the sensor says; a quantity that falls, a moment that breaks, and all in one run."""
    model = pendulum(True, release_when="swing < -0.3")
    model.sensor("swing", "hinge.angle")
    run = simulate(model, 0.005, 0.6)
    (event,) = run.events
    assert event.what == "weld let go"
    k = int(np.flatnonzero(run.t > event.time)[0])
    slope = run["hinge.rate"][k]
    assert run["hinge.angle"][k] - slope * (run.t[k] - event.time) == pytest.approx(-0.3, abs=1e-9)
    assert not run["weld.force"][k:].any()


def test_a_spring_breaks_at_its_moment():
    """A torsion spring gives a moment alone, and has stored ``M^2 / 2k``."""
    model = clutch(True, until=0.9)
    model.switches.clear()
    model.joints.pop()
    model.torsion_spring("a", 2.0, to="b", name="shaft", breaks_at=1.5)
    run = simulate(model, 0.001, 0.5)
    (event,) = run.events
    assert event.lost == pytest.approx(1.5**2 / 4.0, rel=1e-9)
    angle = run["hinge a.angle"] - run["hinge b.angle"]
    before = run.t < event.time
    assert np.abs(angle[before]).max() < 0.75 < np.abs(angle[~before]).max()
    assert not run["shaft.moment"][~before].any() and run.energy_balance() < 1e-6


def test_one_break_leads_to_the_next():
    """Two rods hold a load: what the first one bears goes to the other, at the same time."""
    model = Model(planar=True)
    model.node("load", (0.0, 0.0), keeps="translation")
    model.point_mass("load", "load", 1.0)
    for name, x, limit in (("one", -1.0, 6.9), ("other", 1.0, 7.2)):
        model.node(name, (x, 1.0))
        model.fix(name)
        model.spring("load", name, 1e4, name=f"rod {name}", breaks_at=limit)
    model.force("load", (0.0, -1.0), lambda t: 20.0 * t, name="weight", until=2.0)
    run = simulate(model, 1e-3, 1.2)
    first, second = run.events
    assert first.what == "rod one broke" and second.what == "rod other broke"
    assert second.time < first.time + 0.05
    after = run.t > second.time
    slope = np.diff(run["load.velocity"][after][:, 1]) / 1e-3
    np.testing.assert_allclose(slope, -20.0 * run.t[after][:-1], atol=0.03)


def test_loads_contacts_and_drives_have_times():
    """A drive that lets go, a force that ends, a stop that is taken away."""
    model = Model(planar=True)
    model.node("cart", (0.0, 0.0))
    model.rigid_body("cart", "cart", 2.0, 1.0)
    rail = model.prismatic("cart", (1.0, 0.0), name="rail")
    model.drive_slide(rail, lambda t: 0.5 * t * t, name="motor", until=0.4)
    model.force("cart", (3.0, 0.0), 1.0, name="push", from_=0.6, until=0.8)
    run = simulate(model, 1e-3, 1.0)
    v, t = run["cart.velocity"][:, 0], run.t
    expected = np.minimum(t, 0.4) + 1.5 * np.clip(t - 0.6, 0.0, 0.2)
    np.testing.assert_allclose(v, expected, atol=1e-6)
    off = (t < 0.6) | (t >= 0.8)
    assert not run["push.force"][off].any() and run["push.force"][~off].all(axis=0)[0]
    assert not run["motor.thrust"][t >= 0.4].any() and run.energy_balance() < 1e-5
    assert run["push.work"][-1] == pytest.approx(3.0 * (run["cart.position"][800, 0]
                                                        - run["cart.position"][600, 0]), rel=1e-6)


def test_a_stop_is_taken_away():
    model = Model(planar=True)
    model.node("cart", (0.0, 0.0))
    model.rigid_body("cart", "cart", 1.0, 1.0)
    rail = model.prismatic("cart", (1.0, 0.0), name="rail")
    model.stop(rail, upper=0.1, stiffness=1e4, name="gate", until=0.5)
    model.initial_velocity("cart", (1.0, 0.0))
    model.force("cart", (4.0, 0.0), 1.0, name="push")
    run = simulate(model, 1e-3, 1.0)
    gate = run["gate.normal_force"]
    assert gate[run.t < 0.5].max() > 10.0 and not gate[run.t >= 0.5].any()
    assert run["cart.position"][run.t < 0.5].max() < 0.13 and run["cart.position"][-1, 0] > 0.3


def displaced():
    """A revolute joint that is to close at a place where its nodes are apart."""
    model = Model(planar=True)
    for name in "ab":
        model.node(name, (0.0, 0.0))
        model.rigid_body(f"body {name}", name, 1.0, 1.0)
    model.initial_velocity("a", (1.0, 0.0))
    model.revolute("a", to="b", name="pin", from_=0.1)
    return model


def test_a_joint_that_does_not_fit_is_refused_by_name():
    said = "pin locked at t = 0.1, but the initial position violates 'pin' by 0.1"
    with pytest.raises(SimulationError, match=said) as caught:
        simulate(displaced(), 0.01, 0.2)
    assert caught.value.result.t[-1] == pytest.approx(0.1)
    np.testing.assert_allclose(caught.value.result["a.position"][:, 0], caught.value.result.t)


@pytest.mark.parametrize("given, said", [
    ({"until": -1.0}, r"'clutch': until is -1.0: give a time > 0"),
    ({"until": "soon"}, r"'clutch': until is 'soon': give a time > 0"),
    ({"from_": 0.0}, r"'clutch': from_ is 0.0: give a time > 0"),
    ({"breaks_at": 0.0}, "'clutch': breaks_at of the force is 0.0: give a force, or"),
    ({"breaks_at": {"torque": 2.0}}, "'clutch': breaks_at is .*: give a force, or"),
    ({"breaks_at": {"moment": "much"}}, "'clutch': breaks_at of the moment is 'much': give a for"),
    ({"release_when": 0.3}, "'clutch': release_when is 0.3: give a sensor or quantity and its li"),
    ({"release_when": "a.angle = 2"}, "'clutch': release_when is 'a.angle = 2': give a sensor or"),
    ({"release_when": "a.angle > two"}, "'clutch': release_when is 'a.angle > two': give a sens"),
    ({"from_": 0.2, "until": 0.2}, "'clutch': until and from_ are both 0.2: give two times"),
])
def test_times_that_are_none(given, said):
    with pytest.raises(InputError, match=said):
        clutch(True, **given)


@pytest.mark.parametrize("given, said", [
    ({"release_when": "swing > 2"}, "'weld' cannot tell when to let go: 'swing' is unknown"),
    ({"release_when": "load.velocity > 2"}, "'weld': release_when reads 'load.velocity', which"),
])
def test_thresholds_of_what_is_not(given, said):
    with pytest.raises(InputError, match=said):
        simulate(pendulum(True, **given), 0.01, 0.1)


def test_a_misspelt_time():
    with pytest.raises(TypeError, match="weld has no untill=: its arguments are .*until, from_"):
        clutch(True, untill=0.2)


@pytest.mark.parametrize("use", [
    lambda model: Simulation(model, 0.01),
    lambda model: equilibrium(model),
    lambda model: linearize(model),
    lambda model: simulate_within(model, 0.01, 0.1, Tolerance(1e-3)),
    lambda model: Ensemble(model, 0.01),
    lambda model: planar_variant(model)], ids=["simulation", "equilibrium", "linear", "within",
                                              "ensemble", "planar"])
def test_what_follows_no_switches_says_so(use):
    with pytest.raises(InputError, match="'clutch' acts until t = 0.2, which only simulate.* and "
                                         "PhasedSimulation.* follow"):
        use(clutch(False, until=0.2))
