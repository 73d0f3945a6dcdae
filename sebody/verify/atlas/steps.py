"""Steps that follow the phase of a conservative motion."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipk

from sebody.model.model import Model
from sebody.runs.planning import Plan
from sebody.runs.schemes import generalized_alpha
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance
from sebody.runs.whole_runs import simulate
from sebody.verify.atlas.finding import PROGRAM, Finding, Row

WEIGHT, INERTIA = 9.81, 4.0 / 3.0       # of a uniform rod of 1 kg and 2 m, about its end
ANGLE = 2.0             # from below, at which it is let go [rad]
SHORT, LONG = 0.01, 0.02        # steps [s]
SWINGS = 20


def following() -> Finding:
    """A pendulum whose steps are shorter as it falls, as it rises, or near its turning points."""
    finding = Finding(
        "steps that follow the phase",
        "energy drifts if steps are shorter before a turn than after it",
        "With equal steps the trapezoidal rule keeps H + h^2 Q/12, Q = v.Kv + a.Ma. A change of "
        "the step from h to h' leaves (h'^2 - h^2) Q/12 in H. Changes at turns and at the bottom "
        "add up, unless steps are the same before and after a turn.",
        "sebody plans the steps of a run within a tolerance: one length, wherever that costs at "
        "most twice the steps.",
        "half swings", "energy, relative to that of the swing")
    size = WEIGHT * (1.0 - np.cos(ANGLE))
    drift = (LONG**2 - SHORT**2) * (_q_below() - _q_at_turns()) / 12.0 / size
    count, theory = np.arange(SWINGS + 1), []
    for label, lengths, expected in (
            ("short as it falls", (SHORT, SHORT, LONG, LONG), drift),
            ("short as it rises", (LONG, LONG, SHORT, SHORT), -drift),
            ("short about turns", (SHORT, LONG, LONG, SHORT), 0.0)):
        energy = _energies(lengths) / size
        per_swing = float(energy[-1] / SWINGS)
        finding.rows.append(Row(f"{label}: drift in half a swing", expected, per_swing,
                                0.05 if expected else 0.05 * abs(drift)))
        finding.curves[label] = count, energy
        theory += [*(expected * count), np.nan]
    finding.predict("theory", np.tile([*count, np.nan], 3), theory)
    planned, fixed = _planned()
    finding.rows.append(Row("planned steps: error over that of fixed ones", 1.0, planned / fixed,
                            0.05, PROGRAM))
    return finding


def _q_below() -> float:
    """v.Kv at the bottom, where nothing is accelerated along the swing."""
    return WEIGHT * 2.0 * WEIGHT * (1.0 - np.cos(ANGLE)) / INERTIA


def _q_at_turns() -> float:
    """a.Ma where it stands still."""
    return float((WEIGHT * np.sin(ANGLE))**2 / INERTIA)


def _half_period() -> float:
    return float(2.0 * ellipk(np.sin(ANGLE / 2.0)**2) / np.sqrt(WEIGHT / INERTIA))


def pendulum(angle: float = ANGLE) -> Model:
    """A uniform rod that is let go from an angle."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    model.rigid_body("rod", model.node("pin", (0.0, 0.0)), 1.0, 1.0 / 3.0,
                     centre=(np.sin(angle), -np.cos(angle)))
    model.fix("pin", "position")
    return model


def _energies(lengths: tuple[float, ...]) -> NDArray:
    """Change of the energy at the turns, with these steps in the quarters of every half swing."""
    half = _half_period()
    ends = half / len(lengths) * np.arange(1, SWINGS * len(lengths) + 1)
    plan = Plan(np.stack([ends, np.tile(lengths, SWINGS)], axis=1), allowed=np.inf)
    run = Simulation(pendulum(), half / 64, generalized_alpha(1.0, tolerance=1e-12),
                     tolerance=Tolerance(1.0), plan=plan).run_to(SWINGS * half).result()
    energy = (INERTIA * run["pin.angular_velocity"]**2 / 2.0
              - WEIGHT * np.cos(run["pin.rotation"] + ANGLE))
    return energy[::64] - energy[0]


def _planned() -> tuple[float, float]:
    """Largest errors of planned steps and of as many fixed ones, by far shorter ones."""
    t_end = 6.0
    scheme = generalized_alpha(index=2)
    planned = simulate(pendulum(), 0.01, t_end, scheme, tolerance=Tolerance(1e-5))
    fixed = simulate(pendulum(), t_end / planned.steps, t_end, scheme)
    exact = simulate(pendulum(), 1e-4, t_end, scheme, output_every=100)
    return tuple(float(np.abs(np.interp(exact.t, one.t, np.unwrap(one["pin.rotation"]))
                              - np.unwrap(exact["pin.rotation"]))[-1]) for one in (planned, fixed))
