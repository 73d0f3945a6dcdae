"""Reduction against exact beam eigenvalues, closed-form rigid inertia and full FE statics."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody.basics.errors import InputError
from sebody.fem import FEModel, Section, frame, hexahedral_block, planar_beam, straight_beam
from sebody.reduction import clamped, component_modes, craig_bampton, reduce

LENGTH = 2.0
# So slender that rotary inertia and axial motion do not show: E I = rho A = 1.
SLENDER = Section(1.0, 1e-8, 1e-8, 1e-8, 1e8, 0.3, 1.0)
SQUARE = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3)
BOTH = ((0, "full"), (20, "full"))
# What is exact has the rounding of the condensation, EPS times the condition of the clamped inner
# stiffness: 2.6e4 for 20 elements, 1.4e3 for the elbow, 75 for bricks. Centres and moments of
# inertia are differences of such numbers, several times as large.
ROUNDING = 2.6e4 * np.finfo(float).eps

# omega sqrt(rho A L^4 / E I) of a uniform beam, both ends kept, n bending modes: clamped-free,
# free-free, pinned-free. The limits for many modes are the exact beta^2 L^2.
TABLE = {
    0: ((3.53273, 34.80689), (26.83282, 91.65151), (17.54438, 70.08705)),
    1: ((3.51724, 22.12648, 117.04365), (22.45384, 91.65151, 203.74), (15.52319, 65.99430, 166.01)),
    2: (
        (3.51622, 22.05853, 61.92541),
        (22.45384, 61.94352, 203.74),
        (15.42498, 50.48573, 149.86),
    ),
    3: (
        (3.51607, 22.04235, 61.79421),
        (22.38247, 61.94352, 121.42),
        (15.42231, 50.00857, 105.42),
    ),
    4: (
        (3.51603, 22.03758, 61.74106),
        (22.38247, 61.72955, 121.42),
        (15.41922, 50.00559, 104.38),
    ),
    8: (
        (3.51602, 22.03471, 61.70116),
        (22.37387, 61.67879, 120.96),
        (15.41828, 49.96740, 104.26),
    ),
}


def frequencies(body, fixed):
    """Angular frequencies of the reduced body with the coordinates `fixed` removed."""
    kept = np.setdiff1d(np.arange(len(body.mass)), fixed)
    grid = np.ix_(kept, kept)
    values = eigh(body.stiffness[grid], body.mass[grid], eigvals_only=True)
    return np.sqrt(np.abs(values))


@pytest.mark.parametrize("modes", TABLE)
def test_planar_beam_frequencies_by_mode_count(modes):
    model = planar_beam([0, 0], [LENGTH, 0], SLENDER, 60)
    body = craig_bampton(model, [(0, "full"), (60, "full")], modes)
    # Reduced order: x0 y0 x1 y1 theta0 theta1; three, no and two rows of node 0 are fixed.
    supports = ([0, 1, 4], [], [0, 1])
    rigid_count = (0, 3, 1)
    for expected, fixed, rigid in zip(TABLE[modes], supports, rigid_count, strict=True):
        found = frequencies(body, fixed)[rigid:] * LENGTH**2
        for value in expected:
            digits = len(f"{value}".split(".")[1])
            tolerance = max(0.6 * 10**-digits, 3e-6 * value)
            assert np.min(np.abs(found - value)) < tolerance, (modes, value)


def test_blocks_are_exact_and_the_mass_is_normalised():
    model = straight_beam([0, 0, 0], [100, 100, 0], SQUARE, 20)
    body = craig_bampton(model, BOTH, 6)
    assert_array_equal(body.stiffness[:12, 12:], 0.0)
    assert_array_equal(body.mass[12:, 12:], np.eye(6))
    inner = body.stiffness[12:, 12:]
    assert_array_equal(inner, np.diag(np.diag(inner)))
    basis = component_modes(
        model.stiffness, model.mass, np.r_[0:3, 120:123, 3:6, 123:126], 6
    ).basis
    for name in ("stiffness", "mass"):
        full = basis.T @ (getattr(model, name) @ basis)
        assert_allclose(getattr(body, name), full, atol=1e-9 * np.max(np.abs(full)))


def test_clamped_interface_frequencies_of_a_square_beam_come_in_principal_planes():
    # Clamped-clamped roots beta L; the beam lies in the xy plane at 45 degrees.
    model = straight_beam([0, 0, 0], [1, 1, 0], SLENDER, 40)
    dofs = np.r_[0:6, 240:246]
    component = component_modes(model.stiffness, model.mass, dofs, 4)
    roots = np.repeat([4.7300407449, 7.8532046241], 2)
    assert_allclose(component.omega_squared, roots**4 / 4.0, rtol=2e-6)
    translations = component.fixed_interface.reshape(-1, 6, 4)[:, :3]
    out_of_plane = np.linalg.norm(translations[:, 2], axis=0)
    in_plane = np.linalg.norm(translations[:, :2], axis=(0, 1))
    assert np.all(np.minimum(in_plane, out_of_plane) < 1e-8 * np.maximum(in_plane, out_of_plane))


def test_select_keeps_the_named_modes():
    model = straight_beam([0, 0, 0], [100, 100, 0], SQUARE, 20)
    full, chosen = craig_bampton(model, BOTH, 4), craig_bampton(model, BOTH, 4, select=[1, 3])
    rows = np.r_[0:12, 13, 15]
    assert chosen.modes == 2
    assert_array_equal(chosen.stiffness, full.stiffness[np.ix_(rows, rows)])
    assert_array_equal(chosen.mass, full.mass[np.ix_(rows, rows)])


def test_signs_and_repeated_calls_agree_and_large_models_match_small():
    # 1206 DOFs take the sparse solver, 126 the dense one; frequencies agree as the mesh allows.
    small = straight_beam([0, 0, 0], [100, 100, 0], SQUARE, 20)
    large = straight_beam([0, 0, 0], [100, 100, 0], SQUARE, 200)
    coarse = craig_bampton(small, BOTH, 4)
    fine = craig_bampton(large, [(0, "full"), (200, "full")], 4)
    assert_allclose(np.diag(fine.stiffness)[12:], np.diag(coarse.stiffness)[12:], rtol=1e-4)
    assert_allclose(fine.mass[:12, 12:], coarse.mass[:12, 12:], atol=1e-4 * np.max(fine.mass))
    again = craig_bampton(large, [(0, "full"), (200, "full")], 4)
    assert_array_equal(again.mass, fine.mass)


def star(disturbed=0.0):
    """Six equal arms in space: their modes come in twelves with the centre clamped."""
    points = np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
    points = points @ Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix().T
    points += disturbed * np.random.default_rng(0).normal(size=points.shape)
    section = Section(1e-2, 1e-6, 1e-6, 2e-6, 2.1e6, 0.3, 7.8e-3)
    return frame(points, [(0, k) for k in range(1, 7)], section, 4)


def test_a_cut_between_equal_frequencies_is_no_choice_of_the_solver(monkeypatch):
    dense = craig_bampton(star(), [(0, "full")], 5)
    monkeypatch.setattr(clamped, "_DENSE_LIMIT", 0)
    sparse = craig_bampton(star(), [(0, "full")], 5)
    # the largest components of a turned star's modes are equal to 1e-15 or differ by more than 1e-6
    assert_allclose(sparse.mass, dense.mass, atol=1e-8 * np.abs(dense.mass).max())


def test_a_cut_between_equal_frequencies_is_told():
    def told(body):
        return [note for note in body.notes if "frequency" in note]
    assert told(craig_bampton(star(), [(0, "full")], 5)) == [
        "the last of 5 modes has the frequency of the 7 next ones, which are left out: the body is "
        "less symmetric than its FE model, with 12 modes it is not"]
    assert "the next one, which is left out" in told(craig_bampton(star(), [(0, "full")], 11))[0]
    assert told(reduce(star(), [(1, "full")], 3, "rubin"))[0].startswith("the last of 3 modes")
    for body in (craig_bampton(star(), [(0, "full")], 12), craig_bampton(star(), [(0, "full")], 0),
                 craig_bampton(star(), [(0, "full")], 5, select=[0, 4]),
                 craig_bampton(star(disturbed=1e-3), [(0, "full")], 6)):
        assert not told(body)


@pytest.mark.parametrize("modes", [0, 5])
def test_rigid_motion_mass_and_inertia_survive_reduction(modes):
    start, end = np.array([1.0, 2.0, -1.0]), np.array([3.0, 5.0, 5.0])
    model = straight_beam(start, end, SQUARE, 20)
    body = craig_bampton(model, BOTH, modes)
    rigid = body.rigid_modes
    assert rigid.shape == (12 + modes, 6)
    force = np.abs(body.stiffness @ rigid)
    assert np.max(force) < 1e-11 * np.max(np.abs(body.stiffness)) * np.max(np.abs(rigid))
    mass, centre, axis = 7.8e-3 * 9 * 7, (start + end) / 2, (end - start) / 7
    assert_allclose(body.total_mass, mass, rtol=ROUNDING)
    assert_allclose(body.centre_of_mass, centre, rtol=1e-11)
    across = mass * 49 / 12 + 7.8e-3 * 6.75 * 7
    along = 7.8e-3 * 13.5 * 7
    inertia = across * np.eye(3) + (along - across) * np.outer(axis, axis)
    about_centre = body.rigid_modes_about(centre)
    measured = about_centre.T @ body.mass @ about_centre
    assert_allclose(measured[3:, 3:], inertia, rtol=1e-10, atol=1e-11)
    assert_allclose(measured[:3, 3:], 0.0, atol=1e-11)


def test_rotated_body_is_the_body_of_the_rotated_beam():
    angle = 0.7
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    start, end = np.array([1.0, 2.0, -1.0]), np.array([3.0, 5.0, 5.0])
    body = craig_bampton(straight_beam(start, end, SQUARE, 20), BOTH, 0).rotated(turn)
    other = craig_bampton(straight_beam(turn @ start, turn @ end, SQUARE, 20), BOTH, 0)
    for name in ("stiffness", "mass", "coordinates"):
        expected = getattr(other, name)
        assert_allclose(getattr(body, name), expected, rtol=0,
                        atol=1e-10 * np.max(np.abs(expected)))
    flat = craig_bampton(planar_beam([0, 0], [3, 1], SQUARE, 4), [(0, "full"), (4, "full")], 1)
    moved = flat.rotated(turn[:2, :2])
    assert_allclose(moved.centre_of_mass, turn[:2, :2] @ [1.5, 0.5], rtol=1e-11)
    with pytest.raises(InputError, match="rotation must be a proper rotation matrix"):
        flat.rotated(np.diag([1.0, -1.0]))


def test_mixed_layout_orders_positions_then_rotations_then_modes():
    # Elbow of a right-angle frame: node 1 keeps only its rotation, node 2 only its position.
    model = frame([[0, 0, 0], [5, 0, 0], [5, 3, 0]], [(0, 1), (1, 2)], SQUARE, 4)
    body = craig_bampton(model, {0: "full", 1: "rotation", 2: "translation"}, 2)
    assert body.position_nodes == (0, 2)
    assert body.rotation_nodes == (0, 1)
    assert body.mass.shape == (14, 14)
    mass, moments = 7.8e-3 * 9 * 8, 7.8e-3 * 9 * np.array([5 * 2.5 + 3 * 5, 3 * 1.5, 0])
    assert_allclose(body.total_mass, mass, rtol=1e-11)
    assert_allclose(body.centre_of_mass, moments / mass, rtol=1e-10, atol=1e-10)
    # Static condensation is exact: tip deflection of the frame clamped at node 0.
    free = [3, 4, 5, 9, 10, 11]
    deflection = np.linalg.inv(body.stiffness[np.ix_(free, free)])
    shear_modulus = 2.1e6 / 2.6
    exact = (125 + 27) / (3 * 2.1e6 * 6.75) + 45 / (shear_modulus * 11.387)
    assert_allclose(deflection[2, 2], exact, rtol=1e-9)


def test_solid_with_eight_corner_nodes_keeps_translations_only():
    model = hexahedral_block([1, 2, 3], [2, 3, 1.5], (2, 3, 2), 2.1e6, 0.3, 7.8e-3)
    corners = [(x, y, z) for x in (1, 3) for y in (2, 5) for z in (3, 4.5)]
    body = craig_bampton(model, [(model.node_at(c), "translation") for c in corners], 3)
    assert body.rotation_nodes == ()
    assert body.mass.shape == (27, 27)
    assert_allclose(body.coordinates, corners)
    assert_allclose(body.total_mass, 7.8e-3 * 9, rtol=1e-12)
    assert_allclose(body.centre_of_mass, [2, 3.5, 3.75], rtol=1e-11)


def test_one_boundary_node_leaves_an_exactly_free_body():
    body = craig_bampton(straight_beam([0, 0, 0], [100, 0, 0], SQUARE, 20), {10: "full"}, 3)
    assert_array_equal(body.stiffness[:6, :6], 0.0)
    assert_allclose(body.centre_of_mass, [50, 0, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("boundary", "options", "text"),
    [
        (BOTH, {"modes": 115}, "modes is 115, but the clamped body has 114 internal DOFs"),
        (BOTH, {"modes": -1}, "modes is -1"),
        (BOTH, {"modes": 2, "select": [2]}, r"select = \[2\] must name different modes"),
        ([(0, "full"), (21, "full")], {"modes": 0}, "boundary node 21 unknown"),
        ([(0, "full"), (0, "translation")], {"modes": 0}, "node 0 appears more than once"),
        ([(0, "all")], {"modes": 0}, "keeps 'all'; choose one of full, translation, rotation"),
        ([], {"modes": 0}, "boundary is empty"),
        ([(0, "translation"), (20, "translation")], {"modes": 0}, "a mechanism inside"),
        ([(0, "rotation"), (20, "rotation")], {"modes": 0}, "a mechanism inside"),
        ([(0, "translation")], {"modes": 0}, "a mechanism inside"),
    ],
)
def test_bad_input_is_named(boundary, options, text):
    model = straight_beam([0, 0, 0], [100, 80, 60], SQUARE, 20)
    with pytest.raises(InputError, match=text):
        craig_bampton(model, boundary, **options)


def test_rotations_of_a_solid_and_loose_parts_are_refused():
    solid = hexahedral_block([0, 0, 0], [1, 1, 1], (1, 1, 1), 1.0, 0.3, 1.0)
    with pytest.raises(InputError, match="the model's nodes have no rotations"):
        craig_bampton(solid, {0: "full"}, 0)
    loose = frame([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [(0, 1), (2, 3)], SQUARE, 2)
    with pytest.raises(InputError, match="2 parts that share no node and no element: one of 3 "
                       r"nodes \(node 2, node 3, node 5\); one of 3 nodes \(node 0, node 1,"):
        craig_bampton(loose, {0: "full", 1: "full"}, 0)
    named = replace(loose, labels=[10, 20, 30, 40, 50, 60])
    with pytest.raises(InputError, match=r"one of 3 nodes \(node 30, node 40, node 60\)"):
        craig_bampton(named, {0: "full", 1: "full"}, 0)


def test_what_no_stiffness_holds_is_named():
    """A rotation without stiffness, as drilling of a shell, and a beam on two ball joints."""
    beam = straight_beam([0, 0, 0], [100, 0, 0], SQUARE, 4)
    stiffness = beam.stiffness.toarray()
    stiffness[15], stiffness[:, 15] = 0.0, 0.0
    with pytest.raises(InputError, match="rx of node 2 has no stiffness"):
        craig_bampton(FEModel(stiffness, beam.mass, beam.coordinates), {0: "full", 4: "full"}, 0)
    with pytest.raises(InputError, match="the whole body can, most at rx of node"):
        craig_bampton(beam, {0: "translation", 4: "translation"}, 0)


def test_centre_of_a_planar_body_off_the_middle_of_its_nodes():
    # Legs of 5 and 3 with the boundary at the outer ends: the centre is that of two rods.
    elbow = frame([[1, 2], [6, 2], [6, 5]], [(0, 1), (1, 2)], SQUARE, 4)
    body = craig_bampton(elbow, {0: "full", 2: "full"}, 0)
    centre = (5 * np.array([3.5, 2.0]) + 3 * np.array([6.0, 3.5])) / 8
    assert_allclose(body.centre_of_mass, centre, rtol=1e-9)


def test_damping_turns_with_the_body():
    # Damping by 0.02 of the stiffness is that of the turned stiffness, too.
    flat = craig_bampton(planar_beam([0, 0], [3, 1], SQUARE, 4), [(0, "full"), (4, "full")], 0)
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    turned = flat.damped(stiffness=0.02).rotated(turn)
    scale = np.max(np.abs(turned.stiffness))
    assert np.max(np.abs(turned.stiffness - flat.stiffness)) > 0.1 * scale
    assert_allclose(turned.damping, 0.02 * turned.stiffness, rtol=0, atol=1e-9 * 0.02 * scale)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 1e4])
def test_turned_body_with_one_position_kept(unit):
    """A rotation beside one full node: to move the only position costs nothing, to the last digit.

    The other end is free to move, so a beam bends and twists uniformly: E I / L and G J / L.
    """
    section = replace(SQUARE, area=9 * unit**2, torsion=11 * unit**4, inertia_y=5 * unit**4,
                      inertia_z=6.75 * unit**4, youngs_modulus=2.1e6 / unit**2)
    stiff = 2.1e6 * unit / 100 * np.diag([11 / 2.6, 5, 6.75])
    for seed in range(4):
        turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        start = 30 * unit * seed * turn[1]
        beam = straight_beam(start, start + 100 * unit * turn[:, 0], section, 20, up=turn[:, 1])
        body = craig_bampton(beam, [(20, "rotation"), (0, "full")], 3)
        assert_array_equal(body.stiffness[:3], 0.0)
        # one of 20 elements is 20 times as stiff, and its rounding with it
        assert_allclose(body.stiffness[3:9, 3:9], between(turn @ stiff @ turn.T), rtol=0,
                        atol=20 * ROUNDING * stiff.max())
        squares, shapes = eigh(body.stiffness, body.mass)
        rates = np.diag(shapes.T @ body.damped(0.01).damping @ shapes)[6:]
        assert_allclose(rates, 0.02 * np.sqrt(squares[6:]), rtol=1e-10)   # EPS times 1e4
        # rotated, the only position keeps its zeros
        assert_array_equal(body.rotated(turn).stiffness[:, :3], 0.0)
        held = body.stiffness.copy()
        held[1, 1] += 1e-3 * stiff.max() / (100 * unit)**2
        with pytest.raises(InputError, match="stiffness resists rigid motion"):
            replace(body, stiffness=held, invariants=None)


def between(relative):
    """Stiffness of two DOF blocks of rotations that act by their difference."""
    return np.kron([[1, -1], [-1, 1]], relative)
