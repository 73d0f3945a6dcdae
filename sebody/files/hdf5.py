"""HDF5 files likewise: what a group holds is known before its datasets are read (extra ``hdf5``).
"""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.files.members import Header

CHECKSUM = "checksum"       # attribute of a text
SIGNATURE = b"\x89HDF\r\n\x1a\n"


def is_hdf5(path: Path) -> bool:
    """Whether a file is one, whatever its name is.

    Raises
    ------
    OSError
        It cannot be read.
    """
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


class Group:
    """The datasets of an open group.

    Parameters
    ----------
    group : h5py.Group

    Raises
    ------
    ValueError
        A member that is no dataset of this file.
    """

    def __init__(self, group):
        import h5py

        self._group = group
        self.headers: dict[str, Header] = {}
        for name in group:
            plain = isinstance(group.get(name, getlink=True), h5py.HardLink)
            found = group[name] if plain else None
            if not isinstance(found, h5py.Dataset) or found.is_virtual or found.external:
                raise ValueError(f"member {name} is no dataset of this file")
            text = h5py.check_string_dtype(found.dtype) is not None
            self.headers[name] = Header(found.shape, np.dtype("U") if text else found.dtype)

    def read(self, name: str) -> NDArray:
        """A dataset; texts as arrays of numpy."""
        dataset = self._group[name]
        found = dataset[()]
        if not isinstance(found, bytes):
            return np.asarray(found)
        if dataset.attrs.get(CHECKSUM, zlib.crc32(found)) != zlib.crc32(found):
            raise ValueError(f"member {name} does not have its checksum")
        return np.array(found.decode())


@contextmanager
def opened(path: Path, group: str) -> Iterator[Group]:
    """A group of an HDF5 file, open.

    Raises
    ------
    ValueError
        The file is damaged, or has no such group.
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            yield Group(file[group])
    except InputError:
        raise
    except (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, OverflowError,
            MemoryError) as error:
        raise ValueError(str(error) or type(error).__name__) from error
