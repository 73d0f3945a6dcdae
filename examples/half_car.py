"""Half of a car on a bump: passive springs and dampers, or actuators that hold the body still.

Each axle has an actuator between body and wheel, which works against the velocity of the body at
its place (skyhook), at 200 Hz with a lag of its valve.

Look at ``base.position.y`` and ``front wheel.position.y``: on a bump of 6 cm the body rises by 1.1
cm. Compare ``base.acceleration.y`` with ``suspension=passive``; ``front valve.force`` is what the
actuator adds.
"""

from math import cos, pi, sin

import numpy as np

from sebody import Model, with_corners
from sebody.basics import inputs
from sebody.control import state_feedback
from sebody.scenes.scene import Scene

BODY, INERTIA, WHEEL = 690.0, 1222.0, 40.0      # kg, kg m^2, kg
FRONT, REAR, AXLE, ROAD = 1.3, -1.5, 0.7, 0.3   # m: places along and above the road
SPRING, TYRE = 18e3, 190e3                      # N/m
DAMPER = {"passive": 1200.0, "active": 350.0}    # N s/m
HEIGHT, LENGTH, SPEED = 0.06, 2.0, 15.0         # of the bump, m; of the car, m/s
PERIOD, SKYHOOK = 0.005, 3500.0


def bump(begin: float):
    """Height of the road under a wheel and its rates: a cosine that begins at a time."""
    rate, end = 2.0 * pi * SPEED / LENGTH, begin + LENGTH / SPEED

    def height(t, begin=begin, end=end, rate=rate, size=HEIGHT):
        return 0.5 * size * (1.0 - cos(rate * (t - begin))) if begin < t < end else 0.0

    def first(t, begin=begin, end=end, rate=rate, size=HEIGHT):
        return 0.5 * size * rate * sin(rate * (t - begin)) if begin < t < end else 0.0

    def second(t, begin=begin, end=end, rate=rate, size=HEIGHT):
        return 0.5 * size * rate**2 * cos(rate * (t - begin)) if begin < t < end else 0.0
    return with_corners((height, first, second), (begin, end))


def build(suspension: str = "active") -> Scene:
    """The scene.

    Parameters
    ----------
    suspension : str
        'active' or 'passive'.
    """
    active = inputs.choice(suspension, "suspension", ("active", "passive")) == "active"
    model = Model(planar=True, units="m kg s N")
    model.rigid_body("body", model.node("base", (0.0, AXLE)), BODY, INERTIA)
    model.slider("base", axis=(0.0, 1.0), name="straight on")
    for name, x, begin in (("front", FRONT, 0.2), ("rear", REAR, 0.2 + (FRONT - REAR) / SPEED)):
        corner = model.attach(f"{name} corner", (x, AXLE), "base")
        wheel = model.node(f"{name} wheel", (x, ROAD))
        road = model.node(f"{name} road", (x, 0.0))
        model.rigid_body(f"{name} axle", wheel, WHEEL, 1.0)
        model.prismatic(corner, axis=(0.0, 1.0), to=wheel, name=f"{name} strut")
        model.spring(corner, wheel, SPRING, DAMPER[suspension], name=f"{name} spring")
        model.spring(wheel, road, TYRE, name=f"{name} tyre")
        model.fix(road, "rotation")
        model.move(road, (0.0, 1.0), bump(begin), name=f"{name} bump")
        if active:
            model.actuator(f"{name} valve", between=(wheel, corner), limit=3000.0, lag=0.01)
    if active:
        model.controller("skyhook", state_feedback(SKYHOOK * np.eye(2)),
                         ["front corner.velocity.y", "rear corner.velocity.y"],
                         ["front valve", "rear valve"], PERIOD)
    return Scene("half-car", f"half of a car on a bump, {suspension} suspension", model, h=0.0025,
                 t_end=3.0, tip="front corner")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
