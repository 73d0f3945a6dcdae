"""Histories of loads and drives: tables, or a user's functions compiled for the loop.

Every history is a piecewise cubic or three compiled functions: value and two rates. Loads need the
value alone, drives all three.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.errors import InputError
from sebody.kernels.user_functions import compile_history

SAMPLES = (0.137, 0.61, 1.13, 2.71)     # times at which rates given by a user are tested


@dataclass(frozen=True)
class History:
    """A function of time: cubics ``sum_k c_k (t - t_i)^k``, constant outside, or functions."""

    times: tuple[float, ...] = (0.0,)
    cubics: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0, 0.0),)
    functions: tuple = ()       # keeps the compiled functions alive
    corners: tuple[float, ...] = ()     # times at which the rate jumps

    @property
    def addresses(self) -> tuple[int, int, int]:
        """Addresses of the compiled value and its rates, 0 where there is none."""
        given = [f.address for f in self.functions]
        return (*given, *[0] * (3 - len(given)))


def history(source: "ArrayLike | Callable[[float], float] | History | None") -> History:
    """A load history from None (constant 1), a table ``[(t, value), ...]`` or a function of time.

    A table is interpolated linearly and keeps its end values outside; a function is compiled.

    Raises
    ------
    InputError
        A table whose times do not increase or that is not finite, or a function Numba cannot
        compile.
    """
    if source is None:
        return History()
    if isinstance(source, History):
        return source
    if callable(source):
        return History(functions=(compile_history(source, "load history"),))
    times, values = _table(source, "load history")
    slopes = np.append(np.diff(values) / np.diff(times), 0.0)
    cubics = tuple((v, s, 0.0, 0.0) for v, s in zip(values, slopes, strict=True))
    bends = np.diff(slopes, prepend=0.0) != 0.0
    return History(tuple(times), cubics, corners=tuple(times[bends]))


def with_corners(function: Callable[[float], float], corners: Sequence[float]) -> History:
    """A function of time and the times at which it is not smooth: variable steps end there.

    Raises
    ------
    InputError
        A function Numba cannot compile, or times that are no numbers.
    """
    times = np.asarray(corners, dtype=float)
    if times.ndim != 1 or not np.isfinite(times).all():
        raise InputError(f"corners are {corners}: give a list of times")
    return History(functions=(compile_history(function, "load history"),),
                   corners=tuple(times.tolist()))


def clock() -> History:
    """A history whose value is the time itself."""
    return History((0.0, 1e30), ((0.0, 1.0, 0.0, 0.0), (1e30, 0.0, 0.0, 0.0)))


def motion(source: "ArrayLike | tuple[Callable, Callable, Callable] | History") -> History:
    """The motion of a drive: a position and its first two derivatives.

    Parameters
    ----------
    source : table or tuple of three functions
        A table ``[(t, value), ...]`` becomes a cubic spline, at rest at both ends and outside.
        Three functions of time are value, rate and second rate.

    Raises
    ------
    InputError
        None of these, or functions that are not each other's derivatives.
    """
    if isinstance(source, History):
        return source
    if isinstance(source, tuple) and len(source) == 3 and all(map(callable, source)):
        functions = tuple(compile_history(f, "motion of a drive") for f in source)
        _check_rates(functions)
        return History(functions=functions)
    if callable(source):
        raise InputError("the motion of a drive is one function: give three, (value, rate, second "
                         "rate), or a table [(t, value), ...]")
    times, values = _table(source, "motion of a drive")
    if len(times) < 2:
        raise InputError("the motion of a drive has one row: give at least two rows (t, value), "
                         "or fix the node")
    from scipy.interpolate import CubicSpline  # takes 0.2 s to import

    spline = CubicSpline(times, values, bc_type="clamped")
    return History(tuple(times), (*(tuple(c) for c in spline.c[::-1].T),
                                  (values[-1], 0.0, 0.0, 0.0)))


def _check_rates(functions) -> None:
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


def _table(source: ArrayLike, what: str) -> tuple[NDArray, NDArray]:
    try:
        table = np.asarray(source, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{what} cannot be read as numbers: give rows (t, value), or a function "
                         "of time") from error
    if table.ndim != 2 or table.shape[1] != 2 or not len(table):
        raise InputError(f"{what} has shape {table.shape}: give rows (t, value)")
    if not np.isfinite(table).all():
        raise InputError(f"{what} contains NaN or infinite entries: give finite numbers")
    if (np.diff(table[:, 0]) <= 0).any():
        raise InputError(f"times of a {what} must increase: sort the rows and merge equal times")
    return table[:, 0], table[:, 1]


