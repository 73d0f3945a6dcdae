"""Constants of Hunt and Crossley's contact law: damping from the restitution at a speed."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

LEAST = 1e-2        # smallest restitution: with less the damping grows without bounds
SLOW = 1e-3         # of the given speed: the steps of slower impacts are not looked at


def damping_of(restitution: float, at_speed: float, what: str) -> float:
    """The damping c of ``F = k d^n (1 + c d')`` for a restitution e at a speed v.

    It is the root of ``c v (1 + e) = ln((1 + c v)/(1 - c v e))``, for any k, n and mass.

    Raises
    ------
    InputError
        A restitution that is not between 0.01 and 1, or a speed that is not positive.
    """
    e = inputs.number(restitution, f"{what}: restitution", least=0)
    v = inputs.number(at_speed, f"{what}: at_speed", above=0)
    if e > 1:
        raise InputError(f"{what}: restitution is {e:g}, and more than 1 would make energy: give a "
                         "number from 0.01 to 1")
    if e < LEAST:
        raise InputError(f"{what}: restitution is {e:g}: give a number from 0.01 to 1, since the "
                         "damping of the contact would be without bounds")
    if e > 1 - 1e-9:
        return 0.0
    from scipy.optimize import brentq  # here: models without contact start faster

    def left(z: float) -> float:        # c v e = 1 - exp(-z), which may be 1 to the last digit
        x = -np.expm1(-z)
        return x / e * (1.0 + e) - np.log1p(x / e) - z
    least = -np.log1p(-1e-12 - 0.1 * (1 - e))
    return -np.expm1(-brentq(left, least, 1.0 + 1.0 / e, xtol=1e-15, rtol=1e-14)) / (e * v)


def restitution_of(damping: float, at_speed: float) -> float:
    """The restitution at a speed with some damping: the inverse of `damping_of`."""
    y = damping * at_speed              # c v
    if y == 0:
        return 1.0
    from scipy.optimize import brentq

    loss = y - np.log1p(y)              # with c v e = 1 - exp(-z) it is z + exp(-z) - 1
    return -np.expm1(-brentq(lambda z: z + np.expm1(-z) - loss, 0.0, loss + 1.0, xtol=1e-15)) / y


def checked_law(what: str, stiffness: float, exponent: float) -> dict[str, float]:
    """Stiffness and exponent of the law of a contact.

    Raises
    ------
    InputError
        Numbers out of range.
    """
    return {"stiffness": inputs.number(stiffness, f"{what}: stiffness", above=0),
            "exponent": inputs.number(exponent, f"{what}: exponent", least=1)}


def impact_constants(what: str, restitution: float, at_speed: float, stiffness: float | None,
                     exponent: float) -> dict[str, float | NDArray]:
    """Constants of the law of a contact, a stop or teeth.

    Raises
    ------
    InputError
        No stiffness, or numbers out of range.
    """
    if stiffness is None:
        raise InputError(f"{what}: give stiffness=, the force at a depth of one")
    return {**checked_law(what, stiffness, exponent),
            "damping": damping_of(restitution, at_speed, what), "slow": SLOW * at_speed}
