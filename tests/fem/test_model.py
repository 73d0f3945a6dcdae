"""FE models whose nodes have different DOFs: rows by a map, labels, sets, mass fields."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.fem import FEModel, hexahedral_block, straight_beam
from sebody.fem.section import Section
from sebody.reduction import MeanFace, RigidFace, craig_bampton

STEEL = (210e3, 0.3, 7.85e-9)
SQUARE = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)
RANDOM = np.random.default_rng(17)


def mapped(model, order):
    """The model with its rows in another order, and the map that says so."""
    names = [(node, name) for node in range(len(model.coordinates)) for name in model.node_dofs]
    return FEModel(model.stiffness[order][:, order], model.mass[order][:, order],
                   model.coordinates, dof_map=[names[row] for row in order])


def block_with_reference(point):
    """A block whose end face moves with a reference node of six DOFs, as FE programs write it.

    Returns
    -------
    model : FEModel
        Solid nodes, of which those of the face have no DOFs, and the reference node, the last one.
    whole : FEModel
        The block alone.
    face : list of int
    """
    whole = hexahedral_block([1, 2, 3], [40, 10, 6], (4, 2, 1), *STEEL)
    face = np.flatnonzero(whole.coordinates[:, 0] > 40.9)
    free = np.setdiff1d(np.arange(len(whole.coordinates)), face)
    arms = whole.coordinates[face] - point
    T = np.zeros((whole.stiffness.shape[0], 3 * len(free) + 6))
    rows = (3 * free[:, None] + np.arange(3)).ravel()
    T[rows, np.arange(len(rows))] = 1.0
    for node, arm in zip(face, arms, strict=True):
        T[3 * node:3 * node + 3, -6:-3] = np.eye(3)
        T[3 * node:3 * node + 3, -3:] = np.cross(np.eye(3), arm).T
    names = [(int(node), axis) for node in free for axis in "xyz"]
    last = len(whole.coordinates)
    names += [(last, name) for name in ("x", "y", "z", "rx", "ry", "rz")]
    K, M = (T.T @ (matrix @ T) for matrix in (whole.stiffness, whole.mass))
    model = FEModel(K, M, np.vstack([whole.coordinates, point]), dof_map=names)
    return model, whole, face


def test_rows_in_any_order_give_the_same_body():
    beam = straight_beam([0, 0, 0], [100, 100, 0], SQUARE, 6)
    shuffled = mapped(beam, RANDOM.permutation(42))
    ends = {0: "full", 6: "full"}
    expected, found = craig_bampton(beam, ends, 3), craig_bampton(shuffled, ends, 3)
    # rounding of another elimination order: EPS times the condition of 6 elements, 1e4; the sign
    # of a mode follows the first of its largest components, so the order of rows
    signs = np.append(np.ones(12), np.sign(np.sum(
        found.recovery.shapes[:, 12:15] * expected.recovery.shapes[:, 12:15], axis=0)))
    for name in ("stiffness", "mass"):
        matrix = getattr(expected, name)
        assert_allclose(np.outer(signs, signs) * getattr(found, name), matrix, rtol=0,
                        atol=1e-11 * np.abs(matrix).max())
    assert_allclose(found.recovery.shapes[:, :12], expected.recovery.shapes[:, :12], atol=1e-10)
    assert shuffled.node_dofs == beam.node_dofs
    for kind in ("full", "translation", "rotation"):
        rows = shuffled.dofs(4, kind)
        assert [shuffled.dof_map[row] for row in rows] == [
            (4, name) for name in shuffled.node_dofs
            if kind == "full" or (kind == "rotation") == name.startswith("r")]


def test_a_solid_with_a_reference_node_is_the_solid_with_a_rigid_face():
    point = np.array([43.0, 7.5, 5.0])
    model, whole, face = block_with_reference(point)
    reference = len(whole.coordinates)
    assert len(model.dofs(reference)) == 6
    assert len(model.dofs(0)) == 3
    assert len(model.dofs(int(face[0]))) == 0
    other = np.flatnonzero(whole.coordinates[:, 0] < 1.1).tolist()
    held = RigidFace([0.0, 5.0, 6.0], other)
    expected = craig_bampton(whole, [(held, "full"), (RigidFace(point, face.tolist()), "full")], 4)
    found = craig_bampton(model, [(held, "full"), (reference, "full")], 4)
    # condition of the clamped block, 1e4, times EPS, of entries of 1e8 beside the diagonal
    for name in ("stiffness", "mass"):
        matrix = getattr(expected, name)
        scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
        assert_allclose(getattr(found, name) / scale, matrix / scale, rtol=0, atol=1e-11)
    # the reference node's share of the face's mass is none of a point there
    assert model.mass_field is None
    shape = found.displacements(np.eye(16)[9]).reshape(-1, 6)
    assert_array_equal(shape[face], 0.0)    # nodes without DOFs
    assert_allclose(shape[reference], np.eye(6)[3], atol=1e-14)     # its own rotation about x


def test_interfaces_need_the_dofs_they_keep():
    """In mixed models nodes may lack what an interface keeps; the message names both."""
    point = np.array([43.0, 7.5, 5.0])
    model, whole, face = block_with_reference(point)
    model = replace(model, labels=100 + np.arange(len(model.coordinates)))
    left = np.flatnonzero(whole.coordinates[:, 0] < 1.1).tolist()
    slaved = 100 + int(face[0])
    for items, words in (
            ([(0, "full")], "boundary node 100 has no rx, ry, rz; it keeps 'full': keep what it "),
            ([(int(face[0]), "translation")], f"boundary node {slaved} has no x, y, z; it keeps"),
            ([(MeanFace(face.tolist(), weights="equal"), "full")],
             f"node {slaved} of a mean face has no x, y, z; name nodes that have them")):
        with pytest.raises(InputError, match=words):
            craig_bampton(model, items, 0)
    # the three translations that a solid node of a mixed model has are enough
    body = craig_bampton(model, [(left[0], "translation"), (len(model.coordinates) - 1, "full")], 2)
    assert body.keeps == ("translation", "full")


def lumped(count, turning):
    """Mass of `count` nodes with six DOFs: coupled translations, `turning` on the rotations."""
    factor = RANDOM.normal(size=(count, count))
    mass = np.zeros((count, 6, count, 6))
    for axis in range(3):
        mass[:, axis, :, axis] = factor @ factor.T
    for node in range(count):
        mass[node, 3:, node, 3:] = turning
    return mass.reshape(6 * count, 6 * count)


@pytest.mark.parametrize("turning", [np.zeros((3, 3)), np.diag([1.0, 2.0, 3.0]) + 0.1])
def test_lumped_rotary_inertia_and_massless_rotations_have_a_field_of_points(turning):
    mass = lumped(4, turning)
    model = FEModel(np.eye(24), mass, RANDOM.normal(size=(4, 3)))
    assert_allclose(model.mass_field.matrix().toarray(), mass, rtol=1e-14)
    assert (model.mass_field.rotation is None) == (not turning.any())


def test_masses_that_are_none_of_points_have_no_field():
    coupled = lumped(3, np.eye(3))
    coupled[0, 10] = coupled[10, 0] = 0.01      # x of node 0 with a rotation of node 1
    between = lumped(3, np.eye(3))
    between[3, 9] = between[9, 3] = 0.01        # rotations of two nodes
    uneven = lumped(3, np.eye(3))
    uneven[0, 0] *= 1.1
    for mass in (coupled, between, uneven):
        assert FEModel(np.eye(18), mass, RANDOM.normal(size=(3, 3))).mass_field is None


def test_labels_sets_and_names():
    block = hexahedral_block([0, 0, 0], [2, 1, 1], (2, 1, 1), *STEEL)
    labels = 100 + 7 * np.arange(12)
    model = replace(block, labels=labels, node_sets={"tip": [2, 5, 8, 11]}, units="t mm s")
    assert model.node(114) == 2
    assert model.node_name(2) == "node 114"
    assert block.node_name(2) == "node 2"
    assert model.node_set("tip") == (2, 5, 8, 11)
    with pytest.raises(InputError, match="no node with the label 120; labels near it are 114, 12"):
        model.node(120)
    with pytest.raises(InputError, match="the model has no node labels; use node indices, from 0"):
        block.node(3)
    with pytest.raises(InputError, match="node set 'root' is unknown: known are 'tip'"):
        model.node_set("root")
    with pytest.raises(InputError, match="the model has none; select nodes by place"):
        block.node_set("root")
    with pytest.raises(InputError, match="the nearest, node 100, is"):
        model.node_at([-1, 0, 0])


def with_map(change):
    """A model of one node with six DOFs whose map is changed."""
    names = [(0, name) for name in ("x", "y", "z", "rx", "ry", "rz")]
    return lambda: FEModel(np.eye(6), np.eye(6), [[0, 0, 0]], dof_map=change(names))


@pytest.mark.parametrize(("build", "words"), [
    (with_map(lambda d: d[:5]), r"stiffness has shape \(6, 6\); the 5 rows of dof_map need \(5, "),
    (with_map(lambda d: [*d[:5], (1, "rz")]), r"dof_map\[5\] is \(1, 'rz'\): give one pair per row "
     "of the matrices: a node from 0 to 0 and one of x, y, z, rx, ry, rz"),
    (with_map(lambda d: [*d[:5], (0, "w")]), r"dof_map\[5\] is \(0, 'w'\)"),
    (with_map(lambda d: [*d[:5], (0, "x")]), "x of node 0 in the rows 0 and 5: name each DOF once"),
    (with_map(lambda d: [*d[:5], 3]), r"dof_map\[5\] is 3: give one pair"),
    (with_map(lambda d: [*d[:5], (0.5, "x")]), r"dof_map\[5\]: the node is 0.5"),
    (with_map(lambda d: 7), "dof_map is 7"),
    (lambda: replace(BLOCK, labels=[1, 2]), r"labels have shape \(2,\); 8 nodes need \(8,\)"),
    (lambda: replace(BLOCK, labels=[1, 2, 3, 4, 5, 6, 7, 3]), "label 3 is that of the nodes 2 and"),
    (lambda: replace(BLOCK, labels=np.full(8, 0.5)), "labels is .*give 8 different whole numbers"),
    (lambda: replace(BLOCK, node_sets={"a": [9]}), "node set 'a' has the node 9: give node indices "
     "from 0 to 7"),
    (lambda: replace(BLOCK, node_sets={"a": [1, 1]}), "node set 'a' names a node more than once"),
    (lambda: replace(BLOCK, node_sets=[1]), "node_sets is .*give a dict"),
    (lambda: replace(BLOCK, cells=[("quad", [[0, 1, 2, 8]])]), "cells of kind 'quad' has the node "
     "8"),
    (lambda: replace(BLOCK, cells=[("quad", [0, 1])]), r"cells of kind 'quad' have shape \(2,\)"),
    (lambda: replace(BLOCK, cells=["quad"]), "cells: one kind is 'quad'"),
])
def test_wrong_maps_and_meshes_are_refused(build, words):
    with pytest.raises(InputError, match=words):
        build()


BLOCK = hexahedral_block([0, 0, 0], [1, 1, 1], (1, 1, 1), *STEEL)


def test_planar_models_by_a_map():
    names = [(0, "x"), (0, "y"), (0, "rz"), (1, "x"), (1, "y")]
    model = FEModel(sparse.eye_array(5), sparse.eye_array(5), [[0, 0], [1, 0]], dof_map=names)
    assert model.node_dofs == ("x", "y", "rz")
    assert_array_equal(model.rows, [[0, 1, 2], [3, 4, -1]])
    assert_array_equal(model.mass_field.inertia[:, 0, 0], [1.0, 0.0])
