"""Time functions made of what users give: numbers, tables, Python functions, inputs, splines."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from numbers import Number
from typing import TypeAlias, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.warned import warn
from sebody.io.load_series import LoadSeries, Pieces
from sebody.model.functions import compiled_history
from sebody.model.history_rows import linear, table
from sebody.model.time_functions import LOAD, TimeFunction

BEYOND = 0.05       # of the range of a table: harmonics of eight rows a period leave it by 0.04
WITHIN = 17         # values in an interval that are looked at

FunctionWithRates: TypeAlias = tuple[
    Callable[[float], float], Callable[[float], float], Callable[[float], float]]
Source: TypeAlias = "ArrayLike | Callable[[float], float] | FunctionWithRates | TimeFunction | None"


def time_function(source: Source) -> TimeFunction:
    """A time function from None (1), a number, a table, a Python function or a ready profile.

    A table ``[(t, value), ...]`` is interpolated linearly and keeps its end values outside; two
    rows of one time are a jump. A function is compiled, of a tuple of a function and its rates the
    function.

    Raises
    ------
    InputError
        A table whose times decrease or that is not finite, or a function Numba cannot compile.
    """
    if source is None:
        return TimeFunction()
    if isinstance(source, Number):
        return TimeFunction(pieces=((inputs.number(source, LOAD),),))
    if isinstance(source, TimeFunction):
        return source
    if is_function_with_rates(source):
        source = source[0]
    if callable(source):
        return TimeFunction(functions=(compiled_history(source, LOAD),))
    times, pieces, corners = linear(*table(source, LOAD, jumping=True))
    return TimeFunction(times, pieces, corners=corners)


def with_corners(function: Callable[[float], float] | FunctionWithRates,
                 corners: Sequence[float]) -> TimeFunction:
    """A function of time and the times at which it is not smooth: steps meet them.

    Variable steps end at all of them. Fixed ones do where accelerations jump, at a jump of a load
    or of a drive's second rate.

    Parameters
    ----------
    function : callable, or tuple of three
        A function, or for a drive the function and its first two rates.

    Raises
    ------
    InputError
        A function Numba cannot compile, or times that are no numbers.
    """
    times = corners_of(corners)
    given = function if is_function_with_rates(function) else (function,)
    checked = [inputs.function(one, "function", "give a function of time") for one in given]
    return TimeFunction(functions=tuple(compiled_history(one, LOAD) for one in checked),
                        corners=times)


def input_history(start: float, lag: float, rate: float, limits: tuple[float, float] | tuple[()]
                  ) -> TimeFunction:
    """The time function of an input: what is set during a run; `rate` 0 stands for any."""
    return TimeFunction(pieces=((start, lag, rate),), is_input=True, limits=limits)


def corners_of(given: Sequence[float]) -> tuple[float, ...]:
    """Times of corners, ascending.

    Raises
    ------
    InputError
        Times that are no numbers.
    """
    remedy = f"corners are {inputs.shown(given)}: give a list of times"
    return tuple(np.unique(inputs.vector(given, "corners", remedy=remedy)).tolist())


def clock(corners: Sequence[float] = ()) -> TimeFunction:
    """A time function whose value is the time itself, with corners of what depends on it."""
    return TimeFunction((0.0,), ((0.0, 1.0),), corners=corners_of(corners), is_time=True)


def spline_of(times: NDArray, values: NDArray, rates: tuple[float, float]) -> TimeFunction:
    """A cubic spline with these rates at its ends, constant outside."""
    from scipy.interpolate import CubicSpline  # takes 0.2 s to import

    spline = CubicSpline(times, values, bc_type=((1, rates[0]), (1, rates[1])))
    return of_cubics(times, spline.c, values[-1])


def of_columns(series: LoadSeries) -> list[TimeFunction]:
    """Time functions of the columns of a series of loads."""
    pieces = series.pieces
    times, corners = tuple(pieces.times.tolist()), tuple(pieces.corners.tolist())
    return [TimeFunction(times, tuple(map(tuple, own.tolist())), corners=corners)
            for own in pieces.coefficients.transpose(2, 0, 1)]


def pieces_of(columns: Sequence[TimeFunction], terms: int, jumps: Sequence[float]) -> Pieces:
    """The pieces of columns with the same times and corners, with so many coefficients each."""
    return Pieces(np.array(columns[0].times),
                  np.stack([one.polynomials()[:, :terms] for one in columns], axis=2),
                  np.array(columns[0].corners), np.array(jumps))


def of_cubics(times: NDArray, coefficients: NDArray, last: float) -> TimeFunction:
    """A time function of SciPy's cubics (4, intervals), highest power first, then constant.

    Warns where they leave the range of the rows by more than `BEYOND` of it.
    """
    rows = np.append(coefficients[-1], last)
    within = np.linspace(0.0, 1.0, WITHIN)[:, None] * np.diff(times)
    values = np.polyval(coefficients, within)
    beyond = np.maximum(values - rows.max(), rows.min() - values)
    share = beyond.max() / max(np.ptp(rows), 1e-300)
    if share > BEYOND:
        k = np.unravel_index(np.argmax(beyond), beyond.shape)
        warn(f"the spline through a table of {len(times)} rows leaves their range by "
             f"{100.0 * share:.2g} % of it, to {values[k]:.6g} at t = "
             f"{times[k[1]] + within[k]:.6g}: give more rows, rows (t, value, rate) by "
             "spline, or rest_to_rest")
    return TimeFunction(tuple(times.tolist()), (*map(tuple, coefficients[::-1].T.tolist()),
                                           (float(last),)))


def is_function_with_rates(source: object) -> TypeGuard[FunctionWithRates]:
    return isinstance(source, tuple) and len(source) == 3 and all(map(callable, source))
