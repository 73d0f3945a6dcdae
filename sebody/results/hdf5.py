"""Results as HDF5 files (extra ``hdf5``): a dataset for each history, with its unit in words.

Arrays are written by blocks of rows, packed. The group ``sebody`` holds what a `Result` needs.
"""

from collections.abc import Mapping
from importlib.util import find_spec
from io import BytesIO
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files.hdf5 import SIZE, guarded
from sebody.basics.version import __version__

SUFFIX = ".h5"
BLOCK = 2**16       # numbers of a block
SMALL = 100         # numbers of an array that is not packed


def check_installed() -> None:
    """Refuse files that cannot be written or read.

    Raises
    ------
    InputError
        h5py is missing.
    """
    if find_spec("h5py") is None:
        raise InputError('HDF5 files need h5py: pip install "sebody[hdf5]", or take a file .npz')


def write(file: BinaryIO, members: Mapping[str, NDArray], units: Mapping[str, str],
          attributes: Mapping[str, str]) -> None:
    """Write arrays and texts by name; of a name with a slash the part before it is a group.

    The packed file is made in memory: on a full disk the library prints several pages.

    Parameters
    ----------
    units : mapping of str
        Units in words of some of the arrays.
    attributes : mapping of str
        Of the whole file.

    Raises
    ------
    OSError
        Writing fails.
    """
    import h5py

    memory = BytesIO()
    with h5py.File(memory, "w", userblock_size=SIZE) as made:
        made.attrs.update({**attributes, "program": f"sebody {__version__}"})
        for name, values in members.items():
            _write(made, name, np.asarray(values), units.get(name))
    file.write(guarded(bytearray(memory.getbuffer())))


def _write(file: Any, name: str, values: NDArray, unit: str | None) -> None:
    """One dataset."""
    if values.dtype.kind == "U":
        file[name] = str(values)
        return
    packed = {}
    if values.ndim and values.size > SMALL:
        rows = max(1, min(len(values), BLOCK // max(values[0].size, 1)))
        packed = {"chunks": (rows, *values.shape[1:]), "compression": "gzip",
                  "compression_opts": 1, "shuffle": True}
    made = file.create_dataset(name, shape=values.shape, dtype=values.dtype, **packed)
    if not packed:
        made[...] = values
    else:
        for first in range(0, len(values), rows):
            made[first:first + rows] = values[first:first + rows]
    if unit is not None:
        made.attrs["units"] = unit
