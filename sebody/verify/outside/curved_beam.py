"""A cantilever along a parabola, bent out of its plane (Kynema)."""

from collections.abc import Mapping

import numpy as np

from sebody.fem import Axis, GeneralSection
from sebody.verify.outside.case import Case
from sebody.verify.outside.general_beams import ELEMENTS, Beam, by_axes, moved, quantities


def curved() -> Beam:
    """Axis, section, force and displacement."""
    x, y = np.array([38.2683, 70.7107]), np.array([-7.61205, -29.2893])
    slope, bend = np.linalg.solve(np.column_stack([x, x**2]), y)
    K = np.diag([1e7, 41.6667e5, 41.6667e5, 8.333e5, 8.333e5, 8.333e5])
    return (Axis(lambda s: [x[1] * s, (slope + bend * x[1] * s) * x[1] * s, 0.0]),
            GeneralSection(K, np.eye(6)), (0, 0, 600.0),
            (-23.6459716009047, 13.7208006040058, 53.5776450626987))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return by_axes(moved(curved(), ELEMENTS * division))


CASE = Case(
    "Curved beam", "Kynema, .../static_curved_composite_beam_bending.cpp (12 nodes)", measure,
    quantities(curved()[3]),
    "its axis is a parabola through three points; the arc of 45 degrees moves 2.9e-3 less")
