"""Reductions behind one interface against beam theory, textbook forms, and free vibrations."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import linalg

from sebody import Model, simulate
from sebody.basics.errors import InputError
from sebody.fem import FEModel, Section, frame, hexahedral_block, planar_beam, straight_beam
from sebody.fem.selection import nodes_on_plane
from sebody.reduction import Accuracy, MeanFace, RigidFace, craig_bampton, reduce
from sebody.reduction.summary import effective_masses, frequencies

SLENDER = Section(1.0, 1e-8, 1e-8, 1e-8, 1e8, 0.3, 1.0)     # E I = rho A = 1
STEEL = (2.1e6, 0.3, 7.8e-3)
SQUARE = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)
BEAM = planar_beam([0, 0], [2, 0], SLENDER, 60)
ENDS = [(0, "full"), (60, "full")]
FREE = np.array([4.7300407449, 7.8532046241, 10.9956078380, 14.1371654913]) ** 2
SUPPORTS = {"clamped": ([0, 1, 4], [3.51602, 22.03449, 61.69721]),
            "pinned": ([0, 1], [15.41821, 49.96486, 104.24770])}
BLOCK = hexahedral_block([1, 2, 3], [6, 2, 1.5], (4, 2, 1), *STEEL)
LEFT, RIGHT = (nodes_on_plane(BLOCK, [x, 0, 0], [1, 0, 0]) for x in (1, 7))
TIES = [(RigidFace([0.5, 3, 3.5], LEFT), "full"), (MeanFace(RIGHT), "full")]


def vibrations(body, fixed=(), above=1.0):
    """Dimensionless frequencies of a planar beam of length 2, without rigid motions.

    Of the inverse problem: coordinates may be massless.
    """
    kept = np.setdiff1d(np.arange(len(body.mass)), fixed)
    grid = np.ix_(kept, kept)
    shifted = body.stiffness[grid] + body.mass[grid]
    inverse = linalg.eigh(body.mass[grid], shifted + 1e-12 * np.diag(np.diag(shifted)),
                          eigvals_only=True)[::-1]
    found = 4 * np.sqrt(np.maximum(1 / inverse[inverse > 1e-11 * inverse[0]] - 1, 0))
    return found[found > above]


@pytest.mark.parametrize("method", ["macneal", "rubin"])
def test_free_vibrations_are_exact_and_others_converge(method):
    errors = []
    for modes in range(5):
        body = reduce(BEAM, ENDS, modes, method)
        # 60 elements are 1e-7 stiff, inverse squares have the rounding 1e-12 of the first
        assert_allclose(vibrations(body)[:modes], FREE[:modes], rtol=2e-6)
        errors.append([np.abs(vibrations(body, fixed) - value).min() / value
                       for fixed, exact in SUPPORTS.values() for value in exact])
    # the last mode kept decides: Rubin is ahead of MacNeal by an order
    assert np.max(errors[4]) < {"macneal": 1e-3, "rubin": 2e-5}[method]
    assert np.max(errors[4]) < np.max(errors[1]) / 100


def classical(method, modes, constraint_rows, tie):
    """Rubin's and MacNeal's reduction as the textbook has it, dense: a pencil and boundary values.

    Rigid motions, elastic modes and residual attachment modes of inertia-relieved forces.
    """
    K, M = (tie.T @ matrix.toarray() @ tie for matrix in (BLOCK.stiffness, BLOCK.mass))
    squares, shapes = linalg.eigh(K, M)
    forces = constraint_rows.T
    kept = shapes[:, :6 + modes]
    elastic = shapes[:, 6:]
    flexible = (elastic / squares[6:]) @ (elastic.T @ forces)
    residual = flexible - (elastic[:, :modes] / squares[6:6 + modes]) @ (
        elastic[:, :modes].T @ forces)
    basis = np.hstack([kept, residual])
    mass = basis.T @ M @ basis
    if method == "macneal":
        mass[6 + modes:] = mass[:, 6 + modes:] = 0.0
    return basis.T @ K @ basis, mass, constraint_rows @ basis


@pytest.mark.parametrize("method", ["macneal", "rubin"])
def test_the_form_is_another_but_not_the_body(method):
    """A rigid and a mean face: frequencies with parts of the boundary held are the textbook's."""
    tie, rows = tied_block()
    K, M, L = classical(method, 4, rows, tie)
    body = reduce(BLOCK, TIES, 4, method)
    assert body.modes == 10
    for held in ([], range(0, 12, 2), range(12)):
        still = linalg.null_space(L[list(held)]) if len(held) else np.eye(len(K))
        expected = linalg.eigh(still.T @ M @ still, still.T @ (K + M) @ still,
                               eigvals_only=True)[::-1]
        kept = np.setdiff1d(np.arange(22), held)
        grid = np.ix_(kept, kept)
        found = linalg.eigh(body.mass[grid], (body.stiffness + body.mass)[grid],
                            eigvals_only=True)[::-1]
        # inverse squares, the largest of which is 1; K + M spreads over 1e8
        assert_allclose(found, expected[:len(found)], atol=1e-9)
        assert np.all(expected[len(found):] < 1e-9)


