"""How many fixed-interface modes are enough, by the error of the interface's dynamic stiffness.

With all modes, ``D(w) = K - w^2 M - w^4 sum_j p_j p_j^T / (w_j^2 - w^2)`` is the exact dynamic
stiffness of the interface, K and M reduced to constraint modes Psi, ``p_j = Psi^T M phi_j``.
Leaving out the modes above the n-th leaves out

    E(w) = w^4 sum_{j > n} p_j p_j^T / (w_j^2 - w^2),

positive semidefinite below the next mode and growing with w. Beside the modes computed, sums over
all others are known: with ``Y = M Psi - M Phi p`` and the static answer S of the clamped body,

    sum p p^T / w_j^2 = Y^T S Y,    sum p p^T / w_j^4 = Y^T S M S Y,

so that E lies between ``w^4 (S1 + w^2 S2)`` and ``w^4 (S1 + w^2 S2 / (1 - w^2 / w_N^2))``, of which
the upper is taken; w_N is the last mode computed. The error is that of the work of any interface
motion b, relative to strain and kinetic energy: the largest ``b^T E b / b^T (K + w^2 M) b``, no
matter which units or axes. It grows with w, so it is largest at the end of the band. At a free
vibration it is, to first order, the relative error of the frequency.

Estimates for the same purpose: S.-H. Boo, J.-G. Kim and P.-S. Lee, Int. J. Numer. Meth. Engng 106,
2016 (frequencies); B. Frie and P. Eberhard, 2023 (sampled transfer functions). With sums of all
modes neither an expansion in the unknown frequency nor samples are needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse

from sebody import inputs
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.component import ComponentModes

_BEYOND = 1.2   # last mode computed over the end of the band, so that the two bounds are close
_UNCOUPLED = 1e-12  # part of the energy by which a mode that the interface does not move takes part
_FIRST = 12     # modes computed at first


@dataclass(frozen=True)
class Accuracy:
    """As many modes as the interface's dynamic stiffness needs; in place of a number of modes.

    Parameters
    ----------
    tolerance : float
        Largest relative error of the dynamic stiffness: of the work of any motion of the boundary,
        relative to the strain and kinetic energy that the motion has without internal modes. To
        first order it bounds the relative errors of free vibration frequencies.
    up_to : float
        End of the band, in cycles per unit of time (Hz where time is in seconds).

    Raises
    ------
    InputError
        Numbers that are not positive, or a tolerance of 1 or more.
    """

    tolerance: float
    up_to: float

    def __post_init__(self) -> None:
        inputs.number(self.tolerance, "Accuracy: tolerance", above=0, below=1)
        inputs.number(self.up_to, "Accuracy: up_to", above=0)


def enough_modes(static: ComponentModes, interior: ClampedInterior,
                 matrices: tuple[sparse.csc_array, sparse.csc_array], accuracy: Accuracy
                 ) -> tuple[int, float]:
    """Least number of modes whose estimated error is within the tolerance, and that estimate.

    Parameters
    ----------
    matrices : pair of (n_dofs, n_dofs), sparse
        Stiffness and mass.

    Raises
    ------
    InputError
        No `Accuracy`.
    """
    if not isinstance(accuracy, Accuracy):
        raise inputs.refusal("modes", accuracy, "give a number, or Accuracy(tolerance, up_to)")
    wanted, omega = _FIRST, 2 * np.pi * accuracy.up_to
    while True:
        errors = stiffness_errors(static, interior, matrices, omega, wanted)
        enough = np.flatnonzero(errors <= accuracy.tolerance)
        if len(enough):
            return int(enough[0]), float(errors[enough[0]])
        wanted *= 2


def stiffness_errors(static: ComponentModes, interior: ClampedInterior,
                     matrices: tuple[sparse.csc_array, sparse.csc_array], omega: float, wanted: int
                     ) -> NDArray:
    """Error of the dynamic stiffness up to `omega` with 0, 1, ... modes, of `wanted` computed.

    Infinite where a mode below `omega` is left out, and where too few modes are computed to tell.
    """
    mass = matrices[1]
    stiffness, static_mass = static.project(*matrices)
    squares, shapes = interior.lowest(wanted)
    momenta = mass @ static.constraint
    parts = shapes.T @ momenta
    errors = np.full(len(squares) + 1, np.inf)
    omitted = np.zeros(stiffness.shape)
    if len(squares) >= wanted:      # there are more
        if squares[-1] < (_BEYOND * omega)**2:
            return errors
        rest = momenta - mass @ (shapes @ parts)
        answers = interior.displacement(rest)
        factor = omega**2 / (1 - omega**2 / squares[-1])
        omitted = omega**4 * (rest.T @ answers + factor * (answers.T @ (mass @ answers)))
    norm = stiffness + omega**2 * static_mass
    for count in range(len(squares), -1, -1):
        errors[count] = max(linalg.eigh(omitted, norm, eigvals_only=True)[-1], 0.0)
        if not count:
            break
        square, part = squares[count - 1], parts[count - 1]
        if square > omega**2:
            omitted = omitted + omega**4 / (square - omega**2) * np.outer(part, part)
        elif square * (part @ linalg.solve(stiffness + square * static_mass, part, assume_a="pos")
                       ) > _UNCOUPLED:
            break
    return errors
