"""Models as one superelement: against the model itself, in small motion and in large rotation."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.analysis import equilibrium, modes, vibrations
from sebody.basics.errors import InputError
from sebody.cli.entry import main
from sebody.fem import circle, straight_beam
from sebody.io import load_body, save_body
from sebody.reduction import Accuracy, craig_bampton, reduce_model
from sebody.scenes.bolted_arm import build

LEG, ARM = circle(0.03, 2.1e11, 0.3, 7850.0), circle(0.02, 2.1e11, 0.3, 7850.0)
TURN = Rotation.from_rotvec((0.7, -0.4, 1.1)).as_matrix()
POINTS = {"a": (0, 0, 0), "b": (1.0, 0, 0), "c": (1.0, 0.6, 0), "d": (1.0, 0.6, 0),
          "e": (2.0, 0.6, 0.3), "f": (2.0, 0, 0)}
STRAIGHT = np.eye(3)
pytestmark = pytest.mark.filterwarnings("ignore::sebody.LimitWarning")


def frame(model, origin=(0, 0, 0), turn=STRAIGHT, prefix="", masses=True):
    """Legs and a cross-beam on a hinge with a torsion spring, a box and a ball; ends a and e."""
    nodes = {name: model.node(prefix + name, np.asarray(origin) + turn @ np.array(point, float))
             for name, point in POINTS.items()}
    for name, ends, section, bodies in (
            ("leg", "ab", LEG, 2), ("post", "bc", LEG, 1), ("arm", "de", ARM, 1),
            ("tie", "bf", ARM, 1), ("end", "fe", ARM, 1)):
        model.beam(prefix + name, [nodes[end] for end in ends], section, elements=4, bodies=bodies,
                   modes=2)
    axis = turn @ np.array([0.0, 0, 1])
    model.revolute(nodes["c"], to=nodes["d"], axis=axis, name=f"{prefix}hinge")
    model.torsion_spring(nodes["c"], to=nodes["d"], stiffness=5e3, damping=20.0, axis=axis)
    if masses:
        model.rigid_body(prefix + "box", nodes["f"], 15.0, turn @ np.diag([0.3, 0.4, 0.5]) @ turn.T,
                         centre=origin + turn @ np.array([2.1, -0.1, 0.15]))
        model.point_mass(prefix + "ball", nodes["b"], 4.0)
    return nodes


def alone(body, names=("a", "e"), held="a", **options):
    """A model of a body alone, held at a node."""
    model = Model(planar=body.planar)
    nodes = [model.node(name, point) for name, point in zip(names, body.coordinates, strict=True)]
    model.superelement("body", body, nodes, **options)
    if held:
        model.fix(held)
    return model


def frequencies(model):
    return vibrations(model).frequency


def same(found, exact, relative):
    count = min(len(found), len(exact))
    assert count > 5
    assert found[:count] == pytest.approx(exact[:count], rel=relative)


@pytest.mark.parametrize("turn", [np.eye(3), TURN], ids=["", "turned"])
def test_a_frame_with_a_hinge_and_rigid_parts_has_the_frequencies_of_its_model(turn):
    model, held = Model(), Model()
    frame(model, (3.0, -1, 2), turn)
    held.fix(frame(held, (3.0, -1, 2), turn)["a"])
    body = reduce_model(model, ["a", "e"])
    same(frequencies(alone(body)), frequencies(held), 1e-10)
    assert body.total_mass == pytest.approx(sum(
        one.reduced.total_mass for one in model.bodies.values()) + 19.0, rel=1e-12)
    assert body.damping is not None and np.linalg.matrix_rank(body.damping, 1e-6) == 1
    few = reduce_model(model, ["a", "e"], Accuracy(1e-4, 40.0))
    assert 4 < few.modes < body.modes
    close = frequencies(alone(few))[:4]
    assert close == pytest.approx(frequencies(held)[:4], rel=1e-3)


def test_the_supports_of_interfaces_belong_to_the_model_outside():
    """A model that is held and loaded at its interfaces has the body of one that is free."""
    free, held = Model(), Model()
    frame(free)
    nodes = frame(held)
    held.gravity((0, 0, -9.81))
    held.revolute(nodes["a"], axis="y", name="support")
    held.force(nodes["e"], (0, 0, 0.0), name="push")
    one, other = (reduce_model(model, {"a": "full", "e": "translation"}, 6)
                  for model in (free, held))
    scale = np.sqrt(np.diag(one.stiffness))
    assert np.abs((one.stiffness - other.stiffness) / np.outer(scale, scale)).max() < 1e-9
    assert any("revolute 'support'" in note and "gravity" in note and "'push'" in note
               for note in other.notes)


def test_the_order_of_interfaces_changes_nothing():
    model = Model()
    frame(model)
    one, other = reduce_model(model, ["a", "e"], 8), reduce_model(model, ["e", "a"], 8)
    order = np.r_[3:6, 0:3, 9:12, 6:9, 12:20]
    for name in ("stiffness", "mass", "damping"):
        found, swapped = getattr(one, name), getattr(other, name)[np.ix_(order, order)]
        scale = np.sqrt(np.diag(one.stiffness if name != "mass" else one.mass).clip(1e-12))
        assert np.abs((found - swapped) / np.outer(scale, scale)).max() < 1e-9
    first, second = one.invariants, other.invariants
    assert first.unstiffened.J2[0, 1] == pytest.approx(
        second.unstiffened.J2[0, 1][np.ix_(order, order)], abs=1e-9)
    # of second order the work of loads is the same, whatever their modes are
    stretched, swapped = (np.einsum("an,nij->aij", i.S1[:, 20:], i.Q) for i in (first, second))
    assert stretched == pytest.approx(swapped[:, order][:, :, order],
                                      abs=1e-5 * np.abs(stretched).max())


def test_one_body_is_reduced_to_itself():
    """With its stiffening: the same frequencies where it spins about a skew axis."""
    model = Model()
    nodes = [model.node("a", (0, 0, 0)), model.node("b", (1.0, 0.2, 0.3))]
    model.beam("s", nodes, ARM, elements=6, bodies=1, modes=4)
    own, body = model.bodies["s"].reduced, reduce_model(model, ["a", "b"])
    for name in ("stiffness", "mass"):
        scale = np.sqrt(np.diag(getattr(own, name)))
        defect = (getattr(own, name) - getattr(body, name)) / np.outer(scale, scale)
        assert np.abs(defect).max() < 1e-12
    exact = own.invariants.unstiffened.about(body.invariants.origin)
    for name in ("S1", "J0", "g", "h", "K", "J2", "Mbar"):
        one, other = getattr(exact, name), getattr(body.invariants, name)
        size = one.shape[-1]
        if one.ndim > 2 or name == "Mbar":
            other = other[..., :size, :size]
        elif name != "J0":
            other = other[..., :size]
        assert other == pytest.approx(one, abs=1e-12 * np.abs(one).max())
    assert not body.lacks and own.invariants.slaved == body.invariants.slaved == 2
    assert body.invariants.lam == pytest.approx(own.invariants.lam, rel=1e-9)
    G, H = own.invariants.Ghat[0], body.invariants.Ghat[0]
    sign = np.sign(own.invariants.E[:, 0] @ body.invariants.E[:, 0])
    gauge = np.eye(len(G)) - own.rigid_modes @ np.linalg.pinv(own.rigid_modes)
    assert gauge @ H @ gauge * sign == pytest.approx(
        gauge @ G @ gauge, abs=1e-6 * np.abs(G).max())
    found, exact = (spinning(alone(one, "ab"), (20.0, 40, 80)) for one in (body, own))
    assert found == pytest.approx(exact, rel=1e-6)


def spinning(model, spin):
    """Frequencies of a model that is held at its first node and spins about it."""
    model.fix(next(iter(model.nodes)))
    return modes(model, spin=spin).frequency[:4]


def test_an_assembly_stiffens_as_it_spins():
    """A beam of four bodies beside the beam as one body, whose first frequency is 182 rad/s."""
    def beam(bodies, modes):
        model = Model()
        nodes = [model.node("a", (0, 0, 0)), model.node("b", (1.0, 0, 0))]
        model.beam("s", nodes, LEG, elements=8, bodies=bodies, modes=modes)
        return model
    body = reduce_model(beam(4, 2), ["a", "b"], 8)
    spin = (0, 0, 150.0)
    found, exact = (spinning(one, spin) for one in (alone(body, "ab", held=""), beam(1, 8)))
    assert found == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("masses", [False, True])
def test_a_frame_stiffens_as_it_spins(masses, tmp_path):
    """Its arms bend, so that bodies turn, and so do the forces of a hinge and its spring."""
    whole, free = Model(), Model()
    frame(whole, masses=masses)
    frame(free, masses=masses)
    body = reduce_model(free, ["a", "e"], 16)
    body = load_body(save_body(body, tmp_path / "frame.npz", ("a", "e")))
    assert "stiffening" not in body.lacks
    spin = (1.8, 0.6, 2.4)
    exact, found = spinning(whole, spin)[:3], spinning(alone(body, held=""), spin)[:3]
    assert found == pytest.approx(exact, rel=1e-4)


def test_an_assembly_buckles():
    """A cantilever of two bodies under half and nine tenths of the load of Euler."""
    model = Model()
    nodes = [model.node("a", (0, 0, 0)), model.node("b", (1.0, 0, 0))]
    model.beam("s", nodes, LEG, elements=8, bodies=2, modes=4)
    body = reduce_model(model, ["a", "b"], 8)
    load = np.pi**2 / 4 * 2.1e11 * np.pi * 0.03**4 / 4
    squares = []
    for part in (0.8, 0.95):
        held = alone(body, "ab")
        held.force("b", (-part * load, 0, 0))
        squares.append(modes(held).frequency[0]**2)
    assert 0.8 + 0.15 * squares[0] / (squares[0] - squares[1]) == pytest.approx(1.0, abs=1e-3)


def test_what_has_no_stiffening_says_so():
    def bush(model, nodes):
        model.bushing(nodes["c"], to=nodes["d"], stiffness=1e3, name="rubber")
    model = Model()
    bush(model, frame(model))
    body = reduce_model(model, ["a", "e"], 4)
    assert "bushing 'rubber' inside" in body.lacks["stiffening"]
    assert not body.invariants.stiffens


def chain(count, prefix=""):
    """Frames one behind the other, welded; each is turned by a quarter against the one before."""
    model, place, turn = Model(), np.zeros(3), np.eye(3)
    quarter = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 1.0]])
    before = None
    for k in range(count):
        nodes = frame(model, place, turn, f"{k}", masses=False)
        if before is not None:
            model.weld(before, to=nodes["a"])
        before, place = nodes["e"], place + turn @ np.array(POINTS["e"])
        turn = turn @ quarter
    return model


def rigid_force(body):
    """Largest force of a rigid motion, of that of one coordinate as large: rounding."""
    units = np.sqrt(np.diag(body.stiffness))
    return (np.abs(body.stiffness @ body.rigid_modes) / units[:, None]).max() / np.abs(
        body.rigid_modes * units[:, None]).max()


def test_bodies_of_bodies_of_bodies():
    """Two frames, reduced one by one, as a pair, and the pair beside a third one."""
    direct = reduce_model(chain(3), ["0a", "2e"], 12)
    single = Model()
    frame(single, masses=False)
    one = reduce_model(single, ["a", "e"])
    tip = np.array(POINTS["e"])
    quarter = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 1.0]])
    pair = Model()
    a, b, c = (pair.node(name, p) for name, p in zip("abc", (0 * tip, tip, tip + quarter @ tip),
                                                     strict=True))
    pair.superelement("one", one, (a, b))
    pair.superelement("two", one.rotated(quarter), (b, c))
    two = reduce_model(pair, ["a", "c"])
    triple, end = Model(), tip + quarter @ tip
    a, b, c = (triple.node(name, p) for name, p in zip(
        "abc", (0 * tip, end, end + quarter @ quarter @ tip), strict=True))
    triple.superelement("pair", two, (a, b))
    triple.superelement("third", one.rotated(quarter @ quarter), (b, c))
    nested = reduce_model(triple, ["a", "c"], 12)
    same(frequencies(alone(nested)), frequencies(alone(direct)), 1e-9)
    origin, turns = direct.invariants.origin, (np.eye(3), quarter, quarter @ quarter)
    J0, parts = nested.invariants.about(origin).J0, np.zeros((3, 3))
    for turn, place in zip(turns, (0 * tip, tip, end), strict=True):
        part = one.rotated(turn)
        parts += part.invariants.about(origin - place + part.coordinates[0]).J0
    assert J0 == pytest.approx(parts, abs=1e-13 * np.abs(J0).max())
    # of one elimination of all three, as exact as rigid motion costs no force there
    assert direct.invariants.J0 == pytest.approx(
        J0, abs=max(1e-12, rigid_force(direct)) * np.abs(J0).max())
    # what is inside the inner bodies is still recovered
    assert len(nested.recovery.coordinates) > len(one.recovery.coordinates) * 3
    assert len(nested.recovery.stress) == 3 * len(one.recovery.stress)


def test_a_node_and_a_body_inside_are_recovered(tmp_path):
    force = np.array([1e-2, -2e-2, 3e-2])
    whole, free = Model(), Model()
    whole.fix(frame(whole)["a"])
    whole.force("e", force)
    exact = equilibrium(whole, 1)
    frame(free)
    path = save_body(reduce_model(free, ["a", "e"]), tmp_path / "frame.npz", ("a", "e"))
    body = load_body(path)
    model = alone(body)
    model.force("e", force)
    field = equilibrium(model, 1).field("body")
    note = next(note for note in body.notes if note.startswith("FE nodes: "))
    number = int(note.partition(", f ")[2].partition(",")[0])
    moved = exact["f.position"][-1] - POINTS["f"]
    assert field.displacement(reference="a")[number] == pytest.approx(
        moved, abs=1e-7 * np.abs(moved).max())
    forces = exact.field("end").section_forces()
    inner = field.section_forces()[-len(forces):]
    assert inner == pytest.approx(forces, abs=1e-5 * np.abs(forces).max())


def test_a_frame_falls_as_its_model_does():
    """Through a large angle, with ten modes; most of the difference is the modes'."""
    def falling(model, node):
        model.revolute(node, axis=(0, 1.0, 0))
        model.gravity((0, 0, -9.81))
        return simulate(model, h=4e-3, t_end=0.8)["e.position"]
    whole, free = Model(), Model()
    nodes = frame(whole, masses=False)
    path = falling(whole, nodes["a"])
    frame(free, masses=False)
    body = reduce_model(free, ["a", "e"], 10)
    travel = np.abs(path - path[0]).max()
    assert travel > 1.0
    found = falling(alone(body, held=""), "a")
    assert found == pytest.approx(path, abs=6e-5 * travel)


