"""Two members with a hinge spring, linear, beside ANSYS (OpenFAST, SubDyn)."""

from collections.abc import Mapping
from math import pi

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import Section
from sebody.verify.outside.case import Case, Quantity

SMALL = 1e-6            # of all loads, so that displacements are linear in them
TIP, HINGE, GRAVITY = (-5.31e7, 0.0, 7.3e5), 9.1673e9, 9.8066
POLYGON = 0.99924       # ANSYS's section is a polygon with this part of the circle's area
INERTIA, NU = POLYGON**2 * pi / 64 * 2.1**4, 0.2
SHEAR = 6 * (1 + NU) / (7 + 6 * NU)        # of a circle (G. R. Cowper 1966)
SECTION = Section(POLYGON * pi / 4 * 2.1**2, INERTIA, INERTIA, 2 * INERTIA, 4.2e10, NU, 1375.0,
                  SHEAR)
ANSYS = {"ux at 10 m": -0.003653, "uz at 10 m": 0.0021272, "ux at 20 m": -0.0073061,
         "uz at 20 m": 0.015307, "ux at 32 m": -0.01169, "uz at 32 m": 0.047091,
         "V at the root": -763360.0, "M at the root": 532740.0}
SIZES = {"ux": 0.01169, "uz": 0.047091, "V ": 763360.0, "M ": 7.3e5 * 32}
PRINTED = {"ux": 5e-7, "uz": 5e-7, "V ": 5.0, "M ": 5.0}


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model()
    model.gravity((0.0, 0.0, -SMALL * GRAVITY))
    nodes = [model.node(f"at {x}", (x, 0.0, 0.0)) for x in (0, 1)]
    outer = [model.node("beyond", (1, 0, 0), at=nodes[1]),
             *(model.node(f"at {x}", (x, 0.0, 0.0)) for x in (10, 20, 32))]
    model.beam("short", nodes, SECTION, division, division)
    for k, count in enumerate((9, 10, 12)):
        model.beam(f"long {k}", outer[k:k + 2], SECTION, count * division, division, 2)
    model.fix(nodes[0])
    model.revolute(outer[0], axis="y", to=nodes[1], name="hinge")
    model.torsion_spring("hinge", HINGE)
    model.force(outer[-1], tuple(SMALL * f for f in TIP))
    result = equilibrium(model, 1)
    found = {"V at the root": -result["at 0.reaction"][-1, 2] / SMALL,
             "M at the root": -result["at 0.reaction_moment"][-1, 1] / SMALL}
    for x in (10, 20, 32):
        u = result[f"at {x}.position"][-1] - (x, 0, 0)
        found |= {f"ux at {x} m": u[0] / SMALL, f"uz at {x} m": u[2] / SMALL}
    return found


CASE = Case(
    "Two members with a hinge spring", "OpenFAST r-test, modules/subdyn/SD_AnsysComp1_PinBeam/"
    "ANSYS_reference_results.txt", measure,
    tuple(Quantity(name, value, SIZES[name[:2]], PRINTED[name[:2]], source_tolerance=1e-2)
          for name, value in ANSYS.items()),
    "ANSYS's table has the weight of a section that is 7.6e-4 too small, a polygon, which is "
    "taken here; displacements and forces by their largest values, linear")
