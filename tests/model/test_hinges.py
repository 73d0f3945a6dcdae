"""Springs and drives about the axis of a hinge: by its name, by default, about no other axis."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, ramp, rest_to_rest, simulate

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
AXIS, ACROSS, OTHER = TURN.T
PLACE = np.array([2.0, -1.0, 0.5])
K, REST, J = 5.0, 1.0, 0.4


def door(mounted=False, axis=AXIS, kind="revolute"):
    """A body on a hinge in general position, on the ground or on a heavy mount."""
    model = Model()
    model.rigid_body("leaf", model.node("a", PLACE), 1.0, TURN @ np.diag((J, 0.3, 0.2)) @ TURN.T)
    if mounted:
        model.rigid_body("mass", model.node("mount", PLACE), 1e9, (1e9, 1e9, 1e9))
    getattr(model, kind)("a", axis, to="mount" if mounted else None, name="hinge")
    return model


SPRINGS = {"by its name": lambda m, **to: m.torsion_spring("hinge", K, rest=REST, name="coil"),
           "the joint": lambda m, **to: m.torsion_spring(m.element("hinge"), K, rest=REST,
                                                        name="coil"),
           "by default": lambda m, **to: m.torsion_spring("a", K, rest=REST, name="coil", **to)}


@pytest.mark.parametrize("mounted", [False, True])
@pytest.mark.parametrize("way", SPRINGS)
def test_a_spring_turns_its_hinge(way, mounted):
    """In closed form: REST (1 - cos sqrt(k/J) t)."""
    model = door(mounted)
    SPRINGS[way](model, **({"to": "mount"} if mounted else {}))
    result = simulate(model, 0.002, 0.4)
    exact = REST * (1 - np.cos(np.sqrt(K / J) * result.t))
    assert result["hinge.angle"] == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("kind", ["revolute", "cylindrical"])
def test_a_drive_turns_its_hinge(kind):
    for drive in (lambda m: m.drive_angle("hinge", rest_to_rest(1.0, 1.0), name="motor"),
                  lambda m: m.drive_angle("a", rest_to_rest(1.0, 1.0), name="motor")):
        model = door(kind=kind)
        drive(model)
        result = simulate(model, 0.01, 1.0)
        assert result["hinge.angle"][-1] == pytest.approx(1.0)
        assert result["motor.power"] == pytest.approx(
            result["motor.torque"] * result["hinge.rate"], abs=1e-9)


def chain():
    """Two bodies: one on the ground about AXIS, the other on it about ACROSS."""
    model = door()
    for name in ("b", "c"):
        model.node(name, PLACE)
    model.rigid_body("second", "b", 1.0, (1, 1, 1))
    model.revolute("b", ACROSS, to="a", name="elbow")
    return model


def axis_of(element):
    return np.cross(element.vector("n"), element.vector("m"))


def test_the_default_axis_is_that_of_the_one_hinge():
    """Of the hinges between both nodes, else of those of the node; z where there is none."""
    model = chain()
    assert axis_of(model.torsion_spring("b", 1.0, to="a")) == pytest.approx(ACROSS)
    assert axis_of(model.torsion_spring("b", 1.0)) == pytest.approx(ACROSS)
    assert axis_of(model.torsion_spring("a", 1.0, to="b")) == pytest.approx(ACROSS)
    assert axis_of(model.torsion_spring("a", 1.0)) == pytest.approx(AXIS)
    assert axis_of(model.torsion_spring("c", 1.0)) == pytest.approx((0, 0, 1))
    model.revolute("b", OTHER, to="c", name="wrist")
    with pytest.raises(InputError, match="torsion spring: node 'b' has hinges about several axes, "
                                         "'elbow', 'wrist': give one of these joints in place"):
        model.torsion_spring("b", 1.0)
    assert axis_of(model.torsion_spring("wrist", 1.0)) == pytest.approx(OTHER)


@pytest.mark.parametrize("axis", [AXIS, ACROSS])
def test_a_universal_joint_is_driven_about_either_axis(axis):
    model = door()
    model.rigid_body("second", model.node("b", PLACE), 1.0, (1, 1, 1))
    model.universal("b", ACROSS, AXIS, to="a")
    model.drive_angle("b", ramp(0.5), axis=axis, to="a")
    assert simulate(model, 0.01, 0.1)["b.rotation"].shape == (11, 3, 3)


def test_an_attached_node_turns_with_its_root():
    model = door()
    model.attach("edge", PLACE + ACROSS, "a")
    assert axis_of(model.torsion_spring("edge", 1.0)) == pytest.approx(AXIS)


MOTION = rest_to_rest(1.0, 1.0)


@pytest.mark.parametrize("build, message", [
    (lambda m: m.torsion_spring("a", K, axis=ACROSS, name="coil"),
     "'coil' is about .* which revolute 'hinge' forbids, since it turns about .*: give the joint"),
    (lambda m: m.drive_angle("a", MOTION, axis=(0, 0, 1), name="motor"),
     "'motor' is about .*0, 0, 1.* which revolute 'hinge' forbids"),
    (lambda m: (m.universal("b", ACROSS, AXIS, to="a", name="cross"),
                m.drive_angle("b", MOTION, axis=np.cross(AXIS, ACROSS), to="a", name="motor")),
     "'motor' is about .* which universal 'cross' forbids, since it turns about .* and .*: give"),
    (lambda m: m.torsion_spring("hinge", K, axis=AXIS),
     "torsion spring is given joint 'hinge', which has an axis and two nodes: leave axis and to"),
    (lambda m: m.drive_angle("hinge", MOTION, to="b"), "drive is given joint 'hinge'"),
    (lambda m: m.torsion_spring(door().element("hinge"), K),
     "torsion spring: joint 'hinge' is of another model: use that of this one"),
    (lambda m: m.torsion_spring("hinges", K), "node 'hinges' is unknown"),
    (lambda m: (m.weld("b", to="a", explicit=True, name="glue"),
                m.torsion_spring("b", K, to="a", name="coil")),
     "'coil' acts on the angle of two nodes that weld 'glue' keeps from turning"),
    (lambda m: (m.spherical("b", to="a", name="ball"), m.torsion_spring("ball", K)),
     "'ball' is a spherical, which does not turn about one axis: give a revolute or cylindrical"),
    (lambda m: (m.revolute("b", AXIS, to="a", name="b2"), m.node("b2", PLACE),
                m.torsion_spring("b2", K)),
     "'b2' is a node and a joint, of other nodes: give the Joint or the Node itself")])
def test_what_is_refused(build, message):
    model = door()
    model.rigid_body("second", model.node("b", PLACE), 1.0, (1, 1, 1))
    with pytest.raises(InputError, match=message):
        build(model)


@pytest.mark.parametrize("build", [lambda m: m.torsion_spring("a", K, name="early"),
                                   lambda m: m.drive_angle("a", MOTION, name="early")])
def test_what_is_older_than_its_hinge_is_refused_at_the_start(build):
    """It is about z, or about an axis that was given: the joint came later."""
    model = Model()
    model.rigid_body("leaf", model.node("a", PLACE), 1.0, (1, 1, 1))
    build(model)
    model.revolute("a", AXIS, name="hinge")
    with pytest.raises(InputError, match="'early' is about .* which revolute 'hinge' forbids"):
        simulate(model, 0.01, 0.1)


def test_a_planar_model_needs_no_axis():
    model = Model(planar=True)
    model.rigid_body("leaf", model.node("a", PLACE[:2]), 1.0, J)
    model.revolute("a", name="hinge")
    model.torsion_spring("hinge", K, rest=REST)
    result = simulate(model, 0.002, 0.4)
    assert result["hinge.angle"] == pytest.approx(
        REST * (1 - np.cos(np.sqrt(K / J) * result.t)), abs=1e-5)
