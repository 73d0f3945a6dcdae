"""Records of named scalars: compiled code and Python read and write them as attributes.

Between samples of a run, where microseconds count, Python takes items, ``control["grid"]``: an
attribute of a NumPy record takes five times as long.
"""

import numpy as np
from numpy.typing import NDArray


def record(fields: np.dtype, numbers: NDArray | None = None) -> np.record:
    """Named scalars of one kind.

    Parameters
    ----------
    fields : dtype
        Names of the scalars, all of the same kind.
    numbers : ndarray, optional
        (fields,) Values, which the record shares; zeros by default.
    """
    if numbers is None:
        numbers = np.zeros(len(fields.names), dtype=fields[0])
    return numbers.view(fields).view(np.recarray)[0]


def numbers_of(scalars: np.record) -> NDArray:
    """The scalars of a record as an array that shares their memory, (fields,)."""
    return scalars.base.view(np.ndarray).view(scalars.dtype[0])
