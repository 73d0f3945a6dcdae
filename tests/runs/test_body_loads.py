"""Loads on FE surfaces: reduced with the body, turning with its frame."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.analysis import equilibrium
from sebody.fem import StiffnessSection, hexahedral_block, loads, planar_beam, straight_beam
from sebody.reduction import RigidFace, craig_bampton, reduce

TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
SHIFT = np.array([3.0, -2.0, 5.0])
EXACT = generalized_alpha(1.0, tolerance=1e-12, index=2)     # without numerical damping
SIZE = np.array([4.0, 1.0, 0.5])


def plate():
    """Bricks away from the origin, their upper face and the nodes of the ends."""
    bricks = hexahedral_block([1, 2, 3], SIZE, (6, 2, 1), 1e4, 0.3, 1.0)
    x, _, z = bricks.coordinates.T
    return bricks, np.flatnonzero(z == z.max()), [np.flatnonzero(x == x.min()),
                                                  np.flatnonzero(x == x.max())]


def body(modes=2, residual_modes=True, value=1.0, extra=None):
    """Tied to a node at each end."""
    bricks, top, ends = plate()
    centres = [bricks.coordinates[nodes].mean(axis=0) for nodes in ends]
    faces = [(RigidFace(c, tuple(n)), "full") for c, n in zip(centres, ends, strict=True)]
    given = {"pressure": loads.pressure(bricks, top, value), **(extra or {})}
    return bricks, craig_bampton(bricks, faces, modes, loads=given, residual_modes=residual_modes)


def held(reduced, load):
    """Static coordinates of a body whose first boundary node is held."""
    free = np.setdiff1d(np.arange(len(load)), [0, 1, 2, 6, 7, 8])
    y = np.zeros(len(load))
    y[free] = np.linalg.solve(reduced.stiffness[np.ix_(free, free)], load[free])
    return y


def test_static_answer_is_that_of_all_dofs():
    """Exact with a residual mode, whatever the vibration modes; the tip face is tied in both."""
    bricks, top, (root, tip) = plate()
    held_rows = bricks.rows[root].ravel()
    # multipliers tie the tip's face to a rigid motion
    arms = bricks.coordinates[tip] - bricks.coordinates[tip].mean(axis=0)
    rigid = np.hstack([np.tile(np.eye(3), (len(tip), 1)),
                       np.cross(np.eye(3), arms[:, None]).transpose(0, 2, 1).reshape(-1, 3)])
    rows, size = bricks.rows[tip].ravel(), bricks.stiffness.shape[0]
    inner = np.setdiff1d(np.arange(size), [*held_rows, *rows])
    T = np.zeros((size, len(inner) + 6))
    T[inner, np.arange(len(inner))] = 1.0
    T[rows, len(inner):] = rigid
    p = loads.pressure(bricks, top)
    exact = (T @ np.linalg.solve(T.T @ bricks.stiffness @ T, T.T @ p)).reshape(-1, 3)

    def error(modes, residual_modes):
        _, reduced = body(modes, residual_modes)
        y = held(reduced, reduced.loads["pressure"])
        found = (reduced.recovery.shapes[:, :len(y)] @ y).reshape(-1, 3)    # of first order
        return np.abs(found - exact).max() / np.abs(exact).max()
    assert error(0, True) < 1e-10 and error(3, True) < 1e-10    # rounding of the factorisations
    assert error(0, False) > 1e-2 and error(3, False) > 1e-4


def test_residual_modes_are_vibration_modes_of_unit_mass():
    """Orthogonal to the others, one for each load that is not known already."""
    bricks, top, _ = plate()
    side = loads.traction(bricks, top, (0.0, 2.0, 0.0))
    twice = 2 * loads.pressure(bricks, top) + side
    _, reduced = body(3, extra={"side": side, "both": twice})
    assert reduced.modes == 3 + 2
    for matrix, diagonal in ((reduced.mass, np.ones(5)), (reduced.stiffness, None)):
        inner = matrix[12:, 12:]
        assert np.abs(inner - np.diag(diagonal if diagonal is not None else np.diag(inner))
                      ).max() < 1e-9 * np.abs(inner).max()
    assert body(3, extra={"side": side})[1].loads["side"].shape == (17,)


@pytest.mark.parametrize("value", [1.0, -2.5])
def test_resultants_are_integrals(value):
    """Force and moment about the origin, of the FE nodes and of the reduced coordinates."""
    bricks, top, _ = plate()
    force = np.array([0.0, 0.0, -value * SIZE[0] * SIZE[1]])
    moment = np.cross([3.0, 2.5, 3.5], force)           # centre of the upper face
    p = loads.pressure(bricks, top, value).reshape(-1, 3)
    assert p.sum(axis=0) == pytest.approx(force, abs=1e-12)
    assert np.cross(bricks.coordinates, p).sum(axis=0) == pytest.approx(moment, abs=1e-12)
    _, reduced = body(value=value)
    for one, turn in ((reduced, np.eye(3)), (reduced.rotated(TURN), TURN)):
        found = one.rigid_modes.T @ one.loads["pressure"]
        assert found == pytest.approx(np.r_[turn @ force, turn @ moment], abs=1e-9)


SECTION = StiffnessSection(axial=1e6, bending_y=50.0, bending_z=70.0, torsion=40.0, mass=2.0,
                           inertia_x=2e-3, inertia_y=1e-3, inertia_z=1e-3)


def clamped(frame="converged_mean", turn=TURN, shift=SHIFT, amplitude=1e-4,
            inertia="floating_field"):
    """The plate, held at one end, turned and shifted."""
    _, reduced = body()
    model = Model()
    nodes = [model.node(n, shift + turn @ x)
             for n, x in zip(("root", "tip"), reduced.coordinates, strict=True)]
    model.superelement("plate", reduced, nodes, frame, inertia, rotation=turn)
    model.fix("root")
    model.body_load("plate", "pressure", [(0.0, amplitude), (1.0, amplitude)], name="air")
    return model, reduced


@pytest.mark.parametrize("frame", ["converged_mean", "node"])
def test_a_clamped_body_bends_and_passes_the_load_on(frame):
    """Small deflections are the linear ones, and the support carries force and moment."""
    model, reduced = clamped(frame)
    found = equilibrium(model, 1)
    linear = 1e-4 * held(reduced, reduced.loads["pressure"])
    moved = (found["tip.position"][-1] - SHIFT) @ TURN - reduced.coordinates[1]
    assert np.abs(moved).max() > 1e-5
    # slopes of 1e-5: relative to deflections, as much
    assert moved == pytest.approx(linear[3:6], abs=1e-4 * np.abs(linear[3:6]).max())
    force = 1e-4 * np.array([0.0, 0.0, -4.0])
    moment = np.cross([2.0, 0.0, 0.25], force)      # about the root's node
    carried = [found[f"root.{name}"][-1] @ TURN for name in ("reaction", "reaction_moment")]
    assert carried[0] == pytest.approx(-force, abs=1e-4 * 4e-4)
    assert carried[1] == pytest.approx(-moment, abs=1e-4 * 8e-4)


def swinging(kind, q=3.0):
    """A stiff beam on a hinge, under a load by length that stays perpendicular to it."""
    planar = kind == "planar"
    d, stiff = (2 if planar else 3), replace(SECTION, bending_y=1e6, bending_z=1e6, torsion=1e6,
                                             axial=1e7)
    direction = np.eye(d)[1]
    beam = (planar_beam if planar else straight_beam)(np.zeros(d), 2.0 * np.eye(d)[0], stiff, 4)
    reduced = craig_bampton(beam, [(0, "full"), (2, "full"), (4, "full")][::1 if planar else 2], 0,
                            loads={"wind": loads.line_load(beam, direction)})
    model = Model(planar=planar)
    nodes = [model.node(f"n{k}", x) for k, x in enumerate(reduced.coordinates)]
    model.superelement("beam", reduced, nodes)
    model.revolute("n0") if planar else model.revolute("n0", (0, 0, 1))
    model.body_load("beam", "wind", [(0.0, 0.0), (0.02, q), (10.0, q)])
    return model


@pytest.mark.parametrize("kind", ["planar", "spatial"])
def test_a_load_that_turns_with_the_body(kind):
    """The torque is q L^2 / 2 at every angle: through more than two turns; work is energy."""
    result = simulate(swinging(kind), 2e-3, 3.0, EXACT)
    inertia = 2.0 * 8.0 / 3.0 + 1e-3 * 2.0
    # the ramp delays by 0.01 and leaves (0.02)^2 / 24
    t = 3.0 - 0.01
    angle = 3.0 * 4.0 / 2 / inertia * (t**2 / 2 + 0.02**2 / 24)
    x, y = result["n2.position" if kind == "planar" else "n1.position"][-1][:2]
    off = np.angle(np.exp(1j * (np.arctan2(y, x) - angle)))
    assert angle > 4.0 and abs(off) < 2e-4      # of second order in the step, and the bending
    work = result["wind on beam.work"][-1]
    assert work == pytest.approx(6.0 * angle, rel=1e-4)
    total = result["energy.kinetic"][-1] + result["energy.strain"][-1]
    assert total == pytest.approx(work, rel=1e-4)       # of second order in the step


def test_two_bodies_and_a_free_start():
    """Thrust on one of two bodies in a row: momentum of both is force times time, turned."""
    _, reduced = body(1)
    model = Model()
    a, b = reduced.coordinates
    far = b + (b - a)
    nodes = [model.node(f"n{k}", SHIFT + TURN @ x) for k, x in enumerate((a, b, far))]
    for name, ends in (("one", nodes[:2]), ("two", nodes[1:])):
        model.superelement(name, reduced, ends, rotation=TURN)
    model.body_load("two", "pressure", [(0.0, 0.0), (0.1, 1e-3), (0.2, 0.0), (1.0, 0.0)])
    model.body_load("one", "pressure", [(0.0, 0.0), (0.1, 1e-3), (0.2, 0.0), (1.0, 0.0)])
    result = simulate(model, 2e-3, 0.3, EXACT)
    expected = TURN @ (0.0, 0.0, -2 * 4.0 * 1e-4)
    assert result["momentum"][-1] == pytest.approx(expected, abs=1e-6 * 8e-4)
    works = sum(result[f"pressure on {name}.work"][-1] for name in ("one", "two"))
    energy = result["energy.kinetic"][-1] + result["energy.strain"][-1]
    assert energy == pytest.approx(works, rel=1e-3)     # of second order in the step


@pytest.mark.parametrize("change, message", [
    (lambda m: m.body_load("plate", "presure"), "no load 'presure': did you mean 'pressure'"),
    (lambda m: m.body_load("plate", "wind"), "no load 'wind': it has pressure"),
    (lambda m: m.body_load("plat", "pressure"), "'plat' is unknown: did you mean 'plate'"),
    (lambda m: m.body_load("wing", "pressure"), "'wing' is unknown: the model has plate"),
    (lambda m: m.body_load("plate", "pressure", "much"), "time function")])
def test_names_that_are_not_there(change, message):
    model, _ = clamped()
    with pytest.raises(InputError, match=message):
        change(model)


def test_a_body_without_loads():
    bricks, top, ends = plate()
    one = craig_bampton(bricks, [(int(ends[0][0]), "translation"), (int(ends[1][0]), "translation"),
                                 (int(ends[1][1]), "translation")], 0)
    model = Model()
    nodes = [model.node(f"n{k}", x, "translation") for k, x in enumerate(one.coordinates)]
    model.superelement("plate", one, nodes, "positions")
    with pytest.raises(InputError, match="was reduced without loads, give craig_bampton loads="):
        model.body_load("plate", "pressure")


@pytest.mark.parametrize("given, message", [
    ({"p": np.zeros(3)}, r"load 'p' has shape \(3,\); the FE DOFs need \(126,\)"),
    ({"p": np.full(126, np.nan)}, "load 'p'"), ({"": np.zeros(126)}, "name of a load"),
    ([np.zeros(126)], "loads .*give a dict of vectors by name")])
def test_loads_that_do_not_fit(given, message):
    bricks, _, ends = plate()
    with pytest.raises(InputError, match=message):
        craig_bampton(bricks, [(int(ends[0][0]), "translation")], 0, loads=given)


@pytest.mark.parametrize("method", ["guyan", "macneal", "rubin"])
def test_loads_of_every_reduction(method):
    """Resultants are those of the load; residual modes belong to clamped interiors."""
    bricks, top, ends = plate()
    faces = [(RigidFace(bricks.coordinates[n].mean(axis=0), tuple(n)), "full") for n in ends]
    given = {"pressure": loads.pressure(bricks, top)}
    modes = 0 if method == "guyan" else 3
    found = reduce(bricks, faces, modes, method, loads=given)
    assert (found.rigid_modes[:, :3].T @ found.loads["pressure"]
            == pytest.approx([0.0, 0.0, -4.0], abs=1e-9))
    if method != "guyan":
        with pytest.raises(InputError, match=f"residual_modes is for .*; '{method}' has residual"):
            reduce(bricks, faces, modes, method, loads=given, residual_modes=True)
