"""A straight cantilever whose bending and torsion are coupled, at rest (Kynema, BeamDyn)."""

from collections.abc import Mapping

import numpy as np

from sebody.fem import Axis, GeneralSection
from sebody.verify.outside.case import Case
from sebody.verify.outside.general_beams import ELEMENTS, LINE, Beam, by_axes, moved, quantities


def composite() -> Beam:
    """Axis, section, force and displacement."""
    K = np.diag([1368.17, 88.56, 38.78, 16.96, 59.12, 141.47]) * 1e3
    for i, j, value in ((3, 4, 17.61e3), (3, 5, -0.351e3), (4, 5, -0.37e3)):
        K[i, j] = K[j, i] = value
    M = np.diag([8.538e-2] * 3 + [1.4433e-2, 0.4097e-2, 1.0336e-2])
    return (Axis(LINE), GeneralSection(K, M), (0, 0, 150.0),
            (-0.0902726627566299, -0.0647488486259036, 1.22973648292371))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return by_axes(moved(composite(), ELEMENTS * division))


CASE = Case(
    "Composite beam with a 6 x 6 section", "Kynema, regression_tests/regression/"
    "verification/static_composite_beam_bending.cpp (15 nodes; BeamDyn to 1e-14)", measure,
    quantities(composite()[3]), "32 nonlinear elements")
