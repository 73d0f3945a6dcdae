"""Sections by stiffnesses, along the beam and ready shapes, against closed forms and integrals."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.linalg import eigh

from sebody.basics.errors import InputError
from sebody.fem import (
    Section,
    StiffnessSection,
    circle,
    frame,
    i_profile,
    planar_beam,
    rectangle,
    straight_beam,
    tube,
)

STEEL = (2.1e11, 0.3, 7800.0)
START, END = np.array([1.0, 2.0, -1.0]), np.array([3.0, 5.0, 5.0])  # length 7
UP = np.array([0.3, -0.5, 1.0])
BY_STIFFNESS = StiffnessSection(axial=3e5, bending_y=40.0, bending_z=90.0, torsion=25.0, mass=0.7,
                                inertia_x=0.03, inertia_y=0.0, inertia_z=0.01,
                                shear_y=2e3, shear_z=5e2)


def tip(model, node, load):
    """Displacement of all DOFs of `node` under `load` there, node 0 clamped."""
    width = model.dofs_per_node
    force = np.zeros(model.stiffness.shape[0] - width)
    force[model.dofs(node) - width] = load
    return np.linalg.solve(model.stiffness.toarray()[width:, width:],
                           force)[model.dofs(node) - width]


def section_axes():
    x = (END - START) / 7.0
    y = UP - UP @ x * x
    y /= np.linalg.norm(y)
    return x, y, np.cross(x, y)


def test_stiffnesses_bend_shear_and_twist_a_turned_cantilever():
    """P L^3 / 3 EI + P L / shear for forces along y and z, each with its own shear stiffness."""
    model = straight_beam(START, END, BY_STIFFNESS, 3, up=UP)
    x, y, z = section_axes()
    for direction, bending, shear in ((y, 90.0, 2e3), (z, 40.0, 5e2)):
        moved = tip(model, 3, np.concatenate([direction, np.zeros(3)]))[:3]
        # solutions by elimination at a condition of 1e6
        assert_allclose(moved, (7.0**3 / (3 * bending) + 7.0 / shear) * direction, 0, 1e-9)
    assert_allclose(tip(model, 3, np.concatenate([x, 0 * x]))[:3], 7.0 / 3e5 * x, 0, 1e-14)
    assert_allclose(tip(model, 3, np.concatenate([0 * x, x]))[3:], 7.0 / 25.0 * x, 0, 1e-9)


def test_inertia_a_length_is_that_of_the_rigid_beam():
    """Rotary inertia about the three axes is free: no plane section would have these."""
    model = straight_beam(START, END, BY_STIFFNESS, 4, up=UP)
    arms, axes = model.coordinates - (START + END) / 2, np.array(section_axes())
    turning = np.hstack([np.cross(axes[:, None], arms), np.repeat(axes[:, None], 5, axis=1)])
    turning = turning.reshape(3, 2, 5, 3).transpose(0, 2, 1, 3).reshape(3, -1).T
    measured = turning.T @ (model.mass @ turning)
    slender = 0.7 * 7.0**3 / 12
    exact = np.diag([0.03 * 7, slender, slender + 0.01 * 7])
    assert_allclose(measured, exact, rtol=1e-12, atol=1e-13)    # sums of some hundred products


def test_geometry_and_material_give_the_stiffnesses():
    section = Section(6.0, 4.5, 2.0, 4.7, 2.6e6, 0.3, 7.8e-3, shear_factor=(0.8, 0.5))
    shear = 6.0e6                                       # G A = 2.6e6 / 2.6 * 6
    by_hand = StiffnessSection(2.6e6 * 6, 2.6e6 * 4.5, 2.6e6 * 2.0, 1e6 * 4.7, 7.8e-3 * 6,
                               7.8e-3 * 6.5, 7.8e-3 * 4.5, 7.8e-3 * 2.0, 0.8 * shear, 0.5 * shear)
    models = [straight_beam(START, END, s, 2, UP) for s in (section, by_hand)]
    for name in ("stiffness", "mass"):
        first, second = (getattr(m, name).toarray() for m in models)
        assert_allclose(first, second, rtol=0, atol=1e-14 * np.abs(first).max())


def tapered(place):
    """A plate whose height falls to a third."""
    return replace(rectangle(0.3 - 0.2 * place, 0.05, *STEEL), shear_factor=(5 / 6, 0.4))


@pytest.mark.parametrize(("direction", "axis"), [(1, "inertia_z"), (2, "inertia_y")])
def test_tapered_cantilever_against_the_integral(direction, axis):
    """Tip deflection: integral of x^2 / EI + 1 / kGA, in two elements and in eight."""
    length, load = 2.0, np.eye(6)[direction]

    def flexibility(x):
        section = tapered(1 - x / length)
        shear = section.shear_factor[direction - 1] * section.shear_modulus * section.area
        return x**2 / (section.youngs_modulus * getattr(section, axis)) + 1 / shear
    exact = quad(flexibility, 0.0, length)[0]
    # Gauss's five points are exact to the ninth degree, so to the tenth power of the length
    for elements, error in ((2, 3e-6), (8, 1e-10)):
        model = straight_beam([0, 0, 0], [length, 0, 0], tapered, elements)
        assert_allclose(tip(model, elements, load)[direction], exact, rtol=error)


def test_a_beam_of_two_pieces_is_exact_when_elements_end_where_they_meet():
    thick, thin = rectangle(0.3, 0.1, *STEEL), rectangle(0.1, 0.1, *STEEL)
    thick, thin = (replace(s, shear_factor=None) for s in (thick, thin))
    model = planar_beam([0, 0], [3.0, 0], lambda place: thick if place < 1 / 3 else thin, 3)
    flexible = [1 / (2.1e11 * s.inertia_z) for s in (thick, thin)]
    exact = (flexible[0] * (3.0**3 - 2.0**3) + flexible[1] * 2.0**3) / 3
    assert_allclose(tip(model, 3, [0, 1, 0])[1], exact, rtol=1e-11)     # a condition of 1e4


def test_members_of_a_frame_taper_each():
    one = straight_beam([0, 0, 0], [2, 0, 0], tapered, 4)
    two = frame([[0, 0, 0], [2, 0, 0], [2, 2, 0]], [(0, 1), (2, 1)], tapered, 4)
    measured = [np.ones(m.coordinates.shape[0]) @ m.mass[::6][:, ::6] @ np.ones(
        m.coordinates.shape[0]) for m in (one, two)]
    assert_allclose(measured[1], 2 * measured[0], rtol=1e-12)   # sums of a hundred terms


@pytest.mark.parametrize(("height", "width"), [(2.0, 2.0), (3.0, 1.0), (0.4, 5.0)])
def test_torsion_constant_of_a_rectangle_against_the_double_series(height, width):
    """Navier's solution of Saint-Venant's torsion, 256 a b / pi^6 sum 1 / (m^2 n^2 (..))."""
    odd = np.arange(1, 1200, 2.0)
    m, n = odd[:, None], odd[None, :]
    terms = 1 / (m**2 * n**2 * ((m / height)**2 + (n / width)**2))
    exact = 256 * height * width / np.pi**6 * terms.sum()
    # terms left out fall with the cube of their number: 1e-8 at an aspect of 12
    assert_allclose(rectangle(height, width, *STEEL).torsion, exact, rtol=1e-7)


def moments(shapes):
    """Area and second moments (I_y, I_z) of rectangles (y, z, height along y, width along z)."""
    y, z, h, w = np.array(shapes).T
    area = h * w
    return area.sum(), (area * (z**2 + w**2 / 12)).sum(), (area * (y**2 + h**2 / 12)).sum()


def test_i_profile_is_made_of_three_rectangles():
    section = i_profile(0.2, 0.1, 0.006, 0.01, *STEEL)
    parts = [(0.0, 0.0, 0.18, 0.006), (0.095, 0.0, 0.01, 0.1), (-0.095, 0.0, 0.01, 0.1)]
    assert_allclose((section.area, section.inertia_y, section.inertia_z), moments(parts), 1e-13)
    assert_allclose(section.torsion, (0.19 * 0.006**3 + 2 * 0.1 * 0.01**3) / 3, rtol=1e-13)


def test_shear_factor_of_the_i_is_that_of_the_shear_flow_without_poisson_effect():
    """Energy of the shear flow V S / I in web and flanges; Cowper's factor at nu = 0."""
    section = i_profile(0.21, 0.1, 0.006, 0.01, 2.1e11, 0.0, 7800.0)
    h, b, web, flange = 0.2, 0.1, 0.006, 0.01
    second, area = web * h**3 / 12 + b * flange * h**2 / 2, web * h + 2 * b * flange
    in_web = quad(lambda y: (b * flange * h / 2 + web / 2 * (h**2 / 4 - y**2))**2 / web,
                  -h / 2, h / 2)[0]
    in_flanges = 4 * quad(lambda s: (flange * h / 2 * s)**2 / flange, 0, b / 2)[0]
    assert_allclose(section.shear_factor[0], second**2 / (area * (in_web + in_flanges)), rtol=1e-12)