def test_a_bow_held_by_its_string():
    """Stress inside and no force at the interfaces: the body is that of the bent state."""
    def bow(held, explicit=False):
        model = Model()
        nodes = [model.node(f"n{k}", (k * 0.5, 0.0, 0.3 * (1 - (k - 2)**2 / 4))) for k in range(5)]
        for k in range(4):
            ends = nodes[k:k + 2]
            if explicit and k:          # forces of joints are those of the string
                ends[0] = model.node(f"m{k}", ends[0].point)
                model.weld(ends[0], to=nodes[k], explicit=True)
            model.beam(f"b{k}", ends, ARM, elements=2, bodies=2)
        model.spring(nodes[0], nodes[4], stiffness=2e5, length=1.9)
        if held:
            model.fix(nodes[2])
        return model
    state = equilibrium(bow(True), 4)
    for model in (bow(False), bow(True), state, bow(False, True)):
        body = reduce_model(model, ["n2", "n4"])
        same(frequencies(alone(body)), frequencies(state), 1e-10)
        assert body.invariants is not None
    moved = equilibrium(bow(True), 4)["n4.position"][-1]
    apart = np.linalg.norm(np.diff(body.coordinates, axis=0))
    assert apart == pytest.approx(np.linalg.norm(moved - (1.0, 0, 0.3)), rel=1e-9)
    assert abs(apart - np.hypot(1.0, 0.3)) > 0.001      # of the way of the built places


