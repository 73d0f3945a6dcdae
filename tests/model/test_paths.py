"""Points on paths: moving masses, beads and sliders, by series, closed forms and invariance."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, SimulationError, generalized_alpha, simulate
from sebody.analysis import Ensemble, equilibrium, final, gradient, vibrations
from sebody.export.prepared import refuse_paths
from sebody.fem import rectangle, straight_beam
from sebody.model.path_joints import place_at
from sebody.model.profiles import rest_to_rest
from sebody.model.variants import divide, keep_modes, planar, rigid
from sebody.reduction import craig_bampton
from sebody.results import Result
from sebody.verify.outside import moving_mass

G = 9.81
TURN = Rotation.from_rotvec((0.5, -0.8, 0.4)).as_matrix()
SHIFT = np.array([3.0, -1.0, 2.0])
SMALL = moving_mass.SMALL      # of weights: beams stay straight
MASS, SPEED = moving_mass.MASS, moving_mass.SPEED


@pytest.mark.filterwarnings("ignore")
def test_a_mass_moves_along_a_bridge():
    """Case of Frýba: convective terms included; by one body and by several that are welded."""
    times = np.array([0.25, 0.5, 0.75, 0.95]) / SPEED
    exact, _ = moving_mass.deflections(times, 16)
    for bodies, modes, error in ((1, 8, 3e-4), (3, 4, 6e-4)):
        result = simulate(moving_mass.bridge(bodies, modes), times[-1] / 760, times[-1])
        place = -result["car.position"][:, 1] / SMALL
        under = np.interp(times, result.t, place)
        assert under == pytest.approx(exact, abs=error * 0.0196)
        assert result["runs.way"] == pytest.approx(SPEED * result.t, abs=1e-12)
        assert result["runs.rate"] == pytest.approx(SPEED, rel=1e-12)
        # the engine pushes as much as the path does, which its power says, too
        assert result["engine.thrust"] == pytest.approx(result["runs.thrust"], abs=1e-14)
        assert result["engine.power"] == pytest.approx(SPEED * result["runs.thrust"], abs=1e-13)


def arm(bodies=1, modes=4, flat=True, turned=None, shift=0.0, scale=1.0, **options):
    """A pendulum hangs from a slider on an arm that swings down: flexible, in general position.

    Lengths are `scale` times as large, with the same times and masses.
    """
    turned = np.eye(3) if turned is None else turned

    def at(*point):
        return scale * np.array(point[:2]) if flat else scale * (turned @ (*point, 0.0)) + shift

    model = Model(planar=flat)
    base, tip = model.node("base", at(0.0, 0.0)), model.node("tip", at(2.0, 0.0))
    up = {} if flat else {"up": turned[:, 1]}
    model.beam("arm", (base, tip), rectangle(
        scale * 0.01, scale * 0.04, youngs_modulus=7e10 / scale, poisson_ratio=0.0,
        density=2700.0 / scale**3), elements=20, bodies=bodies, modes=modes, **up, **options)
    axis = (0.0, 0.0, 1.0) if flat else turned[:, 2]
    model.revolute(base, axis, name="hinge")
    model.drive_angle("hinge", rest_to_rest(-1.0, 1.0), name="motor")
    car = model.node("car", at(0.3, 0.0), "translation")
    bob = model.node("bob", at(0.3, -0.4), "translation")
    model.point_mass("car mass", car, 0.3)
    model.point_mass("bob mass", bob, 0.5)
    model.distance(car, bob)
    field = np.array([0.0, -G, 0.0]) * scale
    model.gravity(field[:2] if flat else turned @ field)
    model.path("rail", on="arm")
    model.path_joint(car, "rail", name="runs")
    return model


@pytest.fixture(scope="module")
def swung():
    return simulate(arm(modes=8), 2e-3, 0.8)


@pytest.mark.filterwarnings("ignore")
def test_divisions_of_an_arm_agree(swung):
    """One body in second order, and four, which are geometrically more exact; motions are large."""
    four = simulate(arm(bodies=4), 2e-3, 0.8)
    assert swung["runs.way"][-1] == pytest.approx(four["runs.way"][-1], abs=6e-5)
    assert swung["tip.position"][-1] == pytest.approx(four["tip.position"][-1], abs=2e-4)
    still = simulate(arm(modes=0), 2e-3, 0.8)["runs.way"][-1]
    assert abs(still - four["runs.way"][-1]) > 5e-3         # what bending does


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("bodies", "modes"), [(1, 8), (4, 4)])
def test_an_arm_with_a_pendulum_as_by_cable_elements(bodies, modes):
    """Those of `tests/data/sliding_on_cables.py`, which differ by as much from finer ones."""
    result = simulate(arm(bodies=bodies, modes=modes), 1e-3, 0.8)
    assert result["runs.way"][-1] == pytest.approx(1.408815, abs=3e-5)
    assert result["tip.position"][-1] == pytest.approx((1.052223, -1.699951), abs=3e-4)
    assert result["bob.position"][-1] == pytest.approx((0.431255, -1.429534), abs=1e-4)


@pytest.mark.filterwarnings("ignore")
def test_in_space_turned_shifted_and_in_other_units(swung):
    made = simulate(arm(modes=8, flat=False, turned=TURN, shift=SHIFT, scale=1000.0), 2e-3, 0.8)
    assert made["runs.way"] / 1000 == pytest.approx(swung["runs.way"], abs=5e-5)
    place = (made["bob.position"] - SHIFT) @ TURN / 1000
    assert place[:, :2] == pytest.approx(swung["bob.position"], abs=2e-4)
    assert place[:, 2] == pytest.approx(0.0, abs=1e-8)


def test_the_force_is_normal_to_the_path(swung):
    force, local = swung["runs.force"], swung["runs.local_force"]
    assert np.linalg.norm(local, axis=1) == pytest.approx(np.linalg.norm(force, axis=1), rel=1e-12)
    size = swung["runs.normal_force"]
    assert np.abs(local[:, 1]) == pytest.approx(size, rel=1e-9, abs=1e-9)
    assert np.abs(local[1:, 0]).max() < 1e-6 * size.max()
    assert np.abs(swung["runs.thrust"]).max() < 1e-6 * size.max()
    assert not swung["runs.moment"].any()
    # Newton's law of the slider: with the weight and the pull of the rod
    pull = 0.3 * (swung["car.acceleration"] + (0.0, G)) + 0.5 * (
        swung["bob.acceleration"] + (0.0, G))
    assert pull[100:] == pytest.approx(force[100:], abs=1e-6 * size.max())


@pytest.mark.filterwarnings("ignore")
def test_the_joint_does_no_work():
    """By the scheme of no numerical damping energy stays, with errors of the second order."""
    def fall(h, index):
        model = Model(planar=True)
        along = np.array([np.cos(0.5), np.sin(0.5)])
        ends = model.node("base", (0.0, 0.0)), model.node("tip", 2.0 * along)
        model.beam("arm", ends, rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                          density=2700.0), elements=20, bodies=1, modes=4)
        model.revolute("base")
        car = model.node("car", 1.2 * along, "translation")
        model.point_mass("mass", car, 0.3)
        model.gravity((0.0, -G))
        model.path("rail", on="arm")
        model.path_joint(car, "rail", name="runs")
        return simulate(model, h, 0.3, generalized_alpha(1.0, index=index))

    def spread(result):
        return np.ptp(result["energy.kinetic"] + result["energy.strain"]
                      + result["energy.potential"])
    coarse, fine = fall(2e-3, 2), fall(1e-3, 2)
    assert spread(fine) < 4e-5
    assert 3.5 < spread(coarse) / spread(fine) < 4.5
    assert np.abs(fine["runs.power"]).max() < 1e-7
    assert fall(1e-3, 3)["runs.way"][-1] == pytest.approx(fine["runs.way"][-1], abs=1e-6)


def bead(start, modes=12):
    """A bead on a light beam that is held at both ends, and sags under it."""
    model = Model(planar=True)
    ends = model.node("a", (0.0, 0.0)), model.node("b", (2.0, 0.0))
    model.beam("beam", ends, rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.0,
                                       density=0.27), elements=60, bodies=1, modes=modes,
               stiffening=False)
    for end in ends:
        model.revolute(end)
    car = model.node("car", (start, 0.0), "translation")
    model.point_mass("car", car, 0.3)
    model.force(car, (0.0, -1.0), 0.3 * G)
    model.path("rail", on="beam")
    model.path_joint(car, "rail", name="runs")
    return model


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("start", [0.0, 1e-3, 0.5, 0.98, 1.6, 2.0])
def test_a_bead_rolls_in_its_own_sag(start):
    """Small sag m g L^3 / (48 E I) and frequency g sqrt(m L / (6 E I)), from V = -F^2 C(s) / 2."""
    model, EI = bead(start), 7e10 * 0.04 * 0.01**3 / 12
    rest = equilibrium(model)
    assert rest.stability.startswith("stable")
    assert rest["runs.way"][-1] == pytest.approx(1.0, abs=1e-6)
    assert rest["car.position"][-1] == pytest.approx((1.0, -0.3 * G * 8 / 48 / EI), abs=1e-6)
    if start == 0.5:
        assert vibrations(rest).omega[0] == pytest.approx(G * np.sqrt(0.3 * 2 / (6 * EI)), rel=5e-3)


def circle(flat=True):
    """Points of an arc of a unit circle, more than half of it, in the plane or turned and shifted.
    """
    angle = np.linspace(-np.pi - 0.3, 0.3, 161)
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    return points if flat else points @ TURN[:, :2].T + SHIFT


@pytest.mark.parametrize("flat", [True, False])
def test_a_bead_on_a_circle_is_a_pendulum(flat):
    model = Model(planar=flat)
    cam = model.path("cam", points=circle(flat))
    down = np.array([0.0, -G]) if flat else -G * TURN[:, 1]
    start = place_at(cam, 2.6)
    node = model.node("bead", start, "translation")
    model.point_mass("bead", node, 1.5)
    model.gravity(down)
    model.path_joint(node, cam, name="runs")
    result = simulate(model, 1e-3, 2.0)
    angle = 2.6 / cam.length * (np.pi + 0.6) - np.pi - 0.3
    exact = solve_ivp(lambda t, z: (z[1], -G * np.cos(z[0])), (0, 2), (angle, 0.0), "DOP853",
                      [2.0], rtol=1e-10, atol=1e-12).y[:, -1]
    place = result["bead.position"][-1] if flat else (
        result["bead.position"][-1] - SHIFT) @ TURN[:, :2]
    assert place == pytest.approx((np.cos(exact[0]), np.sin(exact[0])), abs=2e-5)
    assert result["runs.normal_force"][-1] == pytest.approx(
        1.5 * (exact[1]**2 - G * np.sin(exact[0])), rel=1e-4)


@pytest.mark.parametrize("flat", [True, False])
def test_a_bead_in_a_turning_slot_is_thrown_out(flat):
    """s = s0 cosh(w t) in a radial slot, and the side presses with 2 m w s'."""
    model, spin = Model(planar=flat), 2.0
    more = () if flat else (0.0,)
    hub = model.node("hub", (0.0, 0.0, *more))
    model.rigid_body("disc", hub, 1.0, 1.0 if flat else (1.0, 1.0, 1.0))
    model.revolute(hub, name="axle")
    model.drive_angle("axle", (lambda t: 2.0 * t, lambda t: 2.0, lambda t: 0.0))
    node = model.node("bead", (0.3, 0.0, *more), "translation")
    model.point_mass("bead", node, 1.5)
    model.path("slot", on=hub, points=[(0.0, 0.0, *more), (3.0, 0.0, *more)])
    model.path_joint(node, "slot", rate=0.0, name="runs")
    result = simulate(model, 1e-3, 1.0)
    assert result["runs.way"][-1] == pytest.approx(0.3 * np.cosh(spin), abs=1e-5)
    assert result["runs.normal_force"][-1] == pytest.approx(
        2 * 1.5 * spin * 0.3 * spin * np.sinh(spin), rel=2e-5)


