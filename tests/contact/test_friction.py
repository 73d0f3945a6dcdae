"""Dry friction against closed forms and independent integration: rest, stick, slip, break-away."""

import numpy as np
import pytest
from contact_models import (
    G,
    anchored,
    angle_of,
    bar,
    block,
    pendulum_with_journal,
    turning_points,
)

from sebody import InputError, Model, Simulation, Tolerance, simulate
from sebody.model.variants import planar as planar_variant


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("h", [1e-3, 4e-3])
def test_decay_of_a_block(planar, h):
    """m 1, k 100, F 1 from 0.105: each half swing loses 2 F/k, but for the last."""
    model = anchored(block(planar), 100.0, 0.105)
    model.friction("slide", 1.0, preload=1.0, reaction=False, name="dry")
    result = simulate(model, h, 3.0)
    x = result["block.position"][:, 0] + 0.105
    # a bristle of m/h^2 gives way by F h^2/m, and the end of sliding is known to a step
    assert x[-1] == pytest.approx(-0.005, abs=2 * h**2)
    assert np.abs(x[round(2 / h):] - x[-1]).max() < 1e-12 + 1e-3 * h**2
    assert result["dry.work"][-1] == pytest.approx(-0.55, abs=2 * h**2 * 5)
    # where it turns back within a step, by the energy of a bristle at most: F^2 h^2 / m
    assert np.diff(result["dry.dissipation"]).min() > -h**2
    assert result["dry.sticks"][-1] == 1.0 and result["dry.sticks"][round(0.1 / h)] == 0.0


