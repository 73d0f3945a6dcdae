"""Reference axes of beams that curve, and the sections' axes that twist about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

if TYPE_CHECKING:
    from scipy.interpolate import PPoly  # which takes a while to import

DEGREES = (16, 32, 64, 128, 256, 512)   # of the polynomials tried for a function of the user
SMOOTH = 1e-12          # of its size: what the last coefficients of such a polynomial may have
RULE = np.polynomial.legendre.leggauss(16)
VERTICAL = 1e-6         # sine of the angle to z of a straight line that is vertical
STEEP = 0.1             # the same of a place of a curved line
NEWTON = 30


class _Piece(NamedTuple):
    """A smooth part of the axis, by a parameter u, and its length up to knots of u."""

    position: Callable[[NDArray], NDArray]      # (n,) -> (n, 3)
    derivative: Callable[[NDArray], NDArray]
    knots: NDArray      # (k,)
    lengths: NDArray    # (k,)


class Axis:
    """Curve through space with the axes of sections along it; places are parts of its length.

    The sections' x axis is the tangent. Their y axis is `up` or their z axis `side` as far as it
    can be, turned by `twist` about the tangent.

    Parameters
    ----------
    curve : (n, 3), function or scipy.interpolate.PPoly
        Points from end to end: two make a straight line, three a parabola, more a cubic spline,
        whose parameter is the length of the chords. Or a function of one number from 0 to 1 that
        gives a point (3,), smooth but for kinks. Or a spline of three components [length].
    twist : float, (n,), (m, 2) or function
        Angle about the tangent, positive from y to z: one; one at each point of the curve or knot
        of the spline; rows of places and angles; these linear between the places. Or a smooth
        function of the place [rad].
    up, side : (3,), optional
        Direction of the sections' y axis, or of their z axis, without twist. By default `side` is
        z, of axes that are steep somewhere `up` is y.
    kinks : sequence
        Numbers of points or knots, or arguments of the function, where the direction jumps.

    Raises
    ------
    InputError
        No curve, one with a kink that is not named, a twist that is none, `up` or `side` along
        the curve somewhere.

    Examples
    --------
    >>> Axis([[0, 0, 0], [10, 0, 0]], twist=[[0, 0], [1, np.pi / 2]])
    >>> Axis(lambda s: [np.cos(20 * s), np.sin(20 * s), 0.3 * s])
    """

    def __init__(self, curve: ArrayLike | Callable[[float], ArrayLike] | PPoly,
                 twist: float | ArrayLike | Callable[[float], float] = 0.0,
                 up: ArrayLike | None = None, side: ArrayLike | None = None,
                 kinks: Sequence[float] = ()):
        spline = _is_spline(curve)
        self._pieces = (_of_spline(curve, kinks) if spline else
                        _of_function(curve, kinks) if callable(curve) else
                        _of_points(curve, kinks))
        ends = np.cumsum([0.0, *(piece.lengths[-1] for piece in self._pieces)])
        self.length = float(ends[-1])
        self._ends = ends / self.length
        self._ends[-1] = 1.0
        given = None
        if spline or not callable(curve):
            given = np.unique(np.concatenate([
                start + piece.lengths / self.length
                for start, piece in zip(self._ends, self._pieces, strict=False)]).clip(0, 1))
            given = given[np.diff(given, prepend=-1.0) > 1e-12]
            given[-1] = 1.0
        self._twist, twisted = _twist(twist, given)
        self.kinks = np.unique([*self._ends[1:-1], *twisted])
        self._reference, self._across = self._chosen(up, side)

    def __repr__(self) -> str:
        first, last = (", ".join(f"{x:.6g}" for x in point) for point in self.position([0.0, 1.0]))
        return f"<Axis from ({first}) to ({last}), length {self.length:.6g}>"

    def position(self, places: ArrayLike) -> NDArray:
        """Points (..., 3) at places (...)."""
        return self._by_piece(places, lambda piece, u: piece.position(u))

    def tangent(self, places: ArrayLike) -> NDArray:
        """Unit tangents (..., 3) at places (...)."""
        return self._by_piece(places, lambda piece, u: _unit(piece.derivative(u)))

    def axes(self, places: ArrayLike) -> NDArray:
        """Matrices (..., 3, 3) whose columns are the sections' axes at places (...)."""
        x = self.tangent(places)
        angle = self._twist(np.asarray(places, dtype=float))[..., None]
        level = _unit(np.cross(self._reference, x) if self._across else
                      self._reference - (x @ self._reference)[..., None] * x)
        other = np.cross(x, level)
        y = np.cos(angle) * level + np.sin(angle) * other
        return np.stack([x, y, np.cross(x, y)], axis=-1)

    def _by_piece(self, places: ArrayLike, value: Callable) -> NDArray:
        places = np.asarray(places, dtype=float)
        flat = places.ravel()
        own = np.clip(np.searchsorted(self._ends, flat, side="right") - 1, 0, len(self._pieces) - 1)
        found = np.zeros((len(flat), 3))
        for k in np.unique(own):
            here = own == k
            piece = self._pieces[k]
            found[here] = value(piece, _parameter(piece, (flat[here] - self._ends[k])
                                                  * self.length))
        return found.reshape(*places.shape, 3)

    def _chosen(self, up: ArrayLike | None, side: ArrayLike | None) -> tuple[NDArray, bool]:
        """Reference direction, and whether it is that of the z axis."""
        if up is not None and side is not None:
            raise InputError("Axis: up and side are given: leave one out")
        places = np.linspace(0, 1, 201)
        x = self.tangent(np.concatenate([places, self.kinks, np.maximum(self.kinks - 1e-9, 0)]))
        if up is None and side is None:
            steepest = np.linalg.norm(x[:, :2], axis=1).min()
            straight = np.abs(x - x[0]).max() < 1e-12
            if steepest >= (VERTICAL if straight else STEEP):
                return np.array([0.0, 0, 1]), True
            up = np.array([0.0, 1.0, 0.0])
        name, given = ("side", side) if up is None else ("up", up)
        assert given is not None
        vector = inputs.vector(given, f"Axis: {name}", 3)
        vector = vector / max(np.linalg.norm(vector), np.finfo(float).tiny)
        along = np.linalg.norm(np.cross(vector, x), axis=1)
        if along.min() <= 1e-6:
            at = [*places, *self.kinks, *self.kinks][int(along.argmin())]
            raise InputError(f"Axis: {name} = {np.round(vector, 6).tolist()} lies along the axis "
                             f"at {at:.3g} of its length: give up=, another direction of the "
                             "sections' y axis")
        return vector, name == "side"


