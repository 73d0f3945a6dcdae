"""Motions given by their acceleration, such as accelerograms of earthquakes: exact integrals.

Between the rows of a table the acceleration is linear, so the position is a cubic. Before the first
row and behind the last one there is none: the position rests, then goes on at the speed that it
has. What a record leaves there, the drift, is often an error of measurement.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files.csv_files import csv_rows
from sebody.basics.warned import warn
from sebody.model.derivatives import integrals_of
from sebody.model.history_rows import table
from sebody.model.motions import motion
from sebody.model.time_functions import COEFFICIENTS, TimeFunction

Acceleration: TypeAlias = "ArrayLike | str | Path | Callable[[float], float] | TimeFunction"
DRIFTS = "keep", "remove"
ROUNDED = 1e-9      # of the largest speed, what is none


def of_acceleration(given: Acceleration, drift: str | None, what: str) -> TimeFunction:
    """The motion that has an acceleration, at rest in its place at the first row, or t = 0.

    Parameters
    ----------
    given : table, CSV file, function of time or ready profile
        Rows (t, acceleration), in a file below a line of names or not. A function is integrated by
        SymPy.
    drift : {'keep', 'remove'}, optional
        Of a table: keep the speed that it leaves behind its last row, or take from the
        acceleration the straight line that leaves neither speed nor way. It is told what that
        line is, and without `drift` what is left.

    Raises
    ------
    InputError
        A file that cannot be read, no table, a function without an integral in closed form, or a
        drift of anything but a table.
    """
    if drift is not None:
        inputs.choice(drift, f"{what}: drift", DRIFTS)
    if isinstance(given, str | PathLike):
        given = csv_rows(Path(given), what, 2)
    if isinstance(given, TimeFunction) or callable(given):
        if drift is not None:
            raise InputError(f"{what}: drift is of a table, which ends: leave it out of a function")
        return _of_profile(given, what)
    times, values = table(given, what)
    if len(times) < 2:
        raise InputError(f"{what} has one row: give at least two rows (t, acceleration)")
    left = _ends(times, values)[:, -1]
    if drift == "remove":
        values = _without_drift(times, values, left, what)
    elif drift is None and abs(left[0]) > ROUNDED * np.abs(_ends(times, values)[0]).max():
        warn(f"{what} leaves a speed of {left[0]:.6g} and a way of {left[1]:.6g} behind its last "
             f"row, t = {times[-1]:.6g}: give drift='remove', or drift='keep' where they are meant")
    speeds, ways = _ends(times, values)
    slopes = np.append(np.diff(values) / np.diff(times), 0.0)
    values[-1] = 0.0
    pieces = np.stack([ways, speeds, values / 2.0, slopes / 6.0], axis=1)
    return TimeFunction(tuple(times.tolist()), tuple(map(tuple, pieces.tolist()))
                        ).from_zero().with_corners()


def _ends(times: NDArray, values: NDArray) -> NDArray:
    """Speed and way at the rows, (2, n)."""
    h, a, b = np.diff(times), values[:-1], values[1:]
    speeds = np.append(0.0, np.cumsum(h * (a + b) / 2.0))
    return np.stack([speeds, np.append(0.0, np.cumsum(
        h * speeds[:-1] + h**2 * (2.0 * a + b) / 6.0))])


def _without_drift(times: NDArray, values: NDArray, left: NDArray, what: str) -> NDArray:
    """Take a straight line from accelerations, which leave then neither speed nor way."""
    T = times[-1] - times[0]
    line = np.linalg.solve([[T, T**2 / 2.0], [T**2 / 2.0, T**3 / 6.0]], left)
    taken = line[0] + line[1] * (times - times[0])
    share = np.abs(taken).max() / max(np.abs(values).max(), 1e-300)
    warn(f"{what}: a speed of {left[0]:.6g} and a way of {left[1]:.6g} behind the last row are "
         f"removed by a straight line from {taken[0]:.6g} to {taken[-1]:.6g}, at most "
         f"{100.0 * share:.2g} % of the largest acceleration")
    return values - taken


def _of_profile(given: Callable[[float], float] | TimeFunction, what: str) -> TimeFunction:
    """Integrals of a function, or of the pieces of a ready profile."""
    if not isinstance(given, TimeFunction) or given.functions:
        own = given.functions[0].function if isinstance(given, TimeFunction) else given
        corners = given.corners if isinstance(given, TimeFunction) else ()
        made = motion(integrals_of(own, what))
        return replace(made, corners=corners)
    found = _integral(_integral(given, what), what)
    return found.from_zero().with_corners()


def _integral(given: TimeFunction, what: str) -> TimeFunction:
    """The integral from t = 0, where the first piece has to begin, or before."""
    if given.times[0] > 0.0:
        value = given.at(given.times[0])[0]
        given = replace(given, times=(0.0, *given.times), pieces=((value,), *given.pieces),
                        waves=given.waves and ((0.0, 0.0, 0.0), *given.waves))
    if max(map(len, given.pieces)) >= COEFFICIENTS:
        raise InputError(f"{what} is of pieces whose integrals are of degree six: give a table")
    pieces, waves, total = [], [], 0.0
    for k, (t, own) in enumerate(zip(given.times, given.pieces, strict=True)):
        A, w, p = given.waves[k] if given.waves else (0.0, 0.0, 0.0)
        moving = A != 0.0 and w != 0.0
        still = 0.0 if moving or A == 0.0 else A * np.sin(p)
        wave = (A / w, w, p - np.pi / 2.0) if moving else (0.0, 0.0, 0.0)
        rates = (own[0] + still, *own[1:])
        piece = [total - wave[0] * np.sin(wave[2]), *(c / (j + 1) for j, c in enumerate(rates))]
        pieces.append(tuple(map(float, piece)))
        waves.append(wave)
        if k + 1 < len(given.times):
            x = given.times[k + 1] - t
            total = sum(c * x**j for j, c in enumerate(piece)) + wave[0] * np.sin(
                wave[1] * x + wave[2])
    made = TimeFunction(given.times, tuple(pieces), tuple(waves) if given.waves else ())
    start = made.of_piece(max(int(np.searchsorted(made.times, 0.0, side="right")) - 1, 0), 0.0)[0]
    return replace(made, pieces=tuple((c[0] - start, *c[1:]) for c in made.pieces))
