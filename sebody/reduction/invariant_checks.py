"""Checks of the constants of option C against the reduced matrices of their body.

The shapes contain the rigid motions, ``Phi y_t = E_t`` and ``Phi y_r = E_r``: all constants but K
and J2 follow from Mbar, and K and J2 on rigid translations, too.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.reduction.checks import NEGATIVE_STIFFNESS_LIMIT, unit_scale
from sebody.reduction.invariants import LENGTHS, InertiaInvariants

CONTRADICTION_LIMIT = 1e-6  # relative; matrices from files have some eight digits or more
_REMEDY = "compute both from one FE model, with the same modes in the same order"


def check_invariants(invariants: InertiaInvariants, stiffness: NDArray, mass: NDArray,
                     rigid: NDArray, names: list[str]) -> None:
    """Raise InputError unless the constants are of this body and its modes.

    Parameters
    ----------
    stiffness, mass : (n, n)
        Reduced matrices.
    rigid : (n, 6), planar (n, 3)
        Rigid motions about the constants' origin.
    names : list of str
        Of the n coordinates.
    """
    check_shapes(invariants, len(names))
    names = [*names, *(f"mode slaved {b}" for b in range(invariants.slaved))]
    scale = unit_scale(invariants.Mbar, names)
    n = len(mass)
    _compare("Mbar", invariants.Mbar[:n, :n], mass, scale[:n], scale[:n], "the reduced mass")
    for name, array in (("Q", invariants.Q), ("Ghat", invariants.Ghat)):
        if np.abs(array - array.transpose(0, 2, 1)).max(initial=0.0) > (
                CONTRADICTION_LIMIT * np.abs(array).max(initial=0.0)):
            raise InputError(f"invariants.{name} is not symmetric; use a geometric stiffness that "
                             "is the second derivative of an energy")
    _check_rigid(invariants, rigid, scale)
    _check_resultants(invariants, stiffness, scale[:n])


def check_shapes(invariants: InertiaInvariants, n: int) -> None:
    """Raise InputError unless the constants are finite and fit so many coordinates."""
    eta = invariants.slaved
    lengths = {"D": 2 if invariants.planar else 3, "r": 1 if invariants.planar else 3, "n": n,
               "N": n + eta, "slaved": eta, "resultants": invariants.resultants}
    for name, wanted in LENGTHS.items():
        array, shape = getattr(invariants, name), tuple(lengths[one] for one in wanted)
        if array.shape != shape:
            raise InputError(f"invariants.{name} has shape {array.shape}; {n} coordinates and "
                             f"{eta} slaved ones need {shape}")
        if not np.isfinite(array).all():
            raise InputError(f"invariants.{name} is not finite; compute it again")


def _check_rigid(invariants: InertiaInvariants, rigid: NDArray, scale: NDArray) -> None:
    """Check of Mbar on the rigid motions, and of what follows from it."""
    D = len(invariants.c0)
    whole = np.vstack([rigid, np.zeros((invariants.slaved, rigid.shape[1]))])
    momenta = whole.T @ invariants.Mbar             # (S1 ; g)
    rows = np.sqrt(np.diag(momenta @ whole))        # of unit rigid motions: kinetic energies
    still = np.full(D, rows[:D].max())
    turning = np.full(len(rows) - D, rows[D:].max(initial=0.0))
    by_mass = "the reduced mass"
    _compare("mass", np.array([[invariants.mass]]), (momenta @ whole)[:1, :1], still[:1],
             still[:1], by_mass)
    _compare("S1", invariants.S1, momenta[:D], still, scale, by_mass)
    _compare("g", invariants.g, momenta[D:], turning, scale, by_mass)
    _compare("J0", invariants.J0, momenta[D:] @ whole[:, D:], turning, turning, by_mass)
    moments = invariants.S1 @ whole[:, D:]          # e_i . (e_k x c0)
    arms = [_turned(k, invariants.c0) for k in range(len(invariants.J0))]
    _compare("c0", np.array(arms).T, moments, still, turning, by_mass)
    for k, row in enumerate(invariants.K):
        expected = np.array([_turned(k, e) @ invariants.S1 for e in np.eye(D)])
        _compare("K", whole[:, :D].T @ row, expected, still, scale, "S1")
    _check_quadratic(invariants, whole[:, :D], still, scale)


def _check_quadratic(invariants: InertiaInvariants, shifts: NDArray, still: NDArray,
                     scale: NDArray) -> None:
    """J2 on rigid translations: what two axes make of them, times S1."""
    D, axes = len(invariants.c0), range(len(invariants.J0))
    of_shifts = np.array([[_turned(k, one) for one in np.eye(D)] for k in axes])
    of_rows = np.array([[_turned(k, column) for column in invariants.S1.T] for k in axes])
    for k in axes:
        for other in axes:
            expected = (of_shifts[k] @ of_rows[other].T + of_shifts[other] @ of_rows[k].T) / 2
            _compare("J2", shifts.T @ invariants.J2[k, other], expected, still, scale, "S1")


def _check_resultants(invariants: InertiaInvariants, stiffness: NDArray, scale: NDArray) -> None:
    if not np.all(invariants.lam > 0):
        raise InputError(f"invariants.lam has {invariants.lam.min():.3g}; give positive "
                         "stiffnesses")
    rest = stiffness - (invariants.E * invariants.lam) @ invariants.E.T
    unit = np.outer(scale, scale)
    values = np.linalg.eigvalsh(rest / unit)
    largest = np.abs(np.linalg.eigvalsh(stiffness / unit)).max()
    if values[0] < -NEGATIVE_STIFFNESS_LIMIT * largest:
        raise InputError("invariants.lam and E give more stiffness than the body has (the "
                         f"smallest eigenvalue of the difference is {values[0]:.2e}, the "
                         f"largest of the body {largest:.2e}); {_REMEDY}")


def _compare(name: str, found: NDArray, expected: NDArray, rows: NDArray, columns: NDArray,
             other: str) -> None:
    unit = np.outer(rows, columns)
    defect = np.abs(found - expected) / np.where(unit > 0, unit, 1.0)
    if defect.max(initial=0.0) > CONTRADICTION_LIMIT:
        place = tuple(int(i) for i in np.unravel_index(np.argmax(defect), defect.shape))
        raise InputError(f"invariants.{name} contradicts {other}: {found[place]:.6g} in place of "
                         f"{expected[place]:.6g} at {place}; {_REMEDY}")


def _turned(axis: int, vector: NDArray) -> NDArray:
    """``e_k x v``."""
    if len(vector) == 2:
        return np.array([-vector[1], vector[0]])
    return np.cross(np.eye(3)[axis], vector)
