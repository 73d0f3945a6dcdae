"""Displacements measured from a support, a node or the floating frame."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.analysis import equilibrium
from sebody.fem import circle, frame, planar_beam, rectangle, straight_beam
from sebody.reduction import craig_bampton
from sebody.results.references import Welded

STEEL = 2.1e11, 0.3, 7800.0
TURN = Rotation.random(random_state=7).as_matrix()
START = np.array([3.0, -2.0, 5.0])


def names(model):
    """The node that displacements of each body are measured from."""
    welded = Welded(model)
    found = {name: welded.reference(body) for name, body in model.bodies.items()}
    return {name: None if node is None else node.name for name, node in found.items()}


def cantilever(reverse=False):
    """A clamped beam of 10 elements in general position, which a force across it bends."""
    section = circle(0.02, *STEEL)
    ends = [START, START + TURN[:, 0]]
    body = craig_bampton(straight_beam(*ends, section, 10), [(0, "full"), (10, "full")], 4)
    model = Model()
    nodes = [model.node(name, end) for name, end in zip(("root", "tip"), ends, strict=True)]
    model.superelement("beam", body, nodes)
    held = nodes[reverse]
    model.fix(held)
    model.force(nodes[not reverse], TURN[:, 1], [(0.0, 0.0), (1e-3, 20.0), (1.0, 20.0)])
    return simulate(model, 1e-4, 0.02), section


def test_a_clamped_beam_is_measured_from_its_clamp():
    """The displacement is the way of every node since the start, in any state."""
    result, _ = cantilever()
    field = result.field("beam")
    start = START + np.linspace(0, 1, 11)[:, None] * TURN[:, 0]
    for k in (40, 60, -1):
        moved = field.position(k) - start
        assert np.abs(moved).max() > 1e-5
        # rounding of places of size 6
        assert_allclose(field.displacement(k), moved, rtol=0, atol=1e-14)
        assert_allclose(field.displacement(k, axes="body"), moved @ TURN @ TURN.T, atol=1e-14)
        assert np.abs(field.displacement(k)[0]).max() < 1e-14
        assert np.abs(field.displacement(k, reference="frame")[0]).max() > 1e-6
    assert_allclose(result["beam.node3.displacement"], field.at(3).position - start[3], atol=1e-14)
    at_rest = field.at(7, reference="tip").displacement
    assert np.abs(field.at(10, reference="tip").displacement).max() < 1e-14
    assert np.abs(at_rest).max() > 1e-6


def test_the_last_node_may_be_the_fixed_one():
    result, _ = cantilever(reverse=True)
    field = result.field("beam")
    assert np.abs(field.at(10).displacement).max() < 1e-14
    lengths = np.linalg.norm(field.at(0).displacement, axis=1)
    found = field.envelope("displacement")
    assert found.node == 0 and found.largest == pytest.approx(lengths.max(), rel=1e-12)
    from_frame = field.envelope("displacement", reference="frame")
    assert 0 < from_frame.largest < 0.9 * found.largest


@pytest.mark.parametrize("planar", [False, True])
def test_a_turning_beam_is_measured_from_its_hinge(planar):
    """Against the rigid motion of the hinge's node, of a beam in two superelements."""
    D = 2 if planar else 3
    axis, along = (1.0, np.array([0.6, 0.8])) if planar else (TURN[:, 2], TURN[:, 0])
    start = START[:D]
    model = Model(planar=planar)
    ends = [model.node(name, start + x * along) for name, x in (("hub", 0.0), ("tip", 2.0))]
    model.beam("arm", ends, rectangle(0.02, 0.03, *STEEL), elements=8, bodies=2, modes=2)
    if planar:
        model.revolute("hub")
    else:
        model.revolute("hub", axis=axis)
    model.torque("hub", axis, [(0.0, 0.0), (0.01, 300.0), (1.0, 300.0)])
    result = simulate(model, 1e-3, 0.1)
    assert set(names(model).values()) == {"hub"}
    turned = result["hub.rotation"]
    for number, name in enumerate(model.bodies):
        field = result.field(name)
        points = start + (number + np.linspace(0, 1, 5)[:, None]) * along
        for k in (20, 100):
            R = (np.array([[np.cos(turned[k]), -np.sin(turned[k])],
                           [np.sin(turned[k]), np.cos(turned[k])]]) if planar else turned[k])
            moved = field.position(k) - start - (points - start) @ R.T
            assert_allclose(field.displacement(k), moved, rtol=0, atol=1e-13)
            assert_allclose(field.displacement(k, axes="body"), moved @ R, rtol=0, atol=1e-13)
            assert np.linalg.norm(moved[-1]) > 1e-4
    joined = [result.field(name).at(end).displacement
              for name, end in zip(model.bodies, (4, 0), strict=True)]
    assert_allclose(*joined, atol=1e-13)        # the same node of two bodies