def slide(**path):
    """A bead that slides down a straight line of unit length."""
    model = Model()
    model.path("line", points=[(0.0, 0.0, 0.0), (0.6, 0.0, -0.8)], **path)
    node = model.node("bead", (0.0, 0.0, 0.0), "translation")
    model.point_mass("bead", node, 2.0)
    model.gravity((0.0, 0.0, -G))
    model.path_joint(node, "line", name="runs")
    return model


def test_the_end_of_a_path_stops_a_run():
    with pytest.raises(SimulationError) as caught:
        simulate(slide(), 1e-2, 2.0)
    assert "joint 'runs' comes to the end of path 'line', whose length is 1" in str(caught.value)
    arrival = np.sqrt(2 / (0.8 * G))
    assert arrival - 1.1e-2 < caught.value.result.t[-1] <= arrival + 1e-2
    beyond = simulate(slide(ends=("refuse", "straight")), 1e-2, 1.0)
    assert beyond["runs.way"][-1] == pytest.approx(0.4 * G, rel=1e-6)


def test_starts():
    model = slide()
    assert model.joints[0].constraints[0].path.way.start == pytest.approx([0.0], abs=1e-12)
    model.initial_velocity("bead", (0.6, 0.0, -0.8))
    result = simulate(model, 1e-3, 0.1)
    assert result["runs.rate"][0] == pytest.approx(1.0)
    model = Model()
    model.path("line", points=[(0.0, 0.0, 0.0), (0.6, 0.0, -0.8)])
    node = model.node("bead", (0.3, 0.0, -0.4), "translation")
    model.point_mass("bead", node, 2.0)
    model.path_joint(node, "line", rate=0.7, name="runs")
    result = simulate(model, 1e-3, 0.1)
    assert result["runs.way"][-1] == pytest.approx(0.57, rel=1e-9)
    assert result["bead.velocity"][-1] == pytest.approx((0.42, 0.0, -0.56), rel=1e-9)


