"""A planar model in the place of a spatial one: both move alike, and what is not planar is said."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, generalized_alpha, harmonic, simulate
from sebody.fem import Section, straight_beam
from sebody.fem import frame as beams
from sebody.model.variants import copied, divide, keep_modes, planar
from sebody.reduction import craig_bampton
from sebody.results import Result
from sebody.scenes import hinged_beam, planar_hinged_beam

H, STEPS = 0.002, 40
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
START = np.array([3.0, -2.0, 1.0])
X, Y, Z = TURN.T
# bending frequencies in both planes differ, and in the second section are the same
FLAT = Section(area=9.0, inertia_y=4.0, inertia_z=6.75, torsion=8.0, youngs_modulus=2.1e6,
               poisson_ratio=0.3, density=7.8e-3)
SQUARE = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387, youngs_modulus=2.1e6,
                 poisson_ratio=0.3, density=7.8e-3)
# iterations of Newton's method end at 1e-12 of the loads; what differs is their rounding
EXACT = generalized_alpha(tolerance=1e-12)
CLOSE = 1e-8


def at(*place: float) -> np.ndarray:
    """A point of the scene, turned and shifted."""
    return START + TURN @ place


def reduced(first, last, modes: int, section: Section = SQUARE, up=Y, damping: float = 0.0):
    """A beam with a load inside, in the plane."""
    fe_model = straight_beam(first, last, section, 6, up)
    wind = np.zeros(fe_model.stiffness.shape[0])
    wind[fe_model.rows[3]] = [*(TURN @ (30.0, 200.0, 0.0)), *(500.0 * Z)]
    body = craig_bampton(fe_model, [(6, "full"), (0, "full")], modes, loads={"wind": wind})
    return body.damped(damping) if damping else body


def wind(t):
    return 1.0 + 2.0 * t


def assert_same(model: Model, made: Model, quantities, h: float = H) -> None:
    expected, found = (simulate(one, h, STEPS * h, EXACT) for one in (model, made))
    for name in quantities:
        own = made.plane.to_space(name, found[name])
        size = max(np.abs(expected[name] - expected[name][0]).max(), 1e-2 * np.abs(
            expected[name]).max())
        assert np.abs(own - expected[name]).max() <= CLOSE * size, name


@cache
def beam_from_tip(section: Section, up: tuple[float, ...], damping: float):
    return reduced(at(100, 40, 0), at(0, 0, 0), 4, section, up, damping)


def beam(section: Section = SQUARE, up=Y, **options) -> Model:
    """A beam that a torque turns about a hinge."""
    model = Model()
    base, tip = model.node("base", at(0, 0, 0)), model.node("tip", at(100, 40, 0))
    # damped bodies of option b have kernels of their own
    body = beam_from_tip(section, tuple(up), 0.0 if "b" in options.values() else 0.01)
    model.superelement("beam", body, [base, tip], **options)
    model.revolute(base, Z, name="hinge")
    model.torque(base, -2e3 * Z, wind, name="motor")
    model.rigid_velocity(np.zeros(3), 0.1 * Z, about=base.point)
    return model


QUANTITIES = ("tip.position", "tip.velocity", "tip.rotation", "base.angular_velocity",
              "energy.kinetic", "energy.strain", "motor.power", "hinge.force", "beam.base.moment",
              "momentum", "beam.node2.displacement", "beam.node2.velocity",
              "beam.node2.section_forces")


@pytest.mark.parametrize("section", [FLAT, SQUARE])
@pytest.mark.parametrize("options", [{}, {"inertia": "b"}, {"inertia": "d"},
                                     {"frame": "node", "frame_node": 1}])
def test_a_beam_moves_in_its_plane_as_in_space(section, options):
    model = beam(section, **options)
    made, sentence = planar(model)
    assert made.planar and not model.planar
    # base: an angle in the place of three and two multipliers; tip: three; two of four modes
    assert sentence.startswith("the model is planar, normal to (")
    assert sentence.endswith(": 6 instead of 15 unknowns")
    assert made.bodies["beam"].body.modes == 2
    assert_same(model, made, QUANTITIES)


def test_the_hinged_beam_is_the_planar_one():
    made, sentence = planar(hinged_beam.build().model)
    assert sentence == "the model is planar, normal to (0, 0, 1): 6 instead of 15 unknowns"
    found, expected = (simulate(model, 0.01, 1.0, EXACT)
                       for model in (made, planar_hinged_beam.build().model))
    for name in ("tip.position", "base.angular_velocity", "energy.strain",
                 "beam.node10.section_forces"):
        size = np.abs(expected[name]).max()
        assert np.abs(found[name] - expected[name]).max() <= CLOSE * size, name


def test_a_beam_on_a_ball_stays_in_the_plane_of_its_torque():
    model = beam(FLAT)
    free = Model()
    nodes = [free.node(name, node.point) for name, node in model.nodes.items()]
    free.superelement("beam", model.bodies["beam"].body, nodes)
    free.fix("base", "position")
    free.torque("base", -2e3 * Z, wind, name="motor")
    made, sentence = planar(free)
    assert sentence.endswith(": 6 instead of 13 unknowns")
    assert_same(free, made, ("tip.position", "base.rotation", "energy.kinetic"))


def test_the_plane_is_kept_in_files_and_by_copies(tmp_path):
    made = planar(beam()).model
    plane = copied(made).plane
    assert np.array_equal(plane.axes, made.plane.axes)
    result = simulate(made, H, 2 * H, EXACT)
    again = Result.load(result.save(tmp_path / "run.npz"))
    for name in ("origin", "axes"):
        assert np.array_equal(getattr(again.model.plane, name), getattr(made.plane, name))


def test_a_frame_without_planar_kernels_is_said():
    model = Model()
    nodes = [model.node(name, at(x, 0, 0)) for name, x in (("a", 0), ("b", 50))]
    model.superelement("beam", reduced(nodes[1].point, nodes[0].point, 2), nodes, frame="mean")
    model.revolute("a", Z)
    with pytest.raises(InputError, match="^there is no kernel for layout 'planar-f2', frame"):
        planar(model)


def test_modes_of_one_frequency_are_turned_until_they_are_in_the_plane():
    model = beam()
    body = model.bodies["beam"].body
    frequencies = np.sqrt(np.diag(body.stiffness)[-4:])
    assert abs(frequencies[1] / frequencies[0] - 1) < 1e-6      # a pair, in any direction
    kept = planar(model).model.bodies["beam"].body
    assert np.allclose(np.sqrt(np.diag(kept.stiffness)[-2:]), frequencies[[0, 2]], rtol=1e-6)


@pytest.mark.parametrize("up", [Y, Z, None])
@pytest.mark.parametrize("tapered", [False, True])
def test_beams_are_divided_in_the_plane_as_in_space(up, tapered):
    """A section that bends easily about one axis, in any position that is symmetric."""
    section = SQUARE if up is None else FLAT

    def thinner(place):
        return replace(section, inertia_z=(1 - 0.5 * place) * section.inertia_z)
    model = Model()
    ends = [model.node(name, at(*xy, 0)) for name, xy in (("a", (0, 0)), ("b", (90, 50)))]
    if tapered and up is None:
        up = Y
    model.beam("rod", ends, thinner if tapered else section, 8, 2, modes=2, up=up, damping=0.01)
    model.fix("a", "position")
    model.torque("a", 2e3 * Z, wind)
    first, second = divide(planar(model).model, "rod", 4), planar(divide(model, "rod", 4).model)
    assert first.change == "rod has 4 superelements of 2 finite elements instead of 2 " + (
        "superelements of 4 finite elements")
    assert list(first.model.bodies) == list(second.model.bodies)
    for name, body in first.model.bodies.items():
        expected = second.model.bodies[name].body
        assert body.body.modes == expected.modes
        for matrix in ("stiffness", "mass"):
            # signs of modes are free: they are compared by size
            own, other = (np.abs(getattr(one, matrix)) for one in (body.body, expected))
            assert np.abs(own - other).max() < 1e-9 * other.max(), name


def test_half_a_pair_of_modes_is_in_no_plane():
    model = beam(SQUARE)
    with pytest.raises(InputError, match="its mass couples .*mode 2, .*symmetric about the plane, "
                                         "or has a part of the modes of one frequency: "
                                         "keep all or none of them"):
        planar(keep_modes(model, "beam", 3).model)
    assert planar(keep_modes(model, "beam", 2).model).model.bodies["beam"].body.modes == 1


POINTS = [(0, 0, 0), (50, 0, 0), (60, 30, 0), (10, 40, 0)]


@pytest.mark.parametrize(("keeps", "frame", "inertia"), [
    (("full", "translation", "rotation", "translation"), "converged_mean", None),
    (("full", "translation", "rotation", "translation"), "converged_mean", "d"),
    (("translation",) * 4, "positions", None)])
def test_frames_of_beams_with_any_boundary(keeps, frame, inertia):
    """A closed frame in the plane, of whose modes some move in it and others out of it."""
    points = [at(*place) for place in POINTS]
    fe_model = beams(points, [(0, 1), (1, 2), (2, 3), (3, 0)], FLAT, 4, up=Z)
    model = Model()
    nodes = [model.node(name, *one) for name, *one in zip("abcd", points, keeps, strict=True)]
    model.superelement("frame", craig_bampton(fe_model, list(enumerate(keeps)), 6), nodes,
                       frame=frame, inertia=inertia)
    model.fix("a", "position")
    model.force("b", TURN @ (0, 2e3, 0), wind)
    model.gravity(TURN @ (0, -9.0, 0))
    made = planar(model).model
    assert 0 < made.bodies["frame"].body.modes < 6
    assert_same(model, made, ("b.position", "d.velocity", "frame.node6.velocity", "energy.strain"))


def rigid(model: Model, name: str, node, mass: float = 1.0, **options) -> None:
    """A rigid body with a principal axis that is normal to the plane."""
    model.rigid_body(name, node, mass, TURN @ np.diag([400.0, 300.0, 600.0]) @ TURN.T, **options)


def four_bar(model: Model) -> None:
    """Two flexible links and a rigid one, with a block that slides on the coupler."""
    base, elbow, pin = (model.node(name, at(0, y, 0)) for name, y in
                        (("base", 0), ("elbow", 40), ("pin", 40)))
    far, foot = model.node("far", at(80, 60, 0)), model.node("foot", at(90, 0, 0))
    model.superelement("crank", reduced(elbow.point, base.point, 4, up=TURN @ (1, 0, 0.3)),
                       [base, elbow])
    model.superelement("coupler", reduced(far.point, pin.point, 3, FLAT), [pin, far],
                       stiffening=False)
    model.revolute(base, -Z, name="hinge")
    model.revolute(pin, Z, to=elbow, name="knee", explicit=True)
    model.fix(foot, "position")
    rigid(model, "rocker", foot, 3.0, centre=at(85, 30, 0))
    model.spherical(model.attach("top", at(80, 60, 0), foot), far, name="ball")
    block, mid = model.node("block", at(40, 50, 0)), model.attach("mid", at(40, 50, 0), pin)
    rigid(model, "block", block)
    model.prismatic(mid, far.point - pin.point, to=block, name="guide")
    model.spring(block, far, stiffness=500.0, damping=1.0, cubic=3.0)
    model.torsion_spring(pin, stiffness=3e4, damping=10.0, axis=-Z, to=elbow, rest=0.2)
    model.point_mass("weight", far, 0.4)
    model.force(far, TURN @ (0, 300, 0), harmonic(1.0, 12.0), name="push")
    model.force("top", TURN @ (20, 0, 0), wind, follower=True)
    model.body_load("crank", "wind", wind)


def driven(model: Model) -> None:
    """A wheel on which a rider is pushed, and a mass on a node that is moved."""
    wheel, rider = (model.node(name, at(-10, -20, 0)) for name in ("wheel", "rider"))
    rigid(model, "wheel", wheel)
    rigid(model, "rider", rider)
    model.revolute(wheel, Z)
    model.drive_angle(wheel, harmonic(0.5, 6.0), axis=-Z, name="motor")
    model.cylindrical(wheel, TURN @ (1, 0, 0), to=rider, name="rail")
    model.drive_slide(wheel, harmonic(3.0, 4.0), TURN @ (1, 0, 0), to=rider, name="pusher")
    shaken = model.node("shaken", at(120, 0, 0), keeps="translation")
    model.point_mass("shaken", shaken, 1.0)
    model.move(shaken, TURN @ (0, 1, 0), harmonic(2.0, 5.0), name="shaker")
    model.spring(shaken, "top", stiffness=300.0)
    turned = model.node("turned", at(0, -40, 0))
    rigid(model, "turned", turned)
    model.fix(turned, "position")
    model.move(turned, -2 * Z, harmonic(0.2, 5.0), what="rotation", name="twist")
    hung = model.node("hung", at(10, -40, 0), keeps="translation")
    model.point_mass("hung", hung, 0.2)
    model.distance(hung, model.attach("end", at(5, -30, 0), turned), name="rod")
    cross = model.node("cross", at(5, -30, 0))
    rigid(model, "cross", cross)
    model.universal(cross, Z, TURN @ (1, 0, 0), to="end", name="cardan")


def guided(model: Model) -> None:
    """A plate on a table, a slider, a weld of equations, and a bushing."""
    plate, table = model.node("plate", at(200, 0, 0)), model.node("table", at(230, 0, 0))
    rigid(model, "plate", plate)
    model.fix(table)
    model.planar_joint(table, Z, to=plate)
    model.torque(plate, 20 * Z, follower=True)
    sliding = model.node("sliding", at(230, 30, 0), keeps="translation")
    model.point_mass("sliding", sliding, 1.0)
    model.slider(sliding, TURN @ (1, 1, 0), name="way")
    model.spring(sliding, plate, stiffness=50.0)
    glued, held = model.node("glued", at(200, 0, 0)), model.node("held", at(200, 0, 0))
    rigid(model, "glued", glued)
    rigid(model, "held", held)
    model.weld(glued, plate, explicit=True, name="glue")
    model.bushing(held, plate, stiffness=4e3, damping=2.0, turning_damping=30.0)


def test_joints_loads_and_drives_of_all_kinds_act_as_in_space():
    model = Model()
    for part in (four_bar, driven, guided):
        part(model)
    model.gravity(TURN @ (3.0, -9.0, 0.0))
    made, sentence = planar(model)
    assert made.plane.normal @ Z == pytest.approx(-1.0)     # as the axis of the motor
    assert sentence.endswith(" unknowns")
    assert {joint.name: joint.multipliers for joint in made.joints} == {
        "hinge": 0, "knee": 2, "ball": 2, "guide": 2, "revolute at wheel": 0, "motor": 1,
        "rail": 2, "pusher": 1, "rod": 1, "cardan": 0, "planar joint at table": 0, "way": 1,
        "glue": 3}
    assert_same(model, made, (
        *(f"{name}.{kind}" for name in ("far", "block", "rider", "cross", "plate", "held")
          for kind in ("position", "rotation")), "sliding.velocity", "hung.position",
        "knee.force", "guide.force", "ball.force", "shaken.reaction", "shaker.thrust",
        "twist.torque", "turned.reaction_moment", "motor.torque", "motor.moment", "pusher.work",
        "crank.node3.section_forces",
        "energy.kinetic", "energy.strain", "energy.potential", "energy.external_work"))


def in_plane(model: Model) -> None:
    """Nodes on a line in the plane, which says nothing about the normal."""
    for name, x in (("a", 0), ("b", 40), ("c", 40)):
        model.node(name, at(x, 0, 0))
    model.superelement("first", reduced(at(40, 0, 0), at(0, 0, 0), 2, FLAT), ["a", "b"])
    model.weld("b", "c")
    rigid(model, "second", "c")


def test_the_plane_of_a_flying_body_is_that_of_its_velocities():
    model = Model()
    in_plane(model)
    model.rigid_velocity(TURN @ (3.0, 1.0, 0.0), np.zeros(3), about=at(0, 0, 0))
    made = planar(model).model
    assert abs(made.plane.normal @ Z) == pytest.approx(1.0)
    assert_same(model, made, ("a.position", "c.velocity", "energy.kinetic"))


def test_what_breaks_the_symmetry_is_said():
    def pull(model, direction, **options):
        model.force("tip", TURN @ direction, name="pull", **options)

    def joined(model, joint, axis):
        model.node("other", at(100, 40, 0))
        rigid(model, "other", "other")
        getattr(model, joint)("tip", TURN @ axis, to="other", name="joint")

    def crooked(model):
        model.rigid_body("lump", "tip", 1.0, (3.0, 4.0, 5.0))

    def off(model):
        model.node("off", at(50, 0, 2))
        model.attach("held", at(60, 0, 0), "tip")

    cases = [
        (off, "node 'off' is 2 off the plane"),
        (lambda m: joined(m, "revolute", (1, 0, 3)), "the axis of 'joint' is not normal"),
        (lambda m: joined(m, "prismatic", (1, 0, 3)), "the axis of 'joint' has a component out"),
        (lambda m: joined(m, "cylindrical", (1, 0, 3)), "axis of 'joint' .*out of the plane"),
        (lambda m: pull(m, (1, 0, 0.1)), "'pull' has a component out of the plane"),
        (lambda m: pull(m, (1, 0, 0.1), follower=True), "'pull' has a component out"),
        (lambda m: m.torque("tip", TURN @ (1, 0, 0.1), name="twist"), "'twist' is not normal"),
        (lambda m: m.gravity(TURN @ (1, 2, 3)), "gravity has a component out of the plane"),
        (lambda m: m.initial_velocity("tip", linear=Z), "initial velocity of tip.position has a"),
        (lambda m: m.initial_velocity("tip", angular=X), "velocity of tip.rotation is not normal"),
        (lambda m: m.move("tip", Z, harmonic(1.0, 2.0), name="lift"), "direction of 'lift' has a"),
        (lambda m: m.torsion_spring("tip", 1.0, axis=X, name="coil"), "the axis of 'coil' is not"),
        (lambda m: m.bushing("tip", stiffness=(1, 2, 3), name="rubber"), "'rubber' has other"),
        (crooked, "no principal axis of inertia of 'lump' is normal to the plane"),
        (lambda m: m.rigid_body("lump", "tip", 1.0, np.ones(3), centre=at(100, 40, 3)),
         "the centre of mass of 'lump' has a component out of the plane"),
        (lambda m: m.mode_force("beam", 0, 1.0, name="shaker"), "'shaker' acts on mode 0 of super"),
        (lambda m: m.user_force("drag", ["tip"], drag), "'drag' is a function of yours"),
    ]
    for change, message in cases:
        model = beam()
        change(model)
        with pytest.raises(InputError, match="not symmetric about the plane through .* normal to "
                                             rf".*, so its motion leaves it: .*{message}"):
            planar(model)


def drag(t, x, v, force):
    force[0] = -0.3 * v[0]


def test_a_section_at_an_angle_is_no_plane_beam():
    """Its bending about axes of the plane is coupled with that out of it."""
    model = beam(FLAT, up=TURN @ (0, 1, 0.4))
    with pytest.raises(InputError, match=r"superelement 'beam': its stiffness couples rotation z "
                                         r"of node [01], in the plane, with rotation [xy] of node "
                                         r"[01], out of it .*not symmetric about the plane"):
        planar(model)
    with pytest.raises(InputError, match="the model is planar already"):
        planar(planar(beam()).model)
    with pytest.raises(InputError, match="the model has no nodes"):
        planar(Model())


def test_a_load_on_a_body_must_be_in_the_plane():
    model = beam()
    placed = model.bodies["beam"]
    skew = placed.body.loads["wind"].copy()
    skew[:3] += 5.0 * Z
    placed.body = replace(placed.body, loads={"skew": skew, **placed.body.loads}, recovery=None)
    assert planar(model).model.bodies["beam"].body.loads.keys() == {"wind"}
    model.body_load("beam", "skew", name="gust")
    with pytest.raises(InputError, match="'gust' has a part out of the plane"):
        planar(model)


def test_quantities_of_the_plane_in_space():
    plane = planar(beam()).model.plane
    angles = np.array([0.3, -2.0])
    expected = Rotation.from_rotvec(angles[:, None] * plane.normal).as_matrix()
    assert np.allclose(plane.to_space("tip.rotation", angles), expected, rtol=0, atol=1e-15)
    with pytest.raises(InputError, match="'beam.modes' of a planar run has no counterpart"):
        plane.to_space("beam.modes", np.zeros((2, 2)))
    with pytest.raises(InputError, match="'angular_momentum' is another quantity in a plane"):
        plane.to_space("angular_momentum", np.zeros((2, 3)))
