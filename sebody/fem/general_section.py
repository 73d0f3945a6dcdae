"""Cross-sections whose stiffness and mass couple everything, and sections between stations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.vectors import skew
from sebody.fem.section import Fibre, Outline, StiffnessSection, check_fibres, check_outline

SYMMETRIC = 1e-6        # difference across the diagonal, relative to its own entries: few digits
DEFINITE = 1e-12        # lowest eigenvalue of a matrix with a diagonal of ones
FORCES = ("N", "Qy", "Qz", "Mx", "My", "Mz")
MOTIONS = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True, eq=False)
class GeneralSection:
    """Cross-section by matrices: tension, shear, torsion and bending may all be coupled.

    Axes are those of the section, x along the beam, y and z across it, from the beam's reference
    axis. Section forces ``(N, Qy, Qz, Mx, My, Mz)`` are the stiffness times the strains: extension,
    two shear strains, rates of twist and of bending about y and z.

    Parameters
    ----------
    stiffness : (6, 6)
        Symmetric and positive definite [force, force length, force length^2].
    mass : (6, 6)
        Momenta a length of unit velocities and spins: ``[[m I, -m skew(c)], [m skew(c), J]]`` with
        the centre of mass c = (0, y, z) and the rotary inertia J about the reference axis
        [mass/length, mass, mass length].
    outline : tuple of (float, float), optional
        Corners (y, z) of its edge one after the other, for pictures [length]; None: a rectangle
        with its radii of gyration.
    fibres : tuple of Fibre
        Where stresses are computed, ``Fibre(y, z, (xx, xy, zx))``.
    retardation : float or (6,)
        Retardation times mu of the six strains: the section damps like ``sqrt(mu) K sqrt(mu)``,
        which is ``mu K`` for equal ones [time].
    name : str
        Of the section, for messages: ``station 3``.

    Raises
    ------
    InputError
        Matrices that are not finite or not symmetric, a stiffness that is not positive definite,
        a mass of another form, or what `StiffnessSection` refuses.
    """

    stiffness: NDArray
    mass: NDArray
    outline: Outline | None = field(default=None, repr=False)
    fibres: tuple[Fibre, ...] = field(default=(), repr=False)
    retardation: ArrayLike = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        inputs.text(self.name, "name of a GeneralSection")
        check_outline(self)
        check_fibres(self)
        times = inputs.reals(self.retardation, self._part("retardation"), "give one number, or six")
        if times.shape not in ((), (6,)) or not (np.isfinite(times) & (times >= 0)).all():
            raise inputs.refusal(self._part("retardation"), self.retardation,
                                 "give one time, or six of N, Qy, Qz, Mx, My, Mz, not negative")
        object.__setattr__(self, "retardation", np.broadcast_to(times, 6))
        for part, names in (("stiffness", FORCES), ("mass", MOTIONS)):
            matrix = inputs.array(getattr(self, part), self._part(part), (6, 6))
            object.__setattr__(self, part, _symmetric(matrix, self._part(part), names))
        _check_definite(self.stiffness, self._part("stiffness"), FORCES)
        self._check_mass()

    @property
    def stiffnesses(self) -> GeneralSection:
        """The section itself: what beams are made of."""
        return self

    @cached_property
    def flexibility(self) -> NDArray:
        """Strains of unit section forces, the inverse of the stiffness, (6, 6)."""
        scale = 1 / np.sqrt(np.diag(self.stiffness))
        inverse = np.linalg.inv(self.stiffness * np.outer(scale, scale)) * np.outer(scale, scale)
        return (inverse + inverse.T) / 2

    @property
    def inertia(self) -> NDArray:
        """Momenta a length of unit velocities and spins: the mass, (6, 6)."""
        return self.mass

    @property
    def damping(self) -> NDArray:
        """Section forces of unit rates of the strains, (6, 6)."""
        root = np.sqrt(np.asarray(self.retardation))
        return self.stiffness * np.outer(root, root)

    @property
    def wave_speed(self) -> float:
        """Speed of waves of tension, sqrt(EA / mass a length) [length/time]."""
        return float(np.sqrt(self.stiffness[0, 0] / self.mass[0, 0]))

    @property
    def gyration(self) -> tuple[float, float]:
        """Radii of gyration along y and z [length]."""
        return (float(np.sqrt(self.stiffness[5, 5] / self.stiffness[0, 0])),
                float(np.sqrt(self.stiffness[4, 4] / self.stiffness[0, 0])))

    def __repr__(self) -> str:
        named = f" {self.name}" if self.name else ""
        y, z = centre_of_mass(self.mass)[1:]
        return (f"<GeneralSection{named}: EA {self.stiffness[0, 0]:.4g}, GJ "
                f"{self.stiffness[3, 3]:.4g}, EI {self.stiffness[4, 4]:.4g} and "
                f"{self.stiffness[5, 5]:.4g}, mass {self.mass[0, 0]:.4g} at ({y:.4g}, {z:.4g})>")

    def _part(self, part: str) -> str:
        return f"{self.name or 'GeneralSection'}: {part}"

    def _check_mass(self) -> None:
        """Refuse what is no mass of a section."""
        M, what = self.mass, self._part("mass")
        if M[0, 0] <= 0:
            raise InputError(f"{what}[x, x] is {M[0, 0]:.6g}: give a positive mass a length")
        m = M[0, 0]
        wanted = np.zeros((6, 6))
        wanted[:3, :3] = m * np.eye(3)
        wanted[3:, :3] = m * skew(centre_of_mass(M))
        wanted[:3, 3:] = wanted[3:, :3].T
        wanted[3:, 3:] = M[3:, 3:]
        arm = float(np.sqrt(np.abs(np.diag(M)[3:]).max() / m))
        allowed = SYMMETRIC * m * np.outer([1, 1, 1, arm, arm, arm], [1, 1, 1, arm, arm, arm])
        off = np.abs(M - wanted) - allowed - SYMMETRIC * np.abs(wanted)
        i, j = np.unravel_index(np.argmax(off), off.shape)
        if off[i, j] > 0:
            raise InputError(
                f"{what}[{MOTIONS[i]}, {MOTIONS[j]}] is {M[i, j]:.6g} where a mass of "
                f"{m:.6g} with its centre at (y, z) = ({centre_of_mass(M)[1]:.6g}, "
                f"{centre_of_mass(M)[2]:.6g}) has {wanted[i, j]:.6g}: give "
                "[[m I, -m skew(c)], [m skew(c), J]], x along the beam")
        about = central_inertia(M)
        lowest = float(np.linalg.eigvalsh(about)[0])
        if lowest < -SYMMETRIC * np.abs(np.diag(M)[3:]).max():
            raise InputError(f"{what}: the rotary inertia about the centre of mass is negative "
                             f"({lowest:.6g}): give J about the reference axis, with m (y^2 + z^2)")


def centre_of_mass(mass: NDArray) -> NDArray:
    """Place (..., 3) of the centre of mass in the section of mass matrices (..., 6, 6)."""
    return np.stack([mass[..., 5, 1] - mass[..., 4, 2], mass[..., 3, 2] - mass[..., 5, 0],
                     mass[..., 4, 0] - mass[..., 3, 1]], axis=-1) / (2 * mass[..., :1, 0])


def central_inertia(mass: NDArray) -> NDArray:
    """Rotary inertia a length (..., 3, 3) about the centre of mass."""
    arms = skew(centre_of_mass(mass))
    return mass[..., 3:, 3:] + mass[..., :1, :1] * (arms @ arms)


def _symmetric(matrix: NDArray, what: str, names: Sequence[str]) -> NDArray:
    unlike = np.abs(matrix - matrix.T)
    scale = np.sqrt(np.abs(np.outer(np.diag(matrix), np.diag(matrix))))
    i, j = map(int, np.unravel_index(np.argmax(unlike - SYMMETRIC * scale), unlike.shape))
    if unlike[i, j] > SYMMETRIC * scale[i, j]:
        raise InputError(f"{what} is not symmetric: [{names[i]}, {names[j]}] = "
                         f"{matrix[i, j]:.6g} but [{names[j]}, {names[i]}] = {matrix[j, i]:.6g}: "
                         "give both triangles alike")
    whole = (matrix + matrix.T) / 2
    whole.flags.writeable = False
    return whole


def _check_definite(matrix: NDArray, what: str, names: Sequence[str]) -> None:
    diagonal = np.diag(matrix)
    worst = int(np.argmin(diagonal))
    if diagonal[worst] <= 0:
        raise InputError(f"{what}[{names[worst]}, {names[worst]}] is {diagonal[worst]:.6g}: give "
                         "a positive stiffness")
    scale = np.sqrt(diagonal)
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    if values[0] < DEFINITE:
        most = " and ".join(names[k] for k in sorted(np.argsort(-np.abs(vectors[:, 0]))[:2]))
        raise InputError(f"{what} is not positive definite: some strain of {most} has the energy "
                         f"{values[0]:.3g}, where alone it has 1: check their coupling, its units "
                         "and its sign")


class Stations:
    """Sections at places along a beam; matrices linear between them, in axes that twist with it.

    Parameters
    ----------
    places : (n,)
        Ascending from 0 to 1, parts of the length of the beam's axis.
    sections : sequence of n GeneralSection or StiffnessSection
        The latter with shear stiffnesses.

    Raises
    ------
    InputError
        Places that do not ascend from 0 to 1, or other sections.
    """

    def __init__(self, places: ArrayLike, sections: Sequence[GeneralSection | StiffnessSection]):
        remedy = "give GeneralSections, one for each place"
        found = [inputs.instance(one, "Stations: a section", GeneralSection | StiffnessSection,
                                 remedy)
                 for one in inputs.items(sections, "Stations: sections", remedy)]
        at = inputs.vector(places, "Stations: places", len(found),
                           remedy=f"give {len(found)} numbers, one for each section")
        if len(at) < 2 or at[0] != 0 or at[-1] != 1 or (np.diff(at) <= 0).any():
            raise inputs.refusal("Stations: places", at.tolist(),
                                 "give at least two, ascending from 0 to 1")
        self.places, self.sections = at, tuple(map(_general, found))

    @property
    def kinks(self) -> NDArray:
        """Places along the beam where sections are not smooth."""
        return self.places

    def __call__(self, place: float) -> GeneralSection:
        """The section at a place."""
        k = int(np.clip(np.searchsorted(self.places, place, side="right") - 1, 0,
                        len(self.places) - 2))
        part = (place - self.places[k]) / (self.places[k + 1] - self.places[k])
        first, last = self.sections[k], self.sections[k + 1]
        if part <= 0.0 or first is last:
            return first
        if part >= 1.0:
            return last

        def between(a: ArrayLike, b: ArrayLike) -> NDArray:
            return (1 - part) * np.asarray(a) + part * np.asarray(b)
        outline, fibres = None, tuple[Fibre, ...]()
        if first.outline and last.outline and len(first.outline) == len(last.outline):
            outline = tuple(map(tuple, between(first.outline, last.outline).tolist()))
        if len(first.fibres) == len(last.fibres):
            fibres = tuple(Fibre(float(between(a.y, b.y)), float(between(a.z, b.z)),
                                 cast(Any, between(a.stress, b.stress).tolist()))
                           for a, b in zip(first.fibres, last.fibres, strict=True))
        return GeneralSection(between(first.stiffness, last.stiffness),
                              between(first.mass, last.mass), outline, fibres,
                              between(first.retardation, last.retardation), first.name)

    def __repr__(self) -> str:
        return f"<Stations: {len(self.places)}, from {self.sections[0]} to {self.sections[-1]}>"


def _general(section: GeneralSection | StiffnessSection) -> GeneralSection:
    if isinstance(section, GeneralSection):
        return section
    if section.shear_y is None or section.shear_z is None:
        raise InputError("Stations: a StiffnessSection without shear_y and shear_z has no finite "
                         "stiffness to be interpolated: give both")
    return GeneralSection(np.diag(1 / np.diag(section.flexibility)), section.inertia,
                          section.outline, section.fibres)
