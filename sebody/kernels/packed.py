"""Matrices without most of their zeros, as rows of numbers that compiled code multiplies with.

Constants of option C are mostly zeros in bodies such as beams, and what is not zero stands in
blocks. A stack of matrices of equal shapes is cut into strips: `LANES` rows of one matrix, from
any row on, and four columns or eight, from any column on. Strips of zeros are left out; strips of
the same columns are a group, which reads its numbers of the vector once. In large bodies reading
the entries takes most of the time: a matrix that multiplies both vectors is read once, and where
many strips of one matrix have the same columns, they are used once more, transposed. Products that
are multiples of others, number by number, are made from these. Groups by what their strips are:

========  ==========================================================================================
ONCE      strips of any matrices
BOTH      strips of matrices that multiply both vectors
MIRRORED  strips below the diagonal of a symmetric matrix, which are also those to its right
COUPLED   strips of a matrix that multiplies both vectors, and whose transpose multiplies the second
MULTIPLE  no strips: vectors of factors, which make a product from another one
DIAGONAL  no strips: the diagonal of a matrix, of which strips would hold mostly zeros
========  ==========================================================================================

A row has at most the size that matrices without zeros would take; it begins with whole numbers, in
the bits of floats:

========  ==========================================================================================
8         number of groups of each kind: by use, first narrow ones, then wide ones; those that are
          used twice are wide
5 each    first column, vector, number of strips, where their heads and entries begin; of MULTIPLE
          the places of its product and of the other one in the stack, then as above; of DIAGONAL
          the same with the place in the vector, which is 0, in place of the other product
1, 2 ...  heads of a group: places of the strips' products in the stack of all products; then of
          every strip matrix and first row, which products do not read
2, 1 ...  heads of BOTH: how far the products of the second vector are behind those of the first
          one, and their matrices; then as above
1         head of DIAGONAL: the matrix
6, 1 ...  heads of a group that is used twice: places of up to three products (of the first vector,
          of the second one, of the transpose), their matrices, and the first row of each strip
========  ==========================================================================================

Entries of a group follow strip by strip, column by column.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.contract.counts import CACHE_LINE, LANES, packed_size, whole_vectors
from sebody.kernels.packed_groups import (
    BOTH,
    COUPLED,
    DIAGONAL,
    MIRRORED,
    MULTIPLE,
    NARROW,
    ONCE,
    WIDE,
    Group,
    alone,
    diagonals,
    mirrored,
)

KINDS = ((ONCE, NARROW), (ONCE, WIDE), (BOTH, NARROW), (BOTH, WIDE), (MIRRORED, WIDE),
         (COUPLED, WIDE), (MULTIPLE, 1), (DIAGONAL, 1))
BEGIN, GROUP = len(KINDS), 5    # whole numbers of a row, and of a group
BEHIND = 2              # of a group of both vectors
PRODUCTS = 3            # of a group that is used twice


class Multiple(NamedTuple):
    """A product that is made from another one, read back."""

    place: int          # in the stack of all products
    other: int          # place of the other one
    at: int             # where the factors begin
    factors: NDArray


class Diagonal(NamedTuple):
    """The diagonal of a matrix, read back."""

    place: int          # of its product in the stack of all products
    matrix: int         # number of the product
    at: int             # where its numbers begin
    numbers: NDArray


class Use(NamedTuple):
    """A strip's operand: vector and matrix."""

    vector: int                 # the first one or the second
    place: int                  # of its sums in the stack of all products
    matrix: int                 # number of the product
    transposed: bool


class Strip(NamedTuple):
    """A strip of a row, read back."""

    uses: tuple[Use, ...]
    row: int
    first: int                  # column
    at: int                     # where its entries begin
    entries: NDArray            # (LANES, columns)


def pack(matrices: ArrayLike, shape: tuple[int, int, int], symmetric: bool = False) -> NDArray:
    """The row of some matrices, ``(count, rows, columns)``."""
    stack = padded(matrices, shape)
    groups = [*diagonals(stack), *(mirrored(stack) if symmetric else ())]
    return row_of([*groups, *alone(stack)], packed_size(*shape))


def move_to_cache_lines(row: NDArray, first: int) -> None:
    """Move the entries of a row so that they begin at a whole cache line.

    `first` is the place where the row begins among numbers that begin at one.
    """
    whole = row.view(np.int64)
    groups = whole[BEGIN:BEGIN + GROUP * int(whole[:BEGIN].sum())].reshape(-1, GROUP)
    if len(groups):
        at = groups[:, -1]
        begin = int(at.min())
        shift = -(first + begin) % CACHE_LINE
        if shift:
            row[begin + shift:] = row[begin:-shift].copy()
            at += shift