def arms():
    """A chain of two beams, a free beam and one on rigid links."""
    model = Model()
    points = {"a": (0, 0, 0), "b": (1, 0, 0), "c": (1, 0, 0), "d": (2, 0.2, 0.1),
              "e": (5, 0, 0), "f": (6, 0, 0)}
    for name, point in points.items():
        model.node(name, point)
    section = rectangle(0.02, 0.03, *STEEL)
    for name, ends in (("upper", "ba"), ("lower", "dc"), ("free", "ef")):
        model.beam(name, tuple(ends), section, elements=2, bodies=1)
    return model


def test_which_node_is_taken():
    model = arms()
    assert names(model) == {"upper": None, "lower": None, "free": None}
    model.revolute("a", axis=(0, 0, 1))
    model.revolute("c", axis=(0, 1, 0), to="b")
    # a fixed node before one with a joint, else the first of the body's nodes with a joint
    assert names(model) == {"upper": "a", "lower": "c", "free": None}
    model.attach("pin", (6, 0.1, 0), "f")
    model.spherical("pin", explicit=True)
    assert names(model)["free"] == "f"          # the joint is at the end of a rigid link
    model.node("g", (5, 0, 0), at="e")
    assert names(model)["free"] == "e"          # e shares its position with g: a ball joint


def on_two_supports(planar, bodies=1, elements=8, ends=(0, 1)):
    """A beam in general position whose ends are held, and turn, under a uniform load across it."""
    D = 2 if planar else 3
    along, across = ((np.array([0.6, 0.8]), np.array([-0.8, 0.6])) if planar else
                     (TURN[:, 0], TURN[:, 1]))
    model = Model(planar=planar)
    nodes = [model.node(name, START[:D] + x * along) for name, x in (("a", 0.0), ("b", 2.0))]
    model.beam("beam", nodes, rectangle(0.02, 0.03, *STEEL), elements, bodies, 4)
    model.gravity(-200.0 * across)
    first, last = (nodes[k] for k in ends)
    model.fix(first, "position")
    if planar:
        model.slider(last, axis=along)
    else:
        model.slider(last, axis=along)
        model.torsion_spring(first, 1e3, axis=along)      # else it turns about its axis
    return model, along, across


@pytest.mark.parametrize("planar, bodies", [(True, 1), (False, 1), (True, 2)])
def test_a_beam_on_two_supports_is_measured_from_their_chord(planar, bodies):
    """At both supports nothing across; the middle by its place, in a plane by 5 q L^4/(384 E I)."""
    model, along, across = on_two_supports(planar, bodies)
    still = equilibrium(model, 1)
    fields = [still.field(name) for name in model.bodies]
    seen = [field.displacement(-1) @ across for field in fields]
    assert abs(seen[0][0]) < 1e-12 and abs(seen[-1][-1]) < 1e-12
    middle = -1 if bodies == 2 else 4
    moved = (fields[0].position(-1)[middle] - (START[:len(along)] + along)) @ across
    assert seen[0][middle] == pytest.approx(moved, rel=1e-9)     # the chord stays where it is
    assert np.concatenate(seen).min() == pytest.approx(seen[0][middle], rel=1e-12)
    if planar:      # a sag of 0.023 L is beyond a linear beam by its square
        linear = 5 * (7800.0 * 0.02 * 0.03 * 200.0) * 2.0**4 / 384 / (2.1e11 * 0.03 * 0.02**3 / 12)
        assert -moved == pytest.approx(linear, rel=5e-3)


