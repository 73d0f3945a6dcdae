"""Geometric stiffness against strains of Simo and Reissner, closed forms of buckling, patches."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from scipy.special import jv

from sebody.fem import StiffnessSection, frame, hexahedral_block, planar_beam, straight_beam

BENDING = StiffnessSection(axial=1e6, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=2e-6, inertia_y=1e-6, inertia_z=1e-6)
PLATE = replace(BENDING, bending_y=1e3)     # stiff in the xz plane
START, END, UP = np.array([1.0, 2.0, -1.0]), np.array([3.0, 5.0, 5.0]), np.array([0.3, -0.5, 1.0])


class Field:
    """Displacement and rotation of an Euler-Bernoulli beam between its nodes, in its axes."""

    def __init__(self, nodal, axes, length):
        places = np.linspace(0, length, len(nodal))
        u, psi = nodal[:, :3] @ axes.T, nodal[:, 3:] @ axes.T
        self.axial = lambda s, d: (np.interp(s, places, u[:, 0]) if d == 0 else
                                   np.repeat(np.diff(u[:, 0]) / np.diff(places), 8))
        self.twist = lambda s, d: (np.interp(s, places, psi[:, 0]) if d == 0 else
                                   np.repeat(np.diff(psi[:, 0]) / np.diff(places), 8))
        self.v = CubicHermiteSpline(places, u[:, 1], psi[:, 2])
        self.w = CubicHermiteSpline(places, u[:, 2], -psi[:, 1])

    def u(self, s, d):
        return np.column_stack([self.axial(s, d), self.v(s, d), self.w(s, d)])

    def psi(self, s, d):
        return np.column_stack([self.twist(s, d), -self.w(s, d + 1), self.v(s, d + 1)])


def reissner_work(field, scale, s, force, moment):
    """``F . Gamma + M . kappa`` of a deformation, exact: Gamma = R^T (e1 + u') - e1."""
    psi, rate = scale * field.psi(s, 0), scale * field.psi(s, 1)
    angle = np.linalg.norm(psi, axis=1)[:, None]
    gamma = Rotation.from_rotvec(-psi).apply([1.0, 0, 0] + scale * field.u(s, 1)) - [1.0, 0, 0]
    once = np.cross(psi, rate)
    kappa = (rate - (1 - np.cos(angle)) / angle**2 * once
             + (angle - np.sin(angle)) / angle**3 * np.cross(psi, once))
    return (force * gamma + moment * kappa).sum(axis=1)


def test_second_derivative_of_the_work_of_a_prestress():
    """Random prestress and displacement of a turned beam, by second differences."""
    section = replace(BENDING, axial=30.0, bending_y=4.0, bending_z=7.0, torsion=5.0)
    model = straight_beam(START, END, section, 3, up=UP)
    random = np.random.default_rng(6)
    prestress, moved = random.normal(size=(2, 4, 6))
    x = (END - START) / 7.0
    y = UP - UP @ x * x
    y /= np.linalg.norm(y)
    axes = np.array([x, y, np.cross(x, y)])
    points, weights = np.polynomial.legendre.leggauss(8)
    s = (np.arange(3)[:, None] * 7 / 3 + (1 + points) * 7 / 6).ravel()
    weights = np.tile(weights * 7 / 6, 3)
    field = Field(prestress, axes, 7.0)
    bend = 4.0 * field.psi(s, 1)[:, 1], 7.0 * field.psi(s, 1)[:, 2]
    force = np.column_stack([30.0 * field.axial(s, 1), -7.0 * field.v(s, 3),
                             -4.0 * field.w(s, 3)])
    moment = np.column_stack([5.0 * field.twist(s, 1), *bend])
    other = Field(moved, axes, 7.0)
    h = 1e-3
    work = [weights @ reissner_work(other, scale, s, force, moment) for scale in (h, -h)]
    found = moved.ravel() @ (model.geometric_stiffness(prestress.ravel()) @ moved.ravel())
    # the error of second differences is h^2 of fourth derivatives
    assert_allclose(found, sum(work) / h**2, rtol=1e-4)


def held(model, section_dofs=6):
    """Matrices of the beam clamped at node 0."""
    return (m.toarray()[section_dofs:, section_dofs:] for m in (model.stiffness, model.mass))


def critical_load(model, force):
    """Lowest buckling factor of a fixed-direction load on the clamped beam, by linear prestress."""
    width = model.dofs_per_node
    K, _ = held(model, width)
    u = np.concatenate([np.zeros(width), np.linalg.solve(K, force[width:])])
    KG = model.geometric_stiffness(u).toarray()[width:, width:]
    return 1 / eigh(-KG, K, eigvals_only=True)[-1]


def at_tip(model, component):
    force = np.zeros(model.stiffness.shape[0])
    force[component - model.dofs_per_node] = 1.0 if component else -1.0
    return force


def test_euler_column():
    """pi^2 / 4 in a turned frame, in a plane and in space; errors of fourth order."""
    errors = []
    for elements in (2, 4):
        flat = planar_beam([0, 0], [1, 0], BENDING, elements)
        errors.append(critical_load(flat, at_tip(flat, 0)) - np.pi**2 / 4)
        model = straight_beam(START, START + (END - START) / 7, BENDING, elements, up=UP)
        force = np.zeros(6 * elements + 6)
        force[-6:-3] = (START - END) / 7
        # the axial strain of the planar beam changes its load by 1e-6
        assert_allclose(critical_load(model, force) - np.pi**2 / 4, errors[-1], rtol=1e-2)
    assert_allclose(errors[0] / errors[1], 16.0, rtol=0.05)
    assert abs(errors[1]) < 1e-4


@pytest.mark.parametrize(("order", "factor", "tip"), [(-1 / 4, 2.0, True), (-1 / 6, 6.0, False)])
def test_lateral_buckling(order, factor, tip):
    """Thin cantilever under a tip load and under its weight, by zeros of Bessel functions.

    ``phi'' + M^2 phi / (EI GJ) = 0`` with M of the load: 4.0126 and 12.854.
    """
    exact = factor * brentq(lambda x: jv(order, x), 1.8, 2.4)
    errors = []
    for elements in (8, 16):
        model = straight_beam([0, 0, 0], [1, 0, 0], PLATE, elements)
        weight = model.mass @ np.tile([0, 0, 1.0, 0, 0, 0], elements + 1)
        errors.append(critical_load(model, at_tip(model, 2) if tip else weight) / exact - 1)
    assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)       # second order in their length
    assert abs(4 * errors[1] - errors[0]) / 3 < 2e-4


