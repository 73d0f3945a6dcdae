"""Products in lanes against those of each member's numbers."""

import gc
import weakref

import numpy as np
import pytest

from sebody.compiler.choice import way
from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES, MEMBERS, packed_size, whole_vectors
from sebody.kernels.abi import pointer_to
from sebody.kernels.dense import (
    add_blocks_times,
    add_rows_times,
    columns_times,
    columns_times_all,
)
from sebody.kernels.packed import diagonals_of, multiples, pack
from sebody.kernels.packed_couplings import pack_couplings
from sebody.kernels.packed_products import (
    add_couplings,
    add_packed,
    add_packed_times,
    couplings_times,
    packed_times,
)

if way().__name__.endswith("plain"):
    pytest.skip("the plain way has no lanes", allow_module_level=True)

from lane_numbers import Given, numbers_of_all  # noqa: E402

from sebody.kernels.lanes.constant_products import (  # noqa: E402
    add_straight_times,
    straight_times,
)
from sebody.kernels.lanes.straight import (  # noqa: E402
    KEPT,
    entries_of,
    straight_code,
    write_address,
    write_matrix_address,
    write_shared_address,
)

EPS = np.finfo(float).eps


@compiled
def products(A, x, B, y, set_to, added, dotted, rows, columns, of_B, height):
    columns_times(pointer_to(A.rows), pointer_to(x.rows), pointer_to(set_to.rows), rows, columns)
    add_blocks_times(pointer_to(A.rows), pointer_to(x.rows), pointer_to(B.rows),
                     pointer_to(y.rows), pointer_to(added.rows), rows, columns, of_B, height)
    add_rows_times(pointer_to(A.rows), pointer_to(y.rows), pointer_to(dotted.rows), rows, columns,
                   height)


@pytest.mark.parametrize("rows, columns, of_B", [(1, 1, 2), (7, 5, 3), (16, 12, 1), (13, 0, 4)])
def test_dense_products(rows, columns, of_B):
    """Members have matrices of their own, or share them; nothing is written behind the rows."""
    rng, height = np.random.default_rng(rows), whole_vectors(rows)
    A, B = rng.normal(size=(columns + 1, height, MEMBERS)), rng.normal(size=(of_B, height, MEMBERS))
    x, y = rng.normal(size=(columns + 1, MEMBERS)), rng.normal(size=(max(of_B, height), MEMBERS))
    begin = rng.normal(size=(max(rows, columns) + 1, MEMBERS))
    given = [Given.of(one.reshape(-1, MEMBERS)) for one in (A, x, B, y, begin, begin, begin)]
    products(*given, rows, columns, of_B, height)
    set_to, added, dotted = (one.values for one in given[4:])
    Ax = np.einsum("crm,cm->rm", A[:columns, :rows], x[:columns])
    By = np.einsum("crm,cm->rm", B[:, :rows], y[:of_B])
    bound = 8 * (rows + columns + of_B) * EPS * 30        # of sums of products of some ones
    np.testing.assert_allclose(set_to[:rows], Ax, atol=bound, rtol=0)
    np.testing.assert_allclose(added[:rows], begin[:rows] + Ax + By, atol=bound, rtol=0)
    expected = begin[:columns] + np.einsum("crm,rm->cm", A[:columns, :rows], y[:rows])
    np.testing.assert_allclose(dotted[:columns], expected, atol=bound, rtol=0)
    shared = [numbers_of_all(one[:, :, 0].reshape(-1)) for one in (A, B)]
    given[4:] = [Given.of(begin) for _ in range(3)]
    products(shared[0], given[1], shared[1], given[3], *given[4:], rows, columns, of_B, height)
    Ax, By = A[:columns, :rows, 0].T @ x[:columns], B[:, :rows, 0].T @ y[:of_B]
    np.testing.assert_allclose(given[5].values[:rows], begin[:rows] + Ax + By, atol=bound, rtol=0)
    np.testing.assert_array_equal(set_to[rows:], begin[rows:])
    np.testing.assert_array_equal(dotted[columns:], begin[columns:])


@compiled
def three(A, x, y, z, of_x, of_y, of_z, rows, columns):
    columns_times_all(pointer_to(A.rows), pointer_to(x.rows), pointer_to(y.rows),
                      pointer_to(z.rows), pointer_to(of_x.rows), pointer_to(of_y.rows),
                      pointer_to(of_z.rows), rows, columns)


def test_three_products_at_once():
    """Of matrices that members have of their own."""
    rng, rows, columns = np.random.default_rng(6), 6, 5
    A, given = rng.normal(size=(columns, 8, MEMBERS)), rng.normal(size=(3, columns, MEMBERS))
    out = [Given.of(np.full((rows + 1, MEMBERS), 5.0)) for _ in range(3)]
    three(Given.of(A.reshape(-1, MEMBERS)), *map(Given.of, given), *out, rows, columns)
    for x, found in zip(given, out, strict=True):
        expected = np.einsum("crm,cm->rm", A[:, :rows], x)
        np.testing.assert_allclose(found.values[:rows], expected, atol=1e-13)
        assert (found.values[rows] == 5.0).all()


