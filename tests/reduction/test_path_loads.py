"""Static modes of loads on paths: exact answers at their nodes, nodes of sets put in order."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from sebody import InputError, Model
from sebody.fem import frame, hexahedral_block, planar_beam, straight_beam, tube
from sebody.fem.loads import point_load
from sebody.io import load_body, save_body
from sebody.reduction import PathLoads, ReducedBody, RigidFace, craig_bampton, reduce

TURN = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
PLACE = np.array([40.0, -20.0, 5.0])
STEEL = tube(0.02, 0.004, youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)


@pytest.fixture(scope="module")
def block():
    """A slender block with sets in an order of no meaning."""
    made = hexahedral_block((0, -0.01, -0.01), (1, 0.02, 0.02), (12, 2, 2), 2.1e11, 0.3, 7850.0)
    _, y, z = made.coordinates.T
    shuffled = np.random.default_rng(3).permutation
    edge = np.flatnonzero(np.isclose(y, 0.0) & np.isclose(z, 0.01))
    return replace(made, node_sets={"RAIL": shuffled(edge).tolist(),
                                    "TOP": shuffled(np.flatnonzero(np.isclose(z, 0.01))).tolist()})


def faces(model):
    """Rigid faces at both ends."""
    x = model.coordinates[:, 0]
    return [RigidFace((a, 0.0, 0.0), np.flatnonzero(np.isclose(x, a))) for a in (0.0, 1.0)]


def test_static_answers_at_the_nodes_of_a_path_are_exact(block):
    """Against the FE model with held ends."""
    body = reduce(block, faces(block), 1, paths={"rail": PathLoads("RAIL", 5)})
    rail, held = body.paths["rail"], len(body.stiffness) - body.modes
    np.testing.assert_allclose(np.abs(np.diff(block.coordinates[rail], axis=0)),
                               np.outer(np.ones(12), (1 / 12, 0, 0)), atol=1e-12)
    assert body.modes == 1 + 10
    inside = np.flatnonzero(~np.isin(np.arange(len(block.coordinates)), [
        node for face in faces(block) for node in face.nodes]))
    free = np.concatenate([block.dofs(node) for node in inside])
    K = block.stiffness.tocsc()[free][:, free]
    for node in rail[[2, 4, 6, 8, 10]]:      # at equal distances between the held ends
        for force in ((0, 0, 1.0), (0, 1.0, 0)):
            load = point_load(block, int(node), force)
            exact = np.zeros(len(load))
            exact[free] = spsolve(K, load[free])
            y = np.zeros(len(body.stiffness))
            shapes = body.recovery.shapes
            y[held:] = np.linalg.solve(body.stiffness[held:, held:],
                                       shapes[:, held:len(y)].T @ load)
            found = shapes[:, :len(y)] @ y
            assert load @ found == pytest.approx(load @ exact, rel=1e-9)
            own = np.abs(found - exact)[np.concatenate([block.dofs(k) for k in rail])]
            assert own.max() < 1e-9 * np.abs(exact).max()


def test_nodes_of_a_set_are_put_in_order_along_a_curve():
    """An arc of three quarters of a circle, whose ends are nearer than its middle."""
    angles = np.linspace(0.0, 1.5 * np.pi, 25)
    points = PLACE + np.column_stack([np.cos(angles), np.sin(angles), 0 * angles]) @ TURN.T
    arc = frame(points, [(k, k + 1) for k in range(24)], STEEL, 1)
    own = [arc.node_at(point) for point in points]
    mixed = np.random.default_rng(1).permutation(own).tolist()
    arc = replace(arc, node_sets={"ARC": mixed})
    body = craig_bampton(arc, {own[0]: "full", own[-1]: "full"}, 0, paths={"ARC": "ARC"})
    order = body.paths["ARC"].tolist()
    assert order in (own, own[::-1])
    assert order[0] == next(node for node in mixed if node in (own[0], own[-1]))
    assert body.modes == 14 and "path 'ARC': 25 nodes from node" in body.summary()


def test_shapes_of_paths_stay_in_lean_files_and_models_know_their_names(block, tmp_path):
    body = reduce(block, faces(block), 2, recover=[0], paths={"rail": "RAIL"})
    assert len(body.recovery.coordinates) == 13 + (0 not in body.paths["rail"])
    whole = reduce(block, faces(block), 2, paths={"rail": "RAIL"})
    lean = load_body(save_body(whole, tmp_path / "lean.npz", recovery=False))
    full = load_body(save_body(whole, tmp_path / "full.npz"))
    lengths = []
    for one in (whole, full, lean, body):
        np.testing.assert_array_equal(one.paths["rail"], whole.paths["rail"])
        model = Model()
        nodes = [model.node(name, point) for name, point in zip("ab", one.coordinates, strict=True)]
        model.superelement("girder", one, nodes)
        path = model.path("rail", on="girder", nodes="rail")
        lengths.append(path.length)
        np.testing.assert_allclose(path.pieces[0].points, block.coordinates[one.paths["rail"]],
                                   atol=1e-12)
    assert lengths == pytest.approx([1.0] * 4, rel=1e-12)
    assert lean.recovery.shapes.size < whole.recovery.shapes.size / 8 and not lean.recovery.stress
    with pytest.raises(InputError, match="path 'new': path of superelement 'girder', 'rial' is "
                                         "unknown: did you mean 'rail'"):
        model.path("new", on="girder", nodes="rial")


def test_a_planar_body_and_one_direction():
    beam = planar_beam((0, 0), (2, 0), STEEL, 10)
    body = reduce(beam, {0: "full", 10: "full"}, 0, "guyan", paths={"axis": range(11)})
    assert body.modes == 7 and body.paths["axis"].tolist() == list(range(11))
    spatial = straight_beam((0, 0, 0), (2, 0, 0), STEEL, 10)
    assert reduce(spatial, {0: "full"}, 1, paths={"axis": PathLoads(range(11), 3, "y")}).modes == 4


@pytest.mark.parametrize(("paths", "said"), [
    (3, "paths"), ({"a": 3}, "path 'a': nodes is 3: give the name of a node set, FE nodes in"),
    ({"a": "RIAL"}, "path 'a': node set 'RIAL' is unknown: known are 'RAIL', 'TOP'"),
    ({"a": "TOP"}, "path 'a': the nodes of its set are not in one line: at node .* lines meet"),
    ({"a": [0, 1, 999]}, "path 'a': a node is 999: the model has nodes 0 to"),
    ({"a": [0]}, "path 'a' has 1 node: give two different ones"),
    ({"a": [0, 1, 0]}, "path 'a' has 2 nodes of which some are given twice"),
    ({"a": [0, 13]}, "path 'a': interfaces hold all its nodes"),
    ({"a": PathLoads("RAIL", 0)}, "path 'a': number of loads is 0"),
    ({"a": PathLoads("RAIL", 5, "up")}, "path 'a': axis is 'up': give x, y, z, or none for all"),
    ({"": "RAIL"}, "name of a path")])
def test_wrong_paths(block, paths, said):
    x = block.coordinates[:, 0]
    ends = np.flatnonzero(np.isclose(x, 0.0))
    if paths == {"a": [0, 13]}:
        paths = {"a": ends[:2].tolist()}
    with pytest.raises(InputError, match=said):
        reduce(block, faces(block), 1, paths=paths)


def test_wrong_methods_and_wrong_paths_of_bodies(block):
    for method in ("rubin", "macneal"):
        with pytest.raises(InputError, match="paths are for methods 'craig-bampton' and 'guyan'"):
            reduce(block, faces(block), 2, method, paths={"a": "RAIL"})
    body = reduce(block, faces(block), 0, "guyan")
    for paths, said in (({"a": [0, 999]}, "path 'a' has the FE node 999, whose shapes the body"),
                        ({"a": [0]}, "path 'a' has 1 FE nodes: give two"),
                        ({"a": [0, 0.5]}, "path 'a': a node is 0.5"), (3, "paths is 3")):
        with pytest.raises(InputError, match=said):
            replace(body, paths=paths)
    with pytest.raises(InputError, match="path 'a' has the FE node 0, whose shapes"):
        ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, paths={"a": [0, 1]})
