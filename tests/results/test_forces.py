"""Forces of joints, drives and loads as vectors, against closed forms and the bodies' motion."""

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.scenes import heavy_top

AXIS = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
ACROSS = np.array([2.0, -1.0, 0.0]) / np.sqrt(5.0)
GRAVITY = np.array([1.0, -2.0, -9.0])
FINE = generalized_alpha(0.9, 1e-12)
MASS, MOMENT, ARM = 2.0, 0.35, 0.8


def turned(planar=False):
    """Unit vectors along the axis of a hinge, along the pendulum's arm, and across both."""
    return (np.eye(3)[[2, 0, 1]] if planar else
            np.array([AXIS, ACROSS, np.cross(AXIS, ACROSS)]))


def pendulum(explicit=False, planar=False):
    """A rod on a hinge whose axis is not level, with a spin: the moment bears the weight, too."""
    model = Model(planar=planar)
    e, along, across = turned(planar)
    d = 2 if planar else 3
    start = np.array([0.3, -0.2, 0.5])[:d]
    inertia = MOMENT if planar else MOMENT * (np.outer(e, e) + np.outer(across, across))
    model.rigid_body("rod", model.node("pin", start), MASS, inertia, start + ARM * along[:d])
    model.revolute("pin", e, explicit=explicit, name="hinge")
    model.initial_velocity("pin", angular=1.5 if planar else 1.5 * e)
    model.gravity(GRAVITY[:d])
    return model


def closed_form(r, rate, planar):
    """Force and moment of the hinge: r from the hinge to the centre of mass, rate of the angle."""
    e = turned(planar)[0]
    weight = MASS * GRAVITY * ([1.0, 1.0, 0.0] if planar else 1.0)
    whole = MOMENT + MASS * ARM**2
    acceleration = (np.cross(r, weight) @ e / whole)[:, None]
    force = MASS * (acceleration * np.cross(e, r) - rate[:, None]**2 * r) - weight
    return force, whole * acceleration * e - np.cross(r, weight)


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("explicit", [False, True])
def test_hinge_of_a_pendulum(explicit, planar):
    """``F = m (a - g)`` and ``M = J w' e - r x m g``, with the speed from the balance of energy."""
    result = simulate(pendulum(explicit, planar), 1e-3, 0.3, FINE)
    e, along, across = turned(planar)
    if planar:
        angle = result["pin.rotation"]
        r = ARM * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    else:
        r = ARM * result["pin.rotation"] @ along
    fall = MASS * (r - r[0]) @ (GRAVITY * ([1.0, 1.0, 0.0] if planar else 1.0))
    rate = np.sqrt(1.5**2 + 2.0 * fall / (MOMENT + MASS * ARM**2))
    force, moment = closed_form(r, rate, planar)
    local_force = np.stack([force @ e, np.sum(force * r, axis=1) / ARM,
                            np.sum(force * np.cross(e, r), axis=1) / ARM], axis=1)
    wrong = 1e-5 * np.abs(force).max()      # the angle is off by the square of the step
    if planar:
        assert np.abs(result["hinge.force"] - force[:, :2]).max() < wrong
        assert result["hinge.moment"].shape == (301,) and np.abs(result["hinge.moment"]).max() == 0
        assert np.abs(result["hinge.local_force"] - local_force[:, 1:]).max() < wrong
        return
    assert np.abs(result["hinge.force"] - force).max() < wrong
    assert np.abs(result["hinge.moment"] - moment).max() < wrong
    local = result["hinge.local_force"], result["hinge.local_moment"]
    assert np.abs(local[0][:, 0] - local_force[:, 0]).max() < wrong     # along the axis
    assert np.abs(local[1][:, 0]).max() < 1e-9                          # a hinge turns freely
    for own, vector in zip(local, (force, moment), strict=True):
        assert np.linalg.norm(own, axis=1) == pytest.approx(np.linalg.norm(vector, axis=1),
                                                            rel=1e-4)
    assert np.abs(result["rod.pin.force"] - force).max() < wrong        # nothing else is on it
    assert np.abs(result["rod.pin.moment"] - moment).max() < wrong
    assert result["rod.forces"] == pytest.approx(
        np.hstack([result["rod.pin.force"], result["rod.pin.moment"]]))
    # the change of momentum, in space
    weight = MASS * GRAVITY
    change = np.diff(result["momentum"], axis=0) / 1e-3 - weight
    assert np.abs(change - 0.5 * (force[1:] + force[:-1])).max() < 1e-3 * np.abs(force).max()


