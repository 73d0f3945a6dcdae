"""Errors as the IFToMM library of benchmark problems defines them.

Each variable is compared at equal intervals, by the size of the reference or, below a threshold, by
the threshold; the error is the root of the mean square of all. The library admits 1e-1 for low and
1e-3 for high precision (A01_specification.xml; M. Gonzalez, F. Gonzalez, A. Luaces and J. Cuadrado,
Engineering with Computers 26, 2010). The goal here is a thousandth of what it admits.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.results.result import Result
from sebody.verify.outside.case import Quantity

ADMITTED = 1e-3         # high precision
THRESHOLD = 1e-3        # SI units
SHARE = 1e-3            # of what is admitted
INTERVAL = 0.01         # s, of all problems but the squeezer


def error(found: NDArray, exact: NDArray) -> float:
    """Error of some variables, arrays of equal shape with a row for each time."""
    relative = (found - exact) / np.maximum(np.abs(exact), THRESHOLD)
    return float(np.sqrt(np.mean(relative**2)))


def drift(result: Result) -> float:
    """Largest change of the sum of kinetic, potential and strain energy."""
    energy = sum(result[f"energy.{kind}"] for kind in ("kinetic", "potential", "strain"))
    return float(np.abs(energy - energy[0]).max())


def quantity(name: str = "error of the library") -> Quantity:
    """The error as a number whose reference is zero."""
    return Quantity(name, 0.0, 1.0, source_tolerance=ADMITTED, share=SHARE)
