"""Reference of the stiff flyball governor (IFToMM A05): three equations of motion at 1e-12.

    python tests/data/flyball_governor.py

The arms move alike, so that coordinates are the angle of the shaft, that of the arms below the
horizontal, and the height of the slider. SymPy derives Lagrange's equations; DOP853 and Radau,
which share nothing, have to agree. It prints the numbers of
`sebody/verify/outside/flyball_governor.py`, whose data it takes.
"""

import sys

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sebody.verify.outside.flyball_governor import (
    ANGLE,
    BALL,
    BAR,
    DAMPER,
    FREE,
    GRAVITY,
    HINGE,
    SIDE,
    SLIDER,
    SLIDES,
    SPIN,
    SPRING,
    THICK,
)


def equations():
    """Accelerations as a compiled function of coordinates (turn, arm, slider) and rates."""
    q, v = sp.symbols("q:3"), sp.symbols("v:3")
    (_, arm, height), (spin, swing, slide) = q, v
    out, up = sp.cos(arm), -sp.sin(arm)             # of an arm, in its turning plane

    def speeds(r, z):
        """Square of the velocity of a point of an arm's plane at a distance from the axis."""
        radial, vertical = sp.diff(r, arm) * swing, sp.diff(z, arm) * swing
        return radial**2 + vertical**2 + (r * spin)**2
    axial, across = BAR * THICK**2 / 6, BAR * (1 + THICK**2) / 12
    middle = speeds(HINGE + out / 2, 1 + up / 2)
    ball = speeds(HINGE + out, 1 + up)
    # spin of an arm: `swing` across, `spin` with a part along the arm
    one_arm = (BAR * middle + BALL * ball + across * (swing**2 + (spin * out)**2)
               + axial * (spin * up)**2) / 2
    kinetic = 2 * one_arm + (axial + SLIDER * SIDE**2 / 6) * spin**2 / 2 + SLIDER * slide**2 / 2
    potential = GRAVITY * (2 * (BAR * up / 2 + BALL * up) + SLIDER * height)
    length = sp.sqrt((HINGE + out / 2 - SIDE / 2)**2 + (1 + up / 2 - height)**2)
    potential += 2 * SPRING * (length - FREE)**2 / 2
    stretching = sp.diff(length, arm) * swing + sp.diff(length, height) * slide
    dissipation = 2 * DAMPER * stretching**2 / 2
    M = sp.hessian(kinetic, v)
    forces = sp.Matrix([
        sp.diff(kinetic - potential, x) - sp.diff(dissipation, u)
        - sum(sp.diff(sp.diff(kinetic, u), y) * w for y, w in zip(q, v, strict=True))
        for x, u in zip(q, v, strict=True)])
    return sp.lambdify([q, v], [M, forces], cse=True)


def solution(times: NDArray, method: str, rtol: float = 1e-12) -> NDArray:
    """Turn, arm and slider at some times, (3, n)."""
    both = equations()

    def rate(_, y):
        M, forces = both(y[:3], y[3:])
        return np.concatenate([y[3:], np.linalg.solve(M, forces)[:, 0]])
    start = [0.0, ANGLE, 0.5, SPIN, 0.0, 0.0]
    run = solve_ivp(rate, (0.0, times[-1]), start, method=method, t_eval=times, rtol=rtol,
                    atol=1e-14)
    return run.y[:3]


def main() -> None:
    """Print the slider and the turn of the shaft, and by how much both methods differ."""
    times = np.array([float(t) for t in sys.argv[1:]] or list(SLIDES))
    with np.errstate(over="ignore"):        # Radau steps far in the turn, which moves nothing
        one, other = (solution(times, method) for method in ("DOP853", "Radau"))
    print("largest difference of the methods", np.abs(one - other).max())
    for t, (turn, _, slider) in zip(times, one.T, strict=True):
        print(f"{t:g}: slider {slider:.15f} turn {turn:.15f}")


if __name__ == "__main__":
    main()