def test_circle_and_tube_by_integration():
    inner, outer = 0.03, 0.05
    section, solid = tube(outer, outer - inner, *STEEL), circle(outer, *STEEL)
    for shape, first in ((section, inner), (solid, 0.0)):
        assert_allclose(shape.area, quad(lambda r: 2 * np.pi * r, first, outer)[0], rtol=1e-12)
        polar = quad(lambda r: 2 * np.pi * r**3, first, outer)[0]
        assert_allclose((shape.inertia_y, shape.inertia_z, shape.torsion),
                        (polar / 2, polar / 2, polar), rtol=1e-12)
    # without Poisson effect: 6/7 of a circle, 1/2 of a thin tube, the textbook factors
    assert_allclose(circle(1.0, 1.0, 0.0, 1.0).shear_factor, 6 / 7, rtol=1e-15)
    assert_allclose(tube(1.0, 1e-6, 1.0, 0.0, 1.0).shear_factor, 0.5, rtol=1e-11)
    assert_allclose(rectangle(1.0, 3.0, 1.0, 0.0, 1.0).shear_factor, 5 / 6, rtol=1e-15)


def test_frequencies_do_not_depend_on_the_unit_of_length():
    """Metre, kilogram, second against millimetre, tonne, second."""
    squares = []
    for unit, material in ((1.0, (2.1e11, 0.3, 7800.0)), (1e3, (2.1e5, 0.3, 7.8e-9))):
        section = i_profile(0.2 * unit, 0.1 * unit, 0.006 * unit, 0.01 * unit, *material)
        model = straight_beam([0, 0, 0], [3 * unit, unit, 0], section, 4)
        squares.append(eigh(model.stiffness.toarray()[6:, 6:], model.mass.toarray()[6:, 6:],
                            eigvals_only=True)[:6])
    assert_allclose(squares[1], squares[0], rtol=1e-9)      # conditions up to 1e7 with mixed units


