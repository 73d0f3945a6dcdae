"""The spatial rigid slider-crank of the IFToMM library: crank, rod on a ball and a cross, slider.

Reference: one equation of motion for the angle of the crank. The rod points along e, from the pin
of the crank to the slider; the cross holds it normal to an axis that only turns about x, so its
spin is ``a' x + ...`` with the angle a of e about x, and its part along e is ``a' e_x``.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sebody import Model, generalized_alpha, simulate
from sebody.results.result import Result
from sebody.verify.outside.case import Case, Quantity
from sebody.verify.outside.iftomm import INTERVAL, drift, error, quantity

CRANK, ROD, PIVOT, SPEED, GRAVITY = 0.08, 0.3, np.array([0.0, 0.1, 0.12]), 6.0, 9.81
MASSES, AXIAL, ACROSS = (0.12, 0.5, 2.0), 4e-4, 4e-3
END, STEP = 5.0, 4e-5


def build() -> Model:
    """The crank upright, turning at 6 rad/s."""
    model = Model()
    model.gravity((0.0, 0.0, -GRAVITY))
    pin = PIVOT + [0.0, 0.0, CRANK]
    start = np.array([np.sqrt(ROD**2 - pin[1]**2 - pin[2]**2), 0.0, 0.0])
    e = (start - pin) / ROD
    crank = model.node("crank", PIVOT)
    model.rigid_body("crank", crank, MASSES[0], (1e-4, 1e-4, 1e-5), (PIVOT + pin) / 2)
    model.revolute(crank, axis="x", name="shaft")
    model.attach("pin", pin, crank)
    rod = model.node("rod", pin, at="pin")
    model.rigid_body("rod", rod, MASSES[1], ACROSS * np.eye(3) + (AXIAL - ACROSS) * np.outer(e, e),
                     (pin + start) / 2)
    model.attach("end", start, rod)
    slider = model.node("slider", start)
    model.rigid_body("slider", slider, MASSES[2], (1e-4, 1e-4, 1e-4))
    model.prismatic(slider, axis="x")
    cross = np.cross(e, (1.0, 0.0, 0.0))
    model.universal("end", axis=cross / np.linalg.norm(cross), other="x", to=slider, explicit=True)
    model.initial_velocity(crank, angular=(SPEED, 0.0, 0.0))
    return model


def places(angle: complex) -> tuple:
    """Pin's y and z and slider's x, and their derivatives by the angle."""
    s, c = np.sin(angle), np.cos(angle)
    y, z, dy, dz = PIVOT[1] - CRANK * s, PIVOT[2] + CRANK * c, -CRANK * c, -CRANK * s
    x = np.sqrt(ROD**2 - y * y - z * z)
    return y, z, x, dy, dz, -(y * dy + z * dz) / x


def _inertia_and_height(angle: complex) -> NDArray:
    """Twice the kinetic energy at a rate of one, and the weighted sum of heights."""
    y, z, x, dy, dz, dx = places(angle)
    turning = (y * dz - z * dy) / (y * y + z * z) * x / ROD         # of the rod along its axis
    across = (dx * dx + dy * dy + dz * dz) / ROD**2                 # of its direction, squared
    crank, rod, slider = MASSES
    inertia = (1e-4 + crank * CRANK**2 / 4 + rod * (dx * dx + dy * dy + dz * dz) / 4
               + AXIAL * turning**2 + ACROSS * across + slider * dx * dx)
    return np.array([inertia, crank * (PIVOT[2] + z) / 2 + rod * z / 2])


def solution(t: NDArray) -> NDArray:
    """Angle of the crank and place of the slider, (n, 2), by one equation at 1e-12."""
    def rate(_: float, w: NDArray) -> list:
        values = _inertia_and_height(w[0] + 1e-30j)
        (M, _), (dM, dV) = values.real, values.imag / 1e-30
        return [w[1], -(0.5 * dM * w[1]**2 + GRAVITY * dV) / M]
    run = solve_ivp(rate, (0.0, t[-1]), [0.0, SPEED], method="DOP853", t_eval=t, rtol=1e-12,
                    atol=1e-13)
    return np.column_stack([run.y[0], [places(angle)[2] for angle in run.y[0]]])


def run(division: int = 1) -> Result:
    """Five seconds without numerical damping."""
    h = STEP / division
    return simulate(build(), h, END, generalized_alpha(0.9, 1e-10), round(INTERVAL / h))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    result = run(division)
    found = np.column_stack([result["shaft.angle"], result["slider.position"][:, 0]])
    return {"error of the library": error(found, solution(result.t)),
            "drift of the energy [J]": drift(result)}


CASE = Case(
    "Spatial slider-crank", "IFToMM library, Spatial rigid slider-crank mechanism; EXUDYN, "
    "TestModels/sliderCrank3Dbenchmark.py", measure,
    (quantity(), Quantity("drift of the energy [J]", 0.0, 1.0)),
    "crank angle and slider, against one equation of motion at 1e-12")
