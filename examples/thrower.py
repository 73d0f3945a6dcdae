"""A flexible arm that a wound spring throws up: a latch opens, and a grip lets its load go.

The latch holds the tip until 0.1 s; then the spring in the hinge turns the arm, which swings. The
grip lets go at an angle of the arm: from there the load flies on a parabola, turning as fast as it
did. The arm without it swings on against a buffer. A grip of little ``strength`` breaks as soon as
the latch opens, since what that has borne comes to the load at once.

Look at ``load.position.y``, at ``grip.force.norm``, which is zero once it has let go, and at
``latch.force.norm``.
"""

import math

from sebody import Model
from sebody.fem import planar_beam, rectangle
from sebody.reduction import craig_bampton
from sebody.scenes.scene import Scene

LENGTH = 1.2                                        # m
STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}


def build(mass: float = 0.5, angle: float = 1.0, strength: float = math.inf) -> Scene:
    """The scene.

    Parameters
    ----------
    mass : float
        Of the load [kg].
    angle : float
        Of the arm, from where it is held, at which the grip lets go [rad].
    strength : float
        Force at which the grip breaks [N].
    """
    model = Model(planar=True, units="m kg s N")
    foot, tip = model.node("foot", (0.0, 0.0)), model.node("tip", (LENGTH, 0.0))
    beam = planar_beam(foot.point, tip.point, rectangle(0.012, 0.03, **STEEL), 6)
    body = craig_bampton(beam, [(0, "full"), (6, "full")], modes=3).damped(0.01)
    model.superelement("arm", body, [foot, tip])
    model.rigid_body("hub", "foot", 3.0, 0.02)
    model.revolute("foot", name="hinge")
    model.torsion_spring("hinge", 60.0, 0.2, rest=1.6, name="wound")
    model.stop("hinge", upper=1.8, stiffness=2e4, restitution=0.3, at_speed=1.0, name="buffer")
    model.node("load", tip.point)
    model.rigid_body("load", "load", mass, 0.4 * mass * 0.04**2)
    breaks = {} if strength == math.inf else {"breaks_at": strength}
    model.weld("load", to="tip", name="grip", release_when=f"hinge.angle > {angle}", **breaks)
    model.slider("tip", (1.0, 0.0), name="latch", until=0.1)      # holds it across the arm
    model.gravity((0.0, -9.81))
    return Scene("thrower", "a wound arm, a latch that opens, and a load that is let go", model,
                 h=2e-4, t_end=0.8, base="foot", tip="load")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