def _unit(vectors: NDArray) -> NDArray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _parameter(piece: _Piece, lengths: NDArray) -> NDArray:
    """Parameters at some lengths from the beginning of a piece, by Newton's iteration."""
    k = np.clip(np.searchsorted(piece.lengths, lengths, side="right") - 1, 0,
                len(piece.knots) - 2)
    first, last = piece.knots[k], piece.knots[k + 1]
    wanted = lengths - piece.lengths[k]
    u = first + (last - first) * wanted / (piece.lengths[k + 1] - piece.lengths[k])
    for _ in range(NEWTON):
        off = _length(piece.derivative, first, u) - wanted
        step = off / np.linalg.norm(piece.derivative(u), axis=1)
        u = u - step
        if (np.abs(step) <= 1e-9 * np.abs(last - first)).all():     # the next one is its square
            break
    return np.clip(u, piece.knots[0], piece.knots[-1])


def _length(derivative: Callable, first: NDArray, last: NDArray) -> NDArray:
    """Length of the curve between parameters (n,)."""
    x, w = RULE
    half = (last - first) / 2
    points = (first + last)[:, None] / 2 + half[:, None] * x
    speed = np.linalg.norm(derivative(points.ravel()), axis=1).reshape(points.shape)
    return half * (speed @ w)


def _piece(position: Callable, derivative: Callable, knots: NDArray) -> _Piece:
    lengths = np.cumsum([0.0, *_length(derivative, knots[:-1], knots[1:])])
    if (np.diff(lengths) <= 1e-12 * max(lengths[-1], np.finfo(float).tiny)).any():
        raise InputError("Axis: the curve stands still somewhere: give one that goes on, points "
                         "that differ")
    return _Piece(position, derivative, knots, lengths)


def _of_points(curve: ArrayLike, kinks: Sequence[float]) -> list[_Piece]:
    points = inputs.array(curve, "Axis: curve", (None, 3),
                          remedy="give points (n, 3), or a function that returns one")
    if len(points) < 2:
        raise InputError(f"Axis: curve has {len(points)} points: give two at least")
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if (chords <= 1e-12 * chords.sum()).any():
        raise InputError(f"Axis: points {int(chords.argmin())} and {int(chords.argmin()) + 1} of "
                         "the curve are the same: leave one out")
    u = np.cumsum([0.0, *chords])
    from scipy.interpolate import CubicSpline

    made = []
    for a, b in pairwise([0, *_corners(kinks, len(points)), len(points) - 1]):
        part = slice(a, b + 1)
        if b - a == 1:
            made.append(_line(points[a], points[b], u[part]))
        else:
            spline = CubicSpline(u[part], points[part])
            made.append(_piece(spline, spline.derivative(), u[part]))
    return made


def _corners(kinks: Sequence[float], count: int) -> list[int]:
    """Numbers of points, or of knots, at which the direction jumps."""
    remedy = f"give numbers of points between the ends, 1 to {count - 2}"
    return sorted({inputs.integer(one, "Axis: a kink", least=1, most=count - 2, remedy=remedy)
                   for one in inputs.items(kinks, "Axis: kinks", remedy)})


def _is_spline(curve: Any) -> bool:
    if not callable(curve):
        return False
    from scipy.interpolate import PPoly

    return isinstance(curve, PPoly)


