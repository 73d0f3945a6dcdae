"""The composite cantilever from rest under a sudden force (Kynema, BeamDyn)."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sebody import Model, generalized_alpha, simulate
from sebody.verify.outside.case import Case, Quantity
from sebody.verify.outside.composite_beam import composite

STEP, END, ELEMENTS = 0.005, 1.0, 16
# u3 of BeamDyn, 5 nodes, h 0.005, rho 0, every 0.05 s
BEAMDYN = np.array([
    0.76836577, 2.0534850, 2.2052969, 1.1064713, 0.15758876, 0.55309539, 1.8159070, 2.2654943,
    1.3113535, 0.27880849, 0.44070038, 1.5982498, 2.2970329, 1.5343329, 0.34515991, 0.27817189,
    1.3946589, 2.2886914, 1.8093410, 0.54135602])
OFF = 0.04              # of the largest value: what the step of the source leaves
SHOWN = {0.1: 1, 0.15: 2, 0.4: 7, 0.65: 12, 1.0: 19}        # s, and rows of the series


def stepped(elements: int, bodies: int | None = None, modes: int = 0, h: float = STEP,
            rho: float = 0.0) -> NDArray:
    """u3 of the tip every 0.05 s."""
    axis, section, force = composite()[:3]
    model = Model()
    ends = model.node("root", axis.position(0.0)), model.node("tip", axis.position(1.0))
    model.beam("beam", ends, section, elements, bodies, modes, axis=axis)
    model.fix(ends[0])
    model.force(ends[1], force)
    result = simulate(model, h, END, scheme=generalized_alpha(rho))
    return np.interp(0.05 * np.arange(1, 21), result.t, result["tip.position"][:, 2])


def rms(a: NDArray, b: NDArray) -> float:
    """Root of the mean square of a difference, by the largest of BeamDyn's values."""
    return float(np.sqrt(np.mean((a - b)**2)) / BEAMDYN.max())


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    u = stepped(ELEMENTS * division)
    return {"rms difference of the series": rms(u, BEAMDYN)} | {
        f"uz of the tip at {t:g} s": u[row] for t, row in SHOWN.items()}


CASE = Case(
    "Composite beam from rest", "Kynema, .../dynamic_composite_beam_bending.cpp and "
    "dynamic_beam_5nodes_0pt005s_beamdyn.csv", measure,
    (Quantity("rms difference of the series", 0.0, 1.0, source_tolerance=0.2),
     *(Quantity(f"uz of the tip at {t:g} s", BEAMDYN[row], float(BEAMDYN.max()),
                printed=OFF * float(BEAMDYN.max()),
                source_tolerance=0.2) for t, row in SHOWN.items())),
    "the source's step and numerical damping, which alone are off by 4 %; Kynema accepts 20 %")
