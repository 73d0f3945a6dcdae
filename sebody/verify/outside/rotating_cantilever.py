"""A cantilever that turns about its root, slenderness 70, by the spin (mboct-fem-pkg).

Length, bending stiffness and mass a length are one, so spins and frequencies are those of the
tables. The table is of the undeformed length; at a spin of 10 a beam is 0.7 % longer, and the
reference is that of an extensible beam about this state by polynomials.
"""

from collections.abc import Mapping

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.linalg import eigvals

from sebody import Model
from sebody.analysis import equilibrium, modes
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

SLENDERNESS = 70.0
AXIAL = SLENDERNESS**2
SECTION = StiffnessSection(AXIAL, 1.0, 1.0, 1.0, 1.0, 1e-9, 0.0, 0.0)
ELEMENTS, MODES = 24, 12
TABLE = {"chordwise": 3.6195, "flapwise": 4.1373}       # at a spin of 2
TERMS = 14


def build(bodies: int) -> Model:
    """In space, clamped at the axis of rotation."""
    model = Model()
    root, tip = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (1.0, 0.0, 0.0))
    model.beam("beam", (root, tip), SECTION, ELEMENTS, bodies, MODES)
    model.fix(root)
    return model


def found(bodies: int, spin: float) -> dict[str, float]:
    """First frequencies across the axis of rotation and along it."""
    result = equilibrium(build(bodies), 4, spin=(0.0, 0.0, spin))
    chord, flap = modes(result, (0.0, 0.0, spin)).values.imag[:2]
    return {"chordwise": abs(chord), "flapwise": abs(flap)}


def extensible(spin: float) -> dict[str, float]:
    """The same of an extensible beam without shear and rotary inertia, about its steady state.

    It is stretched by ``x' = cos(a s) / cos(a)``, ``a^2 = W^2 / EA``, under ``N = EA (x' - 1)``;
    small motion (u, v) along and across has the second variation
    ``EI ((v'/x')')^2 + N v'^2 / x' + EA u'^2 - W^2 (u^2 + v^2)`` and Coriolis terms.
    """
    s, weights = np.polynomial.legendre.leggauss(3 * TERMS)
    s, weights = (s + 1) / 2, weights / 2
    a = spin / np.sqrt(AXIAL)
    stretch, change = np.cos(a * s) / np.cos(a), -a * np.sin(a * s) / np.cos(a)
    force = AXIAL * (stretch - 1)

    def shapes(power: int) -> tuple[NDArray, NDArray, NDArray]:
        """Polynomials ``s^power P_k`` and two derivatives, (TERMS, points)."""
        rows = [np.polynomial.Polynomial.fromroots([0.0] * power) * np.polynomial.Polynomial(
            legendre.leg2poly(np.eye(TERMS)[k])).convert(domain=[-1, 1])(
                np.polynomial.Polynomial([-1.0, 2.0])) for k in range(TERMS)]
        return tuple(np.array([row.deriv(order)(s) if order else row(s) for row in rows])
                     for order in range(3))

    def product(f: NDArray, g: NDArray, weight: NDArray | float = 1.0) -> NDArray:
        return (f * (weights * weight)) @ g.T
    u, du, _ = shapes(1)
    v, dv, ddv = shapes(2)
    bent = ddv / stretch - dv * change / stretch**2
    K = product(bent, bent) + product(dv, dv, force / stretch)
    M = product(v, v)
    flap = np.sqrt(np.sort(eigvals(K, M).real)[0])
    n = 2 * TERMS
    zero = np.zeros((TERMS, TERMS))
    whole = np.block([[product(du, du, AXIAL) - spin**2 * product(u, u), zero],
                      [zero, K - spin**2 * M]])
    mass = np.block([[product(u, u), zero], [zero, M]])
    cross = 2 * spin * product(u, v)
    turning = np.block([[zero, -cross], [cross.T, zero]])
    first = np.block([[np.zeros((n, n)), np.eye(n)], [-whole, -turning]])
    second = np.block([[np.eye(n), np.zeros((n, n))], [np.zeros((n, n)), mass]])
    roots = np.abs(eigvals(first, second).imag)
    return {"chordwise": float(np.sort(roots)[0]), "flapwise": float(flap)}


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return {f"{name} at a spin of {spin}": value for spin in (2, 10)
            for name, value in found(division, float(spin)).items()}


CASE = Case(
    "Rotating cantilever, one superelement", "mboct-fem-pkg, inst/fem_tests_060.tst (slenderness "
    "70)", measure,
    (*(Quantity(f"{name} at a spin of 2", value, printed=5e-5, source_tolerance=1e-2)
       for name, value in TABLE.items()),
     *(Quantity(f"{name} at a spin of 10", value, source_tolerance=5e-3, share=1.0)
       for name, value in extensible(10.0).items())),
    "one body of 12 modes; at a spin of 10 the source's 4.97 and 11.2023 are those of the "
    "undeformed length, and the reference is an extensible beam by polynomials")
