"""DOF blocks that nothing needs are left to follow: as in a body reduced anew without them."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.fem import Section, planar_beam, straight_beam
from sebody.model.variants import can_be_dropped, drop_triplet, with_options
from sebody.reduction import craig_bampton
from sebody.reduction.condensation import released

H, STEPS = 0.002, 40
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
SECTION = Section(area=9.0, inertia_y=4.0, inertia_z=6.75, torsion=8.0, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
EXACT = generalized_alpha(tolerance=1e-12)
# of vibrations: modes in the space of the modes before are not those of the FE model
MODES = 5e-3


def at(*place: float) -> np.ndarray:
    return np.array([3.0, -2.0, 1.0]) + TURN @ place


def bar(modes: int, keep: str = "full", elements: int = 12, planar: bool = False,
        further: tuple[int, ...] = ()):
    """A beam whose last node keeps what is given, with a load inside."""
    ends = at(0, 0, 0), at(100, 40, 0)
    fe_model = (planar_beam(*(e[:2] for e in ends), SECTION, elements) if planar else
                straight_beam(*ends, SECTION, elements))
    wind = np.zeros(fe_model.stiffness.shape[0])
    wind[fe_model.rows[3]] = (20.0, 50.0, 300.0) if planar else (20.0, 50.0, 30.0, 9.0, 3.0, 300.0)
    boundary = [(0, "full"), (elements, keep), *((node, "full") for node in further)]
    return craig_bampton(fe_model, boundary, modes, loads={"wind": wind})


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize(("kind", "keep", "further"), [("rotation", "translation", ()),
                                                       ("position", "rotation", (7,))])
def test_a_released_body_is_one_reduced_anew(planar, kind, keep, further):
    rich = bar(8, planar=planar, further=further)
    found, anew = released(rich, 1, kind).body, bar(8, keep, planar=planar, further=further)
    assert found.keeps == anew.keeps and found.modes == 8
    held = len(found.mass) - 8
    # static shapes are the same: what differs is the rounding of two reductions
    for name in ("stiffness", "mass"):
        expected = getattr(anew, name)[:held, :held]
        assert np.abs(getattr(found, name)[:held, :held] - expected).max() < (
            1e-11 * np.abs(expected).max())
    load, expected = (one.loads["wind"][:held] for one in (found, anew))
    assert np.abs(load - expected).max() < 1e-11 * np.abs(expected).max()
    for name in ("S1", "g", "h", "K", "J2"):
        own, expected = (getattr(one.invariants, name) for one in (found, anew))
        size = np.abs(expected).max()
        if name in ("K", "J2"):
            own, expected = own[..., :held, :], expected[..., :held, :]
        assert np.abs(own[..., :held] - expected[..., :held]).max() < 1e-10 * size, name
    # modes are those in the space of the modes before and what is released: not quite the same
    rigid = 3 if planar else 6
    own, expected = (np.sqrt(eigh(one.stiffness, one.mass)[0][rigid:rigid + 3])
                     for one in (found, anew))
    assert np.allclose(own, expected, rtol=1e-3)
    shapes, expected = (one.recovery.shapes[:, :held] for one in (found, anew))
    assert np.abs(shapes - expected).max() < 1e-11 * np.abs(expected).max()


def test_all_modes_span_what_was_there_before():
    """With the released coordinates as further modes nothing is lost, in any axes."""
    body = bar(4).rotated(TURN.T)
    found = released(body, 1, "rotation", modes=7)
    assert found.body.modes == 7
    old, new = (eigh(one.stiffness, one.mass, eigvals_only=True)[6:]
                for one in (body, found.body))
    assert np.allclose(new, old, rtol=1e-9)
    y = np.arange(1.0, 17.0) * 1e-3
    assert np.allclose(found.body.displacements(y), body.displacements(found.basis @ y),
                       rtol=0, atol=1e-9)


def pendulum(keep: str = "full", modes: int = 8, planar: bool = False, frame="converged_mean",
             frame_node: int = 0) -> Model:
    model, size = Model(planar=planar), 2 if planar else 3
    tip = model.node("tip", at(100, 40, 0)[:size], keep)
    base = model.node("base", at(0, 0, 0)[:size])
    model.superelement("beam", bar(modes, keep, planar=planar), [base, tip], frame=frame,
                       frame_node=frame_node)
    model.fix(base, "position")
    model.body_load("beam", "wind")
    model.force(tip, (TURN @ (0.0, 3.0, 90.0))[:size])
    model.gravity((TURN @ (0.0, -9.0, 3.0))[:size])
    model.rigid_velocity(np.zeros(size), 0.4 if planar else (0.1, 0.2, 0.4), about=base.point)
    return model


def assert_same(model: Model, other: Model, names, limit: float) -> None:
    expected, found = (simulate(one, H, STEPS * H, EXACT) for one in (model, other))
    for name in names:
        size = np.abs(expected[name] - expected[name][0]).max()
        assert np.abs(found[name] - expected[name]).max() <= limit * size, name


@pytest.mark.parametrize("planar", [False, True])
def test_a_model_moves_as_one_built_without_the_triplet(planar):
    model = pendulum(planar=planar)
    assert can_be_dropped(model) == [("beam", "base", "rotation")]      # then the other must stay
    made, sentence = drop_triplet(model, "beam", "tip")
    saved = "1 unknown" if planar else "3 unknowns"
    assert sentence.startswith(f"beam keeps no rotation at tip: {saved} fewer; its first "
                               "frequency while free is ")
    before, after = (np.sqrt(eigh(b.stiffness, b.mass, eigvals_only=True)[3 if planar else 6])
                     / (2 * np.pi) for b in (m.bodies["beam"].reduced for m in (model, made)))
    assert sentence.endswith(f" {after:.6g} instead of {before:.6g}")
    assert made.nodes["tip"].rotation is None and model.nodes["tip"].rotation is not None
    assert_same(pendulum("translation", planar=planar), made, ("tip.position", "base.rotation"),
                MODES)


def test_modes_keep_their_initial_velocities():
    model = pendulum(modes=2)
    model.bodies["beam"].mode_rates[:] = 5.0, -2.0
    kinetic = simulate(model, H, H, EXACT)["energy.kinetic"][0]
    made = drop_triplet(model, "beam", "tip").model
    body = made.bodies["beam"]
    rates = np.concatenate([*(t.rate for t in (*body.positions, *body.rotations)),
                            body.mode_rates])
    # a part of the motion is in the modes that are left out
    assert rates @ body.reduced.mass @ rates / 2 == pytest.approx(kinetic, rel=1e-2)


def test_a_node_without_any_triplet_is_gone():
    """The middle of a beam, known by its rotation alone, with the frame on the last node."""
    model = Model()
    for name, point in (("base", at(0, 0, 0)), ("end", at(100, 40, 0)),
                        ("middle", at(700 / 12, 280 / 12, 0))):
        model.node(name, point, "rotation" if name == "middle" else "full")
    fe_model = straight_beam(at(0, 0, 0), at(100, 40, 0), SECTION, 12)
    body = craig_bampton(fe_model, [(0, "full"), (7, "rotation"), (12, "full")], 8)
    model.superelement("beam", body, ["base", "middle", "end"], frame="node", frame_node=2)
    model.revolute("base", TURN @ (0, 0, 1))
    model.gravity((3.0, -9.0, 2.0))
    assert can_be_dropped(model) == [("beam", "middle", "rotation")]    # the frame is on the end
    made = drop_triplet(model, "beam", "middle").model
    assert list(made.nodes) == ["base", "end"] and list(model.nodes) == ["base", "end", "middle"]
    placed = made.bodies["beam"]
    assert placed.nodes == (made.nodes["base"], made.nodes["end"])
    assert list(placed.alpha) == [0.0, 1.0]
    by_hand = Model()
    for name in ("base", "end"):
        by_hand.node(name, model.nodes[name].point)
    by_hand.superelement("beam", craig_bampton(fe_model, [(0, "full"), (12, "full")], 8),
                         ["base", "end"], frame="node", frame_node=1)
    by_hand.revolute("base", TURN @ (0, 0, 1))
    by_hand.gravity((3.0, -9.0, 2.0))
    assert_same(by_hand, made, ("end.position",), MODES)


def test_positions_whose_stresses_stiffen_the_body_are_not_proposed():
    model = pendulum()
    model.loads = model.loads[:1]       # that on the body
    made, sentence = drop_triplet(model, "beam", "tip", "position")
    assert sentence.endswith("; stresses that it carried no longer stiffen the body")
    assert made.bodies["beam"].reduced.keeps == ("full", "rotation")
    assert can_be_dropped(model) == [("beam", "base", "rotation")]
    assert can_be_dropped(with_options(model, "beam", stiffening=False).model) == [
        ("beam", "base", "rotation"), ("beam", "tip", "position")]


def test_what_is_needed_is_said():
    def node_on_it(model):
        model.attach("hook", at(105, 40, 0), "tip")

    def neighbour(model):
        model.superelement("twin", bar(2), ["base", "tip"])

    cases = [
        (lambda m: m.torque("tip", TURN[2], name="twist"), "tip.rotation is needed by 'twist'"),
        (lambda m: m.fix("tip", "rotation"), "tip.rotation is fixed, prescribed or follows"),
        (lambda m: m.rigid_body("lump", "tip", 1.0, (1, 1, 1)), "needed by 'lump'"),
        (node_on_it, "tip.rotation is needed by"),
        (neighbour, "tip.rotation is needed by superelement 'twin'"),
        (lambda m: m.mode_force("beam", 0, 1.0, name="shaker"), "'shaker' acts on a mode of super"),
    ]
    for change, message in cases:
        model = pendulum()
        change(model)
        assert ("beam", "tip", "rotation") not in can_be_dropped(model)
        with pytest.raises(InputError, match=message):
            drop_triplet(model, "beam", "tip")
    model = pendulum()
    with pytest.raises(InputError, match="what is dropped"):
        drop_triplet(model, "beam", "tip", "both")
    with pytest.raises(InputError, match="tip.position is needed by 'force on tip.position'"):
        drop_triplet(model, "beam", "tip", "position")
    one = drop_triplet(model, "beam", "tip").model
    with pytest.raises(InputError, match="node 'tip' has no rotation"):
        drop_triplet(one, "beam", "tip")
    with pytest.raises(InputError, match="'beam' needs base.rotation: nothing in the body resists"):
        drop_triplet(one, "beam", "base")
