"""Judgement of the reference for a tolerance, and remedies where it is not good enough."""

from collections.abc import Mapping

from sebody.basics.errors import InputError, SimulationError
from sebody.explore.advice.reference import Reference
from sebody.explore.advice.runs import Run

SHORTER = (8, 16, 32, 64)     # parts of the given step, where the tolerance needs them
EARLY = 3               # steps of the grid, that errors are those of the start in
LARGEST = 0.95          # relative tolerance
MARGIN = 1.2            # of a tolerance that would pass
SHARE = 0.5             # of the tolerance, that the reference must be good to


def judge(reference: Reference, tolerance: float, grid: float, bases: Mapping[float, Run]) -> None:
    """Refuse a tolerance that the reference is not good for.

    Parameters
    ----------
    reference : Reference
    tolerance : float
    grid : float
        Step of its grid.
    bases : mapping of float to Run
        Runs of the reference model by their steps.

    Raises
    ------
    InputError
        Shorter steps may help, or another start.
    SimulationError
        The error does not fall with the step.
    """
    if reference.error <= SHARE * tolerance:
        return
    worst, fine = reference.worst, min(bases)
    first = worst.row is not None and worst.row < EARLY
    where = "" if worst.row is None else f" at t = {worst.row * grid:.4g}"
    told = (f"{worst.quantity} is known to {reference.error:.2g} of its change only, worst"
            f"{where}, even with the step {fine:.3g}")
    passing = reference.error / SHARE * MARGIN
    enough = (f"a tolerance of {passing:.1g} would pass: half of it is left for the reference"
              if passing < LARGEST else "no tolerance below 1 would pass")
    if first:
        raise InputError(
            f"{told}: the model is loaded suddenly at the start, which excites its "
            "fastest vibrations; start from the equilibrium (start='equilibrium'), let loads grow "
            f"from zero, or measure {worst.quantity} by rms or below a frequency; {enough}")
    if not reference.falls:
        raise SimulationError(
            f"{told}, and shorter steps do not change that: the motion depends on the step, as "
            "chaotic motions, impacts, and undamped vibrations do; give an "
            f"earlier end, damping, or measure {worst.quantity} by rms, peak or below a "
            f"frequency; {enough}", bases[fine].result)
    raise InputError(f"{told}: shorter steps that are tried, down to {grid / SHORTER[-1]:.3g}, are "
                     f"not enough; {enough}")
