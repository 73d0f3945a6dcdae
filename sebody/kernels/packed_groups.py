"""Groups of strips that matrices are cut into, see `sebody.kernels.packed`."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.counts import LANES

ONCE, BOTH, MIRRORED, COUPLED, MULTIPLE, DIAGONAL = range(6)        # uses of groups
NARROW, WIDE = 4, 8     # columns of a strip
MANY = 3        # strips of one matrix: with fewer, sums of transposed products cost more
LONELY = 4      # blocks on the diagonal with nothing beside it: with fewer, strips cost as little


class Group(NamedTuple):
    """Strips of the same columns, or what makes a multiple: see the table of whole numbers."""

    use: int
    first: int                  # column
    vector: int                 # that they multiply: the first one or the second
    heads: tuple[int, ...]
    entries: NDArray            # (strips, columns, LANES)


def diagonals(stack: NDArray) -> Iterator[Group]:
    """Takes diagonals out of matrices where strips would hold little else, as of normal modes."""
    count, rows, columns = stack.shape
    if rows != columns or rows == 0:
        return
    across, along = rows // LANES, np.arange(rows)
    blocks = stack.reshape(count, across, LANES, across, LANES)[
        :, range(across), :, range(across)].swapaxes(0, 1) != 0.0
    of_diagonal = blocks & np.eye(LANES, dtype=bool)
    lonely = (of_diagonal.sum(axis=(2, 3)) > 1) & (blocks == of_diagonal).all(axis=(2, 3))
    for k in np.flatnonzero(lonely.sum(axis=1) >= max(LONELY, across // LONELY)).tolist():
        numbers = stack[k, along, along].reshape(-1, 1, LANES)
        stack[k, along, along] = 0.0
        yield Group(DIAGONAL, rows * k, 0, (k,), numbers)


def alone(stack: NDArray, before: int = 0, vector: int = 0, behind: int = 0) -> Iterator[Group]:
    """Groups of strips that are used as they are.

    `before` is the number of products before those of the stack; those of the second vector are
    `behind` them.
    """
    stack = stack.copy()
    rows = stack.shape[1]
    for first, width, own in _pieces(stack):
        columns = stack[:, :, first:first + width]
        filled: dict[int, list[int]] = {}
        for k, i in np.argwhere((stack[:, :, own] != 0.0).any(axis=2)).tolist():
            filled.setdefault(k, []).append(i)
        begin = [(k, i) for k, of_one in filled.items() for i in _covered(of_one, rows)]
        heads = [(before + k) * rows + i for k, i in begin]
        heads += [n for k, i in begin for n in (before + k, i)]
        if behind:
            heads = [behind * rows, behind, *heads]
        if begin:
            yield Group(BOTH if behind else ONCE, first, vector, tuple(heads),
                        _taken(columns, begin))


def _pieces(stack: NDArray) -> Iterator[tuple[int, int, slice]]:
    """First columns and widths of groups, which begin where the filled rows change.

    With the columns whose entries all belong to a group: it may reach into those of the next one.
    """
    columns = stack.shape[2]
    if not columns:     # of a body with one interface and no modes, which is rigid
        return
    filled = (stack != 0.0).reshape(-1, LANES, columns).any(axis=1)
    common, either = ((one(filled[:, 1:], filled[:, :-1])).sum(axis=0)
                      for one in (np.logical_and, np.logical_or))
    changes = [*(1 + np.flatnonzero(2 * common < either)).tolist(), columns]
    empty, first = ~filled.any(axis=0), 0
    while first < columns:
        if empty[first]:
            first += 1
            continue
        end = next(change for change in changes if change >= min(first + NARROW, columns))
        while first < end:
            width = WIDE if end - first > NARROW and columns >= WIDE else NARROW
            own = slice(first, min(first + width, end))
            yield min(first, columns - width), width, own
            first = own.stop


def _covered(rows: list[int], height: int, first: int = 0) -> list[int]:
    """The starts of strips, as few as possible, that cover some rows, none before the first.

    At whole vectors if these are not more: numbers are read by whole vectors afterwards, which
    must not wait for parts that are written last.
    """
    found, end, last = [], 0, height - LANES
    for row in rows if last >= first else ():
        if row >= end:
            found.append(min(row, last))
            end = row + LANES
    whole = sorted({row - row % LANES for row in rows})
    return whole if len(whole) <= len(found) and min(whole, default=0) >= first else found


def _taken(columns: NDArray, begin: list[tuple[int, int]]) -> NDArray:
    """Entries of strips, (strips, columns, LANES), which are zero afterwards: strips may overlap.

    Strips are matrices and first rows.
    """
    found = np.empty((len(begin), columns.shape[2], LANES))
    for own, (k, i) in zip(found, begin, strict=True):
        block = columns[k, i:i + LANES]
        own[:] = block.T
        block[:] = 0.0
    return found


def mirrored(stack: NDArray) -> Iterator[Group]:
    """Takes strips below the diagonal out of symmetric matrices, and what mirrors them."""
    for k, first, rows in _runs(stack, below=True):
        yield _used_twice(stack, MIRRORED, k, first, rows, (k, k, k))
        for row in rows:
            stack[k, first:first + WIDE, row:row + LANES] = 0.0


def coupled(stack: NDArray, before: int) -> Iterator[Group]:
    """Takes strips out of matrices that multiply both vectors, and their transposes the second."""
    for k, first, rows in _runs(stack, below=False):
        products = before + k, before + len(stack) + k, before + 2 * len(stack) + k
        yield _used_twice(stack, COUPLED, k, first, rows, products)


def _runs(stack: NDArray, below: bool) -> Iterator[tuple[int, int, list[int]]]:
    """Matrix, first column, and first rows of wide strips, where there are many of these."""
    height, columns = stack.shape[1:]
    filled = (stack != 0.0).reshape(len(stack), height // LANES, LANES, columns).any(axis=2)
    for k in np.flatnonzero((filled.sum(axis=1) >= MANY).any(axis=1)).tolist():
        for first, width, own in _pieces(stack[k:k + 1]):
            begin = (first + width) * below
            found = np.flatnonzero((stack[k, begin:, own] != 0.0).any(axis=1))
            rows = _covered((begin + found).tolist(), height, begin)
            if width == WIDE and len(rows) >= MANY:
                yield k, first, rows


def _used_twice(stack: NDArray, use: int, k: int, first: int, rows: list[int],
                products: tuple[int, ...]) -> Group:
    """Takes strips out of a matrix."""
    height = stack.shape[1]
    entries = _taken(stack[:, :, first:first + WIDE], [(k, row) for row in rows])
    return Group(use, first, 0, (*(height * p for p in products), *products, *rows), entries)
