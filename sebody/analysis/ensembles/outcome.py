"""What many runs gave."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.errors import InputError


@dataclass
class Outcome:
    """What runs gave.

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
    """

    values: dict[str, NDArray]
    t: NDArray
    reached: NDArray
    failures: dict[int, str] = field(default_factory=dict)
    interrupted: bool = False
    seconds: float = 0.0

    def __getitem__(self, name: str) -> NDArray:
        """An output by name.

        Raises
        ------
        InputError
            No output has this name.
        """
        if not isinstance(name, str) or name not in self.values:
            raise InputError(f"output {inputs.shown(name)} is unknown: there are "
                             f"{', '.join(self.values)}")
        return self.values[name]

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.reached)

    @property
    def done(self) -> NDArray:
        """Which of the runs reached the end, (runs,)."""
        found = np.ones(self.runs, dtype=bool)
        found[list(self.failures)] = False
        return found
