"""A tube of two beams under a force across its tip, small displacements (OpenFAST, SubDyn)."""

from collections.abc import Mapping
from math import pi

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import Section
from sebody.verify.outside.case import Case, Quantity

LENGTH, FORCE, RATIO = 10.0, 2e6, 0.95          # RATIO: of the inner to the outer diameter, 1 m
SMALL = 1e-6            # of the force, so that displacements are linear in it
NU = 0.3


def cowper(m: float) -> float:
    """Shear factor of a hollow circle with this ratio of radii (G. R. Cowper 1966)."""
    a, b = (1 + m * m)**2, m * m
    return 6 * (1 + NU)**2 * a / ((7 + 14 * NU + 8 * NU**2) * a
                                  + 4 * b * (5 + 10 * NU + 4 * NU**2))


AREA, INERTIA = pi / 4 * (1 - RATIO**2), pi / 64 * (1 - RATIO**4)
SECTION = Section(AREA, INERTIA, INERTIA, 2 * INERTIA, 210e9, NU, 7850.0, cowper(RATIO))


def exact(x: float) -> tuple[float, float]:
    """Displacement and rotation at a height under the whole force."""
    EI, GA = 210e9 * INERTIA, 210e9 / 2 / (1 + NU) * AREA * cowper(RATIO)
    return (FORCE * (x * x * (3 * LENGTH - x) / (6 * EI) + x / GA),
            FORCE * x * (2 * LENGTH - x) / (2 * EI))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model()
    root, middle, top = (model.node(f"at {z:g}", (0.0, 0.0, z)) for z in (0.0, 5.0, 10.0))
    for name, ends in (("lower", (root, middle)), ("upper", (middle, top))):
        model.beam(name, ends, SECTION, 2 * division, division, 2)
    model.fix(root)
    model.force(top, (SMALL * FORCE, 0.0, 0.0))
    result = equilibrium(model, 1)
    found = {}
    for z in (5, 10):
        found[f"displacement at {z} m"] = result[f"at {z}.position"][-1, 0] / SMALL
        found[f"rotation at {z} m"] = result[f"at {z}.rotation"][-1][0, 2] / SMALL
    return found


CASE = Case(
    "Cantilever of two beams", "OpenFAST r-test, modules/subdyn/SD_2Beam_Cantilever/"
    "Analytical_solution_2_beams.m", measure,
    tuple(Quantity(f"{name} at {z} m", value) for z in (5, 10)
          for name, value in zip(("displacement", "rotation"), exact(z), strict=True)),
    "linear: under a millionth of the force, times a million")
