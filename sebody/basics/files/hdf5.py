"""HDF5 files likewise: what a group holds is known before its datasets are read (extra ``hdf5``).
"""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files.members import Header

SIGNATURE = b"\x89HDF\r\n\x1a\n"
# what stands before a file of ours, in the room that HDF5 leaves to users
GUARD, SIZE = b"sebody, HDF5 from byte 512 on, crc32 ", 512
BLOCK = 2**20       # bytes that are read at a time


def guarded(content: bytearray) -> bytearray:
    """A file with a user block, in which the checksum of the rest is entered."""
    text = GUARD + b"%08x\n" % zlib.crc32(memoryview(content)[SIZE:])
    content[:SIZE] = text.ljust(SIZE, b"\n")
    return content


def is_hdf5(path: Path) -> bool:
    """Tell whether a file is one, whatever its name is.

    The library may not end over a damaged file, so files of ours have a checksum.

    Raises
    ------
    OSError
        It cannot be read.
    ValueError
        It is one of ours, and not as it was written.
    """
    with path.open("rb") as file:
        begin = file.read(SIZE)
        if not begin.startswith(GUARD):
            return begin.startswith(SIGNATURE)
        signature = 0
        while block := file.read(BLOCK):
            signature = zlib.crc32(block, signature)
    if begin[len(GUARD):len(GUARD) + 8] != b"%08x" % signature:
        raise ValueError("its checksum is not that of its content: damaged, or changed by another "
                         "program")
    return True


class Group:
    """The datasets of an open group.

    Parameters
    ----------
    group : h5py.Group

    Raises
    ------
    ValueError
        A member that is not a dataset of this file.
    """

    def __init__(self, group):
        import h5py

        self._group = group
        self.headers: dict[str, Header] = {}
        for name in group:
            plain = isinstance(group.get(name, getlink=True), h5py.HardLink)
            found = group[name] if plain else None
            if not isinstance(found, h5py.Dataset) or found.is_virtual or found.external:
                raise ValueError(f"member {name} is not a dataset of this file")
            text = h5py.check_string_dtype(found.dtype) is not None
            self.headers[name] = Header(found.shape, np.dtype("U") if text else found.dtype)

    def read(self, name: str) -> NDArray:
        """A dataset; texts as arrays of numpy."""
        dataset = self._group[name][()]
        return np.array(dataset.decode()) if isinstance(dataset, bytes) else np.asarray(dataset)


@contextmanager
def opened(path: Path, group: str) -> Iterator[Group]:
    """A group of an HDF5 file, open.

    Raises
    ------
    InputError
        h5py is missing.
    ValueError
        The file is damaged, or has no such group.
    """
    try:
        import h5py
    except ImportError as error:
        raise InputError('HDF5 files need h5py: pip install "sebody[hdf5]"') from error
    try:
        with h5py.File(path, "r") as file:
            yield Group(file[group])
    except InputError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, OverflowError,
            MemoryError) as error:
        raise ValueError(str(error) or type(error).__name__) from error
