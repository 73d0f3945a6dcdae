"""A rod that its spin stretches by three per cent (code_aster, SSLV104 and SSLV105)."""

from collections.abc import Mapping
from math import sqrt, tan

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

LENGTH, AREA, E, DENSITY, SPIN = 0.5, 4e-4, 2e11, 7800.0, 3000.0
SECTION = StiffnessSection(E * AREA, 1e4, 1e4, 1e4, DENSITY * AREA, 1e-3, 0.0, 0.0)
EXACT = tan(SPIN * sqrt(DENSITY / E) * LENGTH) / (SPIN * sqrt(DENSITY / E)) - LENGTH


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model(planar=True)
    root, tip = model.node("root", (0.0, 0.0)), model.node("tip", (LENGTH, 0.0))
    model.beam("rod", (root, tip), SECTION, 32 * division, 4 * division, 4)
    model.fix(root)
    result = equilibrium(model, 4, spin=SPIN)
    return {"extension [m]": result["tip.position"][-1, 0] - LENGTH}


CASE = Case(
    "Rotating rod", "code_aster, V3.04.105 (SSLV105, loads at the deformed place)", measure,
    (Quantity("extension [m]", EXACT, source_tolerance=1e-3),),
    "at the undeformed place (SSLV104) it is 0.014625, 3.5 % less")
