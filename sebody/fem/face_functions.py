"""Shape functions of faces, and in a plane of edges, by meshio's names; points of integration."""

import numpy as np
from numpy.typing import NDArray


def face_rule(kind: str) -> tuple[NDArray, NDArray, NDArray]:
    """Functions (g, k), their slopes (g, k, c) and weights (g,) at the points of a kind of face.

    Exact for products of two functions on flat faces with straight edges.
    """
    points, weights = _points(kind)
    return *face_functions(kind, points), weights


def face_functions(kind: str, points: NDArray) -> tuple[NDArray, NDArray]:
    """Functions (g, k) and their slopes (g, k, c) at points (g, c) of a kind of face.

    Coordinates are those of the unit triangle, elsewhere from -1 to 1.
    """
    if kind.startswith("triangle"):
        s, t = points.T
        area = np.stack([1 - s - t, s, t], axis=1)
        change = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
        if kind == "triangle":
            return area, np.broadcast_to(change, (len(s), 3, 2))
        first, second = [0, 1, 2], [1, 2, 0]
        values = np.hstack([area * (2 * area - 1), 4 * area[:, first] * area[:, second]])
        slopes = np.concatenate([
            (4 * area - 1)[:, :, None] * change,
            4 * (area[:, first, None] * change[second] + area[:, second, None] * change[first])],
            axis=1)
        return values, slopes
    if kind.startswith("line"):
        s = points[:, 0]
        if kind == "line":
            return (np.stack([1 - s, 1 + s], axis=1) / 2,
                    np.broadcast_to([[-0.5], [0.5]], (len(s), 2, 1)))
        values = np.stack([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s**2], axis=1)
        return values, np.stack([s - 0.5, s + 0.5, -2 * s], axis=1)[:, :, None]
    if kind == "quad9":
        return _biquadratic(points)
    return _quad(points, kind == "quad8")


def _biquadratic(points: NDArray) -> tuple[NDArray, NDArray]:
    """Products of the functions of two lines of three nodes: corners, middles of edges, middle."""
    (u, du), (v, dv) = (face_functions("line3", points[:, [axis]]) for axis in (0, 1))
    along, across = [0, 1, 1, 0, 2, 1, 2, 0, 2], [0, 0, 1, 1, 0, 2, 1, 2, 2]
    return u[:, along] * v[:, across], np.stack(
        [du[:, along, 0] * v[:, across], u[:, along] * dv[:, across, 0]], axis=2)


def _points(kind: str) -> tuple[NDArray, NDArray]:
    """Points and weights of integration."""
    line, weight = np.polynomial.legendre.leggauss(3)
    if kind.startswith("line"):
        return line[:, None], weight
    if kind.startswith("quad"):
        return (np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2),
                np.outer(weight, weight).ravel())
    # six points of degree 4: D.A. Dunavant, Int. J. Numer. Meth. Engng 21, 1985
    parts = [(0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322)]
    points = [p for a, _ in parts for p in ((a, a), (1 - 2 * a, a), (a, 1 - 2 * a))]
    return np.array(points), np.repeat([w for _, w in parts], 3) / 2


def _quad(points: NDArray, quadratic: bool) -> tuple[NDArray, NDArray]:
    """Bilinear functions of four nodes or those of eight (serendipity)."""
    s, t = points[:, :1], points[:, 1:]
    a, b = np.array([-1.0, 1, 1, -1]), np.array([-1.0, -1, 1, 1])
    along, across = 1 + a * s, 1 + b * t
    if not quadratic:
        return along * across / 4, np.stack([a * across, b * along], axis=2) / 4
    values = along * across * (a * s + b * t - 1) / 4
    slopes = np.stack([a * across * (2 * a * s + b * t), b * along * (a * s + 2 * b * t)],
                      axis=2) / 4
    c, d = np.array([0.0, 1, 0, -1]), np.array([-1.0, 0, 1, 0])     # middles of the edges
    level = c == 0
    middle = np.where(level, (1 - s**2) * (1 + d * t), (1 + c * s) * (1 - t**2)) / 2
    ds = np.where(level, -2 * s * (1 + d * t), c * (1 - t**2)) / 2
    dt = np.where(level, d * (1 - s**2), -2 * t * (1 + c * s)) / 2
    return np.hstack([values, middle]), np.concatenate([slopes, np.stack([ds, dt], axis=2)], axis=1)
