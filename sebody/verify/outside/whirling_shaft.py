"""Backward and forward whirl of a simply supported shaft (code_aster)."""

from collections.abc import Mapping
from math import pi, sqrt

import numpy as np

from sebody import Model
from sebody.analysis import modes
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

LENGTH, DIAMETER, E, DENSITY, SPIN = 1.3, 0.08, 2.1e11, 7800.0, 3000.0      # SPIN in rad/s
AREA, INERTIA = pi / 4 * DIAMETER**2, pi / 64 * DIAMETER**4
POLAR = DENSITY * AREA * DIAMETER**2 / 8        # a length
SECTION = StiffnessSection(E * AREA, E * INERTIA, E * INERTIA, 0.8 * E * INERTIA, DENSITY * AREA,
                           POLAR, 0.0, 0.0)


def exact(n: int) -> tuple[float, float]:
    """Backward and forward frequency [rad/s]."""
    still = (n * pi / LENGTH)**2 * sqrt(E * INERTIA / (DENSITY * AREA))
    share = SPIN * POLAR / (2 * sqrt(E * INERTIA * DENSITY * AREA))
    return still * (sqrt(share**2 + 1) - share), still * (sqrt(share**2 + 1) + share)


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model()
    a, b = model.node("a", (0.0, 0.0, 0.0)), model.node("b", (LENGTH, 0.0, 0.0))
    model.beam("shaft", (a, b), SECTION, 24 * division, 2 * division, 4)
    model.fix(a, "position")
    model.slider(b, axis="x")
    values = np.abs(modes(model, (SPIN, 0.0, 0.0)).values.imag)
    found = {}
    for n in (1, 2):
        for label, wanted in zip(("backward", "forward"), exact(n), strict=True):
            found[f"{label} {n} [rad/s]"] = values[np.argmin(np.abs(values - wanted))]
    return found


CASE = Case(
    "Whirling shaft", "code_aster, V2.02.141 (closed form; R.-J. Gibert)", measure,
    tuple(Quantity(f"{label} {n} [rad/s]", value, source_tolerance=1e-2)
          for n in (1, 2)
          for label, value in zip(("backward", "forward"), exact(n), strict=True)),
    "the formula is the source's, the dimensions are not; no rotary inertia but the polar one")
