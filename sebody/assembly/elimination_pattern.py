"""Positions of the blocks of a large sparse matrix and of its factors."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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


def best_slots(row: NDArray, column: NDArray, groups: NDArray, n: int) -> tuple[NDArray, Pattern]:
    """Slots of n unknowns: contiguous, or each group from a new block on if that is cheaper."""
    groups = np.unique(groups[groups < n])
    padding = np.zeros(n, dtype=np.int64)
    padding[groups[1:]] = -np.diff(groups) % LANES
    choices = [np.arange(n), np.arange(n) + np.cumsum(padding)]
    patterns = [block_pattern(slot[row], slot[column], slot[-1] + 1) for slot in choices]
    best = int(patterns[1].products < patterns[0].products)
    return choices[best], patterns[best]


def block_pattern(row: NDArray, column: NDArray, n: int) -> Pattern:
    """Pattern of a structurally symmetric n x n matrix with its fill.

    Fill: the blocks that a column has below the diagonal are added to its parent in the
    elimination tree, the column of the first of them.
    """
    across = -(-n // LANES)
    i, j = row // LANES, column // LANES
    j, i = np.divmod(np.unique((j * across + i)[i > j]), across)
    firsts, i = np.searchsorted(j, np.arange(across + 1)).tolist(), i.tolist()
    below = [set(i[first:end]) for first, end in pairwise(firsts)]
    for rows in below:
        if rows:
            parent = min(rows)
            below[parent] |= rows
            below[parent].discard(parent)
    i = np.array([i for rows in below for i in rows], dtype=np.int64)
    j = np.repeat(np.arange(across), [len(rows) for rows in below])
    keys = np.sort(np.concatenate([np.arange(across) * (across + 1), j * across + i,
                                   i * across + j]))
    return Pattern(np.searchsorted(keys // across, np.arange(across + 1)), keys % across,
                   np.searchsorted(keys, np.arange(across) * (across + 1)))


def entries(pattern: Pattern, row: NDArray, column: NDArray) -> NDArray:
    """Where entries of the matrix are stored."""
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