@pytest.mark.parametrize("h", [1e-2, 1e-3])
def test_belt(h):
    """Stick and slip with break-away: T and A of the closed form, to the size of the step."""
    m, k, v, static, dynamic = 1.0, 100.0, 0.1, 4.0, 3.0
    w = np.sqrt(k / m)
    drop, way = (static - dynamic) / k, v / w
    slips = 2 * (np.pi - np.arctan2(drop, way)) / w
    period = slips + 2 * drop / v
    amplitude = np.hypot(drop, way)
    assert (period, amplitude) == pytest.approx((0.67123890, 0.01414214), abs=1e-8)
    model = Model(planar=True)
    model.node("block", (0.0, 0.0))
    model.rigid_body("body", "block", m, 0.1)
    model.initial_velocity("block", (v, 0.0))
    anchored(model, k, 0.0)
    model.node("belt", (0.0, 0.0))
    model.move("belt", (1.0, 0.0), lambda t: 0.1 * t)
    model.fix("belt", "rotation")
    model.prismatic("belt", (1.0, 0.0), to="block", name="slide")
    model.friction("slide", dynamic, static=static, preload=1.0, reaction=False)
    run = Simulation(model, h).run_to(5.0)
    result = run.result()
    t, x = result["t"], result["block.position"][:, 0]
    up = np.flatnonzero((x[:-1] < 0.03) & (x[1:] >= 0.03))
    times = t[up] + (0.03 - x[up]) / (x[up + 1] - x[up]) * h
    late = x[len(x) // 2:]
    assert np.diff(times)[-3:] == pytest.approx(period, abs=h)
    assert (late.max() - late.min()) / 2 == pytest.approx(amplitude, abs=0.03 * h)
    assert run.state.control.cuts == 0


@pytest.mark.parametrize("h", [0.05, 0.01])
def test_load_below_the_limit_never_drifts(h):
    model = block()
    model.force("block", (1.0, 0.0), lambda t: 0.3 + 0.5 * np.sin(2 * np.pi * t))
    model.friction("slide", 1.0, preload=1.0, reaction=False)
    x = simulate(model, h, 1000.0)["block.position"][:, 0]
    assert abs(x[-1] - x[round(10.0 / h)]) < 1e-12
    assert x.max() < 2 * h**2       # bristles of m/h^2


def test_slip_under_the_preload():
    """Bristles of ``static preload radius / slip``, which a force and a moment bend."""
    model = block()
    model.force("block", (1.0, 0.0), lambda t: 0.9 * min(t, 1.0))
    model.friction("slide", 0.3, static=0.4, preload=5.0, reaction=False, slip=2e-3)
    x = simulate(model, 0.01, 3.0)["block.position"][-1, 0]
    assert x == pytest.approx(0.9 / (0.4 * 5.0 / 2e-3), rel=1e-3)     # damped for two seconds
    hub = Model(planar=True)
    hub.rigid_body("rotor", hub.node("hub", (0.3, 0.1)), 1.0, 0.2)
    hub.revolute("hub", name="hinge")
    hub.torque("hub", 1.0, lambda t: 0.05 * min(t, 1.0))
    hub.friction("hinge", 0.4, radius=0.1, preload=5.0, reaction=False, slip=1e-3)
    angle = simulate(hub, 0.01, 3.0)["hub.rotation"][-1]
    assert angle == pytest.approx(0.05 / (0.4 * 5.0 * 0.1 / 1e-3), rel=1e-3)
    with pytest.raises(InputError, match="a slip and a bristle"):
        hub.friction("hinge", 0.4, radius=0.1, preload=5.0, slip=1e-3, bristle=10.0)
    with pytest.raises(InputError, match="no force under which it gives way: give preload="):
        hub.friction("hinge", 0.4, radius=0.1, slip=1e-3)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("mu, way", [(0.31, 0.0), (0.305, -0.507983563243),
                                     (0.25, -6.951131097090)])
def test_incline(planar, mu, way):
    """From rest: held, or slides from the start; pressed by the joint's own reaction."""
    slope, axis = 0.3, np.array([np.cos(0.3), np.sin(0.3), 0.0])
    exact = 0.5 * G * 25.0 * min(mu * np.cos(slope) - np.sin(slope), 0.0)
    assert exact == pytest.approx(way, abs=1e-11)
    model = block(planar, axis=axis)
    model.gravity((0.0, -G, 0.0)[:model.dimension])
    model.friction("slide", mu, name="dry")
    result = simulate(model, 0.05, 5.0)
    found = result["block.position"][-1] @ axis[:model.dimension]
    assert found == pytest.approx(exact, abs=1e-12)
    assert result["dry.normal_force"] == pytest.approx(G * np.cos(slope), rel=1e-9)
    assert (result["dry.sticks"] == (exact == 0.0)).all()


def test_pendulum_with_journal():
    """Planar, in space with a slanted plane, on a ball: the same, and that of SciPy."""
    exact = pendulum_with_journal()
    angles = []
    for joint, planar in (("revolute", True), ("revolute", False), ("spherical", False)):
        model = bar(planar, joint=joint)
        model.friction("hinge", 0.4, radius=0.05)
        result = simulate(model, 1e-3, 2.7)
        found = turning_points(result["t"], angle_of(result) + np.pi / 3)
        assert found[:, 1] == pytest.approx(exact[:, 1], abs=4e-6)
        assert found[:, 0] == pytest.approx(exact[:, 0], abs=1e-4)
        angles.append(found[:, 1])
    assert np.ptp(angles[:2], axis=0).max() < 1e-12
    assert np.ptp(angles, axis=0).max() < 2e-6


def test_pendulum_comes_to_rest():
    """The rest that DOP853 finds at -0.014280855352, rtol 1e-13; dissipation never falls."""
    model = bar()
    model.friction("hinge", 0.4, radius=0.05, name="dry")
    result = simulate(model, 2e-3, 10.0)
    angle = angle_of(result) + np.pi / 3
    # the last turning point is known to a step, in which the bar is nearly at rest
    assert angle[-1] == pytest.approx(-0.014280855352, abs=1e-5)
    assert np.ptp(angle[-100:]) < 1e-12
    assert np.diff(result["dry.dissipation"]).min() > -0.2**2 * 2e-3**2 / (1 / 3)


def test_general_position():
    """Turned and shifted in space, other units, other names: the planar motion again."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    size, centre = 1000.0, 0.5 * np.array([np.sin(1.0), -np.cos(1.0), 0.0])
    model = Model()         # in mm and t: forces in N
    where = np.array([30.0, -70.0, 20.0])
    model.node("journal", where)
    inertia = 1e-3 * size**2 / 12 * np.eye(3)
    model.rigid_body("bar", "journal", 1e-3, inertia, centre=where + size * turn @ centre)
    model.revolute("journal", axis=turn[:, 2], name="bearing")
    model.gravity(-G * size * turn[:, 1])
    model.friction("bearing", 0.4, static=0.5, radius=50.0)
    flat = bar(angle=1.0)
    flat.friction("hinge", 0.4, static=0.5, radius=0.05)
    R = simulate(model, 2e-3, 2.0)["journal.rotation"]
    seen = np.einsum("ji,njk,kl->nil", turn, R, turn)
    found = np.arctan2(seen[:, 1, 0], seen[:, 0, 0])
    assert found == pytest.approx(simulate(flat, 2e-3, 2.0)["pin.rotation"], abs=3e-8)


def test_planar_variant_keeps_friction():
    model = bar(planar=False, axis=(0.0, 0.0, -1.0))
    model.friction("hinge", 0.4, static=0.45, radius=0.05)
    model.stop("hinge", upper=1.2, stiffness=1e4)
    made = planar_variant(model).model
    found = [angle_of(simulate(one, 1e-3, 1.5)) for one in (model, made)]
    assert found[0] == pytest.approx(found[1], abs=1e-10)


def test_joint_of_a_shared_position_gets_equations():
    """Two hinged bars: friction in the elbow, whose nodes shared a position; the same motion as
    with explicit equations."""
    found = []
    for explicit in (False, True):
        model = bar()
        tip = (np.sin(np.pi / 3), -np.cos(np.pi / 3))
        model.attach("tip", tip, "pin")
        model.node("second", tip)
        model.rigid_body("forearm", "second", 0.5, 0.02, centre=(tip[0] + 0.3, tip[1]))
        model.revolute("second", to="tip", explicit=explicit, name="elbow")
        model.friction("elbow", 0.3, radius=0.1, name="dry")
        result = simulate(model, 1e-3, 1.0)
        found.append(result["second.rotation"])
        assert result["dry.normal_force"] == pytest.approx(
            np.linalg.norm(result["elbow.force"], axis=1), rel=1e-6)
    assert found[0] == pytest.approx(found[1], abs=1e-9)


def test_cylindrical_joint_is_one_vector():
    """Along and about the axis the friction has one limit: F^2 + (M/R)^2 = (mu N)^2."""
    model = Model()
    model.node("a", (0.0, 0.0, 0.0))
    R, m = 0.1, 2.0
    model.rigid_body("body", "a", m, (m * R * R,) * 3)
    model.cylindrical("a", (0.0, 0.0, 1.0), name="rod")
    model.initial_velocity("a", (0.0, 0.0, 0.6), (0.0, 0.0, 8.0))
    model.friction("rod", 0.5, radius=R, preload=4.0, name="dry")
    result = simulate(model, 1e-3, 1.5)
    # inertia along and about is the same at this radius: the direction stays, both end together
    v, w = result["a.velocity"][:, 2], R * result["a.angular_velocity"][:, 2]
    until = round(0.9 / 1e-3)
    assert np.hypot(v, w)[:until] == pytest.approx(1.0 - result["t"][:until], abs=1e-9)
    assert v[:until] / w[:until] == pytest.approx(0.75, rel=1e-9)
    assert np.abs(v[-200:]).max() < 1e-9 and np.abs(w[-200:]).max() < 1e-9


def test_universal_joint_has_friction_about_both_axes():
    model = Model()
    model.node("a", (0.0, 0.0, 0.0))
    model.rigid_body("body", "a", 1.0, (0.2, 0.2, 0.2))
    model.universal("a", (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), name="cross")
    model.initial_velocity("a", angular=(3.0, 0.0, 0.0))
    model.friction("cross", 0.1, radius=0.1, preload=10.0, reaction=False, name="dry")
    result = simulate(model, 1e-3, 1.0)
    rate = result["a.angular_velocity"][:, 0]
    assert rate == pytest.approx(3.0 - 0.1 * 0.1 * 10.0 / 0.2 * result["t"], abs=1e-8)
    assert result["dry 1.work"][-1] == pytest.approx(-0.275, abs=1e-6)
    assert abs(result["dry 2.work"][-1]) < 1e-9


def test_smooth_law():
    """Brown and McPhee's law, sliding at ten reference speeds: close to dry friction."""
    model = block(speed=1.0)
    model.friction("slide", 0.3, preload=2.0, reaction=False, speed=1e-3)
    speed = simulate(model, 1e-3, 1.0)["block.velocity"][:, 0]
    assert speed == pytest.approx(1.0 - 0.6 * np.linspace(0, 1, len(speed)), abs=1e-9)


@pytest.mark.parametrize("share", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("planar", [True, False])
def test_smooth_law_near_its_reference_speed(planar, share):
    """``N (mu_d tanh 4x + (mu_s - mu_d) x / (x^2/4 + 3/4)^2)`` at x reference speeds."""
    model = block(planar, mass=1.5, speed=share * 0.01)
    model.friction("slide", 0.3, static=0.5, preload=2.0, reaction=False, speed=0.01)
    found = simulate(model, 1e-5, 1e-5)["block.acceleration"][0, 0]
    law = 0.3 * np.tanh(4 * share) + 0.2 * share / (share**2 / 4 + 0.75)**2
    assert found == pytest.approx(-2.0 * law / 1.5, rel=1e-9)


@pytest.mark.parametrize("steps", [{"h": 2e-3}, {"h": 2e-2, "tolerance": Tolerance(1e-6)}])
def test_resumed_run_is_the_same(steps, tmp_path):
    """What friction and stops keep is saved: bit for bit, fixed and variable steps."""
    from sebody.analysis import resume, save_state
    model = bar()
    model.friction("hinge", 0.4, static=0.6, radius=0.05)
    model.stop("hinge", lower=-1.3, stiffness=1e4)
    whole = Simulation(model, **steps).run_to(2.0)
    begun = Simulation(model, **steps).run_to(1.0)
    save_state(begun, tmp_path / "state.npz")
    ended = resume(model, tmp_path / "state.npz").run_to(2.0)
    assert np.array_equal(whole.state.now, ended.state.now)


def test_motor_with_friction():
    """A drive's friction is pressed by its preload: the torque it takes more."""
    model = Model(planar=True)
    model.node("a", (0.0, 0.0))
    model.rigid_body("wheel", "a", 1.0, 0.1)
    model.revolute("a")
    model.drive_angle("a", lambda t: 2.0 * t, name="motor")
    model.friction("motor", 0.2, radius=0.1, preload=50.0)
    result = simulate(model, 1e-2, 0.5)
    assert result["motor.torque"][1:] == pytest.approx(0.2 * 0.1 * 50.0, abs=1e-6)


def test_the_summary_says_what_presses():
    model = bar()
    model.friction("hinge", 0.3, radius=0.05, name="dry")
    model.friction("hinge", 0.1, radius=0.02, preload=3.0, reaction=False, name="seal")
    text = simulate(model, 1e-2, 0.1).summary()
    assert "normal forces        of dry: read from equations of hinge\n" in text
    assert "normal forces        of seal: the preload alone\n" in text
    assert "normal forces" not in simulate(bar(), 1e-2, 0.1).summary()