@pytest.mark.filterwarnings("ignore")
def test_labels_and_lines_between_nodes_are_the_same_path():
    """Along the axis of a beam whose FE nodes have labels, forth and back."""
    fe = straight_beam((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), moving_mass.thin(), 6)
    body = craig_bampton(fe, {0: "full", 6: "full"}, 2)
    model = Model()
    model.node("a", (0.0, 0.0, 0.0))
    model.node("b", (1.0, 0.0, 0.0))
    model.superelement("beam", body, ["a", "b"])
    forth = model.path("forth", on="beam", nodes=("a", "b"))
    back = model.path("back", on="beam", nodes=("b", "a"))
    listed = model.path("listed", on="beam", nodes=range(7))
    assert forth.pieces[0].places == listed.pieces[0].places == back.pieces[0].places[::-1]
    assert forth.length == pytest.approx(1.0)
    some = model.path("some", on="beam", nodes=[1, 3, 5])
    assert place_at(some, 0.1) == pytest.approx((1 / 6 + 0.1, 0.0, 0.0))


@pytest.mark.filterwarnings("ignore")
def test_saved_restarted_and_varied(tmp_path, swung):
    model = arm(modes=4)
    result = simulate(model, 2e-3, 0.2)
    result.save(tmp_path / "run.npz")
    read = Result.load(tmp_path / "run.npz")
    for name in ("way", "local_force", "power"):
        np.testing.assert_array_equal(read[f"runs.{name}"], result[f"runs.{name}"])
    fewer = simulate(keep_modes(model, "arm", 2).model, 2e-3, 0.2)
    assert fewer["runs.way"][-1] == pytest.approx(result["runs.way"][-1], abs=1e-3)
    for change, said in ((lambda: rigid(model, "arm"), "path 'rail' goes along superelement 'arm'"),
                         (lambda: divide(model, "arm", 2), "path 'rail' goes along superelement"),
                         (lambda: planar(arm(flat=False)), "path 'rail' has no planar form")):
        with pytest.raises(InputError, match=said):
            change()


