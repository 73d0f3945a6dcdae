"""Positions of the entries of element matrices in the matrix of the system."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sebody.assembly import elimination_pattern
from sebody.assembly.batches import Shape
from sebody.assembly.independent_parts import FEWEST, Parts, independent_parts, whole
from sebody.contract.counts import LANES


def element_scatter(shapes: Iterable[Shape], unused: int) -> tuple[NDArray, NDArray]:
    """Row and column of every entry of the element matrices.

    The row is `unused` where the entry is zero in all states: between the internal modes of a
    superelement whose matrix is diagonal beyond its first rows.
    """
    rows, columns = [], []
    for shape in shapes:
        unknowns = np.array(shape.unknowns, dtype=np.int64)
        row, column = np.empty((2, len(unknowns), shape.width, shape.width), dtype=np.int64)
        row[:], column[:] = unknowns[:, :, None], unknowns[:, None, :]
        if min(shape.full) < shape.width:
            row[_zeros(shape)] = unused
        rows.append(row.ravel())
        columns.append(column.ravel())
    return np.concatenate(rows), np.concatenate(columns)


def _zeros(shape: Shape) -> NDArray:
    """Entries of the matrices of a batch that are zero in all states, (elements, width, width)."""
    inner = np.arange(shape.width) >= np.array(shape.full)[:, None]
    return inner[:, :, None] & inner[:, None, :] & ~np.eye(shape.width, dtype=bool)


def dense_layout(row: NDArray, column: NDArray, n: int) -> tuple[NDArray, dict[str, NDArray]]:
    """Matrix entry of each element entry, and the members of `System` that describe the matrix.

    Entries of fixed coordinates go to one place behind the matrix.
    """
    columns, rows = np.divmod(np.arange(n * n, dtype=np.int32), n)
    none = np.zeros(0, dtype=np.int64)
    return np.where((row < n) & (column < n), column * n + row, n * n), {
        "rows": rows, "columns": columns, "diagonal": np.arange(n) * (n + 1), "padding": none,
        "block_starts": none, "block_rows": none, "block_diagonal": none, "slot_unknowns": none,
        "part_blocks": np.zeros(1, dtype=np.int64), "block_ends": none}


def sparse_layout(row: NDArray, column: NDArray, n: int,
                  groups: NDArray) -> tuple[NDArray, dict[str, NDArray]]:
    """The same as `dense_layout`, in the blocks of an elimination; `groups` as in `Numbering`."""
    free = (row < n) & (column < n)
    parts = _parts(row[free], column[free], n, groups)
    slot, pattern = elimination_pattern.best_slots(row[free], column[free], groups, n, parts)
    slots = LANES * len(pattern.diagonal)
    unknowns = np.full(slots, n)
    unknowns[slot] = np.arange(n)
    rows, columns = elimination_pattern.places(pattern)
    entries = np.full(len(row), len(rows))
    entries[free] = elimination_pattern.entries(pattern, slot[row[free]], slot[column[free]])
    diagonal = elimination_pattern.entries(pattern, np.arange(slots), np.arange(slots))
    firsts = slot[parts.order[parts.firsts]] // LANES
    return entries, {
        "rows": unknowns[rows].astype(np.int32), "columns": unknowns[columns].astype(np.int32),
        "diagonal": diagonal[slot], "padding": diagonal[unknowns == n],
        "block_starts": pattern.starts, "block_rows": pattern.rows,
        "block_diagonal": pattern.diagonal, "slot_unknowns": unknowns, "part_blocks": firsts,
        "block_ends": pattern.before(int(firsts[-1]))}


def _parts(row: NDArray, column: NDArray, n: int, groups: NDArray) -> Parts:
    """The parts of a large elimination."""
    if n < FEWEST:
        return whole(n)
    groups = np.union1d(groups[groups < n], 0)
    of = np.repeat(np.arange(len(groups)), np.diff(groups, append=n))
    return independent_parts(elimination_pattern.filled(of[row], of[column], len(groups)),
                             groups, n)
