"""A beam on a spherical joint, spun fast and struck at its tip: where formulations differ.

Look at ``tip.position.z`` and ``energy.strain``: the blow at 15 s leaves fifty times the strain
energy that spinning up caused. This run tells inertia options apart; with option B it is chaotic.
"""

import math

from sebody import Model, with_corners
from sebody.scenes.hinged_beam import SECTION, TORQUE
from sebody.scenes.scene import Scene


def strike(t: float) -> float:
    """Half a sine between t = 15 and t = 15.1."""
    return math.sin(math.pi * (t - 15.0) / 0.1) if 15.0 < t < 15.1 else 0.0


def build(F0: float = 2800.0, frame: str = "converged_mean", inertia: str | None = None,
          modes: int = 4, elements: int = 20, bodies: int = 1,
          stiffening: bool | None = None) -> Scene:
    """The scene: torque of the hinged beam, then a blow at the tip.

    Parameters
    ----------
    F0 : float
        Peak of the force along z at the tip.
    frame : str
        Frame of the bodies: converged_mean, mean, mean_small, or node (attached to a node).
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
    model = Model()
    base, tip = model.node("base", (0.0, 0.0, 0.0)), model.node("tip", (100.0, 100.0, 0.0))
    model.beam("beam", (base, tip), SECTION, elements, bodies, modes, frame=frame, inertia=inertia,
               stiffening=stiffening)
    model.fix(base, "position")
    model.torque(base, (0, 0, 1), TORQUE)
    model.force(tip, (0, 0, F0), with_corners(strike, (15.0, 15.1)))
    return Scene("spherical-beam-strong", "fast beam on a spherical joint, struck at its tip",
                 model, h=0.0025, t_end=30.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
