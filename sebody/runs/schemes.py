"""Time integration schemes: generalized-alpha and HHT."""

from functools import cache

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.engine.state import Scheme


def generalized_alpha(rho: float = 0.9, tolerance: float = 1e-8, tangent: str = "consistent",
                      index: int = 3) -> Scheme:
    """Chung and Hulbert's scheme with spectral radius `rho` at infinite frequency.

    Parameters
    ----------
    rho : float
        In [0, 1]; 1 has no numerical damping.
    tolerance : float
        Of the Newton correction left, relative to the increment of the step. With the default two
        bodies that rotate freely keep their energy within 1e-5 in a million steps; 1e-10, within
        3e-6, takes a third more iterations.
    tangent : {'consistent', 'paper'}
        Iteration matrix: exact, or (31) with (60)-(63).
    index : {3, 2}
        With 3 the constraints hold for positions; with 2, the stabilised form of Gear, Gupta and
        Leimkuhler, for velocities, too, and multipliers are of second order from the start.

    Raises
    ------
    InputError
        Values out of range.
    """
    rho = inputs.number(rho, "rho", least=0, most=1,
                        remedy="use a spectral radius between 0 and 1")
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 + alpha_f - alpha_m
    return _scheme(alpha_m, alpha_f, 0.25 * (gamma + 0.5) ** 2, gamma, tolerance, tangent, index)


def hht(alpha: float = -0.05, tolerance: float = 1e-8, tangent: str = "consistent",
        index: int = 3) -> Scheme:
    """Hilber, Hughes and Taylor's scheme, ``alpha`` in [-1/3, 0]; see `generalized_alpha`."""
    alpha = inputs.number(alpha, "alpha", least=-1 / 3, most=0,
                          remedy="HHT needs a value between -1/3 and 0")
    return _scheme(0.0, -alpha, 0.25 * (1 - alpha) ** 2, 0.5 - alpha, tolerance, tangent, index)


def checked(scheme: Scheme) -> Scheme:
    """A scheme whose numbers are those of one.

    Raises
    ------
    InputError
        No scheme, or numbers that no scheme of the family has.
    """
    remedy = "give generalized_alpha() or hht()"
    inputs.instance(scheme, "scheme", Scheme, remedy)
    for name, bounds in _BOUNDS.items():
        inputs.number(getattr(scheme, name), f"scheme: {name}", remedy=remedy, **bounds)
    inputs.flag(scheme.stabilized, "scheme: stabilized")
    return scheme


def fitting(scheme: Scheme | None, constrained: bool, variable: bool,
            sliding: bool = False) -> Scheme:
    """The given scheme, `checked`, or by default one that suits the steps and the constraints.

    Parameters
    ----------
    constrained, variable : bool
        Whether there are constraints, and whether steps are chosen by a tolerance.
    sliding : bool
        Whether joints are on paths, whose forces have spikes with index 3.

    Raises
    ------
    InputError
        Variable steps with constraints of index 3.
    """
    if scheme is None:
        return _default(2 if constrained and (variable or sliding) else 3)
    if variable and constrained and not scheme.stabilized:
        raise InputError("with constraints of index 3 errors grow where the step changes: give "
                         "generalized_alpha(index=2), or a fixed step")
    return scheme if constrained else scheme._replace(stabilized=False)


@cache
def _default(index: int) -> Scheme:
    """The scheme of constraints of an index, with its checks made once."""
    return generalized_alpha(index=index)


_BOUNDS = {"alpha_m": {"least": -1, "below": 1}, "alpha_f": {"least": 0, "below": 1},
           "beta": {"above": 0, "most": 1}, "gamma": {"above": 0, "most": 2},
           "tolerance": {"above": 0, "below": 1}, "geometric": {"least": 0, "most": 1}}


def _scheme(alpha_m: float, alpha_f: float, beta: float, gamma: float, tolerance: float,
            tangent: str, index: int) -> Scheme:
    tolerance = inputs.number(tolerance, "tolerance", above=0, below=1,
                              remedy="use a number between 0 and 1, such as 1e-8")
    tangent = inputs.choice(tangent, "tangent", ("consistent", "paper"))
    index = inputs.choice(index, "index", (3, 2), "use 3, or 2 for the stabilised form")
    return Scheme(alpha_m, alpha_f, beta, gamma, tolerance, 1.0 if tangent == "consistent" else 0.0,
                  index == 2)
