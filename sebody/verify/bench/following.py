"""Steps that follow the phase of a motion: a pendulum beside its closed form."""

import statistics

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk

from sebody.results.result import Result
from sebody.runs.schemes import generalized_alpha
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance
from sebody.runs.whole_runs import simulate
from sebody.verify.atlas.steps import INERTIA, WEIGHT, pendulum
from sebody.verify.bench.measurement import Measurement

SCENE = "following-steps"
ANGLE = 3.0             # from below, near the top, at which the pendulum is let go [rad]
T_END, GRID = 20.0, 0.01
TOLERANCE, RUNS = 1e-5, 3


def measure(tolerance: float = TOLERANCE, t_end: float = T_END, runs: int = RUNS
            ) -> list[Measurement]:
    """Planned steps, as many equal ones, and steps that are chosen one by one.

    `tip_error` is relative to the angle at the start; `energy_drift` to the energy of the swing.
    """
    scheme, allowed = generalized_alpha(index=2), Tolerance(tolerance)

    def planned() -> Result:
        return simulate(pendulum(ANGLE), GRID, t_end, scheme, tolerance=allowed)

    def one_by_one() -> Result:
        return Simulation(pendulum(ANGLE), GRID, scheme, tolerance=allowed).run_to(t_end).result()
    count = planned().steps

    def equal() -> Result:
        return simulate(pendulum(ANGLE), t_end / count, t_end, scheme)
    return [_row(variant, [run() for _ in range(runs)], t_end) for variant, run in (
        (f"planned, tolerance {tolerance:g}", planned), ("as many equal steps", equal),
        (f"chosen one by one, {tolerance:g}", one_by_one))]


def _row(variant: str, results: list[Result], t_end: float) -> Measurement:
    last = results[-1]
    angle = np.unwrap(last["pin.rotation"]) + ANGLE
    energy = INERTIA * last["pin.angular_velocity"]**2 / 2.0 - WEIGHT * np.cos(angle)
    return Measurement(
        SCENE, variant, last.numbering.free, t_end / last.steps,
        statistics.median(r.microseconds_per_step for r in results), last.iterations_per_step,
        float(np.abs(angle - _exact(last.t)).max() / ANGLE),
        statistics.median(r.seconds for r in results),
        energy_drift=float(np.abs(energy - energy[0]).max() / (WEIGHT * (1.0 - np.cos(ANGLE)))))


def _exact(t: NDArray) -> NDArray:
    """Angle of the pendulum by elliptic functions, ``sin(angle / 2) = k sn(K - w t)``."""
    k = np.sin(ANGLE / 2.0)
    return 2.0 * np.arcsin(k * ellipj(ellipk(k**2) - np.sqrt(WEIGHT / INERTIA) * t, k**2)[0])


def drifts(measurements: list[Measurement]) -> list[str]:
    """Drift of the energy, a line each."""
    return [f"{m.scene}, {m.variant}: energy off by {m.energy_drift:.1e} of that of the swing, "
            f"path by {m.tip_error:.1e}" for m in measurements if m.energy_drift is not None]