def test_a_planar_frame_with_an_additional_hinge():
    """A triangle of beams on hinges, one of which is there twice: its equations count once."""
    def triangle(model):
        points = {"a": (0, 0), "b": (1.0, 0.1), "c": (0.4, 0.8)}
        nodes = {k: model.node(k, p) for k, p in points.items()}
        for k, (one, other) in enumerate(("ab", "bc", "ca")):
            ends = [model.node(f"{one}{k}", points[one]), model.node(f"{other}{k}", points[other])]
            model.beam(f"beam{k}", ends, LEG, elements=4, bodies=1, modes=2)
            for end, corner in zip(ends, (one, other), strict=True):
                model.weld(end, to=nodes[corner]) if k == 0 else model.revolute(
                    end, to=nodes[corner], explicit=True)
        model.revolute("a2", to=nodes["a"], explicit=True, name="again")
        model.rigid_body("box", nodes["c"], 2.0, 0.1, centre=(0.45, 0.9))
        model.torsion_spring(nodes["c"], to="c1", stiffness=50.0)
        return nodes
    free, held = Model(planar=True), Model(planar=True)
    triangle(free)
    held.fix(triangle(held)["a"])
    body = reduce_model(free, ["a", "b"])
    same(frequencies(alone(body, ("a", "b"))), frequencies(held), 1e-9)
    assert body.planar and body.invariants is not None


