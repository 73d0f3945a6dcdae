"""Checks of numbers, arrays and rotations."""

from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics.errors import InputError
from sebody.basics.inputs.refusals import refusal

ORTHOGONAL = 1e-12      # largest entry of ``R^T R - I`` of a rotation matrix


def number(value: Any, what: str, *, least: float | None = None, above: float | None = None,
           most: float | None = None, below: float | None = None,
           remedy: str | None = None) -> float:
    """A finite real number; not a text, a truth value or an array of one entry.

    Parameters
    ----------
    what : str
        Name of the argument in the message.
    least, above : float, optional
        Bound from below that the number may, or may not, be equal to.
    most, below : float, optional
        The same from above.
    remedy : str, optional
        What to do, in place of a text made of the bounds.

    Raises
    ------
    InputError
        Anything else.
    """
    real = _real(value)
    if not (np.isfinite(real) and _within(real, least, above, most, below)):
        raise refusal(what, value, remedy or "give " + _wanted("finite number", least, above, most,
                                                               below))
    return real


def integer(value: Any, what: str, *, least: int | None = None, most: int | None = None,
            remedy: str | None = None) -> int:
    """A whole number; one that is written as a float, such as 4.0, will do.

    Parameters
    ----------
    what, least, most, remedy
        As for `number`.

    Raises
    ------
    InputError
        A fraction, or anything that is no number.
    """
    real = _real(value)
    if not (np.isfinite(real) and real == np.floor(real)
            and _within(real, least, None, most, None)):
        raise refusal(what, value, remedy or "give " + _wanted("whole number", least, None, most,
                                                               None))
    return int(_scalar(value))


def array(value: Any, what: str, shape: Sequence[int | None], *,
          remedy: str | None = None) -> NDArray:
    """Finite real numbers of a shape, as a new array of floats.

    Parameters
    ----------
    what : str
        Name of the argument in the message.
    shape : sequence of int or None
        At least one length; None stands for any.
    remedy : str, optional
        What to do, in place of a text made of the shape.

    Raises
    ------
    InputError
        Texts, complex numbers, truth values, rows of different lengths, another shape, NaN.
    """
    shape = tuple(shape)
    if remedy is None:
        remedy = f"give {_size(shape)} finite number{'s' * (shape != (1,))}"
    numbers = reals(value, what, remedy)
    if len(shape) == 1 and not _fits(numbers, shape):
        raise refusal(what, value, remedy)
    if not _fits(numbers, shape):
        raise InputError(f"{what} has shape {numbers.shape}: {remedy}")
    if not np.isfinite(numbers).all():
        if len(shape) == 1:
            raise refusal(what, value, remedy)
        at = [int(i) for i in np.argwhere(~np.isfinite(numbers))[0]]
        raise InputError(f"{what} has the entry {numbers[tuple(at)]} at {at}: {remedy}")
    return numbers


def vector(value: ArrayLike, what: str, size: int | None = None, *,
           remedy: str | None = None) -> NDArray:
    """Finite real numbers in a row: so many, or any number of them; see `array`."""
    return array(value, what, (size,), remedy=remedy)


def rotation(value: ArrayLike, what: str, dimension: int = 3) -> NDArray:
    """A proper rotation matrix, (3, 3) or in a plane (2, 2).

    Raises
    ------
    InputError
        Another shape, axes that are not orthonormal, or a reflection.
    """
    remedy = f"it must be a proper rotation matrix of shape ({dimension}, {dimension})"
    R = array(value, what, (dimension, dimension), remedy=remedy)
    if not np.abs(R.T @ R - np.eye(dimension)).max() <= ORTHOGONAL or np.linalg.det(R) < 0:
        raise InputError(f"{what} must be a proper rotation matrix of shape ({dimension}, "
                         f"{dimension}): orthonormalise it")
    return R


def reals(value: Any, what: str, remedy: str) -> NDArray:
    """Real numbers of any shape as a new array of floats, perhaps not finite.

    Raises
    ------
    InputError
        Texts, complex numbers, truth values, rows of different lengths.
    """
    numbers = _numbers(value)
    if numbers is None:
        raise refusal(what, value, remedy)
    return numbers


def _numbers(value: Any) -> NDArray | None:
    """An array of floats; None for what cannot be one."""
    try:
        entries = value if isinstance(value, np.ndarray) else np.asarray(value, dtype=object)
        if entries.dtype.kind not in "iuf" and not (entries.dtype.kind == "O"
                                                    and all(map(_is_real, entries.flat))):
            return None
        return np.array(entries, dtype=float)
    except (TypeError, ValueError, OverflowError):      # rows that do not fit, 10**400
        return None


def _is_real(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _scalar(value: Any) -> Any:
    """The number in an array without axes; everything else as it is."""
    return value[()] if isinstance(value, np.ndarray) and not value.ndim else value


def _real(value: Any) -> float:
    """A real number as a float; NaN for everything else."""
    value = _scalar(value)
    try:
        return float(value) if _is_real(value) else np.nan
    except OverflowError:
        return np.inf


def _within(value: float, least: float | None, above: float | None, most: float | None,
            below: float | None) -> bool:
    return ((least is None or value >= least) and (above is None or value > above)
            and (most is None or value <= most) and (below is None or value < below))


def _wanted(kind: str, least: float | None, above: float | None, most: float | None,
            below: float | None) -> str:
    """A number of a kind within bounds, in words."""
    if above == 0 and most is None and below is None:
        return "a positive number"
    bounds = [f"{sign} {bound:g}" for sign, bound in (
        (">=", least), (">", above), ("<=", most), ("<", below)) if bound is not None]
    return f"a {kind} {' and '.join(bounds)}".rstrip()


def _size(shape: tuple[int | None, ...]) -> str:
    if None not in shape:
        return " x ".join(map(str, shape))
    return "a list of" if len(shape) == 1 else f"rows of {shape[1]}"


def _fits(found: NDArray, shape: tuple[int | None, ...]) -> bool:
    return found.ndim == len(shape) and all(
        wanted is None or size == wanted for size, wanted in zip(found.shape, shape, strict=True))
