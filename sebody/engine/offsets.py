"""Groups of arrays whose numbers lie in one buffer: a copy of it begins a run."""

from collections.abc import Iterator
from dataclasses import fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sebody.contract.counts import CACHE_LINE
from sebody.engine.arrays import Arrays

Group = TypeVar("Group", bound=Arrays)


class Offsets:
    """The places of arrays of floats of some groups in one buffer, by group, member and size.

    Parameters
    ----------
    groups : Arrays
        Members that are views of an earlier member of their group keep being views of it.
    """

    def __init__(self, *groups: Arrays):
        self.size = 0
        self._first: dict[int, int] = {}        # address of an array -> place
        self._sizes: dict[int, int] = {}
        for array in (a for group in groups for a in _floats(group)):
            if array.size and self._within(array) is None:
                self._first[array.ctypes.data] = self.size
                self._sizes[array.ctypes.data] = array.size
                self.size += -(-array.size // CACHE_LINE) * CACHE_LINE

    def of(self, array: NDArray) -> slice:
        """The part of the buffer that an array of the groups has."""
        first = self._within(array) if array.size else 0
        assert first is not None, "an array of another group"
        return slice(first, first + array.size)

    def packed(self, group: Group, buffer: NDArray) -> Group:
        """The same group with its floats in `buffer`, which gets their contents.

        Integers and records of scalars are shared.
        """
        made = {}
        for one in fields(group):
            value = getattr(group, one.name)
            if isinstance(value, Arrays):
                made[one.name] = self.packed(value, buffer)
            elif value.dtype == np.float64:
                view = buffer[self.of(value)].reshape(value.shape)
                view[...] = value
                made[one.name] = view
            else:
                made[one.name] = value
        return type(group)(**made)

    def _within(self, array: NDArray) -> int | None:
        """Place of an array, or of the part of a larger one that it is."""
        address = array.ctypes.data
        if address in self._first:
            return self._first[address]
        for start, first in self._first.items():
            if start <= address < start + 8 * self._sizes[start]:
                return first + (address - start) // 8
        return None


def at_cache_lines(size: int) -> NDArray:
    """Zeros that begin at a whole cache line: vectors of eight numbers are in one line each."""
    room = np.zeros(size + CACHE_LINE)
    first = -room.ctypes.data // room.itemsize % CACHE_LINE
    return room[first:first + size]


def arrays_of(group: Arrays) -> Iterator[NDArray]:
    """The arrays of a group and of the groups in it, in order; records of scalars left out."""
    for one in fields(group):
        value = getattr(group, one.name)
        if isinstance(value, Arrays):
            yield from arrays_of(value)
        elif isinstance(value, np.ndarray):
            yield value


def _floats(group: Arrays) -> Iterator[NDArray]:
    return (array for array in arrays_of(group) if array.dtype == np.float64)


def patterns(group: Arrays) -> Iterator[NDArray]:
    """The arrays of a group that are not of floats, in order: what two models share."""
    return (array for array in arrays_of(group) if array.dtype != np.float64)
