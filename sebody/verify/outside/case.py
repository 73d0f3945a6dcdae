"""Parts of a case of others, and the rule of its tolerances.

The tolerance of a number is the least of a share of the source's own, by default a tenth, where its
number is converged, and ten times the difference at twice the division: finer elements, more bodies
or shorter steps. It is not below half a unit of the last digit that is printed, nor below rounding.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from json import loads
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from sebody.basics.errors import SebodyError

AT_TWICE = Path(__file__).with_name("at_twice.json")
TIMES = 10.0            # the difference at twice the division
ROUNDING = 1e-9         # of closed forms, whose differences are those of iterations


@dataclass(frozen=True)
class Quantity:
    """A number of others.

    Attributes
    ----------
    name : str
        What it is, where and when.
    reference : float
        The number.
    scale : float, optional
        Of differences, in the unit of the number; by default its size.
    printed : float
        Half a unit of the last digit of the reference, or what its authors say of its error.
    source_tolerance : float, optional
        What the source accepts, relative to the scale.
    share : float
        Of the source's tolerance.
    group : str
        Numbers whose differences at twice the division are one, the largest.
    """

    name: str
    reference: float
    scale: float | None = None
    printed: float = 0.0
    source_tolerance: float | None = None
    share: float = 0.1
    group: str = ""

    def difference(self, value: float) -> float:
        """Size of the difference of a value from the reference, by the scale."""
        return abs(value - self.reference) / self.size

    @property
    def size(self) -> float:
        """The scale of differences."""
        return self.scale or abs(self.reference)

    def tolerance(self, at_twice: float) -> float:
        """The tolerance, from the difference at twice the division."""
        own = TIMES * at_twice
        if self.source_tolerance is not None:
            own = min(own, self.share * self.source_tolerance)
        return max(own, self.printed / self.size, ROUNDING)


@dataclass(frozen=True)
class Case:
    """A case: its source, its numbers, and what computes them.

    Attributes
    ----------
    title, source : str
        The source names files, tables or pages.
    measure : callable
        Values by the names of the quantities; its arguments are the division, 1 or 2, and whether
        all quantities are wanted or those alone that take little time.
    quantities : tuple of Quantity
    note : str
        Which model or edition the numbers are of, and what does not agree.
    """

    title: str
    source: str
    measure: Callable[[int, bool], Mapping[str, float]]
    quantities: tuple[Quantity, ...]
    note: str = ""


class Row(NamedTuple):
    """A number of a case beside what was computed; differences are relative to its scale."""

    case: str
    source: str
    quantity: str
    reference: float
    value: float
    difference: float
    tolerance: float
    source_tolerance: float | None
    seconds: float          # of the whole case

    @property
    def passed(self) -> bool:
        """Tell whether the difference is within the tolerance, and a number."""
        return self.difference <= self.tolerance


@lru_cache(1)
def at_twice() -> dict[str, dict[str, float]]:
    """Differences at twice the division, by cases and quantities."""
    return loads(AT_TWICE.read_text())


def rows(name: str, case: Case, whole: bool = True, division: int = 1) -> list[Row]:
    """Measure a case.

    Raises
    ------
    SebodyError
        A quantity without a difference at twice the division.
    """
    began = perf_counter()
    values = case.measure(division, whole)
    seconds = perf_counter() - began
    twice = at_twice().get(name, {})
    groups: dict[str, float] = {}
    for one in case.quantities:
        if division == 1 and one.name not in twice:
            raise SebodyError(f"case {name}: {one.name!r} has no difference at twice the "
                                  f"division in {AT_TWICE.name}")
        key = one.group or one.name
        groups[key] = max(groups.get(key, 0.0), twice.get(one.name, 0.0))
    return [Row(name, case.source, one.name, one.reference, float(values[one.name]),
                one.difference(values[one.name]), one.tolerance(groups[one.group or one.name]),
                one.source_tolerance, seconds)
            for one in case.quantities if one.name in values]
