"""Numbers of eight members as compiled code reads them."""

import numpy as np

import sebody.engine.lanes  # noqa: F401  puts functions for lanes in place
from sebody.engine.lanes.arrays import Columns, empty, numbers


class Given(Columns):
    """Arrays of lanes that compiled code reads as `rows`."""

    @classmethod
    def of(cls, values: np.ndarray) -> "Given":
        made = cls(np.zeros(1, dtype=np.int64), empty(1, len(values)), np.zeros(1, dtype=np.int64))
        numbers(made.rows)[0] = values
        return made

    @property
    def values(self) -> np.ndarray:
        return numbers(self.rows)[0]


def numbers_of_all(values: np.ndarray) -> Columns:
    """Numbers that all members share, as compiled code reads them."""
    nothing = np.zeros(1, dtype=np.int64)
    return Columns(nothing, values.reshape(1, -1).copy(), nothing)
