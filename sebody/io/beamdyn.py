"""Blades of OpenFAST's module BeamDyn: the axis of a primary file, the stations of a blade file.

BeamDyn's z axis leads from root to tip, x to the suction side and y to the trailing edge; matrices
are about the reference axis, in section axes that are turned by the initial twist, in degrees about
minus z. Here the sections' x axis is the tangent, so y is BeamDyn's x and z its y.

Between key points the axis is a cubic spline over z (three points: a parabola), which BeamDyn's own
polynomial differs from by less than its mesh; the twist is linear by length.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PPoly

from sebody.basics.errors import InputError
from sebody.basics.files.reading import existing, text as read_text
from sebody.basics.units import parsed_units
from sebody.fem import Axis, FEModel, GeneralSection, Stations, beam_along
from sebody.fem.materials import Material, doubt
from sebody.io.text import fault

UNITS = "m kg N s"
ORDER = [2, 0, 1, 5, 3, 4]      # of BeamDyn's x, y, z, rx, ry, rz in our x, y, z, rx, ry, rz
TERMS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
ALIKE = 30.0        # ratio of radii of gyration by stiffness and by mass: of other units 1000
JUMP = 300.0        # ratio of EA, or of masses, of stations side by side
RADIANS = 0.6       # twists below are small for degrees [degrees]
_WHAT = "BeamDyn file"
_REMEDY = ("give the primary input file of BeamDyn, with kp_total and BldFile, beside the blade "
           "file that it names")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][-+]?\d+)?"


@dataclass(frozen=True, eq=False)
class Blade:
    """A blade: its axis and its stations.

    Parameters
    ----------
    axis : Axis
        From root to tip, in the axes of the file.
    section : Stations
        With retardation times where the file has damping.
    source : str
        The files, in words.
    cautions : tuple of str
        What is doubtful: ``what; what to do``.
    """

    axis: Axis
    section: Stations
    source: str = ""
    cautions: tuple[str, ...] = ()
    units: str = UNITS

    def fe_model(self, elements: int = 40) -> FEModel:
        """The whole blade, see `sebody.fem.beam_along`."""
        return beam_along(self.axis, self.section, elements)

    @property
    def mass(self) -> float:
        """Mass of the blade [mass]."""
        at, stations = self.section.places, self.section.sections
        masses = np.array([one.mass[0, 0] for one in stations])
        return float(self.axis.length * np.sum((masses[1:] + masses[:-1]) / 2 * np.diff(at)))

    def __repr__(self) -> str:
        return (f"<Blade of {len(self.section.places)} stations, {self.axis.length:.6g} long, mass "
                f"{self.mass:.6g}>")


def read_beamdyn(path: str | Path, blade: str | Path | None = None) -> Blade:
    """A blade from the files of OpenFAST's module BeamDyn.

    Parameters
    ----------
    path : str or Path
        The primary input file.
    blade : str or Path, optional
        The blade file; the one that the primary file names by default.

    Returns
    -------
    Blade
        For ``model.beam(name, nodes, blade.section, ..., axis=blade.axis)``.

    Raises
    ------
    InputError
        A file that cannot be used: a message names line and station. Matrices that are not
        symmetric, not positive definite or in mixed units.

    Examples
    --------
    >>> blade = read_beamdyn("NRELOffshrBsline5MW_BeamDyn.dat")
    >>> root, tip = (model.node(n, blade.axis.position(p)) for n, p in (("root", 0), ("tip", 1)))
    >>> model.beam("blade", (root, tip), blade.section, 24, 4, modes=4, axis=blade.axis,
    ...            divide="rotation")
    """
    primary = existing(path, _WHAT, _REMEDY)
    lines = read_text(primary, _WHAT, _REMEDY).splitlines()
    points, twist, members = _key_points(primary, lines)
    if blade is None:
        number, word = _value(primary, lines, "BldFile", _REMEDY)
        blade = primary.parent / word.strip("\"'")
        if not blade.is_file():
            raise fault(primary, number, f"BldFile {word} is not there", "put it beside this file, "
                        "or give blade=")
    source = existing(blade, "BeamDyn blade file", "give the file that BldFile names")
    stations = _stations(source)
    axis = Axis(_spline(primary, points, members), twist=-np.radians(twist), side=(0.0, 1.0, 0.0),
                kinks=members)
    _check_units(source, stations, axis.length)
    return Blade(axis, stations, f"BeamDyn {primary.name} and {source.name}",
                 tuple(_doubts(primary, twist, stations)))


def _spline(path: Path, points: NDArray, members: list[int]) -> PPoly:
    """The axis over z, member after member."""
    z = points[:, 2]
    falling = np.flatnonzero(np.diff(z) <= 0)
    if len(falling):
        k = int(falling[0])
        raise InputError(f"{path}: kp_zr of key point {k + 2} is {z[k + 1]:g} after {z[k]:g}: z "
                         "ascends from root to tip")
    parts = [CubicSpline(z[a:b + 1], points[a:b + 1])
             for a, b in pairwise([0, *members, len(z) - 1])]
    return PPoly(np.concatenate([one.c for one in parts], axis=1), z)


def _key_points(path: Path, lines: list[str]) -> tuple[NDArray, NDArray, list[int]]:
    """Points (n, 3), twists (n,) in degrees, and numbers of those where members meet."""
    _, members = _whole(path, lines, "member_total")
    number, total = _whole(path, lines, "kp_total")
    if members < 1 or total < 3:
        raise fault(path, number, f"there are {members} members with {total} key points",
                    "a blade has one member at least, and three key points")
    counts = []
    for k in range(members):
        at = number + k
        words = lines[at].split() if at < len(lines) else []
        if len(words) < 2 or not words[0].isdigit() or not words[1].isdigit():
            raise fault(path, at + 1, "here the number of a member and of its key points stand",
                        _REMEDY)
        counts.append(int(words[1]))
    if sum(counts) != total + members - 1:
        raise fault(path, number + 1, f"the members have {counts} key points, and kp_total is "
                    f"{total}", "members that meet share a key point, so they have "
                    f"{total + members - 1} in all")
    rows = []
    for at, values in _rows(path, lines, number + members, total, "key points"):
        if len(values) != 4:
            raise fault(path, at, f"a key point has {len(values)} numbers",
                        "give kp_xr, kp_yr, kp_zr and initial_twist")
        rows.append(values)
    table = np.array(rows)
    return table[:, :3], table[:, 3], np.cumsum(np.array(counts) - 1)[:-1].tolist()


def _rows(path: Path, lines: list[str], first: int, count: int, what: str
          ) -> Iterator[tuple[int, list[float]]]:
    """Lines of numbers alone, from a line on, with their numbers; others before them are left."""
    found = 0
    for number, line in enumerate(lines[first:], first + 1):
        values = _numbers(line)
        if values is None:
            if found and line.strip():
                raise fault(path, number, f"{found} of {count} {what} end here", _REMEDY)
            continue
        found += 1
        yield number, values
        if found == count:
            return
    raise fault(path, len(lines), f"the file ends after {found} of {count} {what}", _REMEDY)


def _numbers(line: str) -> list[float] | None:
    words = line.replace(",", " ").split()
    if not words or not all(re.fullmatch(_NUMBER, word) for word in words):
        return None
    return [float(re.sub("[Dd]", "e", word)) for word in words]


def _value(path: Path, lines: list[str], name: str, remedy: str) -> tuple[int, str]:
    """Line number and value of a line ``value name - meaning``."""
    for number, line in enumerate(lines, 1):
        found = re.match(rf"\s*(\"[^\"]*\"|'[^']*'|\S+)\s+{name}\b", line, re.IGNORECASE)
        if found:
            return number, found[1]
    raise InputError(f"{path} has no {name}: {remedy}")


def _whole(path: Path, lines: list[str], name: str, remedy: str = _REMEDY) -> tuple[int, int]:
    number, word = _value(path, lines, name, remedy)
    if not word.isdigit():
        raise fault(path, number, f"{name} is {word}", "give a whole number")
    return number, int(word)


def _stations(path: Path) -> Stations:
    remedy = "give a blade file of BeamDyn, with station_total, damp_type and six by six matrices"
    lines = read_text(path, "BeamDyn blade file", remedy).splitlines()
    _, total = _whole(path, lines, "station_total", remedy)
    mu = _retardation(path, lines, remedy)
    start = next((k for k, line in enumerate(lines, 1) if "DISTRIBUTED" in line.upper()), None)
    if start is None:
        raise InputError(f"{path} has no DISTRIBUTED PROPERTIES: {remedy}")
    rows = [(at + start, values) for at, line in enumerate(lines[start:], 1)
            if (values := _numbers(line)) is not None]
    if len(rows) < 13 * total:
        raise fault(path, len(lines), f"the file ends within station {len(rows) // 13 + 1} of "
                    f"{total}", "a station is a line with its place, then 12 lines of six numbers")
    places, sections = [], []
    for k in range(total):
        own = rows[13 * k:13 * k + 13]
        for j, (at, values) in enumerate(own):
            if len(values) != (6 if j else 1):
                raise fault(path, at, f"station {k + 1} has {len(values)} numbers here",
                            "a station is a line with its place, then 12 lines of six numbers")
        places.append(own[0][1][0])
        named = f"{path}, station {k + 1} (line {own[0][0]}, eta {places[-1]:g})"
        K, M = (np.array([values for _, values in own[i:i + 6]]) for i in (1, 7))
        _check_symmetry(named, "stiffness", K)
        _check_symmetry(named, "mass", M)
        turned = np.ix_(ORDER, ORDER)
        sections.append(GeneralSection(K[turned], M[turned], retardation=mu[ORDER], name=named))
    eta = np.array(places)
    if total < 2 or abs(eta[0]) > 1e-9 or abs(eta[-1] - 1) > 1e-9 or (np.diff(eta) <= 0).any():
        wrong = next((k for k in range(1, total) if eta[k] <= eta[k - 1]), total - 1)
        raise InputError(f"{path}: stations have places from {eta[0]:g} to {eta[-1]:g}, the one of "
                         f"station {wrong + 1} is {eta[wrong]:g}: give two at least that ascend "
                         "from 0 to 1, parts of the length")
    eta[[0, -1]] = 0.0, 1.0
    return Stations(eta, sections)


def _check_symmetry(named: str, what: str, matrix: NDArray) -> None:
    """Refuse by the rows and columns of the file."""
    scale = np.sqrt(np.abs(np.outer(np.diag(matrix), np.diag(matrix))))
    off = np.abs(matrix - matrix.T) - 1e-6 * scale
    i, j = np.unravel_index(np.argmax(off), off.shape)
    if off[i, j] > 0:
        raise InputError(f"{named}: {what}[{i + 1}, {j + 1}] is {matrix[i, j]:g} and [{j + 1}, "
                         f"{i + 1}] {matrix[j, i]:g} ({TERMS[i]} and {TERMS[j]}): the matrix must "
                         "be symmetric, correct one of them")


def _retardation(path: Path, lines: list[str], remedy: str) -> NDArray:
    """mu of BeamDyn's six strains; zero without damping."""
    number, kind = _whole(path, lines, "damp_type", remedy)
    if kind == 0:
        return np.zeros(6)
    if kind != 1:
        raise fault(path, number, f"damp_type is {kind}", "damping by modes is that of one mesh of "
                    "BeamDyn: give 1 with mu1 to mu6, or 0 and damp the beam by damping=")
    end = next((k for k, line in enumerate(lines) if "DISTRIBUTED" in line.upper()), len(lines))
    for at, line in enumerate(lines[number:end], number + 1):
        values = _numbers(line)
        if values is not None and len(values) == 6:
            if min(values) < 0:
                raise fault(path, at, f"mu is {values}", "give times that are not negative [s]")
            return np.array(values)
    raise fault(path, number, "damp_type is 1, and no line with mu1 to mu6 follows", remedy)


