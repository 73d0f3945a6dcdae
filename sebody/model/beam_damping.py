"""Damping of a whole beam by its material, the same however the beam is divided.

Stresses follow strains and, by a retardation time, their rates: Kelvin and Voigt's material. Such a
beam has the damping ``beta K``, body by body and element by element, so a vibration of the
frequency w has the ratio ``beta w / 2`` of critical damping, with any division and any supports.
Tension, torsion and bending in either plane have times of their own, from the ratio wanted of a
named mode of each.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.section_along import section_at
from sebody.model.beam_pieces import AxisPiece, Course, StraightPiece
from sebody.reduction.body import ReducedBody

ELEMENTS = 32           # of the whole beam whose frequencies are taken: right to 1e-4 and better
NAMED = re.compile(r"(free|clamped|hinged) ([1-9])")
REMEDY = ("give a ratio of critical damping >= 0, or (ratio, mode) with a mode such as 'clamped 1' "
          "or an angular frequency")

Times = tuple[float, ...]       # of tension, bending in the planes of y and z, torsion
Damping: TypeAlias = float | tuple[float, str | float]


def retardation_times(damping: Damping, name: str, course: Course) -> Times:
    """Retardation times of each kind of deformation, one for all where they are coupled.

    Parameters
    ----------
    damping : float or (float, str or float)
        See `Model.beam`.
    name : str
        Of the beam.
    course : Course
        The whole beam.

    Returns
    -------
    tuple of float
        None at all without damping.

    Raises
    ------
    InputError
        No such damping, or sections that have retardation times of their own.
    """
    what = f"beam {name!r}: damping"
    pair = damping if isinstance(damping, tuple | list) else (damping, "free 1")
    if len(pair) != 2 or isinstance(pair[0], str):
        raise inputs.refusal(what, damping, REMEDY)
    ratio, mode = inputs.number(pair[0], what, least=0, remedy=REMEDY), pair[1]
    if ratio == 0.0:
        return ()
    if section_at(course.section, 0.5).damping.any():
        raise InputError(f"{what} is {damping!r}, and its sections have retardation times of their "
                         "own: leave one of both out")
    kinds = 1 if course.coupled else 2 if course.model.planar else 4
    if not isinstance(mode, str):
        omega = inputs.number(mode, f"{what}: frequency", above=0, remedy=REMEDY)
        return (2.0 * ratio / omega,) * kinds
    named = NAMED.fullmatch(mode)
    if not named:
        raise InputError(f"{what}: mode is {mode!r}: give 'free 1', 'clamped 1' (at the first "
                         "end), 'hinged 1' or another number up to 9")
    if course.coupled and named[1] == "hinged":
        raise InputError(f"{what}: mode is {mode!r}, and tension, torsion and bending of this beam "
                         "are coupled: give 'free 1', 'clamped 1' or an angular frequency")
    piece = course.piece(0.0, 1.0, ELEMENTS)
    arguments = piece, course.coupled, named[1], int(named[2])
    try:
        frequencies = _frequencies(*arguments)
    except TypeError:       # a section that has no hash
        frequencies = _frequencies.__wrapped__(*arguments)
    return tuple(2.0 * ratio / omega if omega else 0.0 for omega in frequencies)


def damped(body: ReducedBody, times: Times) -> ReducedBody:
    """A superelement of a beam along x with the damping of its material, ``D K D``.

    D takes the root of the time of each kind from coordinates along the beam's axes, and from
    internal modes by the kind of motion that their inertia couples with; it maps rigid motions to
    rigid ones, which are not damped.

    Parameters
    ----------
    times : tuple of float
        See `retardation_times`.
    """
    if len(times) == 1:     # coupled: of all strains
        return replace(body, damping=times[0] * body.stiffness)
    kinds = _kinds(body.planar)
    roots = np.sqrt(times)
    blocks = [sum(root * axes[kind] for root, axes in zip(roots, kinds, strict=True))
              for kind, count in (("position", len(body.position_nodes)),
                                  ("rotation", len(body.rotation_nodes))) for _ in range(count)]
    bound = sum(len(block) for block in blocks)
    D = np.zeros_like(body.stiffness)
    at = 0
    for block in blocks:
        D[at:at + len(block), at:at + len(block)] = block
        at += len(block)
    for k in range(bound, bound + body.modes):
        shares = np.array([_share(body, axes, body.mass[:bound, k]) for axes in kinds])
        D[k, k] = np.sqrt(shares @ np.array(times) / max(shares.sum(), 1e-300))
    matrix = D @ body.stiffness @ D
    return replace(body, damping=(matrix + matrix.T) / 2)


def _share(body: ReducedBody, axes: dict[str, NDArray], momenta: NDArray) -> float:
    """Square of the part of some momenta of the boundary that belongs to a kind of motion."""
    total, at = 0.0, 0
    scale = np.ptp(body.coordinates, axis=0).max()
    for kind, nodes in (("position", body.position_nodes), ("rotation", body.rotation_nodes)):
        for _ in nodes:
            size = len(axes[kind])
            one = axes[kind] @ momenta[at:at + size]
            total += float(one @ one) * (1.0 if kind == "position" else 1.0 / scale**2)
            at += size
    return total


def _kinds(planar: bool) -> list[dict[str, NDArray]]:
    """Projections of positions and rotations to tension, bending along y and z, and torsion."""
    if planar:
        along = np.diag([1.0, 0.0])
        return [{"position": along, "rotation": np.zeros((1, 1))},
                {"position": np.eye(2) - along, "rotation": np.ones((1, 1))}]
    x, y, z = (np.outer(axis, axis) for axis in np.eye(3))
    none = np.zeros((3, 3))
    return [{"position": x, "rotation": none}, {"position": y, "rotation": z},
            {"position": z, "rotation": y}, {"position": none, "rotation": x}]


@lru_cache(maxsize=64, typed=True)
def _frequencies(piece: StraightPiece | AxisPiece, coupled: bool, held: str, number: int) -> Times:
    """Angular frequency of the mode of a number of each kind; 0 where nothing has mass."""
    fe_model = piece.fe_model()
    K, M = fe_model.stiffness.toarray(), fe_model.mass.toarray()
    if coupled:
        free = slice(6 if held == "clamped" else 0, None)
        squares = eigh(K[free, free], M[free, free], eigvals_only=True)
        return (float(np.sqrt(squares[number - 1 + (6 if held == "free" else 0)])),)
    return tuple(_frequency(K, M, axes, held, number)
                 for axes in _kinds(fe_model.coordinates.shape[1] == 2))


def _frequency(K: NDArray, M: NDArray, axes: dict[str, NDArray], held: str, number: int) -> float:
    """Frequency of one kind of motion of a whole beam, held at its ends."""
    columns = [np.linalg.svd(axes[kind])[0][:, :round(np.trace(axes[kind]))]
               for kind in ("position", "rotation")]
    d, turns = len(axes["position"]), len(axes["rotation"])
    size = columns[0].shape[1] + columns[1].shape[1]
    one = np.zeros((d + turns, size))
    one[:d, :columns[0].shape[1]], one[d:, columns[0].shape[1]:] = columns
    nodes = len(K) // (d + turns)
    basis = np.kron(np.eye(nodes), one)
    fixed = {"free": [], "clamped": range(size),
             "hinged": [0, (nodes - 1) * size]}[held]    # tension and torsion have one coordinate
    basis = np.delete(basis, list(fixed), axis=1)
    mass = basis.T @ M @ basis
    if not np.any(mass):
        return 0.0
    rigid = size if held == "free" else 0      # a shift, and of bending a turn
    squares = eigh(basis.T @ K @ basis, mass, eigvals_only=True)
    return float(np.sqrt(squares[rigid + number - 1]))
