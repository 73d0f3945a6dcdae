"""Coefficients of bearings by the speed of their shaft: tables of arrays, or CSV files.

The columns have the names that ROSS (ross-rotordynamics) gives them: ``kxx``, ``kxy``, ``kyx``,
``kyy``, ``cxx``, ``cxy``, ``cyx``, ``cyy`` and, for the speed, ``frequency`` [rad/time], with x and
y across the shaft. Between the rows they are monotone cubics (F. N. Fritsch and J. Butland, SIAM
Journal on Scientific and Statistical Computing 5, 1984, p. 300).
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files.csv_files import csv_columns

COEFFICIENTS = tuple(f"{kind}{i}{j}" for kind in "kc" for i in "xy" for j in "xy")
SPEEDS = {"frequency": 1.0, "speed": 1.0, "omega": 1.0, "w": 1.0, "rpm": np.pi / 30.0}
SAME = {"kyy": "kxx", "cyy": "cxx"}     # what is left out is that of the other direction
NEEDED = "kxx"
SLACK = 1e-9        # of the range of speeds, by which one may be outside


class BearingTable(NamedTuple):
    """Stiffness and damping across a shaft by its speed."""

    speeds: NDArray         # (m,) ascending [1/time]
    stiffness: NDArray      # (m, 2, 2) [force/length]
    damping: NDArray        # (m, 2, 2) [force time/length]

    @classmethod
    def of(cls, given: Any, what: str) -> BearingTable:
        """The table that a user gives: columns by their names, or the path of a CSV file.

        Raises
        ------
        InputError
            A file that cannot be read, columns that are unknown or missing or have no numbers, or
            speeds that do not ascend.
        """
        if isinstance(given, str | PathLike):
            columns: Mapping[str, Any] = csv_columns(Path(given), what)
        else:
            columns = inputs.mapping(given, what, "give columns by their names, "
                                     f"{', '.join(('frequency', *COEFFICIENTS))}, or a CSV file")
        return cls._of_columns({inputs.name(name, f"{what}: name of a column").strip().lower():
                                column for name, column in columns.items()}, what)

    @classmethod
    def _of_columns(cls, columns: Mapping[str, Any], what: str) -> BearingTable:
        for name in columns:
            inputs.choice(name, f"{what}: column", (*SPEEDS, *COEFFICIENTS))
        of_speed = [name for name in columns if name in SPEEDS]
        if len(of_speed) != 1 or NEEDED not in columns:
            raise InputError(f"{what} needs the column {NEEDED} and one of speeds, frequency or "
                             f"rpm, and has {', '.join(columns) or 'none'}")
        speeds = SPEEDS[of_speed[0]] * inputs.vector(columns[of_speed[0]],
                                                     f"{what}: column {of_speed[0]!r}")
        if len(speeds) < 2 or np.any(np.diff(speeds) <= 0.0) or speeds[0] < 0.0:
            raise InputError(f"{what}: speeds must ascend from zero or above, two of them or more")
        found = {name: inputs.vector(columns[name], f"{what}: column {name!r}", len(speeds))
                 for name in COEFFICIENTS if name in columns}
        none = np.zeros(len(speeds))
        table = np.array([found.get(name, found.get(SAME.get(name, ""), none))
                          for name in COEFFICIENTS]).T.reshape(-1, 2, 2, 2)
        return cls(speeds, table[:, 0], table[:, 1])

    def at(self, speed: float, name: str) -> tuple[NDArray, NDArray]:
        """Stiffness and damping at a speed, (2, 2) each.

        Raises
        ------
        InputError
            A speed outside the table; the message names the bearing.
        """
        from scipy.interpolate import PchipInterpolator

        first, last = self.speeds[0], self.speeds[-1]
        slack = SLACK * (last - first)
        if not first - slack <= speed <= last + slack:
            raise InputError(f"{name!r} has a table for speeds from {first:.6g} to {last:.6g} "
                             f"rad/time, not for {speed:.6g}: add rows")
        stiffness, damping = (PchipInterpolator(self.speeds, one)(np.clip(speed, first, last))
                              for one in (self.stiffness, self.damping))
        return stiffness, damping
