"""Stress operators against uniform strains, closed forms of beams, and Saint-Venant's torsion."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sebody import InputError
from sebody.fem import (
    FEModel,
    Section,
    circle,
    frame,
    hexahedral_block,
    i_profile,
    planar_beam,
    rectangle,
    solid_stress,
    straight_beam,
    tube,
)
from sebody.fem.isoparametric import SOLID_KINDS, element_kind
from sebody.fem.stress import elasticity, principal, von_mises

E, NU, RHO = 7.0e10, 0.33, 2700.0
GRADIENT = 1e-3 * np.array([[0.3, -0.7, 0.2], [0.5, 0.4, -0.6], [-0.1, 0.8, -0.9]])
# xx, yy, zz, 2 yz, 2 zx, 2 xy of du_i / dx_j = GRADIENT[i, j]
STRAIN = 1e-3 * np.array([0.3, 0.4, -0.9, 0.2, 0.1, -0.2])


def reference_nodes(kind):
    """Places of the nodes: where one shape function is 1."""
    from sebody.fem.isoparametric import _KINDS
    return _KINDS[kind][0]


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_uniform_strain_in_a_distorted_element(kind):
    """The affine image of an element, and one with moved corners, are strained as they must be."""
    rng = np.random.default_rng(5)
    points = reference_nodes(kind) @ rng.normal(size=(3, 3)) + [3.0, -1.0, 2.0]
    for spread in (0.0, 0.02):      # small: the element stays convex
        moved = points + spread * rng.normal(size=points.shape)
        order = rng.permutation(len(points))
        cells = [("line", [[0, 1]]), (kind, [np.argsort(order)])]
        one, = solid_stress(moved[order], cells, E, NU)
        u = (moved[order] @ GRADIENT.T)[:, :, None]
        strain = one.strain(u)[0, :, :, 0]
        assert_allclose(strain, np.broadcast_to(STRAIN, strain.shape), rtol=0, atol=1e-14)
        stress = one.at_nodes(one.stress(u))[0, :, :, 0]
        assert_allclose(stress, np.broadcast_to(elasticity(E, NU) @ STRAIN, stress.shape),
                        rtol=1e-10)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron20", "hexahedron27", "wedge15"])
def test_stresses_that_vary_linearly_are_exact_in_quadratic_elements(kind):
    """Pure bending of a straight element, at the nodes, too."""
    points = reference_nodes(kind) * [1.5, 0.7, 0.4]
    one, = solid_stress(points, [(kind, [np.arange(len(points))])], E, NU)
    x, y, z = points.T
    u = np.stack([x * y, -(x**2 + NU * (y**2 - z**2)) / 2, -NU * y * z], axis=1)[:, :, None]
    found = one.at_nodes(one.stress(u))[0, :, :, 0]
    expected = np.zeros((len(points), 6))
    expected[:, 0] = E * y
    assert_allclose(found, expected, rtol=0, atol=1e-12 * E)


def test_incompatible_modes_take_part():
    """One block element across bends as a beam: xx is E y, what its corners alone do not give."""
    model = hexahedral_block((0, -0.5, 0), (1, 1, 2), (1, 1, 1), E, NU, RHO)
    x, y, z = model.coordinates.T
    u = np.stack([x * y, -(x**2 + NU * (y**2 - (z - 1)**2)) / 2, -NU * y * (z - 1)], axis=1)
    one, = model.stress
    stress = one.stress(u[:, :, None])[0, :, :, 0]
    places = one.places()[0]
    expected = np.zeros((8, 6))
    expected[:, 0] = E * places[:, 1]
    assert_allclose(stress, expected, rtol=0, atol=1e-12 * E)
    assert_allclose(one.at_nodes(one.stress(u[:, :, None]))[0, :, 0, 0],
                    E * model.coordinates[one.nodes[0], 1], rtol=1e-10)


def test_equivalent_and_principal_stresses():
    shear = np.array([0, 0, 0, 0, 0, 3.0])
    assert_allclose(von_mises(shear), 3 * np.sqrt(3), rtol=1e-14)
    assert_allclose(principal(shear), [-3, 0, 3], atol=1e-14)
    whole = np.stack([shear, np.full(6, np.nan), [4.0, 4, 4, 0, 0, 0]])
    assert_allclose(von_mises(whole), [3 * np.sqrt(3), np.nan, 0], atol=1e-14)
    assert_allclose(principal(whole)[1:], [[np.nan] * 3, [4, 4, 4]])


def end_loaded(section, load, up=(0.3, -0.2, 1.0)):
    """Section forces of a cantilever along (1, 2, 2) / 3 of length 3 under forces at its end."""
    model = straight_beam((1, 0, -1), (2, 2, 1), section, elements=3, up=up)
    K = model.stiffness.toarray()
    u = np.zeros(24)
    u[6:] = np.linalg.solve(K[6:, 6:], np.r_[np.zeros(12), load])
    one, = model.stress
    return one, u.reshape(4, 6, 1)


def axes_of(up=(0.3, -0.2, 1.0)):
    x = np.array([1, 2, 2]) / 3
    y = np.array(up) - x * (x @ up)
    y /= np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


def test_section_forces_of_a_cantilever():
    axes, force, moment = axes_of(), np.array([5.0, -3.0, 2.0]), np.array([0.4, 0.9, -0.7])
    section = replace(rectangle(0.1, 0.2, E, NU, RHO), shear_factor=(0.8, 0.7))
    one, u = end_loaded(section, np.r_[force @ axes, moment @ axes])
    found = one.section_forces(u)[..., 0]
    for element in range(3):
        for end in range(2):
            arm = 3.0 - (element + end)
            bent = moment + np.cross([arm, 0, 0], force)
            assert_allclose(found[element, end], np.r_[force, bent], rtol=0, atol=1e-9)


def at(section, y, z):
    return next(np.array(f.stress) for f in section.fibres
                if abs(f.y - y) < 1e-12 and abs(f.z - z) < 1e-12)


def test_fibres_of_ready_sections():
    h, w = 0.3, 0.1
    section = rectangle(h, w, E, NU, RHO)
    # largest shear of torsion, on the long side, and that on the short side, for h / w = 3:
    # S.P. Timoshenko and J.N. Goodier, art. 109: T = 0.267 b^2 a tau; tables have three digits
    assert_allclose(-at(section, 0, w / 2)[1, 3] * 0.267 * w**2 * h, 1, rtol=2e-3)
    assert_allclose(at(section, h / 2, 0)[2, 3] / -at(section, 0, w / 2)[1, 3], 0.753, rtol=2e-3)
    turned = rectangle(w, h, E, NU, RHO)
    assert_allclose(at(turned, w / 2, 0)[2, 3], -at(section, 0, w / 2)[1, 3], rtol=1e-12)
    assert_allclose(at(section, h / 2, w / 2)[0], [
        1 / (h * w), 0, 0, 0, 6 / (h * w**2), -6 / (w * h**2)], rtol=1e-12)
    assert_allclose(at(section, 0, 0)[1, 1], 1.5 / (h * w), rtol=1e-12)
    R = 0.05
    solid = circle(R, E, NU, RHO)
    assert_allclose(at(solid, R, 0)[2, 3], 2 / (np.pi * R**3), rtol=1e-12)      # 16 T / pi d^3
    assert_allclose(at(solid, 0, R)[1, [1, 3]], [4 / (3 * np.pi * R**2), -2 / (np.pi * R**3)],
                    rtol=1e-12)
    thin = tube(R, 1e-4 * R, E, NU, RHO)    # shear 2 Q / A; the wall is 1e-4 of the radius
    assert_allclose(at(thin, 0, R)[1, 1] * thin.area, 2, rtol=2e-4)
    for angle in np.arange(8) * np.pi / 4:      # no shear through the surface
        y, z = R * np.cos(angle), R * np.sin(angle)
        assert_allclose(y * at(thin, y, z)[1] + z * at(thin, y, z)[2], 0, atol=1e-7)
    beam = i_profile(0.2, 0.1, 0.006, 0.009, E, NU, RHO)
    middle = at(beam, 0, 0.003)
    outer = (0.1 * 0.2**2 - 0.094 * 0.182**2) / 8       # first moment of half of it
    assert_allclose(middle[1, 1], outer / (0.006 * beam.inertia_z), rtol=1e-12)
    assert_allclose(middle[1, 3], -0.006 / beam.torsion, rtol=1e-12)


def test_stresses_in_fibres_are_those_of_the_section_forces():
    section = circle(0.05, E, NU, RHO)
    axes = axes_of()
    one, u = end_loaded(section, np.r_[np.zeros(3), (100.0, 70.0, 0.0) @ axes])
    stress = one.stress(u)[..., 0]
    assert stress.shape == (3, 2, 8, 6)
    top = stress[1, 1, 2]       # fibre at z = R
    assert_allclose(one.offsets[1, 0, 2], [0, 0.05], atol=1e-15)
    assert_allclose(top, [70 * 4 / (np.pi * 0.05**3), 0, 0, 0, 0, -200 / (np.pi * 0.05**3)],
                    rtol=1e-8, atol=1e-4)


def test_planar_beams_and_frames_of_unlike_sections():
    section = rectangle(0.1, 0.2, E, NU, RHO)
    model = planar_beam((0, 0), (0, 2), section, elements=2)
    K = model.stiffness.toarray()
    u = np.zeros(9)
    u[3:] = np.linalg.solve(K[3:, 3:], [0, 0, 0, 10.0, 0, 0])   # across, to the right
    forces = model.stress[0].section_forces(u.reshape(3, 3, 1))[..., 0]
    assert_allclose(forces[0, 0], [0, -10, 0, 0, 0, -20], atol=1e-9)
    plain = Section(1e-2, 1e-5, 1e-5, 1e-5, E, NU, RHO)
    mixed = frame([(0, 0, 0), (1, 0, 0)], [(0, 1)],
                  lambda place: plain if place < 0.5 else section, elements=4)
    assert sorted(one.fibres.shape[::2][:2] for one in mixed.stress) == [(2, 0), (2, 9)]


def test_what_is_refused():
    points, cells = reference_nodes("tetra"), [("tetra", [[0, 1, 2, 3]])]
    for call, message in (
            (lambda: solid_stress(points, [("triangle", [[0, 1, 2]])], E, NU),
             "cells have no solid elements: give cells of the kinds tetra, tetra10, hexahedron"),
            (lambda: solid_stress(points, [("tetra", [[0, 1, 2]])], E, NU),
             "cells of kind 'tetra' have 3 nodes each: give 4, in meshio's order"),
            (lambda: solid_stress(points, [("tetra", [[0, 1, 2, 4]])], E, NU),
             "cells of kind 'tetra' has the node 4: give node indices from 0 to 3"),
            (lambda: solid_stress(points * [1, 1, 0], cells, E, NU)[0].strain(np.zeros((4, 3, 1))),
             r"element 0 of kind 'tetra', with the nodes \[0, 1, 2, 3\], has no volume"),
            (lambda: solid_stress(points, cells, -1.0, NU), "youngs_modulus is -1.0: give a posi"),
            (lambda: solid_stress(points, cells, E, 0.5), "poisson_ratio is 0.5: give"),
            (lambda: FEModel(np.eye(12), np.eye(12), points, ("x", "y", "z"), stress=[1]),
             "stress is 1: give SolidStress, as solid_stress makes them"),
            (lambda: replace(circle(1.0, E, NU, RHO), fibres=[(0, 0)]),
             r"Section.fibres is \(0, 0\): give Fibre, as Section.fibre makes them")):
        with pytest.raises(InputError, match=message):
            call()
    assert element_kind("tetra") is element_kind("tetra")