@pytest.mark.parametrize(
    ("build", "text"),
    [
        (lambda: replace(BY_STIFFNESS, axial=0.0), r"StiffnessSection\.axial is 0\.0: give a pos"),
        (lambda: replace(BY_STIFFNESS, shear_z=-1), r"StiffnessSection\.shear_z is -1"),
        (lambda: replace(BY_STIFFNESS, inertia_x=-1), r"inertia_x is -1: give a finite number >="),
        (lambda: replace(BY_STIFFNESS, mass="7"), r"mass is '7': give a positive number"),
        (lambda: Section(1, 1, 1, 1, 1, 0.3, 1, (0.8, 0.8, 0.8)), "give one number, or two for"),
        (lambda: Section(1, 1, 1, 1, 1, 0.3, 1, (0.8, 0.0)), r"Section\.shear_factor is 0\.0"),
        (lambda: straight_beam(START, END, "I 200", 2), "section 'I 200' is none: give a Section"),
        (lambda: straight_beam(START, END, lambda place: None, 2), "section None is none"),
        (lambda: rectangle(0.1, -1.0, *STEEL), "rectangle: width is -1.0"),
        (lambda: tube(0.1, 0.2, *STEEL), "tube: thickness is 0.2, more than its radius 0.1"),
        (lambda: circle(np.nan, *STEEL), "circle: radius is nan: give a positive number"),
        (lambda: i_profile(0.2, 0.1, 0.006, 0.1, *STEEL), "do not fit into width 0.1 and height"),
    ],
)
def test_bad_input_is_named(build, text):
    with pytest.raises(InputError, match=text):
        build()


def area_and_moments(outline):
    """Area, I_y and I_z of a polygon by Green's theorem; corners run against the clock."""
    y, z = np.array(outline).T
    y1, z1 = np.roll(y, -1), np.roll(z, -1)
    cross = y * z1 - y1 * z
    return (cross.sum() / 2, (cross * (z**2 + z * z1 + z1**2)).sum() / 12,
            (cross * (y**2 + y * y1 + y1**2)).sum() / 12)


@pytest.mark.parametrize("section, rel", [
    (rectangle(0.3, 0.1, 2e11, 0.3, 7800), 1e-12),
    (i_profile(0.3, 0.2, 0.02, 0.03, 2e11, 0.3, 7800), 1e-12),
    (circle(0.3, 2e11, 0.3, 7800), 0.06)])      # a polygon of 16 corners has 2.6 % less area
def test_outlines_have_area_and_moments_of_the_section(section, rel):
    found = np.abs(area_and_moments(section.outline))
    wanted = section.area, section.inertia_y, section.inertia_z
    np.testing.assert_allclose(found, wanted, rtol=rel)


def test_a_section_without_an_outline_is_a_rectangle_of_its_radii_of_gyration():
    plain = Section(2.0, 0.3, 0.7, 0.5, 1e6, 0.3, 1.0)
    model = straight_beam((0, 0, 0), (0, 0, 4), plain, 2, up=(1, 1, 0))
    y, z = np.array([1, 1, 0]) / np.sqrt(2), np.array([-1, 1, 0]) / np.sqrt(2)
    corners = np.column_stack([model.outlines[1] @ y, model.outlines[1] @ z])
    area, I_y, I_z = area_and_moments(corners)
    assert (I_y / area, I_z / area) == pytest.approx((0.3 / 2.0, 0.7 / 2.0))
    assert np.abs(model.outlines[..., 2]).max() < 1e-12


@pytest.mark.parametrize("outline, said", [
    (((0, 0), (1, 0)), "Section.outline has 2 corners: give at least three"),
    ((1, 2, 3), "Section.outline has shape"), ("box", "Section.outline is 'box'")])
def test_outlines_that_are_none(outline, said):
    with pytest.raises(InputError, match=said):
        replace(Section(2.0, 0.3, 0.7, 0.5, 1e6, 0.3, 1.0), outline=outline)


def test_outlines_of_other_cells_are_refused():
    model = straight_beam((0, 0, 0), (1, 0, 0), rectangle(0.1, 0.1, 1e6, 0.3, 1.0), 2)
    with pytest.raises(InputError, match="give corners .* each of the 2 cells of kind line"):
        replace(model, outlines=model.outlines[:1])