def _check_units(path: Path, stations: Stations, length: float) -> None:
    """Refuse matrices whose entries contradict each other or the length of the blade."""
    before = None
    for one in stations.sections:
        K, M = np.diag(one.stiffness), np.diag(one.mass)
        by_stiffness, by_mass = np.sqrt(max(K[4:]) / K[0]), np.sqrt(max(M[4:]) / M[0])
        if by_mass > 0 and not 1 / ALIKE < by_stiffness / by_mass < ALIKE:
            raise InputError(
                f"{one.name}: mixed units: sqrt(EI/EA) is {by_stiffness:.3g} and the radius of "
                f"gyration by mass {by_mass:.3g}: give both matrices in {UNITS}")
        if by_stiffness > length:
            raise InputError(
                f"{one.name}: mixed units: sqrt(EI/EA) is {by_stiffness:.3g}, more than the length "
                f"{length:.3g} of the key points: give all in {UNITS}")
        if before is not None:
            for what, now, then in (("EA", K[0], np.diag(before.stiffness)[0]),
                                    ("mass", M[0], np.diag(before.mass)[0])):
                if not 1 / JUMP < now / then < JUMP:
                    raise InputError(f"{one.name}: mixed units: {what} is {now:.3g} after "
                                     f"{then:.3g} of the station before: give all in {UNITS}")
        before = one


def _doubts(path: Path, twist: NDArray, stations: Stations) -> Iterator[str]:
    size = np.abs(twist).max()
    if 0 < size < RADIANS:
        yield (f"{path.name}: the twist is at most {size:g} degrees; BeamDyn has degrees, check "
               "that these are not radians")
    root = twist[: max(1, len(twist) // 4)].mean()
    if root < 0 and root == min(root, twist[-max(1, len(twist) // 4):].mean()):
        yield (f"{path.name}: the twist is {root:g} degrees at the root and rises to the tip; it "
               "counts about minus z, so blades have positive ones at the root: check its sign, "
               "which moves edgewise frequencies by a per cent")
    for one in stations.sections:
        found = doubt(Material("of " + one.name.partition(", ")[2], one.wave_speed),
                      parsed_units(UNITS))
        if found is not None:
            yield "; ".join(found)
            return
