"""What error is allowed."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.errors import InputError


class Tolerance(NamedTuple):
    """Allowed errors of positions and rotations, relative ones added to absolute ones.

    Relative means of the model's extent for positions and of one radian for rotations.
    """

    relative: float = 1e-3
    position: float = 0.0       # [length]
    rotation: float = 0.0       # [rad]

    def check(self) -> "Tolerance":
        """The tolerance itself.

        Raises
        ------
        InputError
            Negative or infinite numbers, or nothing allowed.
        """
        for name, value in self._asdict().items():
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"tolerance {name} is {value}: give a number >= 0")
        if self.relative == 0.0 and not (self.position > 0.0 and self.rotation > 0.0):
            raise InputError("the tolerance allows no error: give a relative one, or absolute ones "
                             "of positions and of rotations")
        return self

    def allowed(self, magnitude: ArrayLike, rotational: ArrayLike) -> NDArray:
        """Allowed error of coordinates of a magnitude; infinite where that is zero."""
        absolute = np.where(rotational, self.rotation, self.position)
        size = np.asarray(magnitude)
        return np.where(size > 0.0, absolute + self.relative * size, np.inf)
