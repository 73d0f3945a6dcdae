"""A wind turbine's tower and mass on a jacket in waves: a foundation with a series of loads.

The jacket is a lattice whose feet are held, reduced to the platform on top and eight modes, with
damping of all its motions and the stiffness that the stresses of its own weight and of tower and
turbine leave. Waves push on the platform and on the first mode: a series of loads whose columns are
read from one table. Displacements count from the place where the weights hold the structure.

Look at ``hub.position.x``, which sways with the first vibration, and ``platform.position.x``, which
follows the waves; ``jacket.base.reaction.x`` is what the feet bring into the seabed.
"""

from dataclasses import replace

import numpy as np

from sebody import Model
from sebody.fem import frame, tube
from sebody.fem.loads import point_load
from sebody.io import LoadSeries
from sebody.reduction import RigidFace, grounded_from_fe
from sebody.scenes.scene import Scene

STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
LEG, SHAFT = tube(0.6, 0.02, **STEEL), tube(2.6, 0.03, **STEEL)        # radius, thickness [m]
DEPTH, TOP, HUB = -45.0, 20.0, 90.0                 # heights [m]
FEET, DECK, BAYS = 12.0, 5.0, 3                     # half widths [m], and storeys
TURBINE = 350e3                                     # kg
WAVES = ((0.55, 0.0), (0.72, 1.9), (0.93, 4.0), (1.31, 2.7), (1.74, 5.1))   # rad/s, phase


def lattice():
    """FE model of four legs with braces, nodes of its feet and of its top."""
    heights, widths = np.linspace(DEPTH, TOP, BAYS + 1), np.linspace(FEET, DECK, BAYS + 1)
    corners = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    points = [(w * x, w * y, z) for z, w in zip(heights, widths, strict=True) for x, y in corners]
    members = []
    for below in range(0, 4 * BAYS, 4):
        for k in range(4):
            beside = (k + 1) % 4
            members += [(below + k, below + 4 + k), (below + k, below + 4 + beside),
                        (below + 4 + k, below + 4 + beside)]
    return frame(points, members, LEG, 2), range(4), range(4 * BAYS, 4 * BAYS + 4)


def sea(force, end):
    """Forces and moments of waves, which grow from nothing: columns of one table."""
    t = np.arange(0.0, end + 0.05, 0.1)
    height = sum(np.sin(rate * t + phase) for rate, phase in WAVES) * np.minimum(t / 10.0, 1.0)
    return LoadSeries(t, np.outer(height, force * np.array([1.0, 0.2, -8.0, 0.02])),
                      ("x", "y", "ry", "mode 0"), "cubic")


def build(force: float = 4e5) -> Scene:
    """The scene.

    Parameters
    ----------
    force : float
        Force of a wave [N].
    """
    fe, feet, top = lattice()
    above = TURBINE + SHAFT.area * SHAFT.density * (HUB - TOP)
    weight = sum(point_load(fe, node, (0, 0, -9.81 * above / 4)) for node in top)
    body = grounded_from_fe(fe, [(RigidFace((0, 0, TOP), tuple(top)), "full")],
                            RigidFace((0, 0, DEPTH), tuple(feet)), 8, (0, 0, -9.81), weight)
    model = Model(units="m kg s N")
    platform, hub = model.node("platform", (0, 0, TOP)), model.node("hub", (0, 0, HUB))
    model.foundation("jacket", replace(body, damping=2e-3 * body.stiffness), platform)
    model.beam("tower", (platform, hub), SHAFT, 8, 2, 4, damping=0.005)
    model.rigid_body("turbine", hub, TURBINE, (4e7, 2.5e7, 2.5e7), (-1.5, 0.0, HUB + 2.0))
    model.body_series("jacket", sea(force, 60.0), name="sea")
    return Scene("turbine-on-jacket", "a wind turbine on a jacket in waves", model, h=0.05,
                 t_end=60.0, base="platform", tip="hub")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
