"""Cross-sections of beams: by geometry and material, or by stiffnesses and inertia a length."""

from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import without_symbols

Outline = tuple[tuple[float, float], ...]
Row = tuple[float, ...]


class Fibre(NamedTuple):
    """A place in a cross-section where stresses are wanted.

    Parameters
    ----------
    y, z : float
        In principal axes from the centroid [length].
    stress : ((6,), (6,), (6,))
        Stresses xx, xy and zx there of unit section forces (N, Qy, Qz, Mx, My, Mz).
    """

    y: float
    z: float
    stress: tuple[Row, Row, Row]


@dataclass(frozen=True)
class StiffnessSection:
    """Cross-section of a beam by its stiffnesses and its mass and rotary inertia a length.

    Axes are those of the section: x along the beam, y and z principal axes across it.

    Parameters
    ----------
    axial : float
        EA [force].
    bending_y, bending_z : float
        EI_y and EI_z, for bending moments about y and z [force length^2].
    torsion : float
        GJ [force length^2].
    mass : float
        Mass a length [mass/length].
    inertia_x, inertia_y, inertia_z : float
        Rotary inertia a length about x, y and z [mass length]; may be zero.
    shear_y, shear_z : float, optional
        Shear stiffnesses for shear forces along y and z [force]; None: no shear deformation.
    outline : tuple of (float, float), optional
        Corners (y, z) of its edge one after the other, for pictures [length]; None: a rectangle
        with its radii of gyration.
    fibres : tuple of Fibre
        Where stresses are computed.

    Raises
    ------
    InputError
        A stiffness or mass that is not positive and finite, a negative inertia, or an outline of
        fewer than three corners.
    """

    axial: float
    bending_y: float
    bending_z: float
    torsion: float
    mass: float
    inertia_x: float
    inertia_y: float
    inertia_z: float
    shear_y: float | None = None
    shear_z: float | None = None
    outline: Outline | None = field(default=None, repr=False)
    fibres: tuple[Fibre, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        check_outline(self)
        check_fibres(self)
        for one in fields(self):
            value = getattr(self, one.name)
            if one.name not in ("outline", "fibres") and value is not None:
                _check_number(self, one.name, value, one.name.startswith("inertia"))

    @property
    def stiffnesses(self) -> "StiffnessSection":
        """The section itself: what beams are made of."""
        return self

    @property
    def flexibility(self) -> NDArray:
        """Strains of unit section forces, (6, 6); see `GeneralSection`."""
        shear = [0.0 if one is None else 1 / one for one in (self.shear_y, self.shear_z)]
        return np.diag([1 / self.axial, *shear, 1 / self.torsion, 1 / self.bending_y,
                        1 / self.bending_z])

    @property
    def inertia(self) -> NDArray:
        """Momenta a length of unit velocities and spins, (6, 6); see `GeneralSection`."""
        return np.diag([self.mass] * 3 + [self.inertia_x, self.inertia_y, self.inertia_z])

    @property
    def damping(self) -> NDArray:
        """Section forces of unit rates of the strains: none."""
        return np.zeros((6, 6))

    @property
    def wave_speed(self) -> float:
        """Speed of waves of tension, sqrt(EA / mass a length) [length/time]."""
        return float(np.sqrt(self.axial / self.mass))

    @property
    def gyration(self) -> tuple[float, float]:
        """Radii of gyration along y and z [length]."""
        return (float(np.sqrt(self.bending_z / self.axial)),
                float(np.sqrt(self.bending_y / self.axial)))


@dataclass(frozen=True)
class Section:
    """Cross-section of a beam by geometry and material.

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
        Mass per volume [mass/length^3].
    shear_factor : float or (float, float), optional
        Shear correction factor k of the shear stiffness k G A, two for shear forces along y and
        z; None: no shear deformation (Euler-Bernoulli).
    outline : tuple of (float, float), optional
        As in `StiffnessSection`.

    Raises
    ------
    InputError
        A value that is not positive and finite, a Poisson's ratio outside (-1, 0.5], other than
        one or two shear factors, or an outline of fewer than three corners.
    """

    area: float
    inertia_y: float
    inertia_z: float
    torsion: float
    youngs_modulus: float
    poisson_ratio: float
    density: float
    shear_factor: float | tuple[float, float] | None = None
    outline: Outline | None = field(default=None, repr=False)
    fibres: tuple[Fibre, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        check_outline(self)
        check_fibres(self)
        for one in fields(self):
            if one.name not in ("poisson_ratio", "shear_factor", "outline", "fibres"):
                _check_number(self, one.name, getattr(self, one.name))
        if isinstance(self.shear_factor, (tuple, list)) and len(self.shear_factor) != 2:
            raise InputError(
                f"Section.shear_factor is {self.shear_factor}; give one number, or two for shear "
                "forces along y and z"
            )
        for factor in self._shear_factors():
            if factor is not None:
                _check_number(self, "shear_factor", factor)
        inputs.number(self.poisson_ratio, "Section.poisson_ratio", above=-1, most=0.5)

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [force/length^2]."""
        return self.youngs_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def stiffnesses(self) -> StiffnessSection:
        """The same by stiffnesses and inertia a length."""
        shear = [None if k is None else k * self.shear_modulus * self.area
                 for k in self._shear_factors()]
        return StiffnessSection(
            axial=self.youngs_modulus * self.area,
            bending_y=self.youngs_modulus * self.inertia_y,
            bending_z=self.youngs_modulus * self.inertia_z,
            torsion=self.shear_modulus * self.torsion,
            mass=self.density * self.area,
            inertia_x=self.density * (self.inertia_y + self.inertia_z),
            inertia_y=self.density * self.inertia_y,
            inertia_z=self.density * self.inertia_z,
            shear_y=shear[0],
            shear_z=shear[1],
            outline=self.outline,
            fibres=self.fibres,
        )

    def fibre(self, y: float, z: float, xy: Row = (0.0, 0.0, 0.0),
              zx: Row = (0.0, 0.0, 0.0)) -> Fibre:
        """A fibre of this section: ``xx = N / A + z My / I_y - y Mz / I_z``.

        Parameters
        ----------
        y, z : float
            In principal axes from the centroid [length].
        xy, zx : (3,)
            Shear stresses there of unit shear forces Qy, Qz and of a unit torque.

        Returns
        -------
        Fibre
            For ``dataclasses.replace(section, fibres=(...))``.
        """
        normal = (1 / self.area, 0.0, 0.0, 0.0, z / self.inertia_y, -y / self.inertia_z)
        return Fibre(y, z, (normal, *((0.0, *shear, 0.0, 0.0) for shear in (xy, zx))))

    def _shear_factors(self) -> tuple:
        if isinstance(self.shear_factor, (tuple, list)):
            return tuple(self.shear_factor)
        return self.shear_factor, self.shear_factor


Section.__init__ = without_symbols(Section.__init__, "Section")   # type: ignore[method-assign]


def check_fibres(section: Any) -> None:
    """Fibres of a section as a tuple; InputError for something else."""
    remedy = "give Fibre, as Section.fibre makes them"
    what = f"{type(section).__name__}.fibres"
    checked = tuple(inputs.instance(fibre, what, Fibre, remedy)
                    for fibre in inputs.items(section.fibres, what, remedy))
    for fibre in checked:
        inputs.vector((fibre.y, fibre.z), what, 2)
        inputs.array(fibre.stress, what, (3, 6))
    object.__setattr__(section, "fibres", checked)


def _check_number(section: object, name: str, value: float, may_be_zero: bool = False) -> None:
    bound = {"least": 0} if may_be_zero else {"above": 0}
    inputs.number(value, f"{type(section).__name__}.{name}", **bound)


def check_outline(section: Any) -> None:
    """Corners as a tuple, which can be compared and is a key."""
    if section.outline is None:
        return
    what = f"{type(section).__name__}.outline"
    corners = inputs.array(section.outline, what, (None, 2))
    if len(corners) < 3:
        raise InputError(f"{what} has {len(corners)} corners: give at least three pairs (y, z)")
    object.__setattr__(section, "outline", tuple(map(tuple, corners.tolist())))