def refused(change, interfaces=("a", "e"), **options):
    """The message about a model that is changed by a function of it and its nodes."""
    model = Model()
    nodes = frame(model)
    change(model, nodes)
    with pytest.raises(InputError) as error:
        reduce_model(model, interfaces, **options)
    return str(error.value)


def test_what_cannot_be_inside_is_refused_by_name():
    assert "force 'push' acts on f.position, inside the superelement" in refused(
        lambda model, nodes: model.force(nodes["f"], (1.0, 0, 0), name="push"))
    assert "b.position is fixed, and node 'b' is no interface" in refused(
        lambda model, nodes: model.fix(nodes["b"], "position"))
    assert "drive 'motor' at node 'c' cannot be inside" in refused(
        lambda model, nodes: model.drive_angle("hinge", [[0, 0], [1, 1]], name="motor"))
    assert "mode force" in refused(lambda model, nodes: model.mode_force("arm", 0, 1.0))

    def hang(model, nodes):
        end = model.node("h", (2.5, 0, 0))
        start = model.node("g", POINTS["f"])
        model.beam("pendulum", (start, end), ARM, elements=2, bodies=1, modes=0)
        model.revolute(start, to=nodes["f"], axis="y")
    said = refused(hang)
    assert "node 'h' moves without any resistance: there is a mechanism inside" in said or (
        "node 'g' moves without any resistance" in said)
    model = Model()
    hang(model, frame(model))
    assert reduce_model(model, ["a", "e", "h"]).keeps == ("full",) * 3


