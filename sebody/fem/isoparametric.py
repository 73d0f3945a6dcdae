"""Shape functions of solid elements by meshio's names, and their points of integration.

The shape functions are the polynomials of a kind that are 1 at one node and 0 at the others; what
is known at the points of integration is carried to the nodes by the polynomials that it determines
(O.C. Zienkiewicz and R.L. Taylor, The Finite Element Method, vol. 1). The points of the quadratic
kinds are those of reduced integration, where stresses are of the highest order (J. Barlow, Int. J.
Numer. Meth. Engng 10, 1976).
"""

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Powers = tuple[tuple[int, int, int], ...]


class ElementKind(NamedTuple):
    """Tables of a kind of element with k nodes and g points of integration."""

    values: NDArray         # (g, k) shape functions at the points
    slopes: NDArray         # (g, 3, k) their derivatives by the element's coordinates
    to_nodes: NDArray       # (k, g) from values at the points to those at the nodes


_CUBE = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
                  (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)], dtype=float)
_TETRA = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
_PRISM = np.array([(0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
                  dtype=float)
_CUBE_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5),
               (2, 6), (3, 7)]
_TETRA_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
_PRISM_EDGES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)]
_CUBE_FACES = [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]

_CONSTANT: Powers = ((0, 0, 0),)
_LINEAR: Powers = (*_CONSTANT, (1, 0, 0), (0, 1, 0), (0, 0, 1))
_QUADRATIC: Powers = tuple(p for p in product(range(3), repeat=3) if sum(p) <= 2)
_TRILINEAR: Powers = tuple(product(range(2), repeat=3))
_TRIQUADRATIC: Powers = tuple(product(range(3), repeat=3))
# superlinear degree at most two: powers above one counted
_SERENDIPITY: Powers = tuple(p for p in _TRIQUADRATIC if sum(k for k in p if k > 1) <= 2)
_WEDGE: Powers = tuple((a, b, c) for a, b in ((0, 0), (1, 0), (0, 1)) for c in range(2))
_WEDGE_QUADRATIC: Powers = (*((a, b, c) for a, b in ((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2))
                              for c in range(2)), (0, 0, 2), (1, 0, 2), (0, 1, 2))

_NEAR, _FAR = (5 - np.sqrt(5)) / 20, (5 + 3 * np.sqrt(5)) / 20
_CUBE_POINTS = _CUBE / np.sqrt(3)
_TETRA_POINTS = np.full((4, 3), _NEAR) + (_FAR - _NEAR) * _TETRA
_PRISM_POINTS = np.array([(a, b, c / np.sqrt(3)) for c in (-1, 1) for a, b in (
    (1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3))])


def _middles(corners: NDArray, groups: list[tuple[int, ...]]) -> NDArray:
    return np.array([corners[list(group)].mean(axis=0) for group in groups])


# nodes, polynomials, points, polynomials that the points determine
_KINDS = {
    "tetra": (_TETRA, _LINEAR, np.full((1, 3), 0.25), _CONSTANT),
    "tetra10": (np.vstack([_TETRA, _middles(_TETRA, _TETRA_EDGES)]), _QUADRATIC, _TETRA_POINTS,
                _LINEAR),
    "hexahedron": (_CUBE, _TRILINEAR, _CUBE_POINTS, _TRILINEAR),
    "hexahedron20": (np.vstack([_CUBE, _middles(_CUBE, _CUBE_EDGES)]), _SERENDIPITY, _CUBE_POINTS,
                     _TRILINEAR),
    "hexahedron27": (np.vstack([_CUBE, _middles(_CUBE, _CUBE_EDGES), _middles(_CUBE, _CUBE_FACES),
                                np.zeros((1, 3))]), _TRIQUADRATIC, _CUBE_POINTS, _TRILINEAR),
    "wedge": (_PRISM, _WEDGE, _PRISM_POINTS, _WEDGE),
    "wedge15": (np.vstack([_PRISM, _middles(_PRISM, _PRISM_EDGES)]), _WEDGE_QUADRATIC,
                _PRISM_POINTS, _WEDGE),
}
SOLID_KINDS = tuple(_KINDS)


@cache
def element_kind(name: str) -> ElementKind:
    """The tables of one of `SOLID_KINDS`."""
    nodes, powers, points, carried = _KINDS[name]
    inverse = np.linalg.inv(_monomials(nodes, powers))
    values = _monomials(points, powers) @ inverse
    slopes = slopes_at(name, points)
    to_nodes = _monomials(nodes, carried) @ np.linalg.inv(_monomials(points, carried))
    return ElementKind(values, slopes, to_nodes)


def reference_nodes(name: str) -> NDArray:
    """Nodes of the reference element, (k, 3)."""
    return _KINDS[name][0]


def slopes_at(name: str, points: NDArray) -> NDArray:
    """Derivatives of the shape functions by the element's coordinates at points, (g, 3, k)."""
    nodes, powers, *_ = _KINDS[name]
    inverse = np.linalg.inv(_monomials(nodes, powers))
    return np.stack([_monomials(points, powers, axis) @ inverse for axis in range(3)], axis=1)


def _monomials(points: NDArray, powers: Powers, derived: int | None = None) -> NDArray:
    """Values of ``x^a y^b z^c`` at the points, (points, powers), or of a derivative."""
    columns = []
    for power in powers:
        factor, left = 1.0, list(power)
        if derived is not None:
            factor, left[derived] = float(power[derived]), max(power[derived] - 1, 0)
        columns.append(factor * np.prod(points**left, axis=1))
    return np.column_stack(columns)
