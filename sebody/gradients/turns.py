"""Variations of rotations in a step: ``R' = R exp(psi)``, in material axes.

    (6) xi' = H xi + T dy,  H = exp(-psi),  T = I - c2 skew(psi) + c3 skew(psi)^2

of rotations in space; of positions, modes, angles and multipliers both are one.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.compiler.decorators import compiled
from sebody.kernels.rotations import tangent_operator
from sebody.results import rotations


def turns_of(places: NDArray, increments: NDArray) -> "list[Turns]":
    """H and T of some steps.

    Parameters
    ----------
    places : (r, 3)
        Unknowns of every rotation.
    increments : (steps, r, 3)
        psi of the steps.
    """
    if not len(places):
        none = np.zeros((0, 3, 3))
        return [Turns(places, none, none)] * len(increments)
    psi = increments.reshape(-1, 3)
    H = rotations.matrices(-psi).reshape(*increments.shape, 3)
    T = _tangent_operators(psi).reshape(*increments.shape, 3)
    return [Turns(places, *both) for both in zip(H, T, strict=True)]


class Turns(NamedTuple):
    """H and T of a step."""

    places: NDArray     # (r, 3) unknowns of every rotation
    H: NDArray          # (r, 3, 3)
    T: NDArray          # (r, 3, 3)

    def moved(self, xi: NDArray) -> NDArray:
        """``H xi`` of columns (n, m)."""
        return self._turned(xi, "rij,rjm->rim", self.H)

    def moved_back(self, X: NDArray) -> NDArray:
        """``H^T X``."""
        return self._turned(X, "rji,rjm->rim", self.H)

    def turned(self, dy: NDArray) -> NDArray:
        """``T dy``."""
        return self._turned(dy, "rij,rjm->rim", self.T)

    def turned_back(self, X: NDArray) -> NDArray:
        """``T^T X``."""
        return self._turned(X, "rji,rjm->rim", self.T)

    def of_columns(self, K: NDArray | sparse.csc_array) -> NDArray | sparse.csc_array:
        """``K T``."""
        if not len(self.places):
            return K
        if not isinstance(K, np.ndarray):
            return K @ self._matrix(K.shape[0])
        found = K.copy()
        found[:, self.places] = np.einsum("nri,rij->nrj", K[:, self.places], self.T)
        return found

    def _turned(self, x: NDArray, what: str, operators: NDArray) -> NDArray:
        found = x.copy()
        if len(self.places):
            found[self.places] = np.einsum(what, operators, x[self.places])
        return found

    def _matrix(self, n: int) -> sparse.csc_array:
        ordinary = np.setdiff1d(np.arange(n), self.places)
        rows, columns = np.broadcast_arrays(self.places[:, :, None], self.places[:, None, :])
        return sparse.csc_array((
            np.concatenate([np.ones(len(ordinary)), self.T.ravel()]),
            (np.concatenate([ordinary, rows.ravel()]),
             np.concatenate([ordinary, columns.ravel()]))), shape=(n, n))


@compiled
def _tangent_operators(psi):
    """T of increments (r, 3), row by row."""
    found = np.empty((psi.shape[0], 9))
    for k in range(psi.shape[0]):
        entries = tangent_operator(psi[k, 0], psi[k, 1], psi[k, 2])
        for i in range(9):
            found[k, i] = entries[i]
    return found
