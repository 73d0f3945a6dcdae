"""A01 of the IFToMM library: a point mass on a massless bar, from the horizontal."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk

from sebody import Model, generalized_alpha, simulate
from sebody.results.result import Result
from sebody.verify.outside.case import Case, Quantity
from sebody.verify.outside.iftomm import INTERVAL, drift, error, quantity

GRAVITY, END, STEP = 9.81, 10.0, 1e-5


def build() -> Model:
    """At rest to the left of its hinge."""
    model = Model(planar=True)
    model.gravity((0.0, -GRAVITY))
    hinge = model.node("hinge", (0.0, 0.0))
    model.fix(hinge, "position")
    model.rigid_body("bob", hinge, 1.0, 0.0, centre=(-1.0, 0.0))
    model.attach("mass", (-1.0, 0.0), hinge)
    return model


def path(t: NDArray) -> NDArray:
    """Closed form by Jacobi's functions, (n, 2)."""
    k = np.sin(np.pi / 4)
    half = np.arcsin(k * ellipj(np.sqrt(GRAVITY) * t - ellipk(k * k), k * k)[0])
    return np.column_stack([np.sin(2 * half), -np.cos(2 * half)])


def run(division: int = 1) -> Result:
    """Ten seconds without numerical damping."""
    h = STEP / division
    return simulate(build(), h, END, generalized_alpha(1.0, 1e-11), round(INTERVAL / h))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    result = run(division)
    at_9_99 = result["mass.position"][np.searchsorted(result.t, 9.99 - 1e-9)]
    return {"error of the library": error(result["mass.position"], path(result.t)),
            "drift of the energy [J]": drift(result),
            "x at 9.99 s": at_9_99[0], "y at 9.99 s": at_9_99[1]}


CASE = Case(
    "Simple pendulum", "IFToMM library A01 (A01_specification.xml); the energy's bound as in "
    "EXUDYN, Examples/pendulumIftommBenchmark.py", measure,
    (quantity(), Quantity("drift of the energy [J]", 0.0, 1.0, source_tolerance=5e-5, share=1e-3),
     *(Quantity(f"{axis} at 9.99 s", exact, 1.0, source_tolerance=1e-3, share=1e-3)
       for axis, exact in zip("xy", path(np.array([9.99]))[0], strict=True))),
    "reference: closed form")
