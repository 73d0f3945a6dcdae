"""The paper's beam on a spherical joint (section 8.2) under its own slow loads.

The joint is a fixed position DOF block: the system has no constraint and no multiplier.

Look at ``base.angular_velocity``: a torque about z turns the beam by itself until 10 s; the push
along z at 15 s then tilts the axis, and all three components vibrate.
"""

from sebody import Model
from sebody.scenes.hinged_beam import SECTION
from sebody.scenes.scene import Scene

LENGTH = 141.42
TORQUE = [(0.0, 0.0), (0.2, 200.0), (10.0, 200.0), (10.2, 0.0)]
PUSH = [(15.0, 0.0), (15.2, 100.0), (15.4, 0.0)]


def build(frame: str = "converged_mean", inertia: str | None = None, modes: int = 8,
          elements: int = 20, frame_node: int = 0, bodies: int = 1,
          stiffening: bool | None = None) -> Scene:
    """The scene: a torque of impulse 2000 about z at the base, an impulse of 20 along z at 15.

    Parameters
    ----------
    frame : str
        Frame of the bodies: converged_mean, mean, mean_small, or node (attached to a node).
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    modes : int
        Internal modes a body.
    elements : int
        Finite elements of the whole beam; bodies with one element and no modes are nonlinear beams.
    frame_node : int
        With frame=node, the node of a body that its frame is attached to: 0 or 1.
    bodies : int
        Number of equal superelements the beam is divided into.
    stiffening : bool
        With option c: whether stresses stiffen the bodies; by default all but nonlinear beams.
    """
    model = Model()
    base, tip = model.node("base", (0.0, 0.0, 0.0)), model.node("tip", (LENGTH, 0.0, 0.0))
    model.beam("beam", (base, tip), SECTION, elements, bodies, modes, frame=frame, inertia=inertia,
               stiffening=stiffening, frame_node=frame_node)
    model.fix(base, "position")
    model.torque(base, (0, 0, 1), TORQUE)
    model.force(tip, (0, 0, 1), PUSH)
    return Scene("spherical-beam", "beam on a spherical joint, the paper's loads", model, h=0.02,
                 t_end=30.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
