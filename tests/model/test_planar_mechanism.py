"""A planar model in the place of a spatial mechanism: joints, drives and loads act alike."""

import numpy as np
import pytest
from in_plane import (
    EXACT,
    FLAT,
    STEPS,
    TURN,
    H,
    Z,
    assert_same,
    at,
    beam,
    reduced,
    rigid,
    wind,
)

from sebody import Model, harmonic, simulate
from sebody.model.variants import planar


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
    model.drive_slide(wheel, harmonic(3.0, 4.0), TURN @ (-1, 0, 0), to=rider, name="pusher")
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


def test_a_bushing_that_turns_follows_its_angle():
    """In space its energy is that of the sine: a moment less by two thirds of the angle squared."""
    model = beam(FLAT)
    model.bushing("tip", stiffness=20.0, turning_stiffness=300.0, name="rubber")
    made, sentence = planar(model)
    assert sentence.endswith(" unknowns; moments of rubber follow angles, in space their sines")
    found, expected = (simulate(one, H, STEPS * H, EXACT) for one in (made, model))
    moment = made.plane.to_space("rubber.moment", found["rubber.moment"])
    angle = np.abs(found["tip.rotation"]).max()
    size = np.abs(moment).max()
    assert 1e-3 < angle < 0.1
    assert np.abs(moment - expected["rubber.moment"]).max() < angle**2 * size


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
