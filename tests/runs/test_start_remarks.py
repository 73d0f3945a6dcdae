"""What is said of a start: velocities given and demanded, bodies without support."""

import io
import warnings
from contextlib import redirect_stderr

import numpy as np
import pytest

from sebody import InputError, LimitWarning, Model, Simulation, simulate
from sebody.analysis import Ensemble
from sebody.basics import progress
from sebody.fem import Section, planar_beam, straight_beam
from sebody.model.ties import untied
from sebody.reduction import craig_bampton

SECTION = Section(area=1.0, inertia_y=1e-2, inertia_z=2e-2, torsion=3e-2, youngs_modulus=3e4,
                  poisson_ratio=0.3, density=1.0)
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def said(model, h=1e-3):
    """Warnings of a run of one step, and the run."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        run = Simulation(model, h)
    messages = [str(w.message) for w in found if issubclass(w.category, LimitWarning)]
    assert tuple(messages) == run.result().warnings
    return messages, run


def bar(planar=True, unit=1.0, names=("a", "b")):
    """A free flexible bar between two nodes, in space turned and away from the origin."""
    model = Model(planar=planar)
    if planar:
        ends = np.array([[0.3, 0.2], [1.3, 0.2]]) * unit
        fe_model = planar_beam(*ends, SECTION, 4)
    else:
        ends = unit * (np.array([[0.3, 0.2, -1.0], [1.3, 0.2, -1.0]]) @ TURN.T)
        fe_model = straight_beam(*ends, SECTION, 4)
    body = craig_bampton(fe_model, [(0, "full"), (4, "full")], 2)
    model.superelement("bar", body, [model.node(n, x) for n, x in zip(names, ends, strict=True)])
    return model, ends


def arm():
    """A rigid arm hinged at the origin, turned by a drive at 2 rad/s."""
    model = Model(planar=True)
    model.rigid_body("arm", model.node("a", (0.0, 0.0)), 1.0, 0.1)
    model.fix("a", "position")
    model.drive_angle("a", lambda t: 2.0 * t, name="motor")
    return model


def test_a_velocity_that_contradicts_a_drive_names_both():
    model = arm()
    model.initial_velocity("a", angular=5.0)
    with pytest.raises(InputError, match=r"the given initial velocity of a.rotation, \(5\), "
                                         r"contradicts joints, drives .* which demand \(2\): "):
        Simulation(model, 0.01)
    model = arm()
    model.rigid_velocity((0, 0), 5.0)
    messages, run = said(model)
    assert len(messages) == 1
    assert messages[0].startswith("rigid_velocity contradicts the initial velocities that joints "
                                  "and drives demand: a.rotation 2 in place of 5; give ")
    assert run.result()["a.angular_velocity"][0] == pytest.approx(2.0)
    model = arm()
    model.rigid_velocity((0, 0), 2.0)
    assert said(model)[0] == []
    model.initial_velocity("a", angular=2.0)
    assert said(model)[0] == []


def moved(model):
    model.move("a", (0, 1), lambda t: 2.0 * t, name="lift")


def fixed(model):
    model.fix("a", "position")


@pytest.mark.parametrize("hold, why", [(moved, "'lift' moves it, so it has (0, 2)"),
                                       (fixed, "it is fixed, so it has (0, 0)")])
def test_a_velocity_given_before_its_node_is_held(hold, why):
    """As after it, where it is refused at once; one that is the same does no harm."""
    for give in (lambda m: m.initial_velocity("a", (1.0, 0.0)),
                 lambda m: m.rigid_velocity((1.0, 0.0), 0.0, body="bar"),
                 lambda m: m.rigid_velocity((1.0, 0.0), 0.0, nodes=["a", "b"])):
        model = bar()[0]
        give(model)
        hold(model)
        with pytest.raises(InputError) as caught:
            Simulation(model, 0.01)
        assert str(caught.value).startswith(
            f"a.position is given the initial velocity (1, 0), but {why}: leave one of them out")
    model = bar()[0]
    hold(model)
    model.rigid_velocity((1.0, 0.0), 0.0, body="bar")
    with pytest.raises(InputError, match="a.position is given the initial velocity"):
        Simulation(model, 0.01)
    model = bar()[0]
    model.rigid_velocity((0.0, 2.0 if hold is moved else 0.0), 0.0, body="bar")
    hold(model)
    assert said(model)[0] == []


def test_nodes_that_become_one_have_one_velocity():
    model = Model(planar=True)
    for name in "ab":
        model.rigid_body(f"body {name}", model.node(name, (0.0, 0.0)), 1.0, 0.1)
    model.initial_velocity("a", (1.0, 0.0))
    model.initial_velocity("b", (2.0, 0.0))
    with pytest.raises(InputError, match=r"b.position is given the initial velocity \[2.0, 0.0\] "
                                         r"and a.position \[1.0, 0.0\], but a joint makes them"):
        model.revolute("a", to="b")
    assert not model.joints
    model.initial_velocity("b", (1.0, 0.0))
    model.revolute("a", to="b")
    assert said(model)[0] == []


@pytest.mark.parametrize("planar, unit", [(True, 1.0), (True, 1e3), (False, 1e-3), (False, 1.0)])
def test_a_body_of_which_one_node_is_thrown_is_strained(planar, unit):
    """It is said, with the nodes that rest; nothing is said of what moves as a rigid body."""
    direction = unit * (np.array([0.0, 1.0]) if planar else TURN @ [0.0, 1.0, 0.0])
    model, _ = bar(planar, unit, ("left", "right"))
    model.initial_velocity("right", direction)
    message, = said(model)[0]
    assert message.startswith("body 'bar' is strained from the start: initial velocities are given "
                              "to right.position (")
    assert ("not to left.position at rest, left.rotation at rest, right.rotation at rest: start it "
            "by rigid_velocity(..., body='bar'), or give every node of it a velocity") in message
    # on purpose: every node has its velocity
    model.initial_velocity("right", angular=0.0 if planar else np.zeros(3))
    model.initial_velocity("left", 0.0 * direction, 0.0 if planar else np.zeros(3))
    assert said(model)[0] == []


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("how", ["whole", "body", "nodes"])
def test_a_rigid_motion_strains_nothing(planar, how):
    """Of the whole model, a body or nodes, about any point: as the formula says, exactly kept."""
    model, ends = bar(planar)
    about = ends[0] + 0.3
    v = np.array([1.0, -2.0]) if planar else np.array([1.0, -2.0, 0.5])
    w = 3.0 if planar else np.array([0.3, -0.2, 3.0])
    options = {"whole": {}, "body": {"body": "bar"}, "nodes": {"nodes": ["a", model.nodes["b"]]}}
    model.rigid_velocity(v, w, about, **options[how])
    messages, run = said(model)
    assert messages == []
    for name, point in zip("ab", ends, strict=True):
        arm = point - about
        spin = w * np.array([-arm[1], arm[0]]) if planar else np.cross(w, arm)
        assert run.result()[f"{name}.velocity"][0] == pytest.approx(v + spin, abs=1e-12)
        assert run.result()[f"{name}.angular_velocity"][0] == pytest.approx(w, abs=1e-12)
    energy = run.result()["energy.kinetic"][0]
    mass, centre = model.bodies["bar"].reduced.total_mass, ends.mean(axis=0) - about
    velocity = v + (w * np.array([-centre[1], centre[0]]) if planar else np.cross(w, centre))
    assert energy > 0.5 * mass * velocity @ velocity
    assert simulate(model, 1e-3, 0.05)["energy.strain"].max() < 1e-3 * energy


def two_bars():
    """Two bars in a row, hinged to each other by equations."""
    model = Model(planar=True)
    nodes = {name: (x, 0.0) for name, x in (("a", 0.0), ("b", 1.0), ("c", 1.0), ("d", 2.0))}
    for name, point in nodes.items():
        model.node(name, point)
    for name, ends in (("first", "ab"), ("second", "cd")):
        body = craig_bampton(planar_beam(nodes[ends[0]], nodes[ends[1]], SECTION, 4),
                             [(0, "full"), (4, "full")], 2)
        model.superelement(name, body, list(ends))
    model.revolute("b", to="c", explicit=True, name="elbow")
    return model


def test_one_body_of_several_starts_rigidly():
    """It keeps its motion, and the one that hangs on it is solved for."""
    model = two_bars()
    model.rigid_velocity((0.0, 0.0), 2.0, body="first")
    messages, run = said(model)
    result = run.result()
    assert result["b.velocity"][0] == pytest.approx([0.0, 2.0])
    assert result["c.velocity"][0] == pytest.approx([0.0, 2.0])
    assert result["a.angular_velocity"][0] == pytest.approx(2.0)
    assert all("first" not in message for message in messages)


def test_a_rigid_body_and_a_beam_start_rigidly():
    model = Model()
    ends = model.node("base", (0, 0, 0)), model.node("tip", (2.0, 0, 0))
    model.beam("arm", ends, SECTION, 8, bodies=4, modes=2)
    model.rigid_body("weight", model.node("far", (5.0, 0, 0)), 1.0, (0.1, 0.1, 0.1))
    model.rigid_velocity((0, 0, 0), (0, 0, 2.0), body="arm")
    model.rigid_velocity((0, 1.0, 0), (0, 0, 0.0), body="weight")
    messages, run = said(model)
    assert messages == []
    assert run.result()["tip.velocity"][0] == pytest.approx([0.0, 4.0, 0.0])
    assert run.result()["far.velocity"][0] == pytest.approx([0.0, 1.0, 0.0])
    assert all(node.position.given for node in model.nodes.values())


@pytest.mark.parametrize("options, said", [
    ({"body": "bat"}, "body 'bat' is unknown: did you mean 'bar'"),
    ({"body": 3}, "body 3 is unknown: the model has bar"),
    ({"body": "bar", "nodes": ["a"]}, "rigid_velocity takes body= or nodes=: leave one of them"),
    ({"nodes": "a"}, "nodes is 'a': give a list of nodes"),
    ({"nodes": ["c"]}, "node 'c' is unknown: the model has a, b")])
def test_wrong_bodies_and_nodes(options, said):
    model, _ = bar()
    with pytest.raises(InputError, match=said):
        model.rigid_velocity((1.0, 0.0), 0.0, **options)
    assert not model.nodes["a"].position.given


def test_of_a_clamped_body_the_rest_of_the_model_is_said():
    """`rigid_velocity` leaves out what is fixed, so that the body is strained."""
    model, _ = bar()
    model.fix("a")
    model.rigid_velocity((0.0, 5.0), 0.0)
    message, = said(model)[0]
    assert "given to b.position (0, 5), not to a.position at rest, a.rotation at rest" in message


def hung(gravity=(0.0, -9.81)):
    """Two bodies under gravity."""
    model = Model(planar=True)
    model.gravity(gravity)
    for name, x in (("arm", 0.0), ("weight", 1.0)):
        model.rigid_body(name, model.node(f"{name} end", (x, 0.0)), 1.0, 0.1)
    return model


def test_bodies_that_nothing_ties_are_said():
    model = hung()
    assert untied(model) == [["arm"], ["weight"]]
    message, = said(model)[0]
    assert message == ("bodies 'arm', 'weight' are not connected to the ground and fall under "
                       "gravity: join them to another body or fix a node, unless they are meant to "
                       "fall")
    model.torsion_spring("arm end", 1.0, to="weight end")       # which does not hold its place
    assert untied(model) == [["arm"], ["weight"]]
    model.spring("arm end", "weight end", 5.0)
    assert untied(model) == [["arm", "weight"]]
    model.fix("weight end", "rotation")
    assert len(said(model)[0]) == 1
    model.fix("weight end", "position")
    assert untied(model) == [] and said(model)[0] == []


@pytest.mark.parametrize("tie", [
    lambda m: m.revolute("arm end"), lambda m: m.prismatic("arm end", (0, 1)),
    lambda m: m.spherical("arm end"), lambda m: m.bushing("arm end", stiffness=1.0),
    lambda m: m.move("arm end", (0, 1), lambda t: np.sin(t)),
    lambda m: m.slider("arm end", (0, 1)),
    lambda m: m.user_force("floor", ["arm end"], lambda t, x, v, force: None)])
def test_whatever_ties_a_body_counts(tie):
    model = hung()
    tie(model)
    assert untied(model) == [["weight"]]
    message, = said(model)[0]
    assert message.startswith("body 'weight' is not connected to the ground and falls under "
                              "gravity")


def test_nothing_is_said_of_what_is_thrown_or_flies_without_gravity():
    assert said(hung((0.0, 0.0)))[0] == []
    model = hung()
    for name in ("arm", "weight"):
        model.initial_velocity(f"{name} end", (1.0, 2.0))
    assert untied(model) and said(model)[0] == []


def test_a_drive_of_what_is_fixed_is_refused_whatever_came_first():
    for first, second in ((0, 1), (1, 0)):
        model = Model(planar=True)
        model.rigid_body("arm", model.node("o", (0.0, 0.0)), 1.0, 0.1)
        model.rigid_body("other", model.node("p", (1.0, 0.0)), 1.0, 0.1)
        steps = (lambda m=model: m.fix("o"),
                 lambda m=model: m.drive_angle("o", lambda t: 2 * t))
        steps[first]()
        steps[second]()
        with pytest.raises(InputError, match="drive 'angle at o' has nothing to move: o.rotation "
                                             "is fixed or prescribed; leave out the drive, or "):
            Simulation(model, 0.01)


def test_two_drives_that_contradict_each_other_are_named():
    model = arm()
    model.drive_angle("a", lambda t: 3.0 * t, name="other")
    with pytest.raises(InputError, match="drives motor, other contradict each other"):
        Simulation(model, 0.01)


@pytest.mark.parametrize("build", [
    lambda m, **a: m.revolute("arm end", **a), lambda m, **a: m.revolute("arm end", explicit=True,
                                                                         **a),
    lambda m, **a: m.drive_angle("arm end", lambda t: 2 * t, **a),
    lambda m, **a: m.torsion_spring("arm end", 1.0, **a)])
def test_axes_out_of_the_plane_are_refused(build):
    """In a planar model; what points to -z only where the sign of a motion would change."""
    signed = "revolute" not in build.__code__.co_names
    for axis in ((1, 0, 0), (0.0, 0.1, 1.0), (0, 0, 0), (1, 0), "x", (0, 0, np.nan),
                 *[None] * (not signed)):
        with pytest.raises(InputError, match="axis of the .* at 'arm end' is .*: the model is "
                                             "planar, where all rotations are about "):
            build(hung(), axis=axis)
    build(hung(), axis=(0, 0, 2.0))
    if signed:
        with pytest.raises(InputError, match=r"is \(0, 0, -1\): .* change the sign of angles "):
            build(hung(), axis=(0, 0, -1))
    else:
        build(hung(), axis=(0, 0, -1))


def test_an_ensemble_shows_a_bar(monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    ensemble, stream = Ensemble(arm(), 0.01), io.StringIO()
    stream.isatty = lambda: True
    with redirect_stderr(stream):
        outcome = ensemble.run({"arm.mass": np.linspace(1.0, 2.0, 5)}, 0.1,
                               {"angle": "a.angular_velocity"}, progress=True)
    assert outcome["angle"].shape[0] == 5
    assert "] 100 %" in stream.getvalue() and "t = " not in stream.getvalue()
    with pytest.raises(InputError, match="progress is 3: give a function of the part"):
        ensemble.run({}, 0.1, {"angle": "a.angular_velocity"}, progress=3)
