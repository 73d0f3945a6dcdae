"""How well a run keeps its energy: the one judgement of summaries, reports and warnings."""

import numpy as np
from numpy.typing import NDArray

LIMIT = 0.05            # share of the energy exchanged: speeds are off by half of it
ROUNDING = 1e-12        # of the energies, left by the sums of many numbers


def energy_balance(kinetic: NDArray, strain: NDArray, potential: NDArray, work: NDArray) -> float:
    """Largest drift of kinetic + strain + potential - work, relative to the energy exchanged.

    The energy exchanged is the largest of kinetic and strain energy together, less the strain
    energy that is always there, and of the ranges of potential and work. Of a model at rest the
    drift is rounding, and the balance zero.

    Parameters
    ----------
    kinetic, strain, potential, work : (n,)
    """
    inner = kinetic + strain
    total = inner + potential - work
    rounding = ROUNDING * (np.abs(potential).max() + inner.max())
    drift = max(np.abs(total - total[0]).max() - rounding, 0.0)
    exchanged = max(inner.max() - strain.min(), np.ptp(potential), np.ptp(work))
    return float(drift / max(exchanged, rounding, 1e-300))


def warning(balance: float, adaptive: bool = False) -> str:
    """What a run with such a balance warns of; nothing if it is within the limit.

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
