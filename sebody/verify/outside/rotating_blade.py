"""Flapping of a uniform blade by its speed (Wright, Smith, Thresher and Wang; Bir)."""

from collections.abc import Mapping

import numpy as np

from sebody import Model
from sebody.analysis import equilibrium, modes
from sebody.fem import StiffnessSection
from sebody.verify.outside.case import Case, Quantity

LENGTH, MASS, FLAP, LAG = 31.623, 100.0, 1e8, 1e9
AXIAL = 1e10            # N: stiff, as the source's blade does not stretch
SECTION = StiffnessSection(AXIAL, FLAP, LAG, 1e5, MASS, 1.0, 0.0, 0.0)
ROWS = {0: 3.516, 2: 4.137, 4: 5.585, 6: 7.360, 8: 9.257, 10: 11.202, 12: 13.170}


def found(speed: float, bodies: int) -> float:
    """First frequency of flapping, along the axis of rotation."""
    model = Model()
    root, tip = model.node("root", (0.0, 0.0, 0.0)), model.node("tip", (LENGTH, 0.0, 0.0))
    model.beam("blade", (root, tip), SECTION, 32, bodies, 8)
    model.fix(root)
    if not speed:
        return float(np.abs(modes(model).values[0].imag))
    spin = (0.0, 0.0, speed)
    motion = modes(equilibrium(model, 4, spin=spin), spin)
    values = np.abs(motion.values.imag)
    wanted = ROWS[int(speed)]       # torsion and lag may be lower
    return float(values[np.argmin(np.abs(values - wanted))])


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return {f"flap at {speed} rad/s": found(float(speed), 2 * division) for speed in ROWS}


CASE = Case(
    "Rotating blade", "A. D. Wright, C. E. Smith, R. W. Thresher and J. L. C. Wang 1982, as in G. "
    "S. Bir 2009, AIAA 2009-1035, table 3a", measure,
    tuple(Quantity(f"flap at {speed} rad/s", value, printed=5e-4, source_tolerance=1e-2)
          for speed, value in ROWS.items()),
    "two superelements; the section's axial stiffness, which the source does not need, is 1e10 N")
