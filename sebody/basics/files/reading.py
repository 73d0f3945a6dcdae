"""The way in for every file that a user gives: a regular file, of a size that fits into memory.

Pipes and devices are refused, which would wait or never end; readers of other packages, which open
files themselves, are called by `called`.
"""

import json
import os
from codecs import BOM_UTF8
from collections.abc import Callable, Sequence
from pathlib import Path
from stat import S_ISREG
from typing import Any, TypeVar

from sebody.basics import inputs, memory
from sebody.basics.errors import InputError

LINES = 12          # memory of a text's lines and words, relative to its file
DEEPEST = 100       # brackets within brackets of a JSON text

Found = TypeVar("Found")


def existing(path: str | os.PathLike, what: str, remedy: str,
             suffixes: Sequence[str] = ()) -> Path:
    """The path of a regular file that can be read.

    Parameters
    ----------
    what : str
        What the file is, for the message.
    remedy : str
        What to do without it.
    suffixes : sequence of str
        Endings it may have; any by default.

    Raises
    ------
    InputError
        No path, no file, a folder, a pipe or a device, or a file that cannot be read.
    """
    file = inputs.path(path, what, suffixes)
    try:
        kind = os.stat(file).st_mode
    except (FileNotFoundError, NotADirectoryError) as error:
        raise InputError(f"{what} {path} does not exist: {remedy}") from error
    if not S_ISREG(kind):
        raise InputError(f"{what} {path} is a pipe or a device: give the path of a file")
    try:
        file.open("rb").close()
    except OSError as error:
        raise unreadable(path, what, error, remedy) from error
    return file


def unreadable(path: str | os.PathLike, what: str, error: OSError, remedy: str) -> InputError:
    """The exception for a file that the system does not let us read."""
    return InputError(f"{what} {path} cannot be read ({error.strerror or error}): {remedy}")


def content(path: str | os.PathLike, what: str, remedy: str, suffixes: Sequence[str] = (),
            times: int = 2) -> bytes:
    """The bytes of a file.

    Parameters
    ----------
    what, remedy, suffixes
        As for `existing`.
    times : int
        Memory that is needed, relative to the file's size.

    Raises
    ------
    InputError
        See `existing`, or a file that does not fit into memory.
    """
    file = existing(path, what, remedy, suffixes)
    try:
        memory.check(times * file.stat().st_size, f"{what} {path}", "give a smaller file, or use "
                     "a machine with more memory")
        return file.read_bytes()
    except OSError as error:
        raise unreadable(path, what, error, remedy) from error


def text(path: str | os.PathLike, what: str, remedy: str) -> str:
    """The text of a file, whose line ends may be those of any system.

    Raises
    ------
    InputError
        See `content`.
    """
    read = content(path, what, remedy, times=LINES)
    decoded = read.removeprefix(BOM_UTF8).decode("latin-1")
    return decoded.replace("\r\n", "\n").replace("\r", "\n")


def parsed(json_text: str) -> Any:
    """Contents of a JSON text.

    Raises
    ------
    ValueError
        It is none, or brackets are nested deeper than `DEEPEST`.
    """
    try:
        content = json.loads(json_text)
    except RecursionError as error:
        raise ValueError(f"brackets are nested deeper than {DEEPEST}") from error
    level: list = [content]
    for _ in range(DEEPEST):
        level = [inner for one in level if isinstance(one, list | dict)
                 for inner in (one.values() if isinstance(one, dict) else one)]
        if not level:
            return content
    raise ValueError(f"brackets are nested deeper than {DEEPEST}")


def called(function: Callable[[], Found], path: Path, remedy: str) -> Found:
    """Result of a reader of another package; whatever it raises is said of the file.

    Raises
    ------
    InputError
        The reader fails.
    """
    try:
        return function()
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror or error}): {remedy}"
                         ) from error
    except Exception as error:      # of many classes, of files that are cut off or of other kinds
        raise InputError(f"{path} is damaged or of another kind ({type(error).__name__}: {error}): "
                         f"{remedy}") from error
