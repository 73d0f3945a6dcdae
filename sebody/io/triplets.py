"""Matrices written as rows of row, column, value, counted from 1."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.fem.matrices import unsymmetric_entry
from sebody.io.text import fault, table, whole


def read_triplets(path: Path, size: int, what: str, remedy: str,
                  rows_of: str) -> sparse.csc_array:
    """A symmetric matrix (size, size) from a file with one triangle of it.

    Parameters
    ----------
    what : str
        What the file is, for messages.
    rows_of : str
        What states the number of rows, for messages.

    Raises
    ------
    InputError
        A line that is no entry of such a matrix, rows beyond `size`, entries on both sides of
        the diagonal or twice, or diagonal entries that are missing, as of a file cut off.
    """
    entries = table(path, 3, what, remedy)
    beyond = entries[:, :2].max(axis=1) > size
    if beyond.any():
        line = int(np.argmax(beyond))
        raise fault(path, line + 1, f"row {entries[line, :2].max():g}, but {rows_of} lists {size}",
                    "give files of one run of the program")
    # indices of 32 bits: those of 64 make products of such matrices with others slower
    rows, columns = (whole(entries[:, k], path, size, "row or column", remedy).astype(np.int32)
                     for k in (0, 1))
    values = entries[:, 2].copy()
    del entries
    diagonal = np.zeros(size, dtype=bool)
    diagonal[rows[rows == columns] - 1] = True
    mixed = (rows < columns).any() and (rows > columns).any()
    if mixed or not diagonal.all():
        _check_entries(path, rows.astype(int), columns.astype(int), size, remedy)
    try:
        return symmetric(rows - 1, columns - 1, values, size)
    except WrongEntry:
        _check_entries(path, rows.astype(int), columns.astype(int), size, remedy)
        raise


def _check_entries(path: Path, rows: NDArray, columns: NDArray, size: int, remedy: str) -> None:
    above, below = rows < columns, rows > columns
    if above.any() and below.any():
        line = int(np.argmax(below if above[np.argmax(above | below)] else above))
        raise fault(path, line + 1, f"entry ({rows[line]}, {columns[line]}) is in the other "
                    "triangle than those before it", "export one triangle of the matrix")
    places = rows * (size + 1) + columns
    order = np.argsort(places, kind="stable")
    twice = np.flatnonzero(np.diff(places[order]) == 0)
    if len(twice):
        line = int(order[twice + 1].min())
        raise fault(path, line + 1, f"entry ({rows[line]}, {columns[line]}) occurs twice", remedy)
    missing = np.setdiff1d(np.arange(1, size + 1), rows[rows == columns])
    if len(missing):
        raise InputError(f"{path}: row {missing[0]} of {size} has no diagonal entry, the file is "
                         f"cut off or of another run: {remedy}")


class WrongEntry(ValueError):
    """An entry that a symmetric matrix cannot have beside the others.

    Parameters
    ----------
    message : str
    entry : int
        Its number, from 0.
    """

    def __init__(self, message: str, entry: int):
        super().__init__(message)
        self.entry = entry


def symmetric(rows: NDArray, columns: NDArray, values: NDArray, size: int) -> sparse.csc_array:
    """A matrix from the entries of one triangle, or of both, counted from 0.

    If any two entries are mirror images of each other, both triangles are there: they are to be
    equal, as `fe_matrix` compares them, and entries left out are zero. Else each entry stands for
    its mirror image, on whichever side of the diagonal it is.

    Raises
    ------
    WrongEntry
        A place that occurs twice, or an entry unlike its mirror image.
    """
    matrix = sparse.csc_array(sparse.coo_array((values, (rows, columns)), shape=(size, size)))
    if matrix.nnz < len(values):
        places = rows.astype(np.int64) * size + columns
        order = np.argsort(places, kind="stable")
        entry = int(order[1:][np.diff(places[order]) == 0].min())
        raise WrongEntry("occurs twice", entry)
    if not _overlap(rows, columns, size):
        off = rows != columns
        entries = np.concatenate([values, values[off]])
        places = (np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]]))
        return sparse.csc_array(sparse.coo_array((entries, places), shape=(size, size)))
    unlike = unsymmetric_entry(matrix)
    if unlike is None:
        return sparse.csc_array((matrix + matrix.T) / 2)
    there = ((rows == unlike[0]) & (columns == unlike[1])
             | (rows == unlike[1]) & (columns == unlike[0]))
    entry = int(np.flatnonzero(there)[-1])
    i, j = int(rows[entry]), int(columns[entry])
    raise WrongEntry(f"is {matrix[i, j]:.6g} here and {matrix[j, i]:.6g} across the diagonal",
                     entry)


def _overlap(rows: NDArray, columns: NDArray, size: int) -> bool:
    """Tell whether any two places are mirror images."""
    above, below = rows < columns, rows > columns
    if not (above.any() and below.any()):
        return False
    off = above | below
    pattern = sparse.csc_array((np.ones(off.sum(), dtype=np.int8), (rows[off], columns[off])),
                               shape=(size, size))
    return bool(pattern.multiply(pattern.T).nnz)
