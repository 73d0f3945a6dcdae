"""Screws, racks and couplings of two coordinates against closed forms, in general position."""

import numpy as np
import pytest
from differentiated import differences
from lane_models import assert_bits_in_other_company, single
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, Tolerance, generalized_alpha, simulate
from sebody.analysis import Ensemble, final, gradient, resume, save_state, vibrations
from sebody.compiler.choice import way
from sebody.explore.ensembles import ensemble
from sebody.fem import rectangle
from sebody.model.variants import planar

TURN = Rotation.from_rotvec((0.3, 1.1, -0.4)).as_matrix()
SHIFT = np.array([0.4, -2.0, 1.0])
X, Y, Z = TURN.T
EXACT = generalized_alpha(tolerance=1e-13)
MASS, SPIN, TORQUE = 2.0, 0.5, 3.0
FORCES = 1e-8       # of multipliers, in which rounding of angles and ways is over h^2


def body(model, name, point, mass=MASS, inertia=SPIN):
    node = model.node(name, SHIFT + TURN @ point)
    model.rigid_body(f"{name} body", node, mass, TURN @ np.diag([0.5, 0.4, inertia]) @ TURN.T)
    return node


def driven_screw(pitch=-0.4, length=1.0):
    """A screw in the ground that a torque turns, in units of length."""
    model = Model()
    node = model.node("nut", length * SHIFT)
    model.rigid_body("body", node, MASS, length**2 * TURN @ np.diag([0.3, 0.4, SPIN]) @ TURN.T)
    model.cylindrical(node, Z, name="spindle")
    model.screw("spindle", length * pitch, name="thread")
    model.torque(node, Z, length**2 * TORQUE, name="motor")
    return model


def gears(x=1.0):
    """Two wheels with a ratio of -2.5, and a rack on the second one."""
    model = Model()
    for name, point, inertia in (("one", (0.0, 0.0, 0.2), 0.5), ("two", (1.0, 0.5, 0.0), 0.8)):
        model.revolute(body(model, name, point, inertia=inertia), Z, name=f"axle {name}")
    model.prismatic(body(model, "rack", (0.2, 0.9, 0.1)), x * X, name="guide")
    model.couple("axle one", "axle two", -2.5, name="mesh")
    model.rack("guide", "axle two", 0.3, name="teeth")
    model.torque("one", Z, TORQUE, name="motor")
    return model


@pytest.mark.parametrize("length", [1.0, 1e3])
def test_a_screw_for_sixteen_turns(length):
    """``angle = M t^2 / (2 (J + m p^2))``, a way of p for a radian; thrust is ``m a``."""
    lead = -0.4 / (2.0 * np.pi)
    result = simulate(driven_screw(length=length), 0.02, 6.0, scheme=EXACT)
    rate = TORQUE / (SPIN + MASS * lead**2)
    exact = rate * result.t**2 / 2
    assert exact[-1] > 16.0 * 2.0 * np.pi
    np.testing.assert_allclose(result["spindle.angle"], exact, atol=1e-10 * exact[-1])
    np.testing.assert_allclose(result["spindle.displacement"], lead * length * exact,
                               atol=1e-10 * length * abs(lead) * exact[-1])
    np.testing.assert_allclose(result["thread.thrust"], MASS * length * lead * rate, rtol=FORCES)
    np.testing.assert_allclose(result["energy.kinetic"], result["motor.work"], rtol=1e-9,
                               atol=1e-9 * length**2)


def test_a_screw_between_two_bodies_that_move():
    """A spindle turns in the ground; its nut, which may not turn, slides."""
    model, lead = Model(), 0.2 / (2.0 * np.pi)
    model.revolute(body(model, "spindle", (0.0, 0.0, 0.0)), Z, name="bearing")
    model.prismatic(body(model, "nut", (0.0, 0.0, 0.7)), Z, name="guide")
    model.cylindrical("nut", Z, to="spindle", name="contact")
    model.screw("contact", 0.2, name="thread")
    model.torque("spindle", Z, TORQUE)
    result = simulate(model, 0.02, 4.0, scheme=EXACT)
    exact = TORQUE / (SPIN + MASS * lead**2) * result.t**2 / 2
    np.testing.assert_allclose(result["bearing.angle"], exact, atol=1e-10 * exact[-1])
    np.testing.assert_allclose(result["guide.displacement"], -lead * exact,
                               atol=1e-10 * exact[-1])


