"""Finding of one case of the atlas: theory, measurement, what the program does, and a picture."""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from numpy.typing import ArrayLike

THEORY = "theory"           # derived, in `theory` or in the case itself
REFERENCE = "reference"     # of another program, see `sebody.verify.references`
PROGRAM = "program"         # what the program is to do there


class Row(NamedTuple):
    """A number with its prediction and its measurement; infinity for what never happens."""

    what: str
    expected: float
    measured: float
    within: float           # allowed difference, relative unless zero is expected
    source: str = THEORY    # of the expected number

    @property
    def passed(self) -> bool:
        """Tell whether they agree."""
        if math.isinf(self.expected):
            return self.measured == self.expected
        return abs(self.measured - self.expected) <= self.within * (abs(self.expected) or 1.0)


@dataclass
class Finding:
    """A case: each row is one number known beforehand."""

    title: str
    line: str               # what its picture shows, in a line
    theory: str             # what it says
    program: str            # what sebody does there
    xlabel: str
    ylabel: str
    rows: list[Row] = field(default_factory=list)
    curves: dict[str, tuple[ArrayLike, ArrayLike]] = field(default_factory=dict)
    logarithmic: str = ""   # axes, "x", "y" or "xy"
    predicted: list[str] = field(default_factory=list)      # curves of theory, drawn dashed

    def predict(self, label: str, x: ArrayLike, y: ArrayLike) -> None:
        """Add a curve that theory or another program gives."""
        self.curves[label] = x, y
        self.predicted.append(label)
