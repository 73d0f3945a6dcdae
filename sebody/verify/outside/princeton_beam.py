"""The Princeton beam: a thin strip bent about both axes (Bauchau et al. 2016)."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipeinc, ellipkinc

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

LENGTH, HEIGHT, WIDTH, E, NU = 0.508, 12.377e-3, 3.2024e-3, 71.7e9, 0.31
LOADS = 4.448, 8.896, 13.345        # N: one, two and three pounds
SMALL = 1e-4                        # N
AREA = HEIGHT * WIDTH
STRONG, WEAK = E * WIDTH * HEIGHT**3 / 12, E * HEIGHT * WIDTH**3 / 12
STIFF = 1e6             # times EA: the elastica does not stretch
BODIES = 16


def model(force: tuple[float, float], bodies: int, elements: int, modes: int) -> Model:
    """Along x; y is across the strip, where it is soft."""
    section = StiffnessSection(STIFF * E * AREA, STRONG, WEAK, E / (2 + 2 * NU) * 0.28 * AREA
                               * WIDTH**2, 2810 * AREA, 1e-6, 0.0, 0.0)
    made = Model()
    root, tip = made.node("root", (0.0, 0.0, 0.0)), made.node("tip", (LENGTH, 0.0, 0.0))
    made.beam("beam", (root, tip), section, elements, bodies, modes)
    made.fix(root)
    made.force(tip, (0.0, *force))
    return made


def moved(force: tuple[float, float], bodies: int, elements: int, modes: int) -> NDArray:
    """Displacement of the tip."""
    result = equilibrium(model(force, bodies, elements, modes), 5)
    return result["tip.position"][-1] - (LENGTH, 0.0, 0.0)


def elastica(load: float, bending: float) -> tuple[float, float]:
    """Shortening and deflection of a cantilever under a load across its tip.

    By elliptic integrals, with the slope of the tip from the length of the beam.
    """
    alpha = np.sqrt(load * LENGTH**2 / bending)

    def integrals(slope: float) -> tuple[float, float]:
        k = np.sqrt((1 + np.sin(slope)) / 2)
        start = np.arcsin(1 / (np.sqrt(2) * k))
        F = ellipkinc(np.pi / 2, k * k) - ellipkinc(start, k * k)
        return F, F - 2 * (ellipeinc(np.pi / 2, k * k) - ellipeinc(start, k * k))
    slope = brentq(lambda x: integrals(x)[0] - alpha, 1e-12, np.pi / 2 - 1e-9, xtol=1e-15)
    along = np.sqrt(2 * np.sin(slope)) / alpha
    return LENGTH * (1 - along), LENGTH * integrals(slope)[1] / alpha


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    found = {"small load, soft": moved((SMALL, 0.0), division, 8, 2)[1],
             "small load, stiff": moved((0.0, SMALL), division, 8, 2)[2]}
    for load in LOADS:
        u = moved((load, 0.0), BODIES * division, BODIES * division, 0)
        found |= {f"shortening under {load} N": -u[0], f"deflection under {load} N": u[1]}
    return found


CASE = Case("Princeton beam", "O. A. Bauchau et al. 2016 (section, length, material)", measure, (
    Quantity("small load, soft", SMALL * LENGTH**3 / (3 * WEAK)),
    Quantity("small load, stiff", SMALL * LENGTH**3 / (3 * STRONG)),
    *(Quantity(f"{name} under {load} N", value, elastica(load, WEAK)[1], group=f"{load}")
      for load in LOADS
      for name, value in zip(("shortening", "deflection"), elastica(load, WEAK), strict=True))),
    "P L^3/(3 E I) under 1e-4 N, one superelement; under the experiment's loads the elastica")
