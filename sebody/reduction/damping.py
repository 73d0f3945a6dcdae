"""Damping of a reduced body by its free vibration modes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.reduction.massless import condensed, inert


def modal_damping(stiffness: NDArray, mass: NDArray, rigid: NDArray, strainless: NDArray,
                  ratio: float | Sequence[float], of_mass: float, of_stiffness: float) -> NDArray:
    """The matrix (n, n) that damps every free vibration mode and no rigid motion.

    Motions without mass, which have no vibration, are damped by their stiffness alone.

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
        A number that is negative or not finite, more ratios than modes, or motions with
        neither mass nor stiffness.
    """
    of_mass, of_stiffness = (inputs.number(value, f"damping: {name}", least=0) for name, value
                             in (("mass", of_mass), ("stiffness", of_stiffness)))
    own, moving = condensed(mass, stiffness), rigid.shape[1]
    if own.following + own.bare:
        moving = inert(mass, rigid)
        if own.bare > rigid.shape[1] - moving:
            raise InputError("damping: the body has motions with neither mass nor stiffness, so "
                             "without a frequency; give these inertia, or damping=, a matrix")
    ratios = _ratios(ratio, len(own.mass) - moving)
    squares, shapes = eigh(own.stiffness, own.mass)
    omega = np.sqrt(squares[moving:])
    momenta = mass @ (own.motions @ shapes[:, moving:])
    momenta[strainless] = 0.0       # to rounding
    damping = (momenta * (2 * ratios * omega + of_mass + of_stiffness * omega**2)) @ momenta.T
    if own.following:       # what moves without mass has a stiffness all the same
        damping += of_stiffness * (stiffness - (momenta * omega**2) @ momenta.T)
    return damping


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
