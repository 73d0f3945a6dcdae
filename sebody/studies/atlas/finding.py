"""What one case of the atlas says: theory, measurement, what the program does, and a picture."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from numpy.typing import ArrayLike


class Row(NamedTuple):
    """One number that theory predicts and a run shows; infinity where something never happens."""

    what: str
    theory: float
    measured: float
    within: float           # allowed difference, relative unless theory is zero

    @property
    def passed(self) -> bool:
        """Whether they agree."""
        if math.isinf(self.theory):
            return self.measured == self.theory
        return abs(self.measured - self.theory) <= self.within * (abs(self.theory) or 1.0)


@dataclass
class Finding:
    """A case: each row is one prediction."""

    title: str
    theory: str             # what it says
    program: str            # what sebody does there
    xlabel: str
    ylabel: str
    rows: list[Row] = field(default_factory=list)
    curves: dict[str, tuple[ArrayLike, ArrayLike]] = field(default_factory=dict)
    logarithmic: str = ""   # axes, "x", "y" or "xy"