def test_flutter_of_beck():
    """A compression that follows the tip: two frequencies meet at 20.0510."""
    model = planar_beam([0, 0], [1, 0], BENDING, 8)
    K, M = held(model, 3)
    u = np.zeros(27)
    u[3:] = np.linalg.solve(K, at_tip(model, 0)[3:])
    tangent = model.geometric_stiffness(u).toarray()[3:, 3:]
    tangent[-2, -1] += 1.0      # the load turns with the tip
    inverse = np.linalg.inv(M)

    def fluttering(load):
        squares = np.linalg.eigvals(inverse @ (K + load * tangent))
        return 1.0 if np.abs(squares.imag).max() > 1e-3 * np.abs(squares).min() else -1.0
    # rotary inertia and axial flexibility of 1e-6, elements of fourth order
    assert_allclose(brentq(fluttering, 19.0, 21.0, xtol=1e-4), 20.0510, rtol=2e-4)


def test_planar_beams_are_the_spatial_ones_in_their_plane():
    spatial = straight_beam([1, 2, 0], [4, 6, 0], BENDING, 2)
    planar = planar_beam([1, 2], [4, 6], BENDING, 2)
    u = np.random.default_rng(3).normal(size=9)
    full = np.zeros(18)
    rows = np.concatenate([spatial.dofs(node)[[0, 1, 5]] for node in range(3)])
    full[rows] = u
    expected = spatial.geometric_stiffness(full).toarray()[np.ix_(rows, rows)]
    assert_allclose(planar.geometric_stiffness(u).toarray(), expected, rtol=0,
                    atol=1e-13 * np.abs(expected).max())


def test_bricks_under_a_uniform_stress():
    """Affine fields: ``volume sigma : H^T H`` of a displacement with the gradient H."""
    E, nu = 2.0e3, 0.3
    model = hexahedral_block([1, 2, 3], [2, 3, 1.5], (3, 2, 2), E, nu, 1.0)
    random = np.random.default_rng(8)
    strained, moved = random.normal(size=(2, 3, 3))
    strain = (strained + strained.T) / 2
    sigma = E / (1 + nu) * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
    u, v = ((model.coordinates @ gradient.T).ravel() for gradient in (strained, moved))
    found = v @ (model.geometric_stiffness(u) @ v)
    assert_allclose(found, 9.0 * np.sum(sigma * (moved.T @ moved)), rtol=1e-11)


def test_bricks_buckle_as_a_column():
    """A slender solid, clamped by all nodes of its end: pi^2 EI / 4 L^2 up to the end's effect."""
    model = hexahedral_block([0, 0, 0], [20, 0.5, 1.0], (20, 1, 1), 1e3, 0.0, 1.0)
    x = model.coordinates[:, 0]
    free = np.flatnonzero(np.repeat(x > 0, 3))
    K = model.stiffness.toarray()[np.ix_(free, free)]
    force = np.zeros(len(x) * 3)
    force[3 * np.flatnonzero(x == 20)] = -0.25
    u = np.zeros(len(force))
    u[free] = np.linalg.solve(K, force[free])
    KG = model.geometric_stiffness(u).toarray()[np.ix_(free, free)]
    load = 1 / eigh(-KG, K, eigvals_only=True)[-1]
    # shear and axial flexibility: (depth / length)^2; 20 elements: 1e-3
    assert_allclose(load, np.pi**2 / 4 * 1e3 * 0.5**3 / 12 / 400, rtol=2e-3)


def test_turning_a_frame_as_a_rigid_body_leaves_its_forces():
    """Members that meet at angles, with shear: K_G of a prestress balances its turned forces.

    Displaced by ``psi x X + psi x (psi x X) / 2`` and turned by psi a body has no strain: to second
    order the forces S u of any prestress u do no work on it beyond ``psi . G psi / 2``.
    """
    section = replace(BENDING, axial=30.0, bending_y=4.0, bending_z=7.0, torsion=5.0, shear_y=9.0,
                      shear_z=20.0)
    model = frame([START, END, [4.0, 0.0, 2.0]], [(0, 1), (2, 1)], section, 2, up=UP)
    random = np.random.default_rng(9)
    u = random.normal(size=model.stiffness.shape[0])
    psi = random.normal(size=3)
    first = np.cross(psi, model.coordinates)
    second = np.cross(psi, first) / 2
    forces = (model.stiffness @ u).reshape(-1, 6)[:, :3]
    turn = np.hstack([first, np.tile(psi, (len(first), 1))]).ravel()
    work = turn @ (model.geometric_stiffness(u) @ turn) / 2
    assert_allclose(work, -np.sum(forces * second), rtol=1e-11)
