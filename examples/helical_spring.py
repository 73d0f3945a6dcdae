"""A helical spring of round wire with a weight, as superelements of half a turn each.

The weight is let go where the spring is not strained; it also sways and turns a little, because the
wire ends on one side of the coil.

Look at ``weight.position.z`` and ``weight.rotation.yx``: the weight falls by twice the deflection
at rest, which the stiffness `G d^4 / (8 D^3 n)` gives within 1 % with half the weight of the
spring, and turns a little, for a spring that is stretched unwinds.
"""

import numpy as np

from sebody import Model
from sebody.fem import Axis, circle
from sebody.scenes.scene import Scene

DIAMETER, PITCH, STEEL = 0.06, 0.02, (2.06e11, 0.3, 7850.0)


def helix(turns: float) -> Axis:
    """The axis of the wire, downwards about the z axis."""
    def place(s: float) -> list[float]:
        angle = 2 * np.pi * turns * s
        return [DIAMETER / 2 * np.cos(angle), DIAMETER / 2 * np.sin(angle), -PITCH * turns * s]
    return Axis(place)


def build(turns: float = 4.0, wire: float = 0.005, mass: float = 2.0, bodies: int = 8,
          modes: int = 0) -> Scene:
    """The scene.

    Parameters
    ----------
    turns : float
        Of the coil.
    wire : float
        Diameter of the wire [m].
    mass : float
        Of the weight, whose centre is on the axis of the coil [kg].
    bodies : int
        Superelements of eight elements each.
    modes : int
        Internal modes of each.
    """
    axis = helix(turns)
    model = Model(units="m kg s N")
    base, weight = (model.node(name, axis.position(place))
                    for name, place in (("base", 0.0), ("weight", 1.0)))
    model.beam("spring", (base, weight), circle(wire / 2, *STEEL), 8 * bodies, bodies, modes,
               axis=axis, damping=(0.01, "clamped 1"))
    model.fix(base)
    model.rigid_body("load", weight, mass, mass * DIAMETER**2 / 16 * np.array([1.0, 1.0, 2.0]),
                     centre=(0.0, 0.0, weight.point[2]))
    model.gravity((0.0, 0.0, -9.81))
    return Scene("helical-spring", "helical spring with a weight", model, h=0.002, t_end=2.0,
                 tip="weight")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
