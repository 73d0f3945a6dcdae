"""Beams of coupled sections on curved and twisted axes: closed forms, integrals, equilibrium."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from sebody.basics.errors import InputError
from sebody.fem import (
    Axis,
    GeneralSection,
    Section,
    Stations,
    StiffnessSection,
    beam_along,
    circle,
    frame,
    planar_beam,
    rectangle,
    straight_beam,
)
from sebody.reduction import craig_bampton

START, END, UP = np.array([1.0, 2.0, -1.0]), np.array([3.0, 5.0, 5.0]), np.array([0.3, -0.5, 1.0])
SHEARED = StiffnessSection(axial=3e5, bending_y=40.0, bending_z=90.0, torsion=25.0, mass=0.7,
                           inertia_x=0.03, inertia_y=0.0, inertia_z=0.01, shear_y=2e3, shear_z=5e2)
RIGID_IN_SHEAR = replace(SHEARED, shear_y=None, shear_z=None)
DENSITY = 2700.0


def random_section(seed, **others):
    """Any stiffness, and the mass of a section with its centre off the axis."""
    random = np.random.default_rng(seed)
    root = 0.5 * random.normal(size=(6, 6)) + 3 * np.eye(6)
    y, z = random.uniform(-0.2, 0.2, 2)
    C = np.array([[0, -z, y], [z, 0, 0], [-y, 0, 0.0]])     # skew of (0, y, z)
    m, J = 1.5, np.diag([0.3, 0.1, 0.2])
    mass = np.block([[m * np.eye(3), -m * C], [m * C, J - m * C @ C]])
    return GeneralSection(50.0 * root @ root.T, mass, **others)


def helix(s, turns=1.5):
    """Points of a helix about an axis that is not one of the coordinates."""
    angle = 2 * np.pi * turns * s
    local = np.array([2 * np.cos(angle), 2 * np.sin(angle), 1.3 * s])
    return Rotation.from_rotvec([0.4, -0.3, 0.2]).apply(local) + [3.0, 1.0, 2.0]


def hard():
    """An axis and a section without any symmetry: curved, twisted, tapered, coupled, kinked."""
    axis = Axis(helix, twist=[[0, 0.1], [0.37, 0.9], [1, -0.4]], side=(0.1, 0.2, 1.0))
    return axis, Stations([0.0, 0.21, 1.0], [random_section(k) for k in (1, 2, 3)])


@pytest.mark.parametrize("section", [SHEARED, RIGID_IN_SHEAR], ids=["sheared", "rigid in shear"])
@pytest.mark.parametrize("elements", [1, 3])
def test_uniform_straight_beams_are_those_of_the_closed_forms(section, elements):
    """By integrals and by closed forms; as a GeneralSection, too, which has to be sheared."""
    known = straight_beam(START, END, section, elements, UP)
    models = [beam_along(Axis([START, END], up=UP), section, elements)]
    if section.shear_y:
        matrices = np.linalg.inv(section.flexibility), section.inertia
        models.append(straight_beam(START, END, GeneralSection(*matrices), elements, UP))
    u = np.random.default_rng(1).normal(size=6 * elements + 6)
    for model in models:
        pairs = [(getattr(one, name).toarray() for one in (model, known))
                 for name in ("stiffness", "mass")]
        pairs.append(one.geometric_stiffness(u).toarray() for one in (model, known))
        pairs.append(one.stress[0].section_forces(u.reshape(-1, 6, 1)) for one in (model, known))
        pairs.append(one.outlines for one in (model, known))
        for found, expected in pairs:
            assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_rigid_motions_and_mass_field():
    """K r = 0; the points of mass make the mass; momenta of rigid motions are those of a sum."""
    axis, section = hard()
    model = beam_along(axis, section, 4)
    X = model.coordinates
    rigid = np.zeros((len(X), 6, 6))
    rigid[:, :3, :3] = rigid[:, 3:, 3:] = np.eye(3)
    for k in range(3):
        rigid[:, :3, 3 + k] = np.cross(np.eye(3)[k], X)
    rigid = rigid.reshape(-1, 6)
    K, M = model.stiffness, model.mass.toarray()
    summands = abs(K) @ np.abs(rigid)
    assert np.abs(K @ rigid).max() < 1e-14 * summands.max()
    assert_allclose(model.mass_field.matrix().toarray(), M, rtol=0, atol=1e-14 * np.abs(M).max())
    # of the sections, by another rule and 4000 points
    s = (np.arange(4000) + 0.5) / 4000
    R, r = axis.axes(s), axis.position(s)
    whole = np.zeros((6, 6))
    for place, turn, point in zip(s, R, r, strict=True):
        both = np.kron(np.eye(2), turn)
        arm = np.eye(6)
        arm[:3, 3:] = np.array([np.cross(e, point) for e in np.eye(3)]).T
        own = both @ section(place).mass @ both.T
        whole += arm.T @ own @ arm * axis.length / 4000
    found = rigid.T @ M @ rigid
    assert_allclose(found, whole, rtol=0, atol=2e-6 * np.abs(whole).max())


def tip(model, load):
    """Motion (6,) of the last node of a beam held at the first one."""
    u = np.zeros(model.stiffness.shape[0])
    force = np.zeros_like(u)
    force[-6:] = load
    u[6:] = np.linalg.solve(model.stiffness.toarray()[6:, 6:], force[6:])
    return u


def test_flexibility_is_that_of_the_differential_equations():
    """Strains of a load at the tip, integrated by an initial value problem of its own."""
    axis, section = hard()
    load = np.array([1.0, -2.0, 0.5, 0.7, 0.3, -1.1])
    end = axis.position(1.0)

    def slopes(s, state):
        R = axis.axes(s)
        moment = load[3:] + np.cross(end - axis.position(s), load[:3])
        strains = np.linalg.solve(section(s).stiffness, np.r_[R.T @ load[:3], R.T @ moment])
        turn = state[3:]
        return axis.length * np.r_[R @ strains[:3] + np.cross(turn, R[:, 0]), R @ strains[3:]]
    state = np.zeros(6)
    for a, b in ((0, 0.21), (0.21, 0.37), (0.37, 1.0)):
        inside = b - 1e-12
        state = solve_ivp(slopes, (a, inside), state, method="DOP853", rtol=1e-11, atol=1e-13).y[
            :, -1]
    for elements in (1, 2, 5):      # all are exact: nothing is the mean of an element
        assert_allclose(tip(beam_along(axis, section, elements), load)[-6:], state, rtol=0,
                        atol=1e-7 * np.abs(state).max())


def test_section_forces_and_strains_are_those_of_equilibrium():
    axis, section = hard()
    model = beam_along(axis, section, np.array([0.0, 0.1, 0.5, 1.0]))
    load = np.array([1.0, -2.0, 0.5, 0.7, 0.3, -1.1])
    u = tip(model, load).reshape(-1, 6, 1)
    near = 1e-9
    places = np.array([[0.0, 0.1 - near], [0.1 + near, 0.5 - near], [0.5 + near, 1.0]])
    stress = model.stress
    order = np.argsort(np.concatenate([one.nodes[:, 0] for one in stress]))
    forces, strains = (np.concatenate([getattr(one, name)(u) for one in stress])[order][..., 0]
                       for name in ("section_forces", "section_strains"))
    for k, ends in enumerate(places):
        for end, place in enumerate(ends):
            R = axis.axes(place)
            moment = load[3:] + np.cross(axis.position(1.0) - axis.position(place), load[:3])
            exact = np.r_[R.T @ load[:3], R.T @ moment]
            assert_allclose(forces[k, end], exact, rtol=0, atol=1e-7 * np.abs(exact).max())
            assert_allclose(section(place).stiffness @ strains[k, end], exact, rtol=0,
                            atol=1e-7 * np.abs(exact).max())


def test_section_forces_at_nodes_to_rounding():
    """Where the axes have no kink the ends are taken next to the nodes by 1e-9 of an element."""
    axis = Axis([START, END], up=UP)
    model = beam_along(axis, random_section(5), 3)
    load = np.array([1.0, -2.0, 0.5, 0.7, 0.3, -1.1])
    forces = model.stress[0].section_forces(tip(model, load).reshape(-1, 6, 1))[..., 0]
    for k in range(3):
        for end in (0, 1):
            R, at = axis.axes(0.0), axis.position((k + end) / 3)
            exact = np.r_[R.T @ load[:3], R.T @ (load[3:] + np.cross(END - at, load[:3]))]
            assert_allclose(forces[k, end], exact, rtol=0, atol=1e-10 * np.abs(exact).max())


def test_turned_and_shifted_beams_are_the_same():
    axis, section = hard()
    turn = Rotation.from_rotvec([1.0, 0.4, -2.0])
    other = Axis(lambda s: turn.apply(helix(s)) + [10.0, -20.0, 5.0],
                 twist=[[0, 0.1], [0.37, 0.9], [1, -0.4]], side=turn.apply([0.1, 0.2, 1.0]))
    one, two = (beam_along(a, section, 3) for a in (axis, other))
    by = np.kron(np.eye(8), turn.as_matrix())
    u = np.random.default_rng(2).normal(size=24)
    for found, expected in ((two.stiffness, one.stiffness), (two.mass, one.mass),
                            (two.geometric_stiffness(by @ u), one.geometric_stiffness(u))):
        expected = expected.toarray()
        assert_allclose(by.T @ found.toarray() @ by, expected, rtol=0,
                        atol=1e-10 * np.abs(expected).max())


def test_a_rigid_turn_of_a_stressed_curved_beam_does_the_work_of_its_forces():
    """As of frames: K_G of a prestress balances its turned forces, here of any beam."""
    axis, section = hard()
    model = beam_along(axis, section, 3)
    random = np.random.default_rng(9)
    u, psi = random.normal(size=24), random.normal(size=3)
    first = np.cross(psi, model.coordinates)
    second = np.cross(psi, first) / 2
    forces = (model.stiffness @ u).reshape(-1, 6)[:, :3]
    turn = np.hstack([first, np.tile(psi, (len(first), 1))]).ravel()
    work = turn @ (model.geometric_stiffness(u) @ turn) / 2
    assert_allclose(work, -np.sum(forces * second), rtol=1e-10)


def test_a_bent_tube_of_a_quarter_circle():
    """Castigliano's integrals of a thin curved bar, by quadrature, loaded across its plane."""
    radius, section = 2.0, circle(0.05, 2.1e11, 0.3, 7850.0)
    axis = Axis(lambda s: [radius * np.sin(np.pi * s / 2), radius * (1 - np.cos(np.pi * s / 2)), 0])
    assert_allclose(axis.length, np.pi, rtol=1e-13)
    own = section.stiffnesses
    exact = (quad(lambda a: np.sin(a)**2 / own.bending_y, 0, np.pi / 2)[0]
             + quad(lambda a: (1 - np.cos(a))**2 / own.torsion, 0, np.pi / 2)[0]) * radius**3
    if own.shear_z:
        exact += np.pi / 2 * radius / own.shear_z
    moved = tip(beam_along(axis, section, 2), [0, 0, 1.0, 0, 0, 0])[-4]
    assert_allclose(moved, exact, rtol=1e-8)


