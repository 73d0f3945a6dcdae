"""Checksums of named arrays: whether a file still holds what was written to it.

Files packed again by another program have right checksums of their own, so those of our files are
kept among their notes.
"""

import zlib
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray


def checksums(arrays: Mapping[str, NDArray]) -> dict[str, int]:
    """A number for each array, by its type, shape and content."""
    return {name: _checksum(np.asarray(array)) for name, array in arrays.items()}


def changed(arrays: Mapping[str, NDArray], noted: Mapping[str, int] | None) -> list[str]:
    """Names of arrays that are not those whose checksums were noted; none without checksums."""
    if not noted:
        return []
    current = checksums(arrays)
    return [name for name in {**noted, **current} if noted.get(name) != current.get(name)]


def _checksum(array: NDArray) -> int:
    kind = array.dtype if array.dtype.kind != "U" else "text"
    data = str(array).encode() if array.dtype.kind == "U" and not array.shape else (
        np.ascontiguousarray(array))
    return zlib.crc32(data, zlib.crc32(f"{kind} {array.shape}".encode()))