def _of_spline(curve: PPoly, kinks: Sequence[float]) -> list[_Piece]:
    if curve.c.shape[2:] != (3,) or not np.isfinite(curve.c).all():
        raise InputError(f"Axis: curve is a spline of {curve.c.shape[2:]} components: give one of "
                         "three, x, y and z, all finite")
    from scipy.interpolate import PPoly

    slope = curve.derivative()
    made = []
    for a, b in pairwise([0, *_corners(kinks, len(curve.x)), len(curve.x) - 1]):
        if b - a == len(curve.x) - 1:
            made.append(_piece(curve, slope, curve.x))
        else:       # by themselves: at its end a piece has its own direction
            own, its = (PPoly(one.c[:, a:b], one.x[a:b + 1]) for one in (curve, slope))
            made.append(_piece(own, its, own.x))
    return made


def _line(first: NDArray, last: NDArray, ends: NDArray) -> _Piece:
    way = last - first
    return _piece(lambda u: first + np.multiply.outer((u - ends[0]) / (ends[1] - ends[0]), way),
                  lambda u: np.broadcast_to(way / (ends[1] - ends[0]), (len(u), 3)), ends)


def _of_function(curve: Callable, kinks: Sequence[float]) -> list[_Piece]:
    remedy = "give numbers between 0 and 1, arguments of the function"
    corners = [inputs.number(one, "Axis: a kink", above=0, most=1, remedy=remedy)
               for one in inputs.items(kinks, "Axis: kinks", remedy)]

    def at(u: float) -> NDArray:
        return inputs.vector(_called(curve, u), f"Axis: curve({u:.6g})", 3)
    return [_interpolated(at, a, b)
            for a, b in pairwise(sorted({0.0, 1.0, *corners}))]


def _interpolated(curve: Callable[[float], NDArray], first: float, last: float) -> _Piece:
    """A polynomial in the place of a smooth function."""
    for degree in DEGREES:
        nodes = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
        arguments = (first + last) / 2 + (last - first) / 2 * nodes
        values = np.array([curve(float(u)) for u in arguments])
        coefficients = np.linalg.solve(chebyshev.chebvander(nodes, degree), values)
        size = max(np.ptp(values, axis=0).max(), np.finfo(float).tiny)
        tail = np.abs(coefficients[-max(degree // 8, 2):]).max()
        if tail <= SMOOTH * max(size, 1e-3 * np.abs(values).max()):
            return _of_coefficients(coefficients, first, last)
    raise InputError(f"Axis: curve is not smooth between {first:g} and {last:g} (a polynomial of "
                     f"degree {degree} is off by {tail / size:.2g} of its size): name its corners "
                     "in kinks=, or give points")


def _of_coefficients(coefficients: NDArray, first: float, last: float) -> _Piece:
    """The polynomial with these coefficients of Chebyshev's between two parameters."""
    slopes = chebyshev.chebder(coefficients) * 2 / (last - first)

    def local(u: NDArray) -> NDArray:
        return (2 * u - first - last) / (last - first)
    return _piece(lambda u: chebyshev.chebval(local(u), coefficients).T,
                  lambda u: chebyshev.chebval(local(u), slopes).T,
                  np.linspace(first, last, max(len(coefficients) // 8, 2) + 1))


def _twist(twist: Any, given: NDArray | None) -> tuple[Callable[[NDArray], NDArray], NDArray]:
    """Angles at places, and where they are not smooth; `given` are the places of points."""
    if callable(twist):
        def of_function(places: NDArray) -> NDArray:
            angles = [inputs.number(_called(twist, place), f"Axis: twist({place:.6g})")
                      for place in places.ravel().tolist()]
            return np.array(angles, dtype=float).reshape(places.shape)
        of_function(np.array([0.0, 1.0]))       # refuses what is no angle
        return of_function, np.zeros(0)
    if np.ndim(twist) == 0:
        angle = inputs.number(twist, "Axis: twist", remedy=_TWIST)
        return lambda places: np.full(places.shape, angle), np.zeros(0)
    if np.ndim(twist) == 1 and given is not None:
        angles = inputs.vector(twist, "Axis: twist", len(given), remedy=(
            f"give {len(given)} angles, one for each point of the curve; " + _TWIST))
        twist = np.column_stack([given, angles])
    table = inputs.array(twist, "Axis: twist", (None, 2), remedy=_TWIST)
    places, angles = table.T
    if len(table) < 2 or places[0] != 0 or places[-1] != 1 or (np.diff(places) <= 0).any():
        raise inputs.refusal("Axis: places of the twist", places.tolist(),
                             "give at least two, ascending from 0 to 1")
    if np.abs(np.diff(angles)).max() > np.pi:
        raise InputError(f"Axis: twist changes by {np.abs(np.diff(angles)).max():.3g} rad between "
                         "two places: give angles in radians, and places between for more than "
                         "half a turn")
    return lambda at: np.interp(at, places, angles), places[1:-1]


_TWIST = ("give an angle in radians, rows of places and angles, or a function of the place from 0 "
          "to 1")


def _called(function: Callable, argument: float) -> Any:
    try:
        return function(argument)
    except (TypeError, ValueError, ArithmeticError, LookupError, AttributeError) as error:
        raise InputError(f"Axis: a function raised {type(error).__name__} at {argument:.6g}: "
                         f"{error}; correct it") from error
