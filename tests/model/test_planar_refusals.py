"""What breaks the symmetry about a plane is said, and what planar quantities are in space."""

from dataclasses import replace

import numpy as np
import pytest
from in_plane import FLAT, TURN, X, Z, at, beam, rigid
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, harmonic
from sebody.model.parts import Element, Joint, positions
from sebody.model.variants import planar


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


def test_a_joint_without_a_planar_form_is_named():
    """The remedy is in the message, which does not speak of symmetry."""
    model = beam()
    tip = model.nodes["tip"]
    screw = Element("screw", "screw", positions(tip), {}, 1)
    model.joints.append(Joint("bolt", (screw,), tip, tip, None, "screw"))
    with pytest.raises(InputError) as caught:
        planar(model)
    assert str(caught.value) == (
        "joint 'bolt' has the kind 'screw', whose form in a plane is unknown: build the planar "
        "model by hand, or add 'screw' to EQUATIONS in sebody/model/variants/flat_elements.py")
    del model.joints[-1]
    model.loads.append(Element("sail", "wind", positions(tip), {}))
    with pytest.raises(InputError, match="'sail' has the kind 'wind', whose form in a plane is "
                                         "unknown: build .* add 'wind' to ELEMENTS in "):
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
    skew = placed.reduced.loads["wind"].copy()
    skew[:3] += 5.0 * Z
    placed.reduced = replace(placed.reduced, recovery=None,
                             loads={"skew": skew, **placed.reduced.loads})
    assert planar(model).model.bodies["beam"].reduced.loads.keys() == {"wind"}
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
