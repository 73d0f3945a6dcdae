"""A fast heavy top on a fixed point (Bruls, Cardona and Arnold; EXUDYN)."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sebody import generalized_alpha, simulate
from sebody.scenes import heavy_top
from sebody.verify.outside.case import Case, Quantity

STEP, END = 2e-5, 2.0
QUATERNION = -0.70828, 0.43878, 0.54573, 0.0894         # at 0.2 s, Runge and Kutta's method
DIGITS = 5e-6, 5e-6, 5e-6, 5e-5
TIMES = 0.2, 1.0, 2.0


def place(times: tuple[float, ...]) -> NDArray:
    """Centre of mass by Euler's equations about the pivot, with quaternions, at 1e-12, (n, 3)."""
    J = np.array(heavy_top.INERTIA) + 15.0 * np.array([1.0, 0.0, 1.0])

    def rate(_: float, y: NDArray) -> NDArray:
        (w, x), spin = (y[0], y[1:4]), y[4:]
        R = np.eye(3) + 2 * w * _cross(x) + 2 * _cross(x) @ _cross(x)
        moment = np.cross((0.0, 1.0, 0.0), R.T @ (0.0, 0.0, -15.0 * 9.81))
        return np.concatenate([[-x @ spin / 2], (w * spin + np.cross(x, spin)) / 2,
                               (moment - np.cross(spin, J * spin)) / J])
    run = solve_ivp(rate, (0.0, times[-1]), [1.0, 0, 0, 0, *heavy_top.SPIN], method="DOP853",
                    t_eval=times, rtol=1e-12, atol=1e-12)
    return Rotation.from_quat(run.y[[1, 2, 3, 0]].T).apply((0.0, 1.0, 0.0))


def _cross(x: NDArray) -> NDArray:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    h = STEP / division
    result = simulate(heavy_top.build().model, h, END, generalized_alpha(0.9, 1e-10),
                      round(1e-3 / h))
    R = Rotation.from_matrix(result["pivot.rotation"][200]).as_quat()[[3, 0, 1, 2]]
    R = R * np.sign(R[0]) * np.sign(QUATERNION[0])
    found = {f"quaternion {k} at 0.2 s": value for k, value in enumerate(R)}
    for t in TIMES:
        found |= {f"{axis} of the centre at {t} s": value for axis, value in zip(
            "xyz", result["centre.position"][round(1e3 * t)], strict=True)}
    return found


CASE = Case(
    "Heavy top", "EXUDYN, TestModels/heavyTop.py (Runge and Kutta's method); O. Bruls, A. Cardona "
    "and M. Arnold 2012", measure,
    (*(Quantity(f"quaternion {k} at 0.2 s", value, 1.0, printed=digit, group="quaternion")
       for k, (value, digit) in enumerate(zip(QUATERNION, DIGITS, strict=True))),
     *(Quantity(f"{axis} of the centre at {t} s", value, 1.0, group=f"{t}")
       for t, row in zip(TIMES, place(TIMES), strict=True)
       for axis, value in zip("xyz", row, strict=True))),
    "places: Euler's equations with quaternions at 1e-12")