def unpack(row: NDArray, shape: tuple[int, int, int]) -> NDArray:
    """The matrices of a row, ``(count, rows, columns)``, one for each product."""
    count, rows, columns = shape
    height, found = whole_vectors(rows), list(strips(row))
    products = 1 + max((use.matrix for strip in found for use in strip.uses), default=0)
    stack = np.zeros((max(count, products), height, whole_vectors(columns)))
    for uses, i, first, _, entries in found:
        for use in uses:
            below, right = (first, i) if use.transposed else (i, first)
            block = entries.T if use.transposed else entries
            stack[use.matrix, below:below + block.shape[0], right:right + block.shape[1]] += block
    for _, matrix, _, numbers in diagonals_of(row):
        stack[matrix, range(len(numbers)), range(len(numbers))] += numbers
    for place, other, _, factors in multiples(row):
        stack[place // height] = factors[:, np.newaxis] * stack[other // height]
    return stack[:count, :rows, :columns]


def strips(row: NDArray) -> Iterator[Strip]:
    """The strips of a row, group by group."""
    row = np.ascontiguousarray(row)
    for use, width, (first, vector, count, head, at) in _groups(row):
        for s in range(count) if use not in (MULTIPLE, DIAGONAL) else ():
            begin = at + LANES * width * s
            entries = row[begin:begin + LANES * width].reshape(width, LANES).T
            i, factors = _factors(row.view(np.int64), use, vector, head, s, count, first)
            yield Strip(factors, i, first, begin, entries)


def multiples(row: NDArray) -> Iterator[Multiple]:
    """The products of a row that are made from others."""
    row = np.ascontiguousarray(row)
    for use, _, (place, other, count, _, at) in _groups(row):
        if use == MULTIPLE:
            yield Multiple(place, other, at, row[at:at + LANES * count])


def diagonals_of(row: NDArray) -> Iterator[Diagonal]:
    """The diagonals of a row that stand apart."""
    row = np.ascontiguousarray(row)
    for use, _, (place, _, count, head, at) in _groups(row):
        if use == DIAGONAL:
            yield Diagonal(place, int(row.view(np.int64)[head]), at, row[at:at + LANES * count])


def _groups(row: NDArray) -> Iterator[tuple[int, int, list[int]]]:
    """Use, width and whole numbers of the groups of a row."""
    whole = row.view(np.int64)
    kinds = [kind for kind, count in zip(KINDS, whole[:BEGIN].tolist(), strict=True)
             for _ in range(count)]
    numbers = whole[BEGIN:][:GROUP * len(kinds)].reshape(-1, GROUP).tolist()
    for (use, width), group in zip(kinds, numbers, strict=True):
        yield use, width, group


def _factors(whole: NDArray, use: int, vector: int, head: int, strip: int, count: int,
             first: int) -> tuple[int, tuple[Use, ...]]:
    """First row of a strip, and what it multiplies."""
    if use in (MIRRORED, COUPLED):
        places, matrices = whole[head:head + 2 * PRODUCTS].reshape(2, -1).tolist()
        i, vectors = int(whole[head + 2 * PRODUCTS + strip]), 1 + (use == COUPLED)
        forward = [Use(k, places[k] + i, matrices[k], False) for k in range(vectors)]
        return i, (*forward, Use(vectors - 1, places[-1] + first, matrices[-1], True))
    behind = whole[head:head + BEHIND].tolist()
    head += BEHIND * (use == BOTH)
    k, i = whole[head + count + 2 * strip:head + count + 2 * strip + 2].tolist()
    place = int(whole[head + strip])
    forward = Use(vector, place, k, False), Use(1, place + behind[0], k + behind[1], False)
    return i, forward[:1 + (use == BOTH)]


def padded(matrices: ArrayLike, shape: tuple[int, int, int]) -> NDArray:
    count, rows, columns = shape
    stack = np.zeros((count, whole_vectors(rows), whole_vectors(columns)))
    stack[:, :rows, :columns] = np.asarray(matrices, dtype=float).reshape(shape)
    return stack


def row_of(groups: list[Group], size: int) -> NDArray:
    """Groups by their kinds."""
    kinds = [KINDS.index((group.use, group.entries.shape[1])) for group in groups]
    groups = [groups[g] for g in np.argsort(kinds, kind="stable").tolist()]
    row = np.zeros(size)
    head = BEGIN + GROUP * len(groups)
    end = head + sum(len(group.heads) for group in groups)
    whole = row.view(np.int64)
    whole[:BEGIN] = np.bincount(kinds, minlength=BEGIN)
    for g, (_, first, vector, heads, entries) in enumerate(groups):
        begin = BEGIN + GROUP * g
        whole[begin:begin + GROUP] = first, vector, len(entries), head, end
        whole[head:head + len(heads)] = heads
        row[end:end + entries.size] = entries.ravel()
        head, end = head + len(heads), end + entries.size
    return row
