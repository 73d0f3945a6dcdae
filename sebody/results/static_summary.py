"""Summary of an equilibrium: load steps, iterations, forces out of balance."""

import numpy as np
from numpy.typing import NDArray

from sebody.engine.clock import CONTROL
from sebody.engine.scalars import record
from sebody.results.recording import Recording


def is_static(recording: Recording) -> bool:
    """Tell if the states are those of an equilibrium: there are some beside the first, no steps."""
    return len(recording.rows) > 1 and int(record(CONTROL, recording.counters).steps) == 0


def static_residuals(recording: Recording) -> NDArray:
    """Largest residuals of the constraints, (n, 2), from the forces in every load step.

    Drives are where their share of the load puts them; rates are none.
    """
    equations = [at for one, first in recording.numbering.multipliers.items()
                 for at in range(first, first + one.multipliers)]
    largest = np.abs(recording.forces.sums[:, equations]).max(axis=1, initial=0.0)
    return np.stack([largest, np.zeros_like(largest)], axis=1)


def static_lines(recording: Recording) -> list[str]:
    """Lines of the summary, in place of those of a run."""
    numbering = recording.numbering
    moving = np.ones(numbering.free, dtype=bool)
    for one, first in numbering.multipliers.items():
        moving[first:first + one.multipliers] = False
    left = np.abs(recording.forces.sums[-1, :numbering.free][moving]).max(initial=0.0)
    acting = np.abs(recording.forces.elements[-1]).max(initial=0.0)
    lines = [
        f"unknowns             {numbering.free}",
        f"equilibrium          {len(recording.rows) - 1} load steps, to "
        f"{recording.recorded('t')[-1, 0]:.6g} of the load",
        f"iterations           {int(record(CONTROL, recording.counters).iterations)}",
        f"residual force       {left:.1e} on an unknown, where forces of elements reach "
        f"{acting:.3g}"]
    if numbering.multipliers:
        lines.append(f"constraints          largest residual "
                     f"{recording.constraint_residuals[-1, 0]:.1e}")
    return lines
