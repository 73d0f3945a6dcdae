"""A two-link arm that follows a trajectory: computed torque at 1 kHz.

Its motors know the dynamics of the rigid arm. A load at the hand that they do not know is a
disturbance.

Look at ``shoulder.angle`` and ``elbow.angle``, which follow their trajectory within 4 and 23
milliradians although the controller does not know of the load at the hand; ``first.moment`` and
``second.moment`` are constant between samples.
"""

import numpy as np

from sebody import Model
from sebody.control import computed_torque
from sebody.scenes.scene import Scene

PERIOD = 0.001
SEEN = ("shoulder.angle", "elbow.angle", "shoulder.rate", "elbow.rate")


def dynamics(q, v, mass, bias):
    """Masses and forces of two rods of one metre and one kilogram."""
    c, s = np.cos(q[1]), np.sin(q[1])
    mass[0, 0] = 5.0 / 3.0 + c
    mass[0, 1] = mass[1, 0] = 1.0 / 3.0 + 0.5 * c
    mass[1, 1] = 1.0 / 3.0
    bias[0] = -0.5 * s * (2.0 * v[0] * v[1] + v[1] * v[1])
    bias[1] = 0.5 * s * v[0] * v[0]


def trajectory(t, q, v, a):
    """Angles of the joints, their rates and accelerations."""
    q[0], q[1] = 0.8 * np.sin(1.5 * t)**2, 1.2 * np.sin(t)**2
    v[0], v[1] = 1.2 * np.sin(3.0 * t), 1.2 * np.sin(2.0 * t)
    a[0], a[1] = 3.6 * np.cos(3.0 * t), 2.4 * np.cos(2.0 * t)


def build(load: float = 0.2, bandwidth: float = 20.0) -> Scene:
    """The scene.

    Parameters
    ----------
    load : float
        Mass at the hand, which the controller does not know [kg].
    bandwidth : float
        Frequency of the errors [rad/s], critically damped.
    """
    model = Model(planar=True, units="m kg s N")
    for name, place in (("upper", (0.5, 0.0)), ("lower", (1.5, 0.0))):
        model.rigid_body(name, model.node(name, place), 1.0, 1.0 / 12.0)
    base = model.attach("base", (0.0, 0.0), "upper")
    joint = model.attach("joint", (1.0, 0.0), "upper")
    wrist = model.attach("wrist", (1.0, 0.0), "lower")
    tip = model.attach("tip", (2.0, 0.0), "lower")
    model.revolute(base, name="shoulder")
    model.revolute(wrist, to=joint, name="elbow")
    if load:
        model.point_mass("load", tip, load)
    model.actuator("first", joint="shoulder", limit=60.0)
    model.actuator("second", joint="elbow", limit=30.0)
    model.controller("arm", computed_torque(dynamics, trajectory, 2, bandwidth**2,
                                            2.0 * bandwidth),
                     SEEN, ["first", "second"], PERIOD)
    return Scene("two-link-arm", "two-link arm on a trajectory by computed torque", model, h=0.001,
                 t_end=4.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
