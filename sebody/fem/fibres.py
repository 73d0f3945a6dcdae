"""Fibres of the ready cross-sections that are stressed most, and by what.

Shear stresses of shear forces are those of elementary theory, ``Q S / (I b)``; those of torques are
those of S.P. Timoshenko and J.N. Goodier (Theory of Elasticity, 3rd ed., 1970, chapter 10).
"""

from dataclasses import replace

import numpy as np

from sebody.fem.section import Section

_TERMS = np.arange(1, 1000, 2)


def of_rectangle(section: Section, height: float, width: float) -> Section:
    """Corners, middles of the sides and centre of a rectangle."""
    y, z, across = height / 2, width / 2, 1.5 / section.area
    long, short = max(height, width), min(height, width)
    ratio = np.pi * long / (2 * short)
    with np.errstate(over="ignore"):
        near = 1 - 8 / np.pi**2 * np.sum(1 / (_TERMS**2 * np.cosh(_TERMS * ratio)))
    signs = (-1.0)**((_TERMS - 1) // 2)
    far = 8 / np.pi**2 * np.sum(signs * np.tanh(_TERMS * ratio) / _TERMS**2)
    # on the middle of the long sides, which are near to each other, and of the short ones
    on_long, on_short = near * short / section.torsion, far * short / section.torsion
    at_y, at_z = (on_short, on_long) if height >= width else (on_long, on_short)
    places = [(a * y, b * z, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
              for a in (-1, 1) for b in (-1, 1)]
    places += [(a * y, 0.0, (0.0, 0.0, 0.0), (0.0, across, a * at_y)) for a in (-1, 1)]
    places += [(0.0, b * z, (across, 0.0, -b * at_z), (0.0, 0.0, 0.0)) for b in (-1, 1)]
    places.append((0.0, 0.0, (across, 0.0, 0.0), (0.0, across, 0.0)))
    return replace(section, fibres=tuple(section.fibre(*place) for place in places))


def of_tube(section: Section, radius: float, inner: float) -> Section:
    """Eight places on the outer circumference.

    With the shear stress tangential there, ``xy = k (z / R)^2 Qy`` where ``k = (R^2 + R r + r^2) /
    3 I``: exact for the thin and the solid section.
    """
    k = (radius**2 + radius * inner + inner**2) / (3 * section.inertia_y)
    fibres = []
    for angle in np.arange(8) * np.pi / 4:
        c, s = np.cos(angle), np.sin(angle)
        y, z = radius * c, radius * s
        fibres.append(section.fibre(
            y, z, (k * s * s, -k * c * s, -z / section.torsion),
            (-k * c * s, k * c * c, y / section.torsion)))
    return replace(section, fibres=tuple(fibres))


def of_i_profile(section: Section, height: float, width: float, web: float,
                 flange: float) -> Section:
    """Tips and middles of the flanges, ends and middle of the web, on both its sides."""
    y, inner, z = height / 2, height / 2 - flange, width / 2
    in_flanges, twist = 1.5 / (2 * width * flange), 1 / section.torsion
    at_end = width * flange * (height - flange) / 2 / (section.inertia_z * web)
    at_middle = at_end + inner**2 / 2 / section.inertia_z
    none = (0.0, 0.0, 0.0)
    places = [(a * y, b * z, none, none) for a in (-1, 1) for b in (-1, 1)]
    places += [(a * y, 0.0, none, (0.0, in_flanges, a * flange * twist)) for a in (-1, 1)]
    places += [(a * inner, b * web / 2, (at_middle if a == 0 else at_end, 0.0, -b * web * twist),
                none) for a in (-1, 0, 1) for b in (-1, 1)]
    return replace(section, fibres=tuple(section.fibre(*place) for place in places))
