"""Numbers in CSV files: columns by their names, or rows of numbers."""

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files.reading import existing, unreadable


def csv_columns(path: Path, what: str) -> dict[str, list[float]]:
    """Columns of a CSV file with a line of names; commas, semicolons or tabs are between them.

    Raises
    ------
    InputError
        A file that cannot be read, or a row without a number for each column.
    """
    lines, between = _lines(path, what, "a line of names and rows of numbers")
    names, *rows = csv.reader(lines, delimiter=between)
    numbers = _numbers(rows, len(names), path, what, between)
    return dict(zip(names, numbers.T.tolist(), strict=True))


def csv_rows(path: Path, what: str, columns: int) -> NDArray:
    """Rows of numbers, (n, columns), of a CSV file, below a line of names or not.

    Raises
    ------
    InputError
        A file that cannot be read, or a row without this count of numbers.
    """
    lines, between = _lines(path, what, f"rows of {columns} numbers")
    first, *rows = csv.reader(lines, delimiter=between)
    try:
        _numbers([first], columns, path, what, between)
    except InputError:
        if _are_numbers(first):     # of another count: no names
            raise
    else:
        rows = [first, *rows]
    return _numbers(rows, columns, path, what, between)


def _lines(path: Path, what: str, content: str) -> tuple[list[str], str]:
    """Lines that are neither empty nor remarks, and what is between their entries."""
    file = existing(path, f"{what}: file", "give the path of a CSV file")
    try:
        lines = [line for line in file.read_text(encoding="utf-8-sig").splitlines()
                 if line.strip() and not line.lstrip().startswith("#")]
    except (OSError, UnicodeDecodeError) as error:
        if isinstance(error, OSError):
            raise unreadable(path, f"{what}: file", error, "give a text file") from error
        raise InputError(f"{what}: file {path} is no text: give a CSV file") from error
    if not lines:
        raise InputError(f"{what}: file {path} is empty: give {content}")
    return lines, max(",;\t", key=lines[0].count)


def _numbers(rows: list[list[str]], columns: int, path: Path, what: str, between: str) -> NDArray:
    found = np.zeros((len(rows), columns))
    for place, row in zip(found, rows, strict=True):
        if len(row) != columns or not _are_numbers(row):
            raise InputError(f"{what}: file {path} has the row {between.join(row)!r}, which has "
                             f"no number for each of the {columns} columns")
        place[:] = [float(value) for value in row]
    return found


def _are_numbers(row: list[str]) -> bool:
    try:
        return bool([float(value) for value in row])
    except ValueError:
        return False
