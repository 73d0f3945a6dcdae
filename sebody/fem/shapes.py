"""Ready cross-sections: rectangle, circle, tube and I.

Shear correction factors are those of G.R. Cowper (The shear coefficient in Timoshenko's beam
theory, J. Appl. Mech. 33, 1966), torsion constants those of S.P. Timoshenko and J.N. Goodier
(Theory of Elasticity, 3rd ed., 1970, chapter 10); stresses are computed in the places that
`sebody.fem.fibres` lists. `dataclasses.replace(section, shear_factor=None)` takes out the shear
deformation.
"""

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import without_symbols
from sebody.basics.warned import warn
from sebody.fem import fibres
from sebody.fem.section import Outline, Section

THICK = 0.8             # wall of a tube over its radius, from which it may be an inner radius
ROUND = 16              # corners of a circle in pictures


@without_symbols
def rectangle(height: float, width: float, youngs_modulus: float, poisson_ratio: float,
              density: float) -> Section:
    """Rectangle; shear factor ``10 (1 + nu) / (12 + 11 nu)`` [Cowper, table 1].

    With a the longer and b the shorter side the torsion constant is ``a b^3 (1 - 192 b / (pi^5 a)
    sum tanh(n pi a / 2 b) / n^5) / 3``, n = 1, 3, 5, ... [Timoshenko and Goodier, art. 109].

    Parameters
    ----------
    height, width : float
        Sides along the section's y and z axes [length].
    youngs_modulus, poisson_ratio, density : float
        Material.

    Raises
    ------
    InputError
        Sides or material that no section has.
    """
    _check("rectangle", poisson_ratio, height=height, width=width)
    short, long = sorted((height, width))
    n = np.arange(1, 1000, 2)       # what is left out is 1e-13 of the sum
    series = np.sum(np.tanh(n * np.pi * long / (2 * short)) / n**5.0)
    torsion = long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * series)
    section = Section(height * width, height * width**3 / 12, width * height**3 / 12, torsion,
                      youngs_modulus, poisson_ratio, density, _rectangle_factor(poisson_ratio),
                      _box(height, width))
    return fibres.of_rectangle(section, height, width)


@without_symbols
def circle(radius: float, youngs_modulus: float, poisson_ratio: float, density: float) -> Section:
    """Solid circle; shear factor ``6 (1 + nu) / (7 + 6 nu)`` [Cowper, table 1].

    Parameters
    ----------
    radius : float
        Radius [length].
    youngs_modulus, poisson_ratio, density : float
        Material.

    Raises
    ------
    InputError
        A radius or material that no section has.
    """
    _check("circle", poisson_ratio, radius=radius)
    return tube(radius, radius, youngs_modulus, poisson_ratio, density)


@without_symbols
def tube(radius: float, thickness: float, youngs_modulus: float, poisson_ratio: float,
         density: float) -> Section:
    """Circular tube, solid where `thickness` is `radius`; its torsion constant is I_y + I_z.

    With m the inner over the outer radius the shear factor is ``6 (1 + nu) (1 + m^2)^2 / ((7 + 6
    nu) (1 + m^2)^2 + (20 + 12 nu) m^2)`` [Cowper, table 1].

    Parameters
    ----------
    radius : float
        Outer radius [length].
    thickness : float
        Of the wall, not the inner radius [length].
    youngs_modulus, poisson_ratio, density : float
        Material.

    Raises
    ------
    InputError
        A wall thicker than the radius, lengths or material that no section has.
    """
    _check("tube", poisson_ratio, radius=radius, thickness=thickness)
    if thickness > radius:
        raise InputError(f"tube: thickness is {thickness}, more than its radius {radius}; give "
                         "the thickness of the wall")
    if THICK * radius < thickness < radius:
        warn(f"tube: a wall of {thickness:g} in a radius of {radius:g} leaves a hole of radius "
             f"{radius - thickness:g}: the second number is the thickness of the wall, not the "
             "inner radius")
    inner, nu = radius - thickness, poisson_ratio
    second = np.pi / 4 * (radius**4 - inner**4)
    both, ratio = (1 + (inner / radius)**2)**2, (inner / radius)**2
    factor = 6 * (1 + nu) * both / ((7 + 6 * nu) * both + (20 + 12 * nu) * ratio)
    around = 2 * np.pi * np.arange(ROUND) / ROUND
    outline = tuple(zip(radius * np.cos(around), radius * np.sin(around), strict=True))
    section = Section(np.pi * (radius**2 - inner**2), second, second, 2 * second, youngs_modulus,
                      nu, density, factor, outline)
    return fibres.of_tube(section, radius, inner)


