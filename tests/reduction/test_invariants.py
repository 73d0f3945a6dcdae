"""Constants of exact inertia against kinetic energies integrated from the velocity field."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from sebody.basics.errors import InputError
from sebody.fem import FEModel, Section, frame, hexahedral_block, straight_beam
from sebody.reduction import RigidFace, craig_bampton
from sebody.reduction.invariants import InertiaInvariants

THICK = Section(9.0, 4.75, 6.75, 8.0, 2.1e6, 0.3, 7.8e-3)
START, END, UP = np.array([2.0, 4.0, -1.0]), np.array([14.0, 12.0, 8.0]), [0.3, -0.5, 1.0]
TURN = Rotation.from_rotvec([1.1, -0.7, 0.4]).as_matrix()
STEEL = (2.1e6, 0.3, 7.8e-3)


def beam(turn=None, elements=6, modes=4):
    turn = np.eye(3) if turn is None else turn
    model = straight_beam(turn @ START, turn @ END, THICK, elements, up=turn @ UP)
    return craig_bampton(model, [(0, "full"), (elements, "full")], modes)


def solid():
    model = hexahedral_block([1, 2, 3], [6, 2, 1.5], (4, 2, 1), *STEEL)
    x = model.coordinates[:, 0]
    ends = [RigidFace((place, 2.5, 3.5), tuple(np.flatnonzero(x == place))) for place in (1, 7)]
    return craig_bampton(model, [(end, "full") for end in ends], 4), model


def state(body, seed, size):
    """Random frame velocities, coordinates and rates; coordinates of that size."""
    random = np.random.default_rng(seed)
    n = len(body.mass)
    return *random.normal(size=(2, 3)), size * random.normal(size=n), size * random.normal(size=n)


def kinetic_energy(constants, v0, Omega, y, ydot):
    """T by the constants, about their origin."""
    i = constants
    z = np.concatenate([y, i.Q @ y @ y / 2])
    zdot = np.concatenate([ydot, i.Q @ y @ ydot])
    J = i.J0 + (i.h + i.h.transpose(1, 0, 2)) @ z + i.J2 @ z @ z
    B = i.g + np.einsum("i,kij->kj", z, i.K)
    translation = np.cross(Omega, i.c0 + i.S1 @ z) + i.S1 @ zdot
    return (i.mass * v0 @ v0 / 2 + v0 @ translation + Omega @ J @ Omega / 2 + Omega @ B @ zdot
            + zdot @ i.Mbar @ zdot / 2)


def beam_energy(body, turn, elements, v0, Omega, y, ydot):
    """T of the beam's velocity field, by five points an element and exact rotations.

    Deflections are cubic splines of the nodal values; rotation and displacement of second order
    come from the body's displacements at the nodes.
    """
    axes = turn @ np.array([(END - START) / 17.0, *section_axes()]).T
    length = 17.0
    nodal = np.linspace(0.0, length, elements + 1)
    points, weights = np.polynomial.legendre.leggauss(5)
    s = ((nodal[:-1, None] + nodal[1:, None]) / 2 + points * length / elements / 2).ravel()
    weights = np.tile(weights * length / elements / 2, elements)
    eps = 1e-6          # displacements are of second degree in y: central differences are exact
    moves = [body.displacements(y), (body.displacements(y + eps * ydot)
                                     - body.displacements(y - eps * ydot)) / (2 * eps)]
    fields = []
    for move in moves:
        u, psi = move[:, :3] @ axes, move[:, 3:] @ axes
        v = CubicHermiteSpline(nodal, u[:, 1], psi[:, 2])
        w = CubicHermiteSpline(nodal, u[:, 2], -psi[:, 1])
        fields.append((np.column_stack([np.interp(s, nodal, u[:, 0]), v(s), w(s)]),
                       np.column_stack([np.interp(s, nodal, psi[:, 0]), -w(s, 1), v(s, 1)])))
    (u, psi), (udot, psidot) = fields
    W, V = axes.T @ Omega, axes.T @ v0
    middle = np.column_stack([s - length / 2, 0 * s, 0 * s])
    velocity = V + np.cross(W, middle + u) + udot
    back = Rotation.from_rotvec(-psi)
    angle = np.linalg.norm(psi, axis=1)[:, None]
    once = np.cross(psi, psidot)
    twice = np.cross(psi, once)
    spin = back.apply(np.tile(W, (len(psi), 1))) + psidot - (
        1 - np.cos(angle)) / angle**2 * once + (angle - np.sin(angle)) / angle**3 * twice
    inertia = THICK.density * np.array([THICK.inertia_y + THICK.inertia_z, THICK.inertia_y,
                                        THICK.inertia_z])
    density = THICK.density * THICK.area
    return weights @ (density * (velocity**2).sum(axis=1) + (inertia * spin**2).sum(axis=1)) / 2


def section_axes():
    x = (END - START) / 17.0
    y = UP - (UP @ x) * x
    y /= np.linalg.norm(y)
    return y, np.cross(x, y)


@pytest.mark.parametrize("turn", [np.eye(3), TURN])
def test_kinetic_energy_of_a_beam_is_that_of_its_field(turn):
    """Turning cross-sections included: what is left is of third order in the deformation.

    Per unit of the smallest term of second order, which is that of the sections' rotation.
    """
    body = beam(turn)
    left = []
    for size in (2e-2, 1e-2):
        v0, Omega, y, ydot = state(body, 3, size)
        exact = beam_energy(body, turn, 6, v0, Omega, y, ydot)
        left.append(abs(kinetic_energy(body.invariants, v0, Omega, y, ydot) - exact))
    smallest = THICK.density * THICK.inertia_y * 17.0 * 1e-2**2     # rho I L psi^2 W^2
    assert left[1] < 0.02 * smallest
    assert left[1] < left[0] / 6                                    # third order: an eighth


def test_kinetic_energy_of_a_solid_is_that_of_its_nodes():
    """Any deformation: a mass that is the same along all axes turns exactly."""
    body, model = solid()
    v0, Omega, y, ydot = state(body, 5, 0.3)
    eps = 1e-3
    u = body.displacements(y)
    udot = (body.displacements(y + eps * ydot) - body.displacements(y - eps * ydot)) / (2 * eps)
    velocity = v0 + np.cross(Omega, model.coordinates - body.invariants.origin + u) + udot
    exact = velocity.ravel() @ (model.mass @ velocity.ravel()) / 2
    assert_allclose(kinetic_energy(body.invariants, v0, Omega, y, ydot), exact, rtol=1e-10)


@pytest.mark.parametrize("make", [beam, lambda: solid()[0]], ids=["beam", "solid"])
def test_what_follows_from_the_reduced_mass(make):
    """S1, g, J0 from the rigid modes; nodal forces of a shift that turns are those of S1."""
    body = make()
    i = body.invariants
    n = len(body.mass)
    rigid = body.rigid_modes_about(i.origin)
    momenta = rigid.T @ body.mass

    def close(found, expected):
        # sums of some hundred products of the reduction
        assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
    close(i.Mbar[:n, :n], body.mass)
    close(i.S1[:, :n], momenta[:3])
    close(i.g[:, :n], momenta[3:])
    close(i.J0, momenta[3:] @ rigid[:, 3:])
    close(i.c0 / i.mass + i.origin, body.centre_of_mass)
    for k, e in enumerate(np.eye(3)):
        close(rigid[:, :3].T @ i.K[k, :n], np.array([np.cross(e, s) @ i.S1 for s in np.eye(3)]))


def test_h_of_a_solid_follows_from_k():
    """``h_kl = K_l y_rk``: without rotary inertia nothing is of second order in rotations."""
    body, _ = solid()
    i, n = body.invariants, len(body.mass)
    rigid = body.rigid_modes_about(i.origin)[:, 3:]
    expected = np.einsum("lij,jk->kli", i.K[:, :, :n], rigid)
    assert_allclose(i.h, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_inertia_of_the_deformed_body_stays_positive():
    """The whole mass of frame and coordinates: of a velocity field, truncated for beams."""
    random = np.random.default_rng(1)
    for body in (beam(), solid()[0]):
        i, n = body.invariants, len(body.mass)
        for _ in range(10):
            y = np.zeros(n)
            y[6:] = 0.3 * random.normal(size=n - 6)
            z = np.concatenate([y, i.Q @ y @ y / 2])
            Z = np.vstack([np.eye(n), i.Q @ y])
            c = i.c0 + i.S1 @ z
            across = -np.cross(c, np.eye(3)).T
            J = i.J0 + (i.h + i.h.transpose(1, 0, 2)) @ z + i.J2 @ z @ z
            B = i.g + np.einsum("i,kij->kj", z, i.K)
            whole = np.block([[i.mass * np.eye(3), -across.T, i.S1], [-across, J, B],
                              [i.S1.T, B.T, i.Mbar]])
            turn = np.zeros((len(whole), n + 6))
            turn[:6, :6], turn[6:, 6:] = np.eye(6), Z
            # the frame moves with the boundary: velocities of y alone, 6 of them rigid
            whole = turn[:, 6:].T @ whole @ turn[:, 6:], turn[:, :6].T @ whole @ turn[:, :6]
            assert all(np.linalg.eigvalsh(part)[0] > 0 for part in whole)


def same_motion(first, second, turn):
    """Kinetic energies of one motion, in FE axes of the first and turned ones of the second."""
    v0, Omega, y, ydot = state(first, 7, 0.05)
    by = np.kron(np.eye(4), turn)
    other = [np.concatenate([by @ a[:12], a[12:]]) for a in (y, ydot)]
    shared = turn @ first.invariants.origin
    found = kinetic_energy(second.invariants.about(shared), turn @ v0, turn @ Omega, *other)
    assert_allclose(found, kinetic_energy(first.invariants, v0, Omega, y, ydot), rtol=1e-10)


def test_constants_turn_with_the_body():
    """Reduced in turned axes, and turned afterwards; load modes may change their signs."""
    first, second = beam(modes=0), beam(TURN, modes=0)
    same_motion(first, second, TURN)
    same_motion(first, first.rotated(TURN), TURN)
    whole = beam()
    same_motion(whole, whole.rotated(TURN), TURN)


def test_constants_about_another_point():
    """The same motion told of a frame elsewhere: ``v0* + Omega x shift``."""
    body = beam()
    v0, Omega, y, ydot = state(body, 2, 0.05)
    point = np.array([30.0, -7.0, 11.0])
    moved = body.invariants.about(point)
    there = v0 + np.cross(Omega, point - body.invariants.origin)
    assert_allclose(kinetic_energy(moved, there, Omega, y, ydot),
                    kinetic_energy(body.invariants, v0, Omega, y, ydot), rtol=1e-12)
    assert_allclose(moved.c0 / moved.mass + point, body.centre_of_mass, rtol=1e-12)


def test_a_plane_body_is_the_spatial_one_in_its_plane():
    """An elbow in the xy plane as spatial and planar frame: same energy, same resultants."""
    points = np.array([[1.0, 2.0], [6.0, 2.0], [6.0, 5.0]])
    section = replace(THICK, inertia_y=6.75)
    flat = craig_bampton(frame(points, [(0, 1), (1, 2)], section, 3), {0: "full", 2: "full"}, 0)
    deep = craig_bampton(frame(np.column_stack([points, np.zeros(3)]), [(0, 1), (1, 2)], section,
                               3, up=[0, 0, 1]), {0: "full", 2: "full"}, 0)
    v0, Omega, y, ydot = state(flat, 4, 0.05)
    rows = [0, 1, 3, 4, 8, 11]
    spatial = [np.zeros(12), np.zeros(12)]
    for full, part in zip(spatial, (y, ydot), strict=True):
        full[rows] = part
    v0, spin = np.append(v0[:2], 0.0), 1.3
    i = flat.invariants
    z, zdot = (np.concatenate([y, i.Q @ y @ y / 2]), np.concatenate([ydot, i.Q @ y @ ydot]))
    J = i.J0 + 2 * i.h @ z + i.J2 @ z @ z
    c, cdot = i.c0 + i.S1 @ z, i.S1 @ zdot
    planar = (i.mass * v0 @ v0 / 2 + v0[:2] @ (spin * np.array([-c[1], c[0]]) + cdot)
              + spin**2 * J[0, 0] / 2 + spin * (i.g[0] + z @ i.K[0]) @ zdot
              + zdot @ i.Mbar @ zdot / 2)
    whole = kinetic_energy(deep.invariants, v0, np.array([0, 0, spin]), *spatial)
    # the planar model leaves out what its prestresses change by less than the stated part
    assert_allclose(planar, whole, rtol=1e-5)


def test_a_body_far_from_the_origin_keeps_its_digits():
    near, far = (craig_bampton(straight_beam(START + shift, END + shift, THICK, 4, up=UP),
                               {0: "full", 4: "full"}, 2) for shift in (0.0, 1e5))
    for name in ("J0", "g", "h", "K", "J2"):
        expected = getattr(near.invariants, name)
        # coordinates of 1e5 have the rounding 1e-11, a tenth of a billionth of the beam
        assert_allclose(np.abs(getattr(far.invariants, name)), np.abs(expected), rtol=0,
                        atol=1e-8 * np.abs(expected).max())


def test_without_points_of_mass_there_are_no_constants():
    """A beam's matrices alone, and a solid whose mass differs along its axes."""
    model = straight_beam(START, END, THICK, 4, up=UP)
    bare = FEModel(model.stiffness, model.mass, model.coordinates)
    assert craig_bampton(bare, {0: "full", 4: "full"}, 2).invariants is None
    block = hexahedral_block([1, 2, 3], [6, 2, 1.5], (1, 1, 1), *STEEL)
    odd = block.mass.toarray()
    odd[::3, ::3] *= 1.5
    assert FEModel(block.stiffness, odd, block.coordinates, block.node_dofs).mass_field is None


