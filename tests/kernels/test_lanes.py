"""Maps of rotations, frames and sines in lanes against those of each member's numbers."""

import math

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody.compiler.choice import way
from sebody.compiler.decorators import compiled
from sebody.contract.counts import MEMBERS
from sebody.fem import Section, straight_beam
from sebody.kernels.abi import at, pointer_to
from sebody.kernels.frame_search import best_fit, mean_axes, planar_fit, planar_mean_axes
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

from lane_numbers import Given, columns  # noqa: E402

from sebody.engine.lanes.arrays import empty, numbers  # noqa: E402

EPS = np.finfo(float).eps


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
    arrays[4] = columns(nodes, arrays[4].rows)
    frames(*arrays)
    refused = []
    for member, numbers_of_one in enumerate(given):
        own = [columns(nodes, one.reshape(1, -1).copy()) for one in numbers_of_one]
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
    given = columns(nothing, empty(3, len(angles) // MEMBERS))
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
