"""Bodies held to the ground: the OC4 jacket, a tower against its free body, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import linalg
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, simulate
from sebody.analysis import equilibrium, modes, vibrations
from sebody.fem import Section, circle, loads, planar_beam, straight_beam
from sebody.io import load_body, save_body
from sebody.model.variants import planar, rigid
from sebody.reduction import (
    ReducedBody,
    craig_bampton,
    grounded_body,
    grounded_from_fe,
    self_weight_stiffness,
)
from sebody.verify.outside.jacket import (
    BASE,
    DAMPED,
    INTERFACE,
    INTERFACE_FREE,
    WITH_MASS,
    body as jacket_body,
    jacket,
    matrices,
)

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
SHIFT = np.array([12.0, -7.0, 30.0])
G = 9.81
TOWER = straight_beam((0, 0, 0), (0, 0, 90.0), circle(1.0, 2.1e11, 0.3, 7850.0), 24)


def hertz(K, M):
    """Frequencies of a pencil."""
    return np.sqrt(np.maximum(linalg.eigh(K, M, eigvals_only=True), 0.0)) / (2 * np.pi)


def clamped(free, base, at):
    """What a foundation designer exports of a free body: matrices with the base held."""
    turns = 1 if free.planar else 3
    d, n = free.coordinates.shape[1], len(free.mass)
    at_place = d * free.position_nodes.index(base)
    at_turn = d * len(free.position_nodes) + turns * free.rotation_nodes.index(base)
    gone = [*range(at_place, at_place + d), *range(at_turn, at_turn + turns)]
    kept = np.setdiff1d(np.arange(n), gone)
    R, grid = free.rigid_modes_about(at), np.ix_(kept, kept)
    return (free.stiffness[grid], free.mass[grid], (free.mass @ R)[kept], R.T @ free.mass @ R, kept)


def test_jacket_has_the_frequencies_of_its_matrices():
    """Interface free and with 350 t, damped and not; the numbers are those of SciPy, printed."""
    assert_allclose(vibrations(equilibrium(jacket(damped=False), 1), 8).frequency,
                    INTERFACE_FREE, rtol=0, atol=6e-7)
    assert_allclose(vibrations(equilibrium(jacket(False, top=True), 1), 5).frequency,
                    [*WITH_MASS, INTERFACE_FREE[2]], rtol=0, atol=6e-7)
    found = modes(equilibrium(jacket(top=True), 1))
    assert_allclose(np.abs(found.values[:4]) / (2 * np.pi), DAMPED[0], rtol=0, atol=6e-7)
    assert_allclose(found.damping[:4], DAMPED[1], rtol=0, atol=6e-8)
    M, K, _ = matrices()
    assert_allclose(vibrations(Simulation(jacket(damped=False), 0.01)).frequency, hertz(K, M),
                    rtol=1e-9)


def test_jacket_under_a_static_force():
    model = jacket()
    model.force("interface", (1e6, 0, 0))
    result = equilibrium(model, 1)
    assert result["interface.position"][-1][0] == pytest.approx(0.0285365425, abs=5e-11)
    assert result["jacket.base.reaction"][-1] == pytest.approx([-1e6, 0, 0], abs=1e-3)


def test_matrices_of_the_held_body_make_the_free_one_again():
    """Turned and shifted, three interfaces, of which one keeps a position alone."""
    ends = SHIFT + np.array([[0, 0, 0], [0, 0, 90.0]]) @ TURN.T
    fe = straight_beam(*ends, circle(1.0, 2.1e11, 0.3, 7850.0), 12)
    free = craig_bampton(fe, [(12, "full"), (5, "translation"), (0, "full")], 4)
    K, M, L, MR, kept = clamped(free, 2, ends[0])
    made = grounded_body(K, M, free.coordinates[:2], free.keeps[:2], 4, K * 1e-3, ends[0], L, MR)
    for name in ("stiffness", "mass"):
        one, other = getattr(made, name), getattr(free, name)
        size = np.sqrt(np.abs(np.diag(other)))
        assert np.abs((one - other) / np.outer(size, size)).max() < 1e-9     # of shifted axes
    assert made.keeps == free.keeps and made.base == 2 and not made.rests
    assert_allclose(made.damping, 1e-3 * made.stiffness, rtol=0, atol=1e-9 * made.damping.max())
    planar_free = craig_bampton(planar_beam((1, 2), (4, 6), Section(
        0.01, 1e-5, 1e-5, 1e-5, 1e9, 0.3, 1000.0), 6), [(6, "full"), (0, "full")], 2)
    K, M, L, MR, _ = clamped(planar_free, 1, (1, 2))
    flat = grounded_body(K, M, [(4, 6)], modes=2, base=(1, 2), coupling=L, rigid_mass=MR)
    assert_allclose(flat.mass, planar_free.mass, atol=1e-10 * planar_free.mass.max())
    assert flat.planar and flat.rigid_modes.shape[1] == 3


def held(body, field=(0, 0, 0), **others):
    """A tower on its foundation, under gravity."""
    model = Model()
    top = model.node("top", (0, 0, 90.0))
    model.foundation("tower", body, top, **others)
    model.gravity(field)
    return model


def test_with_coupling_it_is_the_free_body_held():
    """Sag and reaction m g under gravity across the tower."""
    free = replace(craig_bampton(TOWER, [(24, "full"), (0, "full")], 6), invariants=None)
    K, M, L, MR, _ = clamped(free, 1, (0, 0, 0))
    own = held(grounded_body(K, M, [(0, 0, 90.0)], modes=6, base=(0, 0, 0), coupling=L,
                             rigid_mass=MR), (G, 0, 0))
    other = Model()
    top, base = other.node("top", (0, 0, 90.0)), other.node("base", (0, 0, 0))
    other.superelement("tower", free, (top, base), frame="node", frame_node=1)
    other.fix(base)
    other.gravity((G, 0, 0))
    one, two = equilibrium(own, 1), equilibrium(other, 1)
    assert_allclose(one["top.position"][-1], two["top.position"][-1], rtol=1e-10, atol=1e-10)
    weight = free.total_mass * G
    assert one["top.position"][-1][0] == pytest.approx(
        weight / 90 * 90**4 / 8 / (2.1e11 * np.pi / 4), rel=1e-3)        # and shear
    assert one["tower.base.reaction"][-1] == pytest.approx(
        [-weight, 0, 0], rel=1e-12, abs=1e-9 * weight)


def driven(h, amplitude=0.05, rate=1.2):
    """How far a tower's tip is from the linear equations of a base that is driven."""
    free = craig_bampton(TOWER, [(24, "full"), (0, "full")], 6)
    K, M, L, MR, _ = clamped(free, 1, (0, 0, 0))
    body = grounded_body(K, M, [(0, 0, 90.0)], modes=6, base=(0, 0, 0), coupling=L, rigid_mass=MR)
    model = Model()
    top, base = model.node("top", (0, 0, 90.0)), model.node("base", (0, 0, 0))
    model.superelement("tower", body, (top, base))
    model.fix(base, "rotation")
    model.move(base, (1.0, 0, 0), (lambda t: amplitude * (1 - np.cos(rate * t)),
                                   lambda t: amplitude * rate * np.sin(rate * t),
                                   lambda t: amplitude * rate**2 * np.cos(rate * t)))
    result = simulate(model, h, 8.0)
    squares, shapes = linalg.eigh(K, M)
    own, t = result["top.position"][:, 0] - result["base.position"][:, 0], result.t
    # of every mode q'' + w^2 q = -f cos(rate t) from rest: closed form
    factors, w = shapes.T @ L[:, 0] * amplitude * rate**2, np.sqrt(squares)
    answers = factors / (squares - rate**2) * (np.cos(np.outer(t, w)) - np.cos(rate * t)[:, None])
    exact = answers @ shapes[0]
    return np.abs(own - exact).max() / np.abs(exact).max()


