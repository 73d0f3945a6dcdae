"""Interfaces of decks as CalculiX has them: middles of faces, cylinders, surfaces, stray nodes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model
from sebody.fem import hexahedral_block
from sebody.fem.cylinders import middle_of
from sebody.io import import_body, read_fe_model
from sebody.io.interfaces import parsed, tied
from sebody.reduction import RigidFace, craig_bampton

# as decks.py places its drawings, in which the hole of radius 4 is about z, from 0 to 5
TURN = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
PLACE = np.array([1e4, -2e3, 500.0])
MIDDLE = PLACE + TURN @ [0, 0, 2.5]
AXIS = ",".join(map(repr, TURN[:, 2].tolist()))
START = ",".join(map(repr, PLACE.tolist()))
NUMBERS = 1e-7      # of places near 1e4 with twelve digits


@pytest.fixture(scope="module")
def hole(decks):
    return read_fe_model(decks / "hole.inp")


def interface(model, text):
    """The face of an interface and what is said of it."""
    boundary = tied(model, parsed([f"pin={text}"]), {})
    return boundary.items[0][0], boundary.notes["pin"]


@pytest.mark.parametrize("tie", ["rbe2", "rbe3"])
@pytest.mark.parametrize("where", ["BORE", "wall"])
def test_the_middle_of_a_hole_is_on_its_axis_however_uneven_its_mesh(hole, tie, where):
    face, said = interface(hole, f"{tie}:{where}")
    np.testing.assert_allclose(face.point, MIDDLE, atol=NUMBERS)
    mean = hole.coordinates[list(face.nodes)].mean(axis=0)
    assert np.linalg.norm(mean - MIDDLE) > 1.0         # of the radius of 4
    assert "about the middle of the cylinder of radius 4 along (" in said


def test_nodes_without_rows_are_left_out_and_said(hole):
    """One of the set's nodes belongs to no element and lies far away."""
    stray = hole.node(9001)
    assert stray in hole.node_set("BORE") and stray not in hole.node_set("WALL")
    bore, said = interface(hole, "rbe2:BORE")
    wall, _ = interface(hole, "rbe2:WALL")
    assert set(bore.nodes) == set(wall.nodes) == set(hole.node_set("BORE")) - {stray}
    assert said.endswith("; 1 nodes without rows left out: 9001")


def test_the_middle_of_other_faces_is_their_centroid(hole):
    """Of a plane face; of a half shell it is on the axis all the same."""
    local = (hole.coordinates - PLACE) @ TURN
    face, said = interface(hole, "rbe2:EDGE")       # a rectangle
    corners = local[list(face.nodes)]
    np.testing.assert_allclose((face.point - PLACE) @ TURN,
                               (corners.min(axis=0) + corners.max(axis=0)) / 2, atol=NUMBERS)
    assert said.endswith("about the centroid of their faces")
    half = [node for node in hole.node_set("WALL") if local[node, 1] > -1e-6]
    middle = middle_of(hole, half)
    np.testing.assert_allclose(middle.point, MIDDLE, atol=NUMBERS)
    assert middle.cylinder.radius == pytest.approx(4.0, abs=NUMBERS)
    thin = [node for node in half if local[node, 0] > 3.5]      # too little of the arc to tell
    flat = middle_of(hole, thin)
    assert flat is None or flat.cylinder is None


def test_the_middle_of_no_faces_is_the_mean(hole):
    inside = replace(hole, cells=())
    face, said = interface(inside, "rbe2:WALL")
    np.testing.assert_allclose(face.point,
                               inside.coordinates[list(inside.node_set("WALL"))].mean(axis=0))
    assert said.endswith("about their mean: no faces lie within them")
    given, said = interface(hole, "rbe2:WALL@1,2,3")
    np.testing.assert_array_equal(given.point, (1, 2, 3))
    assert said.endswith("about the point given")


@pytest.mark.parametrize("text", [f"cylinder:{START};{AXIS};4", f"rbe3:cylinder:{START};{AXIS};4",
                                  f"cylinder:{START};{AXIS};4;10.1:full"])
def test_a_hole_by_its_place(hole, text):
    """Nodes in the middles of straight edges, which lie within the radius, belong to it."""
    face, _ = interface(hole, text)
    assert sorted(face.nodes) == sorted(hole.node_set("WALL"))
    # the point that is typed, which is off the mesh's middle, and which models repeat
    np.testing.assert_array_equal(face.point, [float(word) for word in START.split(",")])
    away = (hole.coordinates[list(face.nodes)] - PLACE) @ TURN
    assert np.hypot(*away[:, :2].T).min() < 3.8