def test_interfaces_that_are_none_are_refused_by_name():
    def nothing(model, nodes):
        pass
    assert "no node 'x'" in refused(nothing, ("a", "x")) or "'x'" in refused(nothing, ("a", "x"))
    assert "names a node twice" in refused(nothing, ("a", "a"))
    assert "interfaces names no node" in refused(nothing, ())
    assert "the interfaces are tied to each other" in refused(
        lambda model, nodes: model.attach("link", (0, 0, 1.0), to=nodes["a"]), ("a", "link"))
    assert "no interface keeps its position" in refused(nothing, {"a": "rotation"})
    assert "modes is 1000, and with its interfaces at rest the model has" in refused(
        nothing, modes=1000)


def test_friction_sticks_and_is_told_or_slides_and_is_refused():
    """A hinge with friction, and one that a bent spring turns against it."""
    def rubbing(model, nodes):
        model.friction("hinge", 0.3, preload=10.0, radius=0.05, name="rub", reaction=False)
    model = Model()
    rubbing(model, frame(model))
    body = reduce_model(model, ["a", "e"], 4)
    assert "contact rub: sticks, and stays so" in body.notes

    def wound(model, nodes):
        rubbing(model, nodes)
        model.torsion_spring(nodes["c"], to=nodes["d"], stiffness=2e3, rest=0.3, axis="z")
    assert "friction 'rub' at node" in (said := refused(wound)) and "slides in the state" in said