@pytest.mark.filterwarnings("ignore")
def test_refused_by_name_and_ensembles_one_by_one():
    model = slide()
    with pytest.raises(InputError, match="joint 'runs' is on a path, which is not differentiated"):
        gradient(model, 1e-2, 0.1, {"x": final("bead.position.x")}, ["bead.mass"])
    for refuse in (lambda: gradient(loaded(), 1e-2, 0.1, {"x": final("b.rotation")}, ["beam.mass"]),
                   lambda: refuse_paths(loaded())):
        with pytest.raises(InputError, match="force 'axles' moves along a path, which is not"):
            refuse()
    with pytest.raises(InputError, match="joint 'runs' is on a path, which is not exported"):
        refuse_paths(model)
    found = Ensemble(model, 1e-2).run({"bead.mass": np.array([1.0, 2.0])}, 0.2,
                                      {"s": final("runs.way")})
    assert found["s"] == pytest.approx(0.4 * G * 0.04, rel=1e-6)


def test_measured_and_in_summaries():
    model = slide()
    model.sensor("odometer", "runs.way", rate=100.0)
    model.sensor("tachometer", "runs.rate", rate=100.0)
    model.sensor("scales", "runs.normal_force", rate=100.0)
    result = simulate(model, 1e-2, 0.3)
    assert result["odometer.value"][-1] == pytest.approx(0.4 * G * 0.09, rel=1e-6)
    assert result["tachometer.value"][-1] == pytest.approx(0.8 * G * 0.3, rel=1e-6)
    assert result["scales.value"][-1] == pytest.approx(2.0 * G * 0.6, rel=1e-6)
    assert "line  the ground       1      2  refuse" in model.summary()


