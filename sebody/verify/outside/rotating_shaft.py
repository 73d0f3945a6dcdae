"""A shaft with an eccentric disc that passes its critical speed (Bauchau et al. 2016)."""

from collections.abc import Mapping
from math import pi

import numpy as np

from sebody import Model, generalized_alpha, simulate
from sebody.analysis import equilibrium, vibrations
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

LENGTH, MASS, OFFSET, GRAVITY = 6.0, 70.573, 0.05, 9.81
SECTION = StiffnessSection(313.4e6, 354.5e3, 354.5e3, 272.7e3, 11.64, 26.34e-3, 13.17e-3, 13.17e-3,
                           60.5e6, 60.5e6)
SPEED, FIRST, STEP = 60.0, 0.8, 1e-3        # rad/s, the part of it up to 1 s, s
RUN_UP = 0.5                                # s


def build(bodies: int, driven: bool = True, offset: float = OFFSET) -> Model:
    """Along x; the disc's centre begins above the axis."""
    model = Model()
    model.gravity((0.0, 0.0, -GRAVITY))
    left, middle, right = (model.node(name, (x, 0.0, 0.0)) for name, x in (
        ("left", 0.0), ("middle", LENGTH / 2), ("right", LENGTH)))
    model.beam("first", (left, middle), SECTION, 8 * bodies, bodies, 4, frame="mean_axes")
    model.beam("second", (middle, right), SECTION, 8 * bodies, bodies, 4, frame="mean_axes")
    model.rigid_body("disc", middle, MASS, (2.0325, 1.0163, 1.0163),
                     (LENGTH / 2, 0.0, offset))
    model.revolute(left, axis="x", name="shaft")
    model.cylindrical(right, axis="x")
    if driven:
        model.drive_angle("shaft", lambda t: 0.5 * FIRST * SPEED * (
            t - RUN_UP / pi * np.sin(pi * t / RUN_UP)))
    return model


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    still = build(division, driven=False, offset=0.0)
    still.fix("left", "rotation")
    rest = equilibrium(still, 2)
    found = vibrations(rest, 6).omega
    run = simulate(build(division), STEP / division, RUN_UP, generalized_alpha(0.0))
    radius = np.linalg.norm(run["middle.position"][:, 1:], axis=1)
    return {"sag [m]": -rest["middle.position"][-1, 2], "bending 1 [rad/s]": found[0],
            "bending 2 [rad/s]": found[3], "largest radius to 0.5 s [m]": radius.max()}


CASE = Case(
    "Rotating shaft", "O. A. Bauchau et al. 2016, by V. Sonneville's mb_sef_py", measure,
    (Quantity("sag [m]", 3.310e-3, printed=5e-7),
     Quantity("bending 1 [rad/s]", 56.853, printed=5e-4),
     Quantity("bending 2 [rad/s]", 288.5, printed=0.05),
     Quantity("largest radius to 0.5 s [m]", 0.0781, printed=0.0061)),
    "sag and frequencies: another program of the authors of sebody. The source has 0.0781 m "
    "with 16, 0.0720 m with 8 elements, and this difference is what it is good to; beyond the "
    "critical speed its results are not converged (0.233 and 0.260 m at 1.25 s, 0.281 and 0.332 m "
    "later) and not compared")
