"""Two-node beam elements, spatial and planar, with or without shear flexibility.

The element is exact for end loads: cubic deflection, quadratic rotation tied to it by
equilibrium (J.S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, sections 5.6 and
11.5). The mass is consistent with that interpolation and always contains the rotary inertia.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.errors import InputError
from sebody.fem.model import PLANAR, SPATIAL, FEModel, assemble

# Rows of the spatial element: end 1 (ux, uy, uz, rx, ry, rz), then end 2.
_AXIAL, _TORSION = np.array([0, 6]), np.array([3, 9])
_BENDING_Z, _BENDING_Y = np.array([1, 5, 7, 11]), np.array([2, 4, 8, 10])
_IN_PLANE = np.array([0, 1, 5, 6, 7, 11])


@dataclass(frozen=True)
class Section:
    """Cross-section and material of a beam.

    Parameters
    ----------
    area : float
        Cross-section area [length^2].
    inertia_y, inertia_z : float
        Second moments of area about the section's y and z axes [length^4].
    torsion : float
        Torsion constant [length^4].
    youngs_modulus : float
        Young's modulus [force/length^2].
    poisson_ratio : float
        Poisson's ratio.
    density : float
        Mass per volume.
    shear_factor : float, optional
        Shear correction factor k of the shear stiffness k G A; None: no shear deformation
        (Euler-Bernoulli).

    Raises
    ------
    InputError
        A value that is not positive and finite, or a Poisson's ratio outside (-1, 0.5].
    """

    area: float
    inertia_y: float
    inertia_z: float
    torsion: float
    youngs_modulus: float
    poisson_ratio: float
    density: float
    shear_factor: float | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "poisson_ratio" or value is None:
                continue
            if not (np.isfinite(value) and value > 0):
                raise InputError(f"Section.{field.name} is {value}; give a positive number")
        if not -1 < self.poisson_ratio <= 0.5:
            raise InputError(
                f"Section.poisson_ratio is {self.poisson_ratio}; give a value in (-1, 0.5]"
            )

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [force/length^2]."""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))


def straight_beam(
    start: ArrayLike,
    end: ArrayLike,
    section: Section,
    elements: int,
    up: ArrayLike | None = None,
) -> FEModel:
    """Spatial beam of equal elements; node 0 at `start`, node `elements` at `end`.

    Parameters
    ----------
    start, end : (3,)
        Ends of the beam's axis [length].
    section : Section
        Cross-section and material.
    elements : int
        Number of elements.
    up : (3,), optional
        Direction of the section's y axis (its part normal to the beam). Default: the section's
        z axis points along global z as far as it can, so `inertia_z` bends in the xy plane.

    Raises
    ------
    InputError
        Coincident ends, no element, or `up` along the beam.
    """
    return _line(_points([start, end], 3), section, elements, up)


def planar_beam(start: ArrayLike, end: ArrayLike, section: Section, elements: int) -> FEModel:
    """Beam in the xy plane, DOFs (x, y, rz) per node, bending with `inertia_z`.

    Parameters as for `straight_beam`, with `start` and `end` of shape (2,).
    """
    return _line(_points([start, end], 2), section, elements, None)


def frame(
    points: ArrayLike,
    members: Sequence[tuple[int, int]],
    section: Section,
    elements: int,
    up: ArrayLike | None = None,
) -> FEModel:
    """Straight members joined rigidly where they share a point.

    Parameters
    ----------
    points : (n_points, 3), planar (n_points, 2)
        Joints and free ends [length]; they are nodes 0 to n_points - 1 of the model, the nodes
        inside the members follow.
    members : sequence of (int, int)
        Start and end point of each member.
    section : Section
        Cross-section and material of all members.
    elements : int
        Number of elements in each member.
    up : (3,), optional
        As for `straight_beam`.

    Raises
    ------
    InputError
        A member with an unknown point or no length, no element, or `up` along a member.
    """
    points = np.asarray(points, dtype=float)
    points = _points(points, 2 if points.shape[-1] == 2 else 3)
    _check_elements(elements)
    nodes, pairs = list(points), []
    for member in members:
        if not all(0 <= point < len(points) for point in member):
            raise InputError(
                f"member {member} names an unknown point; there are points 0 to {len(points) - 1}"
            )
        first, last = member
        inner = range(len(nodes), len(nodes) + elements - 1)
        nodes.extend(np.linspace(points[first], points[last], elements + 1)[1:-1])
        chain = [first, *inner, last]
        pairs.extend(pairwise(chain))
    return _beam_model(np.array(nodes), np.array(pairs), section, up)


def _line(ends: NDArray, section: Section, elements: int, up: ArrayLike | None) -> FEModel:
    _check_elements(elements)
    nodes = np.linspace(ends[0], ends[1], elements + 1)
    first = np.arange(elements)
    return _beam_model(nodes, np.column_stack([first, first + 1]), section, up)


