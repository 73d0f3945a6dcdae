"""Numbers of eight members as compiled code reads them."""

import numpy as np

import sebody.engine.lanes  # noqa: F401  puts functions for lanes in place
from sebody.engine.lanes.arrays import Columns, empty, numbers


class Given(Columns):
    """Arrays of lanes that compiled code reads as `rows`."""

    @classmethod
    def of(cls, values: np.ndarray) -> "Given":
        made = columns(np.zeros(1, dtype=np.int64), empty(1, len(values)), cls)
        numbers(made.rows)[0] = values
        return made

    @property
    def values(self) -> np.ndarray:
        return numbers(self.rows)[0]


def numbers_of_all(values: np.ndarray) -> Columns:
    """Numbers that all members share, as compiled code reads them."""
    nothing = np.zeros(1, dtype=np.int64)
    return columns(nothing, values.reshape(1, -1).copy())


def columns(places: np.ndarray, rows: np.ndarray, kind: type[Columns] = Columns) -> Columns:
    """Rows and places alone: nothing is evaluated."""
    nothing = np.zeros(1, dtype=np.int64)
    return kind(places, rows, nothing, np.zeros((0, 2), dtype=np.int64),
                np.zeros((0, 3), dtype=np.int64), nothing, nothing, empty(1))