@pytest.mark.parametrize("pitch", [0.02, 0.3])
def test_a_helical_spring(pitch):
    """Castigliano of a load on the axis of the coil; G d^4 / (8 D^3 n) where it is not steep.

    The wire bears P R cos(a) of torsion, P R sin(a) of bending, P sin(a) and P cos(a) of forces.
    """
    D, d, turns, E, nu = 0.06, 0.005, 4.25, 2.06e11, 0.3
    section = replace(circle(d / 2, E, nu, 7850.0), shear_factor=0.9)
    axis = Axis(lambda s: [D / 2 * np.cos(2 * np.pi * turns * s),
                           D / 2 * np.sin(2 * np.pi * turns * s), pitch * turns * s])
    own, a = section.stiffnesses, np.arctan2(pitch, np.pi * D)
    exact = axis.length * ((D / 2)**2 * (np.cos(a)**2 / own.torsion + np.sin(a)**2 / own.bending_y)
                           + np.sin(a)**2 / own.axial + np.cos(a)**2 / own.shear_y)
    model = beam_along(axis, section, 34)
    arm = np.array([0.0, 0.0, pitch * turns]) - axis.position(1.0)
    moved = tip(model, np.r_[0, 0, 1.0, np.cross(arm, [0, 0, 1.0])])[-6:]
    found = moved[2] + np.cross(moved[3:], arm)[2]
    assert_allclose(found, exact, rtol=1e-8)
    simple = 8 * D**3 * turns / (E / (2 + 2 * nu) * d**4)
    assert abs(found / simple - 1) < (0.01 if pitch < 0.1 else 0.9)


