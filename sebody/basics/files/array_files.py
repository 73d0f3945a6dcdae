"""Files of named arrays, npz or HDF5, open."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sebody.basics.errors import InputError
from sebody.basics.files import archive, hdf5
from sebody.basics.files.members import LONGEST_TEXT, Reader
from sebody.basics.files.reading import existing, parsed, unreadable


@contextmanager
def opened(path: str | Path, what: str, remedy: str, suffixes: Sequence[str] = (),
           group: str = "") -> Iterator[Reader]:
    """A file of named arrays, open; whatever goes wrong with it is said of it.

    Parameters
    ----------
    what : str
        What the file is, for messages.
    remedy : str
        What to do with a file of another kind.
    suffixes : sequence of str
        Endings it may have; any by default.
    group : str
        The members that are looked at; all by default. Of a group, the file may be HDF5.

    Raises
    ------
    InputError
        No such file, or one that is damaged or of another kind.
    """
    file = existing(path, what, remedy, suffixes)
    try:
        with (hdf5.opened(file, group) if group and hdf5.is_hdf5(file) else
              archive.opened(file, group and group + "/")) as reader:
            yield reader
    except InputError as error:
        if file.stem in str(error):
            raise
        raise InputError(f"{what} {path}: {error}") from error
    except OSError as error:
        raise unreadable(path, what, error, remedy) from error
    except (ValueError, KeyError, IndexError, TypeError, AttributeError) as error:
        raise InputError(f"{path} is damaged or no {what}: {remedy} ({_said(error)})") from error


def json_of(reader: Reader, name: str) -> Any:
    """Contents of a member that is a JSON text.

    Raises
    ------
    ValueError
        There is no such member, or it is none.
    """
    header = reader.headers.get(name)
    if header is None or header.dtype.kind != "U" or header.shape or header.size > LONGEST_TEXT:
        raise ValueError(f"no text {name}")
    return parsed(str(reader.read(name)))


def _said(error: Exception) -> str:
    """A message on one line, not long."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 120 else text[:117] + "..."
