"""The slewing beam of Kane, Ryan and Banerjee, of which Chrono stiffens the soft direction."""

from collections.abc import Mapping

import numpy as np

from sebody import Model, generalized_alpha, simulate
from sebody.fem import StiffnessSection
from sebody.scenes import spin_up
from sebody.verify.outside.case import Case, Quantity

LENGTH, SPEED, AXIAL, SHEAR, BENDING, MASS = spin_up.CASES["kane"]
SOFT, TORSION = 1.654, 6.047e5      # bending across the plane of rotation, torsion [N m2]
STEP, END, MODES = 0.005, 8.0, 4
LARGEST = -0.53366                  # m, at 6.77 s


def planar(bodies: int) -> Model:
    """In the plane of rotation."""
    return spin_up.build("kane", bodies, MODES, 24).model


def spatial(bodies: int) -> Model:
    """The same in space, soft across the plane."""
    rotary = MASS * BENDING / AXIAL
    section = StiffnessSection(AXIAL, SOFT, BENDING, TORSION, MASS, rotary, 0.0, rotary, SHEAR,
                               None)
    model = Model()
    root, tip = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (LENGTH, 0.0, 0.0))
    model.beam("arm", (root, tip), section, 24, bodies, 2 * MODES)
    model.revolute(root, axis="z", name="hinge")
    model.drive_angle("hinge", spin_up.turning(SPEED))
    return model


def lag(model: Model, h: float = STEP) -> tuple[float, float, float]:
    """Largest displacement of the tip across the turning axis, when, and out of the plane."""
    result = simulate(model, h, END, generalized_alpha(0.9))
    angle = np.array([spin_up.turning(SPEED)[0](t) for t in result.t])
    tip = result["tip.position"]
    across = -tip[:, 0] * np.sin(angle) + tip[:, 1] * np.cos(angle)
    k = int(across.argmin())
    return across[k], result.t[k], float(np.abs(tip[:, 2:]).max(initial=0.0))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    flat, when, _ = lag(planar(division))
    deep, later, beside = lag(spatial(division))
    return {"largest displacement, planar [m]": flat, "its time, planar [s]": when,
            "largest displacement, spatial [m]": deep, "its time, spatial [s]": later,
            "out of the plane, spatial [m]": beside}


CASE = Case(
    "Slewing beam, one superelement", "Chrono, src/demos/modal/demo_MOD_slewing_beam.cpp; T. R. "
    "Kane, R. R. Ryan and A. K. Banerjee 1987", measure,
    tuple(one for label in ("planar", "spatial") for one in (
        Quantity(f"largest displacement, {label} [m]", LARGEST, printed=5e-6,
                 source_tolerance=0.1, group="displacement"),
        Quantity(f"its time, {label} [s]", 6.77, printed=0.05)))
    + (Quantity("out of the plane, spatial [m]", 0.0, LENGTH),),
    "undamped, EI 1.654 as it is; Chrono multiplies it by 20 and damps. The reference is a "
    "geometrically exact beam of 12 quadratic elements, good to 5e-4")
