"""A vehicle on springs crosses a bridge of three spans, each a flexible body of its own.

Both axles stay on one path along all spans, which begins and ends on the ground; where two spans
meet at their supports, one hands over to the next within the length that a rail bridges. Weights
are those of the vehicle alone: the bridge is shown as it moves about its own sag.

Look at ``span 1.node10.position.y``, the middle of a span, and ``chassis.rotation``: the vehicle
meets the second span still nodding from the first one. ``front.normal_force`` is the load of an
axle, half of the weight and what the springs add to it.
"""

from sebody import Model, ramp
from sebody.basics import inputs
from sebody.fem import rectangle
from sebody.scenes.scene import Scene

SPAN, SPANS = 20.0, 3                           # m
BENDING, LINE_MASS, HEIGHT = 4e9, 8000.0, 0.15  # N m^2, kg/m, m: without shear to speak of
BODY, INERTIA, AXLE = 20e3, 1.2e5, 1500.0       # kg, kg m^2, kg
FRONT, START = 2.0, -3.0                        # m: axles before and behind the centre; its start
SPRING, DAMPER, G = 1.5e6, 4e4, 9.81            # N/m, N s/m, m/s^2


def build(speed: float = 25.0, blend: float = 0.5) -> Scene:
    """The scene.

    Parameters
    ----------
    speed : float
        Of the vehicle [m/s].
    blend : float
        Length over which one span hands over to the next [m].
    """
    speed = inputs.number(speed, "speed", above=0)
    model = Model(planar=True, units="m kg s N")
    girder = rectangle(HEIGHT, 1.0, youngs_modulus=12 * BENDING / HEIGHT**3, poisson_ratio=0.0,
                       density=LINE_MASS / HEIGHT)
    spans = [f"span {k}" for k in range(SPANS)]
    for k, span in enumerate(spans):
        ends = [model.node(f"{side} {k}", (SPAN * (k + x), 0.0))
                for x, side in enumerate(("left", "right"))]
        model.beam(span, ends, girder, 20, 1, 4, stiffening=False)
        model.fix(ends[0], "position")
        model.slider(ends[1], axis=(1.0, 0.0), name=f"roller {k}")
    model.path("deck", on=spans, blend=blend, ends="ground")
    chassis = model.node("chassis", (START, 1.0))
    model.rigid_body("body", chassis, BODY, INERTIA)
    model.force(chassis, (0.0, -1.0), BODY * G, name="weight")
    model.drive_slide(chassis, ramp(speed), (1.0, 0.0), name="engine")
    for name, x in (("front", START + FRONT), ("rear", START - FRONT)):
        axle = model.node(f"{name} axle", (x, 0.0), "translation")
        model.point_mass(f"{name} wheels", axle, AXLE)
        model.force(axle, (0.0, -1.0), AXLE * G, name=f"{name} weight")
        model.spring(model.attach(f"{name} corner", (x, 1.0), chassis), axle, SPRING, DAMPER,
                     1.0 + BODY * G / 2 / SPRING, name=f"{name} spring")
        model.path_joint(axle, "deck", name=name)
        model.drive_way(name, ramp(speed), name=f"{name} drive")
    end = (SPANS * SPAN - START + FRONT) / speed
    return Scene("bridge", "a vehicle crosses three spans", model, h=2e-3, t_end=end,
                 base="span 0.node10", tip="chassis")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
