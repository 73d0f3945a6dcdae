"""LU factors of a sparse matrix with row exchanges, in compiled code.

Gilbert and Peierls (SIAM J. Sci. Stat. Comput. 9, 1988, p. 862): column by column, in the order of
the unknowns. Which of the columns before it change a column is found in the graph of L, so the
time is that of the operations. The diagonal entry is the pivot unless it is below `THRESHOLD`
times the largest in its column: the order of the unknowns was chosen for little fill (I. S. Duff,
A. M. Erisman and J. K. Reid, Direct Methods for Sparse Matrices, 5.4).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.engine.arrays import Arrays

THRESHOLD = 0.01        # pivots on the diagonal are kept down to this share of the largest
REGULAR, SINGULAR, ROOM = range(3)      # what a factorization ends with
SMALLEST = 1e-13        # pivot of a regular matrix, relative to the largest


@dataclass(frozen=True, eq=False)
class Columns(Arrays):
    """A square matrix by columns: column j has the entries from ``starts[j]`` on."""

    entries: NDArray
    rows: NDArray
    starts: NDArray         # one more than columns


@dataclass(frozen=True, eq=False)
class Factors(Arrays):
    """Factors ``L U`` of a matrix whose rows are exchanged, by columns.

    A column has entries of U above its pivot, the pivot, then L, whose diagonal is one.

    ============  ==================================================================================
    values, rows  entries; rows of U are numbers of pivots, those of L rows of the matrix
    starts        (n + 1,) first entry of every column; at the end their number, fill included
    diagonal      (n,) entry that is the pivot
    pivots        (n,) row of the matrix that it is in
    order         (n,) of a row the number of its pivot, -1 before it has one
    x             (n,) scratch memory, zeros between columns
    marks, found, path, at
                  (n,) scratch memory of `_reach`
    ============  ==================================================================================
    """

    values: NDArray
    rows: NDArray
    starts: NDArray
    diagonal: NDArray
    pivots: NDArray
    order: NDArray
    x: NDArray
    marks: NDArray
    found: NDArray
    path: NDArray
    at: NDArray

    @classmethod
    def of(cls, n: int, entries: int = 0) -> "Factors":
        """Room for factors of n columns with some number of entries."""
        def whole(size: int) -> NDArray:
            return np.zeros(size, dtype=np.int64)
        return cls(np.zeros(entries), whole(entries), whole(n + 1), whole(n), whole(n), whole(n),
                   np.zeros(n), whole(n), whole(n), whole(n), whole(n))


@compiled
def factorize(matrix, n, factors):
    """Factorize n columns of a matrix.

    Returns REGULAR; SINGULAR where a pivot is zero, not finite or below `SMALLEST`, of which
    ``starts[n]`` is zero if the factors are not complete; or ROOM if they have too many entries.
    """
    values, rows, x, used = factors.values, factors.rows, factors.x, 0
    least, most = np.inf, 0.0
    for i in range(n):
        factors.order[i] = factors.marks[i] = -1
        x[i] = 0.0
    factors.starts[n] = 0
    for j in range(n):
        top = n
        factors.starts[j] = used
        for p in range(matrix.starts[j], matrix.starts[j + 1]):
            if factors.marks[matrix.rows[p]] != j:
                top = _reach(factors, matrix.rows[p], j, top)
            x[matrix.rows[p]] += matrix.entries[p]
        if used + n - top > values.size:
            return ROOM
        used = _subtract_columns(factors, top, n, used)
        row, largest = _pivot(factors, j, top, n)
        if row < 0:
            return SINGULAR
        pivot = x[row]
        least, most = min(least, abs(pivot)), max(most, largest)
        factors.diagonal[j], factors.pivots[j], factors.order[row] = used, row, j
        values[used], rows[used], x[row] = pivot, row, 0.0
        used += 1
        for t in range(top, n):
            i = factors.found[t]
            if x[i] != 0.0:
                values[used], rows[used], x[i] = x[i] / pivot, i, 0.0
                used += 1
    factors.starts[n] = used
    return REGULAR if least >= SMALLEST * most else SINGULAR


@compiled
def _reach(factors, row, j, top):
    """Put rows that an entry of column j changes before those found so far; returns the first.

    Depth first in the graph of L: a row comes before the rows that its column of L changes.
    """
    marks, path, at, rows = factors.marks, factors.path, factors.at, factors.rows
    depth = 0
    path[0], marks[row], at[0] = row, j, 0
    while depth >= 0:
        i, deeper = path[depth], False
        k = factors.order[i]
        if k >= 0:
            first = factors.diagonal[k] + 1
            p = first + at[depth]
            while p < factors.starts[k + 1] and not deeper:
                deeper = marks[rows[p]] != j
                p += 1
            at[depth] = p - first
            if deeper:
                depth += 1
                path[depth], at[depth] = rows[p - 1], 0
                marks[rows[p - 1]] = j
        if not deeper:
            top -= 1
            factors.found[top] = i
            depth -= 1
    return top


@compiled
def _subtract_columns(factors, top, n, used):
    """Subtract columns of L from column x, and store what it has of U; returns its end."""
    values, rows, x = factors.values, factors.rows, factors.x
    for t in range(top, n):
        i = factors.found[t]
        k, u = factors.order[i], x[i]
        if k < 0 or u == 0.0:
            continue
        for p in range(factors.diagonal[k] + 1, factors.starts[k + 1]):
            x[rows[p]] -= values[p] * u
        values[used], rows[used], x[i] = u, k, 0.0
        used += 1
    return used


@compiled
def _pivot(factors, j, top, n):
    """The row of the pivot of column j, and the largest entry there; -1 without a finite pivot."""
    x, row, largest = factors.x, -1, 0.0
    for t in range(top, n):
        i = factors.found[t]
        if factors.order[i] >= 0:
            continue
        if not abs(x[i]) < np.inf:
            return -1, largest
        if abs(x[i]) > largest:
            row, largest = i, abs(x[i])
    if factors.order[j] < 0 and factors.marks[j] == j and abs(x[j]) >= THRESHOLD * largest > 0.0:
        row = j
    return row, largest


@compiled
def substitute(factors, n, right, out):
    """Solve for `out`, (n,), not the same array as `right`, which is overwritten."""
    values, rows, diagonal, starts = factors.values, factors.rows, factors.diagonal, factors.starts
    for j in range(n):
        y = right[factors.pivots[j]]
        out[j] = y
        if y != 0.0:
            for p in range(diagonal[j] + 1, starts[j + 1]):
                right[rows[p]] -= values[p] * y
    for j in range(n - 1, -1, -1):
        out[j] /= values[diagonal[j]]
        y = out[j]
        if y != 0.0:
            for p in range(starts[j], diagonal[j]):
                out[rows[p]] -= values[p] * y
