"""Matrices without most of their zeros, as rows of numbers that compiled code multiplies with.

Constants of option C are mostly zeros in bodies such as beams. A stack of matrices of equal shapes
is cut into strips: `LANES` rows of one matrix, and a run of columns outside of which these rows are
zero. Up to eight strips with the same columns share each number of a vector that they are
multiplied with. A row has the size that matrices without zeros would take; it begins with whole
numbers, in the bits of floats:

========  ==========================================================================================
1         number of groups of strips
5 each    first column, number of columns, number of strips, where their heads and entries begin
3 each    head of a strip: place of its product in the stack of all products, matrix, first row
========  ==========================================================================================

Entries of a group follow column by column, strip by strip.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.kernels.layout import LANES, packed_size, whole_vectors

GROUPS = 8, 4, 2, 1     # strips that share their columns
GROUP, HEAD = 5, 3      # whole numbers that tell of a group, and of a strip
GAP = 3                 # columns of zeros inside a run: one more group costs as much

Strip = tuple[int, int]     # matrix, first row
Run = tuple[int, int]       # first column, end


def pack(matrices: ArrayLike, shape: tuple[int, int, int]) -> NDArray:
    """The row of some matrices, ``(count, rows, columns)``."""
    count, rows, columns = shape
    stack = np.zeros((count, whole_vectors(rows), columns))
    stack[:, :rows] = np.asarray(matrices, dtype=float).reshape(shape)
    by_run = _by_run(stack)
    size = packed_size(*shape)
    if 1 + sum(_group_size(run, group) for run, group in _groups(by_run)) > size:
        by_run = {(0, columns): [(k, i) for k in range(count)
                                 for i in range(0, stack.shape[1], LANES)]}
    groups = list(_groups(by_run))
    row = np.zeros(size)
    head = 1 + GROUP * len(groups)
    end = head + HEAD * sum(len(group) for _, group in groups)
    whole = row.view(np.int64)
    whole[0] = len(groups)
    for g, ((first, last), group) in enumerate(groups):
        whole[1 + GROUP * g:1 + GROUP * (g + 1)] = first, last - first, len(group), head, end
        for k, i in group:
            whole[head:head + HEAD] = k * stack.shape[1] + i, k, i
            head += HEAD
        entries = np.stack([stack[k, i:i + LANES, first:last] for k, i in group])
        row[end:end + entries.size] = entries.transpose(2, 0, 1).ravel()
        end += entries.size
    return row


def unpack(row: NDArray, shape: tuple[int, int, int]) -> NDArray:
    """The matrices of a row, ``(count, rows, columns)``."""
    count, rows, columns = shape
    row = np.ascontiguousarray(row)
    stack, whole = np.zeros((count, whole_vectors(rows), columns)), row.view(np.int64)
    for g in range(whole[0]):
        first, width, strips, head, at = whole[1 + GROUP * g:1 + GROUP * (g + 1)]
        entries = row[at:at + LANES * strips * width].reshape(width, strips, LANES)
        for s, strip in enumerate(entries.transpose(1, 2, 0)):
            k, i = whole[head + HEAD * s + 1:head + HEAD * (s + 1)]
            stack[k, i:i + LANES, first:first + width] += strip
    return stack[:, :rows]


def _by_run(stack: NDArray) -> dict[Run, list[Strip]]:
    """Strips by their runs of columns."""
    count, rows, columns = stack.shape
    blocks = rows // LANES
    filled = (stack.reshape(count * blocks, LANES, columns) != 0.0).any(axis=1)
    strip, column = filled.nonzero()
    begins = np.ones(len(strip) + 1, dtype=bool)        # one more, behind the last
    begins[1:-1] = (np.diff(strip) != 0) | (np.diff(column) > GAP)
    found: dict[Run, list[Strip]] = {}
    for number, first, last in zip(*(array.tolist() for array in (
            strip[begins[:-1]], column[begins[:-1]], column[begins[1:]])), strict=True):
        k, block = divmod(number, blocks)
        found.setdefault((first, last + 1), []).append((k, LANES * block))
    return found


def _groups(by_run: dict[Run, list[Strip]]) -> Iterator[tuple[Run, Sequence[Strip]]]:
    """As many strips with the same columns at a time as there is code for."""
    for run, strips in sorted(by_run.items()):
        done = 0
        for count in GROUPS:
            while len(strips) - done >= count:
                yield run, strips[done:done + count]
                done += count


def _group_size(run: Run, strips: Sequence[Strip]) -> int:
    return GROUP + len(strips) * (HEAD + LANES * (run[1] - run[0]))