def test_displacements_inside_are_those_of_the_fe_model():
    """Under boundary forces the reduction is exact: static displacements of every node."""
    model = straight_beam(START, END, THICK, 6, up=UP)
    body = replace(beam(), invariants=None)
    force = np.array([1.0, -2.0, 3.0, 4.0, -1.0, 2.0])
    exact = np.zeros((7, 6))
    exact[1:] = np.linalg.solve(model.stiffness.toarray()[6:, 6:],
                                np.append(np.zeros(30), force)).reshape(6, 6)
    y = np.concatenate([exact[0, :3], exact[-1, :3], exact[0, 3:], exact[-1, 3:], np.zeros(4)])
    linear = replace(body, recovery=replace(body.recovery, shapes=body.recovery.shapes[:, :16]))
    # a condition of 1e5 in both solutions
    assert_allclose(linear.displacements(y), exact, rtol=0, atol=1e-9 * np.abs(exact).max())
    by = np.concatenate([np.kron(np.eye(4), TURN) @ y[:12], y[12:]])
    turned = linear.rotated(TURN).displacements(by).reshape(7, 2, 3)
    assert_allclose(turned @ TURN, exact.reshape(7, 2, 3), rtol=0, atol=1e-9 * np.abs(exact).max())
    with pytest.raises(InputError, match="knows no displacements inside; reduce the FE model"):
        replace(linear, recovery=None).displacements(y)


def test_constants_without_a_geometric_stiffness():
    model = replace(straight_beam(START, END, THICK, 4, up=UP), geometric_stiffness=None)
    found = craig_bampton(model, {0: "full", 4: "full"}, 2).invariants
    assert isinstance(found, InertiaInvariants)
    assert (found.slaved, found.resultants) == (0, 0)
