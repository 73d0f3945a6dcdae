"""What a model refuses: errors name the thing and the remedy. What it shares, fixes and starts."""

import numpy as np
import pytest

from sebody import InputError, Model
from sebody.assembly.build import build, number
from sebody.contract.counts import layout_name
from sebody.contract.traits import FrameTraits
from sebody.fem import Section, frame, planar_beam, straight_beam
from sebody.model import frames
from sebody.reduction import ReducedBody, craig_bampton
from sebody.scenes.hinged_beam import SECTION

END = (60.0, 0.0, 0.0)


def beam(keeps=("full", "full"), modes=0, middle=None):
    boundary = [(0, keeps[0]), (8, keeps[1])] + ([(4, middle)] if middle else [])
    return craig_bampton(straight_beam(np.zeros(3), END, SECTION, 8), boundary, modes)


def flat_beam():
    return craig_bampton(planar_beam((0, 0), (60, 0), SECTION, 4), [(0, "full"), (4, "full")], 0)


def model_with_nodes(planar=False):
    model = Model(planar=planar)
    d = 2 if planar else 3
    model.node("base", np.zeros(3)[:d])
    model.node("tip", np.array(END)[:d])
    return model


def placed():
    model = model_with_nodes()
    model.superelement("beam", beam(), ["base", "tip"])
    return model


@pytest.mark.parametrize("action, message", [
    (lambda m: m.node("base", (1, 0, 0)), "node 'base' exists already: give every node its own"),
    (lambda m: m.node("x", (1, 0)), "point of node 'x' is .1, 0.: give 3 finite numbers"),
    (lambda m: m.node("x", None), "point of node 'x' is None: give 3 finite numbers"),
    (lambda m: m.node("x", (1, 0, np.nan)), "point of node 'x' is .*give 3 finite numbers"),
    (lambda m: m.node("x", (1, 0, 0), "half"), "keeps 'half': use full, translation or rotation"),
    (lambda m: m.node("x", (1, 0, 0), at=m.nodes["base"]),
     "node 'x' at .* cannot share the position of 'base' at .*: give both the same point"),
    (lambda m: m.fix("nobody"), "node 'nobody' is unknown: the model has base, tip"),
    (lambda m: Model().fix("nobody"), "node 'nobody' is unknown: the model has no nodes"),
    (lambda m: m.fix("base", "all"), "cannot fix 'all': use position, rotation or both"),
])
def test_nodes(action, message):
    with pytest.raises(InputError, match=message):
        action(model_with_nodes())


def place(nodes=("base", "tip"), body=None, **options):
    return lambda m: m.superelement("b", body or beam(), nodes, **options)


@pytest.mark.parametrize("action, message", [
    (place(["base"]), "superelement 'b' has 2 boundary nodes and 1 were given: give one node for"),
    (place(["base", "top"]), "node 'top' is unknown: did you mean 'tip'?"),
    (place(["tip", "base"]), "superelement 'b': the nodes do not lie where the body's boundary "
                             "nodes are .off by .*: give them in the order base, tip, or pass "
                             "rotation=, the matrix that turns FE axes"),
    (place(["base", "base"]), "the nodes do not lie where the body's boundary nodes are"),
    (place(frame="mine"), "frame 'mine' is unknown: use one of converged_mean, mean, mean_axes"),
    (place(inertia="z"), "inertia 'z' is unknown: use one of 'frame_axes'"),
    (place(frame="positions"), "lie on a line, so the frame 'positions' cannot determine "
                               "rotations about it: use 'converged_mean'"),
    (place(frame="node", frame_node=2), "'b': boundary node 2 cannot carry the frame.*: choose a "
                                        "full node"),
    (place(frame="node", frame_node=-1), "boundary node -1 cannot carry the frame"),
    (place(rotation=np.eye(2)), r"proper rotation matrix of shape \(3, 3\)"),
    (place(rotation=2 * np.eye(3)), "must be a proper rotation matrix"),
    (place(rotation=np.diag([1.0, 1.0, -1.0])), "must be a proper rotation matrix"),
    (place(rotation=np.full((3, 3), np.nan)), "must be a proper rotation matrix"),
    (place(body=flat_beam()), "superelement 'b' is planar and the model is spatial: use one kind"),
])
def test_superelements(action, message):
    with pytest.raises(InputError, match=message):
        action(model_with_nodes())


def test_superelement_names_are_unique():
    with pytest.raises(InputError, match="'beam' exists already: give it its own name"):
        placed().superelement("beam", beam(), ["base", "tip"])


