"""Every joint between two free bodies: geometry, energy and momentum, number of equations."""

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, generalized_alpha, simulate

AXIS = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
ACROSS = np.array([2.0, -1.0, 0.0]) / np.sqrt(5.0)
PLACE = np.array([0.3, -0.2, 0.5])


def pair(b_point=PLACE):
    """Two rigid bodies with a node of the joint each, turning about each other."""
    model = Model()
    first = model.node("first", (0.0, 0.0, 0.0))
    second = model.node("second", (0.9, 0.3, 0.2))
    model.rigid_body("first", first, 2.0, (0.2, 0.3, 0.4))
    model.rigid_body("second", second, 1.0, (0.1, 0.15, 0.2))
    model.attach("a", PLACE, first)
    model.attach("b", b_point, second)
    model.initial_velocity("first", (0.2, 0.0, -0.1), (0.5, -0.8, 0.3))
    model.nodes["second"].rotation.rate = np.array([-0.4, 0.6, 1.1])
    return model


def in_body(result, node, vector):
    """A vector fixed in a node's body, in global axes."""
    return result[f"{node}.rotation"] @ vector


def gap(result):
    return result["b.position"] - result["a.position"]


def dots(*pairs):
    return np.array([np.abs(np.sum(x * y, axis=1)).max() for x, y in pairs])


def turns_about(result, axis):
    return np.linalg.norm(np.cross(in_body(result, "a", axis), in_body(result, "b", axis)), axis=1)


def twist(result):
    """Rotation of b seen from a, away from the unit matrix."""
    return np.abs(np.swapaxes(result["a.rotation"], 1, 2) @ result["b.rotation"] - np.eye(3)).max()


def off_axis(result):
    across = np.cross(gap(result), in_body(result, "a", AXIS))
    return np.linalg.norm(across, axis=1).max()


FAMILY = {      # joint: how it is made, multipliers, what must vanish
    "revolute": (lambda m: m.revolute("a", AXIS, to="b", explicit=True), 5,
                 lambda r: [np.abs(gap(r)).max(), turns_about(r, AXIS).max()]),
    "spherical": (lambda m: m.spherical("a", to="b"), 3, lambda r: [np.abs(gap(r)).max()]),
    "universal": (lambda m: m.universal("a", AXIS, ACROSS, to="b", explicit=True), 4,
                  lambda r: [np.abs(gap(r)).max(),
                             *dots((in_body(r, "a", AXIS), in_body(r, "b", ACROSS)))]),
    "cylindrical": (lambda m: m.cylindrical("a", AXIS, to="b"), 4,
                    lambda r: [off_axis(r), turns_about(r, AXIS).max()]),
    "prismatic": (lambda m: m.prismatic("a", AXIS, to="b"), 5, lambda r: [off_axis(r), twist(r)]),
    "planar": (lambda m: m.planar_joint("a", AXIS, to="b"), 3,
               lambda r: [*dots((in_body(r, "a", AXIS), gap(r))), turns_about(r, AXIS).max()]),
    "weld": (lambda m: m.weld("a", to="b", explicit=True), 6,
             lambda r: [np.abs(gap(r)).max(), twist(r)]),
}


@pytest.mark.parametrize("name", FAMILY)
def test_geometry_energy_and_momentum(name):
    make, equations, residuals = FAMILY[name]
    model = pair()
    make(model)
    result = simulate(model, 2e-3, 2.0, generalized_alpha(1.0, 1e-11))
    assert sum(j.multipliers for j in model.joints) == equations
    assert result.numbering.free == 12 + equations
    assert max(residuals(result)) < 1e-8
    assert result["constraints.position"].max() < 1e-9
    relative = result["b.rotation"] - result["a.rotation"]
    if name not in ("weld", "prismatic"):
        assert np.abs(relative[-1]).max() > 0.1         # it does move
    kinetic = result["energy.kinetic"]
    assert np.ptp(kinetic) < 2e-4 * kinetic[0]
    for quantity in ("momentum", "angular_momentum"):
        value = result[quantity]
        assert np.abs(value - value[0]).max() < 2e-5 * np.linalg.norm(value[0])