@pytest.mark.parametrize(("text", "said"), [
    (f"cylinder:{START};{AXIS};5", "interface 'pin': no outer faces are on the cylinder of radius "
                                   "5 about the axis .* have the radii 4"),
    (f"cylinder:{START};{AXIS};4;3", "have the radii 4.*, or give a larger length"),
    (f"cylinder:{START};1,0,0;4", "no outer faces are about this axis; correct its point and"),
    (f"cylinder:{START};0,0,0;4", "interface 'pin': axis of a cylinder is .*: give a direction"),
    (f"cylinder:{START};z;-4", "interface 'pin': radius of a cylinder is -4"),
    (f"cylinder:{START};z", "interface 'pin' is .*: write name=NODE.*name=cylinder:x,y,z;axis;rad"),
    ("cylinder:1,2;z;3", "interface 'pin' is "),
    ("rbe2:BOER", "interface 'pin': node set 'BOER' is unknown: known are 'WALL', 'BORE', 'EDGE'"),
    ("7777", "interface 'pin': the model has no node with the label 7777; labels near it are"),
    ("9001", "interface 'pin': node 9001 has no rows in the matrices: no element has it"),
])
def test_what_is_refused_names_the_interface(hole, text, said):
    with pytest.raises(InputError, match=said):
        interface(hole, text)


def test_reductions_name_the_interface(decks, hole):
    """Nodes on a line, and nodes that two interfaces have."""
    local = (hole.coordinates - PLACE) @ TURN
    line = np.flatnonzero((np.abs(local[:, 0] - 12) < 1e-6) & (np.abs(local[:, 2]) < 1e-6))
    model = replace(hole, node_sets={"LINE": line.tolist()})
    from sebody.reduction import reduce
    for tie, word in (("rbe2", "the rigid face 'pin' lie on a line"),
                      ("rbe3", "the mean face 'pin' by area has nodes on no face"),
                      ("rbe3-equal", "the mean face 'pin' lie on a line")):
        with pytest.raises(InputError, match=word):
            reduce(model, tied(model, parsed([f"pin={tie}:LINE"]), {}).items)
    with pytest.raises(InputError, match="interfaces 'a' and 'b' share node"):
        import_body(decks / "hole.inp", {"a": "rbe2:BORE", "b": "rbe2:WALL"})


def test_faces_that_are_tied_already(beam_deck):
    with pytest.raises(InputError, match="interface 'tip': none of its 21 nodes has rows in the "
                                         "matrices: .*such as tip=900001/900002"):
        import_body(beam_deck, {"tip": "rbe2:FACEA"})


def test_a_label_is_no_index(hole):
    """Where indices are meant and a label is given, the message says how to get the index."""
    from sebody.reduction import craig_bampton
    with pytest.raises(InputError, match=r"node 9001 unknown: the model has nodes 0 to \d+ by "
                                         r"their indices; the index of .* is model.node\(9001\)"):
        craig_bampton(hole, [(9001, "translation")], 0)


def test_nodes_of_a_model_lie_where_those_of_the_body_are():
    """The message has the body's places, and speaks of a rotation only where one helps."""
    block = hexahedral_block((1, 2, 3), (4, 1, 1), (4, 1, 1), 1e4, 0.25, 2.0)
    ends = [RigidFace((x, 2.5, 3.5), np.flatnonzero(np.isclose(block.coordinates[:, 0], x)))
            for x in (1, 5)]
    body = craig_bampton(block, [(face, "full") for face in ends], 1)

    def built(points):
        model = Model()
        nodes = [model.node(name, point) for name, point in zip("ab", points, strict=True)]
        model.superelement("block", body, nodes)
    with pytest.raises(InputError, match=r"off by 0.0005 .*, at \(1, 2.5, 3.5\), \(5, 2.5, 3.5\): "
                                         "give the nodes these places.*no rotation= makes"):
        built([(1, 2.5, 3.5), (5.001, 2.5, 3.5)])
    with pytest.raises(InputError, match="pass rotation=, the matrix that turns FE axes"):
        built([(0, 0, 0), (0, 4, 0)])
