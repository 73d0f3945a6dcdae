"""Axes of a body in which its constants have the most zeros, and the order that gathers them.

In axes along a beam and across it, bending in one plane, bending in the other one, torsion and
stretching are apart: nine tenths of its constants are zeros.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from sebody.contract.counts import Counts
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.massless import units

# Of what an inertia, or a geometric stiffness beside inertias, can be. High modes are exact to
# 1e-16 of the ratio of squared frequencies: with a hundred modes a beam is left with 1e-10 in place
# of zeros, and true entries begin at 1e-8.
ROUNDING = 1e-9
STIFF = 1e-13           # the same of a stiffness: strains are small differences of large forces
CLEAR = 0.43            # of a unit vector: its largest component is more; no usual sine or cosine
SUMMED = 8 * 2.2e-16    # of what a sum would be if all its terms had one sign
LIGHT = 1e-6            # root of a mass that is rounding, over that of a usual one of its stiffness
COUPLED = 1e-6          # less than this part of what they can be leaves coordinates apart


def body_axes(invariants: InertiaInvariants, counts: Counts) -> NDArray:
    """The axes, columns, (D, D): of some candidates those with the most zeros in the mass."""
    candidates = list(_candidates(invariants))
    by = np.stack([of_coordinates(turn.T, counts) for turn in candidates])
    n = by.shape[1]
    mass = np.abs(by @ invariants.Mbar[:n, :n] @ by.transpose(0, 2, 1))
    size = np.sqrt(mass.diagonal(axis1=1, axis2=2))
    limits = size[:, :, None] * size[:, None, :]
    largest = (mass / np.where(limits > 0, limits, 1.0)).max(axis=(1, 2))
    filled = (mass > COUPLED * largest[:, None, None] * limits).sum(axis=(1, 2))
    return candidates[int(filled.argmin())]


def _candidates(i: InertiaInvariants) -> Iterator[NDArray]:
    """Those of the frame, axes along the motion of the modes, and principal axes.

    The last two are the same for a beam, whose principal axes across it have more rounding, as its
    moments of inertia about them are nearly equal.
    """
    D = len(i.c0)
    yield np.eye(D)
    centre = i.c0 / i.mass
    if D == 2:
        for x, y in _directions(i.S1.T):
            yield np.array([[x, -y], [y, x]])
        return
    principal = np.linalg.eigh(i.J0 - i.mass * (centre @ centre * np.eye(3)
                                                - np.outer(centre, centre)))[1]
    principal = _signed(principal)
    others = _directions(np.vstack([i.S1.T, i.g.T]))
    for along in principal.T:
        for other in others:
            across = other - along * (along @ other)
            size = np.linalg.norm(across)
            if size > 0.5:
                across /= size
                yield np.column_stack([along, across, _cross(along, across)])
    yield principal * np.linalg.det(principal)


def _signed(axes: NDArray) -> NDArray:
    """The same columns, each with a sign that does not depend on rounding.

    A body of another mass has the same axes then, and its constants are in proportion.
    """
    first = (np.abs(axes) > CLEAR).argmax(axis=0)
    return axes * np.sign(axes[first, range(axes.shape[1])])


def _cross(a: NDArray, b: NDArray) -> list[float]:
    """The vector product: NumPy's own takes ten times as long for single vectors."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return [y * w - z * v, z * u - x * w, x * v - y * u]


def _directions(vectors: NDArray) -> list[NDArray]:
    """Different directions among some vectors."""
    sizes = np.linalg.norm(vectors, axis=1)
    kept = sizes > 1e-6 * sizes.max()
    units = vectors[kept] / sizes[kept, None]
    cosines, different = np.abs(units @ units.T), []
    for k in range(len(units)):
        if not (cosines[k, different] >= 1 - 1e-6).any():
            different.append(k)
    return [units[k] for k in different]


def of_coordinates(rotation: NDArray, counts: Counts) -> NDArray:
    """The rotation of all local coordinates, (n, n), from that of a vector."""
    n, D = counts["n"], len(rotation)
    whole = np.eye(n)
    vectors = counts["bound"] if D == 3 else 2 * counts["N_POSITIONS"]
    for first in range(0, vectors, D):
        whole[first:first + D, first:first + D] = rotation
    return whole


def grouped(mass: NDArray, stiffness: NDArray) -> NDArray:
    """An order of the coordinates in which those coupled by mass or stiffness are together.

    Those coupled with slaved coordinates, which follow, are last.
    """
    free, N = len(stiffness), len(mass)
    coupled = _cleared(mass, COUPLED) != 0.0
    coupled[:free, :free] |= _cleared(stiffness, COUPLED) != 0.0
    labels = connected_components(coupled, directed=False)[1]
    slaved = np.isin(labels[:free], labels[free:N])
    sizes = np.bincount(labels)[labels[:free]]
    return np.lexsort((np.arange(free), labels[:free], -sizes, slaved))


def without_rounding(values: InertiaInvariants, of_stresses: float, stiffness: NDArray
                     ) -> InertiaInvariants:
    """Constants with zeros where rotations and sums leave but rounding.

    What an entry can be follows from the sizes of its coordinates' displacements. Rates have no
    larger mass, but slaved coordinates may have one of rounding where the rates count by their
    rigid part (`InertiaInvariants.rigidly_followed`), as in symmetric bodies. Coordinates without
    mass, as rotations of lumped masses, count by their stiffness: beside masses that are rounding
    all else would be.

    Parameters
    ----------
    of_stresses : float
        The same as `ROUNDING`, of geometric stiffnesses.
    stiffness : (n, n)
    """
    i, n = values, len(values.E)
    of_z = np.sqrt(np.maximum(np.abs(np.diag(i.Mbar)), np.abs(np.einsum("kkii->i", i.J2))))
    size = units(i.Mbar[:n, :n], stiffness)
    size = size * np.median(of_z[:n] / size)
    of_z[:n] = np.where(of_z[:n] > LIGHT * size, of_z[:n], size)
    Ghat = [_small(one, of_z[:n], of_stresses) for one in i.Ghat]
    return replace(
        i, K=_small(i.K, of_z, ROUNDING), J2=_small(i.J2, of_z, ROUNDING),
        Mbar=_small(i.Mbar, of_z, ROUNDING), Q=_small(i.Q, of_z[:n], ROUNDING),
        Ghat=np.array(Ghat).reshape(i.Ghat.shape))


def stiff_of(stiffness: NDArray, basis: NDArray) -> NDArray:
    """A stiffness or damping on other coordinates, with zeros where sums leave but rounding.

    Parameters
    ----------
    stiffness : (n, n)
    basis : (n, m)
        What the other coordinates move.
    """
    made, size = basis.T @ stiffness @ basis, np.abs(basis)
    rounding = SUMMED * (size.T @ np.abs(stiffness) @ size)
    return _cleared(np.where(np.abs(made) > rounding, made, 0.0), STIFF)


def _cleared(matrix: NDArray, limit: float) -> NDArray:
    """A positive semidefinite matrix without entries that are rounding."""
    return _small(matrix, np.sqrt(np.abs(np.diag(matrix))), limit)


def _small(matrices: NDArray, scale: NDArray, limit: float) -> NDArray:
    """Matrices without entries that are rounding of the largest one, in units of some scales."""
    limits, sizes = np.outer(scale, scale), np.abs(matrices)
    largest = np.divide(sizes, limits, out=np.zeros_like(sizes), where=limits > 0).max(initial=0.0)
    return np.where(sizes > limit * largest * limits, matrices, 0.0)