@compiled
def straight_products(A, x, out, more, count):
    straight_times(pointer_to(A.rows), pointer_to(x.rows), pointer_to(out.rows), count)
    add_straight_times(pointer_to(A.rows), pointer_to(x.rows), pointer_to(more.rows))


@pytest.mark.parametrize("columns", [9, 30])        # factors that stay in registers, and others
def test_products_of_shared_matrices(columns):
    """As straight code of what is not zero; nothing is written behind the rows."""
    rng, rows = np.random.default_rng(columns), 12
    A = rng.normal(size=(rows, columns)) * (rng.uniform(size=(rows, columns)) < 0.4)
    A[[0, 7, 11]] = 0.0
    x, begin = rng.normal(size=(columns, MEMBERS)), rng.normal(size=(rows + 1, MEMBERS))
    given, out, more = numbers_of_all(A), Given.of(begin), Given.of(begin)
    kept, _code = write_matrix_address(A, given.rows[0])
    straight_products(given, Given.of(x), out, more, rows)
    assert given.rows[0, :1].view(np.int64) == kept.ctypes.data
    np.testing.assert_allclose(out.values[:rows], A @ x, atol=1e-13)
    np.testing.assert_allclose(more.values[:rows], begin[:rows] + A @ x, atol=1e-13)
    for found in out, more:
        np.testing.assert_array_equal(found.values[rows], begin[rows])


@compiled
def packed_products_of(packed, x, out, factors, total, count, height):
    packed_times(pointer_to(packed.rows), pointer_to(x.rows), pointer_to(out.rows), count)
    add_packed_times(pointer_to(packed.rows), pointer_to(x.rows), pointer_to(out.rows))
    add_packed(pointer_to(packed.rows), pointer_to(factors.rows), pointer_to(total.rows), height)


@pytest.mark.parametrize("straight, shared, row_of_all", [
    (False, 0.0, False), (True, 0.0, False), (True, 0.5, False), (False, 1.0, True),
    (True, 1.0, True), (True, 0.5, True)])
def test_packed_products(straight, shared, row_of_all):
    """By strips and as straight code; members differ in entries, perhaps some, not in zeros."""
    rng, shape = np.random.default_rng(3), (3, 10, 9)
    count, rows, columns = shape
    pattern = rng.uniform(size=shape) < 0.3
    pattern[:, :4, :8] = True           # a wide strip
    stacks = rng.normal(size=(MEMBERS, *shape)) * pattern
    same = rng.uniform(size=shape) < shared
    stacks[:, same] = stacks[0, same]
    row = np.array([pack(stack, shape) for stack in stacks]).T
    assert len(row) == packed_size(*shape)
    packed = lanes = Given.of(row)
    if row_of_all:
        packed = numbers_of_all(row[:, 0].copy())
    if straight and row_of_all:         # entries that members have of their own stay in lanes
        kept, _code = write_shared_address(packed.rows[0], np.ptp(row, axis=1) > 0.0, lanes.values)
        assert packed.rows[0, :1].view(np.int64) == kept.ctypes.data
    elif straight:
        _code = write_address(row[:, 0].copy(), np.ptp(row, axis=1) > 0.0, packed.values)
    height = whole_vectors(rows)
    x = rng.normal(size=(whole_vectors(columns) + LANES, MEMBERS))
    factors = rng.normal(size=(count, MEMBERS))
    out, total = Given.of(np.full((count * height, MEMBERS), np.nan)), Given.of(
        np.zeros((whole_vectors(columns) * height, MEMBERS)))
    packed_products_of(packed, Given.of(x), out, Given.of(factors), total, count * height, height)
    found = out.values.reshape(count, height, MEMBERS)[:, :rows]
    expected = 2.0 * np.einsum("mkrc,cm->krm", stacks, x[:columns])     # set, then added once more
    np.testing.assert_allclose(found, expected, atol=1e-13)
    if row_of_all and shared < 1.0:     # matrices of members are not made from such rows
        return
    found = total.values.reshape(-1, height, MEMBERS)[:columns, :rows]
    np.testing.assert_allclose(found, np.einsum("mkrc,km->crm", stacks, factors), atol=1e-13)


@pytest.mark.parametrize("straight, row_of_all", [
    (False, False), (True, False), (False, True), (True, True)])
