"""Bodies under stress between their interfaces: strings, clamped arches, in every reader."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, Result, generalized_alpha, simulate
from sebody.analysis import Ensemble, equilibrium, final, gradient, modes
from sebody.basics.errors import InputError
from sebody.fem import Section, circle, straight_beam
from sebody.io import load_body, save_body, write_sid
from sebody.model.variants import copied, keep_modes, planar
from sebody.reduction import ReducedBody, craig_bampton, reduce_model
from sebody.reduction.preload import preload_of
from sebody.reduction.rigid_motions import rigid_motions

TURN = Rotation.from_rotvec((0.7, -0.4, 1.1)).as_matrix()
TUBE = circle(0.02, 2.1e11, 0.3, 7850.0)
PULL, TWIST = np.array([300.0, 40, -100]), np.array([10.0, 30, -20])
pytestmark = pytest.mark.filterwarnings("ignore::sebody.LimitWarning")


def frequencies(state, least=0.05):
    found = modes(state).frequency
    return found[found > least]


def same(found, exact, relative):
    count = min(len(found), len(exact))
    assert count >= 10
    assert found[:count] == pytest.approx(exact[:count], rel=relative)


# a string of 100 m in tension: of the benchmarks of FEDEM, here of twelve nonlinear elements
LENGTH, TENSION = 100.0, 54.6e6
AREA, SECOND = np.pi * 0.3**2 / 4, np.pi * 0.3**4 / 64
ROD = Section(AREA, SECOND, SECOND, 2 * SECOND, 2.1e11, 0.3, 556.58 / AREA)


def string(elements=30):
    model = Model()
    a, b = model.node("a", (0, 0, 0)), model.node("b", (LENGTH, 0, 0))
    model.beam("string", (a, b), ROD, elements=elements)
    model.force(b, (TENSION, 0, 0), name="pull")
    return model


def stretched(body):
    model = Model()
    nodes = [model.node(name, point) for name, point in zip("ab", body.coordinates, strict=True)]
    model.superelement("string", body, nodes)
    model.force("b", (TENSION, 0, 0), name="pull")
    return model


@pytest.fixture(scope="module")
def tense():
    return reduce_model(string(), ["a", "b"])


def test_a_string_reduced_under_tension(tense):
    """A mass hangs at its end, which is free across: only the tension holds it there."""
    found = []
    for model in (string(), stretched(tense)):
        model.fix("a", "position")
        model.point_mass("bob", "b", 2e4)
        state = equilibrium(model, 4)
        found.append(frequencies(state))
    same(found[1], found[0], 1e-9)
    assert found[0][0] == pytest.approx(0.58325, rel=1e-3)      # of the limit of many elements
    # the place of the interface is that under tension, which moves it no more
    assert state["b.position"][-1] == pytest.approx(tense.coordinates[1], abs=1e-9)
    assert tense.coordinates[1, 0] == pytest.approx(LENGTH * (1 + TENSION / (2.1e11 * AREA)),
                                                    rel=1e-5)
    assert tense.preload.tension == pytest.approx([TENSION], rel=1e-9)
    assert "under stress where it is undeformed: 1 line of up to 5.46e+07" in tense.summary()


def test_a_string_between_two_hinges(tense):
    """The frequencies of its stretched length: (n / 2 l) sqrt(T / m (1 + n^2 pi^2 E I / T l^2))."""
    found = []
    for model in (string(), stretched(tense)):
        model.fix("a", "position")
        guide = model.node("guide", model.nodes["b"].point)
        model.fix(guide)
        model.slider("b", to=guide, axis=(1.0, 0, 0))
        found.append(frequencies(equilibrium(model, 4)))
    same(found[1], found[0], 1e-9)
    length = tense.coordinates[1, 0]
    n, mass = np.arange(1, 4), 556.58 * LENGTH / length
    exact = n / (2 * length) * np.sqrt(TENSION / mass * (
        1 + n**2 * np.pi**2 * 2.1e11 * SECOND / (TENSION * length**2)))
    assert exact[0] == pytest.approx(1.56434, abs=1e-5)
    errors = found[1][:6:2] / exact - 1        # of straight elements: of second order in 1 / 30
    assert errors[0] == pytest.approx(-0.46 * (1 / 30)**2, abs=2e-4)
    assert np.abs(errors).max() < 6e-3


def arch(turn=np.eye(3), loaded=True):      # noqa: B008
    """Of four limbs, pulled, bent and twisted between its ends."""
    model = Model()
    nodes = [model.node(f"n{k}", turn @ np.array([k * 0.5, 0.1 * (k == 1),
                                                  0.3 * (1 - (k - 2)**2 / 4)])) for k in range(5)]
    for k in range(4):
        model.beam(f"limb{k}", nodes[k:k + 2], TUBE, elements=2, bodies=1, modes=4)
    model.fix("n0")
    if loaded:
        load(model, "n4", turn)
    return model


def load(model, node, turn=np.eye(3)):      # noqa: B008
    model.force(node, turn @ PULL, name="pull")
    model.torque(node, turn @ TWIST, name="twist")


def alone(body, turn=np.eye(3), loaded=True, **options):        # noqa: B008
    """The arch as a body, held as it was."""
    model = Model()
    placed = body.coordinates @ options["rotation"].T if "rotation" in options else (
        body.coordinates)
    nodes = [model.node(name, point) for name, point in zip("ab", placed, strict=True)]
    model.superelement("arch", body, nodes, **options)
    model.fix("a")
    if loaded:
        load(model, "b", turn)
    return model


@pytest.fixture(scope="module")
def bent():
    return reduce_model(arch(), ["n0", "n4"])


def test_an_arch_under_a_general_force_and_moment(bent, tmp_path):
    exact = frequencies(equilibrium(arch(), 4))
    turned = reduce_model(arch(TURN), ["n0", "n4"])
    again = load_body(save_body(bent, tmp_path / "arch.npz", ("a", "b")))
    for model in (alone(bent), alone(again), alone(turned, TURN),
                  alone(bent, TURN, rotation=TURN)):
        state = equilibrium(model, 2)
        same(frequencies(state), exact, 1e-9)
        assert state["b.position"][-1] == pytest.approx(model.nodes["b"].point, abs=1e-12)
        assert state["b.rotation"][-1] == pytest.approx(np.eye(3), abs=1e-12)
    assert len(bent.preload.tension) == 6
    free = reduce_model(arch(loaded=False), ["n0", "n4"])
    assert free.preload is None
    gap = np.abs(frequencies(equilibrium(arch(loaded=False)))[:2] / exact[:2] - 1).max()
    assert gap > 1e-3       # the stress matters here


def test_the_interfaces_may_come_in_any_order(bent):
    other = reduce_model(arch(), ["n4", "n0"])
    model = Model()
    b, a = (model.node(name, point) for name, point in zip("ba", other.coordinates, strict=True))
    model.superelement("arch", other, (b, a))
    model.fix(a)
    load(model, b)
    same(frequencies(equilibrium(model, 2)), frequencies(equilibrium(alone(bent), 2)), 1e-9)


def test_the_arch_swings_on_when_its_load_is_gone(bent):
    """As its model does, to what linear limbs miss: the whole way is that of the load."""
    few = reduce_model(arch(), ["n0", "n4"], 2)
    taken = simulate(alone(few, loaded=False), 2e-4, 0.1, generalized_alpha(1.0))
    rest = equilibrium(arch(loaded=False), 1)["n4.position"][-1]
    still = equilibrium(alone(bent, loaded=False), 4)["b.position"][-1]
    way = np.linalg.norm(bent.coordinates[1] - rest)
    assert np.linalg.norm(still - rest) < 0.02 * way
    energy = sum(taken[f"energy.{kind}"] for kind in ("kinetic", "strain", "potential"))
    assert np.ptp(energy) < 1e-3 * taken["energy.kinetic"].max()


def test_stiffness_of_lines_against_differences_of_their_energy():
    random = np.random.default_rng(4)
    for D in (3, 2):
        turns = 1 if D == 2 else 3
        points, keeps = random.normal(size=(3, D)), ("full", "translation", "full")
        size = 3 * D + 2 * turns + 1
        forces = np.zeros(size)
        forces[:-1] = random.normal(size=size - 1)
        rigid = rigid_motions(points, keeps, size, points.mean(axis=0))
        forces -= rigid @ np.linalg.lstsq(rigid, forces, None)[0]
        lines = preload_of(forces, points, keeps, size)
        assert lines.forces(points, keeps, size) == pytest.approx(forces, abs=1e-9)
        lengths = np.linalg.norm(np.diff(lines.ends(points), axis=1), axis=2)[:, 0]
        k = np.abs(lines.tension) / lengths
        rest = np.where(lines.tension > 0, 0.0, 2 * lengths)

        def energy(y, points=points, lines=lines, k=k, rest=rest, D=D, turns=turns):
            moved = points + y[:3 * D].reshape(3, D)
            psi = dict(zip((0, 2), y[3 * D:-1].reshape(2, turns), strict=True))
            total = 0.0
            for nodes, arms, own, free in zip(lines.nodes, lines.arms, k, rest, strict=True):
                ends = []
                for node, arm in zip(nodes, arms, strict=True):
                    vector = np.zeros(3) if D == 2 else psi.get(node, np.zeros(3))
                    if D == 2:
                        vector[2] = psi.get(node, np.zeros(1))[0]
                    R = Rotation.from_rotvec(vector).as_matrix()[:D, :D]
                    ends.append(moved[node] + R @ arm)
                total += own * (np.linalg.norm(ends[1] - ends[0]) - free)**2 / 2
            return total
        h, unit = 1e-4, np.eye(size)
        exact = np.array([[(energy(h * (a + b)) - energy(h * (a - b)) - energy(h * (b - a))
                            + energy(-h * (a + b))) / (4 * h**2) for b in unit] for a in unit])
        K = lines.stiffness(points, keeps, size)
        assert K == pytest.approx(exact, abs=1e-5 * np.abs(exact).max())


def test_a_preloaded_body_in_ensembles_gradients_files_and_variants(tmp_path):
    few = reduce_model(flat_arch(True), ["n0", "n4"], 4)
    model = flat_alone(few)
    model.gravity((0, -9.81))
    result = simulate(model, 1e-3, 0.05)
    path = result.save(tmp_path / "run.npz")
    loaded = Result.load(path)
    assert np.array_equal(loaded["b.position"], result["b.position"])
    assert loaded.model.bodies["arch"].reduced.preload.tension == pytest.approx(few.preload.tension)
    for made in (copied(model), keep_modes(model, "arch", 2).model):
        assert len(made.loads) == len(model.loads)      # springs are there once
    sizes, step = np.array([1.0 - 1e-4, 1.0, 1.0 + 1e-4]), 1e-4
    runs = Ensemble(model, 1e-3).run({"pull.amplitude": sizes}, 0.05,
                                     {"z": final("b.position.y")})
    assert runs["z"][1] == pytest.approx(result["b.position"][-1, 1], abs=1e-13)
    slope = gradient(model, 1e-3, 0.05, {"z": final("b.position.y")}, ["pull.amplitude"])
    assert slope.matrix[0, 0] == pytest.approx(
        (runs["z"][2] - runs["z"][0]) / (2 * step), rel=1e-5)


def flat_arch(in_plane):
    """An arch in its plane, pulled and bent."""
    model = Model(planar=in_plane)
    nodes = [model.node(f"n{k}", (k * 0.5, 0.3 * (1 - (k - 2)**2 / 4), 0.0)[:3 - in_plane])
             for k in range(5)]
    for k in range(4):
        model.beam(f"limb{k}", nodes[k:k + 2], TUBE, elements=2, bodies=1, modes=2)
    model.fix("n0")
    model.force("n4", (300.0, -100, 0)[:3 - in_plane], name="pull")
    model.torque("n4", 25.0 if in_plane else (0, 0, 25.0))
    return model


def flat_alone(body):
    model = Model(planar=True)
    nodes = [model.node(name, point) for name, point in zip("ab", body.coordinates, strict=True)]
    model.superelement("arch", body, nodes)
    model.fix("a")
    model.force("b", (300.0, -100), name="pull")
    model.torque("b", 25.0)
    return model


def test_a_planar_arch_is_that_in_space():
    """Its lines lie in the plane, three between two interfaces."""
    exact = frequencies(equilibrium(flat_arch(True), 4))
    body = reduce_model(flat_arch(True), ["n0", "n4"])
    same(frequencies(equilibrium(flat_alone(body), 2)), exact, 1e-9)
    assert len(body.preload.tension) == 3
    spatial = reduce_model(flat_arch(False), ["n0", "n4"])
    assert spatial.coordinates[:, :2] == pytest.approx(body.coordinates, abs=1e-9)
    model = Model()
    nodes = [model.node(name, point) for name, point in zip("ab", spatial.coordinates, strict=True)]
    model.superelement("arch", spatial, nodes)
    model.fix("a")
    model.force("b", (300.0, -100, 0))
    model.torque("b", (0, 0, 25.0))
    flat = planar(model).model          # with the springs of the preload
    assert len(flat.loads) == len(model.loads)
    found, whole = frequencies(equilibrium(flat, 2))[:4], frequencies(equilibrium(model, 2))
    nearest = whole[np.abs(whole[:, None] / found - 1).argmin(axis=0)]      # those in the plane
    assert found == pytest.approx(nearest, rel=1e-8)


def test_forces_that_are_no_preload_are_refused():
    body = craig_bampton(straight_beam((0, 0, 0), (1.0, 0, 0), TUBE, 4),
                         {0: "full", 4: "translation"}, 2)
    n = len(body.mass)

    def refused(**entries):
        forces = np.zeros(n)
        for at, value in entries.items():
            forces[int(at[1:])] = value
        with pytest.raises(InputError) as error:
            ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, 2, preload=forces)
        return str(error.value)
    assert "preload is not in balance" in refused(f0=1.0)
    assert "preload acts on internal modes" in refused(f9=1.0, f0=-1.0, f3=1.0)
    pulled = np.zeros(n)
    pulled[[0, 3]] = -1.0, 1.0
    made = ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, 2, preload=pulled,
                       invariants=body.invariants)
    assert made.preload.tension == pytest.approx([1.0])
    with pytest.raises(InputError, match="SID files hold bodies that are free of stress"):
        write_sid(made, "body.SID_FEM")
    with pytest.raises(InputError, match="give 11 forces, or a Preload"):
        ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, 2, preload="f")
