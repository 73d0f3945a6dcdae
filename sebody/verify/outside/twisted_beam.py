"""A flat section that turns by 90 degrees along a straight cantilever (Kynema, BeamDyn)."""

from collections.abc import Mapping

import numpy as np

from sebody.fem import Axis, GeneralSection
from sebody.verify.outside.case import Case
from sebody.verify.outside.general_beams import ELEMENTS, LINE, Beam, by_axes, moved, quantities


def twisted() -> Beam:
    """Axis, section, force and displacement."""
    K = np.diag([2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8])
    return (Axis(LINE, twist=[[0, 0], [1, np.pi / 2]]), GeneralSection(K, np.eye(6)),
            (0, 0, -4e6), (-1.14152599953942, -1.71805334646388, -3.59321324026952))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return by_axes(moved(twisted(), ELEMENTS * division))


CASE = Case(
    "Beam twisted by 90 degrees", "Kynema, .../static_twisted_composite_beam_bending.cpp; "
    "OpenFAST r-test, modules/beamdyn/bd_static_twisted_with_k1", measure,
    quantities(twisted()[3]),
    "r-test's page has solids of ANSYS, too: -1.134192, -1.714467, -3.58423, the first of "
    "which it prints twice")