@pytest.mark.parametrize("x", [1.0, -1.0])
def test_gears_and_a_rack(x):
    """One equation of motion; what the couplings pass follows from each body's own."""
    result = simulate(gears(x), 0.02, 5.0, scheme=EXACT)
    ratio, radius = -2.5, 0.3
    rate = TORQUE / (0.5 + (0.8 + MASS * radius**2) / ratio**2)
    exact = rate * result.t**2 / 2
    assert exact[-1] > 4.0 * np.pi
    for name, factor in (("axle one.angle", 1.0), ("axle two.angle", 1 / ratio),
                         ("guide.displacement", radius / ratio)):
        np.testing.assert_allclose(result[name], factor * exact, atol=1e-10 * exact[-1])
    np.testing.assert_allclose(result["mesh.torque"], 0.5 * rate - TORQUE, rtol=FORCES)
    np.testing.assert_allclose(result["teeth.thrust"], MASS * radius / ratio * rate, rtol=FORCES)
    np.testing.assert_allclose(result["mesh.moment"], (0.5 * rate - TORQUE) * np.tile(
        Z, (len(exact), 1)), atol=FORCES)
    np.testing.assert_allclose(result["teeth.force"], MASS * radius / ratio * rate * np.tile(
        x * X, (len(exact), 1)), atol=FORCES)


def test_pulleys_and_an_angle_over_a_way():
    """Two ways in a ratio; an angle over a way is the way over the angle."""
    model = Model()
    for name, point in (("a", (0.0, 0.0, 0.0)), ("b", (1.0, 0.0, 0.3))):
        model.slider(body(model, name, point), Y, name=f"way {name}")
    model.revolute(body(model, "c", (0.0, 1.0, 0.0)), Z, name="drum")
    model.couple("way a", "way b", -2.0, name="rope")
    drum = model.couple("drum", "way b.displacement", 4.0, name="winch")
    assert drum.node.name == "b"
    model.gravity(-9.81 * Y)
    result = simulate(model, 0.01, 1.0, scheme=EXACT)
    a = -9.81 * (MASS - 2.0 * MASS) / (MASS + 4.0 * MASS + 16.0 * SPIN)
    exact = a * result.t**2 / 2
    np.testing.assert_allclose(result["way b.displacement"], exact, atol=1e-10)
    np.testing.assert_allclose(result["way a.displacement"], -2.0 * exact, atol=1e-10)
    np.testing.assert_allclose(result["drum.angle"], 4.0 * exact, atol=1e-10)
    np.testing.assert_allclose(result["winch.thrust"], -16.0 * SPIN * a, rtol=1e-9)


def shaft(coupled):
    """A flexible shaft whose one end turns a disc in a ratio of 3, or one of 9 times its inertia.
    """
    model = Model()
    section = rectangle(0.02, 0.03, 2e11, 0.3, 7800.0)
    ends = [model.node(name, SHIFT + s * X) for name, s in (("left", 0.0), ("right", 0.8))]
    model.beam("shaft", ends, section, 4, 1, 4)
    disc = np.outer(X, X) * 1e-3
    model.weld("left")
    model.revolute("right", X, name="bearing")
    if coupled:
        model.node("disc", SHIFT + 0.5 * Z)
        model.rigid_body("wheel", "disc", 1.0, disc + 6e-4 * (np.eye(3) - np.outer(X, X)))
        model.revolute("disc", X, name="axle")
        model.couple("axle", "bearing", -3.0, name="mesh")
    else:
        model.rigid_body("wheel", "right", 1e-9, 9.0 * (disc + 6e-4 * (np.eye(3) - np.outer(X, X))))
    model.torque("right", X, 5.0, name="pull")
    return model


