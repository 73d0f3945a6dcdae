"""Section forces of a heavy tube with a mass beyond its tip, at every attitude (SubDyn)."""

from collections.abc import Mapping
from math import cos, radians, sin

import numpy as np

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import tube
from sebody.verify.outside.case import Case, Quantity

GRAVITY, LENGTH, MASS, BEYOND = 9.80665, 10.0, 2000.0, 1.0
SECTION = tube(2.5, 0.1, 2.1e11, 0.3, 7860.0)
WEIGHT = SECTION.density * SECTION.area * GRAVITY       # a length
ANGLES = 0, 30, 60, 90                                  # degrees, by which the tube points up
PLACES = 0, 5                                           # m from the root


def build(angle: float, bodies: int) -> Model:
    """Along x, turned about y by a drive to an angle [rad] at t = 1."""
    model = Model()
    model.gravity((0.0, 0.0, -GRAVITY))
    root, middle, tip = (model.node(name, (x, 0.0, 0.0)) for name, x in (
        ("root", 0.0), ("middle", 5.0), ("tip", LENGTH)))
    model.beam("inner", (root, middle), SECTION, 8, bodies, 2)
    model.beam("outer", (middle, tip), SECTION, 8, bodies, 2)
    model.rigid_body("top", tip, MASS, np.zeros((3, 3)), (LENGTH + BEYOND, 0.0, 0.0))
    model.revolute(root, axis="y", name="hinge")
    model.drive_angle("hinge", lambda t, angle=angle: -angle * t, name="drive")
    return model


def exact(degrees: float, x: float) -> tuple[float, float, float]:
    """Normal force (tension), shear force and moment at a place, of the undeformed tube."""
    c, s, d = cos(radians(degrees)), sin(radians(degrees)), LENGTH - x
    own = MASS * GRAVITY + WEIGHT * d
    return -own * s, -own * c, (MASS * GRAVITY * (d + BEYOND) + WEIGHT * d * d / 2) * c


def section_forces(degrees: float, bodies: int) -> dict[int, tuple[float, float, float]]:
    """The same of a run: what acts on the part beyond each place, turned back."""
    result = equilibrium(build(radians(degrees), bodies), 1, t=1.0)
    along = np.array([cos(radians(degrees)), 0.0, sin(radians(degrees))])
    across = np.array([-along[2], 0.0, along[0]])
    found = {}
    for x, node, beam in ((0, "root", "inner"), (5, "middle", "outer")):
        part = beam if bodies == 1 else f"{beam} 1"
        force, moment = (result[f"{part}.{node}.{what}"][-1] for what in ("force", "moment"))
        found[x] = -force @ along, -force @ across, -moment[1]
    return found


SIZES = {"N": exact(90, 0)[0], "V": exact(0, 0)[1], "M": exact(0, 0)[2]}


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return {f"{name} at {x} m, {degrees} degrees": value for degrees in ANGLES
            for x, values in section_forces(degrees, division).items()
            for name, value in zip("NVM", values, strict=True)}


CASE = Case(
    "Own weight of a turning tube", "OpenFAST r-test, modules/subdyn/SD_SelfWeight_FloatingSystem/"
    "Beams_self-weight_floating_system.m", measure,
    tuple(Quantity(f"{name} at {x} m, {degrees} degrees", value, abs(SIZES[name]), group=name)
          for degrees in ANGLES for x in PLACES
          for name, value in zip("NVM", exact(degrees, x), strict=True)),
    "section forces by their largest values; the closed form is of the undeformed tube, from which "
    "the weight bends it by some 1e-5 of its length")
