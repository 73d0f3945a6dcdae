"""Effect of modes that a body of Craig and Bampton leaves out.

With all modes, ``D(w) = K - w^2 M - w^4 sum_j p_j p_j^T / (w_j^2 - w^2)`` is the exact dynamic
stiffness of the interface, K and M reduced to constraint modes Psi, ``p_j = Psi^T M phi_j``.
Leaving out the modes above the n-th leaves out

    E(w) = w^4 sum_{j > n} p_j p_j^T / (w_j^2 - w^2),

positive semidefinite below the next mode and growing with w. Beside the modes computed, sums over
all others are known: with ``Y = M Psi - M Phi p`` and the static response S of the clamped body,

    sum p p^T / w_j^2 = Y^T S Y,    sum p p^T / w_j^4 = Y^T S M S Y,

so that E lies between ``w^4 (S1 + w^2 S2)`` and ``w^4 (S1 + w^2 S2 / (1 - w^2 / w_N^2))``, of which
the upper is taken; w_N is the last mode computed.

The error of the dynamic stiffness is that of the work of any interface motion b, relative to strain
and kinetic energy: the largest ``b^T E b / b^T (K + w^2 M) b``, no matter which units or axes. It
grows with w, so it is largest at the end of a band. The relative error of a free frequency is to
first order ``b^T E(w) b / 2 w^2`` of its own motion b of the interface, at unit modal mass, which
is less: free motions are some of all.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse

from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.component import ComponentModes

_BEYOND = 1.2   # last mode computed over the end of the band, so that the two bounds are close
_UNCOUPLED = 1e-12  # part of the energy by which a mode that the interface does not move takes part
_HALVINGS = 40      # of a band of frequencies
_RIGID = 1e-6       # square of a free frequency that is one of rigid motion, of the largest
_SHIFT = 1e-7       # of the stiffness by the mass, of their ratio, so that rigid motions resist


class Omission:
    """Bounds of all modes of a clamped body of which `wanted` are computed.

    Parameters
    ----------
    static : ComponentModes
        Constraint modes.
    interior : ClampedInterior
    matrices : pair of (n_dofs, n_dofs), sparse
        Stiffness and mass.
    wanted : int
        Modes to compute; fewer if there are no more.
    """

    def __init__(self, static: ComponentModes, interior: ClampedInterior,
                 matrices: tuple[sparse.csc_array, sparse.csc_array], wanted: int):
        mass = matrices[1]
        self.stiffness, self.mass = static.project(*matrices)
        self.squares, shapes = interior.lowest(wanted)
        momenta = mass @ static.constraint
        self.parts = shapes.T @ momenta
        self.complete = len(self.squares) < wanted
        self._first = self._second = np.zeros(self.stiffness.shape)
        if not self.complete:
            rest = momenta - mass @ (shapes @ self.parts)
            answers = interior.displacement(rest)
            self._first, self._second = rest.T @ answers, answers.T @ (mass @ answers)
        self._coupled = np.array([
            square * (part @ linalg.solve(self.stiffness + square * self.mass, part,
                                          assume_a="pos")) > _UNCOUPLED
            for square, part in zip(self.squares, self.parts, strict=True)], dtype=bool)

    def covers(self, omega: float) -> bool:
        """Tell whether enough modes are computed to tell errors up to an angular frequency."""
        return self.complete or self.squares[-1] >= (_BEYOND * omega)**2

    def _rest(self, square: float) -> NDArray:
        """E of the modes that are not computed."""
        if self.complete:
            return self._first
        return square**2 * (self._first + square / (1 - square / self.squares[-1]) * self._second)

    def stiffness_errors(self, omega: float) -> NDArray:
        """Errors of the dynamic stiffness up to `omega` with 0, 1, ... modes, (computed + 1,).

        Infinite where a mode below `omega` is left out, and where too few modes are computed.
        """
        errors = np.full(len(self.squares) + 1, np.inf)
        if not self.covers(omega):
            return errors
        omitted = self._rest(omega**2)
        for count in range(len(self.squares), -1, -1):
            errors[count] = self._largest(omitted, omega**2)
            if not count:
                break
            square, part = self.squares[count - 1], self.parts[count - 1]
            if square > omega**2:
                omitted = omitted + omega**4 / (square - omega**2) * np.outer(part, part)
            elif self._coupled[count - 1]:
                break
        return errors

    def _largest(self, omitted: NDArray, square: float) -> float:
        norm = self.stiffness + square * self.mass
        return max(float(linalg.eigh(omitted, norm, eigvals_only=True)[-1]), 0.0)

    def frequency_errors(self, omega: float) -> NDArray:
        """Largest relative errors of the free frequencies up to `omega` with 0, 1, ... modes."""
        if not self.covers(omega):
            return np.full(len(self.squares) + 1, np.inf)
        squares, errors = self.free_errors()
        own = errors[squares <= omega**2]
        largest = own.max(axis=0, initial=0.0)
        below = self._coupled & (self.squares <= omega**2)
        largest[:np.max(np.flatnonzero(below), initial=-1) + 1] = np.inf
        return largest

    def free_errors(self) -> tuple[NDArray, NDArray]:
        """Squares of the free angular frequencies (f,), and their errors (f, computed + 1).

        Errors are infinite of frequencies beyond the modes computed, and where a mode below the
        frequency is left out.
        """
        squares, motions = self._free()
        above = self.squares[None] > squares[:, None]
        gaps = np.where(above, self.squares[None] - squares[:, None], 1.0)
        works = squares[:, None]**2 * (motions @ self.parts.T)**2 / gaps
        works = np.where(above, works, np.where(self._coupled, np.inf, 0.0))
        rest = np.array([b @ self._rest(square) @ b if self.covers(np.sqrt(square)) else np.inf
                         for square, b in zip(squares, motions, strict=True)])
        later = np.cumsum(works[:, ::-1], axis=1)[:, ::-1]
        errors = np.column_stack([later, np.zeros(len(squares))]) + rest[:, None]
        return squares, errors.clip(0.0) / (2 * squares[:, None])

    def _free(self) -> tuple[NDArray, NDArray]:
        """Squares of free vibrations with all modes computed, motions of the interface (f, r)."""
        r, count = len(self.stiffness), len(self.squares)
        K = linalg.block_diag(self.stiffness, np.diag(self.squares))
        M = np.block([[self.mass, self.parts.T], [self.parts, np.eye(count)]])
        scale = 1 / np.sqrt(np.diag(K) + np.diag(M) * np.trace(K) / np.trace(M))
        K, M = (scale[:, None] * matrix * scale for matrix in (K, M))
        shift = _SHIFT * np.trace(K) / np.trace(M)
        inverse, shapes = linalg.eigh(M, K + shift * M)
        inverse, shapes = inverse[::-1], shapes[:, ::-1]
        massive = inverse > 1e-13 * inverse[0]
        squares = 1 / inverse[massive] - shift
        motions = (scale[:, None] * shapes[:, massive] / np.sqrt(inverse[massive]))[:r].T
        elastic = squares > _RIGID * squares.max(initial=0.0) if not count else (
            squares > _RIGID * self.squares[0])
        return squares[elastic], motions[elastic]

    def bands(self, count: int, tolerances: tuple[float, ...]) -> tuple[list, list]:
        """Angular frequencies up to which `count` modes keep tolerances.

        Returns
        -------
        frequencies, stiffness : list of float
            Of the free frequencies and of the dynamic stiffness, for each tolerance.
        """
        squares, errors = self.free_errors()
        own = errors[:, count]
        frequencies = []
        for tolerance in tolerances:
            good = own <= tolerance
            last = len(good) if good.all() else int(np.argmin(good))
            frequencies.append(float(np.sqrt(squares[last - 1])) if last else 0.0)
        return frequencies, [self._stiffness_band(count, one) for one in tolerances]

    def _stiffness_band(self, count: int, tolerance: float) -> float:
        """By halving the band below the first mode that is left out."""
        left = np.append(self.squares[count:][self._coupled[count:]], np.inf)
        high = np.sqrt(min(left[0], self.squares[-1] / _BEYOND**2 if len(self.squares) else 0.0))
        low = 0.0
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            good = self.stiffness_errors(middle)[count] <= tolerance
            low, high = (middle, high) if good else (low, middle)
        return float(low)