def tied_block():
    """Motion of all DOFs by loose ones and the left face's reference, and the boundary values."""
    loose = [n for n in range(len(BLOCK.coordinates)) if n not in LEFT]
    tie = np.zeros((3 * len(BLOCK.coordinates), 3 * len(loose) + 6))
    for place, node in enumerate(loose):
        tie[3 * node:3 * node + 3, 3 * place:3 * place + 3] = np.eye(3)
    for node in LEFT:
        arm = BLOCK.coordinates[node] - TIES[0][0].point
        tie[3 * node:3 * node + 3, -6:] = np.hstack([np.eye(3), np.cross(np.eye(3), arm).T])
    arms = BLOCK.coordinates[list(RIGHT)] - BLOCK.coordinates[list(RIGHT)].mean(axis=0)
    rigid = np.vstack([np.hstack([np.eye(3), np.cross(np.eye(3), arm).T]) for arm in arms])
    weights = np.kron(consistent(len(RIGHT)), np.eye(3))
    fit = np.zeros((6, len(tie)))
    fit[:, (3 * np.array(RIGHT)[:, None] + np.arange(3)).ravel()] = np.linalg.solve(
        rigid.T @ weights @ rigid, rigid.T @ weights)
    fit = fit @ tie
    face = np.eye(len(tie.T))[-6:]
    return tie, np.vstack([face[:3], fit[:3], face[3:], fit[3:]])


def consistent(count):
    """Integrals of products of the bilinear functions of two equal rectangles in a row."""
    line = np.array([[2, 1, 0], [1, 4, 1], [0, 1, 2]]) / 6
    edge = np.array([[2, 1], [1, 2]]) / 6
    assert count == 6
    return np.kron(edge, line)      # y runs faster


@pytest.mark.parametrize("method", ["craig-bampton", "guyan", "macneal", "rubin"])
def test_the_form_is_that_of_every_superelement(method):
    """Rigid motions without internal modes; these leave the boundary still and are decoupled."""
    elbow = frame([[0, 0, 0], [50, 10, 0], [60, 30, 20]], [(0, 1), (1, 2)], SQUARE, 5)
    body = reduce(elbow, {0: "full", 2: "translation", 1: "rotation"},
                  0 if method == "guyan" else 3, method)
    count = len(body.mass) - body.modes
    assert body.modes == {"craig-bampton": 3, "guyan": 0, "macneal": 9, "rubin": 9}[method]
    assert_array_equal(body.stiffness[:count, count:], 0.0)
    for matrix in (body.stiffness, body.mass):
        inner = matrix[count:, count:]
        # products of dense shapes: rounding of the largest
        assert_allclose(inner, np.diag(np.diag(inner)), atol=1e-9 * np.abs(inner).max(initial=1.0))
    shapes = body.recovery.shapes.reshape(11, 6, -1)[:, :, :len(body.mass)]
    assert_allclose(shapes[0, :, count:], 0.0, atol=1e-12)
    assert_allclose(shapes[2, :3, count:], 0.0, atol=1e-12)
    assert_allclose(shapes[1, 3:, count:], 0.0, atol=1e-12)
    expected = reduce(elbow, {0: "full", 2: "translation", 1: "rotation"}, 3)
    assert_allclose(body.stiffness[:count, :count], expected.stiffness[:count, :count],
                    atol=1e-9 * np.abs(expected.stiffness).max())
    assert_allclose(body.total_mass, expected.total_mass, rtol=1e-10)
    assert_allclose(body.centre_of_mass, expected.centre_of_mass, rtol=1e-9)
    assert (body.invariants is None) == (method == "macneal")


