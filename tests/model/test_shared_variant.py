"""Shared DOF blocks in the place of a joint's equations: the same motion with fewer unknowns."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.model.variants import can_be_shared, shared

H, STEPS = 0.002, 40
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
EXACT = generalized_alpha(tolerance=1e-12)
# of the motion: steps are those of other coordinates where a position hangs on a link
STEP_ERROR = 1e-5


def at(*place: float) -> np.ndarray:
    return np.array([3.0, -2.0, 1.0]) + TURN @ place


def chain(kind: str, explicit: bool, linked: bool = False, planar: bool = False) -> Model:
    """Two rigid bodies that a joint holds together, the second with a link to a mass."""
    model, size = Model(planar=planar), 2 if planar else 3

    def inertia(k):
        return float(k) if planar else (k, 1.2 * k, 1.5 * k)
    base = model.node("base", at(0, 0, 0)[:size])
    model.rigid_body("first", base, 1.0, inertia(1.0), centre=at(0.5, 0.1, 0)[:size])
    model.fix(base, "position")
    end, other = at(1, 0, 0)[:size], model.node("other", at(1, 0, 0)[:size])
    one = model.attach("one", end, base) if linked else model.node("one", end)
    if not linked:
        model.rigid_body("between", one, 0.7, inertia(0.5))
        model.weld(model.attach("end", end, base), one)
    model.rigid_body("second", other, 2.0, inertia(1.2), centre=at(1.5, 0.2, 0.1)[:size])
    model.point_mass("mass", model.attach("tip", at(2, 0, 0)[:size], other), 1.0)
    axes = {"universal": (TURN @ (0, 0, 1), TURN @ (0, 1, 0))}.get(
        kind, (TURN @ (0, 0, 1),) if kind == "revolute" else ())
    getattr(model, kind)(one, *axes, to=other, name="joint", explicit=explicit)
    model.gravity((TURN @ (1.0, -9.81, 3.0))[:size])
    return model


def assert_same(model: Model, other: Model, names, limit: float) -> None:
    expected, found = (simulate(one, H, STEPS * H, EXACT) for one in (model, other))
    for name in names:
        size = np.abs(expected[name] - expected[name][0]).max()
        assert np.abs(found[name] - expected[name]).max() <= limit * size, name


@pytest.mark.parametrize(("kind", "linked", "planar"), [
    ("spherical", False, False), ("revolute", True, False), ("universal", False, False),
    ("weld", False, False), ("weld", True, False), ("spherical", True, True),
    ("weld", True, True)])
def test_equations_are_replaced(kind, linked, planar):
    model = chain(kind, True, linked, planar)
    assert can_be_shared(model) == ["joint"]
    made, sentence = shared(model, "joint")
    size, angles = (2, 1) if planar else (3, 3)
    saved = 2 * (size + (angles if kind == "weld" else 0))
    both = "positions and rotations" if kind == "weld" else "positions"
    left = {"revolute": 2, "universal": 1}.get(kind, "no")
    assert sentence == (f"joint takes {left} equations, one and other share {both}: {saved} "
                        "unknowns fewer")
    assert made.nodes["one"].position is made.nodes["other"].position
    assert model.nodes["one"].position is not model.nodes["other"].position
    assert can_be_shared(made) == []
    by_hand = chain(kind, False, linked, planar)
    moved = ("base.rotation", "one.position", "tip.position")
    assert_same(by_hand, made, (*moved, "joint.force", "second.other.force"), 1e-9)
    assert_same(model, made, moved, STEP_ERROR)


def test_what_is_shared_with_the_ground_is_fixed():
    model = chain("spherical", True)
    model.weld("other", explicit=True, name="wall")
    assert can_be_shared(model) == ["joint", "wall"]
    made, sentence = shared(model, "wall")
    assert sentence == ("wall takes no equations, other is fixed in positions and rotations: 12 "
                        "unknowns fewer")
    assert made.nodes["other"].position.fixed and made.nodes["other"].rotation.fixed
    assert can_be_shared(made) == []        # one hangs on base, and other is fixed
    assert_same(model, made, ("base.rotation",), STEP_ERROR)


def test_all_joints_at_once():
    """One after the other: what the first fixes may leave the second its equations."""
    model = chain("spherical", True)
    model.weld("other", explicit=True, name="wall")
    made, sentence = shared(model)
    assert sentence == ("joint takes no equations, one and other share positions; wall takes 3 "
                        "equations, other is fixed in rotations: 12 unknowns fewer")
    assert made.element("wall").multipliers == 3
    assert_same(model, made, ("base.rotation",), STEP_ERROR)


def test_guides_share_their_rotation():
    model = Model()
    for name, mass in (("a", 1.0), ("b", 2.0)):
        model.rigid_body(name, model.node(name, at(0, 0, 0)), mass, (1.0, 2.0, 2.5))
    model.fix("a", "position")
    model.prismatic("a", TURN @ (1, 0, 0), to="b", name="guide")
    model.gravity((3.0, -9.0, 2.0))
    model.initial_velocity("a", angular=(0.5, 0.2, 1.0))
    made, sentence = shared(model, "guide")
    assert sentence == "guide takes 2 equations, a and b share rotations: 6 unknowns fewer"
    assert_same(model, made, ("b.position", "b.rotation"), STEP_ERROR)


def test_a_node_with_links_may_be_put_at_the_end_of_another_link():
    """Links that begin at a position which joins another one go on from there."""
    assert_same(*(chain("spherical", explicit, linked=True) for explicit in (True, False)),
                ("other.position", "tip.position"), STEP_ERROR)


def test_a_loop_of_links_keeps_its_equations():
    model = chain("spherical", True)
    model.attach("back", at(1, 0, 0), "tip")
    model.spherical("back", "other", explicit=False, name="loop")
    assert model.element("loop").multipliers == 3
    assert can_be_shared(model) == ["joint"]


def test_what_cannot_be_shared_is_said():
    model = chain("revolute", False)
    with pytest.raises(InputError, match="joint 'hinge' is unknown: the model has 'weld at end'"):
        shared(model, "hinge")
    with pytest.raises(InputError, match="joint 'joint' has no equations that shared"):
        shared(model, "joint")
    with pytest.raises(InputError, match="the model has no joint with equations that shared"):
        shared(model)
    thrown = chain("spherical", True)
    thrown.initial_velocity("other", linear=(1, 0, 0))
    with pytest.raises(InputError, match="joint 'joint' has no equations that shared"):
        shared(thrown, "joint")


def test_joints_whose_forces_press_keep_their_equations():
    """Friction reads the multipliers of its joint; without them its kernel did not fit."""
    model = Model()
    for name in ("hinge", "pin"):
        model.node(name, (0.0, 0.0, 0.0) if name == "hinge" else (1.0, 0.0, 0.0))
        model.rigid_body(f"bar {name}", name, 1.0, (0.1, 0.2, 0.3))
    model.attach("end", (1.0, 0.0, 0.0), "hinge")
    model.revolute("hinge", axis=(0.0, 0.6, 0.8), name="dry", explicit=True)
    model.spherical("pin", to="end", name="ball")
    model.friction("dry", 0.3, radius=0.02)
    model.gravity((0.0, 0.0, -9.81))
    with pytest.raises(InputError, match="'dry' keeps its equations, whose forces press 'friction "
                                         "in dry': define that with reaction=False and a preload"):
        shared(model, "dry")
    assert can_be_shared(model) == ["ball"]
    made = shared(model).model
    one, other = (simulate(m, 1e-3, 0.1)["end.position"] for m in (model, made))
    assert one == pytest.approx(other, abs=1e-5)        # second order in the step