def loaded(bodies=1, flat=True, turned=None, **force):
    """A force without mass, or several, on the beam of `bridge`."""
    model, turned = Model(planar=flat), np.eye(3) if turned is None else turned
    ends = [model.node(name, x * turned[:2, 0] if flat else x * turned[:, 0] + SHIFT)
            for name, x in (("a", 0.0), ("b", 1.0))]
    up = {} if flat else {"up": turned[:, 1]}
    model.beam("beam", ends, moving_mass.thin(), elements=24, bodies=bodies,
               modes=10 if flat else 20, stiffening=False, **up)
    if flat:
        for end in ends:
            model.fix(end, "position")
    else:
        model.revolute("a", turned[:, 2])
        model.universal("b", turned[:, 2], turned[:, 0])
    model.path("deck", on="beam")
    down = -MASS * SMALL * turned[:, 1]
    model.moving_force("deck", down[:2] if flat else down, lambda t: 0.5 * np.pi * t,
                       name="axles", **force)
    return model


@pytest.mark.filterwarnings("ignore")
def test_a_force_moves_along_a_bridge():
    """Mid-span by the series of a moving force; its work is the energy of the beam."""
    times = np.array([0.25, 0.5, 0.75, 0.95]) / SPEED
    k = np.arange(1, 40) * np.pi
    exact = [2 * MASS * np.sum(np.sin(k / 2) / (k**4 - (SPEED * k)**2) * (
        np.sin(SPEED * k * t) - SPEED / k * np.sin(k * k * t))) for t in times]
    for bodies in (1, 2):
        result = simulate(loaded(bodies), times[-1] / 760, times[-1])
        place = "beam.node12" if bodies == 1 else "beam 1"
        middle = -np.interp(times, result.t, result[f"{place}.position"][:, 1]) / SMALL
        assert middle == pytest.approx(exact, abs=4e-6)
        work = sum(result[f"{name}.work"][-1] for name in result.numbering.port_names)
        energy = (result["energy.kinetic"] + result["energy.strain"])[-1]
        assert work == pytest.approx(energy, rel=1e-5)


