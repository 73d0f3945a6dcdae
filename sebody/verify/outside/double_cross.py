"""Pin-ended double cross in its plane (NAFEMS FV2): repeated and close frequencies."""

from collections.abc import Mapping

import numpy as np

from sebody import Model
from sebody.analysis import vibrations
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

ARM, SIDE, E, DENSITY = 5.0, 0.125, 200e9, 8000.0
STIFF = 1e4             # times: arms that do not stretch, as in the closed form
BENDING = E * SIDE**4 / 12
SECTION = StiffnessSection(STIFF * E * SIDE**2, BENDING, BENDING, BENDING, DENSITY * SIDE**2, 1.0,
                           0.0, 0.0)
FREQUENCIES = {(0,): 11.336, (1, 2): 17.709, (3, 7): 17.709, (8,): 45.345, (9, 10): 57.390,
               (11, 15): 57.390}


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model(planar=True)
    hub = model.node("hub", (0.0, 0.0))
    for k in range(8):
        end = model.node(f"end {k}", (ARM * np.cos(k * np.pi / 4), ARM * np.sin(k * np.pi / 4)))
        model.fix(end, "position")
        model.beam(f"arm {k}", (hub, end), SECTION, 16 * division, division, 6)
    found = vibrations(model, 16).frequency
    return {name(places): found[list(places)].mean() for places in FREQUENCIES}


def name(places: tuple[int, ...]) -> str:
    """Name of one mode or several equal ones."""
    return f"mode{'s' * (len(places) > 1)} {' to '.join(str(k + 1) for k in places)} [Hz]"


CASE = Case(
    "Pin-ended double cross", "NAFEMS FV2 (closed form); Altair OptiStruct, OS-V 0400", measure,
    tuple(Quantity(name(places), value, printed=5e-4, source_tolerance=1e-2, group="all")
          for places, value in FREQUENCIES.items()),
    "beams of Euler and Bernoulli, one superelement for each arm, which cannot stretch in "
    "the closed form: with the true stiffness modes 2 and 3 are 17.681, modes 10 and 11 57.08 Hz")
