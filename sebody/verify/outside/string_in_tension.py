"""A long slender beam in tension, held across at both ends: string modes (FEDEM)."""

from collections.abc import Mapping
from math import pi, sqrt

from sebody import Model
from sebody.analysis import equilibrium, modes
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

TENSION, MASS, E, RADIUS, LENGTH = 54.6e6, 556.58, 2.1e11, 0.15, 100.0
AXIAL, BENDING = E * pi * RADIUS**2, E * pi / 4 * RADIUS**4
STRETCH = 1 + TENSION / AXIAL
FEDEM = 1.56716108, 3.14104772, 4.72833395, 6.33559418, 7.96925497
BODIES, ELEMENTS, MODES = 8, 80, 4


def exact(n: int, length: float, mass: float, bending: float) -> float:
    """Frequency of a pinned beam in tension, of Euler and Bernoulli [Hz]."""
    k = n * pi / length
    return k / (2 * pi) * sqrt((TENSION + bending * k * k) / mass)


def stretched(n: int) -> float:
    """The same of the stretched beam, whose curvature bends by material lengths."""
    return exact(n, LENGTH * STRETCH, MASS / STRETCH, BENDING * STRETCH**-1 * STRETCH**2 / STRETCH)


def frequencies(length: float, mass: float, division: int) -> list[float]:
    """In a plane, of a beam that has this length and mass a length without tension [Hz]."""
    section = StiffnessSection(AXIAL, BENDING, BENDING, BENDING, mass, 1.0, 0.0, 0.0)
    model = Model(planar=True)
    left, right = model.node("left", (0.0, 0.0)), model.node("right", (length, 0.0))
    model.beam("beam", (left, right), section, ELEMENTS * division, BODIES * division, MODES)
    model.fix(left, "position")
    model.slider(right, axis=(1.0, 0.0))
    model.force(right, (TENSION, 0.0))
    return list(modes(equilibrium(model, 4)).frequency[:5])


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    own = frequencies(LENGTH, MASS, division)
    final = frequencies(LENGTH / STRETCH, MASS * STRETCH, division)
    return ({f"mode {k + 1}, 100 m before tension [Hz]": f for k, f in enumerate(own)}
            | {f"mode {k + 1}, 100 m in tension [Hz]": f for k, f in enumerate(final)})


CASE = Case(
    "String modes of a beam in tension", "fedem-solver-tests, TimeDomain/BeamModes", measure,
    (*(Quantity(f"mode {k}, 100 m before tension [Hz]", stretched(k))
       for k in range(1, 6)),
     *(Quantity(f"mode {k + 1}, 100 m in tension [Hz]", value,
                printed=abs(value - exact(k + 1, LENGTH, MASS, BENDING)))
       for k, value in enumerate(FEDEM))),
    "FEDEM's frequencies are of a length of 100 m in tension, the first rows of 100 m without it, "
    "which a nonlinear beam has; FEDEM's own, of 100 elements, are 4e-5 to 9e-4 below the "
    "closed form, which bounds what they are good for")