@pytest.mark.filterwarnings("ignore")
def test_a_series_of_axles_is_a_sum():
    """In space and in general position as in a plane; what has left the path does not act."""
    h, end = 0.5e-3, 0.8
    one = simulate(loaded(), h, end)["beam.node12.position"][:, 1]
    later = np.interp(one_t := np.arange(len(one)) * h - 0.2 / SPEED, np.arange(len(one)) * h, one)
    later[one_t < 0] = 0.0
    both = simulate(loaded(spacing=(0.0, 0.2), factors=(1.0, 0.5)), h, end)
    found = both["beam.node12.position"][:, 1]
    size = np.abs(found).max()
    assert found == pytest.approx(one + 0.5 * later, abs=2e-3 * size)
    spatial = simulate(loaded(flat=False, turned=TURN, spacing=(0.0, 0.2), factors=(1.0, 0.5)),
                       h, end)
    place = (spatial["beam.node12.position"] - SHIFT) @ TURN[:, 1]
    assert place == pytest.approx(found, abs=2e-3 * size)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("blend", [0.0, 0.05])
def test_a_mass_comes_from_the_ground_and_crosses_two_spans(blend):
    """Two separate beams; before and behind them it is on the ground, where nothing bends."""
    model = Model(planar=True)
    for k in range(2):
        ends = [model.node(f"{name} {k}", (k + x, 0.0)) for name, x in (("a", 0.0), ("b", 1.0))]
        model.beam(f"span {k}", ends, moving_mass.thin(), elements=24, bodies=1, modes=8,
                   stiffening=False)
        for end in ends:
            model.fix(end, "position")
    car = model.node("car", (-0.2, 0.0), "translation")
    model.point_mass("mass", car, MASS)
    model.force(car, (0.0, -1.0), MASS * SMALL)
    model.path("deck", on=["span 0", "span 1"], blend=blend, ends="ground")
    model.path_joint(car, "deck", name="runs")
    model.drive_way("runs", (lambda t: 0.5 * np.pi * t, lambda t: 0.5 * np.pi, lambda t: 0.0))
    result = simulate(model, 1e-3, 2.5 / SPEED)
    way, place = result["runs.way"], -result["car.position"][:, 1] / SMALL
    assert way[0] == pytest.approx(-0.2)
    outside = (way < -blend) | (way > 2 + blend)
    assert outside.sum() > 100
    assert np.abs(place[outside]).max() < 1e-6
    exact, _ = moving_mass.deflections(np.array([0.25, 0.5, 0.75]) / SPEED, 16)
    for span in range(2):       # the second one rests when the mass comes
        under = np.interp(np.array([0.25, 0.5, 0.75]) + span, way, place)
        assert under == pytest.approx(exact, abs=(3e-4 if blend == 0 else 5e-3) * 0.0196)


@pytest.mark.filterwarnings("ignore")
def test_a_point_is_held_for_an_equilibrium_and_let_go():
    """A run starts from the state of the model with a drive that stands still; or it says so."""
    held = bead(0.5)
    held.drive_way("runs", lambda t: 0.0)
    rest = equilibrium(held)
    assert rest["runs.way"][-1] == pytest.approx(0.5) and rest.stability == "stable"
    result = simulate(bead(0.5), 1e-2, 0.2, start=rest)
    assert result["runs.way"][0] == pytest.approx(0.5)
    # the slope of the sag under it, F C'(s) / 2, moves it
    EI = 7e10 * 0.04 * 0.01**3 / 12
    slope = 0.3 * G * 2 * 0.5 * 1.5 * (2 - 2 * 0.5) / (3 * EI * 2) / 2
    assert result["runs.way"][-1] - 0.5 == pytest.approx(G * slope * 0.02, rel=2e-2)