def test_distance_keeps_its_length():
    model = pair(np.array([1.0, 0.5, 0.2]))
    model.distance("a", "b")
    result = simulate(model, 2e-3, 2.0, generalized_alpha(0.95, 1e-11))
    length = np.linalg.norm(gap(result), axis=1)
    assert np.abs(length - length[0]).max() < 1e-9
    assert np.ptp(result["energy.kinetic"]) < 1e-4 * result["energy.kinetic"][0]
    assert np.abs(gap(result)[-1] - gap(result)[0]).max() > 0.1


@pytest.mark.parametrize("name", ["revolute", "universal", "spherical", "weld"])
def test_sharing_needs_fewer_unknowns_and_moves_alike(name):
    """The second body's node is the joint; explicit, the position is one of its own."""
    results = []
    for explicit in (False, True):
        model = Model()
        first = model.node("first", (0.0, 0.0, 0.0))
        model.rigid_body("first", first, 2.0, (0.2, 0.3, 0.4))
        model.attach("a", PLACE, first)
        model.node("b", PLACE)
        model.rigid_body("second", "b", 1.0, (0.1, 0.15, 0.2), centre=PLACE + [0.5, 0.2, 0.1])
        model.torque(first, (0.5, -0.8, 0.3))       # from rest: what is not given is solved for
        {"revolute": lambda m, e: m.revolute("a", AXIS, to="b", explicit=e),
         "universal": lambda m, e: m.universal("a", AXIS, ACROSS, to="b", explicit=e),
         "spherical": lambda m, e: m.spherical("a", to="b", explicit=e),
         "weld": lambda m, e: m.weld("a", to="b", explicit=e)}[name](model, explicit)
        if name != "weld":
            model.torque("b", AXIS, [(0.0, 0.1), (0.5, 0.0)])
        results.append(simulate(model, 5e-4, 1.0, generalized_alpha(0.9, 1e-11)))
    shared, explicit = results
    saved = explicit.numbering.free - shared.numbering.free
    assert saved == (12 if name == "weld" else 6)
    assert np.abs(shared["b.position"] - explicit["b.position"]).max() < 2e-6
    assert np.abs(shared["b.rotation"] - explicit["b.rotation"]).max() < 2e-5


def test_slider_keeps_to_its_line():
    model = Model()
    bead = model.node("bead", PLACE, keeps="translation")
    model.point_mass("bead", bead, 1.0)
    model.gravity((0.0, 0.0, -9.81))
    model.slider(bead, AXIS)
    result = simulate(model, 1e-2, 1.0)
    fall = 0.5 * (AXIS @ [0.0, 0.0, -9.81]) * result.t**2
    exact = PLACE + fall[:, None] * AXIS
    assert np.abs(result["bead.position"] - exact).max() < 1e-9


def turn(t):
    return 0.3 * np.sin(2.0 * t) + t * t


def turn_rate(t):
    return 0.6 * np.cos(2.0 * t) + 2.0 * t


def turn_second(t):
    return -1.2 * np.sin(2.0 * t) + 2.0


DRIVE = (turn, turn_rate, turn_second)


def hinged_plate(planar):
    model = Model(planar=planar)
    d = 2 if planar else 3
    base = model.node("base", np.zeros(d))
    model.rigid_body("plate", base, 2.0, 0.3 if planar else (0.2, 0.3, 0.4),
                     centre=[0.5, 0.1, 0.0][:d])
    model.gravity([0.0, -9.81, 0.0][:d])
    return model, base


