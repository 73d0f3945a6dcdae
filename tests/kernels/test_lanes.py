"""Products and maps of rotations in lanes against those of each member's numbers."""

import gc
import math
import weakref

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody.compiler.choice import way
from sebody.compiler.decorators import compiled
from sebody.contract.counts import LANES, MEMBERS, packed_size, whole_vectors
from sebody.fem import Section, straight_beam
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.dense import (
    add_blocks_times,
    add_rows_times,
    columns_times,
    columns_times_all,
)
from sebody.kernels.frame_search import best_fit, mean_axes, planar_fit, planar_mean_axes
from sebody.kernels.packed import multiples, pack
from sebody.kernels.packed_couplings import pack_couplings
from sebody.kernels.packed_products import (
    add_couplings,
    add_packed,
    add_packed_times,
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
from sebody.reduction import craig_bampton
from sebody.reduction.mean_rotation import mean_rotation

if way().__name__.endswith("plain"):
    pytest.skip("the plain way has no lanes", allow_module_level=True)

import sebody.engine.lanes  # noqa: E402, F401  puts functions for lanes in place
from sebody.engine.lanes.arrays import Columns, empty, numbers  # noqa: E402
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


def numbers_of_all(values: np.ndarray) -> Columns:
    """Numbers that all members share, as compiled code reads them."""
    nothing = np.zeros(1, dtype=np.int64)
    return Columns(nothing, values.reshape(1, -1).copy(), nothing)


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


@compiled
def frames(X, alpha, Gam, q, R, found):
    """Frames of two points and rotations, and of three points, one after the other."""
    psi, nodes, fit = at(pointer_to(found.rows), 40), pointer_to(R.places), pointer_to(alpha.rows)
    x, own, frame = pointer_to(q.rows), pointer_to(X.rows), pointer_to(found.rows)
    of_mean = mean_axes(2, 2, 14, nodes, fit, own, pointer_to(Gam.rows), x, pointer_to(R.rows),
                        frame, psi)
    in_plane = planar_mean_axes(2, 1, 7, fit, at(own, 15), at(pointer_to(Gam.rows), 42), at(x, 23),
                                at(frame, 9), at(psi, 6))
    points = at(x, 14)
    fitted = best_fit(3, at(fit, 2), at(own, 6), at(fit, 2), points, at(frame, 18))
    flat = planar_fit(3, at(fit, 2), at(own, 6), at(fit, 2), points, at(frame, 27))
    return of_mean, in_plane, fitted, flat


def test_frames_of_members_are_those_of_each_alone():
    """Bodies that are turned a little or far; where one alone has no frame it is no number."""
    rng = np.random.default_rng(11)
    section = Section(area=4.0, inertia_y=1.2, inertia_z=0.9, torsion=2.0, youngs_modulus=2e6,
                      poisson_ratio=0.3, density=7e-3)
    body = craig_bampton(straight_beam((1.0, -2.0, 0.5), (4.0, 2.0, 3.0), section, elements=3),
                         [(0, "full"), (3, "full")], modes=2)
    mean = mean_rotation(body).T
    middle = body.coordinates.mean(axis=0)
    flat = (body.coordinates - middle)[:, :2]
    X = np.concatenate([(body.coordinates - middle).ravel(), rng.normal(size=9), flat.ravel()])
    plane = mean[[0, 1, 3, 4, 8, 12, 13], 2]
    alpha = np.array([0.5, 0.5, 0.3, 0.3, 0.4])
    given = []
    for member, angle in enumerate((0.1, 0.3, 1.3, 0.0, 2.2, 0.4, 0.7, 0.2)):
        axis = rng.normal(size=3)
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
        points = turn.apply(body.coordinates.copy()) + 0.02 * rng.normal(size=(2, 3))
        own = turn * Rotation.from_rotvec(0.1 * rng.normal(size=(2, 3)))
        others = turn.apply(X[6:15].reshape(3, 3)) * (member != 5) + 3.0
        planar = flat @ Rotation.from_rotvec((0, 0, angle)).as_matrix()[:2, :2].T
        q = np.concatenate([points.ravel(), 0.1 * rng.normal(size=8), others.ravel(),
                            planar.ravel(), [angle + 0.05], 0.1 * rng.normal(size=2)])
        given.append((X, alpha, np.concatenate([mean.ravel(), plane]), q,
                      own.as_matrix().ravel(), np.concatenate([np.eye(3).ravel()] * 6)))
    together = [np.array(one).T for one in zip(*given, strict=True)]
    arrays, nodes = [Given.of(one) for one in together], np.arange(2)
    arrays[4] = Columns(nodes, arrays[4].rows, nodes)
    frames(*arrays)
    refused = []
    for member, numbers_of_one in enumerate(given):
        own = [Columns(nodes, one.reshape(1, -1).copy(), nodes) for one in numbers_of_one]
        statuses = frames(*own)
        expected, found = own[5].rows[0], arrays[5].values[:, member]
        refused += [(member, k) for k, status in enumerate(statuses) if status != 0]
        for k, status in enumerate(statuses):
            part = slice(9 * k, 9 * k + 9)
            if status != 0:
                assert np.isnan(found[part]).any()
            else:       # Newton's last step leaves the square of 1e-8, and rounding
                np.testing.assert_allclose(found[part], expected[part], atol=1e-13)
        for k, part in enumerate((slice(40, 46), slice(46, 47))):
            if statuses[k] == 0:
                np.testing.assert_allclose(found[part], expected[part], atol=1e-13)
    assert {(5, 2), (5, 3)} <= set(refused) and len(refused) < 6


@compiled
def sines_of(given):
    """Sines in the place of the second row, and cosines in that of the third."""
    for k in range(given.rows.shape[1]):
        x = given.rows[0, k]
        given.rows[1, k], given.rows[2, k] = math.sin(x), math.cos(x)


def sines_in_lanes(angles: np.ndarray) -> np.ndarray:
    """Sines and cosines of angles, eight at a time."""
    nothing = np.zeros(1, dtype=np.int64)
    given = Columns(nothing, empty(3, len(angles) // MEMBERS), nothing)
    numbers(given.rows)[0] = angles.reshape(-1, MEMBERS)
    sines_of(given)
    return numbers(given.rows)[1:].reshape(2, -1).copy()


def test_sines_and_cosines_are_those_of_mpmath():
    """Small and large angles, and those next to multiples of pi/2, where digits cancel."""
    rng = np.random.default_rng(3)
    near = np.round(rng.uniform(-6e5, 6e5, 200)) * (np.pi / 2)
    angles = np.concatenate([rng.uniform(-4, 4, 400), rng.uniform(-1e6, 1e6, 200), near,
                             np.nextafter(near, 0), 10.0 ** rng.uniform(-300, 15, 196),
                             [0.0, np.pi / 4, 355.0, 1e22]])
    found = sines_in_lanes(angles)
    for x, *both in zip(angles, *found, strict=True):
        for got, exact in zip(both, (mpmath.sin(x), mpmath.cos(x)), strict=True):
            assert abs(mpmath.mpf(got) - exact) <= 2 * EPS * max(abs(exact), 1e-16), x


def test_a_sine_does_not_depend_on_its_neighbours():
    angles = np.array([0.3, -2.0, 7.0, 1e5, -40.0, 1.5, 3.1, -0.0])
    alone = sines_in_lanes(angles)
    for others in (np.inf, np.nan, 1e300):
        mixed = np.where(np.arange(MEMBERS) % 2, others, angles)
        found = sines_in_lanes(mixed)
        assert np.array_equal(found[:, ::2], alone[:, ::2])
        expected = np.full(MEMBERS // 2, np.sin(others) if others == 1e300 else np.nan)
        assert np.allclose(found[0, 1::2], expected, rtol=EPS, equal_nan=True)
