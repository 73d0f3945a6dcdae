"""Frame weights: closed forms, invariance, and the trap of the printed recipe."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody.basics.errors import InputError
from sebody.fem import Section, frame, hexahedral_block, straight_beam
from sebody.reduction import body_weights, craig_bampton, frame_weights

SECTION = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)
# Weights of order one: some ten roundings of 1 / n and of products with a pseudoinverse, whose
# condition is that of the spread of the nodes, below ten in these cases.
TIGHT = 1e2 * np.finfo(float).eps


def printed_weights(coordinates, centre):
    """Equations (21)-(22) as they stand in the paper."""
    x = np.asarray(coordinates, dtype=float).T
    matrix = np.vstack([x.T @ x, np.ones(x.shape[1])])
    return np.linalg.pinv(matrix) @ np.append(x.T @ centre, 1.0)


def random_rotation(rng):
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q *= np.sign(np.diag(r))
    return q * np.linalg.det(q)


def test_printed_recipe_does_not_add_up_to_one_off_the_nodes_span():
    nodes = [[1, 0, 0], [0, 1, 0]]
    assert_allclose(printed_weights(nodes, np.zeros(3)), [1 / 3, 1 / 3])
    assert_allclose(frame_weights(nodes, np.zeros(3)), [0.5, 0.5], rtol=0, atol=TIGHT)


def test_printed_recipe_depends_on_the_origin():
    nodes = np.array([[0, 0, 0], [100, 100, 0]]) + [1e6, 1e6, 0]
    centre = nodes.mean(axis=0)
    assert_allclose(printed_weights(nodes, centre), [0.499975, 0.500025], atol=1e-6)
    # 1e6 from the origin places have an EPS of 1e-10, to the distance of 100: 1e-12
    assert_allclose(frame_weights(nodes, centre), [0.5, 0.5], rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("nodes", "centre", "expected"),
    [
        ([[3, 4, 5]], [0, 0, 0], [1]),
        ([[3, 4]], [0, 0], [1]),
        ([[0, 0, 0], [4, 0, 0]], [1, 0, 0], [0.75, 0.25]),
        ([[0, 0, 0], [4, 0, 0]], [1, 5, -2], [0.75, 0.25]),  # off the line: nearest point
        ([[2, 2, 2], [2, 2, 2]], [0, 0, 0], [0.5, 0.5]),
        ([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [1, 1, 1], [1 / 3] * 3),
        ([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [2, 2, 2], [-1 / 6, 1 / 3, 5 / 6]),
        ([[0, 0], [1, 0], [0, 1]], [0.2, 0.3], [0.5, 0.2, 0.3]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [0.5, 0.5, 9], [0.25] * 4),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [0.1, 0.2, 0.3], [0.4, 0.1, 0.2, 0.3]),
    ],
)
def test_closed_forms(nodes, centre, expected):
    assert_allclose(frame_weights(nodes, centre), expected, rtol=0, atol=TIGHT)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 8])
def test_order_shift_rotation_and_unit_change_nothing(count):
    rng = np.random.default_rng(count)
    nodes = rng.standard_normal((count, 3))
    centre = rng.dirichlet(np.ones(count)) @ nodes + 0.1
    weights = frame_weights(nodes, centre)
    assert_allclose(weights.sum(), 1.0, rtol=0, atol=TIGHT)
    order = rng.permutation(count)
    assert_allclose(frame_weights(nodes[order], centre), weights[order], rtol=0, atol=TIGHT)
    shift = rng.standard_normal(3)
    assert_allclose(frame_weights(nodes + shift, centre + shift), weights, rtol=0, atol=TIGHT)
    turn = random_rotation(rng)
    assert_allclose(frame_weights(nodes @ turn.T, turn @ centre), weights, rtol=0, atol=TIGHT)
    assert_allclose(frame_weights(1e3 * nodes, 1e3 * centre), weights, rtol=0, atol=TIGHT)


def test_collinear_nodes_in_a_general_direction():
    direction = np.array([1.0, 2.0, -0.7]) / 3
    nodes = np.outer([0.0, 1.0, 3.0], direction) + 10
    middle = nodes.mean(axis=0)
    # ten from the origin, one apart: ten times the rounding, and five times as far off the line
    assert_allclose(frame_weights(nodes, middle), [1 / 3] * 3, rtol=0, atol=1e-14)
    assert_allclose(frame_weights(nodes, middle + np.cross(direction, [0, 0, 5])), [1 / 3] * 3,
                    rtol=0, atol=1e-13)


def test_nodes_nearly_in_a_plane_or_on_a_line_have_weights_of_this_plane_or_line():
    """Weights that reached a centre off the plane were millions of both signs."""
    random = np.random.default_rng(4)
    square = np.array([[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0.0]]) / 2
    line = np.array([[0, 0], [0.5, 0], [1, 0.0]])
    for nodes, centre in ((square, [0.1, 0.05, 0.3]), (line, [0.4, 0.2])):
        flat, off = frame_weights(nodes, centre), random.normal(size=nodes.shape)
        for size in (1e-12, 1e-9, 1e-6, 1e-4):
            # thickness over (a tenth of the width) squared, times the way to the centre
            change = np.abs(frame_weights(nodes + size * off, centre) - flat).max()
            assert change < 100 * size * np.linalg.norm(off)


def test_thick_clouds_of_nodes_reach_the_centre_and_thin_ones_go_on_from_there():
    square = np.array([[1, 1, 1], [-1, 1, -1], [-1, -1, 1], [1, -1, -1.0]])
    centre = np.array([0.1, 0.05, 0.03])
    for thickness, reached in ((0.2, 1.0), (0.1 + 1e-9, 1.0), (0.1 - 1e-9, 1.0), (0.01, 0.01)):
        nodes = square * [1, 1, thickness]
        mean = frame_weights(nodes, centre) @ nodes
        assert_allclose(mean, centre * [1, 1, reached], rtol=0, atol=1e-7)


@pytest.mark.parametrize("count", [2, 3, 5, 9])
def test_centres_within_the_hull_are_reached_and_others_as_far_as_moderate_weights_do(count):
    random = np.random.default_rng(count)
    nodes = random.standard_normal((count, 3))
    middle = nodes.mean(axis=0)
    for corner in range(count):                     # of the hull, where weights are largest
        inside = random.dirichlet(0.1 * np.ones(count)) @ nodes
        for centre in (nodes[corner], inside):
            mean = frame_weights(nodes, centre) @ nodes
            directions = np.linalg.svd(nodes - middle)[2][:count - 1]
            assert_allclose(directions @ mean, directions @ centre, rtol=0, atol=1e-12)
    far = middle + 50.0 * (nodes[0] - middle)
    weights = frame_weights(nodes, far)
    assert np.linalg.norm(weights - 1 / count) <= 1.0 + TIGHT
    towards = weights @ nodes - middle              # straight towards the centre
    assert_allclose(towards / np.linalg.norm(towards),
                    (far - middle) / np.linalg.norm(far - middle), rtol=0, atol=1e-12)


def test_body_weights_of_beam_frame_and_solid():
    beam = straight_beam([0, 0, 0], [100, 100, 0], SECTION, 10)
    for weights in body_weights(craig_bampton(beam, {0: "full", 10: "full"}, 2)):
        # centres of reduced masses: EPS times the condition of the condensation, 2e4
        assert_allclose(weights, [0.5, 0.5], rtol=0, atol=1e-11)
    # Positions at nodes 0 and 2, rotations at 0 and 1: each set has its own weights.
    elbow = frame([[0, 0, 0], [5, 0, 0], [5, 3, 0]], [(0, 1), (1, 2)], SECTION, 4)
    body = craig_bampton(elbow, {0: "full", 1: "rotation", 2: "translation"}, 0)
    centre = np.array([27.5 / 8, 4.5 / 8, 0])
    positions, rotations = body_weights(body)
    tip = centre @ [5, 3, 0] / 34
    assert_allclose(positions, [1 - tip, tip], rtol=0, atol=1e-10)
    assert_allclose(rotations, [1 - centre[0] / 5, centre[0] / 5], rtol=0, atol=1e-10)
    solid = hexahedral_block([0, 0, 0], [2, 3, 1], (2, 2, 2), 2.1e6, 0.3, 7.8e-3)
    corners = [solid.node_at((x, y, z)) for x in (0, 2) for y in (0, 3) for z in (0, 1)]
    body = craig_bampton(solid, [(node, "translation") for node in corners], 0)
    positions, rotations = body_weights(body)
    assert_allclose(positions, 1 / 8, rtol=0, atol=1e-12)       # a condition of 130
    assert rotations.shape == (0,)


def test_bad_input_is_named():
    with pytest.raises(InputError, match=r"coordinates have shape \(2, 3\) and centre_of_mass"):
        frame_weights(np.zeros((2, 3)), np.zeros(2))
    with pytest.raises(InputError, match="not finite"):
        frame_weights([[0, 0, np.nan]], np.zeros(3))