@pytest.mark.parametrize("planar", [False, True])
def test_driven_angle_equals_a_moved_rotation(planar):
    """With an equation and without an unknown; the drives do the same work and turn alike."""
    model, base = hinged_plate(planar)
    model.revolute(base)
    model.drive_angle(base, DRIVE)
    driven = simulate(model, 1e-3, 3.0, generalized_alpha(0.9, 1e-11))
    moved, base = hinged_plate(planar)
    moved.attach("tip", [1.0, 0.0, 0.0][:2 if planar else 3], base)
    moved.point_mass("dust", moved.node("loose", [9.0, 9.0, 9.0][:2 if planar else 3],
                                        keeps="translation"), 1.0)
    moved.fix(base, "position")
    moved.move(base, 1.0 if planar else (0.0, 0.0, 1.0), DRIVE, "rotation")
    moved = simulate(moved, 1e-3, 3.0)
    angle = (driven["base.rotation"] if planar else
             np.unwrap(np.arctan2(driven["base.rotation"][:, 1, 0],
                                  driven["base.rotation"][:, 0, 0])))
    assert driven.start.changed == pytest.approx({"base.rotation": 0.6})
    assert np.abs(angle - turn(driven.t)).max() < 1e-9
    tip = moved["tip.position"][:, :2]      # no unknown: the same functions evaluated twice
    assert np.abs(tip - np.array([np.cos(turn(moved.t)), np.sin(turn(moved.t))]).T).max() < 1e-10
    works = driven["angle at base.work"], moved["motion of base.rotation.work"]
    assert np.abs(works[0] - works[1]).max() < 2e-3 * np.abs(works[1]).max()
    rigid = 2.0 * (0.5**2 + 0.1**2) + (0.3 if planar else 0.4)
    moment = rigid * turn_second(moved.t) + 2.0 * 9.81 * (
        0.5 * np.cos(turn(moved.t)) - 0.1 * np.sin(turn(moved.t)))
    reaction = moved["base.reaction_moment"]
    assert np.abs((reaction if planar else reaction[:, 2]).ravel() - moment).max() < 1e-6
    assert driven.energy_balance() < 1e-4


def test_driven_slide():
    """A carriage on a rail that turns: way as prescribed, force as the equation of motion says."""
    model = Model(planar=True)
    rail = model.node("rail", (0.0, 0.0))
    model.rigid_body("rail", rail, 1.0, 0.5)
    model.fix(rail, "position")
    car = model.node("car", (1.0, 0.0))
    model.rigid_body("car", car, 0.5, 0.1)
    model.prismatic(rail, (1.0, 0.0), to=car)
    model.drive_slide(rail, DRIVE, (-1.0, 0.0), to=car)     # of the rail against the car
    model.initial_velocity(rail, angular=1.5)
    result = simulate(model, 5e-4, 1.0, generalized_alpha(0.9, 1e-11))
    way = np.linalg.norm(result["car.position"], axis=1)
    assert np.abs(way - 1.0 - turn(result.t)).max() < 1e-9
    moment = (0.6 + 0.5 * way**2) * result["rail.angular_velocity"]
    assert np.abs(moment - moment[0]).max() < 1e-4 * moment[0]      # nothing turns it
    force = 0.5 * (turn_second(result.t) - way * result["rail.angular_velocity"]**2)
    assert np.abs(-result["slide at rail.multipliers"][50:, 0] - force[50:]).max() < 1e-2
    assert result.energy_balance() < 1e-4


