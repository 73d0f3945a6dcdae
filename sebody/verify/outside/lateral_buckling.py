"""A strip that a crank lifts by a link until it buckles sideways (Bauchau et al. 2016)."""

from collections.abc import Mapping
from dataclasses import replace
from math import cos, pi, sqrt

from scipy.linalg import eigh
from scipy.optimize import brentq

from sebody import Model, generalized_alpha, simulate
from sebody.analysis import equilibrium, linearize
from sebody.fem import StiffnessSection
from sebody.results.result import Result
from sebody.verify.outside.case import Case, Quantity

LENGTH, LINK, CRANK, OFFSET, LIFT = 1.0, 0.25, 0.05, 1e-4, 0.4
STRIP = StiffnessSection(73e6, 60830.0, 608.3, 877.2, 2.68, 2255.33e-6, 2233e-6, 22.33e-6,
                         5.025e6, 23.40e6)
ROD = StiffnessSection(33.02e6, 1189.0, 1189.0, 914.5, 1.212, 87.3e-6, 43.65e-6, 43.65e-6,
                       10.81e6, 10.81e6)
ARM = StiffnessSection(132.1e6, 19020.0, 19020.0, 14630.0, 4.85, 1396.6e-6, 698.3e-6, 698.3e-6,
                       43.22e6, 43.22e6)
VERTICAL = {0.02: 3.018e-4, 0.08: 4.620e-3, 0.12: 9.384e-3}        # s, m
LIMIT = 4.0126 * sqrt(608.3 * 877.2) / LENGTH**2                    # N
STEP, ELEMENTS = 5e-4, 12


def build(division: int = 1) -> Model:
    """The strip along x, flat in the plane of x and z; its nonlinear beams are one element each."""
    model = Model()
    root, middle, tip = (model.node(name, (x, 0.0, 0.0)) for name, x in (
        ("root", 0.0), ("middle", LENGTH / 2), ("tip", LENGTH)))
    count = ELEMENTS // 2 * division
    model.beam("inner", (root, middle), STRIP, count, count)
    model.beam("outer", (middle, tip), STRIP, count, count)
    model.fix(root)
    model.attach("lug", (LENGTH, OFFSET, 0.0), tip)
    top = model.node("top", (LENGTH, OFFSET, 0.0), at="lug")
    pin = model.node("pin", (LENGTH, OFFSET, -LINK))
    model.beam("link", (top, pin), ROD, 4, 1, 2, frame="mean_axes")
    end = model.node("end", pin.point, at=pin)
    model.revolute(end, axis="y", to=pin)
    pivot = model.node("pivot", (LENGTH - CRANK, OFFSET, -LINK))
    model.beam("crank", (pivot, end), ARM, 2, 1, 2, frame="mean_axes")
    model.revolute(pivot, axis="y", name="shaft")
    model.drive_angle("shaft", lambda t: -pi / 2 * (1 - cos(pi * t / LIFT)))
    return model


RIGID = 1e4             # times the vertical stiffness: the closed form has no bending before


def limit(elements: int) -> float:
    """Static load across the tip at which the strip buckles [N]."""
    strip = replace(STRIP, bending_y=RIGID * STRIP.bending_y, shear_y=None, shear_z=None)

    def square(load: float) -> float:
        """Lowest square of a frequency, which falls through zero."""
        model = Model()
        root, tip = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (LENGTH, 0.0, 0.0))
        model.beam("strip", (root, tip), strip, elements)
        model.fix(root)
        model.force(tip, (0.0, 0.0, load))
        found = linearize(equilibrium(model, 1, unstable="keep"))
        K = (found.stiffness + found.stiffness.T) / 2
        return float(eigh(K, found.mass, eigvals_only=True, subset_by_index=(0, 0))[0])
    return float(brentq(square, 0.8 * LIMIT, 1.2 * LIMIT, xtol=0.1))


def run(division: int = 1, end: float = 0.18) -> Result:
    """From rest."""
    return simulate(build(division), STEP, end, generalized_alpha(0.6))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    middle = run(division, max(VERTICAL))["middle.position"]
    return {f"vertical at {t} s [m]": middle[round(t / STEP), 2] for t in VERTICAL} | {
        "static limit load [N]": limit(ELEMENTS * division)}


CASE = Case(
    "Lateral buckling of a strip", "O. A. Bauchau et al. 2016, by V. Sonneville's mb_sef_py; the "
    "limit load of L. Prandtl 1899", measure,
    (*(Quantity(f"vertical at {t} s [m]", value, printed=5e-7, source_tolerance=0.05)
       for t, value in VERTICAL.items()),
     Quantity("static limit load [N]", LIMIT)),
    "middle of the strip before it buckles, at about 0.17 s in the source's stored run, at 0.15 s "
    "in sebody's: later values are not compared")
