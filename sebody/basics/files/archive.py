"""Files npz: what their members are is known before any of them is unpacked."""

import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tokenize import TokenError
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from sebody.basics import memory
from sebody.basics.errors import InputError
from sebody.basics.files.members import Header

ENDING = ".npy"
ENCRYPTED = 1               # bit of the flags of a member
LONGEST_HEADER = 10_000     # bytes: headers of plain arrays have some hundred
LARGE, TIMES = 2**28, 900   # bytes unpacked, times those packed: larger ones hold nothing but zeros
# what zipfile and numpy raise of files that are damaged
ERRORS = (BadZipFile, zlib.error, ValueError, EOFError, KeyError, IndexError, TypeError,
          NotImplementedError, RuntimeError, OverflowError, SyntaxError, TokenError)


class Archive:
    """An open npz file.

    Parameters
    ----------
    file : ZipFile
    group : str
        Beginning of the names of the members that are looked at, which is left out of them.

    Raises
    ------
    ValueError
        A member that is encrypted, given twice, packed in another way, or no plain array.
    """

    def __init__(self, file: ZipFile, group: str = ""):
        self._file = file
        self._infos: dict[str, ZipInfo] = {}
        self.headers: dict[str, Header] = {}
        own = [info for info in file.infolist() if info.filename.startswith(group)]
        _refuse_bombs(own)
        for info in own:
            name = info.filename.removeprefix(group).removesuffix(ENDING)
            if info.flag_bits & ENCRYPTED:
                raise ValueError(f"member {name} is encrypted")
            if info.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
                raise ValueError(f"member {name} is packed by method {info.compress_type}")
            if name in self._infos:
                raise ValueError(f"member {name} occurs twice")
            self._infos[name] = info
            self.headers[name] = self._header(name, info)

    def _header(self, name: str, info: ZipInfo) -> Header:
        with self._file.open(info) as stream:
            version = npy.read_magic(stream)
            read = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
            if version not in read:
                raise ValueError(f"member {name} is of version {version} of its format")
            shape, _, dtype = read[version](stream, max_header_size=LONGEST_HEADER)
            begin = stream.tell()
        header = Header(shape, dtype)
        if dtype.hasobject or info.file_size != begin + header.size:
            raise ValueError(f"member {name} has {info.file_size - begin} bytes, its header "
                             f"lists {header.size}")
        return header

    def read(self, name: str) -> NDArray:
        """A member; what is unpacked is compared with its checksum."""
        with self._file.open(self._infos[name]) as stream:
            array = npy.read_array(stream, allow_pickle=False)
            if stream.read(1):          # the checksum is compared at the end
                raise ValueError(f"member {name} is longer than its header says")
        return np.asarray(array)


def _refuse_bombs(infos: list[ZipInfo]) -> None:
    whole, packed = (sum(getattr(one, size) for one in infos)
                     for size in ("file_size", "compress_size"))
    if whole > LARGE and whole > TIMES * packed:
        raise ValueError(f"it would unpack to {memory.size(whole)}, {whole // max(packed, 1)} "
                         "times its size")


@contextmanager
def opened(path: Path, group: str = "") -> Iterator[Archive]:
    """An npz file, open; see `Archive`.

    Raises
    ------
    ValueError
        It is damaged or of another kind.
    OSError
        It cannot be read.
    """
    try:
        with ZipFile(path) as file:
            yield Archive(file, group)
    except (InputError, OSError):
        raise
    except ERRORS as error:
        raise ValueError(str(error) or type(error).__name__) from error
