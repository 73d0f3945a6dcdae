"""The judgement of a run by its energy, for summaries, reports and warnings."""

import numpy as np
from numpy.typing import NDArray

LIMIT = 0.05            # share of the energy exchanged: speeds are off by half of it
ROUNDING = 1e-10        # of the energies, left by sums and by iterations that end at a tolerance


def energy_balance(kinetic: NDArray, strain: NDArray, potential: NDArray, work: NDArray) -> float:
    """Largest drift of kinetic + strain + potential - work, relative to the energy exchanged.

    The energy exchanged is the largest of kinetic and strain energy together, less the strain
    energy that is always there, of the range of the potential, and of the work that is done and
    taken back, the integral of the size of its power: where something drives a model for thousands
    of turns, drift and this work grow with the turns. Of a model at rest the drift is rounding, and
    the balance zero.

    Parameters
    ----------
    kinetic, strain, potential, work : (n,)
    """
    inner = kinetic + strain
    total = inner + potential - work
    rounding = rounded(inner, potential)
    drift = max(np.abs(total - total[0]).max() - rounding, 0.0)
    exchanged = max(inner.max() - strain.min(), np.ptp(potential), np.abs(np.diff(work)).sum())
    return float(drift / max(exchanged, rounding, 1e-300))


def rounded(inner: NDArray, potential: NDArray) -> float:
    """Energy that means nothing: what rounding makes of kinetic + strain and of the potential."""
    return float(ROUNDING * (np.abs(potential).max() + inner.max()))


def warning(balance: float, adaptive: bool = False) -> str:
    """Warning of a run with such a balance; nothing if it is within the limit.

    Parameters
    ----------
    adaptive : bool
        Whether a tolerance has chosen the steps.
    """
    if balance <= LIMIT:
        return ""
    reason = ("steps within the tolerance do not conserve energy; take a smaller tolerance, or a "
              "larger rho" if adaptive else "the step is too long, or numerical damping "
              "dissipates energy; take a smaller step, a larger rho, or simulate_within")
    return f"energy balance {balance:.2g} of the energy exchanged (limit {LIMIT:g}): {reason}"
