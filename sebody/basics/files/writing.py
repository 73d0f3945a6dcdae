"""Files that are written: checked before anything is computed for them, and never half written."""

import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO
from uuid import uuid4
from zlib import crc32

from sebody.basics import inputs
from sebody.basics.errors import InputError, WriteError

LEFT = 3600.0           # seconds since something was written to a file that nobody completes


def check_target(path: str | Path, what: str, suffixes: tuple[str, ...] = ()) -> Path:
    """The path of a file to write, refused before anything is computed for it.

    Parameters
    ----------
    what : str
        What the file is, for the message.
    suffixes : tuple of str
        Endings it may have; any by default.

    Raises
    ------
    InputError
        No path, see `inputs.path`; a folder that does not exist or cannot be written, or
        something at the path that is no file or is write-protected.
    """
    path = inputs.path(path, what, suffixes)
    if not path.parent.is_dir():
        raise InputError(f"folder {path.parent} of the {what} does not exist: make it")
    if path.exists() and not path.is_file():
        raise InputError(f"{what} {path} is a device: give the path of a file")
    part = _beside(path.resolve())
    try:
        if path.exists():
            path.open("r+b").close()        # may be protected in a folder that is not
        part.touch()
        part.unlink()
    except OSError as error:
        raise InputError(f"{what} {path} cannot be written ({error.strerror}): give another "
                         "path") from error
    return path


@contextmanager
def replacing(path: str | Path, what: str) -> Iterator[BinaryIO]:
    """An open file that takes the place of the one at `path` when it is complete.

    It is written beside it and renamed. Whatever happens before, an error, a full disk, the end of
    the process, leaves the older file as it is.

    Parameters
    ----------
    what : str
        What the file is, for the message.

    Raises
    ------
    WriteError
        The file cannot be written.
    """
    path = Path(path).resolve()         # a link stays a link
    part = _beside(path)
    _sweep(path)
    try:
        with part.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())     # some file systems report a full disk only here
        if path.exists():
            shutil.copymode(path, part)
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        older = "; the older file is unchanged" if path.exists() else ""
        raise WriteError(f"the {what} {path} cannot be written: {error.strerror or error}"
                         f"{older}") from error
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def _beside(path: Path) -> Path:
    """A new name in the folder of a file, not longer than names may be."""
    return path.with_name(f"{_prefix(path)}{uuid4().hex[:16]}.part")


def _prefix(path: Path) -> str:
    """Beginning of names of unfinished files of a path."""
    return f".sebody-{crc32(path.name.encode()):08x}-"


def _sweep(path: Path) -> None:
    """Remove unfinished files of this path that were left long ago by a process that was killed."""
    try:
        for part in path.parent.glob(f"{_prefix(path)}*.part"):
            if time.time() - part.stat().st_mtime > LEFT:
                part.unlink(missing_ok=True)
    except OSError:         # another process removes it, or the folder cannot be listed
        return