def test_damping_follows_the_retardation_times():
    """Equal times: mu K to rounding; others: sqrt(mu) K sqrt(mu), reduced with the body."""
    axis, section = hard()
    for mu in (0.003, np.full(6, 0.003)):
        stations = Stations(section.places, [GeneralSection(one.stiffness, one.mass, retardation=mu)
                                             for one in section.sections])
        model = beam_along(axis, stations, 3)
        K = 0.003 * model.stiffness.toarray()
        assert_allclose(model.damping.toarray(), K, rtol=0, atol=1e-14 * np.abs(K).max())
    mu = np.array([0.001, 0.0015, 0.0012, 0.0022, 0.0014, 0.0025])
    one = random_section(3, retardation=mu)
    model = straight_beam(START, END, one, 2, UP)
    root = np.diag(np.sqrt(mu))
    assert_allclose(one.damping, root @ one.stiffness @ root, rtol=1e-12, atol=1e-12)
    body = craig_bampton(model, [(0, "full"), (2, "full")], 4)
    shapes = body.recovery.shapes[:, :16]
    reduced = shapes.T @ model.damping.toarray() @ shapes
    assert_allclose(body.damping, reduced, rtol=0, atol=1e-13 * np.abs(reduced).max())
    assert body.rotated(Rotation.from_rotvec([1, 2, 3]).as_matrix()).damping is not None
    assert straight_beam(START, END, SHEARED, 2, UP).damping is None