def tree(explicit=False):
    """Three rigid bodies, joined at the ends of rigid links, with loads and springs on them."""
    model = Model()
    points = np.random.default_rng(1).normal(size=(4, 3))
    for k in range(3):
        centre = model.node(f"centre {k}", (points[k] + points[k + 1]) / 2)
        model.rigid_body(f"body {k}", centre, 1.0 + k, (0.2, 0.3, 0.4))
        model.attach(f"left {k}", points[k], centre)
        model.attach(f"right {k}", points[k + 1], centre)
    model.revolute("left 0", AXIS, explicit=explicit, name="hinge")
    model.universal("left 1", AXIS, ACROSS, to="right 0", explicit=explicit, name="cross")
    model.weld("right 1", to="left 2", explicit=explicit, name="weld")
    model.force("right 2", (1.0, 2.0, 3.0), name="push")
    model.torque("centre 1", (0.1, -0.2, 0.3), name="twist")
    model.spring("right 2", "left 0", 3.0, damping=0.2, length=0.5, name="spring")
    model.bushing("left 2", "right 1", 5.0, turning_stiffness=2.0, name="rubber")
    model.gravity(GRAVITY)
    return model


@pytest.mark.parametrize("explicit", [False, True])
def test_forces_move_the_bodies(explicit):
    """Forces and moments of joints, spring and loads on every body are its mass times its motion.

    The moment about the centre is compared at the start, where nothing turns: ``J w'``.
    """
    result = Simulation(tree(explicit), 0.01).run_to(0.1).result()

    def at(name, node, sign=1.0):
        """A force, and its moment about the centre of the node's body."""
        r = result[f"{node}.position"] - result[f"centre {node[-1]}.position"]
        moment = np.zeros_like(r) if name in ("push", "spring") else result[f"{name}.moment"]
        force = result[f"{name}.force"]
        return sign * force, sign * (moment + np.cross(r, force))

    stretch = result["left 0.position"] - result["right 2.position"]
    length = np.linalg.norm(stretch, axis=1)
    along = stretch / length[:, None]
    rate = np.sum((result["left 0.velocity"] - result["right 2.velocity"]) * along, axis=1)
    expected = (3.0 * (length - 0.5) + 0.2 * rate)[:, None] * along
    assert result["spring.force"] == pytest.approx(expected, rel=1e-9)
    assert result["twist.moment"] == pytest.approx(np.tile([0.1, -0.2, 0.3], (11, 1)))
    no_force = np.zeros((11, 3))
    on = [[at("hinge", "left 0"), at("cross", "right 0", -1.0), at("spring", "left 0", -1.0)],
          [at("cross", "left 1"), at("weld", "right 1"), (no_force, result["twist.moment"]),
           at("rubber", "right 1", -1.0)],
          [at("weld", "left 2", -1.0), at("push", "right 2"), at("spring", "right 2"),
           at("rubber", "left 2")]]
    for k, wrenches in enumerate(on):
        forces, moments = (np.sum(v, axis=0) for v in zip(*wrenches, strict=True))
        inertia = (1.0 + k) * (result[f"centre {k}.acceleration"] - GRAVITY)
        # what Newton's iteration leaves: 1e-7 of the forces in a step
        assert np.abs(forces - inertia).max() < 1e-6 * np.abs(inertia).max()
        start = np.array([0.2, 0.3, 0.4]) * result[f"centre {k}.angular_acceleration"][0]
        assert moments[0] == pytest.approx(start, abs=1e-9)


def test_joints_with_and_without_equations_pass_the_same():
    results = [simulate(tree(explicit), 0.01, 0.1, FINE) for explicit in (False, True)]
    assert results[0].numbering.free < results[1].numbering.free
    for joint in ("hinge", "cross", "weld"):
        for quantity in ("force", "moment", "local_force", "local_moment"):
            one, other = (r[f"{joint}.{quantity}"] for r in results)
            assert np.abs(one - other).max() < 1e-6 * max(np.abs(other).max(), 1.0)


