"""Variants of a model: each equals a model built that way by hand, and the original stays."""

import numpy as np
import pytest
from hinged_beams import SECTION, TURN, at, linkage, reduced, rigid_beam, slender

from sebody import Model, harmonic, simulate
from sebody.fem import planar_beam
from sebody.model.variants import VARIANTS, copied, divide, keep_modes, rigid, with_options
from sebody.reduction import craig_bampton

H, STEPS = 0.01, 20
# iterations of Newton's method end at 1e-8 of the loads; motions that differ by rounding stay close
CLOSE = 1e-7


def motion(model: Model, names=("base", "elbow", "elbow2", "hook", "tip")) -> dict:
    result = simulate(model, h=H, t_end=STEPS * H)
    return {f"{name}.{kind}": result[f"{name}.{kind}"] for name in names
            for kind in ("position", "rotation")}


def assert_same(found: dict, expected: dict) -> None:
    for name, time_function in expected.items():
        moved = np.abs(time_function - time_function[0]).max()
        assert np.abs(found[name] - time_function).max() <= CLOSE * max(moved, 1.0), name


@pytest.fixture(scope="module")
def original() -> Model:
    return linkage()


@pytest.fixture(scope="module")
def before(original) -> dict:
    return motion(original)


def test_a_copy_runs_like_its_model_and_shares_nothing_that_changes(original, before):
    copy = copied(original)
    for name, time_function in motion(copy).items():
        assert np.array_equal(time_function, before[name])
    ours, theirs = ({id(one) for node in model.nodes.values()
                     for one in (node, node.position, node.rotation, node.position.rate)}
                    for model in (original, copy))
    assert not ours & theirs
    assert copy.nodes["elbow2"].position is copy.nodes["elbow"].position
    assert copy.loads[4].body is copy.bodies["first"]
    copy.nodes["tip"].position.rate[:] = 5.0
    copy.loads[0].constants["k"] = 0.0
    copy.move("anchor", TURN @ (1, 0, 0), harmonic(1.0, 3.0))
    for name, time_function in motion(original).items():
        assert np.array_equal(time_function, before[name])


@pytest.mark.parametrize(("name", "change", "sentence", "by_hand"), [
    ("options", {"inertia": "material"},
     "first has inertia 'material' instead of 'floating_field' and does not stiffen with "
     "its stresses", lambda: linkage(options={"inertia": "material"})),
    ("options", {"stiffening": False}, "first does not stiffen with its stresses",
     lambda: linkage(options={"stiffening": False})),
    ("options", {"frame": "node"}, "first has frame 'node' instead of 'converged_mean'",
     lambda: linkage(options={"frame": "node"})),
])
def test_a_variant_is_the_model_built_that_way(original, before, name, change, sentence, by_hand):
    variant = VARIANTS[name](original, "first", **change)
    assert variant.change.startswith(sentence)
    expected, found = by_hand(), motion(variant.model)
    assert list(variant.model.bodies) == ["second", "first"]
    assert variant.model.bodies["first"].kernel == expected.bodies["first"].kernel
    assert_same(found, motion(expected))
    assert np.abs(found["tip.position"] - before["tip.position"]).max() > 1e-4
    for quantity, time_function in motion(original).items():
        assert np.array_equal(time_function, before[quantity])


def test_fewer_modes_are_those_of_a_new_reduction(original, before):
    """Without stiffening, whose resultants a new reduction may choose differently."""
    unstiffened = with_options(original, "first", stiffening=False).model
    variant = keep_modes(unstiffened, "first", 2)
    rich = original.bodies["first"].reduced
    frequency = np.sqrt(rich.stiffness[-2, -2]) / (2 * np.pi)
    assert variant.change == ("first keeps 2 of its 4 internal modes; first omitted mode: "
                              f"{frequency:.4g}")
    expected = motion(linkage(modes=2, options={"stiffening": False}))
    found = motion(variant.model)
    assert_same(found, expected)
    four = motion(unstiffened)
    assert np.abs(found["tip.position"] - four["tip.position"]).max() > 1e-5
    assert "keeps no internal modes" in keep_modes(original, "first", 0).change
    for quantity, time_function in motion(original).items():
        assert np.array_equal(time_function, before[quantity])


@pytest.mark.parametrize("names", [("first",), ("second",), ("first", "second"),
                                   ("second", "first")])
def test_rigid_bodies(original, before, names):
    model = original
    for name in names:
        model, sentence = rigid(model, name)
        assert sentence.startswith(f"{name} is rigid: mass ")
    assert sorted(model.rigid_bodies) == sorted([*names, "weight"])
    found = motion(model)
    assert_same(found, motion(linkage(rigid=tuple(sorted(names)))))
    assert np.abs(found["tip.position"] - before["tip.position"]).max() > 1e-4


