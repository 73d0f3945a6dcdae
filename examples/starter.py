"""A flexible arm turned by a motor, with a load at its tip, to be changed into a model of your own.

    sebody run FILE.py --output run.npz --plot run.png
    sebody animate run.npz --colour von_mises --output run.html
    sebody sweep FILE.py --vary thickness=0.004:0.008:0.001 --keep "maximum(norm tip.velocity)"
    sebody advise FILE.py --quantity tip.position --tolerance 1e-2

Look at ``hinge.angle``, which goes from rest to rest in one second, and at ``tip.position.x``,
which goes on vibrating; the push at 1.25 s adds to it. ``motor.torque`` is what the drive needs.
"""

import math

from sebody import Model, rest_to_rest
from sebody.fem import rectangle
from sebody.scenes.scene import Scene


def build(length: float = 0.8, thickness: float = 0.006, load: float = 0.2, angle: float = 90.0,
          modes: int = 4) -> Scene:
    """The scene. Its arguments are the parameters that ``--set`` and ``--vary`` change.

    Parameters
    ----------
    length : float
        Of the arm [m].
    thickness : float
        Of the arm, in the plane in which it turns [m].
    load : float
        Mass at the tip [kg].
    angle : float
        By which the motor turns the arm in one second [degrees].
    modes : int
        Internal modes of the arm: more of them follow faster vibrations.
    """
    # Numbers have no units; these names are those of axes and legends.
    model = Model(units="m kg s N")
    model.gravity((0.0, -9.81, 0.0))

    # Nodes are where bodies meet joints, loads and each other.
    model.node("base", (0.0, 0.0, 0.0))
    model.node("tip", (length, 0.0, 0.0))

    # A flexible body: a beam of 20 finite elements, reduced to its ends and some modes. Bodies from
    # FE programs: model.superelement("arm", "BODY.npz", ["base", "tip"]), see `sebody import`.
    section = rectangle(thickness, 0.03, youngs_modulus=7e10, poisson_ratio=0.33, density=2700.0)
    model.beam("arm", ("base", "tip"), section, 20, 1, modes, damping=0.01)

    # Rigid parts: point_mass and rigid_body, both on a node.
    model.point_mass("load", "tip", load)

    # Joints to the ground, or with to="NODE" to another body; drives turn them as prescribed.
    model.revolute("base", axis=(0.0, 0.0, 1.0), name="hinge")
    model.drive_angle("base", rest_to_rest(math.radians(angle), 1.0), name="motor")

    # Loads vary with time: numbers, tables of (time, value), functions.
    model.force("tip", (1.0, 0.0, 0.0), [(0.0, 0.0), (1.2, 0.0), (1.25, 5.0), (1.3, 0.0)],
                name="push")

    # The step should resolve the fastest vibration that matters, with 20 steps a period or more.
    return Scene("starter", "a flexible arm turned by a motor", model, h=0.002, t_end=2.0,
                 base="base", tip="tip")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