def door(hinges):
    """A door on hinges along one turned axis; every one but the first is at the end of a link."""
    model = Model()
    place = np.array([0.3, -0.2, 0.5])
    model.rigid_body("door", model.node("hinge 0", place), 3.0, (0.3, 0.5, 0.4),
                     centre=place + 0.4 * ACROSS + 0.5 * AXIS)
    for k in range(hinges):
        if k:
            model.attach(f"hinge {k}", place + k * AXIS, "hinge 0")
        model.revolute(f"hinge {k}", AXIS, name=f"joint {k}")
    model.gravity(GRAVITY)
    return model


def test_redundant_hinges_share_the_total():
    """Forces of two hinges, and their moments about the first, add up to those of one."""
    one, two = (Simulation(door(n), 0.01).result() for n in (1, 2))
    assert two.start.redundant and not one.start.redundant
    force = two["joint 0.force"] + two["joint 1.force"]
    assert force == pytest.approx(one["joint 0.force"], abs=1e-9)
    moment = (two["joint 0.moment"] + two["joint 1.moment"]
              + np.cross(AXIS, two["joint 1.force"]))
    assert moment == pytest.approx(one["joint 0.moment"], abs=1e-9)
    assert np.abs(two["joint 1.force"]).max() > 1.0


def test_two_hinges_without_equations_bear_half_each():
    """Both fix the same position, so either may bear everything: the least forces are halves."""
    model = Model(planar=True)
    for name in ("left", "right"):
        model.rigid_body(name, model.node(name, (0.0, 0.0)), 2.0, 0.1, centre=(0.0, -1.0))
    model.weld("left", to="right", name="weld")
    for name in ("left", "right"):
        model.revolute(name, name=f"{name} hinge")
    model.gravity((0.0, -9.81))
    result = Simulation(model, 0.01).result()
    total = 4.0 * 9.81
    assert result["left.reaction"][0] == pytest.approx([0.0, total])
    # two hinges and the weld between them: the bodies are alike, so the weld passes nothing
    for name in ("left", "right"):
        assert result[f"{name} hinge.force"][0] == pytest.approx([0.0, total / 2])
        assert result[f"{name}.{name}.force"][0] == pytest.approx([0.0, total / 2])
    assert np.abs(result["weld.force"]).max() < 1e-12


def test_a_joint_of_nodes_made_at_one_place_passes_all():
    """`at=` shares the position, the joint built afterwards is what bears the hanging body."""
    model = Model()
    place = np.array([0.3, -0.2, 0.5])
    model.rigid_body("upper", model.node("top", place), 1.0, (0.1, 0.2, 0.3))
    model.node("bottom", place, at="top")
    model.rigid_body("lower", "bottom", 2.0, (0.1, 0.2, 0.3), centre=place + 0.5 * AXIS)
    model.fix("top")
    model.revolute("bottom", AXIS, to="top", name="hinge")
    model.gravity(9.81 * -AXIS)
    result = Simulation(model, 0.01).result()
    assert result["hinge.force"][0] == pytest.approx(2.0 * 9.81 * AXIS)
    assert result["hinge.local_force"][0] == pytest.approx([2.0 * 9.81, 0.0, 0.0], abs=1e-9)
    assert result["top.reaction"][0] == pytest.approx(3.0 * 9.81 * AXIS)


def angle(t):
    return 0.4 * np.sin(3.0 * t)


def angle_rate(t):
    return 1.2 * np.cos(3.0 * t)


def angle_second(t):
    return -3.6 * np.sin(3.0 * t)