def test_damping_ratios_are_those_of_the_sections():
    """A bar whose tension alone is damped: mu w / 2 of its axial modes, none of bending."""
    K = np.diag([4e4, 1e6, 1e6, 5e5, 20.0, 30.0])
    M = np.diag([1.0, 1, 1, 0.01, 0.005, 0.005])
    section = GeneralSection(K, M, retardation=[2e-3, 0, 0, 0, 0, 0])
    model = straight_beam([0, 0, 0], [1.0, 0, 0], section, 12)
    D = model.damping.toarray()
    axial = np.zeros(78, dtype=bool)
    axial[::6] = True
    assert_allclose(D[np.ix_(axial, axial)], 2e-3 * model.stiffness.toarray()[np.ix_(axial, axial)],
                    atol=1e-9)
    assert np.abs(D[~axial]).max() < 1e-9


def test_tapered_beams_in_a_plane_and_in_space():
    def thinner(place):
        return rectangle(0.3 - 0.2 * place, 0.05, 2.1e11, 0.3, 7800.0)
    spatial = straight_beam([1, 2, 0], [4, 6, 0], thinner, 3)
    planar = planar_beam([1, 2], [4, 6], thinner, 3)
    rows = np.concatenate([spatial.dofs(node)[[0, 1, 5]] for node in range(4)])
    u = np.random.default_rng(3).normal(size=12)
    full = np.zeros(24)
    full[rows] = u
    for found, expected in ((planar.stiffness, spatial.stiffness), (planar.mass, spatial.mass),
                            (planar.geometric_stiffness(u), spatial.geometric_stiffness(full)),
                            (planar.mass_field.matrix(), spatial.mass)):
        expected = expected.toarray()[np.ix_(rows, rows)]
        assert_allclose(found.toarray(), expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    # fibres are those of the sections at the ends
    stress = spatial.stress[0]
    last = thinner(1.0).fibres[0]
    assert_allclose(stress.offsets[2, 1, 0], [last.y, last.z], rtol=1e-8)
    assert_allclose(stress.fibres[2, 1, 0], last.stress, rtol=1e-7, atol=1e-9)


def test_pieces_of_a_beam_join_where_its_axis_has_a_corner():
    """A right angle as one axis with a kink, and as a frame of two members."""
    corner = [[0, 0, 0], [2.0, 0, 0], [2.0, 3.0, 0]]
    one = beam_along(Axis(corner, kinks=[1]), SHEARED, np.array([0.0, 0.4, 1.0]))
    two = frame(corner, [(0, 1), (1, 2)], SHEARED, 1)
    for name in ("stiffness", "mass"):
        expected = getattr(two, name).toarray()
        assert_allclose(getattr(one, name).toarray(), expected, rtol=0,
                        atol=1e-12 * np.abs(expected).max())
    across = beam_along(Axis(corner, kinks=[1]), SHEARED, 1)        # the corner within an element
    load = [0.1, 0.2, 1.0, 0.3, 0.2, 0.1]
    assert_allclose(tip(across, load)[-6:], tip(one, load)[-6:], rtol=1e-11)


def test_an_axis_by_points_function_and_spline():
    s = np.linspace(0, 1, 41)
    points = np.array([helix(one) for one in s])
    by_points, by_function = Axis(points, up=(0, 0, 1)), Axis(helix, up=(0, 0, 1))
    spline = CubicSpline(s, points)
    places = np.linspace(0, 1, 17)
    exact = np.array([helix(one) for one in places])     # its parameter is the length
    length = 2 * np.pi * 1.5 * np.hypot(2.0, 1.3 / (2 * np.pi * 1.5))
    assert_allclose(by_function.length, length, rtol=1e-13)
    assert_allclose(by_function.position(places), exact, rtol=0, atol=1e-12)
    for other, error in ((by_points, 3e-4), (Axis(spline, up=(0, 0, 1)), 3e-4)):
        assert_allclose(other.length, length, rtol=1e-4)
        assert_allclose(other.position(places), exact, rtol=0, atol=error)
    R = by_function.axes(places)
    assert_allclose(R.transpose(0, 2, 1) @ R, np.broadcast_to(np.eye(3), R.shape), atol=1e-14)
    assert_allclose(np.linalg.det(R), 1.0, rtol=1e-13)
    h = 1e-6
    slope = (by_function.position(places[1:-1] + h) - by_function.position(places[1:-1] - h)) / (
        2 * h * length)
    assert_allclose(R[1:-1, :, 0], slope, atol=1e-8)
    assert_allclose(Axis(points, twist=0.3 * s, up=(0, 0, 1)).axes(0.5)[:, 1] @ by_points.axes(
        0.5)[:, 2], np.sin(0.15), rtol=1e-12)


def test_default_axes_are_those_of_straight_beams():
    for end in ((3.0, 4.0, 1.0), (0.0, 0.0, 2.0), (0.0, -2.0, 0.0)):
        expected = straight_beam([0, 0, 0], end, SHEARED, 1)
        found = beam_along(Axis([[0, 0, 0], end]), SHEARED, 1)
        K = expected.stiffness.toarray()
        assert_allclose(found.stiffness.toarray(), K, rtol=0, atol=1e-12 * np.abs(K).max())


def test_stations_are_linear_in_twisting_axes():
    first, last = random_section(1), random_section(2)
    between = Stations([0, 1], [first, last])(0.3)
    assert_allclose(between.stiffness, 0.7 * first.stiffness + 0.3 * last.stiffness, rtol=1e-14)
    assert_allclose(between.mass, 0.7 * first.mass + 0.3 * last.mass, rtol=1e-14)
    known = Section(6.0, 4.5, 2.0, 4.7, 2.6e6, 0.3, 7.8e-3, shear_factor=(0.8, 0.5)).stiffnesses
    assert_allclose(Stations([0, 1], [known, known])(0.5).flexibility, known.flexibility)


GOOD = random_section(1)
ASYMMETRIC = np.array(GOOD.stiffness) + np.eye(6, k=1)
INDEFINITE = np.array(GOOD.stiffness) - 1.01 * np.linalg.eigvalsh(GOOD.stiffness)[0] * np.eye(6)
OFF = np.array(GOOD.mass)
OFF[0, 4] += 0.1
OFF[4, 0] += 0.1
HEAVY = np.array(GOOD.mass)
HEAVY[3:, 3:] = 0.0


@pytest.mark.parametrize(("make", "said"), [
    (lambda: GeneralSection(ASYMMETRIC, GOOD.mass, name="station 7"),
     r"station 7: stiffness is not symmetric: \[.*\] = .* but .*: give both triangles alike"),
    (lambda: GeneralSection(INDEFINITE, GOOD.mass, name="station 7"),
     r"station 7: stiffness is not positive definite: some strain of .* and .* has the energy"),
    (lambda: GeneralSection(-GOOD.stiffness, GOOD.mass), r"GeneralSection: stiffness\[\w+, \w+\] "
     "is -.*: give a positive stiffness"),
    (lambda: GeneralSection(np.eye(5), GOOD.mass), r"GeneralSection: stiffness has shape \(5, 5\)"),
    (lambda: GeneralSection(GOOD.stiffness, -GOOD.mass), r"mass\[x, x\] is -1.5: give a positive"),
    (lambda: GeneralSection(GOOD.stiffness, OFF, name="station 2"),
     r"station 2: mass\[\w+, \w+\] is .* where a mass of 1.5 with its centre at"),
    (lambda: GeneralSection(GOOD.stiffness, HEAVY), "rotary inertia about the centre of mass is "
     "negative"),
    (lambda: GeneralSection(GOOD.stiffness, GOOD.mass, retardation=[1, 2]), "retardation"),
    (lambda: GeneralSection(GOOD.stiffness, GOOD.mass, retardation=-1.0), "not negative"),
    (lambda: Stations([0, 0.5], [GOOD, GOOD]), "Stations: places .* ascending from 0 to 1"),
    (lambda: Stations([0, 1], [GOOD, RIGID_IN_SHEAR]), "give both"),
    (lambda: Axis([[0, 0, 0]]), "has 1 points: give two"),
    (lambda: Axis([[0, 0, 0], [0, 0, 0], [1, 0, 0]]), "points 0 and 1 of the curve are the same"),
    (lambda: Axis(lambda s: [abs(s - 0.4), s, 0]), "not smooth between 0 and 1 .*: name its corne"),
    (lambda: Axis(lambda s: [s, 0]), r"Axis: curve\(.*\) is .*: give 3 finite numbers"),
    (lambda: Axis(lambda s: [1 / 0, 0, 0]), "a function raised ZeroDivisionError"),
    (lambda: Axis([[0, 0, 0], [1, 0, 0]], up=(2, 0, 0)), "lies along the axis at 0 of its length"),
    (lambda: Axis([[0, 0, 0], [1, 0, 0]], up=(0, 1, 0), side=(0, 0, 1)), "leave one out"),
    (lambda: Axis([[0, 0, 0], [1, 0, 0]], twist=[[0, 0], [1, 90.0]]), "give angles in radians"),
    (lambda: Axis([[0, 0, 0], [1, 0, 0]], twist=[0, 1, 2]), "give 2 angles, one for each point"),
    (lambda: Axis([[0, 0, 0], [1, 0, 0]], kinks=[1]), "give numbers of points between the ends"),
    (lambda: Axis(lambda s: [np.sin(7 * s), np.cos(7 * s), 0], up=(1, 0, 0)),
     "up = .* lies along the axis at .*: give up=, another"),
    (lambda: beam_along(Axis([[0, 0, 0], [1, 0, 0]]), SHEARED, [0.2, 0.1]), "elements: places"),
    (lambda: planar_beam([0, 0], [1, 0], GOOD, 2), "a GeneralSection is for beams in space"),
])
def test_what_is_refused(make, said):
    with pytest.raises(InputError, match=said):
        make()
