"""An arc of 45 degrees, whose curvature couples tension and bending, as five superelements."""

from collections.abc import Mapping

import numpy as np

from sebody.fem import Axis, GeneralSection
from sebody.verify.outside.case import Case
from sebody.verify.outside.general_beams import Beam, by_axes, moved, quantities

BODIES, ELEMENTS, MODES = 5, 8, 12          # those of the source; elements of a body


def curved_of_chrono() -> Beam:
    """Axis, section, force and displacement."""
    K = np.diag([1e7, 41.6667e5, 41.6667e5, 7.03e5, 8.333333e5, 8.333333e5])
    K[0, 5] = K[5, 0] = -8.333333e3
    return (Axis(lambda s: [100 * np.sin(np.pi / 4 * s), 100 * (np.cos(np.pi / 4 * s) - 1), 0.0]),
            GeneralSection(K, np.eye(6)), (0, 0, 600.0), (-23.821, 13.732, 53.610))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    bodies = BODIES * division
    return by_axes(moved(curved_of_chrono(), ELEMENTS * bodies, bodies, MODES, divide="rotation"))


CASE = Case(
    "Curved beam as five superelements", "Chrono, src/tests/unit_tests/modal/"
    "utest_MOD_curved_beam.cpp (V. Sonneville 2021, 16 elements)", measure,
    quantities(curved_of_chrono()[3], printed=5e-4, source_tolerance=5e-2),
    "five bodies of eight elements and twelve modes, as in Chrono, which accepts 5 %")
