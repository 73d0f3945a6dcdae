"""Matrices without most of their zeros, as rows of numbers that compiled code multiplies with.

Constants of option C are mostly zeros in bodies such as beams. A stack of matrices of equal shapes
is cut into strips: `LANES` rows of one matrix, and four columns or eight, from a multiple of four
or eight on. Strips of zeros are left out; strips of the same columns are a group, which reads its
numbers of the vector once. A row has the size that matrices without zeros would take; it begins
with whole numbers, in the bits of floats:

========  ==========================================================================================
1         number of groups of strips
5 each    first column, number of columns, number of strips, where their heads and entries begin
3 each    head of a strip: place of its product in the stack of all products, matrix, first row
========  ==========================================================================================

Entries of a group follow strip by strip, column by column.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.contract.counts import LANES, packed_size, whole_vectors

WIDE, NARROW = WIDTHS = 8, 4    # columns of a strip
GROUP, HEAD = 5, 3      # whole numbers that tell of a group, and of a strip

Strip = tuple[int, int]     # matrix, first row


def pack(matrices: ArrayLike, shape: tuple[int, int, int]) -> NDArray:
    """The row of some matrices, ``(count, rows, columns)``."""
    count, rows, columns = shape
    stack = np.zeros((count, whole_vectors(rows), whole_vectors(columns)))
    stack[:, :rows, :columns] = np.asarray(matrices, dtype=float).reshape(shape)
    groups = [group for group in _groups(stack) if group[2]]
    row = np.zeros(packed_size(*shape))
    head = 1 + GROUP * len(groups)
    end = head + HEAD * sum(len(strips) for *_, strips in groups)
    whole = row.view(np.int64)
    whole[0] = len(groups)
    for g, (first, width, strips) in enumerate(groups):
        whole[1 + GROUP * g:1 + GROUP * (g + 1)] = first, width, len(strips), head, end
        for k, i in strips:
            whole[head:head + HEAD] = k * stack.shape[1] + i, k, i
            entries = stack[k, i:i + LANES, first:first + width].T
            row[end:end + entries.size] = entries.ravel()
            head, end = head + HEAD, end + entries.size
    return row


def unpack(row: NDArray, shape: tuple[int, int, int]) -> NDArray:
    """The matrices of a row, ``(count, rows, columns)``."""
    count, rows, columns = shape
    row = np.ascontiguousarray(row)
    stack = np.zeros((count, whole_vectors(rows), whole_vectors(columns)))
    whole = row.view(np.int64)
    for g in range(whole[0]):
        first, width, strips, head, at = whole[1 + GROUP * g:1 + GROUP * (g + 1)]
        entries = row[at:at + LANES * strips * width].reshape(strips, width, LANES)
        for s, strip in enumerate(entries):
            k, i = whole[head + HEAD * s + 1:head + HEAD * (s + 1)]
            stack[k, i:i + LANES, first:first + width] += strip.T
    return stack[:, :rows, :columns]


def _groups(stack: NDArray) -> Iterator[tuple[int, int, Sequence[Strip]]]:
    """First column, number of columns and strips: wide ones where both halves have entries."""
    count, rows, columns = stack.shape
    filled = (stack.reshape(count, rows // LANES, LANES, columns // NARROW, NARROW)
              != 0.0).any(axis=(2, 4))
    for first in range(0, columns, WIDE):
        halves = filled[:, :, first // NARROW:(first + WIDE) // NARROW]
        both = halves.all(axis=2) & (halves.shape[2] == WIDE // NARROW)
        yield first, WIDE, _strips(both)
        for half in range(halves.shape[2]):
            yield first + half * NARROW, NARROW, _strips(halves[:, :, half] & ~both)


def _strips(chosen: NDArray) -> list[Strip]:
    return [(int(k), LANES * int(block)) for k, block in np.argwhere(chosen)]
