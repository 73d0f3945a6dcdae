"""The numbers of a body file: mass, rigid motion, frequencies, conditioning.

Matrices may be wrong in any way but shape, so nothing here builds a `ReducedBody`. They are
compared in unit-free form, as `sebody.reduction.checks` does.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eigh

from sebody.basics.errors import InputError
from sebody.io.body_file import BodyFile
from sebody.reduction.checks import (
    asymmetry,
    check_layout,
    coordinate_names,
    rigid_residual,
    unit_scale,
)
from sebody.reduction.massless import condensed, inert
from sebody.reduction.rigid_motions import rigid_motions
from sebody.reduction.weights import frame_weights
from sebody.runs.limits.thresholds import PERIOD

SHOWN = 12          # frequencies


@dataclass(frozen=True, eq=False)
class Matrices:
    """The reduced matrices of a file with the layout of their rows, made symmetric.

    Parameters
    ----------
    asymmetry : dict
        Largest unit-free difference across the diagonal of stiffness and mass, by name.
    rigid : (n, 6), planar (n, 3)
        Rigid motions about the mean of the boundary nodes.
    """

    stiffness: NDArray
    mass: NDArray
    coordinates: NDArray
    keeps: tuple[str, ...]
    names: list[str]
    asymmetry: dict[str, float]
    rigid: NDArray

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self.coordinates.shape[1]


def stiffening(file: BodyFile, body: Matrices) -> dict[str, int]:
    """Load modes and resultants of second order, and elastic motions that could have a resultant.

    Nothing of a body without constants of inertia.
    """
    i = file.parts.get("invariants")
    if i is None:
        return {}
    boundary = body.rigid[:len(body.rigid) - file.parts.get("modes", 0)]
    return {"load_modes": i.slaved, "resultants": i.resultants,
            "motions": len(boundary) - int(np.linalg.matrix_rank(boundary))}


def matrices_of(file: BodyFile) -> Matrices:
    """The matrices of a body file.

    Raises
    ------
    InputError
        Shapes that do not fit together, or numbers that are not finite.
    """
    parts = file.parts
    coordinates, keeps = np.asarray(parts["coordinates"], dtype=float), tuple(parts["keeps"])
    check_layout(coordinates, keeps)
    names = coordinate_names(keeps, coordinates.shape[1], parts.get("modes", 0), file.names)
    matrices, differences = {}, {}
    for name in ("stiffness", "mass"):
        matrix = np.asarray(parts[name], dtype=float)
        if matrix.shape != (len(names),) * 2:
            raise InputError(f"{name} has shape {matrix.shape}, but the layout of the file has "
                             f"{len(names)} coordinates: import the body again")
        if not np.isfinite(matrix).all():
            i, j = np.argwhere(~np.isfinite(matrix))[0]
            raise InputError(f"{name}[{i}, {j}] is {matrix[i, j]} ({names[i]}, {names[j]}): export "
                             "the matrix again")
        differences[name] = float(asymmetry(matrix, names, coordinates).max())
        matrices[name] = (matrix + matrix.T) / 2
    rigid = rigid_motions(coordinates, keeps, len(names), coordinates.mean(axis=0))
    return Matrices(**matrices, coordinates=coordinates, keeps=keeps, names=names,
                    asymmetry=differences, rigid=rigid)


def mass_properties(body: Matrices) -> dict:
    """Mass, centre, inertia about it, and how far R^T M R is from what geometry allows.

    ``R^T M R = [[m I, -m skew(c)], [m skew(c), J]]`` of a rigid body with any c and J: what it has
    else, relative to the mass and the size of the body, is a defect.
    """
    D = body.dimension
    gyration = body.rigid.T @ body.mass @ body.rigid
    mass = float(np.trace(gyration[:D, :D]) / D)
    size = float(np.ptp(body.coordinates, axis=0).max()) or 1.0
    defect = [np.abs(gyration[:D, :D] - mass * np.eye(D)).max()]
    moment = gyration[:D, D:]
    if D == 2:
        centre = np.array([moment[1, 0], -moment[0, 0]]) / mass
        inertia = gyration[2:, 2:] - mass * centre @ centre
    else:
        skew = (moment - moment.T) / 2
        defect.append(np.abs(moment + moment.T).max() / 2 / size)
        centre = np.array([skew[1, 2], skew[2, 0], skew[0, 1]]) / mass
        inertia = gyration[3:, 3:] - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    moments, axes = np.linalg.eigh(inertia)
    if D == 3:      # a right-handed triad, each axis with its largest component positive
        axes = axes * np.sign(axes[np.argmax(np.abs(axes), axis=0), range(3)])
        axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return {"mass": mass, "centre": centre + body.coordinates.mean(axis=0), "inertia": inertia,
            "principal_moments": moments, "principal_axes": axes,
            "mass_geometry_defect": float(max(defect) / abs(mass)) if mass else np.inf}


def rigid_residuals(body: Matrices) -> dict:
    """``|K r|`` over ``|K_B| |r|`` of every rigid motion, and the coordinate it is worst at."""
    motions = (["translation x", "translation y", "rotation"] if body.dimension == 2 else
               [f"{kind} {axis}" for kind in ("translation", "rotation") for axis in "xyz"])
    each = {name: rigid_residual(body.stiffness, body.rigid[:, [k]], body.names)[0]
            for k, name in enumerate(motions)}
    whole, row = rigid_residual(body.stiffness, body.rigid, body.names)
    return {"each": each, "largest": whole, "worst": body.names[row]}


def definiteness(body: Matrices) -> dict:
    """Lowest unit-free eigenvalues over the largest of stiffness and mass, condition numbers."""
    lowest = {}
    for name in ("stiffness", "mass"):
        matrix = getattr(body, name)
        scale = unit_scale(matrix, body.names)
        values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
        largest = np.abs(values).max() or 1.0
        lowest[name] = {"lowest": float(values[0] / largest),
                        "worst": body.names[int(np.argmax(np.abs(vectors[:, 0])))]}
        flexible = values[body.rigid.shape[1]:] if name == "stiffness" else values
        lowest[name]["condition"] = (float(largest / flexible[0]) if len(flexible)
                                     and flexible[0] > 0 else np.inf)
    return lowest


def frequencies(body: Matrices) -> dict:
    """Free vibrations: squares of all angular frequencies, and the first flexible ones in Hz.

    The lowest ones are those of rigid motion, as many as rigid motions that have inertia. Motions
    without mass follow the others statically; their number is ``following``.
    """
    try:
        squares, _, rigid, following = _vibrations(body)
    except LinAlgError:
        squares, rigid, following = np.zeros(0), 0, 0
    hertz = np.sqrt(np.abs(squares)) / (2 * np.pi)
    flexible = hertz[rigid:]
    last = flexible[-1] if len(flexible) else np.nan
    first = flexible[0] if len(flexible) else np.nan
    return {"rigid": hertz[:rigid], "flexible": flexible[:SHOWN], "count": len(flexible),
            "highest": float(last), "step_first": 1 / (PERIOD * first) if first > 0 else np.inf,
            "step_highest": 1 / (PERIOD * last) if last > 0 else np.inf, "following": following}


def clamped(body: Matrices, modes: int, centre: NDArray) -> dict:
    """Frequencies (k,) in Hz of vibrations with all interfaces held, and the part of the mass, and
    of the moments of inertia about the centre, that each moves, (k, motions); see `directions`.

    With shapes s of unit mass and rigid motions R, ``(R^T M s)^2`` over ``R^T M R``.
    """
    own = slice(len(body.mass) - modes, None)
    rigid = rigid_motions(body.coordinates, body.keeps, len(body.mass), centre)
    whole = np.diag(rigid.T @ body.mass @ rigid)
    try:
        squares, shapes = (eigh(body.stiffness[own, own], body.mass[own, own]) if modes else
                           (np.zeros(0), np.zeros((0, 0))))
    except LinAlgError:     # masses that are none, which findings name
        squares, shapes = np.zeros(0), np.zeros((modes, 0))
    parts = (rigid.T @ body.mass[:, own] @ shapes)**2 / np.where(whole > 0, whole, np.inf)[:, None]
    return {"frequencies": np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi), "parts": parts.T,
            "directions": ["x", "y", "about z"] if body.dimension == 2 else
            ["x", "y", "z", "about x", "about y", "about z"]}


def free_modes(body: Matrices, most: int) -> tuple[NDArray, NDArray]:
    """Frequencies (k,) in Hz of the lowest free vibrations, and their motions (n, k)."""
    try:
        squares, shapes, rigid, _ = _vibrations(body)
    except LinAlgError:
        return np.zeros(0), np.zeros((len(body.mass), 0))
    own = slice(rigid, rigid + most)
    return np.sqrt(np.maximum(squares[own], 0.0)) / (2 * np.pi), shapes[:, own]


def _vibrations(body: Matrices) -> tuple[NDArray, NDArray, int, int]:
    """Squares of frequencies, shapes, number of rigid motions among them, motions without mass."""
    own = condensed(body.mass, body.stiffness)
    if not own.following + own.bare:
        size = np.sqrt(np.outer(*[unit_scale(body.mass, body.names)] * 2))
        squares, shapes = eigh(body.stiffness / size, body.mass / size)
        return squares, shapes / np.sqrt(np.diag(size))[:, None], body.rigid.shape[1], 0
    squares, shapes = eigh((own.stiffness + own.stiffness.T) / 2, own.mass)
    return squares, own.motions @ shapes, inert(body.mass, body.rigid), own.following


def frame(body: Matrices, centre: NDArray) -> dict:
    """Weights of the position nodes in the mean frame, and its origin."""
    points = body.coordinates[[keep != "rotation" for keep in body.keeps]]
    weights = frame_weights(points, centre)
    origin = weights @ points
    return {"weights": weights, "origin": origin, "off_centre": float(np.linalg.norm(
        origin - centre)), "size": float(np.ptp(points, axis=0).max())}