def test_frequencies_and_motion_of_a_flexible_shaft():
    """Seen through a ratio, an inertia counts with its square."""
    runs = [Simulation(shaft(coupled), 1e-4) for coupled in (True, False)]
    one, other = (vibrations(run, 3).omega for run in runs)
    np.testing.assert_allclose(one, other, rtol=1e-7)
    one, other = (run.run_to(0.01).result()["bearing.angle"] for run in runs)
    np.testing.assert_allclose(one, other, atol=1e-7 * np.abs(other).max())


def in_plane():
    """A planar mechanism: an arm on a hinge, whose angle moves a slide."""
    model = Model()
    model.gravity(-9.81 * Y)
    arm = body(model, "arm", (0.3, 0.0, 0.0))
    model.attach("pin", SHIFT, arm)
    model.revolute("pin", -Z, name="hinge")
    model.revolute(body(model, "wheel", (1.0, 1.0, 0.0)), Z, name="axle")
    model.prismatic(body(model, "slide", (1.0, 0.0, 0.0)), 0.6 * X + 0.8 * Y, name="guide")
    model.rack("guide", "hinge", -0.2, name="teeth")
    model.couple("axle", "hinge", 1.7, name="belt")
    return model


def test_the_planar_form():
    """Angles about axes against the normal change the sign of a ratio."""
    space = in_plane()
    made, _ = planar(space)
    flat, full = (simulate(model, 0.01, 1.5) for model in (made, space))
    assert np.abs(full["axle.angle"]).max() > 4.0
    np.testing.assert_allclose(made.plane.to_space("slide.position", flat["slide.position"]),
                               full["slide.position"], atol=1e-7)
    np.testing.assert_allclose(flat["teeth.thrust"], full["teeth.thrust"], atol=1e-5)


def test_runs_resume_after_several_turns(tmp_path):
    """The number of turns is part of a state."""
    whole = Simulation(gears(), 0.02)
    whole.run_to(5.0)
    half = Simulation(gears(), 0.02)
    half.run_to(3.0)
    save_state(half, tmp_path / "state.npz")
    rest = resume(gears(), tmp_path / "state.npz").run_to(5.0).result()
    assert np.array_equal(rest.rows[-1], whole.result().rows[-1])


@pytest.mark.parametrize("build, names", [
    (driven_screw, {"thread.ratio", "motor.amplitude", "body.mass"}),
    (gears, {"mesh.ratio", "teeth.ratio", "motor.amplitude"})])
def test_gradients(build, names):
    """Adjoint, forward and differences, over more than a turn."""
    model, run = build(), (0.02, 2.0)
    joint = next(joint for joint in model.joints if joint.kind in ("cylindrical", "revolute"))
    objectives = {"a": final(f"{joint.name}.angle")}
    one, other = (gradient(model, *run, objectives, names, mode, scheme=EXACT)
                  for mode in ("adjoint", "forward"))
    np.testing.assert_allclose(one.matrix, other.matrix, rtol=1e-9)
    expected = differences(model, *run, objectives, names, relative=1e-4)
    np.testing.assert_allclose(one.matrix, expected, rtol=1e-6)


@pytest.mark.skipif(way().__name__.endswith("plain"), reason="runs one by one")
def test_members_equal_single_runs(monkeypatch):
    """Eight at a time."""
    monkeypatch.setattr(ensemble, "WORTH_IT", 0)
    rng = np.random.default_rng(5)
    given = {name: rng.uniform(0.5, 2.0, 9) for name in ("pull.amplitude", "shaft.stiffness")}
    outputs = {"a": "bearing.angle", "m": "mesh.torque"}
    many = Ensemble(shaft(True), 1e-4)
    found = many.run(given, 0.003, outputs)
    assert found.in_lanes == 9
    assert_bits_in_other_company(many, given, 0.003, outputs, found)
    alone = single(shaft(True), {name: own[4] for name, own in given.items()}, 1e-4, 0.003)
    for name, quantity in outputs.items():
        np.testing.assert_allclose(found[name][4], alone[quantity],
                                   atol=1e-9 * np.abs(alone[quantity]).max())


