"""Nodes that turn with a path in space: closed forms, other formulations, general position."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.analysis import equilibrium, vibrations
from sebody.fem import rectangle

G = 9.81
STEEL = {"youngs_modulus": 7e10, "poisson_ratio": 0.25, "density": 2700.0}
TURNED, SHIFT = Rotation.from_rotvec([0.4, -0.7, 1.1]), np.array([3.0, -2.0, 1.0])


def arm(planar=False, turn=None, shift=(0.0, 0.0, 0.0), beside=0.0, half=None, joint=(),
        blend=0.0, **beam):
    """A carriage that runs on an arm that falls, its centre beside the path; or on two wheels."""
    R = turn or Rotation.identity()

    def at(*place):
        return (R.apply(np.r_[place, np.zeros(3 - len(place))]) + shift)[:2 if planar else 3]

    model, c = Model(planar=planar), np.array([np.cos(0.5), np.sin(0.5), 0.0])
    base, tip = model.node("base", at(0.0)), model.node("tip", at(*2 * c))
    if not planar:
        beam["up"] = R.apply([-c[1], c[0], 0.0])
    model.beam("arm", (base, tip), rectangle(0.01, 0.04, **STEEL), elements=20, **beam)
    model.revolute(base, R.apply([0.0, 0.0, 1.0]))
    car = model.node("car", at(*1.2 * c))
    inertia = R.as_matrix() @ np.diag([0.01, 0.015, 0.02]) @ R.as_matrix().T
    model.rigid_body("carriage", car, 0.3, 0.02 if planar else inertia,
                     centre=at(0.0, 0.15, beside))
    model.gravity(R.apply([0.0, -G, 0.0])[:2 if planar else 3])
    model.path("rail", on="arm", **({"blend": blend} if blend else {}))
    if half is None:
        given = dict(joint) | {"axis": R.apply(dict(joint)["axis"])} if "axis" in dict(joint) else (
            dict(joint))
        model.path_joint(car, "rail", turns="with", name="runs", **given)
    else:
        for name, place in (("rear", 1.2 - half), ("front", 1.2 + half)):
            model.path_joint(model.attach(name, at(*place * c), car), "rail", name=name)
    return model


EXACT = generalized_alpha(index=2, tolerance=1e-12)


def angle_of(result, node="car"):
    return Rotation.from_matrix(result[f"{node}.rotation"][-1]).as_rotvec()


@pytest.mark.filterwarnings("ignore")
def test_motion_in_a_plane_is_that_of_the_planar_model():
    """Of bodies without modes, whose shapes are the same in both, from one body to the next."""
    flat, space = (simulate(arm(planar, bodies=2, modes=0, blend=0.2), 1e-3, 0.25, EXACT)
                   for planar in (True, False))
    assert 1.0 < flat["runs.way"][-1] < 1.07
    assert space["runs.way"][-1] == pytest.approx(flat["runs.way"][-1], abs=1e-9)
    assert angle_of(space) == pytest.approx([0.0, 0.0, flat["car.rotation"][-1]], abs=1e-9)
    assert space["runs.moment"][-1] == pytest.approx([0.0, 0.0, flat["runs.moment"][-1]], abs=1e-5)
    assert abs(flat["runs.moment"][-1]) > 0.1


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("frame", ["converged_mean", "mean_axes"])
def test_turned_and_shifted_it_moves_alike(frame):
    """The centre is beside the plane of the arm, which bends and twists."""
    results = [simulate(arm(turn=turn, shift=shift, beside=0.08, bodies=2, modes=4, frame=frame),
                        1e-3, 0.1, EXACT) for turn, shift in ((None, np.zeros(3)), (TURNED, SHIFT))]
    one, other = results
    assert other["runs.way"][-1] == pytest.approx(one["runs.way"][-1], abs=1e-7)
    assert TURNED.inv().apply(angle_of(other)) == pytest.approx(angle_of(one), abs=1e-7)
    assert TURNED.inv().apply(other["runs.moment"][-1]) == pytest.approx(
        one["runs.moment"][-1], abs=1e-4)
    assert np.abs(one["runs.moment"][-1]).min() > 1e-2
    assert np.abs(one["runs.thrust"]).max() < 1e-8 * np.abs(one["runs.force"]).max()
    assert np.abs(one["runs.power"]).max() < 1e-5


@pytest.mark.filterwarnings("ignore")
def test_two_wheels_of_a_shorter_and_shorter_base_leave_it_free_to_roll():
    """They do what the axis along the path does, see the same in a plane."""
    along = np.array([np.cos(0.5), np.sin(0.5), 0.0])
    result = simulate(arm(beside=0.08, joint={"axis": along}, bodies=1, modes=4), 1e-3, 0.2)
    limit, errors = np.r_[result["runs.way"][-1], angle_of(result)], []
    assert np.abs(angle_of(result)[:2]).max() > 0.1
    for half in (0.05, 0.0125):
        one = simulate(arm(beside=0.08, half=half, bodies=1, modes=4), 1e-3, 0.2)
        errors.append(np.linalg.norm(np.r_[(one["rear.way"] + one["front.way"])[-1] / 2,
                                           angle_of(one)] - limit))
    assert errors[1] < errors[0] / 4


RADIUS, PITCH, MASS, CENTRE = 1.5, 0.4, 2.0, np.array([0.1, 0.25, -0.2])
INERTIA, FIELD = np.array([[0.3, 0.02, 0.0], [0.02, 0.2, 0.01], [0.0, 0.01, 0.25]]), np.array(
    [1.0, -4.0, -3.0])


def helix(t):
    return np.array([RADIUS * np.cos(t), RADIUS * np.sin(t), PITCH * t])


def helical(on=None, **given):
    """A body on a helix to which it keeps its orientation; on the ground or on a node."""
    model, begin = Model(), 0.7
    if on:
        model.fix(model.node(on, (0.3, 0.1, -0.2)))
    model.path("rail", on=on, points=[helix(t) for t in np.linspace(-0.5, 4.0, 181)])
    node = model.node("car", helix(begin))
    model.rigid_body("body", node, MASS, INERTIA, centre=helix(begin) + CENTRE)
    model.gravity(FIELD)
    model.path_joint(node, "rail", turns="with", name="runs", **given)
    return model


def reduced():
    """Rotation, M and V of one equation: the kinetic energy is M(u) u'^2 / 2.

    A triad without twist turns by t x t'.
    """
    grid = np.linspace(-0.45, 0.7, 601)
    slope = np.stack([-RADIUS * np.sin(grid), RADIUS * np.cos(grid), PITCH + 0 * grid], axis=1)
    bend = np.stack([-RADIUS * np.cos(grid), -RADIUS * np.sin(grid), 0 * grid], axis=1)
    spin = CubicSpline(grid, np.cross(slope, bend) / (RADIUS**2 + PITCH**2))
    turned = solve_ivp(lambda u, R: np.cross(spin(u), R.reshape(3, 3), axisb=0, axisc=0).ravel(),
                       (0.7, -0.45), np.eye(3).ravel(), "DOP853", dense_output=True,
                       rtol=1e-11, atol=1e-12).sol
    R = turned(grid).T.reshape(-1, 3, 3)
    arms, w = R @ CENTRE, spin(grid)
    own = np.einsum("kij,ki->kj", R, w)
    M = CubicSpline(grid, MASS * np.sum((slope + np.cross(w, arms))**2, axis=1)
                    + np.sum(own * (own @ INERTIA), axis=1))
    V = CubicSpline(grid, -MASS * (helix(grid).T + arms) @ FIELD)
    return turned, M, V


def expected(times):
    """Angles along the helix and rotations of the body."""
    turned, M, V = reduced()
    found = solve_ivp(lambda _, z: [z[1], -(M(z[0], 1) * z[1]**2 / 2 + V(z[0], 1)) / M(z[0])],
                      (0.0, times[-1]), [0.7, 0.0], "DOP853", times, rtol=1e-10, atol=1e-12)
    return found.y[0], turned(found.y[0]).T.reshape(-1, 3, 3)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("on", [None, "hub"])
def test_a_body_on_a_helix_keeps_to_a_triad_without_twist(on):
    """Place and rotation by one equation of motion, to second order in the step."""
    errors = []
    for h in (2e-3, 1e-3):
        result = simulate(helical(on), h, 0.8)
        u, R = expected(result.t)
        errors.append([np.abs(result["car.position"] - helix(u).T).max(),
                       np.abs(result["car.rotation"] - R).max()])
    assert abs(u[-1] - 0.7) > 0.5
    assert np.all(np.array(errors[1]) < 1e-6)
    assert np.all(np.array(errors[0]) > 3.0 * np.array(errors[1]))


@pytest.mark.filterwarnings("ignore")
def test_small_motions_on_a_helix():
    """Rest where a spring along the path holds the weight, and the frequency about it."""
    model, stiffness, length = helical(), 400.0, 1.5
    model.spring("runs", stiffness=stiffness, length=length)
    state = equilibrium(model)
    x, y, _ = state["car.position"][-1]
    (_, M, V), u, slope = reduced(), np.arctan2(y, x), np.hypot(RADIUS, PITCH)
    assert stiffness * (state["runs.way"][-1] - length) * slope == pytest.approx(-V(u, 1), rel=1e-3)
    assert vibrations(state).omega[0] == pytest.approx(
        np.sqrt((V(u, 2) + stiffness * slope**2) / M(u)), rel=1e-4)


@pytest.mark.filterwarnings("ignore")
def test_friction_takes_all_energy_that_is_lost():
    model = helical()
    model.friction("runs", 0.1, name="rubs")
    result = simulate(model, 5e-4, 0.6)
    energy = result["energy.kinetic"] + result["energy.potential"]
    rub = 0.1 * result["runs.normal_force"] * np.abs(result["runs.rate"])
    assert energy[0] - energy[-1] > 0.1
    assert np.trapezoid(rub, result.t) == pytest.approx(energy[0] - energy[-1], rel=1e-3)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("index", [2, 3])
def test_it_is_resumed_where_it_stopped(index):
    """With either way to solve the equations, which differ by the square of the step."""
    scheme = generalized_alpha(0.9, index=index, tolerance=1e-12)
    whole = simulate(helical(), 1e-3, 0.2, scheme)
    run = Simulation(helical(), 1e-3, scheme)
    run.run_to(0.1)
    again = run.run_to(0.2).result()
    for name in ("runs.way", "car.rotation", "runs.moment"):
        assert np.abs(again[name][-1] - whole[name][-1]).max() < 1e-9 * np.abs(whole[name]).max()
    assert whole["car.position"][-1] == pytest.approx(helix(expected(whole.t)[0][-1]), abs=1e-6)


@pytest.mark.filterwarnings("ignore")
def test_a_weight_beside_the_path_twists_the_beam():
    """By its moment times length over G J, and bends it, at the end of the first of two bodies."""
    model, section = Model(), rectangle(0.01, 0.04, youngs_modulus=7e10, poisson_ratio=0.25,
                                        density=1e-6)
    root, tip = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (2.0, 0.0, 0.0))
    model.beam("arm", (root, tip), section, elements=8, bodies=2, up=(0.0, 1.0, 0.0),
               stiffening=False)
    model.fix(root)
    car = model.node("car", (1.0, 0.0, 0.0))
    mass, beside = 0.02, 0.1
    model.rigid_body("weight", car, mass, (1e-3, 1e-3, 1e-3), centre=(1.0, beside, 0.0))
    model.gravity((0.0, 0.0, -G))
    model.path("rail", on="arm")
    model.path_joint(car, "rail", turns="with", name="runs")
    model.drive_way("runs", (lambda t: 0.0, lambda t: 0.0, lambda t: 0.0))
    state = equilibrium(model)
    turned = Rotation.from_matrix(state["car.rotation"][-1]).as_rotvec()
    force = mass * G
    shear = section.youngs_modulus / 2 / (1 + section.poisson_ratio)
    assert turned[0] == pytest.approx(-force * beside / (shear * section.torsion), rel=1e-6)
    assert turned[1] == pytest.approx(force / (2 * section.youngs_modulus * section.inertia_y),
                                      rel=1e-6)
    assert state["runs.moment"][-1] == pytest.approx([force * beside, 0.0, 0.0], rel=1e-3, abs=1e-6)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("planar", [True, False])
def test_beyond_a_straight_end_a_path_does_not_turn(planar):
    """A node with little inertia leaves an arc along its tangent."""
    angles = np.linspace(0.0, 1.0, 41)
    model = Model(planar=planar)
    points = np.stack([np.sin(angles), 1 - np.cos(angles), 0 * angles], axis=1)
    model.path("arc", points=points[:, :2] if planar else points, ends="straight")
    end = points[30]
    car = model.node("car", end[:2] if planar else end)
    model.rigid_body("car", car, 1.0, 1e-6 if planar else (1e-6, 1e-6, 1e-6))
    model.path_joint(car, "arc", turns="with", name="runs", rate=1.0)
    result = simulate(model, 2e-3, 0.6)
    assert result["runs.way"][-1] > 1.3
    turned = result["car.rotation"][-1] if planar else angle_of(result)[2]
    assert turned == pytest.approx(0.25, abs=1e-4)
    along = result["car.velocity"][-1]
    assert along[1] / along[0] == pytest.approx(np.tan(1.0), rel=1e-3)


SLOPE = tuple(np.array([-RADIUS * np.sin(0.7), RADIUS * np.cos(0.7), PITCH]))


def test_malformed_turns_in_space_are_refused():
    model = helical()
    free = model.node("free", helix(0.7))
    for given, message in (
            ({"axis": "z"}, "path joint at 'free': axis is of a node that turns with the path"),
            ({"turns": "with", "axis": (0.0, 0.0, 0.0)}, "axis"),
            ({"turns": "with", "axis": (1.0, 0.0)}, "axis"),
            ({"turns": "with", "axis": "w"}, "axis"),
            ({"turns": "with", "axis": (np.nan, 0.0, 1.0)}, "axis"),
            ({"across": "level"}, "axis of the freedom across a path at 'free'"),
            ({"across": SLOPE}, "across is .* which is along path 'rail': give a direction")):
        with pytest.raises(InputError, match=message):
            model.path_joint(free, "rail", **given)
    point = model.node("point", helix(0.7), "translation")
    with pytest.raises(InputError, match="'point'.* rotation"):
        model.path_joint(point, "rail", turns="with")
    flat = Model(planar=True)
    flat.path("line", points=[(0, 0), (1, 0)])
    with pytest.raises(InputError, match="axis is of models in space; in a plane a node turns"):
        flat.path_joint(flat.node("car", (0.5, 0)), "line", turns="with", axis="z")
    with pytest.raises(InputError, match="across is of models in space; in a plane the path"):
        flat.path_joint("car", "line", across="free")
    assert len(model.joints) == 1 and not flat.joints
    model.path("mast", points=[(0, 0, 0), (0, 0, 2)])
    bead = model.node("bead", (0, 0, 1), "translation")
    with pytest.raises(InputError, match="across='free' is level, and path 'mast' goes along the "
                                         "z axis somewhere"):
        model.path_joint(bead, "mast", across="free")
    model.path_joint(bead, "mast", across="x", name="slides")
    with pytest.raises(InputError, match="leaves the node of joint 'slides' free across, so fric"):
        model.friction("slides", 0.1)
    model.friction("slides", 0.0, preload=3.0, reaction=False)


RATE, SPEED = 3.0, 0.4


def sweeping(turn=None):
    """A bead that is free across a rail, which turns about itself and so sweeps the bead along."""
    R = turn or Rotation.identity()
    model = Model()
    axis, across, up = R.as_matrix().T
    hub = model.node("hub", R.apply([-0.3, 0.0, 0.0]))
    model.rigid_body("hub", hub, 1.0, (0.1, 0.1, 0.1))
    model.drive_angle(model.revolute(hub, axis), lambda t: RATE * t)
    model.path("rail", on=hub, points=[R.apply([x, 0.0, 0.0]) for x in (0.0, 1.0, 2.0)])
    bead = model.node("bead", R.apply([0.5, 0.0, 0.0]), "translation")
    model.initial_velocity(bead, R.apply([0.2, SPEED, 0.0]))
    model.point_mass("bead", bead, 2.0)
    model.path_joint(bead, "rail", across="free" if turn is None else across, name="runs")
    return model


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("turn", [None, TURNED])
def test_a_bead_that_is_free_across_is_swept_by_a_turning_rail(turn):
    """Its distance y from the rail obeys y'' = w^2 y, and the rail pushes it with 2 m w y'."""
    result = simulate(sweeping(turn), 1e-3, 0.5)
    R, (y, rate) = turn or Rotation.identity(), (
        SPEED / RATE * np.sinh(RATE * 0.5), SPEED * np.cosh(RATE * 0.5))
    out = np.array([0.0, np.cos(RATE * 0.5), np.sin(RATE * 0.5)])
    push = np.array([0.0, -out[2], out[1]])
    assert result["bead.position"][-1] == pytest.approx(
        R.apply(np.array([0.6, 0.0, 0.0]) + y * out), abs=2e-6)
    assert result["runs.way"][-1] == pytest.approx(0.6, abs=1e-7)
    assert result["runs.force"][-1] == pytest.approx(
        R.apply(2 * 2.0 * RATE * rate * push), abs=2e-4)
    assert np.abs(result["runs.thrust"]).max() < 1e-9
    assert np.abs(result["runs.power"]).max() < 1e-5