def test_diagonals(straight, row_of_all):
    """Those that stand apart, beside a full row, by number and as straight code."""
    rng, N = np.random.default_rng(7), 20
    stacks = np.zeros((MEMBERS, 1, N, N))
    stacks[:, 0, range(N), range(N)] = rng.normal(size=(MEMBERS, N))
    stacks[:, 0, 1] = rng.normal(size=(MEMBERS, N))
    if row_of_all:
        stacks[:] = stacks[0]
    row = np.array([pack(stack, stack.shape) for stack in stacks]).T
    assert len(list(diagonals_of(row[:, 0]))) == 1
    packed = numbers_of_all(row[:, 0].copy()) if row_of_all else Given.of(row)
    if straight and row_of_all:
        _kept = write_shared_address(packed.rows[0], np.ptp(row, axis=1) > 0.0, row)
    elif straight:
        _kept = write_address(row[:, 0].copy(), np.ptp(row, axis=1) > 0.0, packed.values)
    x, factors = rng.normal(size=(N + LANES, MEMBERS)), rng.normal(size=(1, MEMBERS))
    out, total = Given.of(np.full((N, MEMBERS), np.nan)), Given.of(np.zeros((N * N, MEMBERS)))
    packed_products_of(packed, Given.of(x), out, Given.of(factors), total, N, N)
    expected = np.einsum("mrc,cm->rm", stacks[:, 0], x[:N])
    np.testing.assert_allclose(out.values, 2.0 * expected, atol=1e-13)
    np.testing.assert_allclose(total.values.reshape(N, N, MEMBERS),
                               np.einsum("mrc,m->crm", stacks[:, 0], factors[0]), atol=1e-13)


def test_straight_code_is_freed_once_nobody_keeps_it():
    """Some are kept for the next ensemble; one in use works when it is not among them any more."""
    rng, shape = np.random.default_rng(5), (1, 4, 4)
    stack, nothing = rng.normal(size=shape), np.zeros(packed_size(*shape), dtype=bool)
    row = pack(stack, shape)
    packed = Given.of(np.tile(row[:, np.newaxis], MEMBERS))
    used = write_address(row, nothing, packed.values)
    others = [weakref.ref(straight_code(entries_of(pack(rng.normal(size=shape), shape), nothing)))
              for _ in range(KEPT + 2)]
    gc.collect()
    assert [code() is None for code in others] == [True, True] + [False] * KEPT
    assert straight_code(entries_of(row, nothing)) is not used
    x, out = rng.normal(size=(8, MEMBERS)), Given.of(np.full((4, MEMBERS), np.nan))
    packed_products_of(packed, Given.of(x), out, Given.of(np.zeros((1, MEMBERS))),
                       Given.of(np.zeros((16, MEMBERS))), 4, 4)
    np.testing.assert_allclose(out.values, 2.0 * stack[0] @ x[:4], atol=1e-13)


@compiled
def couplings_of(packed, x, y, out, factors, scales, of_x, of_y, products, height):
    couplings_times(pointer_to(packed.rows), pointer_to(x.rows), pointer_to(y.rows),
                    pointer_to(out.rows), products * height)
    add_couplings(pointer_to(packed.rows), pointer_to(factors.rows), pointer_to(scales.rows),
                  pointer_to(of_x.rows), pointer_to(of_y.rows), products, height, height)


@pytest.mark.parametrize("straight", [False, True])
def test_couplings(straight):
    """Symmetric matrices and others, large enough to be used twice, and one made from another."""
    rng, N = np.random.default_rng(4), 33
    S, C = rng.normal(size=(MEMBERS, 2, N, N)), rng.normal(size=(MEMBERS, 2, N, N))
    S[:, 1, 12:], C[:, 1, :, 5:] = 0.0, 0.0
    S += S.swapaxes(2, 3)
    S[:, 1, :20, :20] = S[:, 1, 20:, 20:] = 0.0
    C[:, 0] = S[:, 1] * np.where(np.arange(N) < 20, 3.0, -0.7)[:, np.newaxis]
    every = np.concatenate([S, C, C, C.swapaxes(2, 3)], axis=1)
    row = np.array([pack_couplings(*both) for both in zip(S, C, strict=True)]).T
    assert len(list(multiples(row[:, 0]))) == 3
    packed, height = Given.of(row), whole_vectors(N)
    if straight:
        _code = write_address(row[:, 0].copy(), np.ptp(row, axis=1) > 0.0, packed.values)
    x, y = rng.normal(size=(2, height + LANES, MEMBERS))
    factors, products = np.zeros((10, MEMBERS)), 10     # with two that others are made from
    factors[:8] = rng.normal(size=(8, MEMBERS))
    out, scales = (Given.of(np.full((products * height, MEMBERS), np.nan)) for _ in range(2))
    of_x, of_y = (Given.of(np.zeros((height * height, MEMBERS))) for _ in range(2))
    couplings_of(packed, Given.of(x), Given.of(y), out, Given.of(factors), scales, of_x, of_y,
                 products, height)
    found = out.values.reshape(products, height, MEMBERS)[:8, :N]
    expected = [*np.einsum("mkrc,cm->krm", every[:, :4], x[:N]),
                *np.einsum("mkrc,cm->krm", every[:, 4:], y[:N])]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    for total, of in ((of_x, slice(0, 4)), (of_y, slice(4, 8))):
        found = total.values.reshape(-1, height, MEMBERS)[:N, :N]
        np.testing.assert_allclose(
            found, np.einsum("mkrc,km->crm", every[:, of], factors[of]), atol=1e-12)
