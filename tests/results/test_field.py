"""Fields inside bodies: kinematics of FE nodes in states in general position."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result, simulate
from sebody.assembly.numbering import number
from sebody.contract.layout import RECORD
from sebody.fem import Section, frame as frame_of_beams, planar_beam
from sebody.model.numbering import record_counts
from sebody.reduction import ReducedBody, craig_bampton
from sebody.scenes import hinged_beam

SECTION = Section(0.02, 3e-5, 5e-5, 6e-5, 2.1e11, 0.3, 7800.0, 0.85)
TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()
H = 1e-4        # of the differences: their formula is off by H^2, rounding by 1e-14 over H or H^2


def spatial(frame, inertia="material", frame_node=0):
    """A bent frame of beams with three boundary nodes, turned and shifted, and a second body."""
    joints = [(1.0, 2.0, -1.0), (2.0, 2.5, -0.5), (2.5, 2.0, 0.5)]
    fe = frame_of_beams(joints, [(0, 1), (1, 2)], SECTION, elements=3)
    body = craig_bampton(fe, [(2, "full"), (0, "full"), (1, "full")], modes=3)
    model = Model()
    shift = np.array([5.0, -3.0, 2.0])
    points = body.coordinates @ TURN.T + shift
    nodes = [model.node(f"n{i}", point) for i, point in enumerate(points)]
    extra = [model.node(f"m{i}", point + 1.0) for i, point in enumerate(points)]
    model.superelement("other", body, extra, frame=frame, rotation=TURN, frame_node=frame_node)
    model.superelement("body", body, nodes, frame=frame, inertia=inertia, rotation=TURN,
                       frame_node=frame_node)
    return model, [(i, f"n{k}") for k, i in enumerate((2, 0, 1))]


def planar(frame):
    fe = planar_beam((1.0, 2.0), (3.0, 2.5), SECTION, elements=6)
    body = craig_bampton(fe, [(6, "full"), (0, "full")], modes=2)
    model = Model(planar=True)
    c, s = np.cos(0.8), np.sin(0.8)
    turn = np.array([[c, -s], [s, c]])
    points = body.coordinates @ turn.T + [4.0, 1.0]
    nodes = [model.node(f"n{i}", point) for i, point in enumerate(points)]
    model.superelement("body", body, nodes, frame=frame, rotation=turn)
    return model, [(6, "n0"), (0, "n1")]


def states(model, seed=3):
    """A result with three states of a random motion, at times -H, 0 and H."""
    numbering, rng = number(model), np.random.default_rng(seed)
    counts = record_counts(numbering)
    rows = np.zeros((3, RECORD.size(counts)))
    at = RECORD.slices(counts)
    whole = Rotation.from_rotvec((0.4, 1.3, -0.9))
    v, a = rng.normal(size=(2, numbering.total))
    q = 0.02 * rng.normal(size=numbering.total)
    for node in model.nodes.values():
        first = numbering.dof_blocks[node.position]
        place = np.r_[node.point, np.zeros(3 - len(node.point))]
        q[first:first + len(node.point)] += (whole.apply(place) if len(node.point) == 3 else
                                             turned(1.9, node.point))
        if model.planar:
            q[numbering.dof_blocks[node.rotation]] = 1.9 + 0.2 * rng.normal()
    start = {key: whole * Rotation.from_rotvec(0.15 * rng.normal(size=3))
             for key in numbering.rotations}
    for row, t in zip(rows, (-H, 0.0, H), strict=True):
        row[at["t"]] = t
        row[at["q"]], row[at["v"]], row[at["a"]] = q + t * v + t * t / 2 * a, v + t * a, a
        for key, k in numbering.rotations.items():
            first = numbering.dof_blocks[key]
            step = t * v[first:first + 3] + t * t / 2 * a[first:first + 3]
            R = (start[key] * Rotation.from_rotvec(step)).as_matrix()
            row[at["R"]][9 * k:9 * k + 9] = R.ravel()
        for k in range(len(numbering.modes)):
            near = whole if t else whole * Rotation.from_rotvec((0.2, -0.3, 0.1))
            row[at["frames"]][9 * k:9 * k + 9] = near.as_matrix().ravel()
    return Result(model, numbering, None, None, rows, 0.0)


def turned(angle, point):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


CASES = {"mean": lambda: spatial("converged_mean"),
         "exact": lambda: spatial("converged_mean", "floating_field"),
         "node": lambda: spatial("node", frame_node=2), "fit": lambda: spatial("positions"),
         "planar mean": lambda: planar("converged_mean"), "planar fit": lambda: planar("positions")}


@pytest.mark.parametrize("case", CASES)
def test_rates_are_those_of_the_places_and_nodes_those_of_the_model(case):
    model, nodes = CASES[case]()
    result = states(model)
    field = result.field("body")
    before, now, after = field.places(range(3))
    # third derivatives are of size 10: H^2 of them, and of the second one rounding
    assert_allclose(field.velocity(1), (after - before) / (2 * H), rtol=0, atol=2e-7)
    assert_allclose(field.acceleration(1), (after - 2 * now + before) / H**2, rtol=0, atol=1e-5)
    for node, name in nodes:
        own = field.at(node)
        for quantity in ("position", "velocity", "acceleration"):
            # rounding of positions of size 10 and of the frame, which is solved for
            assert_allclose(getattr(own, quantity), result[f"{name}.{quantity}"], rtol=0,
                            atol=1e-11)


@pytest.mark.parametrize("case", ["exact", "fit", "planar mean"])
def test_displacements_in_both_axes(case):
    model, _ = CASES[case]()
    field, superelement = states(model).field("body"), model.bodies["body"]
    body, motion = superelement.reduced, field.motion
    local = body.displacements(motion.y[1])[:, :field.points.shape[1]]
    assert np.abs(local).max() > 1e-3
    assert_allclose(field.displacement(1, axes="body"), local, rtol=0, atol=1e-14)
    assert_allclose(field.displacement(1), local @ motion.rotation[1].T, rtol=0, atol=1e-14)
    assert_allclose(field.position(1, axes="body"), field.points + local, rtol=0, atol=1e-14)
    point = field.at(3, axes="body")
    assert_allclose(point.displacement[1], local[3], rtol=0, atol=1e-14)
    # the shapes and their amplitudes, from which pictures are drawn
    drawn = np.einsum("a,akd->kd", field.amplitudes[1], field.shapes())
    assert_allclose(drawn, local, rtol=0, atol=1e-14)
    assert_allclose(point.velocity[1], field.velocity(t=0.0)[3] @ motion.rotation[1], rtol=0,
                    atol=1e-13)


def test_fields_of_a_loaded_result_and_bodies_that_share_shapes(tmp_path):
    scene = hinged_beam.build(modes=2, elements=4)
    result = simulate(scene.model, 0.01, 0.05)
    loaded = Result.load(result.save(tmp_path / "r.npz"))
    for quantity in ("position", "velocity", "acceleration", "displacement", "rotation"):
        assert np.array_equal(getattr(loaded.field("beam").at(2), quantity),
                              getattr(result.field("beam").at(2), quantity))
    model, _ = spatial("converged_mean")
    alike, one = (body.reduced for body in model.bodies.values())
    assert alike is one
    one, other = one.recovery, one.rotated(TURN).recovery
    assert one is not other and one.shapes is other.shapes


def test_what_is_refused():
    result = states(CASES["mean"]()[0])
    field = result.field("body")
    for call, message in (
            (lambda: result.field("bod"), "superelement 'bod' is unknown: use 'other' or 'body'"),
            (lambda: field.position(3), "step is 3: the recorded states are 0 to 2"),
            (lambda: field.position(1, t=0.0), "step and t both choose a state: give one"),
            (lambda: field.position(t=1.0), "t is 1.0: give a finite number >= -0.0001 and <="),
            (lambda: field.position(axes="local"), "axes 'local' is unknown: use 'global' or "),
            (lambda: field.at(7), "node of body 'body' is 7: its FE model has nodes 0 to 6")):
        with pytest.raises(InputError, match=message):
            call()
    result.rows = result.rows[:0]
    result.fields.clear()
    with pytest.raises(InputError, match="no recorded state: run the model first"):
        result.field("body")


def test_bodies_without_recovery():
    model, _ = CASES["mean"]()
    body = model.bodies["body"].reduced
    bare = ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, body.modes)
    model.bodies["body"].reduced = bare
    with pytest.raises(InputError, match="'body' has reduced matrices only, so fields "
                                         "inside it are unknown: reduce its FE model"):
        states(model).field("body")
    rigid = Model()
    rigid.point_mass("p", rigid.node("n", (0, 0, 0), keeps="translation"), 1.0)
    with pytest.raises(InputError, match="the model has no superelement, so there is no field"):
        states(rigid).field("p")


def test_histories_by_name():
    result = states(CASES["mean"]()[0])
    field = result.field("body")
    assert result.field("body") is field
    for quantity in ("position", "velocity", "acceleration", "displacement"):
        assert np.array_equal(result[f"body.node3.{quantity}"], getattr(field.at(3), quantity))
    for name, message in (
            ("body.node3.speed", "'speed' is unknown: .* a node inside a body has position, velo"),
            ("body.node3.velocty", "did you mean 'body.node3.velocity'"),
            ("n0.postion", "'postion' is unknown: did you mean 'n0.position'"),
            ("body.node7.velocity", "'body.node7.velocity' is unknown: nodes are .*of FE nodes, "
                                    "<body>.node<k>, position, velocity"),
            ("body.node03.velocity", "is unknown: nodes are"),
            ("energy.kinetc", "did you mean 'energy.kinetic'")):
        with pytest.raises(InputError, match=message):
            result[name]
