"""FE models against closed forms: deflections, frequencies, rigid motion, patch test."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from sebody.basics.errors import InputError
from sebody.fem import FEModel, Section, frame, hexahedral_block, planar_beam, straight_beam

AREA, IY, IZ, J, E, NU, RHO, KAPPA = 6.0, 4.5, 2.0, 4.7, 2.1e6, 0.3, 7.8e-3, 0.8
G = E / (2 * (1 + NU))
STIFF = Section(AREA, IY, IZ, J, E, NU, RHO)
SHEAR = Section(AREA, IY, IZ, J, E, NU, RHO, shear_factor=KAPPA)
START, END = np.array([1.0, 2.0, -1.0]), np.array([3.0, 5.0, 5.0])  # length 7
UP = np.array([0.3, -0.5, 1.0])
EPS = np.finfo(float).eps
# Exact by construction, so what is left is rounding: of solutions EPS times the condition of their
# matrix, see `rounding`; of sums of a hundred products as rigid masses and nodal forces are, some
# hundred EPS at the most, 1e-13 of their largest terms; 1e-12 where these cancel to a tenth.


def rounding(stiffness):
    """Relative error of a solution by elimination."""
    return EPS * np.linalg.cond(stiffness)


def static_tip(model, node, load):
    """Displacement of all DOFs of `node` under `load` there, node 0 clamped; relative rounding."""
    width = model.dofs_per_node
    stiffness = model.stiffness.toarray()[width:, width:]
    force = np.zeros(width + len(stiffness))
    force[model.dofs(node)] = load
    solution = np.zeros_like(force)
    solution[width:] = np.linalg.solve(stiffness, force[width:])
    return solution[model.dofs(node)], rounding(stiffness)


def rigid_motions(model):
    """Unit translations and rotations about the origin at all DOFs, from their definition."""
    columns = []
    for turn in (False, True):
        for axis in np.eye(3):
            rows = []
            for point in model.coordinates:
                rows.append(np.cross(axis, point) if turn else axis)
                if model.dofs_per_node == 6:
                    rows.append(axis if turn else np.zeros(3))
            columns.append(np.concatenate(rows))
    return np.array(columns).T


def section_axes():
    x = (END - START) / 7.0
    y = UP - UP @ x * x
    y /= np.linalg.norm(y)
    return x, y, np.cross(x, y)


@pytest.mark.parametrize("section", [STIFF, SHEAR])
@pytest.mark.parametrize("elements", [1, 3])
def test_cantilever_tip_deflection_is_exact(section, elements):
    # P L^3 / 3 E I + P L / k G A and slope P L^2 / 2 E I, for any number of elements.
    model = straight_beam(START, END, section, elements, up=UP)
    x, y, z = section_axes()
    shear = 0.0 if section is STIFF else 7.0 / (KAPPA * G * AREA)
    for direction, inertia, slope_axis in ((y, IZ, z), (z, IY, -y)):
        tip, error = static_tip(model, elements, np.concatenate([direction, np.zeros(3)]))
        error *= np.abs(tip).max()
        assert_allclose(tip[:3], (7.0**3 / (3 * E * inertia) + shear) * direction, 0, error)
        assert_allclose(tip[3:], 7.0**2 / (2 * E * inertia) * slope_axis, 0, error)
    tip, error = static_tip(model, elements, np.concatenate([x, np.zeros(3)]))
    assert_allclose(tip[:3], 7.0 / (E * AREA) * x, 0, error * np.abs(tip).max())
    tip, error = static_tip(model, elements, np.concatenate([np.zeros(3), x]))
    assert_allclose(tip[3:], 7.0 / (G * J) * x, 0, error * np.abs(tip).max())


def test_default_section_axes_bend_with_inertia_z_in_the_xy_plane():
    spatial = straight_beam([0, 0, 0], [3, 4, 0], SHEAR, 2)
    planar = planar_beam([0, 0], [3, 4], SHEAR, 2)
    in_plane = np.concatenate([spatial.dofs(node)[[0, 1, 5]] for node in range(3)])
    for name in ("stiffness", "mass"):
        full = getattr(spatial, name).toarray()[np.ix_(in_plane, in_plane)]
        # the same products in the same order, turned by 3/5 and 4/5 alike: a few EPS
        assert_allclose(getattr(planar, name).toarray(), full, rtol=1e-15)


@pytest.mark.parametrize("section", [STIFF, SHEAR])
def test_rigid_motion_costs_no_force_and_has_the_rod_inertia(section):
    model = straight_beam(START, END, section, 4, up=UP)
    rigid = rigid_motions(model)
    force = model.stiffness @ rigid
    assert np.max(np.abs(force)) < 1e-13 * np.max(abs(model.stiffness) @ np.abs(rigid))
    x, y, z = section_axes()
    mass, centre = RHO * AREA * 7.0, (START + END) / 2
    polar, slender = RHO * 7.0 * (IY + IZ), mass * 49.0 / 12
    inertia = (
        polar * np.outer(x, x)
        + (slender + RHO * IY * 7.0) * np.outer(y, y)
        + (slender + RHO * IZ * 7.0) * np.outer(z, z)
        + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    )
    measured = rigid.T @ (model.mass @ rigid)
    assert_allclose(measured[:3, :3], mass * np.eye(3), rtol=1e-13, atol=1e-14)
    assert_allclose(measured[3:, 3:], inertia, rtol=1e-13, atol=1e-13)
    moment = [mass * np.cross(axis, centre) for axis in np.eye(3)]
    assert_allclose(measured[:3, 3:], np.array(moment).T, rtol=1e-13, atol=1e-13)


def timoshenko_errors(elements, length=14.0):
    """Relative errors of the three lowest omega^2 of a simply supported beam.

    rho^2 I/(k G) w^4 - (rho A + (rho I + rho E I/(k G)) k^2) w^2 + E I k^4 = 0, k = n pi / L.
    """
    model = planar_beam([0, 0], [length, 0], SHEAR, elements)
    free = np.setdiff1d(np.arange(3 * (elements + 1)), [0, 1, 3 * elements, 3 * elements + 1])
    grid = np.ix_(free, free)
    values = eigh(model.stiffness.toarray()[grid], model.mass.toarray()[grid], eigvals_only=True)
    k2 = (np.arange(1, 4) * np.pi / length) ** 2
    a = RHO**2 * IZ / (KAPPA * G)
    b = RHO * AREA + RHO * IZ * (1 + E / (KAPPA * G)) * k2
    exact = (b - np.sqrt(b**2 - 4 * a * E * IZ * k2**2)) / (2 * a)
    return np.min(np.abs(values[:, None] / exact - 1), axis=0)


def test_simply_supported_frequencies_converge_to_the_timoshenko_equation():
    # Below the depth of the section the interpolation is nearly linear: second order in h.
    coarse, fine = timoshenko_errors(40), timoshenko_errors(80)
    assert_allclose(coarse / fine, 4.0, rtol=0.01)
    assert np.all(np.abs(4 * fine - coarse) / 3 < 1e-6)


def test_right_angle_frame_bends_and_twists():
    # Out-of-plane tip load on two legs a (clamped) and b: both bend, a also twists by P b a/(G J).
    a, b, elements = 5.0, 3.0, 4
    model = frame([[0, 0, 0], [a, 0, 0], [a, b, 0]], [(0, 1), (1, 2)], STIFF, elements)
    assert len(model.coordinates) == 2 * elements + 1
    tip, error = static_tip(model, 2, [0, 0, 1, 0, 0, 0])
    exact = (a**3 + b**3) / (3 * E * IY) + b**2 * a / (G * J)
    assert_allclose(tip[2], exact, rtol=error)


def test_planar_frame_portal_corner():
    # Load along the outer leg b stretches it, bends leg a and turns the corner by P a^2 / 2 E I.
    a, b = 5.0, 3.0
    model = frame([[0, 0], [a, 0], [a, b]], [(0, 1), (1, 2)], STIFF, 2)
    tip, error = static_tip(model, 2, [0, 1, 0])
    assert_allclose(tip[1], a**3 / (3 * E * IZ) + b / (E * AREA), rtol=error)
    assert_allclose(tip[2], a**2 / (2 * E * IZ), rtol=error)
    assert model.node_at([a, b / 2]) == 4


def test_brick_passes_the_patch_test():
    model = hexahedral_block([1, 2, 3], [2, 3, 1.5], (3, 2, 2), E, NU, RHO)
    gradient = np.array([[1.0, 0.3, -0.2], [0.5, -0.7, 0.1], [0.4, 0.6, 0.2]])
    field = (model.coordinates @ gradient.T).ravel()
    force = (model.stiffness @ field).reshape(-1, 3)
    lower, upper = model.coordinates.min(axis=0), model.coordinates.max(axis=0)
    inner = np.all((model.coordinates > lower) & (model.coordinates < upper), axis=1)
    assert inner.any()
    assert np.max(np.abs(force[inner])) < 1e-13 * np.max(np.abs(force))
    strain = (gradient + gradient.T) / 2
    lame = E * NU / ((1 + NU) * (1 - 2 * NU))
    energy = 9.0 * (lame / 2 * np.trace(strain) ** 2 + G * np.sum(strain**2))
    assert_allclose(field @ (model.stiffness @ field) / 2, energy, rtol=1e-13)


def test_brick_rigid_motion_and_mass():
    corner, size = np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 1.5])
    model = hexahedral_block(corner, size, (2, 2, 1), E, NU, RHO)
    rigid = rigid_motions(model)
    force = model.stiffness @ rigid
    assert np.max(np.abs(force)) < 1e-13 * np.max(abs(model.stiffness) @ np.abs(rigid))
    mass, centre = RHO * np.prod(size), corner + size / 2
    measured = rigid.T @ (model.mass @ rigid)
    assert_allclose(measured[:3, :3], mass * np.eye(3), rtol=1e-13, atol=1e-14)
    inertia = mass / 12 * np.diag(np.sum(size**2) - size**2)
    inertia += mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    assert_allclose(measured[3:, 3:], inertia, rtol=1e-12)


def test_one_layer_of_bricks_bends_exactly():
    # Pure bending without Poisson effect: tip deflection M L^2 / 2 E I from incompatible modes.
    length, height, width, moment = 10.0, 1.0, 0.5, 3.0
    model = hexahedral_block([0, 0, 0], [length, height, width], (5, 1, 1), E, 0.0, RHO)
    force = np.zeros(3 * len(model.coordinates))
    clamped = []
    for node, (x, y, _) in enumerate(model.coordinates):
        if x == 0:
            clamped.extend(model.dofs(node))
        if x == length:
            force[3 * node] = moment / (2 * height) * (1 if y == 0 else -1)
    free = np.setdiff1d(np.arange(len(force)), clamped)
    stiffness = model.stiffness.toarray()[np.ix_(free, free)]
    solution = np.zeros_like(force)
    solution[free] = np.linalg.solve(stiffness, force[free])
    tip = solution[model.dofs(model.node_at([length, 0, 0]))]
    exact = moment * length**2 / (2 * E * width * height**3 / 12)
    assert_allclose(tip[1], exact, rtol=rounding(stiffness))    # a condition of 8e5: 2e-10


@pytest.mark.parametrize(
    ("build", "text"),
    [
        (lambda: Section(-1, IY, IZ, J, E, NU, RHO), r"Section\.area is -1: give a positive"),
        (lambda: Section(AREA, IY, IZ, J, E, 0.7, RHO), r"poisson_ratio is 0\.7"),
        (lambda: Section(AREA, IY, IZ, J, E, NU, RHO, 0.0), r"Section\.shear_factor is 0\.0"),
        (lambda: straight_beam(START, START, STIFF, 2), "both ends at the same point"),
        (lambda: straight_beam(START, END, STIFF, 0), "elements is 0"),
        (lambda: straight_beam(START, END, STIFF, 2, up=END - START), "lies along a beam"),
        (lambda: planar_beam(START, END, STIFF, 2), "give 2 finite coordinates"),
        (lambda: frame([START, END], [(0, 2)], STIFF, 1), r"member \(0, 2\) names an unknown"),
        (lambda: hexahedral_block(START, [1, 0, 1], (1, 1, 1), E, NU, RHO), "block size"),
        (lambda: hexahedral_block(START, END, (1, 1, 1), E, 0.5, RHO), "block poisson_ratio"),
        (lambda: FEModel(np.eye(5), np.eye(6), START[None]), r"stiffness has shape \(5, 5\)"),
        (lambda: FEModel(np.eye(6), np.eye(6), START[None, :2]), r"coordinates have shape"),
        (lambda: FEModel(np.eye(6), np.eye(6), START[None], ("x",)), "node_dofs .* unknown"),
        (lambda: straight_beam(START, END, STIFF, 2).node_at([9, 9, 9]), "no node at"),
    ],
)
def test_bad_input_is_named(build, text):
    with pytest.raises(InputError, match=text):
        build()


def test_mass_of_an_element_is_that_of_its_interpolation():
    """Kinetic energy of the deflection that equilibrium ties to the end DOFs, by integration.

    Where moment and shear force balance, a section turns by the slope and ``phi L^2 / 12`` of the
    third derivative: cubics, fitted here to unit end DOFs and integrated exactly as polynomials.
    """
    length = 3.0
    phi = 12 * E * IZ / (KAPPA * G * AREA * length**2)

    def deflection(a):
        return np.polynomial.Polynomial(a)

    def rotation(a):
        return deflection(a).deriv() + phi * length**2 / 2 * a[3]
    columns = [[f(a)(x) for x in (0.0, length) for f in (deflection, rotation)] for a in np.eye(4)]
    shapes = np.linalg.inv(np.array(columns).T).T       # rows: polynomials of the four unit DOFs

    def energy(i, j):
        product = (AREA * deflection(shapes[i]) * deflection(shapes[j])
                   + IZ * rotation(shapes[i]) * rotation(shapes[j]))
        return RHO * product.integ()(length)
    expected = np.array([[energy(i, j) for j in range(4)] for i in range(4)])
    mass = planar_beam([0, 0], [length, 0], SHEAR, 1).mass.toarray()[np.ix_([1, 2, 4, 5],
                                                                           [1, 2, 4, 5])]
    # polynomials of degree 6 with coefficients of a few hundred: some thousand EPS at the most
    assert_allclose(mass, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