def test_refused():
    """What has no coordinate, or two; a coordinate twice."""
    model = gears()
    model.cylindrical(body(model, "nut", (3.0, 0.0, 0.0)), Z, name="spindle")
    model.spherical(body(model, "ball", (4.0, 0.0, 0.0)), name="socket")
    for call, said in (
            (lambda: model.couple("spindle", "guide", 1.0), "'spindle' turns and slides: give "
             "'spindle.angle' or 'spindle.displacement'"),
            (lambda: model.couple("guide.angle", "axle one", 1.0), "'guide' is a prismatic, which "
             "has no angle: give 'guide.displacement'"),
            (lambda: model.couple("socket", "guide", 1.0), "'socket' is a spherical, which has no "
             "angle or displacement: give a revolute, cylindrical, prismatic, slider"),
            (lambda: model.couple("guide", "guide", 1.0), "coupling of guide.displacement and "
             "guide.displacement: give two coordinates"),
            (lambda: model.couple("guide", "axle one", 0.0), "ratio is 0: give the first"),
            (lambda: model.screw("guide", 1.0), "screw: 'guide' is a prismatic: give a "
             "cylindrical joint"),
            (lambda: model.screw("spindle", 0.0), "pitch is 0: give the way of one turn"),
            (lambda: model.rack("axle one", "axle two", 1.0), "rack: 'axle one' is a revolute, "
             "which has no displacement: give a prismatic, slider, cylindrical"),
            (lambda: model.friction("mesh", 0.1, radius=1.0), "a coupling has no friction"),
            (lambda: simulate(model, 0.1, 1.0)["mesh.thrust"], "mesh.torque")):
        with pytest.raises(InputError) as caught:
            call()
        assert said in str(caught.value)
    assert len(model.joints) == 7


@pytest.mark.parametrize("how, when", [
    ("until", {"until": 0.617}), ("breaks_at", {"breaks_at": 0.7}),
    ("release_when", {"release_when": "axle one.angle > 0.4"})])
def test_a_coupling_lets_go(how, when):
    """From then on each wheel turns by itself; a number is the moment of what couples angles."""
    model = Model()
    for name, point, inertia in (("one", (0.0, 0.0, 0.2), 0.5), ("two", (1.0, 0.5, 0.0), 0.8)):
        model.revolute(body(model, name, point, inertia=inertia), Z, name=f"axle {name}")
    model.couple("axle one", "axle two", -2.5, name="mesh", **when)
    ramp = 5.0      # of the torque, so that the moment of the mesh grows
    model.torque("one", Z, lambda t: ramp * t, name="motor")
    result = simulate(model, 0.005, 1.0, scheme=EXACT)
    whole = 0.5 + 0.8 / 2.5**2
    passed = ramp * (1.0 - 0.5 / whole)     # by the mesh, for one of the time
    ends = {"until": 0.617, "breaks_at": 0.7 / passed,
            "release_when": (6.0 * whole * 0.4 / ramp) ** (1.0 / 3.0)}[how]
    (event,) = result.events
    assert event.time == pytest.approx(ends, abs=2e-5) and abs(event.lost) < 1e-9
    assert event.what == ("mesh broke" if how == "breaks_at" else "mesh let go")
    t, after = result.t, result.t > event.time
    np.testing.assert_allclose(result["mesh.torque"][~after], -passed * t[~after], atol=1e-3)
    assert not result["mesh.torque"][after].any() and not result["mesh.moment"][after].any()
    alone = ramp * (event.time**2 / whole + (t**2 - event.time**2) / 0.5) / 2
    np.testing.assert_allclose(result["axle one.rate"], np.where(
        after, alone, ramp * t**2 / whole / 2), atol=1e-4)
    np.testing.assert_allclose(result["axle two.rate"][after],
                               -ramp * event.time**2 / whole / 5.0, atol=1e-4)
    assert result.energy_balance() < 1e-4