def test_a_driven_base_follows_the_linear_equations():
    coarse, fine = driven(0.01), driven(0.005)
    assert fine < 2e-4 and 3.3 < coarse / fine < 4.7


def test_self_weight_lowers_the_frequencies():
    """Against all DOFs of the FE model, and against the body that stiffens under gravity."""
    push = loads.point_load(TOWER, 24, (0, 0, -350e3 * G))
    K, M = TOWER.stiffness.toarray(), TOWER.mass.toarray()
    M[144:147, 144:147] += 350e3 * np.eye(3)
    p = push + loads.body_force(TOWER, (0, 0, -G))
    u = np.r_[np.zeros(6), np.linalg.solve(K[6:, 6:], p[6:])]
    exact = hertz((K + TOWER.geometric_stiffness(u).toarray())[6:, 6:], M[6:, 6:])[:4]

    def found(body, field=(0, 0, 0)):
        model = held(body, field)
        model.point_mass("turbine", "top", 350e3)
        return vibrations(equilibrium(model, 1), 4).frequency
    with_weight = grounded_from_fe(TOWER, [(24, "full")], 0, 6, (0, 0, -G), push)
    assert_allclose(found(with_weight), exact, rtol=1e-4)       # of six modes
    assert_allclose(found(grounded_from_fe(TOWER, [(24, "full")], 0, 6), (0, 0, -G)), exact,
                    rtol=2e-4)
    assert found(grounded_from_fe(TOWER, [(24, "full")], 0, 6))[0] > 1.1 * exact[0]
    free = craig_bampton(TOWER, [(24, "full"), (0, "full")], 6)
    K, M, L, MR, _ = clamped(free, 1, (0, 0, 0))
    given = grounded_body(K, M, [(0, 0, 90.0)], modes=6, base=(0, 0, 0), coupling=L, rigid_mass=MR,
                          self_weight_stiffness=self_weight_stiffness(
                              TOWER, [(24, "full")], 0, 6, (0, 0, -G), push))
    assert_allclose(given.stiffness, with_weight.stiffness, rtol=0,
                    atol=1e-9 * with_weight.stiffness.max())


