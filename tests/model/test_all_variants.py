"""A model with everything goes through all variants, one after the other, and stays as it is."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, generalized_alpha, harmonic, simulate
from sebody.fem import Section, hexahedral_block, straight_beam
from sebody.io import load_body, save_body
from sebody.model.variants import (
    can_be_dropped,
    copied,
    divide,
    drop_triplet,
    keep_modes,
    planar,
    rigid,
    shared,
    with_options,
)
from sebody.reduction import ReducedBody, RigidFace, craig_bampton

H, STEPS = 0.002, 40
TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
Z = TURN[:, 2]
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=5.0, torsion=9.0, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
EXACT = generalized_alpha(tolerance=1e-12)


def at(*place: float) -> np.ndarray:
    return np.array([3.0, -2.0, 1.0]) + TURN @ place


def gust(t):
    return 1.0 + 3.0 * t


def drag(t, x, v, force):
    for i in range(3):
        force[i] = -0.3 * v[i]


def everything() -> Model:
    """Two beams and a body, rigid links, springs, masses and loads of all kinds, in a plane."""
    model = Model()
    points = {"a": (0, 0), "b": (40, 0), "c": (80, 20), "d": (100, -20)}
    nodes = {name: model.node(name, at(*xy, 0)) for name, xy in points.items()}
    model.beam("first", ("a", "b"), SECTION, 8, 2, modes=4, up=TURN @ (0, 1, 0), damping=0.01)
    model.beam("second", ("b", "c"), SECTION, 8, 1, modes=4, up=Z)
    joint = model.node("joint", nodes["c"].point)
    fe_model = straight_beam(joint.point, nodes["d"].point, SECTION, 6, Z)
    wind = np.zeros(fe_model.stiffness.shape[0])
    wind[fe_model.rows[3], ] = [*(TURN @ (20.0, 50.0, 0.0)), *(300.0 * Z)]
    last = craig_bampton(fe_model, [(0, "full"), (6, "full")], 4, loads={"wind": wind})
    model.superelement("last", last, [joint, nodes["d"]])
    model.revolute("a", Z, name="hinge")
    model.revolute(nodes["c"], Z, to=joint, explicit=True, name="elbow")
    hook = model.attach("hook", at(42, 6, 0), "b")
    model.point_mass("weight", hook, 0.7)
    held = model.node("held", at(60, -30, 0))
    model.fix(held)
    model.spring(hook, held, stiffness=300.0, damping=1.0)
    model.torsion_spring(joint, stiffness=4e4, axis=-Z, to="c", rest=0.1)
    model.force("c", TURN @ (5.0, 30.0, 0.0), harmonic(1.0, 12.0))
    model.body_load("last", "wind", gust, name="gale")
    model.gravity(TURN @ (0.0, -9.0, 0.0))
    model.rigid_velocity(np.zeros(3), 0.3 * Z, about=at(0, 0, 0))
    return model


CHANGES = {
    "copied": lambda model: (copied(model), "a copy"),
    "divide": lambda model: divide(model, "first", 4),
    "keep_modes": lambda model: keep_modes(model, "second", 2),
    "with_options": lambda model: with_options(model, "last", stiffening=False),
    "drop_triplet": lambda model: drop_triplet(model, "last", "d"),
    "shared": lambda model: shared(model, "elbow"),
    "planar": planar,
    "rigid": lambda model: rigid(model, "second"),
}
SMALL = {"copied": 0.0, "divide": 2e-3, "keep_modes": 2e-3, "with_options": 2e-3,
         "drop_triplet": 5e-3, "shared": 1e-6, "planar": 1e-7, "rigid": 0.2}


def mutable(model: Model) -> set[int]:
    """Everything of a model that can change, by its id."""
    dof_blocks = model.dof_blocks()
    parts = [*model.nodes.values(), *model.grounds, *dof_blocks, *(t.rate for t in dof_blocks),
             *(t.start for t in dof_blocks), *(t.motions
                                               for t in dof_blocks), *model.bodies.values(),
             *(body.mode_rates for body in model.bodies.values()), *model.rigid_bodies.values(),
             *model.constraints, *model.loads, *model.joints, model.connections, model.beams,
             model.own_names, model.default_names, model.gravity_field, model.nodes, model.bodies,
             *(one.constants for one in (*model.constraints, *model.loads))]
    return {id(one) for one in parts}


def place(model: Model) -> np.ndarray:
    """Positions of two nodes, in space."""
    result = simulate(model, H, STEPS * H, EXACT)
    names = ("c.position", "d.position")
    return np.hstack([result[name] if model.plane is None else
                      model.plane.to_space(name, result[name]) for name in names])


def test_one_after_the_other():
    original = everything()
    model, before = original, place(original)
    moved = np.abs(before - before[0]).max()
    for name, change in CHANGES.items():
        made, sentence = change(model)
        assert isinstance(sentence, str) and sentence, name
        assert not mutable(made) & mutable(model), name
        after = place(made)
        # a poorer model differs a little, a planar or shared one by rounding and step errors
        assert np.abs(after - before).max() <= SMALL[name] * moved, name
        model, before = made, after
    assert model.planar and model.plane is not None and list(model.rigid_bodies) == [
        "weight", "second"]
    assert np.array_equal(place(original), place(everything()))


@pytest.mark.parametrize("first", CHANGES)
def test_each_on_its_own(first):
    """From the model itself, too; planar models go on to the other changes, and these to planar."""
    original = everything()
    if first != "planar":       # of a user's function no symmetry is known
        original.user_force("drag", ["c"], drag)
    made, _ = CHANGES[first](original)
    assert not mutable(made) & mutable(original)
    assert [load.name for load in made.loads if load.function is not None] == (
        [] if first == "planar" else ["drag"])
    made.loads = [load for load in made.loads if load.function is None]
    if first != "planar":
        expected = place(made)
        moved = np.abs(expected - expected[0]).max()
        assert np.abs(place(planar(made).model) - expected).max() <= SMALL["planar"] * moved
    else:
        for name in ("keep_modes", "with_options", "drop_triplet", "shared", "rigid"):
            further, _ = CHANGES[name](made)
            assert np.array_equal(further.plane.axes, made.plane.axes)
            assert place(further).shape == (STEPS + 1, 6)


def block(turn: np.ndarray, bare: bool):
    """A solid between two rigid faces, turned; `bare`: of its matrices alone, as a file may be."""
    fe_model = hexahedral_block((0, 0, 0), (60.0, 6.0, 8.0), (6, 1, 2), 2.1e6, 0.3, 7.8e-3)
    x = fe_model.coordinates[:, 0]
    faces = [(RigidFace((end, 3.0, 4.0), np.flatnonzero(np.isclose(x, end))), "full")
             for end in (0.0, 60.0)]
    body = craig_bampton(fe_model, faces, 6).rotated(turn)
    return ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, body.modes) if (
        bare) else body


@pytest.mark.parametrize("bare", [False, True])
def test_solids_and_bodies_from_files(tmp_path: Path, bare):
    body = load_body(save_body(block(TURN, bare), tmp_path / "body.npz"))
    model = Model()
    for name, point in zip("cd", body.coordinates, strict=True):
        model.node(name, point)
    model.superelement("solid", body, ["c", "d"])
    model.revolute("c", Z, name="hinge")
    model.gravity(TURN @ (0.0, -9.0, 0.0))
    before, = (place(model),)
    moved = np.abs(before - before[0]).max()
    assert can_be_dropped(model) == [("solid", "d", "rotation")]
    for made, limit in ((planar(model), 1e-7), (keep_modes(model, "solid", 4), 1e-3),
                        (with_options(model, "solid", inertia="rigid_part"), 1e-3),
                        (drop_triplet(model, "solid", "d"), 1e-3), (rigid(model, "solid"), 0.1),
                        (planar(keep_modes(drop_triplet(model, "solid", "d").model, "solid",
                                           4).model), 1e-3)):
        assert np.abs(place(made.model) - before).max() <= limit * moved, made.change
