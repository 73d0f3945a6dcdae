"""The paper's hinged beam in its plane: two coordinates and an angle a node, no constraint.

Look at ``base.angular_velocity``: the same curve as of the hinged beam in space, with 6 unknowns
in place of 15. ``tip.position.x:y`` is the path of the tip.
"""

from sebody import Model
from sebody.scenes.hinged_beam import SECTION, TORQUE
from sebody.scenes.scene import Scene


def build(frame: str = "converged_mean", inertia: str | None = None, modes: int = 2,
          elements: int = 20, bodies: int = 1, stiffening: bool | None = None) -> Scene:
    """The scene; two modes in the plane are what is left of the four of the spatial one.

    Parameters
    ----------
    frame : str
        Frame of the bodies: converged_mean, or node (attached to their first node).
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    modes : int
        Internal modes a body.
    elements : int
        Finite elements of the whole beam; bodies with one element and no modes are nonlinear beams.
    bodies : int
        Number of equal superelements the beam is divided into.
    stiffening : bool
        With option c: whether stresses stiffen the bodies; by default all but nonlinear beams.
    """
    model = Model(planar=True)
    base, tip = model.node("base", (0.0, 0.0)), model.node("tip", (100.0, 100.0))
    model.beam("beam", (base, tip), SECTION, elements, bodies, modes, frame=frame, inertia=inertia,
               stiffening=stiffening)
    model.revolute(base)
    model.torque(base, 1.0, TORQUE)
    return Scene("planar-hinged-beam", "the paper's hinged beam in its plane", model, h=0.01,
                 t_end=30.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