@pytest.mark.parametrize("action, message", [
    (lambda m: m.universal("a", AXIS, AXIS, to="b"), "its axes are at an angle of 0 "
     "degrees: give two that"),
    (lambda m: m.cylindrical("a", (0, 0, 0), to="b"), "axis of the cylindrical joint at 'a' is"),
    (lambda m: m.prismatic("a", AXIS, to="second"), "prismatic: node 'second' is off the axis"),
    (lambda m: m.distance("a", "b"), "distance between 'a' and 'b' is zero: use a spheric"),
    (lambda m: m.weld("a", to="first"), "weld: nodes 'a' and 'first' do not coincide"),
    (lambda m: m.drive_angle("a", (turn, turn, turn)), "second function is not the derivative"),
    (lambda m: m.move("first", (0, 0, 0), DRIVE), "motion of first.position has the direction"),
    (lambda m: m.move("a", (0, 0, 1), DRIVE), "a.position follows another node by a rigid link"),
    (lambda m: (m.move("first", (0, 0, 1), DRIVE, "rotation"),
                m.move("first", (0, 1, 0), DRIVE, "rotation")), "is moved about an axis already"),
    (lambda m: Model(planar=True).universal("a", AXIS, ACROSS), "universal joint: the model is"),
])
def test_wrong_joints(action, message):
    with pytest.raises(InputError, match=message):
        action(pair())


JOINTS = {
    "revolute": lambda m, **e: m.revolute("a", AXIS, to="b", **e),
    "universal": lambda m, **e: m.universal("a", AXIS, ACROSS, to="b", **e),
    "weld": lambda m, **e: m.weld("a", to="b", **e),
}


@pytest.mark.parametrize("kind", JOINTS)
def test_nodes_at_the_ends_of_links_need_no_knowledge(kind):
    """Where both hang on other nodes nothing can be shared: equations are taken by themselves."""
    results = []
    for given in ({}, {"explicit": True}):
        model = pair()
        JOINTS[kind](model, **given)
        results.append(simulate(model, 1e-3, 0.02, generalized_alpha(0.9, 1e-11)))
    own, told = results
    assert own.numbering.free <= told.numbering.free
    for quantity in ("first.position", "second.position", "second.rotation"):
        assert np.abs(own[quantity] - told[quantity]).max() < 1e-9


@pytest.mark.parametrize("planar", [False, True])
def test_a_chain_closes_on_a_link(planar):
    """A four-bar of rigid bodies with links, closed on the ground: one freedom, no `explicit`."""
    model, d = Model(planar=planar), 2 if planar else 3
    points = np.array([(0.0, 0, 0), (0.5, 1, 0), (2.5, 1.2, 0), (2.0, 0, 0)])[:, :d]
    for k in range(3):
        centre = model.node(f"bar {k}", (points[k] + points[k + 1]) / 2)
        model.rigid_body(f"bar {k}", centre, 1.0, 0.1 if planar else (0.1, 0.2, 0.2))
        for end in (k, k + 1):
            model.attach(f"bar {k} at {end}", points[end], centre)
    model.revolute("bar 0 at 0")
    for k in (1, 2):
        model.revolute(f"bar {k - 1} at {k}", to=f"bar {k} at {k}")
    model.revolute("bar 2 at 3", name="last")
    model.gravity((0.0, -9.81, 0.0)[:d])
    result = Simulation(model, 0.01).result()
    power = sum(result[f"bar {k}.acceleration"][0, 1] for k in range(3)) * -9.81
    assert power > 0.0      # it begins to fall
    for k in range(3):      # forces at both ends and weight move every bar
        name = f"bar {k} at {k}"
        left = result["revolute at bar 0 at 0.force" if k == 0 else
                      f"revolute at bar {k - 1} at {k}.force"][0] * (1.0 if k == 0 else -1.0)
        right = result["last.force" if k == 2 else f"revolute at {f'bar {k} at {k + 1}'}.force"][0]
        inertia = result[f"bar {k}.acceleration"][0] - model.gravity_field
        assert left + right == pytest.approx(inertia, abs=1e-9), name


def test_constraints_that_contradict_each_other():
    """Two drives of the same angle that do not agree."""
    model, base = hinged_plate(True)
    model.revolute(base)
    model.drive_angle(base, DRIVE)
    model.drive_angle(base, (lambda t: t, lambda t: 1.0, lambda t: 0.0))
    with pytest.raises(InputError, match=r"violates 'angle at base( \(2\))?' by "
                                         ".*no velocities satisfy all joints|contradict"):
        Simulation(model, 1e-3)
