"""Positions of the blocks of a large sparse matrix and of its factors."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.independent_parts import Parts
from sebody.contract.counts import LANES
from sebody.engine.elimination import BLOCK


class Pattern(NamedTuple):
    """Blocks of the matrix and of its factors, column by column."""

    starts: NDArray         # (blocks across + 1,) first block of each column
    rows: NDArray           # block row of each block, ascending in a column
    diagonal: NDArray       # (blocks across,) the block on the diagonal

    @property
    def products(self) -> int:
        """Number of products of blocks in an elimination."""
        return int(((self.starts[1:] - self.diagonal - 1) ** 2).sum())

    def before(self, row: int) -> NDArray:
        """First block of every column that is in a block row or below it, or the end."""
        return self.starts[:-1] + np.add.reduceat(self.rows < row, self.starts[:-1], dtype=int)


def best_slots(row: NDArray, column: NDArray, groups: NDArray, n: int,
               parts: Parts | None = None) -> tuple[NDArray, Pattern]:
    """Slots of n unknowns: contiguous, or each group from a new block on if that is cheaper.

    The unknowns of `parts` come first, each part from a new block on.
    """
    groups = np.unique(groups[groups < n])
    order = np.arange(n) if parts is None else parts.order
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    firsts = np.zeros(0, dtype=np.int64) if parts is None else parts.firsts
    padded = [_padded(n, firsts), _padded(n, np.union1d(place[groups], firsts))]
    choices = [slots[place] for slots in padded]
    patterns = [block_pattern(slot[row], slot[column], slot.max() + 1) for slot in choices]
    best = int(patterns[1].products < patterns[0].products)
    return choices[best], patterns[best]


def _padded(n: int, firsts: NDArray) -> NDArray:
    """Slots of n unknowns in their order; those numbered `firsts` begin a block."""
    padding = np.zeros(n, dtype=np.int64)
    firsts = firsts[(firsts > 0) & (firsts < n)]
    padding[firsts] = -np.diff(firsts, prepend=0) % LANES
    return np.arange(n) + np.cumsum(padding)


def block_pattern(row: NDArray, column: NDArray, n: int) -> Pattern:
    """Pattern of a structurally symmetric n x n matrix with its fill, in blocks."""
    across = -(-n // LANES)
    below = filled(row // LANES, column // LANES, across)
    i = np.array([i for rows in below for i in rows], dtype=np.int64)
    j = np.repeat(np.arange(across), [len(rows) for rows in below])
    keys = np.sort(np.concatenate([np.arange(across) * (across + 1), j * across + i,
                                   i * across + j]))
    return Pattern(np.searchsorted(keys // across, np.arange(across + 1)), keys % across,
                   np.searchsorted(keys, np.arange(across) * (across + 1)))


def filled(i: NDArray, j: NDArray, across: int) -> list[set[int]]:
    """Rows below the diagonal in every column of a structurally symmetric matrix, with its fill.

    Fill: the rows that a column has below the diagonal are added to its parent in the
    elimination tree, the column of the first of them.
    """
    j, i = np.divmod(np.unique((j * across + i)[i > j]), across)
    firsts, i = np.searchsorted(j, np.arange(across + 1)).tolist(), i.tolist()
    below = [set(i[first:end]) for first, end in pairwise(firsts)]
    for rows in below:
        if rows:
            parent = min(rows)
            below[parent] |= rows
            below[parent].discard(parent)
    return below


def entries(pattern: Pattern, row: NDArray, column: NDArray) -> NDArray:
    """Places of entries in the stored matrix."""
    across = len(pattern.diagonal)
    columns = np.repeat(np.arange(across), np.diff(pattern.starts))
    block = np.searchsorted(columns * across + pattern.rows,
                            column // LANES * across + row // LANES)
    return block * BLOCK + column % LANES * LANES + row % LANES


def places(pattern: Pattern) -> tuple[NDArray, NDArray]:
    """Row and column of every stored entry."""
    across = len(pattern.diagonal)
    columns = np.repeat(np.arange(across), np.diff(pattern.starts))
    inner_column, inner_row = np.divmod(np.arange(BLOCK), LANES)
    return ((LANES * pattern.rows[:, None] + inner_row).ravel(),
            (LANES * columns[:, None] + inner_column).ravel())
