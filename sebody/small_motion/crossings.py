"""Speeds at which a frequency of a rotor is a multiple of its speed: critical speeds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from sebody.basics import inputs, tabular
from sebody.basics.errors import InputError

HEADS = ("speed [rad/s]", "[rpm]", "order", "frequency [Hz]", "whirl", "damping ratio", "mode")


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings of frequencies and multiples of the speed, by ascending speed.

    Attributes
    ----------
    speeds : (m,)
        Angular velocities [1/time].
    orders : (m,)
        Frequency over speed.
    values : (m,)
        Complex eigenvalues there [1/time].
    whirl : (m,) of str
        As of a `Campbell`.
    mode : (m,) of int
        Which of the modes of the diagram, from 0.
    """

    speeds: NDArray
    orders: NDArray
    values: NDArray
    whirl: NDArray
    mode: NDArray

    @property
    def omega(self) -> NDArray:
        """Angular frequencies, (m,) [1/time]."""
        return self.values.imag

    @property
    def damping(self) -> NDArray:
        """Parts of critical damping, (m,)."""
        return -self.values.real / np.abs(self.values)

    @classmethod
    def sorted(cls, rows: Iterable[tuple]) -> Crossings:
        """Crossings by speed, from those in any order."""
        columns = list(zip(*sorted(rows, key=lambda row: row[:2]), strict=True)) or [()] * 5
        kinds = float, float, complex, str, int
        return cls(*(np.array(column, dtype=kind)
                     for column, kind in zip(columns, kinds, strict=True)))

    def __len__(self) -> int:
        return len(self.speeds)

    def __repr__(self) -> str:
        return tabular.text(*self._table())

    def _repr_html_(self) -> str:
        """Table that notebooks show."""
        return tabular.titled(*self._table())

    def _table(self) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]]:
        rows = zip(self.speeds, self.orders, self.omega, self.whirl, self.damping, self.mode,
                   strict=True)
        return (tabular.counted(len(self), "critical speed"), HEADS, [
            (f"{speed:.6g}", f"{30.0 * speed / np.pi:.6g}", f"{order:g}",
             f"{omega / (2 * np.pi):.6g}", str(whirl), f"{ratio + 0.0:.4g}", str(mode + 1))
            for speed, order, omega, whirl, ratio, mode in rows])


def orders_of(orders: ArrayLike) -> NDArray:
    """Multiples of the speed.

    Raises
    ------
    InputError
        Some are not positive.
    """
    found = inputs.vector(orders, "orders")
    if not len(found) or found.min() <= 0.0:
        raise inputs.refusal("orders", orders, "give multiples of the speed, all positive")
    return found


def refuse_turning(frame: str, reason: str) -> None:
    """Refuse frequencies in turning axes, which no multiple of the speed excites."""
    if frame == "turning":
        raise InputError("frequencies are told in turning axes, so where they are a multiple of "
                         f"the speed is no critical speed ({reason}): an unbalance is at rest in "
                         "these axes, and the critical speeds are where a frequency in them is "
                         "zero; see modes()")


def by_interpolation(speeds: NDArray, values: NDArray, whirl: NDArray, orders: NDArray
                     ) -> Crossings:
    """Crossings of modes over speeds, (m, count), by cubics between the speeds."""
    rows = []
    for k, column in enumerate(values.T):
        for order in orders:
            for speed in roots(speeds, column.imag - order * speeds):
                j = int(np.argmin(np.abs(speeds - speed)))
                growth = float(PchipInterpolator(speeds, column.real)(speed))
                rows.append((speed, order, growth + 1j * order * speed,
                             whirl[j, k], k))
    return Crossings.sorted(rows)


def roots(speeds: NDArray, gaps: NDArray) -> NDArray:
    """Speeds above zero at which gaps change their signs."""
    found = PchipInterpolator(speeds, gaps).roots(extrapolate=False)
    return found[np.isfinite(found) & (found > 0.0)]
