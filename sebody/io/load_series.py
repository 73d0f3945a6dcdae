"""Series of loads: columns of one table of times, linear or cubic between its rows."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.basics.files.reading import text as read_text
from sebody.basics.spelling import unknown
from sebody.basics.tabular import counted

INTERPOLATIONS = {"linear": 2, "cubic": 4}      # and the coefficients of a piece
_BEFORE = 1.0       # time before a jump in the first row, where values are constant
_SMALL = 1e-9       # jump of a slope, relative to the slopes beside it, that is rounding


class Pieces(NamedTuple):
    """Polynomials of all columns from each time on, in the time since then; constant before."""

    times: NDArray          # (pieces,), ascending
    coefficients: NDArray   # (pieces, coefficients, columns), by ascending powers
    corners: NDArray        # times at which a value or slope jumps
    jumps: NDArray          # those of them at which a value does


@dataclass(frozen=True, eq=False)
class LoadSeries:
    """Loads by time: one table for all columns.

    Outside the table the first and last values go on. Two rows of one time are a jump.

    Parameters
    ----------
    t : (rows,)
        Times, not decreasing [time].
    values : (rows, columns)
        Values at these times.
    names : sequence of str
        A name for each column, which says what it acts on: see `Model.body_series` and
        `Model.beam_series`.
    interpolation : 'linear' or 'cubic'
        Between rows. Cubic: a spline with continuous curvature between jumps.
    others : mapping of str to (rows,), optional
        Further columns of the same table that are no loads, such as a wave elevation.

    Raises
    ------
    InputError
        Shapes that do not fit, entries that are not finite, times that decrease, more than two rows
        of one time, or names that repeat.
    """

    t: NDArray
    values: NDArray
    names: tuple[str, ...]
    interpolation: str = "linear"
    others: Mapping[str, NDArray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = tuple(inputs.name(name, "name of a column of a load series") for name in
                      inputs.items(self.names, "names of a load series", "give a text per column"))
        if len(set(names)) != len(names) or not names:
            raise inputs.refusal("names of a load series", names, "give a different name for each "
                                 "column, and one column at least")
        t = inputs.vector(self.t, "times of a load series")
        values = inputs.array(self.values, "values of a load series", (len(t), len(names)),
                              remedy=f"give {len(t)} rows, one for each time, of {len(names)} "
                              "finite numbers, one for each name")
        _check_times(t)
        inputs.choice(self.interpolation, "interpolation", tuple(INTERPOLATIONS))
        others = {inputs.name(name, "name of a further column"): _frozen(inputs.vector(
            value, f"column {name!r} of a load series", len(t)))
            for name, value in inputs.mapping(self.others, "others", "give a dict").items()}
        for name, value in (("t", _frozen(t)), ("values", _frozen(values)), ("names", names),
                            ("others", others)):
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        return f"<LoadSeries: {self.described()}>"

    def described(self) -> str:
        """Description in a few words."""
        return (f"{counted(len(self.names), 'column')}, {counted(len(self.t), 'row')}, t = "
                f"{self.t[0]:.6g} to {self.t[-1]:.6g}, {self.interpolation}")

    @classmethod
    def from_csv(cls, path: str | Path, interpolation: str = "linear",
                 columns: Iterable[str] | None = None) -> LoadSeries:
        """The series of a CSV file: a line of names, then rows of a time and a number for each.

        Lines that begin with # and empty ones are left out.

        Parameters
        ----------
        columns : iterable of str, optional
            Names of the columns that are loads; all by default. The others go to `others`.

        Raises
        ------
        InputError
            A file that cannot be read, or a line that has something else; the message names it.
        """
        names, rows = _csv_rows(inputs.path(path, "path of a load series"))
        table = np.array(rows)
        chosen = list(names) if columns is None else [_known(name, names, path) for name in
                                                      inputs.items(columns, "columns",
                                                                   "give a list of names")]
        at = [names.index(name) for name in chosen]
        return cls(table[:, 0], table[:, 1:][:, at], tuple(chosen), interpolation,
                   {name: table[:, 1 + k] for k, name in enumerate(names) if name not in chosen})

    def to_csv(self, path: str | Path) -> Path:
        """Write the table; numbers as they are read again, bit for bit."""
        path = check_target(path, "load series")
        table = np.column_stack([self.t, self.values, *self.others.values()])
        with replacing(path, "load series") as stream:
            lines = [",".join(("t", *self.names, *self.others)),
                     *(",".join(map(repr, row)) for row in table.tolist())]
            stream.write(("\n".join(lines) + "\n").encode())
        return path

    def scaled(self, factor: float) -> LoadSeries:
        """The same with all loads times a factor."""
        return replace(self, values=self.values * inputs.number(factor, "factor of a load series"))

    def chosen(self, names: Iterable[str]) -> LoadSeries:
        """The same with some of its columns."""
        wanted = [_known(name, self.names, "load series") for name in inputs.items(
            names, "names", "give a list of names")]
        return replace(self, values=self.values[:, [self.names.index(n) for n in wanted]],
                       names=tuple(wanted))

    def at(self, times: ArrayLike) -> NDArray:
        """Values at some times, (times, columns); at a jump those after it."""
        times = np.atleast_1d(inputs.reals(times, "times", "give numbers"))
        pieces = self.pieces
        row = np.maximum(np.searchsorted(pieces.times, times, side="right") - 1, 0)
        x = np.maximum(times - pieces.times[row], 0.0)[:, None]
        total = np.zeros((len(times), len(self.names)))
        for k in range(pieces.coefficients.shape[1])[::-1]:
            total = total * x + pieces.coefficients[row, k]
        return total

    @cached_property
    def pieces(self) -> Pieces:
        """The polynomials between its rows."""
        t, values = self.t, self.values
        if len(t) > 1 and t[0] == t[1]:
            t, values = np.append(t[0] - _BEFORE, t), np.vstack([values[:1], values])
        terms = INTERPOLATIONS[self.interpolation]
        coefficients = np.zeros((len(t), terms, values.shape[1]))
        coefficients[:, 0] = values
        breaks = np.flatnonzero(np.diff(t) == 0.0) + 1
        for first, last in zip([0, *breaks], [*breaks, len(t)], strict=True):
            own = slice(first, last - 1)
            if last - first > 1:
                coefficients[own, 1:] = _between(t[first:last], values[first:last], terms)
        begins = np.append(np.diff(t) > 0.0, True)      # all rows but those before a jump
        jumps = t[breaks]
        slopes = coefficients[begins, 1]
        ends = _slopes_at_ends(t, coefficients)[begins]
        before = np.vstack([np.zeros_like(slopes[:1]), ends[:-1]])
        bends = np.abs(slopes - before) > _SMALL * np.maximum(np.abs(slopes), np.abs(before))
        corners = np.union1d(t[begins][bends.any(axis=1)], jumps)
        return Pieces(t[begins], coefficients[begins], corners, jumps)


def _between(t: NDArray, values: NDArray, terms: int) -> NDArray:
    """Higher coefficients of the pieces between some rows, (rows - 1, terms - 1, columns)."""
    if terms == 2:
        return (np.diff(values, axis=0) / np.diff(t)[:, None])[:, None]
    from scipy.interpolate import CubicSpline  # takes 0.2 s to import

    return CubicSpline(t, values).c[-2::-1].transpose(1, 0, 2)


def _slopes_at_ends(t: NDArray, coefficients: NDArray) -> NDArray:
    """Slopes at the end of every piece, (pieces, columns)."""
    x = np.append(np.diff(t), 0.0)[:, None]
    return sum(k * coefficients[:, k] * x**(k - 1) for k in range(1, coefficients.shape[1]))


def _check_times(t: NDArray) -> None:
    steps = np.diff(t)
    if not len(t):
        raise InputError("a load series has no row: give times and values")
    if (steps < 0).any():
        raise InputError("times of a load series must not decrease, after t = "
                         f"{t[np.argmax(steps < 0)]:.9g} they do: sort the rows")
    threefold = (steps[1:] == 0) & (steps[:-1] == 0)
    if threefold.any():
        raise InputError("a load series has more than two rows at t = "
                         f"{t[np.argmax(threefold)]:.9g}: give the values before a jump and those "
                         "after it")


def _frozen(array: NDArray) -> NDArray:
    array.flags.writeable = False
    return array


def _known(name: str, names: Iterable[str], where: object) -> str:
    if name not in names:
        raise unknown("column", name, names, f"{where} has", f"{where} has none")
    return name


def _csv_rows(path: Path) -> tuple[tuple[str, ...], list[list[float]]]:
    """Names of the columns behind the time, and rows of numbers."""
    remedy = "give a line of names, t first, then rows of numbers, all separated by commas"
    names, rows = None, []
    for number, line in enumerate(read_text(path, "load series", remedy).splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        cells = [cell.strip() for cell in next(csv.reader([line]))]
        if names is None:
            names = tuple(cells[1:])
            continue
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            raise InputError(f"{path}, line {number}: {inputs.shown(line)} is no row of numbers: "
                             f"{remedy}") from None
        if len(row) != len(names) + 1:
            raise InputError(f"{path}, line {number}: {len(row)} numbers for {len(names) + 1} "
                             f"names: {remedy}")
        rows.append(row)
    if names is None or not names or not rows:
        raise InputError(f"{path} has no table: {remedy}")
    return names, rows
