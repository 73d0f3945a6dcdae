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
========  ==========================================================================================

A row has at most the size that matrices without zeros would take; it begins with whole numbers, in
the bits of floats:

========  ==========================================================================================
7         number of groups of each kind: by use, first narrow ones, then wide ones; those that are
          used twice are wide
5 each    first column, vector, number of strips, where their heads and entries begin; of MULTIPLE
          the places of its product and of the other one in the stack, then as above
3 each    head of a strip: place of its product in the stack of all products, matrix, first row
2, 3 ...  heads of BOTH: how far the products of the second vector are behind those of the first
          one, and their matrices; then as above
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

ONCE, BOTH, MIRRORED, COUPLED, MULTIPLE = range(5)      # uses of groups
NARROW, WIDE = 4, 8     # columns of a strip
KINDS = ((ONCE, NARROW), (ONCE, WIDE), (BOTH, NARROW), (BOTH, WIDE), (MIRRORED, WIDE),
         (COUPLED, WIDE), (MULTIPLE, 1))
BEGIN, GROUP, HEAD = len(KINDS), 5, 3   # whole numbers of a row, of a group and of a strip
BEHIND = 2              # of a group of both vectors
PRODUCTS = 3            # of a group that is used twice
MANY = 3        # strips of one matrix: with fewer, sums of transposed products cost more


class Group(NamedTuple):
    """Strips of the same columns, or what makes a multiple: see the table of whole numbers."""

    use: int
    first: int                  # column
    vector: int                 # that they multiply: the first one or the second
    heads: tuple[int, ...]
    entries: NDArray            # (strips, columns, LANES)


class Multiple(NamedTuple):
    """A product that is made from another one, read back."""

    place: int          # in the stack of all products
    other: int          # place of the other one
    at: int             # where the factors begin
    factors: NDArray


class Use(NamedTuple):
    """What a strip multiplies."""

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
    groups = list(mirrored(stack)) if symmetric else []
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
    for place, other, _, factors in multiples(row):
        stack[place // height] = factors[:, np.newaxis] * stack[other // height]
    return stack[:count, :rows, :columns]


def strips(row: NDArray) -> Iterator[Strip]:
    """The strips of a row, group by group."""
    row = np.ascontiguousarray(row)
    for use, width, (first, vector, count, head, at) in _groups(row):
        for s in range(count) if use != MULTIPLE else ():
            begin = at + LANES * width * s
            entries = row[begin:begin + LANES * width].reshape(width, LANES).T
            i, factors = _factors(row.view(np.int64), use, vector, head, s, first)
            yield Strip(factors, i, first, begin, entries)


def multiples(row: NDArray) -> Iterator[Multiple]:
    """The products of a row that are made from others."""
    row = np.ascontiguousarray(row)
    for use, _, (place, other, count, _, at) in _groups(row):
        if use == MULTIPLE:
            yield Multiple(place, other, at, row[at:at + LANES * count])


def _groups(row: NDArray) -> Iterator[tuple[int, int, list[int]]]:
    """Use, width and whole numbers of the groups of a row."""
    whole = row.view(np.int64)
    kinds = [kind for kind, count in zip(KINDS, whole[:BEGIN].tolist(), strict=True)
             for _ in range(count)]
    numbers = whole[BEGIN:][:GROUP * len(kinds)].reshape(-1, GROUP).tolist()
    for (use, width), group in zip(kinds, numbers, strict=True):
        yield use, width, group


def _factors(whole: NDArray, use: int, vector: int, head: int, strip: int, first: int
             ) -> tuple[int, tuple[Use, ...]]:
    """First row of a strip, and what it multiplies."""
    if use in (MIRRORED, COUPLED):
        places, matrices = whole[head:head + 2 * PRODUCTS].reshape(2, -1).tolist()
        i, vectors = int(whole[head + 2 * PRODUCTS + strip]), 1 + (use == COUPLED)
        forward = [Use(k, places[k] + i, matrices[k], False) for k in range(vectors)]
        return i, (*forward, Use(vectors - 1, places[-1] + first, matrices[-1], True))
    behind = whole[head:head + BEHIND].tolist()
    head += BEHIND * (use == BOTH)
    place, k, i = whole[head + HEAD * strip:head + HEAD * (strip + 1)].tolist()
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
        heads = [n for k, i in begin for n in ((before + k) * rows + i, before + k, i)]
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
    """Where strips begin, as few as possible, that cover some rows, none before the first.

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
