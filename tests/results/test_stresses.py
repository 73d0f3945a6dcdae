"""Stresses inside bodies: closed forms, full FE solutions, and what the static response adds."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result
from sebody.analysis import equilibrium
from sebody.fem import StressModes, hexahedral_block, rectangle, straight_beam
from sebody.fem.loads import pressure
from sebody.reduction import RigidFace, craig_bampton

E, NU, RHO = 2.1e11, 0.3, 7800.0
HEIGHT, WIDTH, LENGTH, ELEMENTS = 0.02, 0.04, 1.5, 20
WEIGHT = RHO * HEIGHT * WIDTH * 9.81       # of the beam, a length
# small: what deformation changes of the loads is then 1e-6 of them
GRAVITY, FORCE = np.array([0.03, -0.9, 0.5]), np.array([100.0, -40.0, 70.0])
TURN = Rotation.from_rotvec((0.7, -1.1, 0.4)).as_matrix()


def beam(modes, recover=None):
    fe = straight_beam((0, 0, 0), (LENGTH, 0, 0), rectangle(HEIGHT, WIDTH, E, NU, RHO), ELEMENTS,
                       up=(0, 1, 0))
    return craig_bampton(fe, [(ELEMENTS, "full"), (0, "full")], modes, recover=recover)


def cantilever(body, inertia="material", root=(0.3, -1.0, 2.0)):
    """The beam clamped at a place and in axes that are not those of its FE model."""
    model = Model()
    a, b = model.node("a", root), model.node("b", root + TURN @ (LENGTH, 0, 0))
    model.superelement("beam", body, [b, a], inertia=inertia, rotation=TURN)
    model.fix(a)
    return model


@pytest.mark.parametrize("modes", [0, 4])
def test_a_beam_that_hangs_from_its_root(modes):
    model = cantilever(beam(modes))
    model.gravity(TURN @ (0, -9.81, 0))
    field = equilibrium(model, 2).field("beam")
    root, middle = (field.at(node).section_forces[-1] for node in (0, ELEMENTS // 2))
    # the forces of an element are those of its ends: off by the load on half of it, 1 / 40
    assert_allclose(root[0, 5], -WEIGHT * LENGTH**2 / 2, rtol=5e-4)
    assert_allclose(middle[:, 5], -WEIGHT * LENGTH**2 / 8, rtol=2e-3)
    assert_allclose(root[0, 1], -WEIGHT * LENGTH, rtol=1 / 39)
    bending = WEIGHT * LENGTH**2 / 2 * 6 / (WIDTH * HEIGHT**2)
    assert_allclose(field.at(0).von_mises[-1], bending, rtol=5e-4)
    assert_allclose(field.von_mises()[0], bending, rtol=5e-4)
    fibres = field.at(0).fibre_stress[-1, :, 0]
    assert_allclose((fibres.min(), fibres.max()), (-bending, bending), rtol=5e-4)
    assert_allclose(np.abs(field.principal()[0]).max(), bending, rtol=5e-4)
    # without the static response the modes kept miss as much as they must: Guyan's cubic
    # displacement has the moments q L^2 5 / 12 at the root and q L^2 / 6 in the middle
    plain = field.at(0, static=False).section_forces[-1, 0, 5] / (WEIGHT * LENGTH**2)
    if modes == 0:
        assert_allclose(plain, -5 / 12, rtol=1e-4)
    else:
        assert 0.001 < plain + 0.5 < 0.005


@pytest.mark.parametrize("modes", [0, 2])
def test_a_beam_that_spins(modes):
    """N = rho A W^2 (L^2 - x^2) / 2 about its root: in option C, which stiffens by this force."""
    model = cantilever(beam(modes), "c", (0, 0, 0))
    field = equilibrium(model, 2, spin=TURN @ (0, 0, 30.0)).field("beam")
    x = np.linspace(0, LENGTH, ELEMENTS + 1)
    found = field.section_forces()[:, :, 0]
    expected = RHO * HEIGHT * WIDTH * 30.0**2 * (LENGTH**2 - x**2) / 2
    # forces of elements are constant: those of their middles, to 2 / 20^2 / 12 of the whole
    assert_allclose(found.mean(axis=1), (expected[1:] + expected[:-1]) / 2, rtol=0,
                    atol=1e-3 * expected[0])
    assert_allclose(field.von_mises()[10], found[9:11].max() / (HEIGHT * WIDTH), rtol=1e-6)


def block(modes, recover=None):
    """A clamped block of 3 x 2 x 2 elements, its faces tied to nodes."""
    fe = hexahedral_block((1, 2, 3), (3.0, 1.0, 0.8), (3, 2, 2), E, NU, RHO)
    ends = [np.flatnonzero(np.abs(fe.coordinates[:, 0] - x) < 1e-9) for x in (1.0, 4.0)]
    points = [fe.coordinates[nodes].mean(axis=0) for nodes in ends]
    faces = [(RigidFace(point, tuple(nodes)), "full")
             for point, nodes in zip(points, ends, strict=True)]
    return fe, craig_bampton(fe, faces, modes, recover=recover), ends, points


def held(body, points):
    model = Model()
    a, b = (model.node(name, TURN @ point) for name, point in zip("ab", points, strict=True))
    model.superelement("block", body, [a, b], rotation=TURN)
    model.fix(a)
    model.force(b, TURN @ FORCE, [(0, 1), (1, 1)])
    model.gravity(TURN @ GRAVITY)
    return model


def full_solution(fe, ends, points, more=0.0):
    """Displacements of the whole FE model under the same loads, the end face tied."""
    free = np.setdiff1d(np.arange(len(fe.coordinates)), np.concatenate(ends))
    inner = (3 * free[:, None] + np.arange(3)).ravel()
    tied = np.zeros((fe.mass.shape[0], 6))
    for node in ends[1]:
        arm = fe.coordinates[node] - points[1]
        tied[3 * node:3 * node + 3] = np.hstack([np.eye(3), -np.cross(np.eye(3), arm)])
    T = np.hstack([np.eye(len(tied))[:, inner], tied])
    loads = fe.mass @ np.tile(GRAVITY, len(fe.coordinates)) + more
    reduced = T.T @ loads + np.r_[np.zeros(len(inner)), FORCE, 0, 0, 0]
    return T @ np.linalg.solve(T.T @ fe.stiffness @ T, reduced)


def test_a_solid_at_rest_has_the_stresses_of_its_fe_model(tmp_path):
    fe, body, ends, points = block(2)
    u = full_solution(fe, ends, points)
    result = equilibrium(held(body, points), 1)
    one, = fe.stress
    expected = one.stress(u.reshape(-1, 3, 1))[..., 0].reshape(-1, 6)
    close = {"rtol": 0, "atol": 1e-5 * np.abs(expected).max()}     # of the loads, see there
    for source in (result, Result.load(result.save(tmp_path / "r.npz"))):
        field = source.field("block")
        assert_allclose(field.stress(at="points"), expected, **close)
        assert_allclose(field.strain(at="points"),
                        one.strain(u.reshape(-1, 3, 1))[..., 0].reshape(-1, 6), rtol=0,
                        atol=1e-5 * np.abs(expected).max() / E)
        nodal, corner = field.stress(), one.at_nodes(one.stress(u.reshape(-1, 3, 1)))
        middle = 17     # eight elements meet there
        around = corner[one.nodes == middle]
        assert len(around) == 8
        assert_allclose(nodal[middle], around.mean(axis=0)[:, 0], **close)
        largest = np.abs(expected).max()        # other sums: rounding
        assert_allclose(field.at(middle).stress[-1], nodal[middle], rtol=0, atol=1e-12 * largest)
        assert_allclose(field.at(middle).principal[-1], field.principal()[middle], rtol=0,
                        atol=1e-12 * largest)
    plain = field.stress(at="points", static=False)
    assert np.abs(plain - expected).max() > 2e-3 * np.abs(expected).max()
    places = one.places().reshape(-1, 3) @ TURN.T
    origin = field.motion.origin[0] - body.coordinates.mean(axis=0) @ TURN.T
    assert_allclose(field.stress_points + field.motion.origin[0] - origin, places, rtol=0,
                    atol=1e-12)


def test_forces_of_the_field_at_the_boundary_are_the_reactions():
    """K u + M (a - g) of the recovered field on a face, against the force from the joint."""
    fe, body, ends, points = block(2)
    result = equilibrium(held(body, points), 1)
    field = result.field("block")
    stresses = field.stresses()
    u = stresses._moved(np.array([1]))[:, :, 0].ravel()
    weight = fe.mass @ np.tile(GRAVITY, len(fe.coordinates))
    nodal = (fe.stiffness @ u - weight).reshape(-1, 3)
    force = nodal[ends[0]].sum(axis=0)
    moment = np.cross(fe.coordinates[ends[0]] - points[0], nodal[ends[0]]).sum(axis=0)
    # deformation changes the moments
    assert_allclose(TURN @ force, result["block.a.force"][-1], rtol=1e-5)
    assert_allclose(TURN @ moment, result["block.a.moment"][-1], rtol=1e-5)
    inside = np.setdiff1d(np.arange(len(nodal)), np.concatenate(ends))
    assert np.abs(nodal[inside]).max() < 1e-5 * np.abs(force).max()


def test_parts_of_the_recovery_data():
    kept = np.array([0, 1, 4, 5, 12, 13, 16, 17, 30])
    _, whole, _, points = block(1)
    _, part, _, _ = block(1, recover=kept)
    fields = [equilibrium(held(body, points), 1).field("block") for body in (whole, part)]
    assert fields[1].count == 9 and len(part.recovery.cells[0][1]) == 1
    for node in (5, 30):
        assert_allclose(fields[1].at(node).velocity, fields[0].at(node).velocity, atol=1e-14)
        assert_allclose(fields[1].displacement()[np.searchsorted(kept, node)],
                        fields[0].displacement()[node], atol=1e-16)
    assert_allclose(fields[1].stress(at="points"), fields[0].stress(at="points")[:8], rtol=1e-9)
    assert np.isnan(fields[1].von_mises()[8])
    assert fields[1].envelope().node in kept
    for call, message in (
            (lambda: fields[1].at(2), "node 2 of body 'block' is not among the 9 nodes whose"),
            (lambda: fields[1].at(30).stress, "is unknown at node 30"),
            (lambda: fields[0].label(3), "the nodes of body 'block' have no labels: give their"),
            (lambda: block(0, recover=[99]), "recover: a node is 99: give nodes of the FE model"),
            (lambda: block(0, recover=[]), "recover names no node: give nodes"),
            (lambda: fields[0].section_forces(), "has no beam elements, so there are no section")):
        with pytest.raises(InputError, match=message):
            call()


def test_envelopes():
    fe, body, ends, points = block(2)
    model = held(body, points)
    field = equilibrium(model, 4).field("block")
    history = np.array([field.von_mises(step) for step in range(len(field.t))])
    found = field.envelope()
    assert_allclose(found.value, history.max(axis=0), rtol=1e-12)
    assert_allclose(found.t, field.t[history.argmax(axis=0)])
    step, node = np.unravel_index(history.argmax(), history.shape)
    assert (found.node, found.time) == (node, field.t[step])
    assert_allclose(found.largest, history.max(), rtol=1e-12)
    lowest = np.array([field.principal(step)[:, 0] for step in range(len(field.t))])
    assert_allclose(field.envelope("smallest_principal").largest, lowest.min(), rtol=1e-12)
    moved = np.linalg.norm(field.displacement(), axis=1)
    assert_allclose(field.envelope("displacement").value, moved, rtol=1e-12,
                    atol=1e-15 * np.abs(points).max())      # rounding at the reference, which rests
    with pytest.raises(InputError, match="quantity of an envelope 'mises' is unknown: use 'von_m"):
        field.envelope("mises")


def test_stress_modes_of_another_program():
    """Stresses at points by reduced coordinates, in place of elements; labels of nodes."""
    fe, body, ends, points = block(2)
    shapes, (one,) = body.recovery, fe.stress
    modes = one.stress(shapes.shapes[:, :14].reshape(-1, 3, 14)).reshape(-1, 6, 14)
    owners = np.full(len(modes), -1)
    owners[3] = 7
    given = StressModes(one.places().reshape(-1, 3), modes, owners)
    labels = 1000 + np.arange(len(fe.coordinates))
    own = replace(body, recovery=replace(shapes, stress=(given,), static=None, labels=labels))
    field, whole = (equilibrium(held(one, points), 1).field("block") for one in (own, body))
    expected = whole.stress(at="points", static=False)
    assert_allclose(field.stress(at="points"), expected, rtol=1e-9)
    assert_allclose(field.at(field.label(1007)).stress[-1], expected[3], rtol=1e-9)
    assert_allclose(field.stress()[7], expected[3], rtol=1e-9)
    assert np.isnan(field.stress()[8]).all()
    with pytest.raises(InputError, match="no node with the label 5: there are 1000 to 1035"):
        field.label(5)
    bare = replace(body, recovery=replace(shapes, stress=()))
    with pytest.raises(InputError, match="'block' has no known stresses: the body was made "
                                         "without"):
        equilibrium(held(bare, points), 1).field("block").von_mises()


def test_the_static_answer_to_loads_on_the_body(tmp_path):
    """Pressure on a side, with few modes: the stresses of the whole FE model."""
    fe, _, ends, points = block(0)
    side = np.flatnonzero(np.abs(fe.coordinates[:, 2] - 3.8) < 1e-9)
    p = pressure(fe, side, 50.0)
    faces = [(RigidFace(point, tuple(nodes)), "full")
             for point, nodes in zip(points, ends, strict=True)]
    body = craig_bampton(fe, faces, 1, loads={"other": 0.3 * p[::-1], "wind": p})
    model = held(body, points)
    model.body_load("block", "wind", [(0, 2.0), (1, 2.0)])
    result = equilibrium(model, 1)
    one, = fe.stress
    u = full_solution(fe, ends, points, 2.0 * p).reshape(-1, 3, 1)
    expected = one.stress(u)[..., 0].reshape(-1, 6)
    largest = np.abs(expected).max()
    for source in (result, Result.load(result.save(tmp_path / "r.npz"))):
        field = source.field("block")
        assert_allclose(field.stress(at="points"), expected, rtol=0, atol=1e-5 * largest)
    plain = field.stress(at="points", static=False)
    assert np.abs(plain - expected).max() > 1e-3 * largest
