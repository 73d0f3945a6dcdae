"""Heavy top: a fast spinning rigid body on a fixed point (Geradin and Cardona 2001).

By default the body's node is the pivot, whose position is fixed: three unknowns. With
``explicit=True`` it is the centre of mass, and a spherical joint holds the pivot with multipliers.

Look at the path of the centre, ``centre.position.x:y``, and at its height ``centre.position.z``:
the centre falls by 0.7 to 0.9 m, which turns the top about the vertical, and rises again to the
height it started from, three times in two seconds.
"""

from sebody import Model
from sebody.scenes.scene import Scene

INERTIA = (0.234375, 0.46875, 0.234375)     # about the centre of mass [kg m^2]
SPIN = (0.0, 150.0, -4.61538)               # [rad/s]


def build(explicit: bool = False) -> Scene:
    """The scene: axis along y, gravity along -z.

    Parameters
    ----------
    explicit : bool
        Hold the pivot by a spherical joint with multipliers, the node being the centre of mass.
    """
    model = Model()
    model.gravity((0.0, 0.0, -9.81))
    pivot, centre = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    if explicit:
        base = model.node("centre", centre)
        model.attach("pivot", pivot, base)
        model.spherical("pivot")
    else:
        base = model.node("pivot", pivot)
        model.attach("centre", centre, base)
        model.fix(base, "position")
    model.rigid_body("top", base, 15.0, INERTIA, centre)
    model.initial_velocity(base, angular=SPIN)
    return Scene("heavy-top", "heavy top on a fixed point", model, h=1e-3, t_end=2.0, base="pivot",
                 tip="centre")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
