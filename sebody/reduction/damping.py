"""Damping of a reduced body by its free vibration modes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError


def modal_damping(stiffness: NDArray, mass: NDArray, rigid: NDArray, strainless: NDArray,
                  ratio: float | Sequence[float], of_mass: float, of_stiffness: float) -> NDArray:
    """The matrix (n, n) that damps every free vibration mode and no rigid motion.

    Parameters
    ----------
    stiffness, mass : (n, n)
    rigid : (n, r)
        Rigid motions.
    strainless : (k,) of int
        Coordinates that are rigid motions by themselves.
    ratio, of_mass, of_stiffness : float
        See `ReducedBody.damped`.

    Raises
    ------
    InputError
        A number that is negative or not finite, more ratios than modes, or a singular mass.
    """
    of_mass, of_stiffness = (inputs.number(value, f"damping: {name}", least=0) for name, value
                             in (("mass", of_mass), ("stiffness", of_stiffness)))
    ratios = _ratios(ratio, len(mass) - rigid.shape[1])
    try:
        squares, shapes = eigh(stiffness, mass)
    except LinAlgError as error:
        raise InputError("damping: the mass is singular, so the body has motions without a "
                         "frequency; give every coordinate inertia, or damping=, a matrix"
                         ) from error
    omega, momenta = np.sqrt(squares[rigid.shape[1]:]), mass @ shapes[:, rigid.shape[1]:]
    momenta[strainless] = 0.0       # to rounding
    return (momenta * (2 * ratios * omega + of_mass + of_stiffness * omega**2)) @ momenta.T


def _ratios(ratio: float | Sequence[float], count: int) -> NDArray:
    """Damping ratios of all free vibration modes."""
    if np.ndim(ratio) == 0:
        return np.full(count, inputs.number(ratio, "damping: ratio", least=0))
    ratios = [inputs.number(one, "damping: a ratio", least=0)
              for one in inputs.items(ratio, "damping: ratio", "give numbers >= 0")]
    if not 0 < len(ratios) <= count:
        raise InputError(f"damping: {len(ratios)} ratios, but the body has {count} free vibration "
                         f"modes: give 1 to {count}")
    return np.array(ratios + [ratios[-1]] * (count - len(ratios)))
