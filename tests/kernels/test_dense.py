"""Products with reduced matrices against NumPy's."""

import numpy as np
import pytest

from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES, whole_vectors
from sebody.contract.layout import padded_columns
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.dense import (
    add_block_times,
    add_blocks_times,
    add_rows_times,
    arrow_times,
    block_times,
    columns_times_all,
    rows_times,
)

EPS = np.finfo(float).eps


@compiled
def product(A, x, out, n, filled):
    arrow_times(pointer_to(A), pointer_to(x), pointer_to(out), n, filled)


@pytest.mark.parametrize("n, filled", [(1, 1), (7, 7), (7, 4), (16, 12), (13, 12), (76, 12),
                                       (77, 12), (112, 48), (30, 0)])
def test_arrow_times_a_vector(n, filled):
    """Full rows and columns first, then a diagonal; sizes that are no whole vectors, too."""
    random = np.random.default_rng(n)
    A = random.normal(size=(n, n))
    A[filled:, filled:] = np.diag(random.normal(size=n - filled))
    x, out = random.normal(size=n), np.full(whole_vectors(n) + LANES, 7.0)
    product(padded_columns(A), x, out, n, filled)
    # sums of up to n products
    assert np.abs(out[:n] - A @ x).max() < n * EPS * (np.abs(A) @ np.abs(x)).max()
    assert np.all(out[whole_vectors(n):] == 7.0)        # nothing is written behind the padding


def test_what_is_not_an_arrow_is_seen():
    """The product of a full matrix as if it were an arrow differs: the test above can fail."""
    A, x, out = np.ones((16, 16)), np.ones(16), np.zeros(16)
    product(padded_columns(A), x, out, 16, 12)
    assert np.all(out[12:] == 13.0)


@compiled
def by_block(A, x, out, rows, columns, height, add):
    if add:
        add_block_times(pointer_to(A), pointer_to(x), pointer_to(out), rows, columns, height)
    else:
        block_times(pointer_to(A), pointer_to(x), pointer_to(out), rows, columns, height)


@compiled
def by_blocks(A, x, B, y, out, rows, columns, of_B, height):
    add_blocks_times(pointer_to(A), pointer_to(x), pointer_to(B), pointer_to(y), pointer_to(out),
                     rows, columns, of_B, height)


@compiled
def by_rows(A, x, out, rows, columns, height, add):
    if add:
        add_rows_times(pointer_to(A), pointer_to(x), pointer_to(out), rows, columns, height)
    else:
        rows_times(pointer_to(A), pointer_to(x), pointer_to(out), rows, columns, height)


@pytest.mark.parametrize("rows", [1, 4, 13, 32, 61])    # one, two, four, eight vectors, odd ones
@pytest.mark.parametrize("columns", [0, 1, 3, 4, 6])
def test_blocks_of_taller_matrices(rows, columns):
    """``A x`` and ``A^T x`` of leading rows, set or added; columns are padded by zeros."""
    random = np.random.default_rng(rows + 100 * columns)
    height = whole_vectors(rows) + 8
    A = random.normal(size=(rows, columns))
    stored, tail = np.zeros((columns + 1, height)), whole_vectors(rows)
    stored[:columns, :rows] = A.T
    stored[:, tail:] = np.nan           # beyond the block
    x, y, before = random.normal(size=columns + 1), np.zeros(tail), random.normal(size=height)
    y[:rows] = random.normal(size=rows)
    for add in (False, True):
        out, sums = before.copy(), before.copy()
        by_block(stored.ravel(), x, out, rows, columns, height, add)
        by_rows(stored.ravel(), y, sums, rows, columns, height, add)
        # sums of up to 62 products of numbers of size one
        assert np.abs(out[:rows] - add * before[:rows] - A @ x[:columns]).max() < 1e-13
        assert np.abs(sums[:columns] - add * before[:columns] - A.T @ y[:rows]).max(
            initial=0.0) < 1e-13
        assert np.array_equal(out[tail:], before[tail:])
        both = out.copy()       # the same again, and its first column
        by_blocks(stored.ravel(), x, stored.ravel(), x, both, rows, columns, min(columns, 1),
                  height)
        more = A @ x[:columns] + A[:, :1] @ x[:min(columns, 1)]
        assert np.abs(both[:rows] - out[:rows] - more).max() < 1e-13
        assert np.array_equal(sums[columns:], before[columns:])


@compiled
def three(A, x, out, rows, columns, of, to):
    a, b = pointer_to(x), pointer_to(out)
    columns_times_all(pointer_to(A), a, at(a, of), at(a, 2 * of), b, at(b, to), at(b, 2 * to), rows,
                      columns)


@pytest.mark.parametrize("rows", [1, 4, 12, 18])    # one vector, three, and more
@pytest.mark.parametrize("columns", [0, 1, 7])
def test_three_products_at_once(rows, columns):
    """Nothing is written behind the padding of the products."""
    random, height = np.random.default_rng(rows + columns), whole_vectors(rows)
    A, x = np.zeros((columns + 1, height)), random.normal(size=(3, columns + 2))
    A[:columns, :rows] = random.normal(size=(columns, rows))
    out = np.full((3, height + 3), 5.0)
    three(A.ravel(), x.ravel(), out.ravel(), rows, columns, columns + 2, height + 3)
    # sums of seven products of numbers of size one
    np.testing.assert_allclose(out[:, :height], x[:, :columns] @ A[:columns], atol=1e-14)
    assert (out[:, height:] == 5.0).all()