@pytest.mark.parametrize("planar", [False, True])
def test_torque_of_a_drive(planar):
    """``J w'' + m g x r`` about the axis; its power is the torque times the rate."""
    model = pendulum(planar=planar)
    e, along, _ = turned(planar)
    motor = model.drive_angle("pin", (angle, angle_rate, angle_second), e, name="motor")
    assert model.element("motor") is motor
    model.nodes["pin"].rotation.given = False
    result = simulate(model, 2e-3, 1.0, FINE)
    t = result.t
    r = ARM * (np.stack([np.cos(angle(t)), np.sin(angle(t)), 0 * t], axis=1) if planar else
               result["pin.rotation"] @ along)
    weight = MASS * GRAVITY * ([1.0, 1.0, 0.0] if planar else 1.0)
    torque = (MOMENT + MASS * ARM**2) * angle_second(t) - np.cross(r, weight) @ e
    later = t > 0.4         # multipliers of index 3 settle from the accelerations of the start
    size = np.abs(torque).max()
    assert np.abs(result["motor.torque"] - torque)[later].max() < 1e-4 * size
    # with index 3 rates are off by the square of the step
    assert result["motor.power"] == pytest.approx(result["motor.torque"] * angle_rate(t),
                                                  abs=2e-5 * size)
    energy = 0.5 * (MOMENT + MASS * ARM**2) * angle_rate(t)**2 - r @ weight
    assert result["motor.work"] == pytest.approx(energy - energy[0], abs=2e-5 * size)
    if not planar:      # as a vector it is along the axis, and the hinge gives the rest
        assert np.abs(np.cross(result["motor.moment"], e)).max() < 1e-6 * size
        assert result["motor.local_moment"][:, 0] == pytest.approx(result["motor.torque"])
    with pytest.raises(InputError, match="drive 'motor' moves a rotation: ask for motor.torque"):
        result["motor.thrust"]
    with pytest.raises(InputError, match="'velocity' is unknown: a joint has multipliers, force, "
                                         "moment, local_force, local_moment, angle, rate, "
                                         "displacement, speed; a drive has torque"):
        result["motor.velocity"]


def test_thrust_of_drives():
    """A mass is lifted along a slope, by a drive of a slide and by a moved node: ``m (a - g)``."""
    found = []
    motion = (angle, angle_rate, angle_second)
    for moved in (False, True):
        model = Model()
        model.point_mass("car", model.node("car", (0.0, 0, 0)), 2.0)
        model.rigid_body("frame", "car", 1.0, (0.1, 0.2, 0.3))
        model.point_mass("dust", model.node("dust", (5.0, 0, 0), keeps="translation"), 1.0)
        model.gravity(GRAVITY)
        if moved:
            model.fix("car", "rotation")
            model.move("car", ACROSS, motion, name="winch")
        else:
            rail = model.node("rail", (0.0, 0, 0))
            model.fix(rail)
            model.prismatic(rail, ACROSS, to="car", name="guide")
            model.drive_slide(rail, motion, -ACROSS, to="car", name="winch")
        result = simulate(model, 2e-3, 0.6, FINE)
        expected = 3.0 * (angle_second(result.t) - GRAVITY @ ACROSS)
        later = result.t > 0.4
        assert np.abs(result["winch.thrust"] - expected)[later].max() < 1e-4 * 30.0
        assert result["winch.power"] == pytest.approx(
            result["winch.thrust"] * angle_rate(result.t), abs=2e-5 * 30.0)
        found.append(result)
    with pytest.raises(InputError, match="drive 'winch' moves a position: ask for winch.thrust"):
        found[1]["winch.torque"]
    # the rail bears what is across the slope, on the car; the force of a joint is on its `node`
    across = -3.0 * (GRAVITY - GRAVITY @ ACROSS * ACROSS)
    assert -found[0]["guide.force"][-1] == pytest.approx(across, abs=1e-3)
    assert np.abs(found[0]["guide.local_force"][:, 0]).max() < 1e-9


def test_a_rod_is_in_tension():
    """A mass on a rod without mass: the force on the support points to the mass."""
    model = Model()
    model.fix(model.node("top", (0.0, 0, 0), keeps="translation"), "position")
    model.point_mass("bob", model.node("bob", 0.7 * AXIS, keeps="translation"), 1.5)
    model.distance("top", "bob", name="rod")
    model.gravity(9.81 * AXIS)
    result = Simulation(model, 0.01).result()
    assert result["rod.force"][0] == pytest.approx(1.5 * 9.81 * AXIS)
    assert result["rod.local_force"][0] == pytest.approx([1.5 * 9.81, 0.0, 0.0], abs=1e-9)
    assert np.abs(result["rod.moment"]).max() == 0.0


@pytest.mark.parametrize("index", [2, 3])
def test_both_indices_give_the_same_force(index):
    """The support of a top: Newton's law for its mass, with constraints of either index."""
    model = heavy_top.build(True).model
    result = simulate(model, 1e-3, 0.05, generalized_alpha(0.9, 1e-11, index=index))
    name, body = model.joints[0].name, next(iter(model.rigid_bodies))
    mass = model.rigid_bodies[body].constants["mass"]
    expected = mass * (result["centre.acceleration"] - model.gravity_field)
    assert result[f"{name}.force"] == pytest.approx(expected, rel=1e-6, abs=1e-6)