@pytest.mark.parametrize("names", [("first",), ("second",)])
def test_bodies_in_a_plane_are_rigid(names):
    def chain(hand_made: tuple[str, ...]) -> Model:
        model, points = Model(planar=True), np.array([[2.0, 1.0], [30.0, 25.0], [60.0, 11.0]])
        nodes = [model.node("base", points[0])]
        for k, name in enumerate(("first", "second")):
            a, b = points[k:k + 2]
            start, length = nodes[-1], np.linalg.norm(b - a)
            if name in hand_made:
                mass = SECTION.density * SECTION.area * length
                J = mass * length**2 / 12 + SECTION.density * SECTION.inertia_z * length
                nodes.append(model.attach(f"end of {name}", b, start))
                model.rigid_body(name, start, mass, J, (a + b) / 2)
            else:
                fe_model = planar_beam(a, b, SECTION, 4)
                load = np.zeros(fe_model.stiffness.shape[0])
                load[fe_model.rows[2]] = 30.0, 80.0, 500.0
                nodes.append(model.node(f"end of {name}", b))
                model.superelement(name, craig_bampton(fe_model, [(0, "full"), (4, "full")], 2,
                                                       loads={"push": load}), [start, nodes[-1]])
            if name in hand_made and name == names[0]:
                force, arm = np.array([30.0, 80.0]), (b - a) / 2
                model.force(start, force, follower=True)
                model.torque(start, 500.0 + arm[0] * force[1] - arm[1] * force[0])
            elif name == names[0]:
                model.body_load(name, "push")
                model.mode_force(name, 1, 1e3, name="shaker")
            if name == "first":
                nodes.append(model.node("after the hinge", b, at=nodes[-1]))
        model.revolute("base")
        model.gravity((0.0, -9.81))
        return model
    found, sentence = rigid(chain(()), names[0])
    assert sentence.endswith(f"with end of {names[0]} on rigid links; shaker left out")
    quantities = ("base", "end of first", "after the hinge", "end of second")
    assert_same(motion(found, quantities), motion(chain(names), quantities))


def test_a_welded_flying_body_is_rigid_and_keeps_its_motion():
    """Two beams without a hinge, one welded to the other, that fly and spin as one body."""
    def pair(by_hand: bool) -> Model:
        model, a, b, c = Model(), at(0, 0, 0), at(40, 0, 0), at(40, 30, 10)
        model.node("c", c)      # carries the rigid body: time steps are those of its position
        model.node("a", a)
        if by_hand:
            model.attach("b", b, "c")
            rigid_beam(model, "arm", "c", b, c)
        else:
            model.node("b2", b)
            model.node("b", b)
            model.superelement("arm", reduced(b, c, 2), ["c", "b2"])
            model.weld("b2", "b")
        model.superelement("first", reduced(a, b, 2), ["b", "a"])
        model.rigid_velocity(TURN @ (3.0, 0, 1), TURN @ (0.5, 2.0, -1.0), about=a)
        return model
    found = rigid(pair(False), "arm").model
    assert_same(motion(found, ("a", "b", "c")), motion(pair(True), ("a", "b", "c")))


@pytest.mark.parametrize(("before", "after", "planar"), [(1, 4, False), (4, 2, False),
                                                         (2, 1, False), (2, 4, True)])
def test_a_beam_is_divided(before, after, planar):
    original, expected = slender(before, planar=planar), slender(after, planar=planar)
    names = list(expected.nodes)
    first = motion(original, original.nodes)
    found, sentence = divide(original, "rod", after)
    each = {count: f"{count} superelement{'s' * (count > 1)} of {8 // count} finite elements"
            for count in (before, after)}
    assert sentence == f"rod has {each[after]} instead of {each[before]}"
    assert list(found.bodies) == list(expected.bodies)
    assert sorted(found.nodes) == sorted(names)
    assert_same(motion(found, names), motion(expected, names))
    for name, time_function in motion(original, original.nodes).items():
        assert np.array_equal(time_function, first[name])
    back = divide(found, "rod", before, elements=8).model
    assert_same(motion(back, original.nodes), first)


def test_modes_that_stay_keep_their_initial_velocities(original):
    """The energy of the start is that of the modes that are kept, and of the rest."""
    made = copied(original)
    name = next(n for n, body in made.bodies.items() if body.reduced.modes > 1)
    body = made.bodies[name]
    rates = np.linspace(1.0, 2.0, body.reduced.modes)
    body.mode_rates = rates.copy()
    found = keep_modes(made, name, 1).model.bodies[name]
    assert np.array_equal(found.mode_rates, rates[:1])
    other = with_options(made, name, stiffening=False).model.bodies[name]
    assert np.array_equal(other.mode_rates, rates)
