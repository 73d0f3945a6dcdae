"""A02 of the IFToMM library: two four-bar loops, which fall through flat configurations."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sebody import generalized_alpha, simulate
from sebody.results.result import Result
from sebody.scenes import four_bar
from sebody.verify.outside.case import Case, Quantity
from sebody.verify.outside.iftomm import ADMITTED, INTERVAL, error

END, STEP, LOOPS = 10.0, 2e-4, 2
PASSING = 5e-3      # of what is admitted: flat configurations multiply rounding by a thousand


def rocker(t: NDArray, loops: int = LOOPS) -> NDArray:
    """Angle of the rockers and its rate, (2, n), from one equation of motion."""
    inertia = (loops + 1) / 3 + loops
    weight = ((loops + 1) / 2 + loops) * 9.81
    run = solve_ivp(lambda _, y: [y[1], -weight / inertia * np.cos(y[0])], (0.0, t[-1]),
                    [np.pi / 2, -1.0], method="DOP853", t_eval=t, rtol=1e-13, atol=1e-13)
    return run.y


def path(t: NDArray) -> NDArray:
    """Place of the first joint, (n, 2)."""
    angle = rocker(t)[0]
    return np.column_stack([np.cos(angle), np.sin(angle)])


def run(division: int = 1, end: float = END) -> Result:
    """Without numerical damping."""
    h = STEP / division
    return simulate(four_bar.build(LOOPS).model, h, end, generalized_alpha(index=2),
                    round(INTERVAL / h))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    result = run(division)
    (x, y), (u, v) = result["B0.position"][-1], result["B0.velocity"][-1]
    return {"error of the library": error(result["B0.position"], path(result.t)),
            "x at 10 s": x, "y at 10 s": y, "x velocity at 10 s": u, "y velocity at 10 s": v}


# EXUDYN at h 5e-4, 2.5e-4, 1.25e-4: the last two, extrapolated for order 2, and their difference
PEER = {"x": (0.3284552113, 0.3284573768), "y": (0.9445195467, 0.9445187937),
        "x velocity": (1.423045728, 1.423050003), "y velocity": (-0.4948619021, -0.4948670827)}

CASE = Case(
    "N four-bar, N = 2", "IFToMM library A02; EXUDYN, TestModels/fourBarMechanismIftomm.py",
    measure,
    (Quantity("error of the library", 0.0, 1.0, source_tolerance=ADMITTED, share=PASSING),
     *(Quantity(f"{name} at 10 s", fine + (fine - coarse) / 3, printed=abs(
        fine - coarse) / 3, source_tolerance=abs(fine - coarse), share=1.0)
        for name, (coarse, fine) in PEER.items())),
    "error: against one equation of motion at 1e-13; places and velocities: EXUDYN's, extrapolated "
    "from its two finest steps, whose difference is its own error. Shorter steps gain nothing: "
    "motion is not unique in flat configurations, where what rounding leaves grows by three orders")
