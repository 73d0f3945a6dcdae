"""Products and maps of rotations in lanes against those of each member's numbers."""

import numpy as np
import pytest

from sebody.compiler.choice import way
from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES, MEMBERS, packed_size, whole_vectors
from sebody.kernels.abi import pointer_to
from sebody.kernels.dense import add_blocks_times, add_rows_times, columns_times
from sebody.kernels.packed import pack, pack_couplings
from sebody.kernels.packed_products import (
    add_couplings,
    add_packed,
    couplings_times,
    packed_times,
)
from sebody.kernels.rotations import (
    inverse_tangent_coefficients,
    inverse_tangent_second,
    relative_rotations,
    rotate,
    stumpff_23,
)

if way().__name__.endswith("plain"):
    pytest.skip("the plain way has no lanes", allow_module_level=True)

import sebody.engine.lanes  # noqa: E402, F401  puts functions for lanes in place
from sebody.engine.lanes.arrays import Columns, empty, numbers  # noqa: E402
from sebody.kernels.lanes.straight import write_address  # noqa: E402

EPS = np.finfo(float).eps


class Given(Columns):
    """Arrays of lanes that compiled code reads as `rows`."""

    @classmethod
    def of(cls, values: np.ndarray) -> "Given":
        made = cls(np.zeros(1, dtype=np.int64), empty(1, len(values)), np.zeros(1, dtype=np.int64))
        numbers(made.rows)[0] = values
        return made

    @property
    def values(self) -> np.ndarray:
        return numbers(self.rows)[0]


@compiled
def products(A, x, B, y, set_to, added, dotted, rows, columns, of_B, height):
    columns_times(pointer_to(A.rows), pointer_to(x.rows), pointer_to(set_to.rows), rows, columns)
    add_blocks_times(pointer_to(A.rows), pointer_to(x.rows), pointer_to(B.rows),
                     pointer_to(y.rows), pointer_to(added.rows), rows, columns, of_B, height)
    add_rows_times(pointer_to(A.rows), pointer_to(y.rows), pointer_to(dotted.rows), rows, columns,
                   height)


@pytest.mark.parametrize("rows, columns, of_B", [(1, 1, 2), (7, 5, 3), (16, 12, 1), (13, 0, 4)])
def test_dense_products(rows, columns, of_B):
    """Every member has a matrix and vectors of its own; nothing is written behind the rows."""
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
    np.testing.assert_array_equal(set_to[rows:], begin[rows:])
    np.testing.assert_array_equal(dotted[columns:], begin[columns:])


@compiled
def packed_products_of(packed, x, out, factors, total, count, height):
    packed_times(pointer_to(packed.rows), pointer_to(x.rows), pointer_to(out.rows), count)
    add_packed(pointer_to(packed.rows), pointer_to(factors.rows), pointer_to(total.rows), height)


@pytest.mark.parametrize("straight", [False, True])
def test_packed_products(straight):
    """By strips and as straight code; members differ in their entries, not in their zeros."""
    rng, shape = np.random.default_rng(3), (3, 10, 9)
    count, rows, columns = shape
    pattern = rng.uniform(size=shape) < 0.3
    pattern[:, :4, :8] = True           # a wide strip
    stacks = rng.normal(size=(MEMBERS, *shape)) * pattern
    row = np.array([pack(stack, shape) for stack in stacks]).T
    assert len(row) == packed_size(*shape)
    packed = Given.of(row)
    if straight:
        write_address(row[:, 0].copy(), packed.values)
    height = whole_vectors(rows)
    x = rng.normal(size=(whole_vectors(columns) + LANES, MEMBERS))
    factors = rng.normal(size=(count, MEMBERS))
    out, total = Given.of(np.full((count * height, MEMBERS), np.nan)), Given.of(
        np.zeros((whole_vectors(columns) * height, MEMBERS)))
    packed_products_of(packed, Given.of(x), out, Given.of(factors), total, count * height, height)
    found = out.values.reshape(count, height, MEMBERS)[:, :rows]
    np.testing.assert_allclose(found, np.einsum("mkrc,cm->krm", stacks, x[:columns]), atol=1e-13)
    found = total.values.reshape(-1, height, MEMBERS)[:columns, :rows]
    np.testing.assert_allclose(found, np.einsum("mkrc,km->crm", stacks, factors), atol=1e-13)


