"""Error that is allowed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

UNSIZED = ("the model has no characteristic length: errors of positions are relative to one unit "
           "of length; give an absolute tolerance, such as Tolerance(1e-3, position=1e-6)")
FINEST = 1e-9       # relative error of a run below which Newton's tolerance and rounding decide


class Tolerance(NamedTuple):
    """Allowed errors of positions and rotations, relative ones added to absolute ones.

    Relative to the model's characteristic length for positions, to one radian for rotations. Where
    nothing in the model has a length, as in a single mass without a moment of inertia, it means one
    unit of length, and a run warns.
    """

    relative: float = 1e-3
    position: float = 0.0       # [length]
    rotation: float = 0.0       # [rad]

    def check(self) -> Tolerance:
        """The tolerance itself.

        Raises
        ------
        InputError
            Negative or infinite numbers, or nothing allowed.
        """
        for name, value in self._asdict().items():
            inputs.number(value, f"tolerance {name}", least=0, remedy="give a number >= 0")
        if self.relative == 0.0 and not (self.position > 0.0 and self.rotation > 0.0):
            raise InputError("the tolerance allows no error: give a relative error, or absolute "
                             "ones "
                             "of positions and of rotations")
        return self

    def check_reachable(self, extent: float) -> None:
        """Refuse errors of a run that no step is short enough for.

        Parameters
        ----------
        extent : float
            Of the model [length].

        Raises
        ------
        InputError
            Positions or rotations are allowed less than `FINEST`.
        """
        least = self.least(extent)
        if least < FINEST:
            raise InputError(f"the tolerance allows errors of {least:.3g}, relative to the model's "
                             f"characteristic length or in radians: give at least {FINEST:g}, "
                             "below which shorter steps do not help")

    def least(self, extent: float) -> float:
        """The smaller of the errors of positions, over the characteristic length, and rotations."""
        sizes, rotational = np.array([extent, 1.0]), np.array([False, True])
        sized = sizes > 0.0
        return float((self.allowed(sizes, rotational)[sized] / sizes[sized]).min())

    def allowed(self, magnitude: ArrayLike, rotational: ArrayLike) -> NDArray:
        """Allowed error of positions and rotations of a magnitude.

        Where nothing in a model has a length, which is a magnitude of 0, a relative error alone is
        relative to one unit of length (`UNSIZED`).
        """
        absolute = np.where(rotational, self.rotation, self.position)
        errors = absolute + self.relative * np.asarray(magnitude)
        errors = np.where(errors == 0.0, self.relative, errors)
        return errors


def given(tolerance: Tolerance | None) -> Tolerance | None:
    """The tolerance a user gives, checked; None stays None.

    Raises
    ------
    InputError
        Something that is no tolerance, such as a number, or see `Tolerance.check`.
    """
    if tolerance is None:
        return None
    return inputs.instance(tolerance, "tolerance", Tolerance,
                           "give a Tolerance, such as Tolerance(1e-3)").check()