def test_all_modes_of_the_model_are_the_model():
    """Rubin's basis with as many modes as there are: dependent shapes are left out."""
    rod = straight_beam([0, 0, 0], [3, 1, 2], SQUARE, 3)
    body = reduce(rod, {0: "full", 3: "full"}, 18, "rubin")
    assert body.modes == 12
    whole = linalg.eigh(rod.stiffness.toarray(), rod.mass.toarray(), eigvals_only=True)
    found = linalg.eigh(body.stiffness, body.mass, eigvals_only=True)
    assert_allclose(found[6:], whole[6:], rtol=1e-8)        # condition of the pencil 1e7


def test_the_runtime_takes_them_all():
    """A pendulum of a soft beam, after 0.2 s: by another method as many modes do as much."""
    section = replace(SLENDER, youngs_modulus=2e9, area=1e-2, inertia_z=1e-5, density=1e3)
    beam = planar_beam([0, 0], [1, 0], section, 20)
    tips = []
    for method, modes in (("craig-bampton", 4), ("rubin", 1)):
        body = reduce(beam, [(0, "full"), (20, "full")], modes, method)
        assert body.modes == 4
        model = Model(planar=True)
        model.node("base", (0, 0))
        model.node("tip", (1, 0))
        model.superelement("arm", body, ["base", "tip"])
        model.gravity((0, -9.81))
        model.fix("base", "position")
        tips.append(simulate(model, 1e-3, 0.2)["tip.position"][-1])
    # modes beyond the fourth deflect the pendulum by some millionths of its length
    assert_allclose(tips[0], tips[1], atol=1e-5)


def test_massless_motions_start_and_run():
    """MacNeal's bodies, whose mass is singular: a turned pendulum, and a beam that falls freely."""
    section = replace(SQUARE, area=1e-2, inertia_y=5e-6, inertia_z=1e-5, torsion=1e-5,
                      youngs_modulus=2e9, density=1e3)
    beam = straight_beam([3, -2, 1], [3.6, -2.48, 1.64], section, 12)      # of length 1
    along = np.array([0.6, -0.48, 0.64])

    def tip(method, modes, pinned):
        body = reduce(beam, [(12, "full"), (0, "full")], modes, method)
        assert (np.linalg.matrix_rank(body.mass) < len(body.mass)) == (method == "macneal")
        model = Model()
        model.node("tip", beam.coordinates[12])
        model.node("base", beam.coordinates[0])
        model.superelement("arm", body, ["tip", "base"], inertia="material")
        model.gravity(9.81 * np.cross(along, [0.48, 0.6, 0]))
        if pinned:
            model.fix("base", "position")
        return simulate(model, 1e-3, 0.1)["tip.position"][-1] - beam.coordinates[12]
    fall = 9.81 * 0.1**2 / 2 * np.cross(along, [0.48, 0.6, 0])
    expected = tip("rubin", 1, True)
    # the whole deflection is some thousandths of the length, of which modes leave ever less
    for modes, left in ((0, 1e-4), (1, 1e-5), (3, 1e-6)):
        # no force deforms it: rounding of the stiffness, beside a fall of hundredths
        assert_allclose(tip("macneal", modes, False), fall, atol=1e-11)
        assert_allclose(tip("macneal", modes, True), expected, atol=left)


def test_effective_masses():
    """A clamped beam between two ends: 8 / (k pi)^2-like parts of bending, all of what moves."""
    body = craig_bampton(BEAM, ENDS, 30)
    rigid = body.rigid_modes_about(body.centre_of_mass)
    parts = effective_masses(body.mass, rigid, 30)
    # (integral phi)^2 of clamped-clamped modes over the mass: 0.690, then 0, then 0.133
    assert_allclose(parts[[0, 2], 1], [0.6904, 0.1325], atol=1e-3)
    assert_allclose(parts[[1, 3], 1], 0.0, atol=1e-8)
    assert np.all(parts.sum(axis=0)[1:] < 1) and parts.sum(axis=0)[1] > 0.97
    first = frequencies(body.stiffness, body.mass, 30)[0]
    assert_allclose(first, FREE[0] / 4 / (2 * np.pi), rtol=1e-6)
    assert "frequency" not in craig_bampton(BEAM, ENDS, 0).summary()


