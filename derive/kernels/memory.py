"""Scratch memory and constants of a kernel of bodies: where its arrays are."""

from collections.abc import Iterable
from typing import NamedTuple

from sebody.contract.counts import axes_of
from sebody.contract.layout import Part
from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, Held, constant
from sebody.derive.form.functions import PACKED_ROOM
from sebody.derive.form.statements import Let, Point, Statement
from sebody.derive.form.whole import Applied, Count, Number, Whole, largest, replaced, whole
from sebody.derive.kernels.arguments import ARGUMENTS


class Memory(NamedTuple):
    """Places of scratch arrays, in rows of `counts.row` numbers."""

    rows: int
    squares: int                        # of as many rows as local coordinates, and a margin
    points: tuple[Point, ...]

    @classmethod
    def of(cls, arrays: Iterable[Array]) -> "Memory":
        """Scratch arrays one after the other: single rows, those of several rows, squares."""
        asked = [(array, array.shape[0] if len(array.shape) > 1 else 1)
                 for array in dict.fromkeys(arrays) if array.held is Held.SCRATCH]
        single = [array for array, rows in asked if rows == 1]
        tall = [(array, rows) for array, rows in asked if isinstance(rows, int) and rows > 1]
        squares = [(array, rows) for array, rows in asked if not isinstance(rows, int)]
        first, points = 0, []
        for array, rows in (*((array, 1) for array in single), *tall):
            points.append(Point(array, ARGUMENTS["work"].at(first * counts.row)))
            first += rows
        for k, (array, rows) in enumerate(squares):
            points.append(Point(array, ARGUMENTS["work"].at((first + k * rows) * counts.row)))
        return cls(first, len(squares), tuple(points))


def row_size(squares: int, margin: int) -> Whole:
    """Length of a row of scratch memory: local coordinates, or rotations of the nodes."""
    longest = counts.n + (margin if squares else 0)
    return counts.padded(largest(longest, 9 * counts.ROTATIONS))


def chain(parts: tuple[Part, ...], planar: bool, read: dict[Array, tuple[Let, ...]]
          ) -> tuple[Statement, ...]:
    """Pointers to the constants of an element, one after the other.

    Parameters
    ----------
    read : dict
        Counts that are read from a part, by its array; sizes of parts behind it know them.
    """
    place = ARGUMENTS["index"][counts.first + counts.agreed("AT_CONSTANTS")]
    start, statements = ARGUMENTS["constants"].at(place), []
    for part in parts:
        array = constant(part)
        statements += [Point(array, start), *read.get(array, ())]
        start = array.at(size_of(part, planar))
    return tuple(statements)


def size_of(part: Part, planar: bool) -> Whole:
    """The count of numbers that a part of the constants takes; counts of the space are numbers."""
    known = {Count(name): number for name, number in axes_of(planar).items()}
    sizes = [replaced(Count(size), known) if isinstance(size, str) else whole(size)
             for size in part.shape]
    if part.columns:
        return sizes[1] * counts.padded(sizes[0])
    if part.packed:
        return Applied(PACKED_ROOM, tuple(sizes))
    size: Whole = Number(1)
    for factor in sizes:
        size = size * factor
    return size
