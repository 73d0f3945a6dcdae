"""A rotor on a hinge with a sampled controller, perhaps with a flexible beam."""

from sebody import Model
from sebody.control import pid
from sebody.fem import StiffnessSection, planar_beam
from sebody.reduction import craig_bampton

GAINS = {"kp": 2.0, "ki": 0.5, "kd": 0.5, "filter": 50.0, "reference": 1e-4}
PERIOD = 0.02
SECTION = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)
BODY = craig_bampton(planar_beam((0, 0), (1, 0), SECTION, elements=20),
                     [(0, "full"), (20, "full")], modes=4)


def rotor(flexible=False, start=0.0, **options):
    """A rotor on a hinge, perhaps with a beam, and an actuator."""
    model = Model(planar=True)
    hub = model.node("hub", (0.0, 0.0))
    if flexible:
        model.superelement("beam", BODY, [hub, model.node("tip", (1.0, 0.0))])
    model.rigid_body("rotor", hub, 1.0, 0.1)
    model.revolute(hub, name="hinge")
    if start:
        model.initial_velocity(hub, angular=start)
    model.actuator("motor", joint="hinge", **options)
    return model


def controlled(delay=0, flexible=False, **options):
    model = rotor(flexible, **options)
    model.controller("pid", pid(**GAINS), ["hub.rotation"], ["motor"], PERIOD, delay)
    return model
