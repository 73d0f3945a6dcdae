"""A thin ring that spins about its axis, held by its mean motion (mboct-mbdyn-pkg)."""

from collections.abc import Mapping
from math import pi

import numpy as np

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import frame, rectangle
from sebody.reduction import MeanFace, craig_bampton
from sebody.verify.outside.case import Case, Quantity

INNER, OUTER, WIDTH, E, NU, DENSITY = 0.048, 0.050, 0.002, 70e9, 0.3, 2700.0     # diameters [m]
RADIUS, THICK = (INNER + OUTER) / 4, (OUTER - INNER) / 2
SPIN = 15000 / 60 * 2 * pi
ELEMENTS, MODES = 64, 10


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    count = ELEMENTS * division
    angles = 2 * pi * np.arange(count) / count
    points = RADIUS * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    fe = frame(points, [(k, (k + 1) % count) for k in range(count)],
               rectangle(THICK, WIDTH, E, NU, DENSITY), 1)
    place = np.zeros(fe.stiffness.shape[0])
    for k, point in enumerate(points):
        place[fe.dofs(k, "translation")] = point
    face = MeanFace(tuple(range(count)), np.zeros(3), "equal")
    body = craig_bampton(fe, [(face, "full")], MODES, loads={"spin": fe.mass @ place},
                         residual_modes=True)
    model = Model()
    centre = model.node("centre", (0.0, 0.0, 0.0))
    model.superelement("ring", body, [centre])
    model.fix(centre)
    field = equilibrium(model, 2, spin=(0.0, 0.0, SPIN)).field("ring")
    u = field.displacements([-1])[0]
    tension = field.section_forces(-1)[:, :, 0] / (THICK * WIDTH)
    return {"radial displacement [m]": float(np.mean((u * points).sum(axis=1)) / RADIUS),
            "hoop stress [Pa]": float(np.mean(tension))}


CASE = Case(
    "Spinning ring by modes", "mboct-mbdyn-pkg, inst/mbdyn_post_load_output_mod_01.tst", measure,
    (Quantity("radial displacement [m]", DENSITY * SPIN**2 * RADIUS**3 / E,
              source_tolerance=0.07),
     Quantity("hoop stress [Pa]", DENSITY * SPIN**2 * RADIUS**2, source_tolerance=0.07)),
    "ten modes and the shape of the centrifugal load, held by the mean motion of all nodes; "
    "closed form of a thin ring")
