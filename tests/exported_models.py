"""Models of tests of exports: several features at once, names with spaces, a turned plane."""

import math

import numpy as np

from sebody import Model, Tolerance, plane
from sebody.fem import Section
from sebody.io import LoadSeries

SECTION = Section(area=1e-4, inertia_y=2e-9, inertia_z=1e-9, torsion=2e-9, youngs_modulus=7e10,
                  poisson_ratio=0.3, density=2700.0)
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
H = 2e-3
VARIABLE = Tolerance(1e-5)


def feedback(t, y, x, u, parameters):
    """Proportional and derivative, with the integral as its state."""
    x[0] += parameters[2] * (-0.1 - y[0])
    u[0] = parameters[0] * (-0.1 - y[0]) - parameters[1] * y[1] + x[0]


def arm() -> Model:
    """A turned flexible arm on a motor with a controller, wind, a series of loads, a floor."""
    model = Model(units="m kg N s")
    model.gravity(TURN @ (0.0, -9.81, 0.0))
    shoulder = model.node("the shoulder", TURN @ (0.1, 0.2, 0.0))
    hand = model.node("the hand", TURN @ (0.7, 0.3, 0.0))
    model.beam("upper arm", (shoulder, hand), SECTION, 6, 1, 2, up=TURN @ (0.0, 0.0, 1.0))
    model.revolute(shoulder, axis=TURN @ (0.0, 0.0, 1.0), name="joint 1")
    model.rigid_body("load at the hand", hand, 0.2, 1e-3 * np.eye(3))
    model.unbalance(hand, 0.003, 0.4)
    model.actuator("motor 1", joint="joint 1", limit=30.0, lag=0.004)
    model.controller("loop", feedback, ["joint 1.angle", "joint 1.rate"], ["motor 1"], 0.004,
                     states=[0.1], parameters=[12.0, 0.8, 0.05])
    model.force(hand, TURN @ (0.0, 1.0, 0.0), lambda t: 0.5 * math.sin(9.0 * t) + math.exp(-t),
                name="a wind")
    model.force(hand, TURN @ (1.0, 0.0, 0.0), [(0.0, 0.0), (0.05, 0.0), (0.05, 1.0), (0.2, 0.4)],
                name="a pull")
    model.body_series("upper arm", LoadSeries(
        [0.0, 0.03, 0.03, 0.1], [[0.0, 0.1], [0.2, 0.1], [0.1, 0.0], [0.3, 0.2]],
        ["the hand.y", "mode 0"]), name="waves")
    model.contact(hand, on=plane(TURN @ (0.0, 1.0, 0.0), TURN @ (0.0, 0.27, 0.0)), radius=0.02,
                  stiffness=1e5, restitution=0.4, friction=0.3, name="the floor")
    return model


def law(t, y, x, rates, u, parameters):
    """Continuous: against a filtered angle and its rate."""
    rates[0] = (y[0] - x[0]) / parameters[0]
    u[0] = -parameters[1] * x[0] - 0.2 * y[1]


def derivatives(t, y, x, D, parameters):
    """Of its rates and outputs by y and x."""
    D[0, 0], D[0, 2] = 1.0 / parameters[0], -1.0 / parameters[0]
    D[1, 1], D[1, 2] = -0.2, -parameters[1]


def with_law() -> Model:
    """The same arm with a continuous controller, its derivatives given, beside the sampled one."""
    model = arm()
    model.actuator("motor 2", joint="joint 1")
    model.controller("law", law, ["joint 1.angle", "joint 1.rate"], ["motor 2"], states=[0.05],
                     parameters=[0.03, 3.0], derivatives=derivatives)
    return model


def pendulum() -> Model:
    """A pendulum in a plane whose support is driven, with an actuator and a spring."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    model.node("cart", (0.0, 0.0))
    model.fix("cart", "rotation")
    model.move("cart", (1.0, 0.0), [(0.0, 0.0), (10.0, 0.0)], name="the support")
    model.node("bob", (0.3, -0.4))
    model.rigid_body("rod", "bob", 1.2, 0.03)
    model.attach("rod top", (0.0, 0.0), "bob")
    model.revolute("cart", to="rod top", name="pin")
    model.actuator("push", node="bob", direction=(1.0, 0.5))
    return model