def _points(points: ArrayLike, dimension: int) -> NDArray:
    points = np.array(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != dimension or not np.all(np.isfinite(points)):
        raise InputError(f"points {points.tolist()}: give {dimension} finite coordinates for each")
    return points


def _check_elements(elements: int) -> None:
    if elements < 1:
        raise InputError(f"elements is {elements}; a beam needs at least one")


def _beam_model(
    nodes: NDArray, pairs: NDArray, section: Section, up: ArrayLike | None
) -> FEModel:
    """Assemble one element per node pair, turned from the member's into global axes."""
    planar = nodes.shape[1] == 2
    node_dofs = PLANAR if planar else SPATIAL
    stiffness, mass = [], []
    for first, last in pairs:
        axis = np.zeros(3)
        axis[: nodes.shape[1]] = nodes[last] - nodes[first]
        turn = np.kron(np.eye(4), _section_axes(axis, up))  # global to member axes
        element_matrices = beam_element(section, float(np.linalg.norm(axis)))
        for target, local in zip((stiffness, mass), element_matrices, strict=True):
            matrix = turn.T @ local @ turn
            target.append((matrix + matrix.T) / 2)
    rows = np.arange(len(node_dofs))
    dofs = np.concatenate([len(node_dofs) * pairs[:, [end]] + rows for end in (0, 1)], axis=1)
    kept = np.ix_(range(len(pairs)), *[_IN_PLANE if planar else range(12)] * 2)
    size = len(nodes) * len(node_dofs)
    return FEModel(
        assemble(dofs, np.array(stiffness)[kept], size),
        assemble(dofs, np.array(mass)[kept], size),
        nodes,
        node_dofs,
    )


def _section_axes(axis: NDArray, up: ArrayLike | None) -> NDArray:
    """Rows: member axis x, section axes y and z, in global axes."""
    length = np.linalg.norm(axis)
    if length == 0:
        raise InputError("a beam has both ends at the same point; give it a length")
    x = axis / length
    if up is None:
        vertical = np.hypot(x[0], x[1]) < 1e-6
        up = np.array([0.0, 1.0, 0.0]) if vertical else np.cross([0.0, 0.0, 1.0], x)
    up = np.asarray(up, dtype=float)
    y = up - (up @ x) * x
    if np.linalg.norm(y) <= 1e-6 * np.linalg.norm(up):
        raise InputError(f"up = {up.tolist()} lies along a beam; choose another direction")
    y /= np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


def beam_element(section: Section, length: float) -> tuple[NDArray, NDArray]:
    """Stiffness and mass (12, 12) in member axes, DOFs (ux, uy, uz, rx, ry, rz) per end."""
    stiffness, mass = np.zeros((12, 12)), np.zeros((12, 12))
    polar = section.inertia_y + section.inertia_z
    spring = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    linear = np.array([[2.0, 1.0], [1.0, 2.0]]) * section.density * length / 6
    stiffness[np.ix_(_AXIAL, _AXIAL)] = section.youngs_modulus * section.area * spring
    stiffness[np.ix_(_TORSION, _TORSION)] = section.shear_modulus * section.torsion * spring
    mass[np.ix_(_AXIAL, _AXIAL)] = section.area * linear
    mass[np.ix_(_TORSION, _TORSION)] = polar * linear
    # In the xz plane a positive ry turns x towards -z: rotations change sign.
    for rows, inertia, sign in (
        (_BENDING_Z, section.inertia_z, 1.0),
        (_BENDING_Y, section.inertia_y, -1.0),
    ):
        flip = np.outer([1, sign, 1, sign], [1, sign, 1, sign])
        stiffness[np.ix_(rows, rows)] = flip * _bending_stiffness(section, inertia, length)
        mass[np.ix_(rows, rows)] = flip * _bending_mass(section, inertia, length)
    return stiffness, mass


def _shear_ratio(section: Section, inertia: float, length: float) -> float:
    """phi = 12 E I / (k G A L^2), zero without shear deformation."""
    if section.shear_factor is None:
        return 0.0
    shear = section.shear_factor * section.shear_modulus * section.area
    return 12 * section.youngs_modulus * inertia / (shear * length**2)


def _bending_stiffness(section: Section, inertia: float, length: float) -> NDArray:
    """Stiffness (4, 4) on (v1, theta1, v2, theta2)."""
    phi = _shear_ratio(section, inertia, length)
    a, near, far = 6 * length, (4 + phi) * length**2, (2 - phi) * length**2
    shape = [[12, a, -12, a], [a, near, -a, far], [-12, -a, 12, -a], [a, far, -a, near]]
    return section.youngs_modulus * inertia / ((1 + phi) * length**3) * np.array(shape)


def _bending_mass(section: Section, inertia: float, length: float) -> NDArray:
    """Mass (4, 4) on (v1, theta1, v2, theta2): translation of the axis and rotary inertia."""
    phi = _shear_ratio(section, inertia, length)
    points, weights = np.polynomial.legendre.leggauss(4)  # exact to degree 7, needed 6
    s, one_phi = (1 + points) / 2, 1 + phi
    deflection = np.array([
        1 - 3 * s**2 + 2 * s**3 + phi * (1 - s),
        length * (s - 2 * s**2 + s**3 + phi / 2 * (s - s**2)),
        3 * s**2 - 2 * s**3 + phi * s,
        length * (s**3 - s**2 + phi / 2 * (s**2 - s)),
    ]) / one_phi
    rotation = np.array([
        6 / length * (s**2 - s),
        1 - 4 * s + 3 * s**2 + phi * (1 - s),
        6 / length * (s - s**2),
        3 * s**2 - 2 * s + phi * s,
    ]) / one_phi
    per_point = section.density * weights * length / 2
    axis_part = (deflection * per_point * section.area) @ deflection.T
    rotary_part = (rotation * per_point * inertia) @ rotation.T
    mass = axis_part + rotary_part
    return (mass + mass.T) / 2