def wheels_and_rack(flat, locks):
    """A free wheel, a second one and a rack, which couplings catch; all of them move before."""
    model = Model(planar=flat)
    turn, axis = (np.eye(2), ()) if flat else (TURN, (Z,))
    for name, point, inertia, speed in (("one", (0.1, 0.2), 0.5, 9.0),
                                        ("two", (1.0, 0.5), 0.8, 2.0),
                                        ("rack", (0.2, 0.9), 0.3, None)):
        node = model.node(name, turn @ (point if flat else (*point, 0.3)))
        if speed is not None:
            model.initial_velocity(node, angular=speed if flat else speed * Z)
        else:
            model.initial_velocity(node, turn[:, 0] * -1.3)
        model.rigid_body(f"{name} body", node, MASS, inertia if flat else inertia * np.eye(3))
        if speed is None:
            model.prismatic(node, turn[:, 0], name="guide")
        else:
            model.revolute(node, *axis, name=f"axle {name}")
    model.couple("axle one", "axle two", -2.5, name="mesh", **locks)
    model.rack("guide", "axle two", 0.3, name="teeth", **locks)
    return model


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("tolerance", [None, Tolerance(1e-6)])
@pytest.mark.parametrize("locks", [{"from_": 0.703}, {"until": 0.2, "from_": 0.703}])
def test_couplings_lock(flat, tolerance, locks):
    """Wherever the coordinates are then, after several radians: a plastic impact, and momentum.

    With the speed w of the second wheel ``w (J_2 + ratio^2 J_1 + m r^2)`` is the sum of the momenta
    times their ratios.
    """
    if "until" in locks:        # coupled at first, so with speeds that fit
        model = wheels_and_rack(flat, locks)
        for name, speed in (("one", -5.0), ("two", 2.0)):
            model.initial_velocity(name, angular=speed if flat else speed * Z)
        model.initial_velocity("rack", (np.eye(2) if flat else TURN)[:, 0] * 0.6)
        model.torque("one", 3.0 if flat else 3.0 * Z, [(0.2, 0.0), (0.2, 1.0), (0.6, 1.0),
                                                       (0.6, 0.0)], name="push")
    else:
        model = wheels_and_rack(flat, locks)
    scheme = generalized_alpha(tolerance=1e-12, index=2 if tolerance else 3)
    result = simulate(model, 0.01, 1.0, scheme, tolerance=tolerance)
    t, after = result.t, result.t > 0.703
    names = "axle one", "axle two", "guide"
    rates = [result[f"{name}.{'speed' if name == 'guide' else 'rate'}"] for name in names]
    free = (t < 0.703) & (t > 0.6)
    before = [rate[free][-1] for rate in rates]
    weights = np.array([-2.5, 1.0, 0.3])
    inertias = np.array([0.5, 0.8, MASS])
    speed = weights @ (inertias * before) / (weights**2 @ inertias)
    for rate, weight in zip(rates, weights, strict=True):
        np.testing.assert_allclose(rate[after], weight * speed, atol=2e-9)
    event = result.events[-1]
    assert event.time == pytest.approx(0.703, abs=1e-12) and "locked" in event.what
    lost = inertias @ np.square(before) / 2 - weights**2 @ inertias * speed**2 / 2
    assert event.lost == pytest.approx(lost, rel=1e-8) and result.energy_balance() < 1e-8


def test_what_couplings_refuse_of_when_they_act():
    model = gears()
    model.cylindrical(body(model, "nut", (0.0, 0.0, 0.7)), Z, name="spindle", until=0.2)
    with pytest.raises(InputError, match="screw in spindle: 'spindle' acts until t = 0.2.*until="):
        model.screw("spindle", 0.1)