def test_the_place_of_a_base_at_rest_does_not_matter():
    """But for products of rotations, here 1e-8; places of 20 m are rounded to 4e-15."""
    M, K, C = matrices()
    tips = []
    for base in (None, (40.0, -30.0, -50.0)):
        model = Model()
        node = model.node("interface", INTERFACE)
        model.foundation("jacket", grounded_body(K, M, [INTERFACE], modes=25, damping=C, base=base),
                         node)
        model.force(node, (300.0, 100.0, 0), lambda t: np.sin(3.0 * t))
        tips.append(simulate(model, 0.02, 1.0)["interface.position"][-1] - INTERFACE)
    assert_allclose(*tips, rtol=0, atol=1e-13)


def test_rotated_saved_planar_and_on_a_carrier(tmp_path):
    body = jacket_body()
    model = Model()
    node = model.node("interface", TURN @ INTERFACE + SHIFT)
    model.foundation("jacket", body, [node], rotation=TURN)
    assert_allclose(model.nodes["jacket.base"].point, TURN @ BASE + SHIFT, atol=1e-12)
    found = modes(Simulation(model, 0.01))
    straight = modes(Simulation(jacket(), 0.01))
    assert_allclose(np.abs(found.values[:4]), np.abs(straight.values[:4]), rtol=1e-9)
    read = load_body(save_body(body, tmp_path / "jacket.npz"))
    assert read.base == 1 and read.rests and read.rotated(TURN).rests
    free = craig_bampton(TOWER, [(24, "full"), (0, "full")], 2)
    K, M, L, MR, _ = clamped(free, 1, (0, 0, 0))
    coupled = grounded_body(K, M, [(0, 0, 90.0)], modes=2, base=(0, 0, 0), coupling=L,
                            rigid_mass=MR)
    flat = planar(held(coupled, (0, 0, -G))).model
    assert flat.bodies["tower"].reduced.base == 1
    carried = Model()       # on a heavy cart that is free: the centre of mass stays
    top, base = carried.node("top", (0, 0, 90.0)), carried.node("base", (0, 0, 0))
    carried.superelement("tower", coupled, (top, base))
    carried.rigid_body("cart", base, 3e6, np.full(3, 1e9))
    carried.force(top, (1e5, 0, 0))
    result = simulate(carried, 0.02, 1.0)
    assert result["momentum"][-1][0] == pytest.approx(1e5 * result.t[-1], rel=1e-6)


