"""Histories of loads and motions of drives: pieces of formulas, or functions of a user.

A history of pieces is on each of its intervals a polynomial of degree five at most plus a harmonic:
see `History`. Loads need the value alone, drives its first two derivatives, too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from math import cos, sin
from numbers import Number

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from sebody import inputs
from sebody.compiler.user_functions import UserFunction, compile_history
from sebody.errors import InputError
from sebody.model.derivatives import rates_of
from sebody.model.functions import compilable, compiled_history

LOAD, MOTION = "load history", "motion of a drive"
SAMPLES = (0.137, 0.61, 1.13, 2.71)     # times at which rates given by a user are tested
COEFFICIENTS = 6        # most of a polynomial
SMALL = 1e-9            # jump of a value or rate, relative to its size, that is rounding

Source = "ArrayLike | Callable | tuple[Callable, Callable, Callable] | History | None"


@dataclass(frozen=True)
class History:
    """A function of time with its first two derivatives.

    From the time t_i on, and until the next one, the value is
    ``sum_k c_k x^k + A sin(w x + p)`` with ``x = t - t_i``; before the first time it is constant.
    """

    times: tuple[float, ...] = (0.0,)
    pieces: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0, 0.0),)     # c_0, c_1, ... of each
    waves: tuple[tuple[float, float, float], ...] = ()      # A, w, p of each; none at all: zeros
    functions: tuple[UserFunction, ...] = ()    # in place of pieces: value and its rates
    corners: tuple[float, ...] = ()     # times at which it is not smooth: variable steps end there

    @property
    def addresses(self) -> tuple[int, int, int]:
        """Addresses of the compiled value and its rates, 0 where there is none."""
        given = [f.address for f in self.functions]
        return (*given, *[0] * (3 - len(given)))

    def at(self, t: float) -> NDArray:
        """Value and two rates at a time, (3,); at the time of a piece those of this piece."""
        if self.functions:
            return np.array([f.ctypes(t) for f in self.functions] + [0.0] * (
                3 - len(self.functions)))
        k = int(np.searchsorted(self.times, t, side="right")) - 1
        return self.of_piece(max(k, 0), t) if k >= 0 else np.array(
            [self.of_piece(0, self.times[0])[0], 0.0, 0.0])

    def values(self, times: NDArray) -> NDArray:
        """Values at some times, (n,)."""
        if self.functions:
            return np.array([self.functions[0].ctypes(t) for t in times])
        starts = np.array(self.times)
        row = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        x = np.maximum(times - starts[row], 0.0)
        found = (self.polynomials()[row] * x[:, None]**np.arange(COEFFICIENTS)).sum(axis=1)
        if self.waves:
            A, w, p = np.array(self.waves)[row].T
            found += A * np.sin(w * x + p)
        return found

    def polynomials(self) -> NDArray:
        """Coefficients of all pieces, (pieces, COEFFICIENTS)."""
        found = np.zeros((len(self.pieces), COEFFICIENTS))
        for row, coefficients in zip(found, self.pieces, strict=True):
            row[:len(coefficients)] = coefficients
        return found

    def of_piece(self, k: int, t: float) -> NDArray:
        """Value and two rates of a piece, also outside its interval."""
        x, polynomial = t - self.times[k], np.polynomial.Polynomial(self.pieces[k])
        found = np.array([polynomial.deriv(m)(x) if m else polynomial(x) for m in range(3)])
        if self.waves:
            A, w, p = self.waves[k]
            s, c = sin(w * x + p), cos(w * x + p)
            found += A * np.array([s, w * c, -w * w * s])
        return found

    def described(self) -> str:
        """What it is, in a few words."""
        if self.functions:
            return f"function {getattr(self.functions[0].function, '__name__', '')}".rstrip()
        if len(self.pieces) == 1 and not self.waves and not any(self.pieces[0][1:]):
            return f"constant {self.pieces[0][0]:.6g}"
        return f"{len(self.pieces)} pieces, t = {self.times[0]:.6g} to {self.times[-1]:.6g}"

    def __repr__(self) -> str:
        return f"<History: {self.described()}>"

    def _summands(self, k: int, t: float) -> NDArray:
        """Sums of the sizes of what is added up in `of_piece`: they may cancel but for rounding."""
        x, polynomial = abs(t - self.times[k]), np.polynomial.Polynomial(np.abs(self.pieces[k]))
        found = np.array([polynomial.deriv(m)(x) if m else polynomial(x) for m in range(3)])
        if self.waves:
            A, w, _ = self.waves[k]
            found += abs(A) * np.array([1.0, abs(w), w * w])
        return found

    def jumps(self) -> list[tuple[float, NDArray, NDArray]]:
        """Times after the start at which value or rates jump, with what they are on both sides.

        What does not jump but for rounding is the same on both sides.
        """
        found = []
        for k, t in enumerate(self.times):
            if t <= 0.0:
                continue
            after = self.of_piece(k, t)
            before = self.of_piece(k - 1, t) if k else np.array([after[0], 0.0, 0.0])
            size = np.maximum(np.abs(after), self._summands(k - 1, t) if k else 0.0)
            jump = np.abs(after - before) > SMALL * size
            if jump.any():
                found.append((t, np.where(jump, before, after), after))
        return found

    def with_corners(self) -> History:
        """This history of pieces, its corners where its value or a rate jumps."""
        return replace(self, corners=tuple(t for t, *_ in self.jumps()))

    def from_zero(self) -> History:
        """The same less its value at t = 0."""
        value = self.at(0.0)[0]
        if value == 0.0 or not np.isfinite(value):
            return self
        if self.functions:
            return replace(self, functions=(_less(self.functions[0], value),
                                            *self.functions[1:]))
        return replace(self, pieces=tuple((c[0] - value, *c[1:]) for c in self.pieces))


def history(source: Source) -> History:
    """A load history from None (1), a number, a table, a function of time or a ready profile.

    A table ``[(t, value), ...]`` is interpolated linearly and keeps its end values outside; a
    function is compiled, of a tuple of a function and its rates the function.

    Raises
    ------
    InputError
        A table whose times do not increase or that is not finite, or a function Numba cannot
        compile.
    """
    if source is None:
        return History()
    if isinstance(source, Number):
        return History(pieces=((inputs.number(source, LOAD),),))
    if isinstance(source, History):
        return source
    if _is_function_with_rates(source):
        source = source[0]
    if callable(source):
        return History(functions=(compiled_history(source, LOAD),))
    times, values = table(source, LOAD)
    slopes = np.append(np.diff(values) / np.diff(times), 0.0)
    bends = np.diff(slopes, prepend=0.0) != 0.0
    return History(tuple(times), tuple(zip(values, slopes, strict=True)),
                   corners=tuple(times[bends]))


def with_corners(function: Callable[[float], float], corners: Sequence[float]) -> History:
    """A function of time and the times at which it is not smooth: variable steps end there.

    Raises
    ------
    InputError
        A function Numba cannot compile, or times that are no numbers.
    """
    remedy = f"corners are {inputs.shown(corners)}: give a list of times"
    times = np.unique(inputs.vector(corners, "corners", remedy=remedy))
    inputs.function(function, "function", "give a function of time")
    return History(functions=(compiled_history(function, LOAD),), corners=tuple(times.tolist()))


def clock() -> History:
    """A history whose value is the time itself."""
    return History((0.0,), ((0.0, 1.0),))


def motion(source: Source) -> History:
    """The motion of a drive: a position and its first two derivatives, less its value at t = 0.

    Parameters
    ----------
    source : table, function, tuple of three functions or ready profile
        A table ``[(t, value), ...]`` becomes a cubic spline, at rest at both ends and outside.
        The rates of a function of time are derived from it by SymPy; three functions are value,
        rate and second rate.

    Raises
    ------
    InputError
        None of these, functions that are not each other's derivatives, a function that cannot be
        compiled or differentiated, a position or rate that jumps.
    """
    if isinstance(source, History):
        if len(source.functions) == 1:
            value = source.functions[0]
            rates = (compiled_history(f, MOTION) for f in rates_of(value.function, MOTION))
            source = replace(source, functions=(value, *rates))
        _refuse_jumps(source)
        return source.from_zero()
    if callable(source):
        source = (source, *rates_of(source, MOTION))
    if _is_function_with_rates(source):
        functions = tuple(compiled_history(f, MOTION) for f in source)
        _check_rates(functions)
        return History(functions=functions).from_zero()
    if isinstance(source, Number):
        raise InputError(f"motion of a drive is {inputs.shown(source)}, always the same: give a "
                         "table, a function of time or a ready profile, or fix the node")
    times, values = table(source, MOTION)
    if len(times) < 2:
        raise InputError("the motion of a drive has one row: give at least two rows (t, value), "
                         "or fix the node")
    return spline_of(times, values, (0.0, 0.0)).from_zero()


def spline_of(times: NDArray, values: NDArray, rates: tuple[float, float]) -> History:
    """A cubic spline with these rates at its ends, constant outside."""
    from scipy.interpolate import CubicSpline  # takes 0.2 s to import

    spline = CubicSpline(times, values, bc_type=((1, rates[0]), (1, rates[1])))
    return of_cubics(times, spline.c, values[-1])


def of_cubics(times: NDArray, coefficients: NDArray, last: float) -> History:
    """A history of SciPy's cubics (4, intervals), highest power first, then constant."""
    return History(tuple(times.tolist()), (*map(tuple, coefficients[::-1].T.tolist()),
                                           (float(last),)))


