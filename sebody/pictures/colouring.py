"""Quantities that colour bodies: their values, and where they are largest."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.units import Units
from sebody.pictures.drawn_bodies import DrawnBody, Undeformed
from sebody.results.units import unit

TITLES = {"displacement": "displacement", "von_mises": "von Mises stress"}
MOST = 1_000_000_000    # products of amplitudes, stations and frames in a search, a second or two
ROUNDING = 1e-12        # of the largest body: smaller displacements are none
AT_ONCE = 200_000       # values of stations that are computed together


class Colouring(NamedTuple):
    """A quantity with its largest value: in which frame, of which body, at which station."""

    name: str
    title: str
    unit: str
    largest: float
    frame: int
    body: int
    station: int


def colourings(bodies: list[DrawnBody], units: Units | None) -> list[Colouring]:
    """The quantities of which some body has values, with their units, in words without units."""
    seen = []
    for name, title in TITLES.items():
        peaks = [(*_peak(body, name), k) for k, body in enumerate(bodies)]
        value, frame, station, body = max(peaks, default=(0.0, 0, 0, 0))
        rounding = 0.0 if name == "von_mises" or not bodies else ROUNDING * max(
            np.ptp(one.surface.points, axis=0).max() for one in bodies)
        if value > rounding:
            seen.append(Colouring(name, title, unit(f"body.{name}", units), value, frame, body,
                                  station))
    return seen


def values_of(body: DrawnBody, name: str, frame: int) -> NDArray | None:
    """Values at the vertices of a body in a frame; None if it has none."""
    if name == "von_mises":
        if body.stress is None:
            return None
        row = min(round(frame / body.stride), len(body.stress) - 1)
        return np.maximum(body.surface.weights @ body.stress[row], 0.0)
    if body.rigid:
        return None
    return np.linalg.norm(body.surface.weights @ _moved(body, [frame])[0], axis=1)


def _peak(body: DrawnBody, name: str) -> tuple[float, int, int]:
    """The largest value of a body, its frame and its station; of large bodies in some frames."""
    if name == "von_mises":
        if body.stress is None:
            return 0.0, 0, 0
        row, station = np.unravel_index(body.stress.argmax(), body.stress.shape)
        return float(body.stress[row, station]), int(row) * body.stride, int(station)
    largest = 0.0, 0, 0
    if body.rigid:
        return largest
    count, stations = body.amplitudes.shape[1], len(body.surface.points)
    frames = np.arange(len(body.amplitudes))
    frames = frames[::-(-len(frames) * stations * count // MOST) or 1]
    at_once = max(1, AT_ONCE // stations)
    for first in range(0, len(frames), at_once):
        some = frames[first:first + at_once]
        lengths = np.linalg.norm(_moved(body, some), axis=2)
        row, station = np.unravel_index(lengths.argmax(), lengths.shape)
        largest = max(largest, (float(lengths[row, station]), int(some[row]), int(station)))
    return largest


def _moved(body: DrawnBody, frames: NDArray | list[int]) -> NDArray:
    """Displacements of the stations in some frames, (frames, stations, 3), in axes of the body."""
    points = body.surface.points
    places = points + np.tensordot(body.amplitudes[frames], body.surface.moves, 1)
    if body.still is None:
        return places - points
    still = Undeformed(body.still.rotation[frames], body.still.shift[frames])
    return places - still.places(points)
