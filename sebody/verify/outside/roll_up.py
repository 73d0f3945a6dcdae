"""A cantilever that a moment at its tip bends to an arc, a half and a whole circle."""

from collections.abc import Mapping
from math import cos, pi, sin

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

LENGTH, BENDING = 10.0, 1e4
SECTION = StiffnessSection(1e8, BENDING, BENDING, BENDING, 1.0, 1.0, 0.0, 0.0)
TURNS = {0.25: "quarter", 0.5: "half", 1.0: "whole"}
ELEMENTS = 32


def exact(turn: float) -> tuple[float, float]:
    """Displacement of the tip along and across."""
    t = 2 * pi * turn
    return LENGTH * (sin(t) / t - 1), LENGTH * (1 - cos(t)) / t


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    found = {}
    for turn, label in TURNS.items():
        model = Model(planar=True)
        root, tip = model.node("root", (0.0, 0.0)), model.node("tip", (LENGTH, 0.0))
        model.beam("beam", (root, tip), SECTION, ELEMENTS * division)
        model.fix(root)
        model.torque(tip, 2 * pi * turn * BENDING / LENGTH)
        u = equilibrium(model, 10)["tip.position"][-1] - (LENGTH, 0.0)
        found |= {f"{label} circle, along": u[0], f"{label} circle, across": u[1]}
    return found


CASE = Case(
    "Roll-up of a cantilever", "code_aster, V6.04.138 (closed form; J. C. Simo and L. Vu-Quoc "
    "1986)", measure,
    tuple(Quantity(f"{label} circle, {way}", value, LENGTH, group="all")
          for turn, label in TURNS.items()
          for way, value in zip(("along", "across"), exact(turn), strict=True)),
    "32 nonlinear elements, by the length of the beam")