def table(source: ArrayLike, what: str) -> tuple[NDArray, NDArray]:
    """Times and values of a table.

    Raises
    ------
    InputError
        Other shapes than rows (t, value), numbers that are not finite, times that do not increase.
    """
    rows = inputs.reals(source, f"{what} cannot be read as numbers: it",
                        "give rows (t, value), or a function of time")
    if rows.ndim != 2 or rows.shape[1] != 2 or not len(rows):
        raise InputError(f"{what} has shape {rows.shape}: give rows (t, value)")
    if not np.isfinite(rows).all():
        raise InputError(f"{what} contains NaN or infinite entries: give finite numbers")
    if (np.diff(rows[:, 0]) <= 0).any():
        raise InputError(f"times of a {what} must increase: sort the rows and merge equal times")
    return rows[:, 0], rows[:, 1]


def same_waves(parts: Sequence[History]) -> tuple[tuple[float, float, float], ...]:
    """Harmonics of all pieces of some histories, zeros where one has none."""
    if not any(part.waves for part in parts):
        return ()
    none = (0.0, 0.0, 0.0)
    return tuple(wave for part in parts
                 for wave, _ in zip_longest(part.waves, part.pieces, fillvalue=none))


def _is_function_with_rates(source: object) -> bool:
    return isinstance(source, tuple) and len(source) == 3 and all(map(callable, source))