def test_spatial_body_in_a_planar_model():
    with pytest.raises(InputError, match="'b' is spatial and the model is planar: use one kind"):
        place()(model_with_nodes(planar=True))


def test_no_rotation_needs_the_positions_frame():
    points = np.array([[0.0, 0, 0], [60, 0, 0], [60, 40, 0]])
    body = craig_bampton(frame(points, [(0, 1), (1, 2)], SECTION, 4),
                         [(k, "translation") for k in range(3)], 0)
    model = Model()
    nodes = [model.node(f"n{k}", p, "translation") for k, p in enumerate(points)]
    with pytest.raises(InputError, match="keeps no rotation, so its frame cannot be "
                                         "'converged_mean': use frame='positions'"):
        model.superelement("b", body, nodes)


def test_frames_are_judged_by_what_they_need(monkeypatch):
    """A frame of another name is refused, or finds its kernel, by its traits alone."""
    kinds = {"fits": frames.Frame("positions", FrameTraits("", needs_rotations=False)),
             "turns": frames.Frame("converged_mean", FrameTraits(""), on_one_node=True)}
    for name, kind in kinds.items():
        monkeypatch.setitem(frames.FRAMES, name, kind)
    with pytest.raises(InputError, match="lie on a line, so the frame 'fits' cannot determine "):
        place(frame="fits")(model_with_nodes())
    placed_body = place(frame="turns", frame_node=1)(model_with_nodes())
    assert placed_body.kernel == "superelement_f2_converged_mean_floating_field"
    assert placed_body.alpha.tolist() == [0.0, 1.0]


def test_missing_kernel_says_the_command_that_makes_it(monkeypatch, tmp_path):
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    model = model_with_nodes()
    model.node("middle", (30.0, 0, 0), "rotation")
    with pytest.raises(InputError, match=r"there is no kernel for layout 'f2r1', frame 'mean', "
                                         r"inertia 'frame_axes': make it with\s+"
                                         r"python -m sebody.derive f2r1:mean:frame_axes$"):
        model.superelement("b", beam(middle="rotation"), ["base", "tip", "middle"], frame="mean",
                           inertia="frame_axes")


def half_node(keeps):
    model = Model()
    model.node("half", (0, 0, 0), keeps)
    model.node("tip", END)
    return model


@pytest.mark.parametrize("keeps, action, missing", [
    ("translation", place(["half", "tip"]), "rotation"),
    ("rotation", place(["half", "tip"]), "position"),
    ("translation", lambda m: m.revolute("half"), "rotation"),
    ("rotation", lambda m: m.spherical("half"), "position"),
    ("translation", lambda m: m.torque("half", (0, 0, 1)), "rotation"),
    ("rotation", lambda m: m.force("half", (0, 0, 1)), "position"),
    ("translation", lambda m: m.initial_velocity("half", angular=(0, 0, 1)), "rotation"),
    ("rotation", lambda m: m.fix("half", "position"), "position")])
def test_node_without_a_triplet(keeps, action, missing):
    with pytest.raises(InputError, match=f"node 'half' has no {missing}: make it with "
                                         "keeps='full'"):
        action(half_node(keeps))


def test_massless_body():
    with pytest.raises(InputError, match="density is 0.0: give a positive number"):
        Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 0.0)
    heavy = beam()
    with pytest.raises(InputError, match="mass"):
        ReducedBody(heavy.stiffness, 0 * heavy.mass, heavy.coordinates, heavy.keeps)


@pytest.mark.parametrize("action, message", [
    (lambda m: m.revolute("base", (0, 0, 0)), "axis of the revolute joint at 'base' is zero: give "
                                              "its direction"),
    (lambda m: m.revolute("base", (0, 1)), "axis of the revolute joint at 'base' is .0, 1.: give"),
    (lambda m: m.revolute("base", (0, 0, np.nan)), "axis of .* give 3 finite numbers"),
    (lambda m: m.revolute("base", to="tip"), "revolute joint: nodes 'base' and 'tip' do not "
                                             "coincide: "
                                             "give both the same point"),
    (lambda m: m.revolute("base", to="far"), "node 'far' is unknown"),
    (lambda m: m.spherical("base", "tip"), "'base' and 'tip' do not coincide: give both the same"),
    (lambda m: m.spherical("base", "base"), "node 'base' is joined to itself: give two nodes"),
    (lambda m: (m.node("twin", (0, 0, 0), at="base"), m.spherical("base", "twin")),
     "nodes 'base' and 'twin' share their position already: leave the joint out"),
    (lambda m: m.initial_velocity("base", (0, 1)), "initial rate of base.position is .0, 1.: give "
                                                   "3 finite"),
    (lambda m: m.initial_velocity("base", angular=(0, 0, np.inf)),
     "initial rate of base.rotation is .*: give 3 finite"),
    (lambda m: m.rigid_velocity((0, 0), (0, 0, 1)), "linear velocity is .0, 0.: give 3 finite"),
    (lambda m: m.rigid_velocity((0, 0, 0), (0, 0, 1), about=(1,)), "about is .*: give 3 finite"),
])
def test_joints_and_velocities(action, message):
    with pytest.raises(InputError, match=message):
        action(model_with_nodes())


