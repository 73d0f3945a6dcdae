"""Laws of springs and dampers by tables and functions: cubics between rows, straight beyond them.

Between the rows of a user the cubics are monotone (F. N. Fritsch and J. Butland, SIAM Journal on
Scientific and Statistical Computing 5, 1984, p. 300), as of bearing tables, with one slope at a
row; beyond the ends the slope of the last row goes on. A gap and an end of tension are kinks.
"""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files.csv_files import csv_rows
from sebody.basics.warned import warn
from sebody.kernels.tables import HEAD, ROWS, SIZE, TERMS, table_law

Given: TypeAlias = "ArrayLike | str | Path | Callable[[float], float]"
FINE = 1e-7         # of the largest force, by which rows may differ from a function
STEP = 1e-3         # of an interval, in differences of a function
ENERGY, FORCE, SLOPE = range(3)     # orders of `table_law`


class Law(NamedTuple):
    """A force at places, with the slopes before and behind each of them."""

    places: NDArray
    forces: NDArray
    before: NDArray
    behind: NDArray

    @classmethod
    def straight(cls, slope: float) -> Law:
        """The force of a stiffness, or of a damper."""
        slopes = np.array([slope])
        return cls(np.zeros(1), np.zeros(1), slopes, slopes)

    @classmethod
    def of(cls, given: Given, between: ArrayLike | None, what: str) -> Law:
        """The law that a user gives.

        Parameters
        ----------
        given : table, CSV file or function
            Rows (elongation, force), ascending.
        between : (2,), optional
            Of a function: elongations between which it is read; beyond it goes straight on.

        Raises
        ------
        InputError
            A file that cannot be read, too few or too many rows, numbers that are not finite or do
            not ascend, a function without `between`.
        """
        if callable(given):
            return cls._of_function(given, between, what)
        if between is not None:
            raise InputError(f"{what} is a table, so leave between= out: it is of a function")
        if isinstance(given, str | PathLike):
            rows = csv_rows(Path(given), what, 2)
        else:
            rows = inputs.reals(given, what, "give rows (elongation, force), a CSV file of them, "
                                "or a function")
        if rows.ndim != 2 or rows.shape[1] != 2 or not 2 <= len(rows) <= ROWS:
            raise InputError(f"{what} has shape {rows.shape}: give 2 to {ROWS} rows (elongation, "
                             "force)")
        if not np.isfinite(rows).all():
            raise InputError(f"{what} contains NaN or infinite entries: give finite numbers")
        u, forces = rows.T
        if (np.diff(u) <= 0.0).any():
            k = int(np.argmax(np.diff(u) <= 0.0))
            raise InputError(f"{what}: elongations must ascend, and behind {u[k]:.6g} comes "
                             f"{u[k + 1]:.6g}: sort the rows")
        from scipy.interpolate import PchipInterpolator  # takes 0.2 s

        slopes = PchipInterpolator(u, forces).derivative()(u)
        return cls(u, forces, slopes, slopes)

    @classmethod
    def _of_function(cls, given: Callable[[float], float], between: ArrayLike | None, what: str
                     ) -> Law:
        if between is None:
            raise InputError(f"{what} is a function: give between=(least, largest), where it is "
                             "read; beyond it goes straight on")
        low, high = inputs.vector(between, f"{what}: between", 2)
        if not low < high:
            raise InputError(f"{what}: between is {low:.6g} to {high:.6g}: give the least first")
        u = np.linspace(low, high, ROWS - 2)     # a gap takes rows, too
        d = STEP * (u[1] - u[0])

        def at(places: NDArray) -> NDArray:
            try:
                found = np.array([float(given(float(x))) for x in places])
            except Exception as error:      # whatever the user's function does
                raise InputError(f"{what} cannot be evaluated ({error}): give a function of one "
                                 "number, the elongation") from error
            if not np.isfinite(found).all():
                raise InputError(f"{what} is not finite at {places[~np.isfinite(found)][0]:.6g}: "
                                 "give other limits by between=")
            return found
        slopes = (8.0 * (at(u + d) - at(u - d)) - at(u + 2 * d) + at(u - 2 * d)) / (12.0 * d)
        made = cls(u, at(u), slopes, slopes)
        middle = (u[1:] + u[:-1]) / 2.0
        apart = np.abs(made.at(middle) - at(middle)).max() / max(np.abs(made.forces).max(), 1e-300)
        if apart > FINE:
            warn(f"{what}: {len(u)} cubics differ from the function by {apart:.2g} of the largest "
                 "force: give closer limits by between=")
        return made

    def at(self, places: NDArray) -> NDArray:
        """Forces."""
        table = self.packed()
        return np.array([_law(table, float(u), FORCE) for u in places])

    def slopes_at(self, u: float) -> float:
        """Slope."""
        return _law(self.packed(), u, SLOPE)

    def with_row(self, u: float) -> Law:
        """The same law with a row at a place."""
        if np.any(self.places == u):
            return self
        k = int(np.searchsorted(self.places, u))
        force, slope = self.at(np.array([u]))[0], self.slopes_at(u)
        return Law(*(np.insert(own, k, value) for own, value in zip(
            self, (u, force, slope, slope), strict=True)))

    def with_gap(self, gap: float, what: str) -> Law:
        """The law beyond a gap on either side, without a force within."""
        law = self.with_row(0.0)
        k = int(np.flatnonzero(law.places == 0.0)[0])
        if abs(law.forces[k]) > 1e-12 * np.abs(law.forces).max(initial=0.0):
            raise InputError(f"{what}: without elongation the force is {law.forces[k]:.6g}, so "
                             "there is no gap: give a force that is 0 there, and preload=")
        left, right = slice(0, k + 1), slice(k, None)
        return Law(np.append(law.places[left] - gap, law.places[right] + gap),
                   np.append(law.forces[left], law.forces[right]),
                   np.append(law.before[left], [0.0, *law.before[k + 1:]]),
                   np.append([*law.behind[:k], 0.0], law.behind[right]))

    def pulling(self, what: str) -> Law:
        """The law without a force below the elongation at which it begins to pull."""
        from scipy.optimize import brentq

        u = self.places
        slope = self.before[0]
        if self.forces[0] > 0.0:
            if not slope > 0.0:
                raise InputError(f"{what} never ceases to pull: give tension_only a law that does")
            root = u[0] - self.forces[0] / slope
        else:
            pulling = np.flatnonzero(self.forces > 0.0)
            if pulling.size:
                k = int(pulling[0])
                root = u[k - 1] if self.forces[k - 1] == 0.0 else brentq(
                    lambda x: self.at(np.array([x]))[0], u[k - 1], u[k], xtol=1e-15)
            elif self.behind[-1] > 0.0:
                root = u[-1] - self.forces[-1] / self.behind[-1]
            else:
                raise InputError(f"{what} never pulls: leave tension_only out, or give positive "
                                 "forces")
        law = self.with_row(float(root))
        k = int(np.flatnonzero(law.places == root)[0])
        if (law.forces[k + 1:] < 0.0).any():
            raise InputError(f"{what} pushes again beyond an elongation of {root:.6g}: give "
                             "tension_only forces that stay positive")
        own = slice(k, None)
        return Law(law.places[own], np.append(0.0, law.forces[k + 1:]),
                   np.append(0.0, law.before[k + 1:]), law.behind[own])

    def mirrored(self) -> Law:
        """The law of an elongation that counts the other way."""
        return Law(-self.places[::-1], -self.forces[::-1], self.behind[::-1], self.before[::-1])

    def packed(self) -> NDArray:
        """The numbers that kernels read, (SIZE,): see `sebody.kernels.tables`."""
        if len(self.places) > ROWS:
            raise InputError(f"a spring has {len(self.places)} rows with those of its gap and its "
                             f"end of tension: give at most {ROWS} in all")
        table = np.zeros(SIZE)
        h, rise = np.diff(self.places), np.diff(self.forces)
        with np.errstate(divide="ignore", invalid="ignore"):
            b = (3.0 * rise / h - 2.0 * self.behind[:-1] - self.before[1:]) / h
            c = (self.behind[:-1] + self.before[1:] - 2.0 * rise / h) / h**2
        energy = np.append(0.0, np.cumsum(h * (self.forces[:-1] + h * (
            self.behind[:-1] / 2.0 + h * (b / 3.0 + c * h / 4.0)))))
        rows = np.column_stack([self.places, self.forces, self.behind, np.append(b, 0.0),
                                np.append(c, 0.0), energy])
        table[:HEAD] = len(h), self.before[0]
        table[HEAD:HEAD + rows.size] = rows.ravel()
        table[HEAD + TERMS - 1:HEAD + rows.size:TERMS] -= _law(table, 0.0, ENERGY)
        return table


def unpacked(table: NDArray) -> Law:
    """The law of numbers that kernels read."""
    count = int(table[0])
    u, forces, behind, b, c, _ = table[HEAD:HEAD + TERMS * (count + 1)].reshape(-1, TERMS).T
    h = np.diff(u)
    ends = behind[:-1] + h * (2.0 * b[:-1] + 3.0 * c[:-1] * h)
    return Law(u, forces, np.append(table[1], ends), behind)


def _law(table: NDArray, u: float, order: int) -> float:
    """`table_law` as Python runs it, without compiling."""
    return float(getattr(table_law, "py_func", table_law)(table, u, order))