@compiled
def couplings_of(packed, x, y, out, factors, of_x, of_y, count, height):
    couplings_times(pointer_to(packed.rows), pointer_to(x.rows), pointer_to(y.rows),
                    pointer_to(out.rows), count)
    add_couplings(pointer_to(packed.rows), pointer_to(factors.rows), pointer_to(of_x.rows),
                  pointer_to(of_y.rows), height)


@pytest.mark.parametrize("straight", [False, True])
def test_couplings(straight):
    """Symmetric matrices and others, large enough to be used twice."""
    rng, N = np.random.default_rng(4), 33
    S, C = rng.normal(size=(MEMBERS, 2, N, N)), rng.normal(size=(MEMBERS, 2, N, N))
    S[:, 1, 12:], C[:, 1, :, 5:] = 0.0, 0.0
    S += S.swapaxes(2, 3)
    every = np.concatenate([S, C, C, C.swapaxes(2, 3)], axis=1)
    row = np.array([pack_couplings(*both) for both in zip(S, C, strict=True)]).T
    packed, height = Given.of(row), whole_vectors(N)
    if straight:
        write_address(row[:, 0].copy(), packed.values)
    x, y = rng.normal(size=(2, height + LANES, MEMBERS))
    factors = rng.normal(size=(8, MEMBERS))
    out = Given.of(np.full((8 * height, MEMBERS), np.nan))
    of_x, of_y = (Given.of(np.zeros((height * height, MEMBERS))) for _ in range(2))
    couplings_of(packed, Given.of(x), Given.of(y), out, Given.of(factors), of_x, of_y,
                 8 * height, height)
    found = out.values.reshape(8, height, MEMBERS)[:, :N]
    expected = [*np.einsum("mkrc,cm->krm", every[:, :4], x[:N]),
                *np.einsum("mkrc,cm->krm", every[:, 4:], y[:N])]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    for total, of in ((of_x, slice(0, 4)), (of_y, slice(4, 8))):
        found = total.values.reshape(-1, height, MEMBERS)[:N, :N]
        np.testing.assert_allclose(
            found, np.einsum("mkrc,km->crm", every[:, of], factors[of]), atol=1e-12)


@compiled
def maps(s, R, frame, out, nodes):
    rows = out.rows
    rows[0, 0], rows[0, 1] = stumpff_23(s.rows[0, 0])
    rows[0, 2], rows[0, 3] = inverse_tangent_coefficients(s.rows[0, 0])
    rows[0, 4] = inverse_tangent_second(s.rows[0, 0])
    psi = pointer_to(R.rows)
    rotate(psi, 0, s.rows[0, 1], s.rows[0, 2], s.rows[0, 3], pointer_to(frame.rows), 0)
    relative_rotations(1, pointer_to(nodes), psi, pointer_to(frame.rows), pointer_to(s.rows))


def test_maps_of_rotations_take_series_and_closed_forms_side_by_side():
    """Small and large arguments among eight members: each as alone; half a turn is no number."""
    rng = np.random.default_rng(2)
    turns = np.concatenate([[0.0, 1e-4, 0.2, 0.6, 1.4, 2.6], [3.1, 0.3]])
    axes = rng.normal(size=(3, MEMBERS))
    psi = axes / np.linalg.norm(axes, axis=0) * turns
    s = Given.of(np.vstack([turns**2, psi]))
    identity = np.tile(np.eye(3).reshape(9, 1), MEMBERS)
    R, frame, out = Given.of(identity), Given.of(identity), Given.of(np.zeros((5, MEMBERS)))
    maps(s, R, frame, out, np.zeros(1, dtype=np.int64))
    for member, square in enumerate(turns**2):
        expected = (*stumpff_23(square), *inverse_tangent_coefficients(square),
                    inverse_tangent_second(square))
        # products and sums fused in other places: a rounding or two of numbers below one
        np.testing.assert_allclose(out.values[:, member], expected, atol=4 * EPS, rtol=1e-12)
        own = np.zeros(9)
        rotate(np.eye(3).ravel(), 0, *psi[:, member], own, 0)
        np.testing.assert_allclose(frame.values[:, member], own, atol=8 * EPS)
    back = s.values[:3]                 # log of the transpose: the rotation back
    far = np.cos(turns) < -0.98
    assert far.sum() == 1 and np.isnan(back[:, far]).all()
    np.testing.assert_allclose(back[:, ~far], -psi[:, ~far], atol=1e-12)
