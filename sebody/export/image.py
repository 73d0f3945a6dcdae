"""The memory of an instance of an exported model: its arrays in one block of bytes."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple
from zlib import MAX_WBITS, compressobj

import numpy as np
from numpy.typing import NDArray

from sebody.engine.arrays import Arrays

ALIGNED = 64            # bytes: arrays begin at whole cache lines


class _Span(NamedTuple):
    """The place of an array in this process, and in the image."""

    address: int
    size: int
    offset: int


class Image:
    """The arrays of some groups, one after the other.

    First what never changes, then what does; of this last what is zero at the start, which
    libraries need not contain, and scratch memory, which states of instances do not.

    Parameters
    ----------
    groups : list of Arrays
    changing : iterable of ndarray
        Arrays of them that change in a run.
    scratch : sequence of ndarray
        Of these, what is written before it is read.

    Attributes
    ----------
    stored : bytes
        The image without the zeros at its end.
    mutable : int
        Where what changes begins.
    saved : int
        Where scratch memory begins.
    size : int
        Of the whole, with a line to spare that empty arrays begin at.
    """

    def __init__(self, groups: list[Arrays], changing: Iterable[NDArray | np.record],
                 scratch: Sequence[NDArray | np.record]):
        mutable = {_address(array) for array in changing if array.nbytes}
        pieces: dict[int, NDArray | np.record] = {}
        for array in sorted((one for group in groups for one in _members(group)),
                            key=lambda one: -one.nbytes):
            if array.nbytes and not _holding(pieces.values(), array):
                pieces[_address(array)] = array
        zero = {at: not any(bytes_of(array)) for at, array in pieces.items()}
        last = {_address(array) for array in scratch if array.nbytes}
        order = sorted(pieces, key=lambda at: (at in mutable, at in mutable and zero[at],
                                               at in last))
        self._spans: list[_Span] = []
        self.size = 0
        self.mutable = self.saved = -1
        content = bytearray()
        for at in order:
            array = pieces[at]
            if at in mutable and self.mutable < 0:
                self.mutable = self.size
            if at in last and self.saved < 0:
                self.saved = self.size
            self._spans.append(_Span(at, array.nbytes, self.size))
            self.size += -(-array.nbytes // ALIGNED) * ALIGNED
            if at not in mutable or not zero[at]:
                content += bytes_of(array).ljust(-(-array.nbytes // ALIGNED) * ALIGNED, b"\0")
        self.stored = bytes(content)
        self.size += ALIGNED

    @property
    def packed(self) -> bytes:
        """Stored bytes, compressed by deflate: most numbers of reduced bodies are zeros."""
        packer = compressobj(9, wbits=-MAX_WBITS)
        return packer.compress(self.stored) + packer.flush()

    def at(self, array: NDArray | np.record, item: int = 0) -> int:
        """Offset of an array, or of one of its items of eight bytes."""
        if not array.nbytes:
            return self.size - ALIGNED
        address = _address(array)
        span = next(s for s in self._spans if s.address <= address < s.address + s.size)
        return span.offset + address - span.address + 8 * item

    def clear(self, offsets: list[int]) -> None:
        """Set some items of eight bytes to zero."""
        content = bytearray(self.stored)
        for at in offsets:
            content[at:at + 8] = bytes(8)
        self.stored = bytes(content)

    def words(self, group: Arrays) -> list[int]:
        """The words with which compiled code is given a group; pointers as -1 - offset."""
        listed: list[int] = []
        for name in type(group).__annotations__:
            value = getattr(group, name)
            if isinstance(value, Arrays):
                listed += self.words(value)
            elif isinstance(value, np.record):
                listed.append(-1 - self.at(value))
            else:
                listed += [-1 - self.at(value), *value.shape]
        return listed


def _members(group: Arrays) -> Iterator[NDArray | np.record]:
    for name in type(group).__annotations__:
        value = getattr(group, name)
        if isinstance(value, Arrays):
            yield from _members(value)
        else:
            yield value


def members(group: Arrays) -> list[NDArray | np.record]:
    """All arrays and records of scalars of a group."""
    return list(_members(group))


def _address(array: NDArray | np.record) -> int:
    return array.__array_interface__["data"][0]


def _holding(known: Iterable[NDArray | np.record], array: NDArray | np.record) -> bool:
    """Tell whether an array is a part of one that is known."""
    first = _address(array)
    return any(_address(one) <= first and first + array.nbytes <= _address(one) + one.nbytes
               for one in known)


def bytes_of(array: NDArray | np.record) -> bytes:
    """The contents of an array."""
    return array.tobytes()
