"""Curves of paths that no body draws: cams, slots, rails and approaches on nodes and the ground."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism
from sebody.model.parts import Node, Path
from sebody.model.path_tables import curve
from sebody.pictures.surface import spatial

SAMPLES = 8         # points of a curve between two of its knots
APPROACH = 0.3      # length that is drawn of the ground before and behind a path, of the extent


class PathCurve(NamedTuple):
    """A curve at the start."""

    name: str           # of the path
    carrier: Node
    points: NDArray     # (points, 3), global axes


def path_curves(model: Mechanism, size: float) -> Iterator[PathCurve]:
    """Curves of all paths on nodes and the ground, of a model of this extent."""
    for path in model.paths.values():
        for k, piece in enumerate(path.pieces):
            if isinstance(piece.carrier, Node):
                yield PathCurve(path.name, piece.carrier, spatial(_points(path, k, size)))


def _points(path: Path, k: int, size: float) -> NDArray:
    piece, of = path.pieces[k], curve(path, k)
    first, last = 0.0, float(piece.ways[-1])
    if piece.offset < 0.0:                  # the approach, and below the ground behind the path
        first = max(first, last - APPROACH * size)
    elif piece.offset >= path.length:
        last = min(last, APPROACH * size)
    ways = np.interp(np.arange(SAMPLES * (len(piece.ways) - 1) + 1) / SAMPLES,
                     np.arange(len(piece.ways)), piece.ways)
    inside = ways[(ways > first) & (ways < last)]
    points: NDArray = of(np.concatenate([[first], inside, [last]]))
    return points
