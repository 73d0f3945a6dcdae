"""The paper's hinged beam (section 8.1): one superelement spun up by a torque at its hinge.

Look at ``base.angular_velocity.z``: from 7.5 s on, when the torque has ended, the beam rotates at
0.906 rad/s in the mean, and the vibration on top goes on undamped. The deflection of the tip shows
in ``beam.modes``.
"""

from sebody import Model
from sebody.fem import Section
from sebody.scenes.scene import Scene

SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387,
                  youngs_modulus=2.1e6, poisson_ratio=0.3, density=7.8e-3, shear_factor=5 / 6)
TORQUE = [(0.0, 0.0), (2.5, 1.2e4), (5.0, 1.2e4), (7.5, 0.0)]


def build(frame: str = "converged_mean", inertia: str | None = None, modes: int = 4,
          elements: int = 20, frame_node: int = 0, bodies: int = 1,
          stiffening: bool | None = None, torque: float = 1.2e4) -> Scene:
    """The scene: beam of length 100 sqrt(2) along (1, 1, 0), hinged about z at its base.

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
    torque : float
        Largest torque at the hinge.
    """
    model = Model()
    base, tip = model.node("base", (0.0, 0.0, 0.0)), model.node("tip", (100.0, 100.0, 0.0))
    model.beam("beam", (base, tip), SECTION, elements, bodies, modes, frame=frame, inertia=inertia,
               stiffening=stiffening, frame_node=frame_node)
    model.revolute(base, axis=(0, 0, 1))
    model.torque(base, (0, 0, 1), [(t, value * (torque / 1.2e4)) for t, value in TORQUE])
    return Scene("hinged-beam", "the paper's hinged beam, spun up by a torque at its base",
                 model, h=0.01, t_end=30.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
