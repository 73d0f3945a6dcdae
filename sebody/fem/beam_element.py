"""Two-node beam element, with or without shear flexibility, in the axes of its section.

The element is exact for end loads: cubic deflection, quadratic rotation tied to it by
equilibrium (J.S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, sections 5.6 and
11.5). The mass is consistent with that interpolation and contains the rotary inertia.

DOFs are (ux, uy, uz, rx, ry, rz) of end 1, then of end 2.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.fem.section import StiffnessSection

_AXIAL, _TORSION = np.array([0, 6]), np.array([3, 9])
_BENDING_Z, _BENDING_Y = np.array([1, 5, 7, 11]), np.array([2, 4, 8, 10])
# In the xz plane a positive ry turns x towards -z: rotations change sign.
_FLIP = np.array([1.0, -1.0, 1.0, -1.0])

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)  # exact to degree 7, the mass needs 6
PLACES, WEIGHTS = (1 + _POINTS) / 2, _WEIGHTS / 2  # of the integration, on 0 to 1


def stiffness(section: StiffnessSection, length: float) -> NDArray:
    """Stiffness (12, 12)."""
    matrix = np.zeros((12, 12))
    spring = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    matrix[np.ix_(_AXIAL, _AXIAL)] = section.axial * spring
    matrix[np.ix_(_TORSION, _TORSION)] = section.torsion * spring
    for rows, bending, shear, flip in _planes(section):
        phi = _shear_ratio(bending, shear, length)
        a, near, far = 6 * length, (4 + phi) * length**2, (2 - phi) * length**2
        shape = [[12, a, -12, a], [a, near, -a, far], [-12, -a, 12, -a], [a, far, -a, near]]
        factor = bending / ((1 + phi) * length**3)
        matrix[np.ix_(rows, rows)] = factor * np.outer(flip, flip) * np.array(shape)
    return matrix


def interpolation(section: StiffnessSection, length: float,
                  places: NDArray) -> tuple[NDArray, NDArray]:
    """Displacement and rotation (rows 0-2, 3-5) between the ends, and their derivatives.

    Parameters
    ----------
    places : (n,)
        From 0 at end 1 to 1 at end 2.

    Returns
    -------
    values, slopes : (n, 6, 12)
        Of unit DOFs; slopes by length.
    """
    s = np.asarray(places)[:, None]
    powers = s ** np.arange(4)
    derived = np.column_stack([0 * s, 0 * s + 1, 2 * s, 3 * s**2]) / length
    fields = []
    for monomials in (powers, derived):
        field = np.zeros((len(s), 6, 12))
        for row, columns in ((0, _AXIAL), (3, _TORSION)):
            field[:, row, columns] = monomials @ np.array([[1.0, -1, 0, 0], [0, 1.0, 0, 0]]).T
        for (rows, bending, shear, flip), across, about in zip(
                _planes(section), (1, 2), (5, 4), strict=True):
            deflection, rotation = _bending_shapes(_shear_ratio(bending, shear, length), length)
            field[:, across, rows] = monomials @ deflection.T * flip
            field[:, about, rows] = monomials @ rotation.T * flip * flip[1]
        fields.append(field)
    return fields[0], fields[1]


def point_inertia(section: StiffnessSection) -> NDArray:
    """Mass and rotary inertia a length of the six components of `interpolation`, (6,)."""
    return np.array([section.mass] * 3
                    + [section.inertia_x, section.inertia_y, section.inertia_z])


def mass(section: StiffnessSection, length: float) -> NDArray:
    """Mass (12, 12): exact integral over the interpolation."""
    values, _ = interpolation(section, length, PLACES)
    weights = length * WEIGHTS[:, None] * point_inertia(section)
    return np.einsum("gia,gi,gib->ab", values, weights, values)


def _planes(section: StiffnessSection) -> tuple:
    """Rows, bending and shear stiffness and signs of bending about z, then about y."""
    return ((_BENDING_Z, section.bending_z, section.shear_y, np.ones(4)),
            (_BENDING_Y, section.bending_y, section.shear_z, _FLIP))


def _shear_ratio(bending: float, shear: float | None, length: float) -> float:
    """phi = 12 E I / (k G A L^2), zero without shear deformation."""
    return 0.0 if shear is None else 12 * bending / (shear * length**2)


def _bending_shapes(phi: float, length: float) -> tuple[NDArray, NDArray]:
    """Deflection and rotation of unit (v1, theta1, v2, theta2): coefficients (4, 4) of s^k."""
    lever = np.array([1.0, length, 1.0, length])[:, None] / (1 + phi)
    deflection = lever * np.array([
        [1 + phi, -phi, -3, 2],
        [0, 1 + phi / 2, -2 - phi / 2, 1],
        [0, phi, 3, -2],
        [0, -phi / 2, phi / 2 - 1, 1],
    ])
    rotation = lever / length * np.array([
        [0, -6, 6, 0],
        [1 + phi, -4 - phi, 3, 0],
        [0, 6, -6, 0],
        [0, phi - 2, 3, 0],
    ])
    return deflection, rotation