@without_symbols
def i_profile(height: float, width: float, web: float, flange: float, youngs_modulus: float,
              poisson_ratio: float, density: float) -> Section:
    """I with its web along the section's y axis, of thin walls.

    Torsion constant: sum of ``b t^3 / 3`` over web and flanges [Timoshenko and Goodier, art.
    111]. Shear factor along the web [Cowper, table 1, thin-walled I], with h the distance of the
    flanges' middles, n = b / h, m = 2 b t_f / (h t_w): ``10 (1 + nu) (1 + 3 m)^2 / (12 + 72 m + 150
    m^2 + 90 m^3 + nu (11 + 66 m + 135 m^2 + 90 m^3) + 30 n^2 (m + m^2) + 5 nu n^2 (8 m + 9 m^2))``;
    along the flanges these carry the force alone, as rectangles.

    Parameters
    ----------
    height : float
        Over all, along the section's y axis [length].
    width : float
        Of the flanges, along the section's z axis [length].
    web, flange : float
        Their thicknesses [length].
    youngs_modulus, poisson_ratio, density : float
        Material.

    Raises
    ------
    InputError
        A web or flanges thicker than there is room, lengths or material that no section has.
    """
    _check("i_profile", poisson_ratio, height=height, width=width, web=web, flange=flange)
    if not (2 * flange < height and web < width):
        raise InputError(f"i_profile: web {web} and flanges {flange} do not fit into width {width} "
                         f"and height {height}; give thinner walls")
    clear, nu = height - 2 * flange, poisson_ratio
    area = 2 * width * flange + clear * web
    middle = height - flange
    n2, m = (width / middle)**2, 2 * width * flange / (middle * web)
    along_web = 10 * (1 + nu) * (1 + 3 * m)**2 / (
        12 + 72 * m + 150 * m**2 + 90 * m**3 + nu * (11 + 66 * m + 135 * m**2 + 90 * m**3)
        + 30 * n2 * (m + m**2) + 5 * nu * n2 * (8 * m + 9 * m**2))
    along_flanges = _rectangle_factor(nu) * 2 * width * flange / area
    section = Section(area, (2 * flange * width**3 + clear * web**3) / 12,
                      (width * height**3 - (width - web) * clear**3) / 12,
                      (2 * width * flange**3 + middle * web**3) / 3, youngs_modulus, nu, density,
                      (along_web, along_flanges), _i_outline(height, width, web, clear))
    return fibres.of_i_profile(section, height, width, web, flange)


def _box(height: float, width: float) -> Outline:
    y, z = height / 2, width / 2
    return (-y, -z), (y, -z), (y, z), (-y, z)


def _i_outline(height: float, width: float, web: float, clear: float) -> Outline:
    y, z, inner, half = height / 2, width / 2, clear / 2, web / 2
    right = ((-y, z), (-inner, z), (-inner, half), (inner, half), (inner, z), (y, z))
    return *right, *((a, -b) for a, b in reversed(right))


def _rectangle_factor(poisson_ratio: float) -> float:
    return 10 * (1 + poisson_ratio) / (12 + 11 * poisson_ratio)


def _check(shape: str, poisson_ratio: float, **lengths: float) -> None:
    for name, value in lengths.items():
        inputs.number(value, f"{shape}: {name}", above=0)
    inputs.number(poisson_ratio, f"{shape}: poisson_ratio", above=-1, most=0.5)
