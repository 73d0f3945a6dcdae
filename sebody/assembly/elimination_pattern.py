"""Positions of the blocks of a large sparse matrix and of its factors."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.engine.elimination import BLOCK
from sebody.kernels.layout import LANES


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
    below: list[set[int]] = [set() for _ in range(across)]
    for key in np.unique(column // LANES * across + row // LANES):
        i, j = key % across, key // across
        if i > j:
            below[j].add(int(i))
    keys = [np.arange(across) * (across + 1)]
    for j in range(across):
        rows = np.array(sorted(below[j]), dtype=np.int64)
        if len(rows):
            below[rows[0]].update(rows[1:].tolist())
        keys += [j * across + rows, rows * across + j]
    keys = np.unique(np.concatenate(keys))
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