def test_summaries_say_what_was_done():
    text = reduce(BLOCK, TIES, 4).summary()
    for words in ("2 boundary nodes, 12 boundary coordinates, 4 internal modes", "mass 0.1404,",
                  "centre of mass (4, 3, 3.75)", "boundary node 0 at (0.5, 3, 3.5) keeps 'full'",
                  "mode  frequency (1/time)", "craig-bampton from 78 DOFs",
                  "boundary node 0 is a rigid face of 6 nodes",
                  "boundary node 1 is the mean of 6 nodes, weights by area",
                  "exact inertia from the points of the mass",
                  "stiffening by stresses: "):
        assert words in text, (words, text)
    labelled = replace(BEAM, labels=[1 + n for n in range(61)], geometric_stiffness=None)
    text = reduce(labelled, ENDS, Accuracy(1e-2, 3.0)).summary()
    assert "boundary node 1 is FE node 61" in text and "no stiffening: the FE model has no" in text
    assert "dynamic stiffness of the interface within 0.00" in text and "frequency 3\n" in text
    bare = FEModel(BEAM.stiffness, BEAM.mass, BEAM.coordinates, BEAM.node_dofs)
    assert "exact inertia: the mass is not that of points" in reduce(bare, ENDS).summary()
    assert "residual modes carry no mass" in reduce(BEAM, ENDS, 1, "macneal").summary()
    massless = np.kron(np.diag(np.r_[1, np.full(59, 2.0), 1]), np.diag([1.0, 1.0, 0.0]))
    shell = FEModel(BEAM.stiffness, massless, BEAM.coordinates, BEAM.node_dofs)
    assert "points of the mass; nodal rotations carry none" in reduce(shell, ENDS, 2).summary()


@pytest.mark.parametrize(("options", "words"), [
    ({"method": "cms"}, "method 'cms' is unknown: use 'craig-bampton', 'guyan', 'macneal' or"),
    ({"method": "guyan", "modes": 2}, "modes is 2, but method 'guyan' has none"),
    ({"method": "guyan", "modes": Accuracy(0.1, 1)}, "method 'guyan' has none"),
    ({"method": "rubin", "modes": 181}, "modes is 181, but the body has 180 elastic modes"),
    ({"method": "rubin", "modes": -1}, "modes is -1"),
    ({"method": "rubin", "modes": 2, "select": [0]}, "select is for method 'craig-bampton'"),
    ({"method": "macneal", "modes": Accuracy(0.1, 1)},
     "chooses the number of modes of methods 'craig-bampton' and 'rubin'"),
    ({"method": "rubin", "modes": Accuracy(0.1, 1, "stiffness")}, "method 'rubin' has no estimate"),
    ({"modes": Accuracy(0.1, 1), "select": [0]}, "without select; give a number"),
    ({"modes": "all"}, "modes is 'all'"),
    ({"fe_model": 3}, "fe_model is 3: give an FEModel"),
])
def test_wrong_options_are_refused(options, words):
    with pytest.raises(InputError, match=words):
        reduce(**{"fe_model": BEAM, "boundary": ENDS, **options})


@pytest.mark.parametrize("method", ["rubin", "macneal"])
@pytest.mark.parametrize("planar", [True, False])
def test_bodies_of_less_than_a_micrometre(method, planar):
    """In metres; frequencies go with one over the length. A raw LinAlgError from 1e-6 on."""
    def squares(length):
        section = Section(4e-4 * length**2, 1.4e-8 * length**4, 3e-8 * length**4,
                          2.2e-8 * length**4, 7e10, 0.3, 2700.0)
        ends = length * np.array([[0.2, -0.3, 0.5], [0.7, 0.1, 0.8]])[:, :2 if planar else 3]
        fe_model = (planar_beam if planar else straight_beam)(*ends, section, 4)
        body = reduce(fe_model, [(0, "full"), (4, "full")], 3, method)
        return np.diag(body.stiffness)[-body.modes:] * length**2
    assert_allclose(squares(1e-6), squares(1.0), rtol=1e-8)
