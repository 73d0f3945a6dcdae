"""Friction of hinges: what presses across the axis, a collar along it; arguments that need others.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, plane, simulate
from sebody.model.variants import planar

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
PLACE = np.array([2.0, -1.0, 0.5])
MASS, J, G, MU, RADIUS, SPEED = 10.0, 0.8, 9.81, 0.2, 0.05, 1.0


def turning(gravity, mounted=False, radial=0.0):
    """A body that turns about an axis through, or beside, its centre of mass."""
    model = Model()
    a = model.node("a", PLACE)
    to = None
    if mounted:
        to = model.node("mount", PLACE)
        model.rigid_body("mass", to, 1e9, (1e9, 1e9, 1e9))
        model.fix("mount")
    model.revolute(a, TURN[:, 2], to=to, name="hinge", explicit=mounted)
    model.rigid_body("door", a, MASS, TURN @ np.diag((0.5, 0.6, J)) @ TURN.T,
                     centre=PLACE + TURN @ (radial, 0, 0))
    model.gravity(TURN @ gravity)
    model.initial_velocity(a, angular=SPEED * TURN[:, 2])
    return model


@pytest.mark.parametrize("mounted", [False, True])
def test_the_weight_along_the_axis_presses_on_a_collar_alone(mounted):
    weight, t = MASS * G, 0.5
    lost = MU * RADIUS * weight / J * t
    for takes, pressing, rate in ((None, 0.0, SPEED), ("radial", 0.0, SPEED),
                                  ("axial", weight, SPEED - lost), ("whole", weight, SPEED - lost)):
        model = turning((0, 0, -G), mounted)
        model.friction("hinge", MU, radius=RADIUS, takes=takes, name="dry")
        result = simulate(model, 1e-3, t)
        assert result["dry.normal_force"][1:] == pytest.approx(pressing, abs=1e-6)
        assert result["hinge.rate"][-1] == pytest.approx(rate, rel=1e-6)


def test_journal_and_collar_add_up():
    """Gravity oblique to the axis: each takes its part, of the other radius."""
    model = turning((0, -3.0, -4.0))
    model.friction("hinge", MU, radius=RADIUS, name="journal")
    model.friction("hinge", 0.1, radius=2 * RADIUS, takes="axial", name="collar")
    result = simulate(model, 1e-3, 0.3)
    assert result["journal.normal_force"][1:] == pytest.approx(3.0 * MASS, rel=1e-6)
    assert result["collar.normal_force"][1:] == pytest.approx(4.0 * MASS, rel=1e-6)
    lost = (MU * RADIUS * 3.0 + 0.1 * 2 * RADIUS * 4.0) * MASS / J * 0.3
    assert result["hinge.rate"][-1] == pytest.approx(SPEED - lost, rel=1e-6)


def test_the_planar_variant_has_the_journal_alone():
    """The motion of a mass beside a horizontal axis is that of the spatial model."""
    model = turning((0, -G, 0), radial=0.3)
    model.friction("hinge", MU, radius=RADIUS, name="journal")
    model.friction("hinge", MU, radius=RADIUS, takes="axial", preload=5.0, name="collar")
    one, other = (simulate(made, 1e-3, 0.3) for made in (model, planar(model).model))
    assert one["hinge.rate"][-1] < SPEED - 0.1
    assert abs(other["hinge.rate"]) == pytest.approx(abs(one["hinge.rate"]), abs=1e-7)
    for name in ("journal", "collar"):
        assert other[f"{name}.normal_force"][5:] == pytest.approx(
            one[f"{name}.normal_force"][5:], rel=1e-5)       # convergence of forces in space


def test_a_universal_joint_presses_across_each_axis():
    """Along the first axis nothing presses on it, and all of the force on the second."""
    model = Model()
    a = model.node("a", PLACE)
    model.universal(a, TURN[:, 2], TURN[:, 0], name="cross")
    model.rigid_body("ball", a, MASS, (J, J, J))
    model.gravity(-G * TURN[:, 2])
    model.initial_velocity(a, angular=SPEED * TURN[:, 2])
    model.friction("cross", MU, radius=RADIUS, name="dry")
    result = simulate(model, 1e-3, 0.05)
    found = sorted(result[f"dry {k}.normal_force"][-1] for k in (1, 2))
    assert found == pytest.approx([0.0, MASS * G], abs=1e-4)


def joint(kind):
    model = Model()
    model.rigid_body("body", model.node("a", PLACE), MASS, (J, J, J))
    getattr(model, kind)("a", TURN[:, 0], name="joint")
    return model


@pytest.mark.parametrize("given, message", [
    ({"bristle": 1e4, "speed": 0.1}, "has bristle= 10000 and speed= 0.1, but the smooth law of a "
                                     "speed has no bristles: give one of the two"),
    ({"damping": 0.5, "speed": 0.1}, "has damping= 0.5 and speed= 0.1"),
    ({"slip": 1e-3, "speed": 0.1, "preload": 3.0}, "has slip= 0.001 and speed= 0.1"),
    ({"takes": "across"}, "friction in 'joint': takes 'across' is unknown: use 'radial'"),
    ({"takes": "axial", "reaction": False, "preload": 1.0}, "takes is of revolute and universal")])
def test_refused_of_friction(given, message):
    with pytest.raises(InputError, match=message):
        joint("revolute").friction("joint", MU, radius=RADIUS, **given)


def test_other_joints_take_one_force():
    with pytest.raises(InputError, match="takes is of revolute and universal joints in space whose "
                                         "force is read, and this is a prismatic: leave it out"):
        joint("prismatic").friction("joint", MU, takes="axial")


@pytest.mark.parametrize("node", ["a", "beam.node2"])
@pytest.mark.parametrize("given", [{"static": 0.3}, {"bristle": 1e4}, {"speed": 0.1},
                                   {"damping": 0.5}, {"static": 0.3, "speed": 0.1}])
def test_friction_of_contacts_needs_a_coefficient(given, node):
    from sebody.fem import rectangle, straight_beam
    from sebody.reduction import craig_bampton
    model = joint("revolute")
    fe = straight_beam((0, 0, 0), (1, 0, 0), rectangle(0.02, 0.03, 2.1e11, 0.3, 7800.0), 4)
    ends = model.node("left", (0, 0, 0)), model.node("right", (1, 0, 0))
    model.superelement("beam", craig_bampton(fe, [(0, "full"), (4, "full")], 1), ends)
    floor = {"on": plane((0, 0, 1), (0, 0, -9)), "stiffness": 1e5}
    with pytest.raises(InputError, match=f"contact of '{node}' has {'=.*'.join(given)}= and no "
                                         "friction: give friction=, the coefficient of sliding"):
        model.contact(node, **floor, **given)
    with pytest.raises(InputError, match="has bristle= 10000 and speed= 0.1"):
        model.contact(node, **floor, friction=0.2, bristle=1e4, speed=0.1)
    model.contact(node, **floor, friction=0.2, static=0.3, bristle=1e4, damping=0.5)
