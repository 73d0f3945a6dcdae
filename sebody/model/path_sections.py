"""Sections of paths in space: triads of the undeformed path, transported without twist."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.parts import Path
from sebody.model.path_tables import curve, hermite_slopes

STEPS = 4           # of the transport between two knots
STEEP = 1e-3        # sine of the angle to a direction that a path nearly goes along


class Sections(NamedTuple):
    """Triads at the knots of one piece, columns in global axes at the start; the first a tangent.

    As cubic splines in the way along the piece, of the knots `ways` (K,).
    """

    ways: NDArray
    triads: NDArray     # (K, 3, 3)

    def rows(self, direction: NDArray) -> NDArray:
        """A direction that is given in the triads, and its slopes at the knots: (K, 2, 3)."""
        values = (self.triads @ direction)[:, None]
        return np.concatenate([values, hermite_slopes(self.ways, values)], axis=1)

    def at(self, way: float) -> NDArray:
        """The triad at a way along the piece, beyond its ends that of the end."""
        from scipy.interpolate import CubicHermiteSpline

        rows = self.triads.reshape(len(self.ways), 1, 9)
        of = CubicHermiteSpline(self.ways, rows[:, 0], hermite_slopes(self.ways, rows)[:, 0])
        found: NDArray = of(np.clip(way, 0.0, self.ways[-1])).reshape(3, 3)
        return found


def sections(path: Path) -> tuple[Sections, ...]:
    """Sections of all pieces; one after the other, each goes on where the one before ends."""
    found: list[Sections] = []
    at = normal = None
    for k, piece in enumerate(path.pieces):
        of, ways = curve(path, k), piece.ways
        near = np.unique(np.concatenate([np.linspace(*ends, STEPS + 1) for ends in pairwise(ways)]))
        slopes = of(near, 1)
        tangents, kept = slopes / np.linalg.norm(slopes, axis=1)[:, None], []
        for there in zip(of(near), tangents, strict=True):
            if at is None or normal is None:
                tangent = there[1]
                normal = np.cross(tangent, np.eye(3)[np.argmin(np.abs(tangent))])
            else:
                normal = _carried(normal, *at, *there)
            normal = normal - (normal @ there[1]) * there[1]
            normal, at = normal / np.sqrt(normal @ normal), there
            kept.append(normal)
        normals = np.array(kept)
        triads = np.stack([tangents, normals, np.cross(tangents, normals)], axis=2)
        found.append(Sections(ways, triads[::STEPS]))
    return tuple(found)


def upright(path: Path, up: NDArray) -> tuple[Sections, ...] | None:
    """Sections whose second direction is across the path, near a direction `up`, global axes.

    None where the path goes along it somewhere.
    """
    found = []
    for k, piece in enumerate(path.pieces):
        slopes = curve(path, k)(piece.ways, 1)
        tangents = slopes / np.linalg.norm(slopes, axis=1)[:, None]
        normals = up - (tangents @ up)[:, None] * tangents
        sizes = np.linalg.norm(normals, axis=1)[:, None]
        if sizes.min() < STEEP:
            return None
        normals = normals / sizes
        found.append(Sections(piece.ways, np.stack(
            [tangents, normals, np.cross(tangents, normals)], axis=2)))
    return tuple(found)


def _carried(normal: NDArray, x: NDArray, tangent: NDArray, there: NDArray, next_one: NDArray
             ) -> NDArray:
    """A normal at the next place on a curve, by two reflections: exact on circles.

    Wang, Juettler, Zheng and Liu, ACM Transactions on Graphics 27(1), 2008. Places of two pieces
    that meet are one; then the reflections turn one tangent into the other.
    """
    between = there - x
    if not between @ between > 0.0:
        between = tangent
    normal, tangent = _reflected(normal, between), _reflected(tangent, between)
    return _reflected(normal, next_one - tangent)


def _reflected(vector: NDArray, across: NDArray) -> NDArray:
    """A vector reflected in the plane normal to another one."""
    mirrored: NDArray = vector - (2.0 * (across @ vector) / (across @ across)) * across
    return mirrored