def test_what_a_body_without_coupling_cannot_be_asked_for():
    body = jacket_body()
    model = jacket()
    model.gravity((0, 0, -G))
    with pytest.raises(InputError, match="'jacket' is held to the ground without inertial coupling "
                                         "with its base, so its weight is unknown: give grounded"):
        Simulation(model, 0.1)
    for change, message in (
            (lambda m, nodes: m.superelement("j", body, nodes, frame="converged_mean"),
             "the frame 'converged_mean' would give wrong frequencies"),
            (lambda m, nodes: m.superelement("j", body, nodes, frame="node", frame_node=0),
             "use frame='node' with frame_node=1, as model.foundation does"),
            (lambda m, nodes: Simulation(m.superelement("j", body, nodes) and m, 0.1),
             "so node 'b', its base, must be fixed: use model.foundation"),
            (lambda m, nodes: [m.superelement("j", body, nodes), m.move(
                nodes[1], (1, 0, 0), [(0, 0), (1, 1)]), m.fix(nodes[1], "rotation"),
                Simulation(m, 0.1)], "so node 'b', its base, must be fixed")):
        made = Model()
        nodes = made.node("a", INTERFACE), made.node("b", BASE)
        with pytest.raises(InputError) as caught:
            change(made, nodes)
        assert message in str(caught.value)
    with pytest.raises(InputError, match="its mass as a rigid body is unknown"):
        rigid(jacket(), "jacket")


def test_a_held_body_is_told_what_it_is():
    M, K, _ = matrices()
    with pytest.raises(InputError, match="the body is held to the ground: use grounded_body, or "
                                         "import the FE model free with the base as an interface"):
        ReducedBody(K, M, [INTERFACE], ("full",), 25)
    free = craig_bampton(TOWER, [(24, "full"), (0, "full")], 2)
    with pytest.raises(InputError, match="does not resist rigid motion of the interfaces"):
        grounded_body(free.stiffness, free.mass, free.coordinates, modes=2)
    rounded = free.stiffness + 1e-4 * np.abs(free.stiffness).max() * np.diag(
        np.r_[np.ones(3), np.zeros(11)])
    with pytest.raises(InputError, match="export them with 14 digits or more"):
        replace(free, stiffness=rounded, invariants=None)


@pytest.mark.parametrize("changed, message", [
    ({"coupling": np.zeros((31, 6))}, "coupling is given without rigid_mass: give both"),
    ({"rigid_mass": np.eye(6)}, "rigid_mass is given without coupling: give both"),
    ({"coupling": np.zeros((31, 6)), "rigid_mass": np.eye(6)}, "without base: give the point"),
    ({"coupling": np.zeros((6, 31)), "rigid_mass": np.eye(6), "base": BASE},
     "coupling has shape (6, 31)"),
    ({"coupling": np.zeros((31, 6)), "rigid_mass": np.triu(np.ones((6, 6))), "base": BASE},
     "rigid_mass is not symmetric"),
    ({"coupling": np.full((31, 6), 1e8), "rigid_mass": np.eye(6), "base": BASE},
     "mass is indefinite"),
    ({"mass": -matrices()[0]}, "mass has a negative eigenvalue"),
    ({"stiffness": np.diag(-np.ones(31))}, "stiffness has a negative eigenvalue"),
    ({"damping": -matrices()[2]}, "damping is negative"),
    ({"stiffness": np.triu(matrices()[1])}, "stiffness is not symmetric: stiffness[0, 4]"),
    ({"modes": 24}, "stiffness has shape (31, 31); the layout has 30"),
    ({"self_weight_stiffness": -2 * matrices()[1]}, "stiffness has a negative eigenvalue"),
    ({"loads": {"wind": np.zeros(5)}}, "load 'wind' has shape (5,)")])
def test_refused(changed, message):
    M, K, C = matrices()
    with pytest.raises(InputError) as caught:
        grounded_body(**{"stiffness": K, "mass": M, "coordinates": [INTERFACE], "modes": 25,
                         "damping": C, **changed})
    assert message in str(caught.value)
