"""Checks of names, other texts and paths of files."""

import os
from collections.abc import Sequence
from pathlib import Path
from stat import S_ISDIR
from typing import Any

from sebody.basics.errors import InputError
from sebody.basics.inputs.refusals import refusal, shown

LONGEST_NAME = 200      # characters: names are parts of lines that are printed
LONGEST_TEXT = 2000     # of titles and the like


def name(value: Any, what: str) -> str:
    """A name of something: a text of visible characters that is not empty.

    Raises
    ------
    InputError
        Anything else, or more than `LONGEST_NAME` characters.
    """
    if not (isinstance(value, str) and value.strip() and value.isprintable()):
        raise refusal(what, value, "give a text that is not empty")
    if len(value) > LONGEST_NAME:
        raise refusal(what, value, f"it has {len(value)} characters, give at most {LONGEST_NAME}")
    return str(value)


def text(value: Any, what: str) -> str:
    """A text of visible characters on one line, perhaps empty.

    Raises
    ------
    InputError
        Anything else, or more than `LONGEST_TEXT` characters.
    """
    if not (isinstance(value, str) and value.isprintable()):
        raise refusal(what, value, "give a text of one line")
    if len(value) > LONGEST_TEXT:
        raise refusal(what, value, f"it has {len(value)} characters, give at most {LONGEST_TEXT}")
    return str(value)


def path(value: Any, what: str, suffixes: Sequence[str] = ()) -> Path:
    """The path of a file, which need not exist.

    Parameters
    ----------
    what : str
        What the file is, for the message.
    suffixes : sequence of str
        Endings it may have; any by default.

    Raises
    ------
    InputError
        No path, another ending, a folder, or a name that no file can have.
    """
    if not (isinstance(value, str | os.PathLike) and isinstance(os.fspath(value), str)
            and os.fspath(value).strip()):
        raise refusal(what, value, "give the path of a file")
    file = Path(value)
    if suffixes and file.suffix not in suffixes:
        raise InputError(f"{what} {file} must end in {', '.join(suffixes)}")
    try:
        is_folder = S_ISDIR(os.stat(file).st_mode)
    except (FileNotFoundError, NotADirectoryError):     # files to be written: `check_target`
        return file
    except (OSError, ValueError) as error:      # too long, a loop of links, a zero character
        raise InputError(f"{what} {shown(str(file))} cannot be a file ({error}): give another "
                         "path") from error
    if is_folder:
        raise InputError(f"{what} {file} is a folder: give the path of a file")
    return file