# wrong input that is not reported as such
@pytest.mark.parametrize("action, message", [
    pytest.param(lambda m: m.rigid_velocity((0, 0, 0), 1.0), "angular", id="angular is a number"),
    pytest.param(lambda m: m.rigid_velocity((0, 0, 0), (0, 0, 0, 1)), "angular",
                 id="angular is long"),
    pytest.param(lambda m: m.rigid_velocity((0, 0, 0), (0, 0, np.nan)), "angular", id="NaN"),
    pytest.param(lambda m: m.node("x", "abc"), "point of node 'x'", id="point is text"),
    pytest.param(lambda m: m.node("x", (0, 0, 0), at="nobody"), "node 'nobody' is unknown",
                 id="at is a name"),
    pytest.param(lambda m: m.fix(Model().node("base", (9, 9, 9))), "base", id="foreign node"),
])
def test_inputs_to_be_refused(action, message):
    with pytest.raises(InputError, match=message):
        action(model_with_nodes())


@pytest.mark.parametrize("joint", ["revolute", "spherical"])
def test_joint_to_a_fixed_node(joint):
    """A fixed node stands for the ground: a joint to it is one to the ground."""
    model = placed()
    shared = joint == "revolute"
    model.node("ground", (0, 0, 0), at=model.nodes["base"] if shared else None)
    model.fix("ground", "rotation" if shared else "both")
    getattr(model, joint)("base", to="ground")
    assert build(model)[1].free > 0


def test_refused_joint_leaves_the_model_as_it_was():
    model = placed()
    with pytest.raises(InputError, match="is zero"):
        model.revolute("base", (0, 0, 0))
    assert not model.nodes["base"].position.fixed


@pytest.mark.parametrize("joints, unknowns", [
    (lambda m: None, 12), (lambda m: m.fix("base"), 6), (lambda m: m.fix("base", "position"), 9),
    (lambda m: m.revolute("base"), 9 + 2), (lambda m: m.spherical("base"), 12 + 3)])
def test_number_of_unknowns(joints, unknowns):
    """Fixed DOF blocks are no unknowns, multipliers are."""
    model = placed()
    joints(model)
    assert number(model).free == unknowns


def test_shared_position_is_one_triplet():
    model = model_with_nodes()
    twin = model.node("twin", END, at=model.nodes["tip"])
    assert twin.position is model.nodes["tip"].position
    assert twin.rotation is not model.nodes["tip"].rotation


def test_bodies_may_be_placed_anywhere():
    """A constant shift is no error: only the arrangement of the nodes counts."""
    model = Model()
    nodes = [model.node("a", (7.0, 1.0, 2.0)), model.node("b", (7.0, 61.0, 2.0))]
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    placed_body = model.superelement("beam", beam(), nodes, rotation=turn)
    assert np.allclose(placed_body.reduced.coordinates, [[0, 0, 0], [0, 60, 0]])
    assert placed_body.layout == "f2" == layout_name(placed_body.reduced.keeps, planar=False)


@pytest.mark.parametrize("planar", [False, True])
def test_rigid_velocity(planar):
    """``v + w x (x - about)`` at free positions, w at free rotations, nothing at fixed ones."""
    model = model_with_nodes(planar)
    model.fix("base", "position")
    v, w = ((1.0, 2.0), 0.5) if planar else ((1.0, 2.0, 3.0), (0.0, 0.0, 0.5))
    about = (10.0, 4.0) if planar else (10.0, 4.0, 0.0)
    model.rigid_velocity(v, w, about)
    base, tip = model.nodes["base"], model.nodes["tip"]
    assert tip.position.rate[:2] == pytest.approx([1.0 + 0.5 * 4.0, 2.0 + 0.5 * 50.0])
    assert base.rotation.rate[-1] == tip.rotation.rate[-1] == 0.5
    assert not base.position.rate.any()
