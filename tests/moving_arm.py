"""A mechanism of everything that a picture shows, in general position, for tests of pictures."""

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.fem import i_profile, tube

TURN = Rotation.random(random_state=11).as_matrix()
START = np.array([-3.0, 4.0, 1.0])
GRAVITY = 9.81 * TURN @ [0.2, -0.1, -1.0]
ALU = 7e10, 0.3, 2700.0


def build():
    """Two arms of two superelements each, a pendulum, a spring, loads and gravity."""
    def at(*point):
        return START + TURN @ np.array(point, dtype=float)

    model = Model()
    for name, point in {"hub": (0, 0, 0), "base": (0, 0, 0), "elbow": (1.2, 0, 0.2),
                        "fork": (1.2, 0, 0.2), "tip": (2.0, 0.3, -0.3), "bob": (2.0, 0.3, -0.3),
                        "post": (2.2, -0.6, 0.2)}.items():
        model.node(name, at(*point))
    model.beam("upper", ("base", "elbow"), tube(0.05, 0.005, *ALU), elements=8, bodies=2, modes=2)
    model.beam("fore", ("fork", "tip"), i_profile(0.06, 0.05, 0.004, 0.006, *ALU), elements=8,
               bodies=2, modes=2)
    model.rigid_body("bob", "bob", 3.0, TURN @ np.diag([0.02, 0.03, 0.025]) @ TURN.T,
                     centre=at(2.0, 0.3, -0.5))
    model.fix("hub")
    model.fix("post")
    model.revolute("base", axis=TURN[:, 2], to="hub", name="shoulder")
    model.revolute("fork", axis=TURN @ [0, 1, 0.2], to="elbow", name="elbow hinge")
    model.spherical("bob", to="tip", explicit=False, name="ball")
    model.spring("tip", "post", 300.0, 3.0, name="spring")
    model.gravity(GRAVITY)
    model.force("tip", TURN[:, 1], [(0, 10.0), (0.05, 30.0), (1, 30.0)], name="gust")
    model.torque("elbow", TURN[:, 0], [(0, 0.0), (0.05, -8.0), (1, -8.0)], follower=True,
                 name="twist")
    return model


def run():
    """101 recorded states."""
    return simulate(build(), 1e-3, 0.1)
