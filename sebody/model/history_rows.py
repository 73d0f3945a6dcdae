"""Tables of time functions: rows (t, value), linear between rows, two at one time for a jump."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

BEFORE = 1.0        # time before a jump in the first row, where the value is constant


def table(source: object, what: str, jumping: bool = False) -> tuple[NDArray, NDArray]:
    """Times and values of a table.

    Parameters
    ----------
    jumping : bool
        Whether two rows may have the same time: the values before and from then on.

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
    times, steps = rows[:, 0], np.diff(rows[:, 0])
    if not jumping and (steps <= 0).any():
        raise InputError(f"times of a {what} must increase: sort the rows and merge equal times")
    if (steps < 0).any():
        raise InputError(f"times of a {what} must not decrease, after t = "
                         f"{times[np.argmax(steps < 0)]:.9g} they do: sort the rows")
    threefold = (steps[1:] == 0) & (steps[:-1] == 0)
    if threefold.any():
        raise InputError(f"{what} has more than two rows at t = {times[np.argmax(threefold)]:.9g}: "
                         "give the value before a jump and the value after it")
    return times, rows[:, 1]


def linear(times: NDArray, values: NDArray
           ) -> tuple[tuple[float, ...], tuple[tuple[float, float], ...], tuple[float, ...]]:
    """Times and pieces of a table of rows, and the times at which its slope or value jumps."""
    if len(times) > 1 and times[0] == times[1]:
        times, values = np.append(times[0] - BEFORE, times), np.append(values[0], values)
    begins = np.append(np.diff(times) > 0.0, True)      # all rows but those before a jump
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.append(np.diff(values) / np.diff(times), 0.0)[begins]
    bends = np.diff(slopes, prepend=0.0) != 0.0
    jumps = np.append(False, ~begins[:-1])[begins]
    times, values = times[begins].tolist(), values[begins].tolist()
    return (tuple(times), tuple(zip(values, slopes.tolist(), strict=True)),
            tuple(t for t, corner in zip(times, bends | jumps, strict=True) if corner))


def rows_of(times: Sequence[float], pieces: Sequence[Sequence[float]]) -> NDArray | None:
    """The table that `linear` makes these pieces of, (n, 2); None of another time function."""
    if any(any(piece[2:]) for piece in pieces) or any(pieces[-1][1:]):
        return None
    t = np.array(times, dtype=float)
    value, slope = np.array([(*piece, 0.0)[:2] for piece in pieces], dtype=float).T
    before = np.append(value[0], value[:-1] + slope[:-1] * np.diff(t))
    size = np.maximum(np.maximum(np.abs(before), np.abs(value)), np.abs(np.append(0.0, value[:-1])))
    rows = np.stack([np.stack([t, before], axis=1), np.stack([t, value], axis=1)], axis=1)
    kept = np.stack([np.abs(before - value) > 1e-12 * size, np.ones(len(t), dtype=bool)], axis=1)
    return rows[kept]
