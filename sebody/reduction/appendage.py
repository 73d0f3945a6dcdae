"""Bodies given by participation factors: panels of satellites, sloshing, equipment on a floor.

A structure that hangs on one interface is told by its rigid mass M_RR about this interface, the
frequencies of its vibrations with the interface held, and their participation factors
``L = Phi^T M R`` in motions of the interface. Its kinetic and strain energy are

    T = (v^T M_RR v + 2 eta'^T L v + eta'^T eta') / 2,  V = sum omega_k^2 eta_k^2 / 2

with the interface's velocity v and modes of unit modal mass, which is all that a reduction with one
boundary node has. ``sum L_k^T L_k`` is the effective mass of the modes, at most M_RR; what is left
moves with the interface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.reduction.body import ReducedBody
from sebody.reduction.checks import NEGATIVE_MASS_LIMIT


def appendage(masses: ArrayLike, frequencies: ArrayLike, participation: ArrayLike,
              damping: float | Sequence[float] = 0.0, *, point: ArrayLike | None = None,
              units: str = "") -> ReducedBody:
    """Superelement with one interface from participation factors.

    Parameters
    ----------
    masses : float, (6,) or (6, 6), planar (3,) or (3, 3)
        Rigid mass about the interface: of translations x, y, z, then rotations; a number is a mass
        at the interface without inertia [mass], in space.
    frequencies : (modes,)
        Of the vibrations with the interface held [1/time], in cycles.
    participation : (modes, 6), planar (modes, 3)
        Factors of modes of unit modal mass, columns as the rows of the rigid mass: of an
        oscillating mass m at the arm r in the direction d ``sqrt(m) (d, r x d)``.
    damping : float or sequence of float
        Part of critical damping of all modes, or of each.
    point : (3,), planar (2,), optional
        Place of the interface [length]; the origin by default.
    units : str
        Units of its numbers, such as ``m kg N s``.

    Raises
    ------
    InputError
        Shapes that do not fit, frequencies that are not positive, or modes with more effective mass
        than the body has.
    """
    squares = _squares(frequencies)
    rigid, axes = _rigid_mass(masses)
    L = inputs.array(participation, "participation", (len(squares), axes))
    _check_effective(rigid, L)
    ratios = inputs.vector(np.atleast_1d(np.asarray(damping, dtype=object)), "damping")
    if len(ratios) not in (1, len(squares)) or (ratios < 0).any():
        raise inputs.refusal("damping", damping, "give a ratio >= 0, or one for each of "
                             f"{len(squares)} modes")
    dimension = 3 if axes == 6 else 2
    at = np.zeros(dimension) if point is None else inputs.vector(point, "point", dimension)
    n = axes + len(squares)
    K, C, M = np.zeros((n, n)), np.zeros((n, n)), np.eye(n)
    K[axes:, axes:] = np.diag(squares)
    C[axes:, axes:] = np.diag(2.0 * ratios * np.sqrt(squares))
    M[:axes, :axes], M[axes:, :axes], M[:axes, axes:] = rigid, L, L.T
    return ReducedBody(K, M, at[None], ("full",), len(squares), C if ratios.any() else None,
                       units=units, notes=("of participation factors of one interface",))


def _squares(frequencies: ArrayLike) -> NDArray:
    """Squares of the angular frequencies."""
    given = inputs.vector(frequencies, "frequencies", remedy="give a positive number for each mode")
    if not len(given) or not (given > 0).all():
        raise inputs.refusal("frequencies", frequencies, "give a positive number for each mode")
    return (2.0 * np.pi * given)**2


def _rigid_mass(masses: ArrayLike) -> tuple[NDArray, int]:
    """The rigid mass as a matrix, and its size."""
    remedy = "give a mass, its 6 (planar 3) diagonal entries, or a 6 x 6 (planar 3 x 3) matrix"
    given = inputs.reals(masses, "masses", remedy)
    if given.ndim == 0:
        given = np.r_[np.full(3, given), np.zeros(3)]
    rigid = np.diag(given) if given.ndim == 1 else given
    if rigid.shape not in ((6, 6), (3, 3)) or not np.isfinite(rigid).all():
        raise InputError(f"masses has shape {np.shape(masses)}: {remedy} of finite numbers")
    if np.abs(rigid - rigid.T).max() > 1e-9 * np.abs(rigid).max():
        raise InputError("masses is not symmetric: mirror one triangle")
    return (rigid + rigid.T) / 2, len(rigid)


def _check_effective(rigid: NDArray, L: NDArray) -> None:
    """Refuse modes that have more effective mass than the body."""
    scale = np.sqrt(np.diag(rigid).clip(0.0))
    scale[scale == 0.0] = np.sqrt(np.abs(L).max(initial=0.0)**2 or 1.0)
    values, vectors = np.linalg.eigh((rigid - L.T @ L) / np.outer(scale, scale))
    if values[0] < -NEGATIVE_MASS_LIMIT:
        names = ("x", "y", "z", "rx", "ry", "rz") if len(rigid) == 6 else ("x", "y", "rz")
        k = int(np.argmax(np.abs(vectors[:, 0])))
        effective = float((L[:, k]**2).sum())
        raise InputError(f"the modes have the effective mass {effective:.6g} in {names[k]}, and "
                         f"masses {rigid[k, k]:.6g}: the participation factors are of modes of "
                         "unit modal mass, and their sum of squares is at most the rigid mass")
