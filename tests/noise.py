"""Rounding of a result: what it moves by where its inputs change by one unit in the last place.

Another processor, or another library for linear algebra, rounds each operation of a computation
differently. Changes of its inputs by one unit are of the same kind and size, so what they do tells
what two ways to compute the same may differ by, which no literal in a test can know.
"""

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

TRIALS = 4
SAFE = 10.0         # times the largest of few trials; rounding of all operations, not of the inputs


def neighbours(values: ArrayLike, rng: np.random.Generator) -> NDArray:
    """Every number replaced by the next larger or the next smaller one; zeros stay.

    Symmetric matrices stay symmetric.
    """
    own = np.asarray(values, dtype=float)
    towards = np.where(rng.random(own.shape) < 0.5, -np.inf, np.inf)
    if own.ndim == 2 and np.array_equal(own, own.T):
        towards = np.tril(towards, -1).T + np.tril(towards) if own.size else towards
    return np.where(own == 0.0, 0.0, np.nextafter(own, towards))


def noise(compute: Callable[..., ArrayLike], *inputs: ArrayLike, most: float) -> NDArray:
    """What a result may be off by: `SAFE` times the most that it moves with its inputs' last units.

    Parameters
    ----------
    compute : callable
        Gives the result for inputs, numbers or arrays.
    most : float
        Of the largest number of the result: with more than this nothing would be compared.

    Returns
    -------
    ndarray
        For each number of the result.

    Raises
    ------
    AssertionError
        The noise is more than that.
    """
    rng = np.random.default_rng(len(inputs))
    return spread(compute(*inputs), (compute(*(neighbours(one, rng) for one in inputs))
                                     for _ in range(TRIALS)), most)


def spread(result: ArrayLike, others: Iterable[ArrayLike], most: float) -> NDArray:
    """`SAFE` times the most by which others, which only rounding sets apart, differ from a result.

    So do results of a model that stands elsewhere: the digits of its places are others then.
    Arguments, result and exception are those of `noise`.
    """
    own = np.asarray(result)
    moved = np.max([np.abs(np.asarray(other) - own) for other in others], axis=0)
    assert SAFE * moved.max() <= most * np.abs(own).max(), moved.max() / np.abs(own).max()
    return SAFE * moved