def test_a_scene_from_its_bodies_and_as_one(tmp_path, capsys):
    """A box frame and a bolted flange: the body of the command is that of the scene."""
    path = tmp_path / "arm.npz"
    assert main(["reduce", "bolted-arm", "--set", "reduced=False", "--interfaces", "root", "tip",
                 "--modes", "10", "--output", str(path)]) == 0
    said = capsys.readouterr().out
    assert "revolute 'hinge', drive 'drive', what fixes root.position" in said
    whole, one = (build(reduced=reduced) for reduced in (False, True))
    states = [equilibrium(scene.model, 2) for scene in (whole, one)]
    exact, found = (vibrations(state, 4).frequency for state in states)
    assert found == pytest.approx(exact, rel=1e-4)
    # bolts that pull plates together: a part of what they would without a flange that gives way
    bolts = [np.linalg.norm(states[0][f"bolt {k}.force"][-1]) for k in range(4)]
    assert all(5e3 < force < 1.5e4 for force in bolts)
    paths = [simulate(scene.model, 1e-3, 0.4, start=state)["tip.position"]
             for scene, state in zip((whole, one), states, strict=True)]
    travel = np.ptp(paths[0][:, 2])
    assert travel > 0.5 and np.abs(paths[1] - paths[0]).max() < 1e-3 * travel
    assert load_body(path).total_mass == pytest.approx(
        one.model.bodies["arm"].reduced.total_mass + 5.0)      # with the tool at its tip


def test_paths_along_bodies_stay_on_the_whole(tmp_path):
    """Paths of the model, over several bodies, and of reductions; a mass crosses all of it."""
    def bridge(reduced):
        model = Model()
        ends = [model.node(name, (x, 0, 0)) for name, x in (("a", 0.0), ("m", 1.0), ("b", 2.0))]
        fe = straight_beam((0, 0, 0), (1.0, 0, 0), ARM, 6)
        body = craig_bampton(fe, [(0, "full"), (6, "full")], 2, paths={"axis": range(7)})
        for name, k in (("first", 0), ("second", 1)):
            model.superelement(name, body, ends[k:k + 2], stiffening=False)
        model.path("deck", on=["first", "second"])
        if reduced:
            whole = reduce_model(model, ["a", "b"])
            assert sorted(whole.paths) == ["deck", "first.axis", "second.axis"]
            assert [len(nodes) for nodes in whole.paths.values()] == [13, 7, 7]
            assert whole.recovery.coordinates[whole.paths["deck"]][:, 0] == pytest.approx(
                np.arange(13) / 6)
            model = Model()
            ends = [model.node(name, point) for name, point in zip("ab", whole.coordinates,
                                                                   strict=True)]
            model.superelement("whole", load_body(save_body(whole, reduced)), ends,
                               stiffening=False)
            model.path("deck", on="whole", nodes="deck")
        for end in (ends[0], ends[-1]):
            model.fix(end)
        mass = model.node("mass", (0, 0, 0), "translation")
        model.point_mass("car", mass, 3.0)
        model.force(mass, "-z", 3.0)
        model.path_joint(mass, "deck", name="runs")
        model.drive_way("runs", (lambda t: 2.0 * t, lambda t: 2.0, lambda t: 0.0))
        return simulate(model, 2e-3, 0.9)["mass.position.z"]
    exact, found = bridge(None), bridge(tmp_path / "whole.npz")
    assert found == pytest.approx(exact, abs=2e-3 * np.abs(exact).max())
