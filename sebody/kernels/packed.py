"""Matrices without most of their zeros, as rows of numbers that compiled code multiplies with.

Constants of option C are mostly zeros in bodies such as beams. A stack of matrices of equal shapes
is cut into strips: `LANES` rows of one matrix, and four columns or eight, from a multiple of four
or eight on. Strips of zeros are left out; strips of the same columns are a group, which reads its
numbers of the vector once. In large bodies reading the entries takes most of the time. Where many
strips of one matrix have the same columns, they are therefore used twice: as they are, and
transposed. Kinds of groups:

========  ==========================================================================================
NARROW    strips of any matrices, four columns
WIDE      the same, eight columns
MIRRORED  strips below the diagonal of a symmetric matrix, which are also those to its right
COUPLED   strips of a matrix that multiplies both vectors, and whose transpose multiplies the second
========  ==========================================================================================

A row has at most the size that matrices without zeros would take; it begins with whole numbers, in
the bits of floats:

========  ==========================================================================================
4         number of groups of each kind
5 each    first column, vector, number of strips, where their heads and entries begin
3 each    head of a strip: place of its product in the stack of all products, matrix, first row
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

NARROW, WIDE, MIRRORED, COUPLED = KINDS = range(4)      # of groups, in the order of a row
WIDTHS = 4, 8, 8, 8         # columns of a strip
BEGIN, GROUP, HEAD = 4, 5, 3    # whole numbers of a row, of a group and of a strip
PRODUCTS = 3            # of a group that is used twice
MANY = 4        # strips of one matrix: with fewer, sums of transposed products cost more


class Group(NamedTuple):
    """Strips of the same columns."""

    kind: int
    first: int                  # column
    vector: int                 # that they multiply: the first one or the second
    heads: tuple[int, ...]
    entries: NDArray            # (strips, columns, LANES)


class Strip(NamedTuple):
    """A strip of a row, read back."""

    kind: int
    vector: int
    places: tuple[int, ...]     # of products, one or three
    matrices: tuple[int, ...]   # the same by their numbers
    row: int
    first: int                  # column
    at: int                     # where its entries begin
    entries: NDArray            # (LANES, columns)


def pack(matrices: ArrayLike, shape: tuple[int, int, int], symmetric: bool = False) -> NDArray:
    """The row of some matrices, ``(count, rows, columns)``."""
    stack = _padded(matrices, shape)
    groups = list(_mirrored(stack)) if symmetric else []
    return _row([*groups, *_alone(stack)], packed_size(*shape))


def pack_couplings(squares: NDArray, couplings: NDArray) -> NDArray:
    """The row of products with two vectors x and y: ``S x``, ``C x``, ``C y``, ``C^T y``.

    Parameters
    ----------
    squares : (squares, N, N)
        Symmetric matrices S.
    couplings : (couplings, N, N)
        Matrices C.
    """
    S, C = (_padded(stack, stack.shape) for stack in (squares, couplings))
    groups = [*_mirrored(S), *_coupled(C, len(S))]
    groups += _alone(np.concatenate([S, C]))
    groups += _alone(np.concatenate([C, C.transpose(0, 2, 1)]), len(S) + len(C), 1)
    return _row(groups, packed_size(len(S) + 3 * len(C), *squares.shape[1:]))


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
    stack = np.zeros((count, whole_vectors(rows), whole_vectors(columns)))
    for _, _, _, matrices, i, first, _, entries in strips(row):
        end = first + entries.shape[1]
        for k in matrices[:-1] or matrices:
            stack[k, i:i + LANES, first:end] = entries
        for k in matrices[1:][-1:]:
            stack[k, first:end, i:i + LANES] = entries.T
    return stack[:, :rows, :columns]


def strips(row: NDArray) -> Iterator[Strip]:
    """The strips of a row, group by group."""
    row = np.ascontiguousarray(row)
    whole = row.view(np.int64)
    kinds = np.repeat(KINDS, whole[:BEGIN]).tolist()
    for kind, group in zip(kinds, whole[BEGIN:][:GROUP * len(kinds)].reshape(-1, GROUP).tolist(),
                           strict=True):
        first, vector, count, head, at = group
        width = WIDTHS[kind]
        for s in range(count):
            if kind in (NARROW, WIDE):
                place, k, i = whole[head + HEAD * s:head + HEAD * (s + 1)].tolist()
                places, matrices = (place,), (k,)
            else:
                places, matrices = whole[head:head + 2 * PRODUCTS].reshape(2, -1).tolist()
                i = int(whole[head + 2 * PRODUCTS + s])
            begin = at + LANES * width * s
            entries = row[begin:begin + LANES * width].reshape(width, LANES).T
            yield Strip(kind, vector, tuple(places), tuple(matrices), i, first, begin, entries)


def _padded(matrices: ArrayLike, shape: tuple[int, int, int]) -> NDArray:
    count, rows, columns = shape
    stack = np.zeros((count, whole_vectors(rows), whole_vectors(columns)))
    stack[:, :rows, :columns] = np.asarray(matrices, dtype=float).reshape(shape)
    return stack


def _row(groups: list[Group], size: int) -> NDArray:
    """Groups by their kinds."""
    groups = sorted(groups, key=lambda group: group.kind)
    row = np.zeros(size)
    head = BEGIN + GROUP * len(groups)
    end = head + sum(len(group.heads) for group in groups)
    whole = row.view(np.int64)
    whole[:BEGIN] = np.bincount([group.kind for group in groups], minlength=BEGIN)
    for g, (_, first, vector, heads, entries) in enumerate(groups):
        begin = BEGIN + GROUP * g
        whole[begin:begin + GROUP] = first, vector, len(entries), head, end
        whole[head:head + len(heads)] = heads
        row[end:end + entries.size] = entries.ravel()
        head, end = head + len(heads), end + entries.size
    return row


def _alone(stack: NDArray, before: int = 0, vector: int = 0) -> Iterator[Group]:
    """Groups of strips that are used once; wide ones where both halves have entries.

    `before` is the number of products before those of the stack.
    """
    count, rows, columns = stack.shape
    narrow, wide = WIDTHS[NARROW], WIDTHS[WIDE]
    filled = (stack.reshape(count, rows // LANES, LANES, columns // narrow, narrow)
              != 0.0).any(axis=(2, 4))

    def group(kind, first, chosen):
        heads, entries, width = [], [], WIDTHS[kind]
        for k, block in np.argwhere(chosen).tolist():
            i = LANES * block
            heads += (before + k) * rows + i, before + k, i
            entries.append(stack[k, i:i + LANES, first:first + width].T)
        return [Group(kind, first, vector, tuple(heads), np.array(entries))] if heads else []
    for first in range(0, columns, wide):
        halves = filled[:, :, first // narrow:(first + wide) // narrow]
        both = halves.all(axis=2) & (halves.shape[2] == wide // narrow)
        yield from group(WIDE, first, both)
        for half in range(halves.shape[2]):
            yield from group(NARROW, first + half * narrow, halves[:, :, half] & ~both)


def _mirrored(stack: NDArray) -> Iterator[Group]:
    """Takes strips below the diagonal out of symmetric matrices, and what mirrors them."""
    width = WIDTHS[MIRRORED]
    for k, first, rows in _runs(stack, width, below=True):
        yield _used_twice(stack, MIRRORED, k, first, rows, (k, k, k))
        stack[k, first:first + width].reshape(width, -1, LANES)[:, rows] = 0.0


def _coupled(stack: NDArray, before: int) -> Iterator[Group]:
    """Takes strips out of matrices that multiply both vectors, and their transposes the second."""
    for k, first, rows in _runs(stack, WIDTHS[COUPLED], below=False):
        products = before + k, before + len(stack) + k, before + 2 * len(stack) + k
        yield _used_twice(stack, COUPLED, k, first, rows, products)


def _runs(stack: NDArray, width: int, below: bool) -> Iterator[tuple[int, int, NDArray]]:
    """Matrix, first column, and blocks of rows, where there are many of these."""
    count, rows, columns = stack.shape
    whole = columns // width
    filled = (stack[:, :, :width * whole].reshape(count, rows // LANES, LANES, whole, width)
              != 0.0).any(axis=(2, 4))
    if below:
        filled &= (LANES * np.arange(rows // LANES)[:, None] >= width * (1 + np.arange(whole)))
    for k, block in np.argwhere(filled.sum(axis=1) >= MANY).tolist():
        yield k, width * block, np.flatnonzero(filled[k, :, block])


def _used_twice(stack: NDArray, kind: int, k: int, first: int, rows: NDArray,
                products: tuple[int, ...]) -> Group:
    """Takes strips out of a matrix."""
    height, columns = stack.shape[1:]
    own = stack[k].reshape(-1, LANES, columns)[:, :, first:first + WIDTHS[kind]]
    entries = own[rows].transpose(0, 2, 1)
    own[rows] = 0.0
    return Group(kind, first, 0, (*(height * p for p in products), *products,
                                  *(LANES * rows).tolist()), entries)
