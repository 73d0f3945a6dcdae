"""The most stressed nodes of a run, and nodes by their labels in the FE program."""

from dataclasses import replace

import numpy as np
import pytest

from sebody import InputError, Model, simulate
from sebody.fem import hexahedral_block
from sebody.reduction import RigidFace, reduce


@pytest.fixture(scope="module")
def result():
    """A cantilever of bricks, whose labels are no indices, in mm, pushed sideways."""
    model = hexahedral_block((1e4, 0, 0), (60, 6, 8), (8, 2, 2), 2.1e5, 0.3, 7.85e-9)
    count = len(model.coordinates)
    labels = 1000 + np.random.default_rng(5).permutation(count)
    model = replace(model, labels=labels)
    x = model.coordinates[:, 0]
    faces = [(RigidFace((place, 3, 4), np.flatnonzero(np.isclose(x, place))), "full")
             for place in (1e4, 1e4 + 60)]
    body = reduce(model, faces, 3)
    made = Model(units="mm t N s")
    root, tip = (made.node(name, point) for name, point in zip(
        ("root", "tip"), body.coordinates, strict=True))
    made.superelement("arm", body, [root, tip])
    made.fix(root)
    made.force(tip, (0.3, 1.0, 0.2), [(0.0, 0.0), (1e-3, 40.0), (2e-3, -10.0)])
    return simulate(made, h=2e-5, t_end=2e-3)


def test_they_are_the_largest_of_all_states(result):
    field = result.field("arm")
    stresses = np.array([field.von_mises(step) for step in range(len(result.t))])
    highest = np.nanmax(stresses, axis=0)
    order = np.argsort(-highest)[:12]
    labels = result.model.bodies["arm"].reduced.recovery.labels
    spots = result.hot_spots("arm", 12)
    np.testing.assert_allclose([one.von_mises for one in spots], highest[order], rtol=1e-9)
    assert {one.node for one in spots[:11]} <= set(labels[order].tolist())
    for one in spots:
        place = field.label(one.node)
        state = int(np.nanargmax(stresses[:, place]))
        assert one.t == result.t[state]
        np.testing.assert_allclose(one.stress, field.stress(state)[place], rtol=1e-9)
        np.testing.assert_array_equal(one.place, field.fe_places[place])


def test_neighbours_are_one_spot(result):
    spots = result.hot_spots("arm", 6, apart=15.0)
    places = np.array([one.place for one in spots])
    distances = np.linalg.norm(places[:, None] - places, axis=2)[np.triu_indices(len(spots), 1)]
    assert distances.min() >= 15.0 and spots[0].node == result.hot_spots("arm", 1)[0].node
    assert all(one.von_mises >= other.von_mises
               for one, other in zip(spots, spots[1:], strict=False))
    assert len(result.hot_spots("arm", 1000)) == 81      # there are no more


def test_the_table(result):
    text = repr(result.hot_spots("arm", 3))
    head, *rows = text.splitlines()
    assert head.split("  ")[0] == "node" and "von Mises [MPa]" in head and "time [s]" in head
    assert "x [mm]" in head and "xy [MPa]" in head and len(rows) == 3
    assert len({len(line) for line in (head, *rows)}) == 1
    assert result.hot_spots("arm", 3)._repr_html_().count("<tr>") == 4
    pandas = pytest.importorskip("pandas")
    frame = result.hot_spots("arm", 3).to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.shape == (3, 12)


def test_nodes_are_named_by_their_labels(result):
    """A label within the range of the indices would be another node."""
    labels = result.model.bodies["arm"].reduced.recovery.labels
    field = result.field("arm")
    for place in (3, 40):
        np.testing.assert_array_equal(result[f"arm.node{labels[place]}.von_mises"],
                                      field.at(place).von_mises)
    with pytest.raises(InputError, match="'arm.node3.von_mises' is unknown"):
        result["arm.node3.von_mises"]
    with pytest.raises(InputError, match=r"nodes 0 to 80; field.label\(label\) is the number"):
        field.at(1003)


@pytest.mark.parametrize(("arguments", "said"), [
    (("arm", 0), "number of hot spots is 0"), (("arm", 3, -1.0), "apart is -1.0"),
    (("leg",), "'leg'")])
def test_refused(result, arguments, said):
    with pytest.raises(InputError, match=said):
        result.hot_spots(*arguments)


def test_a_body_without_stresses_says_why():
    block = replace(hexahedral_block((0, 0, 0), (3, 1, 1), (3, 1, 1), 1e4, 0.3, 2.0), stress=(),
                    missing={"stresses": "the deck has a flaw; correct it"})
    left = np.flatnonzero(block.coordinates[:, 0] == 0)
    body = reduce(block, [(RigidFace((0, 0.5, 0.5), left), "full")], 1)
    model = Model()
    nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("part", body, nodes)
    model.gravity((0, 0, -9.81))
    result = simulate(model, h=0.01, t_end=0.02)
    with pytest.raises(InputError, match="'part' has no known stresses: the deck has a flaw; "
                                         "correct"):
        result.hot_spots("part")
    said = "body 'part' has no stresses: the deck has a flaw; correct it"
    assert said in result.cautions and f"caution              {said}" in result.summary()
