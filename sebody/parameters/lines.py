"""Numbers of arrays as linear functions of parameters, found by building a model with values.

A force follows from its amplitude by its direction, a stiffness changes the entries of a matrix.
Three values of each parameter and one of all together tell which numbers change, by how much, and
that they change linearly.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from sebody.assembly.close_rows import Grid
from sebody.basics.errors import InputError
from sebody.parameters.changes import Handle

LINEAR = 1e-12      # largest deviation from a line, relative to the largest of the numbers compared
Numbers = Callable[[], NDArray | None]      # of the model as it is now; None if its pattern differs


class Lines(NamedTuple):
    """Numbers that depend linearly on parameters."""

    slots: NDArray      # (k,) places in the numbers
    slopes: csr_array   # (k, components of the parameters)


def lines(handles: Mapping[str, Handle], numbers: Numbers, grid: Grid | None) -> Lines | None:
    """Slopes of all numbers; None unless they depend linearly on all parameters together."""
    base, slopes, steps = numbers(), [], []
    for handle in handles.values():
        for k in range(handle.base.size):
            slopes.append(_slope(handle, k, base, numbers, grid))
            if slopes[-1] is None:
                return None
        # another part of a step for every component
        steps.append(_step(handle) * (1 + np.arange(len(slopes) - handle.base.size,
                                                    len(slopes))) / len(slopes))
    together = _at(list(handles.values()), steps, numbers, grid)
    change = np.concatenate(steps) @ np.array(slopes)
    if together is None or not _equal(together - base, change, base, together):
        return None
    slots = np.flatnonzero(np.any(np.array(slopes) != 0.0, axis=0))
    return Lines(slots, csr_array(np.array(slopes)[:, slots].T))


def _slope(handle: Handle, k: int, base: NDArray, numbers: Numbers, grid: Grid | None
           ) -> NDArray | None:
    """Change of all numbers by one component of a parameter; None if it is not linear."""
    steps = np.zeros(handle.base.size)
    steps[k] = _step(handle)[k]
    one, two = (_at([handle], [by * steps], numbers, grid) for by in (1, 2))
    if one is None or two is None or not _equal(two - base, 2 * (one - base), base, two):
        return None
    change = one - base
    rounding = LINEAR * np.maximum(np.abs(base), np.abs(one))
    return np.where(np.abs(change) > rounding, change, 0.0) / steps[k]


def _at(handles: list[Handle], steps: list[NDArray], numbers: Numbers, grid: Grid | None
        ) -> NDArray | None:
    """All numbers with some parameters changed; None if the model cannot have these values."""
    try:
        for handle, step in zip(handles, steps, strict=True):
            value = handle.base + step.reshape(handle.base.shape)
            if handle.as_built is None:
                handle.set(value)
            else:
                handle.as_built(value, grid)
        return numbers()
    except InputError:
        return None
    finally:
        for handle in reversed(handles):
            handle.reset()


def _step(handle: Handle) -> NDArray:
    """By how much the components of a parameter are changed to see what follows."""
    return np.maximum(1.0, np.abs(handle.base)).ravel()


def _equal(one: NDArray, other: NDArray, *numbers: NDArray) -> bool:
    """Tell whether two changes are the same but for rounding of the numbers that changed."""
    size = max(np.abs(n).max(initial=0.0) for n in numbers)
    return bool((np.abs(one - other) <= LINEAR * size).all())
