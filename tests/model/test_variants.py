"""Variants of a model: each equals a model built that way by hand, and the original stays."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, harmonic, simulate
from sebody.fem import Section, planar_beam, straight_beam
from sebody.model.variants import VARIANTS, copied, divide, keep_modes, rigid, with_options
from sebody.reduction import craig_bampton

H, STEPS = 0.01, 20
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
START = np.array([3.0, -2.0, 1.0])
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
LOAD = np.zeros((7, 6))         # on the nodes of a beam
LOAD[1:, :3] = 200.0 * TURN @ (0.2, 1.0, -0.4)
LOAD[4, 3:] = 900.0 * TURN @ (0.0, 0.3, 1.0)
# iterations of Newton's method end at 1e-8 of the loads; motions that differ by rounding stay close
CLOSE = 1e-7


def at(*place: float) -> np.ndarray:
    """A point of the scene, turned and shifted."""
    return START + TURN @ place


def reduced(first: np.ndarray, last: np.ndarray, modes: int):
    """A beam with a load inside."""
    fe_model = straight_beam(first, last, SECTION, 6)
    wind = np.zeros(fe_model.stiffness.shape[0])
    wind[fe_model.rows] = LOAD
    return craig_bampton(fe_model, [(6, "full"), (0, "full")], modes, loads={"wind": wind})


def rigid_beam(model: Model, name: str, node, first: np.ndarray, last: np.ndarray) -> None:
    """A beam as a rigid body, by the closed forms for a rod with rotary inertia."""
    length = np.linalg.norm(last - first)
    mass = SECTION.density * SECTION.area * length
    rotary = SECTION.density * SECTION.inertia_y * length
    axis = (last - first) / length
    along, across = 2 * rotary, rotary + mass * length**2 / 12
    J = across * np.eye(3) + (along - across) * np.outer(axis, axis)
    model.rigid_body(name, node, mass, J, (first + last) / 2)


def wind(t):
    return 1.0 + 2.0 * t


def drag(t, x, v, force):
    for i in range(3):
        force[i] = -0.3 * v[i]


def linkage(modes: int = 4, options: dict | None = None, rigid: tuple[str, ...] = ()) -> Model:
    """Two beams that are hinged together, with a rigid link, springs and loads of every kind.

    The second body is built first, and nodes do not follow the order of the chain.
    """
    model, a, b, c = Model(), at(0, 0, 0), at(40, 0, 0), at(40, 30, 10)
    base, anchor = model.node("base", a), model.node("anchor", at(45, 10, -20))
    if rigid == ("second",):
        tip = model.node("tip", c)
        elbow2 = model.attach("elbow2", b, tip)
        elbow = model.node("elbow", b, at=elbow2)
    else:
        elbow = model.attach("elbow", b, base) if rigid else model.node("elbow", b)
        elbow2 = model.node("elbow2", b, at=elbow)
        tip = model.attach("tip", c, elbow2) if "second" in rigid else model.node("tip", c)
    if "second" in rigid:
        rigid_beam(model, "second", elbow2, b, c)
    else:
        model.superelement("second", reduced(b, c, 2), [tip, elbow2])
    if "first" in rigid:
        rigid_beam(model, "first", base, a, b)
    else:
        model.superelement("first", reduced(a, b, modes), [elbow, base], **(options or {}))
    hook = model.attach("hook", at(45, 3, 0), elbow)
    model.fix(anchor)
    model.revolute(base, TURN @ (0, 0, 1), name="hinge")
    model.spring(hook, anchor, stiffness=900.0, damping=2.0)
    model.point_mass("weight", hook, 0.8)
    model.torsion_spring(tip, stiffness=300.0, axis=TURN @ (1, 0, 0), to=elbow)
    model.force(tip, TURN @ (30, 80, 10), harmonic(1.0, 12.0))
    model.force(elbow, TURN @ (0, 60, 20), wind, follower=True)
    if "first" in rigid:
        points = np.linspace(a, b, 7)
        moment = LOAD[:, 3:] + np.cross(points - a, LOAD[:, :3])
        model.force(base, LOAD[:, :3].sum(axis=0), wind, follower=True)
        model.torque(base, moment.sum(axis=0), wind, follower=True)
    else:
        model.body_load("first", "wind", wind, name="gale")
    model.user_force("drag", [tip], drag)
    model.gravity(TURN @ (0.0, -9.0, 3.0))
    return model


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


def slender(bodies: int, elements: int = 8, planar: bool = False) -> Model:
    """A beam between other bodies' nodes, that spins from the start."""
    model = Model(planar=planar)
    d = 2 if planar else 3
    tip, base = model.node("tip", at(70, 5, 0)[:d]), model.node("base", at(0, 0, 0)[:d])
    up = {} if planar else {"up": TURN @ (0, 1, 2)}
    model.beam("rod", (base, tip), SECTION, elements, bodies, modes=2, damping=0.01, **up)
    other = model.node("other", at(70, 40, 0)[:d])
    model.beam("arm", (tip, other), SECTION, 4, 2, **up)
    model.point_mass("weight", other, 0.7)
    model.rigid_velocity(np.zeros(d), 2.0 if planar else TURN @ (0, 0, 2.0), about=base.point)
    model.revolute(base, (0, 0, 1) if planar else TURN @ (0, 0, 1))
    model.gravity((TURN @ (0.0, -9.0, 3.0))[:d])
    return model


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


