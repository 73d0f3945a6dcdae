"""Means of FE nodes as interfaces, against dense Lagrange multipliers and polar decompositions."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import linalg
from scipy.spatial.transform import Rotation
from spinning_body import turned_resultants

from sebody.basics.errors import InputError
from sebody.fem import FEModel, hexahedral_block, planar_beam, straight_beam
from sebody.fem.faces import surface_mass
from sebody.fem.section import Section
from sebody.fem.selection import nodes_on_plane
from sebody.reduction import MeanFace, RigidFace, clamped, craig_bampton
from sebody.reduction.interfaces import MeanMotion

STEEL = (2.1e6, 0.3, 7.8e-3)
SQUARE = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)
BLOCK = hexahedral_block([1, 2, 3], [6, 2, 1.5], (4, 2, 2), *STEEL)
LEFT, RIGHT = (nodes_on_plane(BLOCK, [x, 0, 0], [1, 0, 0]) for x in (1, 7))
TOP = tuple(n for n in nodes_on_plane(BLOCK, [0, 0, 4.5], [0, 0, 1]) if n not in LEFT + RIGHT)
POINT = np.array([7.5, 3.3, 3.2])
RANDOM = np.random.default_rng(3)
WEIGHTS = RANDOM.uniform(1, 3, len(TOP))


def least_squares(nodes, point, weights):
    """Rigid motion (6, 3 k) of `point` that fits the displacements best, by a pseudo-inverse."""
    arms = BLOCK.coordinates[list(nodes)] - point
    rigid = np.vstack([np.hstack([np.eye(3), np.cross(np.eye(3), arm).T]) for arm in arms])
    root = np.kron(np.linalg.cholesky(weights).T, np.eye(3))
    return np.linalg.pinv(root @ rigid) @ root


def rows_of(nodes):
    return (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()


def functional(nodes, rows):
    whole = np.zeros((len(rows), BLOCK.stiffness.shape[0]))
    whole[:, rows_of(nodes)] = rows
    return whole


def areas(nodes):
    return surface_mass(BLOCK, np.array(nodes)).toarray()


def middle(nodes):
    return areas(nodes).sum(axis=0) @ BLOCK.coordinates[list(nodes)] / areas(nodes).sum()


RIGHT_MOTION = functional(RIGHT, least_squares(RIGHT, POINT, areas(RIGHT)))
LEFT_MOTION = functional(LEFT, least_squares(LEFT, middle(LEFT), np.eye(9)))
TOP_CENTRE = WEIGHTS @ BLOCK.coordinates[list(TOP)] / WEIGHTS.sum()
TOP_MOTION = functional(TOP, least_squares(TOP, TOP_CENTRE, np.diag(WEIGHTS)))
CASES = {
    "two means": (
        [(MeanFace(LEFT, weights="equal"), "full"), (MeanFace(RIGHT, POINT), "full")],
        [LEFT_MOTION[:3], RIGHT_MOTION[:3], LEFT_MOTION[3:], RIGHT_MOTION[3:]]),
    "parts of means": (
        [(MeanFace(RIGHT, POINT), "translation"), (MeanFace(TOP, weights=WEIGHTS), "rotation"),
         (MeanFace(LEFT, weights="equal"), "translation")],
        [RIGHT_MOTION[:3], LEFT_MOTION[:3], TOP_MOTION[3:]]),
    "a node holds some": (
        [(LEFT[0], "translation"), (MeanFace(RIGHT, POINT), "full")],
        [np.eye(135)[rows_of(LEFT[:1])], RIGHT_MOTION[:3], RIGHT_MOTION[3:]]),
}


@pytest.mark.parametrize("sparse", [False, True])
@pytest.mark.parametrize("case", CASES)
def test_means_are_those_of_lagrange_multipliers(case, sparse, monkeypatch):
    if sparse:
        monkeypatch.setattr(clamped, "_DENSE_LIMIT", 0)
    items, parts = CASES[case]
    C = np.vstack(parts)
    count = len(C)
    K, M = BLOCK.stiffness.toarray(), BLOCK.mass.toarray()
    saddle = np.block([[K, C.T], [C, np.zeros((count, count))]])
    scale = np.append(np.ones(len(K)), np.full(count, np.abs(K).max()))
    right = np.vstack([np.zeros((len(K), count)), np.eye(count)])
    static = (scale[:, None] * np.linalg.solve(scale[:, None] * saddle * scale,
                                               scale[:, None] * right))[:len(K)]
    still = linalg.null_space(C)
    squares, shapes = linalg.eigh(still.T @ K @ still, still.T @ M @ still)
    shapes = still @ shapes[:, :5]
    body = craig_bampton(BLOCK, items, 5)
    signs = np.append(np.ones(count), np.sign(np.sum(
        shapes * (M @ body.recovery.shapes[:, count:count + 5]), axis=0)))
    basis = np.hstack([static, shapes]) * signs
    assert_allclose(np.diag(body.stiffness)[count:], squares[:5], rtol=1e-9)
    for name, matrix in (("stiffness", K), ("mass", M)):
        expected = basis.T @ matrix @ basis
        # condition of the clamped block 1e4, of the saddle point 1e6: EPS times both
        unit = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
        assert np.abs((getattr(body, name) - expected) / unit).max() < 1e-9, name
    found = C @ body.recovery.shapes[:, :count + 5]
    assert_allclose(found, np.eye(count, count + 5), atol=1e-10)


def test_forces_on_a_mean_spread_over_its_nodes():
    """A force at the point and the same force as a uniform traction make the same displacement."""
    body = craig_bampton(BLOCK, [(RigidFace([1, 3, 3.75], LEFT), "full"),
                                 (MeanFace(RIGHT), "full")], 0)
    free = np.r_[3:6, 9:12]     # of the mean face; the rigid one is clamped
    force = np.array([10.0, -20.0, 30.0])
    y = np.zeros(12)
    y[free] = np.linalg.solve(body.stiffness[np.ix_(free, free)], [*force, 0, 0, 0])
    traction = np.zeros((45, 3))
    traction[list(RIGHT)] = np.outer(areas(RIGHT).sum(axis=0), force) / 3.0     # area 2 x 1.5
    inside = np.setdiff1d(np.arange(135), rows_of(LEFT))
    exact = np.zeros(135)
    exact[inside] = np.linalg.solve(BLOCK.stiffness.toarray()[np.ix_(inside, inside)],
                                    traction.ravel()[inside])
    found = body.recovery.shapes[:, :12] @ y
    assert_allclose(found, exact, atol=1e-10 * np.abs(exact).max())


def best_fit(motion, weights, arms, lever, displacements):
    """Displacement of the point and rotation vector by the polar decomposition."""
    portions = weights.sum(axis=0) / weights.sum()
    left, _, right = np.linalg.svd((arms + displacements).T @ weights @ arms)
    turn = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    psi = Rotation.from_matrix(turn).as_rotvec()
    return np.concatenate([portions @ displacements + turn @ lever - lever, psi])


def test_second_order_is_that_of_the_best_fitting_rotation():
    model = MeanMotion(BLOCK, MeanFace(RIGHT, POINT))
    weights = areas(RIGHT)
    centre = middle(RIGHT)
    arms = BLOCK.coordinates[list(RIGHT)] - centre
    force, moment = RANDOM.normal(size=(2, 3))
    shapes = RANDOM.normal(size=(len(RIGHT), 3, 4))
    # differences of second order: rounding 1e-10 and third order 1e-6, both beside the step 1e-3
    step, work = 1e-3, np.concatenate([force, moment])

    def potential(amplitudes):
        return -work @ best_fit(model, weights, arms, POINT - centre, shapes @ amplitudes)
    unit = step * np.eye(4)
    found = np.array([[(potential(a + b) - potential(a - b) - potential(b - a) + potential(-a - b))
                       / (4 * step**2) for a in unit] for b in unit])
    exact = model.second_order(force, moment, shapes)
    assert_allclose(exact, found, atol=1e-4 * np.abs(found).max())


def test_turning_a_body_with_means_makes_no_resultants():
    for items, _ in CASES.values():
        if any(keep == "rotation" for _, keep in items):
            continue        # the turned body's coordinates are those of nodes with positions
        body = craig_bampton(BLOCK, items, 2)
        # constraint modes have the rounding of their solution, a condition of 1e6
        assert turned_resultants(body).max() < 1e-9


def test_a_rigid_face_that_keeps_its_position_alone_is_free_to_turn():
    """Its rotation is an internal DOF: held by another face it is that of the full interface."""
    faces = RigidFace([1, 3, 3.75], LEFT), RigidFace(POINT, RIGHT)
    whole = craig_bampton(BLOCK, [(face, "full") for face in faces], 0)
    part = craig_bampton(BLOCK, [(faces[0], "full"), (faces[1], "translation")], 0)
    keep, free = np.arange(9), np.arange(9, 12)
    K = whole.stiffness[np.ix_(keep, keep)] - whole.stiffness[np.ix_(keep, free)] @ np.linalg.solve(
        whole.stiffness[np.ix_(free, free)], whole.stiffness[np.ix_(free, keep)])
    assert_allclose(part.stiffness, K, atol=1e-10 * np.abs(K).max())
    # a node that turns as the face does has a stress resultant of second order, too
    assert turned_resultants(part).max() < 1e-9


def test_planar_means():
    """The mean of one node with its own weight is the node; two nodes hold a rotation."""
    beam = planar_beam([1, 2], [4, 6], SQUARE, 4)
    ends = craig_bampton(beam, [(0, "full"), (4, "translation")], 2)
    means = craig_bampton(beam, [(0, "full"), (MeanFace((4,), weights="equal"), "translation")], 2)
    assert_allclose(means.stiffness, ends.stiffness, atol=1e-9 * np.abs(ends.stiffness).max())
    chord = craig_bampton(beam, [(0, "full"), (MeanFace((2, 4), (3, 5.0), "equal"), "full")], 2)
    shapes = chord.recovery.shapes[:, :6].reshape(5, 3, 6)
    span = beam.coordinates[4] - beam.coordinates[2]
    turned = (shapes[4] - shapes[2])[:2].T @ [-span[1], span[0]] / (span @ span)
    assert_allclose(turned, np.eye(6)[5], atol=1e-10)
    assert turned_planar(chord) < 1e-9


def turned_planar(body):
    """Resultants of a planar body that turns as a whole; see `turned_resultants`."""
    i = body.invariants
    arms = body.coordinates - i.origin
    second = np.zeros(len(body.mass))
    second[:arms.size] = -arms.ravel() / 2
    y = body.rigid_modes_about(i.origin)[:, 2]
    parts = i.lam * (i.E.T @ second), i.Ghat @ y @ y / 2
    return np.abs(sum(parts)).max() / np.abs(parts).max()


ROD = straight_beam([0, 0, 0], [4, 0, 0], SQUARE, 4)
LINE = tuple(n for n in TOP if BLOCK.coordinates[n, 1] == 3)
BARE = FEModel(BLOCK.stiffness, BLOCK.mass, BLOCK.coordinates, BLOCK.node_dofs,
               labels=1000 + np.arange(45))


@pytest.mark.parametrize(("model", "items", "words"), [
    (BLOCK, [(MeanFace(LEFT), "full"), (MeanFace((*RIGHT, LEFT[2])), "full")],
     rf"boundary node {LEFT[2]} appears more than once, in the interfaces 0 and 1; name it once"),
    (BLOCK, [(MeanFace(LEFT), "full"), (RigidFace(POINT, (*RIGHT, LEFT[2])), "full")],
     "appears more than once, in the interfaces 0 and 1"),
    (BARE, [(MeanFace(LEFT, weights="equal"), "full"), (LEFT[2], "translation")],
     f"boundary node {1000 + LEFT[2]} appears more than once"),
    (BLOCK, [(MeanFace(LEFT), "full"), (MeanFace(LINE, weights="equal"), "full")],
     "nodes of a mean face lie on a line, so they do not determine its rotation about the line"),
    (BLOCK, [(MeanFace(LEFT), "full"), (MeanFace(LINE, POINT, "equal"), "translation")],
     "lie on a line"),
    (BLOCK, [(MeanFace((*RIGHT, TOP[0])), "full")],
     f"by area has nodes on no face that lies within it: node {TOP[0]}; name all nodes"),
    (BARE, [(MeanFace(LEFT), "full")], "node 1000, node 1005, .*and more; .*FEModel its cells"),
    (BLOCK, [(MeanFace((3, 99)), "full")], "node 99 of a mean face unknown"),
    (BLOCK, [(MeanFace(LEFT), "all")], f"node {LEFT[0]} of a mean face keeps 'all'; choose"),
    (BLOCK, [(MeanFace(LEFT, (1, 2)), "full")], "point of a mean face is .* give 3 finite"),
    (BLOCK, [(MeanFace(LEFT), "translation")], "a mechanism inside.: the whole body can, most at "),
    (BLOCK, [(MeanFace(LEFT), "rotation"), (MeanFace(RIGHT), "rotation")], "whole body can, most"),
    (ROD, [(MeanFace((0, 1), weights="equal"), "translation"), (3, "translation")],
     "a mechanism inside"),
])
def test_means_that_cannot_be_are_refused(model, items, words):
    with pytest.raises(InputError, match=words):
        craig_bampton(model, items, 2)


@pytest.mark.parametrize(("options", "words"), [
    ({"nodes": []}, "a mean face has no nodes: name the FE nodes it is the mean of"),
    ({"nodes": [0.5]}, "node of a mean face is 0.5"),
    ({"point": (0, np.nan, 0)}, "point of a mean face is"),
    ({"weights": "mass"}, "weights of a mean face is 'mass': give 'area', 'equal' or 3 positive"),
    ({"weights": [1, 2]}, "weights of a mean face is"),
    ({"weights": [1, 2, 0]}, "weights of a mean face is .*3 positive numbers"),
])
def test_bad_mean_faces_are_refused(options, words):
    with pytest.raises(InputError, match=words):
        MeanFace(**{"nodes": (0, 1, 2), **options})


def test_faces_by_themselves_keep_both_blocks():
    faces = RigidFace(BLOCK.coordinates[LEFT[0]], LEFT), MeanFace(RIGHT)
    found = craig_bampton(BLOCK, list(faces), 2)
    expected = craig_bampton(BLOCK, [(face, "full") for face in faces], 2)
    for name in ("stiffness", "mass"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
    with pytest.raises(InputError, match="a boundary node is 3: give pairs"):
        craig_bampton(BLOCK, [faces[0], 3], 2)
