"""A shaft with two discs out of balance, run up through its first critical speeds.

The shaft of example 5.9.2 of Friswell, Penny, Garvey and Lees, Dynamics of Rotating Machines
(Cambridge 2010), in bearings that are softer along z than along y. Unbalances whirl it, most at 83
and 87 rad/s.

Look at ``disc 2.position.y`` and ``disc 2.position.z``, which swell at the two critical speeds, one
after the other, and are small beyond them, where the shaft turns about its centre of mass.
"""

import numpy as np

from sebody import Model
from sebody.basics import inputs
from sebody.fem import circle
from sebody.scenes.scene import Scene

LENGTH, ELEMENTS = 1.5, 6
STEEL = {"youngs_modulus": 211e9, "poisson_ratio": 211e9 / (2 * 81.2e9) - 1, "density": 7810.0}
DISCS = {2: 0.28, 4: 0.35}                  # node and diameter [m], both 0.07 m thick
STIFFNESS, DAMPING = np.diag([1e6, 0.8e6]), 300.0 * np.eye(2)       # N/m, N s/m
ACCELERATION, END = 10.0, 13.0              # rad/s^2, s


def rotor() -> Model:
    """The rotor at rest, out of balance."""
    model = Model(units="m kg s N")
    names = [f"disc {k}" if k in DISCS else f"n{k}" for k in range(ELEMENTS + 1)]
    for k, name in enumerate(names):
        model.node(name, (LENGTH * k / ELEMENTS, 0.0, 0.0))
    for k, ends in enumerate(zip(names, names[1:], strict=False)):
        model.beam(f"shaft {k}", ends, circle(0.025, **STEEL), 1, 1, 0)
    for k, diameter in DISCS.items():
        squares = diameter**2 + 0.05**2
        mass = np.pi / 4 * (diameter**2 - 0.05**2) * 0.07 * STEEL["density"]
        across = mass * (3 * squares / 4 + 0.07**2) / 12
        model.rigid_body(f"wheel {k}", f"disc {k}", mass, (mass * squares / 8, across, across))
    for name in (names[0], names[-1]):
        ground = model.node(f"bearing {name}", model.nodes[name].point)
        model.fix(ground)
        model.bushing(ground, to=name, stiffness=STIFFNESS, damping=DAMPING, axis=(1, 0, 0))
    model.bushing("bearing n0", to="n0", stiffness=(1e8, 0, 0), damping=(500, 0, 0),
                  name="thrust")
    model.unbalance("disc 2", 5e-4, 0.0)
    model.unbalance("disc 4", 3e-4, 1.0)
    return model


def build(acceleration: float = ACCELERATION) -> Scene:
    """The scene.

    Parameters
    ----------
    acceleration : float
        Of the angle [rad/s^2].
    """
    rate = inputs.number(acceleration, "acceleration", above=0)
    model = rotor()
    model.drive_angle("n0", (lambda t: rate * t**2 / 2, lambda t: rate * t, lambda t: rate),
                      axis=(1, 0, 0), name="motor")
    return Scene("rotor", "a rotor out of balance through its critical speeds", model, h=1e-3,
                 t_end=END, base="n0", tip="disc 2")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
