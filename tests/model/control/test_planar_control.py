"""Planar models in the place of spatial ones, with actuators, sensors and controllers."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import InputError, Model, simulate
from sebody.control import low_pass
from sebody.fem import StiffnessSection, straight_beam
from sebody.model.variants import planar
from sebody.reduction import craig_bampton

SECTION = StiffnessSection(axial=1e4, bending_y=3.0, bending_z=2.0, torsion=1.5, mass=1.0,
                           inertia_x=0.02, inertia_y=0.01, inertia_z=0.01)


def sampled(t, y, x, u, parameters):
    x[0] += 0.01 * y[1]
    u[0] = 1.0 * (0.4 - y[0]) - 0.1 * y[1] - x[0]
    u[1] = 0.3 * y[2] - 0.02 * y[3] + 0.2 * y[4]


def continuous(t, y, x, rates, u, parameters):
    rates[0] = (y[0] - x[0]) / 0.3
    u[0] = 0.3 - 2.0 * x[0] - 0.3 * y[1] - 0.1 * y[1] * y[2]
    u[1] = 0.1 * y[3] - 3.0 * y[4] - 0.2 * y[5]


def arm(axis):
    """A flexible arm in a plane normal to a global axis, with a slide on a rigid one."""
    model, (x, y) = Model(), np.delete(np.eye(3), axis, axis=0)
    normal = -np.eye(3)[axis]           # against the plane's own

    def node(name, a, b, **options):
        return model.node(name, 0.7 * abs(normal) + (0.3 + a) * x + (b - 0.2) * y, **options)
    hub, tip, mount = node("hub", 0, 0), node("tip", 1, 0.4), node("mount", 1, 0.4)
    car = node("car", 0.6, 0.8)
    reduced = craig_bampton(straight_beam(hub.point, tip.point, SECTION, elements=4, up=normal),
                            [(0, "full"), (4, "full")], modes=6)
    model.superelement("beam", reduced, [hub, tip])
    model.rigid_body("rotor", hub, 1.0, 0.1 * np.eye(3))
    model.rigid_body("part", mount, 0.5, np.diag([0.02, 0.03, 0.04]))
    model.rigid_body("load", car, 0.3, 0.01 * np.eye(3))
    model.revolute(hub, axis=normal, name="hinge")
    model.revolute(mount, to=tip, axis=normal, name="elbow")
    model.prismatic(car, axis=y - x, to=mount, name="slide")
    model.actuator("motor", joint="hinge", inertia=0.002, ratio=5.0)
    model.actuator("elbow motor", joint="elbow")
    model.actuator("thrust", joint="slide", inertia=1e-3, ratio=3.0)
    model.actuator("rope", between=("hub", "car"))
    model.gravity(-2.0 * x + 1.0 * y)
    return model


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_same_motion(axis):
    """Sampled and continuous loops; components along global axes and angles about the normal."""
    model = arm(axis)
    one, other = np.delete(list("xyz"), axis)
    about = "xyz"[axis]
    model.sensor("force", f"elbow.force.{one}", rate=10.0)
    model.sensor("late", f"tip.position.{other}", rate=50.0, delay=1, bias=0.1)
    model.sensor("own", f"car.velocity.{other}", axes="mount")
    model.controller("first", sampled, ["hinge.angle", f"hub.angular_velocity.{about}",
                                        f"tip.velocity.{one}", "force", "late"],
                     ["motor", "rope"], period=0.02, states=[0.0])
    model.controller("second", continuous, ["elbow.angle", "elbow.rate", "own", "late",
                                            "slide.displacement", "slide.speed"],
                     ["elbow motor", "thrust"], states=[0.0])
    model.controller("filter", low_pass(2.0), [f"car.position.{one}"], ["smooth"])
    variant = planar(model)
    assert model.sensors["force"].quantity.endswith(one) and "planar" in variant.change
    flat, found, own = variant.model, *(simulate(one, 5e-3, 0.5) for one in (model, variant.model))
    assert np.abs(found["tip.position"] - found["tip.position"][0]).max() > 0.03
    for name in ("tip.position", "car.velocity", "motor.value", "elbow motor.value", "rope.value",
                 "smooth.value", "first.states", "second.states", "late.value", "motor.work"):
        space = flat.plane.to_space(name, own[name])
        # the tolerance of Newton's iteration over 200 steps
        assert_allclose(space, found[name], rtol=0, atol=2e-5 * np.abs(found[name]).max(),
                        err_msg=name)


def test_what_has_no_planar_form():
    """Components out of the plane, or of a plane that no two global axes span."""
    model = arm(2)
    model.sensor("out", "tip.position.z")
    with pytest.raises(InputError, match="sensor 'out' measures 'tip.position.z', which is no quan"
                       "tity of the planar model"):
        planar(model)
    model = arm(2)
    model.controller("loop", low_pass(2.0), ["tip.angular_velocity.x"], ["signal"])
    with pytest.raises(InputError, match=r"'tip\.angular_velocity\.x', which is no quantity"):
        planar(model)
