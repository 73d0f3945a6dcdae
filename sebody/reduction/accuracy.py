"""The number of vibration modes that is enough for a band of frequencies.

Of Craig and Bampton's bodies errors are known from static solutions, see
`sebody.reduction.omission`; Rubin's have the free frequencies of the modes that they keep.

Estimates for the same purpose: S.-H. Boo, J.-G. Kim and P.-S. Lee, Int. J. Numer. Meth. Engng 106,
2016 (frequencies); B. Frie and P. Eberhard, 2023 (sampled transfer functions). With sums of all
modes neither an expansion in the unknown frequency nor samples are needed.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.reduction.clamped import ClampedInterior
from sebody.reduction.component import ComponentModes
from sebody.reduction.omission import Omission
from sebody.reduction.watch import SILENT, Watch

CRITERIA = ("stiffness", "frequencies")
_FIRST = 12     # modes computed at first
_MORE, _MOST = 1.25, 6.0        # modes computed next, over those expected and those before
_TOLERANCES = (1e-3, 1e-2)      # of which the bands are told


@dataclass(frozen=True)
class Accuracy:
    """As many modes as a band of frequencies needs; in place of a number of modes.

    Parameters
    ----------
    tolerance : float
        Largest relative error.
    up_to : float
        End of the band, in cycles per unit of time (Hz where time is in seconds).
    of : 'stiffness' or 'frequencies', optional
        What the tolerance is of: of the dynamic stiffness of the interface, that is of the work of
        any motion of the boundary, relative to the strain and kinetic energy that the motion has
        without internal modes; or of the frequencies of free vibration alone, which takes far
        fewer modes. By default the first, with 'rubin' the second.

    Raises
    ------
    InputError
        Numbers that are not positive, a tolerance of 1 or more, or another criterion.
    """

    tolerance: float
    up_to: float
    of: str = ""

    def __post_init__(self) -> None:
        inputs.number(self.tolerance, "Accuracy: tolerance", above=0, below=1)
        inputs.number(self.up_to, "Accuracy: up_to", above=0)
        if self.of != "":
            inputs.choice(self.of, "criterion of Accuracy", CRITERIA)

    @property
    def omega(self) -> float:
        """End of the band as an angular frequency."""
        return 2 * np.pi * self.up_to


def enough_modes(static: ComponentModes, interior: ClampedInterior,
                 matrices: tuple[sparse.csc_array, sparse.csc_array], accuracy: Accuracy,
                 watch: Watch = SILENT) -> tuple[int, float]:
    """Least number of modes whose estimated error is within the tolerance, and that estimate.

    Parameters
    ----------
    matrices : pair of (n_dofs, n_dofs), sparse
        Stiffness and mass.
    watch : Watch
        Is told how many modes are expected, and how long they take.

    Raises
    ------
    InputError
        No `Accuracy`.
    """
    if not isinstance(accuracy, Accuracy):
        raise inputs.refusal("modes", accuracy, "give a number, or Accuracy(tolerance, up_to)")
    wanted = _FIRST
    while True:
        began = time.perf_counter()
        try:
            known = Omission(static, interior, matrices, wanted)
            errors = _errors(known, accuracy)
        except linalg.LinAlgError as error:
            raise InputError("the error of a number of modes is unknown: motions of the interfaces "
                             "have no mass or stiffness, or a negative one; check the matrices, "
                             "or give a number of modes") from error
        enough = np.flatnonzero(errors <= accuracy.tolerance)
        if len(enough):
            return int(enough[0]), float(errors[enough[0]])
        expected = _expected(known, errors, accuracy)
        seconds = (time.perf_counter() - began) * expected / wanted
        watch.remark(_forecast(known, accuracy, errors[-1], expected, seconds))
        wanted = int(np.clip(_MORE * expected + 4, 1.5 * wanted, _MOST * wanted))


def _errors(known: Omission, accuracy: Accuracy) -> NDArray:
    return (known.frequency_errors if accuracy.of == "frequencies" else known.stiffness_errors)(
        accuracy.omega)


def stiffness_errors(static: ComponentModes, interior: ClampedInterior,
                     matrices: tuple[sparse.csc_array, sparse.csc_array], omega: float, wanted: int
                     ) -> NDArray:
    """Errors of the dynamic stiffness up to `omega`, see `Omission.stiffness_errors`."""
    return Omission(static, interior, matrices, wanted).stiffness_errors(omega)


def _expected(known: Omission, errors: NDArray, accuracy: Accuracy) -> int:
    """Modes that the tolerance will take, from how errors or frequencies have gone on so far."""
    computed = len(known.squares)
    if not np.isfinite(errors[-1]):     # frequencies are not there yet
        numbers, values, aim = np.arange(1, computed + 1), known.squares, (1.2 * accuracy.omega)**2
    else:
        numbers, values, aim = np.arange(computed + 1), errors, accuracy.tolerance
    numbers, values = numbers[computed // 2:], values[computed // 2:]
    there = np.isfinite(values) & (values > 0) & (numbers > 0)
    if not there.any() or np.ptp(np.log(values[there])) < 1e-6:
        return 2 * computed         # there is no trend to follow
    slope, start = np.polyfit(np.log(values[there]), np.log(numbers[there]), 1)
    estimate = np.exp(np.clip(start + slope * np.log(aim), 0.0, np.log(1e6)))
    return int(max(estimate, computed + 1))


def _forecast(known: Omission, accuracy: Accuracy, error: float, expected: int, seconds: float
              ) -> str:
    """Forecast of the cost of the tolerance, and of cheaper ones."""
    text = f"{len(known.squares)} modes with the interfaces clamped: "
    if np.isfinite(error):
        what = "free frequencies" if accuracy.of == "frequencies" else "the dynamic stiffness"
        text += f"{what} within {error:.2g} up to {accuracy.up_to:g}"
    else:
        text += (f"up to {np.sqrt(known.squares[-1]) / (2 * np.pi):.4g}, the band ends at "
                 f"{accuracy.up_to:g}")
    text += f"; about {expected} for {accuracy.tolerance:g}, which take some {_rounded(seconds)}"
    if accuracy.of == "frequencies":
        return text + "; method 'rubin' has these frequencies exactly"
    fewer = np.flatnonzero(known.frequency_errors(accuracy.omega) <= accuracy.tolerance)
    modes = f" with {fewer[0]} modes" if len(fewer) else ""
    return text + (f"; the free frequencies alone are within it{modes} by the criterion "
                   "'frequencies', and exact with method 'rubin'")


def _rounded(seconds: float) -> str:
    """A duration to one digit or two."""
    if seconds < 100:
        return f"{max(seconds, 1.0):.1g} s" if seconds < 10 else f"{10 * round(seconds / 10)} s"
    return f"{round(seconds / 60)} minutes"


def reached(static: ComponentModes, interior: ClampedInterior,
            matrices: tuple[sparse.csc_array, sparse.csc_array], modes: int) -> str:
    """Accuracy of a number of modes, in words."""
    try:
        known = Omission(static, interior, matrices, modes + 4)
        frequencies, stiffness = known.bands(min(modes, len(known.squares)), _TOLERANCES)
    except linalg.LinAlgError:      # coordinates of the boundary without mass and stiffness
        return "unknown, as motions of the interfaces have neither mass nor stiffness"
    parts = []
    for what, bands in (("free frequencies", frequencies),
                        ("dynamic stiffness of the interfaces", stiffness)):
        parts.append(f"{what} " + " and ".join(
            f"within {tolerance:g} up to {omega / (2 * np.pi):.4g}"
            for tolerance, omega in zip(_TOLERANCES, bands, strict=True)))
    return f"{'; '.join(parts)} (estimates, in cycles per unit of time)"
