"""Outcome of many runs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sebody.basics import tabular
from sebody.basics.spelling import unknown


@dataclass(repr=False)
class Outcome:
    """Outcome of runs.

    Attributes
    ----------
    values : dict
        Outputs by name: histories (runs, n, ...), others (runs, ...); NaN where there is none.
    t : (n,)
        Times of the histories [time].
    reached : (runs,)
        Time that each run reached [time]; NaN of runs that did not start.
    failures : dict
        Reason by number of the run, of those that did not reach the end.
    interrupted : bool
        Whether Ctrl-C ended it; the runs that were not done are among the failures.
    seconds : float
        Time of all runs together, set-up apart.
    in_lanes : int
        How many runs were made eight at a time; all others were made one by one.
    why_one_by_one : str
        The reason, where all were.
    """

    values: dict[str, NDArray]
    t: NDArray
    reached: NDArray
    failures: dict[int, str] = field(default_factory=dict)
    interrupted: bool = False
    seconds: float = 0.0
    in_lanes: int = 0
    why_one_by_one: str = ""

    def __repr__(self) -> str:
        return tabular.text(*self._table())

    def _repr_html_(self) -> str:
        """HTML that notebooks show."""
        return tabular.titled(*self._table())

    def _table(self) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]]:
        """Every output with the smallest, mean and largest value of the runs that have one."""
        failed = f", {len(self.failures)} of them did not reach the end" * bool(self.failures)
        how = (f", one by one: {self.why_one_by_one}" if self.why_one_by_one else
               f", {self.in_lanes} of them eight at a time")
        title = f"{tabular.counted(self.runs, 'run')}{failed}, {self.seconds:.3g} s{how}"
        rows = []
        for name, value in self.values.items():
            known = value[np.isfinite(value)]
            numbers = [f"{known.min():.6g}", f"{known.mean():.6g}", f"{known.max():.6g}"] if (
                known.size) else ["-"] * 3
            rows.append((name, f"({', '.join(map(str, value.shape))})", *numbers))
        return title, ("output", "shape", "smallest", "mean", "largest"), rows

    def __getitem__(self, name: str) -> NDArray:
        """An output by name.

        Raises
        ------
        InputError
            No output has this name.
        """
        if not isinstance(name, str) or name not in self.values:
            raise unknown("output", name, self.values)
        return self.values[name]

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.reached)

    @property
    def done(self) -> NDArray:
        """The runs that reached the end, (runs,) of bool."""
        found = np.ones(self.runs, dtype=bool)
        found[list(self.failures)] = False
        return found
