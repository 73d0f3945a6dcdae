"""Text files of FE programs: tables of numbers, and errors that name file and line."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files.reading import text as read_text

_BLOCK = 1 << 20        # bytes


def fault(path: Path, line: int, what: str, remedy: str) -> InputError:
    """The exception for a line that cannot be used; lines count from 1."""
    return InputError(f"{path}, line {line}: {what}: {remedy}")


def table(path: Path, columns: int, what: str, remedy: str) -> NDArray:
    """Rows of so many finite numbers, (n, columns), separated by blanks.

    Raises
    ------
    InputError
        The file cannot be read, is empty, ends within a line, or has another line, which the
        message names.
    """
    rows = regular_table(path, columns)
    if rows is not None:
        return rows
    text = read_text(path, what, remedy)
    values = text.replace("D", "E").replace("d", "e").split()
    try:
        rows = np.array(values, dtype=float)
    except ValueError as error:
        raise _worst_line(path, text, columns, remedy) from error
    if len(rows) % columns or len(text.splitlines()) * columns != len(rows) or not (
            np.isfinite(rows).all()):
        raise _worst_line(path, text, columns, remedy)
    if not len(rows):
        raise InputError(f"{what} {path} is empty: {remedy}")
    if not text.endswith("\n"):
        raise fault(path, len(text.splitlines()), "the file ends within a line", remedy)
    return rows.reshape(-1, columns)


def regular_table(path: Path, columns: int, delimiter: str | None = None) -> NDArray | None:
    """The rows (n, columns) of a file of plain numbers alone, read without its text in memory.

    None of a file in which anything is unusual: a line without these columns, an exponent with D, a
    comment, an end within a line. Then the file is to be read line by line.
    """
    if not path.is_file():
        return None
    try:
        with path.open("rb") as stream:
            lines, last = 0, b""
            while block := stream.read(_BLOCK):
                lines, last = lines + block.count(b"\n"), block[-1:]
        if last != b"\n":
            return None
        rows = np.loadtxt(path, comments=None, ndmin=2, delimiter=delimiter)
    except (OSError, ValueError):
        return None
    regular = rows.shape == (lines, columns) and np.isfinite(rows).all()
    return rows if regular else None


def _worst_line(path: Path, text: str, columns: int, remedy: str) -> InputError:
    """The first line that is not a row of finite numbers."""
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        words = line.replace("D", "E").replace("d", "e").split()
        try:
            right = len(words) == columns and np.isfinite(np.array(words, dtype=float)).all()
        except ValueError:
            right = False
        if not right:
            return fault(path, number, f"{inputs.shown(line)} is not a row of {columns} finite "
                         "numbers", remedy)
    return fault(path, len(lines), "the file cannot be read", remedy)


def whole(values: NDArray, path: Path, most: int | None, what: str, remedy: str,
          first_line: int = 1) -> NDArray:
    """A column of whole numbers from 1 to `most`, one a line.

    Raises
    ------
    InputError
        Another number; the message names its line.
    """
    wrong = (values != np.floor(values)) | (values < 1)
    if most is not None:
        wrong |= values > most
    if wrong.any():
        k = int(np.argmax(wrong))
        upto = "" if most is None else f" to {most}"
        raise fault(path, first_line + k, f"{what} {values[k]:g} is not a number from 1{upto}",
                    remedy)
    return values.astype(int)


def first_repeated(items: Sequence) -> tuple[int, int] | None:
    """Places of the first item that occurred before: there and here; None if all differ."""
    seen: dict = {}
    for k, item in enumerate(items):
        if item in seen:
            return seen[item], k
        seen[item] = k
    return None
