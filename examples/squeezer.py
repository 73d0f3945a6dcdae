"""Andrews' squeezer: seven bodies, a spring and a motor (IVP test set).

Every body is one angle; chains hang on the ground by rigid links and meet in one point, held
together by six multipliers.

Look at ``crank.rotation``, 15.87 rad in 0.03 s as in the test set's solution, and at
``point.position.x:y``, where three chains meet. ``energy`` shows how work goes into the spring and
back.
"""

import numpy as np

from sebody import Model
from sebody.scenes.scene import Scene

MASS = 0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498
INERTIA = 2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5
A, B, C = np.array([-0.06934, -0.00227]), np.array([-0.03635, 0.03273]), np.array([0.014, 0.072])
STIFFNESS, LENGTH, TORQUE = 4530.0, 0.07785, 0.033
START = (-0.0617138900142764496, 0.0, 0.455279819163070380, 0.222668390165885885,
         0.487364979543842550, -0.222668390165885885, 1.23054744454982119)


def build() -> Scene:
    """The scene, at rest."""
    beta, theta, gamma, phi, delta, omega, epsilon = START
    model = Model(planar=True)
    model.node("anchor", C)
    model.fix("anchor")
    crank = _hinged(model, "crank", np.zeros(2), 0, beta, (0.00092, 0.0))
    pin = _end(model, "pin", crank, beta, (0.007, 0.0))
    link = _hung(model, "link", pin, 1, beta + theta, (-0.0115, 0.0))
    point = _end(model, "point", link, beta + theta, (-0.028, 0.0))
    frame = _hinged(model, "frame", B, 2, gamma, (0.01043, -0.01874))
    spring = _end(model, "spring end", frame, gamma, (0.02, -0.018))
    lower = _hinged(model, "lower arm", A, 4, delta, (0.02308, 0.00916))
    elbow = _end(model, "lower elbow", lower, delta, (0.04, 0.0))
    rod = _hung(model, "lower rod", elbow, 3, phi + delta, (0.0, -0.00579))
    upper = _hinged(model, "upper arm", A, 6, epsilon, (-0.00449, -0.01228))
    knee = _end(model, "upper elbow", upper, epsilon, (0.0, -0.04))
    bar = _hung(model, "upper rod", knee, 5, omega + epsilon, (0.00579, 0.0))
    for name, node, angle, end in (("frame end", frame, gamma, (0.0, -0.035)),
                                   ("lower end", rod, phi + delta, (0.0, -0.02)),
                                   ("upper end", bar, omega + epsilon, (0.02, 0.0))):
        model.spherical(_end(model, name, node, angle, end), point)
    model.spring("anchor", spring, STIFFNESS, length=LENGTH)
    model.torque(crank, TORQUE)
    return Scene("squeezer", "Andrews' squeezer", model, h=1e-5, t_end=0.03, base="crank",
                 tip="point")


def _rotated(angle: float, vector: tuple) -> np.ndarray:
    """A vector of a body's own axes in the axes of the ground."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]]) @ vector


def _hinged(model: Model, name: str, point, number: int, angle: float, centre: tuple):
    """A body on a hinge of the ground."""
    node = model.node(name, point)
    model.fix(node, "position")
    return _body(model, node, number, angle, centre)


def _hung(model: Model, name: str, on, number: int, angle: float, centre: tuple):
    """A body on a hinge at the end of another one."""
    return _body(model, model.node(name, on.point, at=on), number, angle, centre)


def _body(model: Model, node, number: int, angle: float, centre: tuple):
    model.rigid_body(node.name, node, MASS[number], INERTIA[number],
                     node.point + _rotated(angle, centre))
    return node


def _end(model: Model, name: str, node, angle: float, arm: tuple):
    return model.attach(name, node.point + _rotated(angle, arm), node)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