def _less(function: UserFunction, value: float) -> UserFunction:
    inner = njit(compilable(function.function))

    def less(t):
        return inner(t) - value
    made = compile_history(less, MOTION)
    made.function, made.read = function.function, function.read
    return made


def _refuse_jumps(given: History) -> None:
    """Refuse a motion that no body can follow."""
    for t, before, after in given.jumps():
        for k, what in enumerate(("position", "rate")):
            if before[k] != after[k]:
                raise InputError(
                    f"motion of a drive: its {what} jumps from {before[k]:.6g} to {after[k]:.6g} "
                    f"at t = {t:.6g}, which no body can follow: go there by rest_to_rest, "
                    "trapezoidal or a spline; only at t = 0 may it have a speed at once")


def _check_rates(functions: Sequence[UserFunction]) -> None:
    """Refuse a rate that is not the derivative of the function before it."""
    for k, what in ((0, "second function is not the derivative of the first"),
                    (1, "third function is not the derivative of the second")):
        f, rate = functions[k].ctypes, functions[k + 1].ctypes
        for t in SAMPLES:
            slope = (f(t + 1e-5) - f(t - 1e-5)) / 2e-5
            size = max(abs(slope), abs(rate(t)), abs(f(t)), 1e-300)
            if not abs(slope - rate(t)) < 1e-4 * size:
                raise InputError(f"motion of a drive: the {what}: at t = {t} it is {rate(t):.6g}, "
                                 f"differences give {slope:.6g}")