@pytest.mark.filterwarnings("ignore")
def test_freedom_across_a_flexible_path_turns_with_the_model():
    """On an arm of two bodies that hand over to each other, which falls and bends."""
    found = []
    for turn, shift in ((Rotation.identity(), np.zeros(3)), (TURNED, SHIFT)):
        model, along = Model(), np.array([1.0, 0.0, 0.0])
        base, tip = (model.node(name, turn.apply(x * along) + shift)
                     for name, x in (("base", 0.0), ("tip", 2.0)))
        model.beam("arm", (base, tip), rectangle(0.01, 0.04, **STEEL), elements=20, bodies=2,
                   modes=2, up=turn.apply([0.0, 1.0, 0.0]))
        model.revolute(base, turn.apply([0.0, 0.0, 1.0]))
        bead = model.node("bead", turn.apply(0.98 * along) + shift, "translation")
        model.point_mass("bead", bead, 0.3)
        model.gravity(turn.apply([1.0, -G, 0.8]))
        model.path("rail", on="arm", blend=0.1)
        model.path_joint(bead, "rail", across=turn.apply([0.0, 0.1, 1.0]), name="runs")
        found.append(simulate(model, 1e-3, 0.15, EXACT))
    one, other = found
    assert one["bead.position"][-1][2] > 5e-3
    assert TURNED.inv().apply(other["bead.position"][-1] - SHIFT) == pytest.approx(
        one["bead.position"][-1], abs=1e-8)
    force = one["runs.force"][-1]
    assert TURNED.inv().apply(other["runs.force"][-1]) == pytest.approx(force, abs=1e-4)
    assert np.abs(one["runs.power"]).max() < 1e-6
