"""Histories of loads: tables read by linear interpolation, or a user's compiled function."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import cfunc, types
from numba.core.errors import NumbaError
from numpy.typing import ArrayLike

from .errors import InputError

FUNCTION = types.float64(types.float64)


@dataclass(frozen=True)
class History:
    """Amplitude of a load in time: a table, or the address of a compiled function."""

    times: tuple[float, ...] = (0.0,)
    values: tuple[float, ...] = (1.0,)
    function: object = None     # keeps the compiled function alive

    @property
    def address(self) -> int:
        """Address of the compiled function, 0 for a table."""
        return self.function.address if self.function is not None else 0


def history(source: "ArrayLike | Callable[[float], float] | None") -> History:
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
        try:
            return History(function=cfunc(FUNCTION)(source))
        except NumbaError as error:
            raise InputError(f"load history {getattr(source, '__name__', source)!r} cannot be "
                             f"compiled: use only arithmetic, math and numpy in it ({error})"
                             ) from error
    table = np.asarray(source, dtype=float)
    if table.ndim != 2 or table.shape[1] != 2 or not len(table):
        raise InputError(f"load history has shape {table.shape}: give rows (t, value)")
    if not np.isfinite(table).all():
        raise InputError("load history contains NaN or infinite entries: give finite numbers")
    if (np.diff(table[:, 0]) <= 0).any():
        raise InputError("times of a load history must increase: sort the rows and merge equal "
                         "times")
    return History(tuple(table[:, 0]), tuple(table[:, 1]))