def test_what_cannot_be_changed_is_said(original):
    cases = [
        (keep_modes, ("third", 1), "superelement 'third' is unknown: the model has second, first"),
        (keep_modes, ("first", 5), "it has 4: keep 0 to 4"),
        (with_options, ("first", "mean"), "inertia 'floating_field' needs the exact rates"),
        (divide, ("first", 2), r"model.beam has built 0 beams 'first'.*\(it has built no beam\)"),
    ]
    for change, given, message in cases:
        with pytest.raises(InputError, match=message):
            change(original, *given)
    pushed = copied(original)
    pushed.mode_force("first", 2, 1.0, name="shaker")
    with pytest.raises(InputError, match="'shaker' acts on mode 2 .*'first': keep 3 modes or more"):
        keep_modes(pushed, "first", 2)


def test_what_cannot_be_rigid_is_said():
    held = linkage()
    held.fix("elbow", "position")
    with pytest.raises(InputError, match="positions of elbow and base are both fixed"):
        rigid(held, "first")
    turned = linkage()
    turned.fix("base", "rotation")
    turned.move("elbow", TURN @ (0, 0, 1), harmonic(0.1, 3.0), what="rotation")
    with pytest.raises(InputError, match="rotations of elbow and base are both fixed"):
        rigid(turned, "first")
    thrown = linkage()
    thrown.initial_velocity("elbow", linear=TURN @ (0, 1.0, 0))
    with pytest.raises(InputError, match="initial velocity of elbow.position is not that of a "
                                         "rigid motion with base"):
        rigid(thrown, "first")
    parallel = rigid(linkage(), "second").model
    parallel.superelement("beside", reduced(at(40, 0, 0), at(40, 30, 10), 1), ["tip", "elbow2"])

    with pytest.raises(InputError, match="joined by rigid links already"):
        rigid(parallel, "beside")


def test_a_held_node_without_rotation_cannot_carry_a_rigid_body():
    model, body = Model(), straight_beam(at(0, 0, 0), at(40, 0, 0), SECTION, 2)
    model.node("base", at(0, 0, 0))
    model.node("tip", at(40, 0, 0))
    model.superelement("beam", craig_bampton(body, [(0, "translation"), (2, "full")], 0),
                       ["base", "tip"])
    assert "on node tip, with base on rigid links" in rigid(model, "beam").change
    model.fix("base", "position")
    with pytest.raises(InputError, match="'beam' cannot be made rigid: it does not keep both "
                                         "position and rotation at base, which is held"):
        rigid(model, "beam")


def test_what_a_beam_that_is_divided_must_not_lose_is_said():
    cases = [
        (lambda m: m.force("rod 1", TURN @ (0, 1, 0)), "acts on or holds its node 'rod 1'; build"),
        (lambda m: m.fix("rod 1", "position"), "acts on or holds its node 'rod 1'"),
        (lambda m: m.attach("on it", at(35, 2.5, 8), "rod 1"), "acts on or holds its node 'rod 1'"),
        (lambda m: m.mode_force("rod 2", 0, 1.0, name="shaker"),
         "'shaker' acts on superelement 'rod 2'"),
    ]
    for change, message in cases:
        model = slender(2)
        change(model)
        with pytest.raises(InputError, match=f"beam 'rod' cannot be divided anew: .*{message}"):
            divide(model, "rod", 4)
    model = rigid(slender(2), "rod 1").model
    with pytest.raises(InputError, match="superelement 'rod 1' was changed; divide the beam first"):
        divide(model, "rod", 4)
    with pytest.raises(InputError, match="8 elements cannot be divided among 3 bodies"):
        divide(slender(2), "rod", 3)


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
