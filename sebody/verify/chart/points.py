"""Points of error against computing time, and the front of those that nothing beats."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


@dataclass(frozen=True)
class Point:
    """A variant with its error and cost, both from the same runs.

    Parameters
    ----------
    family : str
        Points of a family have the same colour and marker.
    label : str
        Its name within the chart.
    error : float
        Relative, never below that of the reference; infinite of a run that failed.
    cost : float
        Computing time of the quickest of several runs, by simulated time or as the chart says [s].
    unknowns : int
    h : float
        Time step.
    iterations : float
        Of Newton a step.
    slowest : float
        Cost of the slowest of these runs; zero of a single one.
    """

    family: str
    label: str
    error: float
    cost: float
    unknowns: int = 0
    h: float = 0.0
    iterations: float = 0.0
    slowest: float = 0.0


class Study(NamedTuple):
    """Contents of a chart.

    Parameters
    ----------
    points : list of Point
    quantity : str
        What is compared.
    error : float
        Of the reference.
    choice : Point, optional
        The advised model; it is one of the points.
    tolerance : float, optional
        Of the advice.
    notes : tuple of str
        What errors and bars are, which peers there are, and why no model is advised.
    """

    points: list[Point]
    quantity: str
    error: float
    choice: Point | None = None
    tolerance: float | None = None
    notes: tuple[str, ...] = ()


def front(points: Iterable[Point]) -> list[Point]:
    """The Pareto front: points that no other beats in both error and cost, cheapest first."""
    best, kept = np.inf, []
    for point in sorted(points, key=lambda p: (p.cost, p.error)):
        if point.error < best:
            kept.append(point)
            best = point.error
    return kept
