"""Nodes by their place, in models that are turned, shifted and scaled."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody.basics.errors import InputError
from sebody.fem import FEModel, hexahedral_block
from sebody.fem.selection import nearest_node, nodes_in_box, nodes_on_cylinder, nodes_on_plane

BLOCK = hexahedral_block([0, 0, 0], [4, 2, 1], (4, 2, 1), 1.0, 0.3, 1.0)
TURN = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
SHIFT = np.array([1e3, -2e3, 5e2])


def moved(scale):
    """The block turned, shifted and scaled, and what this makes of a point and a direction."""
    place = lambda point: scale * (TURN @ np.asarray(point, dtype=float) + SHIFT)  # noqa: E731
    points = scale * (BLOCK.coordinates @ TURN.T + SHIFT)
    eye = np.eye(3 * len(points))
    return FEModel(eye, eye, points, ("x", "y", "z")), place, lambda axis: TURN @ np.array(axis)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e4])
def test_planes_and_cylinders_in_general_position(scale):
    model, place, along = moved(scale)
    found = nodes_on_plane(model, place([4, 7, -3]), along([2.5, 0, 0]))
    assert found == tuple(np.flatnonzero(BLOCK.coordinates[:, 0] == 4))
    found = nodes_on_cylinder(model, place([2, 1, 9]), along([0, 0, 3.0]), np.sqrt(5) * scale)
    corners = np.isin(BLOCK.coordinates[:, 0], (0, 4)) & np.isin(BLOCK.coordinates[:, 1], (0, 2))
    assert found == tuple(np.flatnonzero(corners))
    assert nearest_node(model, place([3.9, 2.2, 7])) == np.flatnonzero(
        np.all(BLOCK.coordinates == [4, 2, 1], axis=1))[0]


def test_boxes_and_tolerances():
    found = nodes_in_box(BLOCK, [-np.inf, 0.5, 0], [1, np.inf, 0])
    assert [BLOCK.coordinates[node].tolist() for node in found] == [
        [0, 1, 0], [1, 1, 0], [0, 2, 0], [1, 2, 0]]
    # a tenth of the extent, 4, reaches the nodes 0.4 below the box
    assert nodes_in_box(BLOCK, [3.4, 2, 1], [9, 9, 9], tolerance=0.1) == nodes_in_box(
        BLOCK, [3, 2, 1], [9, 9, 9])


def test_planar_models_have_lines_and_circles():
    points = np.array([[0, 0], [3, 4], [5, 0], [1, 1.0]])
    model = FEModel(np.eye(12), np.eye(12), points, ("x", "y", "rz"))
    assert nodes_on_cylinder(model, [0, 0], None, 5.0) == (1, 2)
    assert nodes_on_plane(model, [9, 9], [1, -1]) == (0, 3)


@pytest.mark.parametrize(("select", "words"), [
    (lambda: nodes_in_box(BLOCK, [5, 0, 0], [6, 1, 1]), "no node in the box .* the nearest, node 4 "
     r"at \[4. 0. 0.\], is 1 away; correct the place or raise the tolerance, which is 1e-06 of 4"),
    (lambda: nodes_in_box(BLOCK, [5, 0, 0], [4, 1, 1]), "give the lower one first"),
    (lambda: nodes_in_box(BLOCK, [5, 0], [6, 1]), "corners of the box are .* give 3 numbers"),
    (lambda: nodes_on_plane(BLOCK, [0.5, 0, 0], [1, 0, 0]), "no node on the plane"),
    (lambda: nodes_on_plane(BLOCK, [0.5, 0, 0], [0, 0, 0]), "normal of the plane is .*direction"),
    (lambda: nodes_on_cylinder(BLOCK, [0, 0, 0], [1, 0, 0], 9.0), "no node on the cylinder"),
    (lambda: nodes_on_cylinder(BLOCK, [0, 0, 0], [1, 0, 0], 0.0), "radius of the cylinder is 0"),
    (lambda: nodes_on_cylinder(BLOCK, [0, 0, 0], None, 1.0), "axis of the cylinder is None"),
    (lambda: nodes_on_plane(BLOCK, [0, 0], [1, 0, 0]), "point of plane is .* give 3 finite"),
    (lambda: nearest_node(3, [0, 0, 0]), "model is 3: give an FEModel"),
])
def test_empty_selections_name_the_nearest_node(select, words):
    with pytest.raises(InputError, match=words):
        select()