def test_either_support_may_be_the_fixed_one():
    model, along, across = on_two_supports(True)
    still = equilibrium(model, 1)
    turned, *_ = on_two_supports(True, ends=(1, 0))     # held at the other end
    other = equilibrium(turned, 1)
    one, two = (r.field("beam").displacement(-1) @ across for r in (still, other))
    assert one == pytest.approx(two, abs=1e-9 * np.abs(one).max() + 1e-12)


def test_a_clamped_node_comes_before_supports():
    """In whatever order; a chord needs two places."""
    model = arms()
    model.fix("e", "position")
    assert names(model)["free"] == "e"
    model.slider("f", axis=(1, 0, 0))
    found = Welded(model).reference(model.bodies["free"])
    assert (found.node.name, found.other.name) == ("e", "f")
    model.fix("f")
    assert names(model)["free"] == "f"


def test_bodies_that_are_welded_are_measured_from_one_node():
    for explicit in (False, True):
        model = arms()
        model.weld("b", "c", explicit=explicit)
        model.revolute("d", axis=(0, 1, 0))
        assert names(model) == {"upper": "d", "lower": "d", "free": None}
    model = arms()
    model.weld("b", "c")
    assert names(model) == {"upper": "b", "lower": "b", "free": None}   # free: continuous


def test_bodies_of_positions_alone():
    """Without a rotation of the node the undeformed body has that of the frame."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    edges = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    body = craig_bampton(frame(np.array(corners) @ TURN.T, edges, circle(0.01, *STEEL), 2),
                         [(k, "translation") for k in range(4)], 2)
    model = Model()
    nodes = [model.node(f"n{k}", START + TURN @ p, "translation") for k, p in enumerate(corners)]
    model.superelement("truss", body, nodes, frame="positions")
    model.fix("n1", "position")
    model.gravity((0, 0, -9.81))
    result = simulate(model, 1e-3, 0.05)
    assert names(model) == {"truss": "n1"}
    field = result.field("truss")
    one, other = (field.displacement(-1, reference=name) for name in (None, "frame"))
    assert_allclose(one, other - other[1], rtol=0, atol=1e-14)


def test_refused():
    result, _ = cantilever()
    field = result.field("beam")
    with pytest.raises(InputError, match="body 'beam' cannot be measured from 'top': give one of "
                                         "its nodes, root, tip, or 'frame', its floating frame"):
        field.displacement(reference="top")
    with pytest.raises(InputError, match="reference is 'tip', but von_mises has none"):
        field.envelope(reference="tip")


def test_planar_beams_are_measured_likewise():
    body = craig_bampton(planar_beam((0, 0), (1, 2), rectangle(0.02, 0.03, *STEEL), 6),
                         [(0, "full"), (6, "full")], 2)
    model = Model(planar=True)
    for name, point in (("a", (0, 0)), ("b", (1, 2))):
        model.node(name, point)
    model.superelement("beam", body, ["a", "b"])
    model.fix("b")
    model.force("a", (1.0, 0.3), [(0, 0), (0.01, 50.0), (1, 50.0)])
    result = simulate(model, 1e-3, 0.02)
    field = result.field("beam")
    start = np.linspace(0, 1, 7)[:, None] * (1, 2)
    assert_allclose(field.displacement(), field.position() - start, atol=1e-14)


def test_a_weld_between_bodies_is_no_support():
    """Bodies that fly freely, welded at the second node of the first: measured from the first."""
    model = Model()
    section = circle(0.02, *STEEL)
    for k in range(2):
        ends = [START + k * TURN[:, 0], START + (k + 1) * TURN[:, 0]]
        body = craig_bampton(straight_beam(*ends, section, 4), [(0, "full"), (4, "full")], 2)
        nodes = [model.node(f"{name} {k}", end) for name, end in zip("ab", ends, strict=True)]
        model.superelement(f"half {k}", body, nodes)
    model.weld("b 0", "a 1")
    assert names(model) == {"half 0": "a 0", "half 1": "a 0"}
