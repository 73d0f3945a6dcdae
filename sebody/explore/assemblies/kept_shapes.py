"""Shapes of a linearized model that a superelement keeps: static ones, and internal modes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from sebody.basics.errors import InputError
from sebody.reduction.accuracy import Accuracy
from sebody.reduction.clamped import canonical_turn
from sebody.reduction.massless import condensed

DEPENDENT = 1e-9        # singular value of the rows of interfaces, of the largest, that is none
LOOSE = 1e-12           # stiffness of an internal motion, of the stiffest, that is none


class Kept(NamedTuple):
    """Motion of the coordinates by reduced ones, interfaces first."""

    shapes: NDArray         # (m, n)
    modes: int
    flexibility: NDArray    # (m, m) static motion by forces, with the interfaces at rest
    omega: NDArray          # (modes,) their angular frequencies, and
    omitted: float          # that of the first which was left out; infinite if none was


class LooseInside(InputError):
    """A motion inside without stiffness: its shape."""

    def __init__(self, shape: NDArray):
        super().__init__("a motion inside has no stiffness")
        self.shape = shape


def kept_shapes(M: NDArray, K: NDArray, B: NDArray, free: NDArray, modes: int | Accuracy | None
                ) -> Kept:
    """Equations (1) to (3): static shapes of the interfaces, and modes with these at rest.

    Parameters
    ----------
    M, K : (m, m)
        Symmetric.
    B : (b, m)
        Rows of the interfaces.
    free : (unknowns, m)
        Motion of the unknowns, by which signs of modes are chosen.
    modes : int or Accuracy, optional
        All by default.

    Raises
    ------
    InputError
        Interfaces that are tied to each other, or more modes than there are.
    LooseInside
        A motion that the interfaces do not hold.
    """
    b = len(B)
    sizes = np.linalg.svd(B / np.linalg.norm(B, axis=1)[:, None], compute_uv=False)
    if b > B.shape[1] or sizes[-1] < DEPENDENT * sizes[0]:
        raise InputError("the interfaces are tied to each other, by rigid links, welds or joints: "
                         "leave one of them out, or let it keep its 'translation' or 'rotation'")
    N, P = null_space(B), np.linalg.pinv(B)
    own = (N.T @ K @ N + N.T @ K.T @ N) / 2
    unit = np.sqrt(np.abs(np.diag(own)))
    unit[unit == 0.0] = 1.0
    values, vectors = np.linalg.eigh(own / np.outer(unit, unit))
    if len(values) and values[0] < LOOSE * values[-1]:
        raise LooseInside(N @ (vectors[:, 0] / unit))
    inverse = (vectors / np.where(values, values, 1.0)) @ vectors.T / np.outer(unit, unit)
    flexibility = N @ inverse @ N.T
    static = P - flexibility @ (K @ P)
    static -= flexibility @ (K @ static)        # once more, for the last digits
    shapes, squares = _vibrations(N.T @ M @ N, own)
    shapes = N @ shapes
    count = _count(modes, static, shapes, squares, M, K)
    if count > len(squares):
        raise InputError(f"modes is {count}, and with its interfaces at rest the model has "
                         f"{len(squares)} vibrations: give this number or fewer")
    turn = canonical_turn(squares[:count], free @ shapes[:, :count])
    omega = np.sqrt(squares)
    return Kept(np.hstack([static, shapes[:, :count] @ turn]), count, flexibility, omega[:count],
                omega[count] if count < len(omega) else np.inf)


def _vibrations(M: NDArray, K: NDArray) -> tuple[NDArray, NDArray]:
    """Mass-normalised shapes, and squares of their frequencies; what has no mass follows."""
    if not len(M):
        return np.zeros((0, 0)), np.zeros(0)
    found = condensed((M + M.T) / 2, K)
    mass, stiffness = ((A + A.T) / 2 for A in (found.mass, found.stiffness))
    squares, vectors = eigh(stiffness, mass)
    return found.motions @ vectors, squares


def _count(modes: int | Accuracy | None, static: NDArray, shapes: NDArray, squares: NDArray,
           M: NDArray, K: NDArray) -> int:
    """Number of modes: that given, all, or as many as an accuracy needs."""
    if modes is None:
        return len(squares)
    if not isinstance(modes, Accuracy):
        return modes
    of_frequencies = modes.of == "frequencies"
    error = _of_frequencies if of_frequencies else _of_stiffness
    low, high = int(np.sum(squares < modes.omega**2)), len(squares)
    parts = [A @ B @ C for A, B, C in (
        (static.T, M, static), (static.T, K, static), (static.T, M, shapes))]
    while low < high:           # errors fall with every mode
        middle = (low + high) // 2
        if error(middle, modes, squares, *parts) <= modes.tolerance:
            high = middle
        else:
            low = middle + 1
    return low


def _of_stiffness(count: int, accuracy: Accuracy, squares: NDArray, M: NDArray, K: NDArray,
                  coupling: NDArray) -> float:
    """Work of omitted modes, of any motion of the interfaces, over its energies without modes.
    """
    w = accuracy.omega**2
    rest = coupling[:, count:]
    lost = (w**2 * rest / (squares[count:] - w)) @ rest.T
    return float(eigh(lost, (K + K.T) / 2 + w * (M + M.T) / 2, eigvals_only=True)[-1])


def _of_frequencies(count: int, accuracy: Accuracy, squares: NDArray, M: NDArray, K: NDArray,
                    coupling: NDArray) -> float:
    """Largest relative error of a free frequency of the band."""
    def free(n: int) -> NDArray:
        mass = np.block([[M, coupling[:, :n]], [coupling[:, :n].T, np.eye(n)]])
        stiffness = np.block([[K, np.zeros((len(K), n))], [np.zeros((n, len(K))),
                                                           np.diag(squares[:n])]])
        return np.sqrt(np.maximum(eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2,
                                       eigvals_only=True), 0.0))
    exact, found = free(len(squares)), free(count)
    band = (exact > 1e-6 * exact[-1]) & (exact <= accuracy.omega)
    band = band[:len(found)]
    return float(np.max(found[band] / exact[:len(found)][band] - 1.0, initial=0.0))
