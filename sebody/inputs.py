"""Checks of what users give: types, shapes, finiteness, ranges and names, the same everywhere.

Every function returns the value in the form the program works with, or raises `InputError` with a
message that names the argument (`what`), shows the value and says what to give instead.
"""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Real
from pathlib import Path
from stat import S_ISDIR
from types import UnionType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.errors import InputError

LONGEST_NAME = 200      # characters: names are parts of lines that are printed
LONGEST_TEXT = 2000     # of titles and the like
LONGEST_SHOWN = 60      # characters of a value in a message
ORTHOGONAL = 1e-12      # largest entry of ``R^T R - I`` of a rotation matrix

Kind = TypeVar("Kind")


def shown(value: object) -> str:
    """A value as messages show it: on one line, and not long."""
    try:
        text = repr(value.tolist() if isinstance(value, np.generic | np.ndarray) else value)
    except Exception:       # of whatever class a user passes by mistake
        text = f"of class {type(value).__name__}"
    text = " ".join(text.split())
    return text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN - 3] + "..."


def refusal(what: str, value: object, remedy: str) -> InputError:
    """The exception for a value that cannot be used."""
    return InputError(f"{what} is {shown(value)}: {remedy}")


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


def flag(value: Any, what: str) -> bool:
    """True or False; numbers and texts are neither."""
    if not isinstance(value, bool | np.bool_):
        raise refusal(what, value, "give True or False")
    return bool(value)


def name(value: Any, what: str) -> str:
    """A name of something: a text of visible characters that is not empty.

    Raises
    ------
    InputError
        Anything else, or more than `LONGEST_NAME` characters.
    """
    if not (isinstance(value, str) and value.strip() and value.isprintable()):
        raise refusal(what, value, "give a text that is not empty")
    if len(value) > LONGEST_NAME:
        raise refusal(what, value, f"it has {len(value)} characters, give at most {LONGEST_NAME}")
    return str(value)


def text(value: Any, what: str) -> str:
    """A text of visible characters on one line, perhaps empty.

    Raises
    ------
    InputError
        Anything else, or more than `LONGEST_TEXT` characters.
    """
    if not (isinstance(value, str) and value.isprintable()):
        raise refusal(what, value, "give a text of one line")
    if len(value) > LONGEST_TEXT:
        raise refusal(what, value, f"it has {len(value)} characters, give at most {LONGEST_TEXT}")
    return str(value)


def mapping(value: Any, what: str, remedy: str) -> dict:
    """What a dict or other mapping holds.

    Raises
    ------
    InputError
        Anything else, an empty text or list included.
    """
    if not isinstance(value, Mapping):
        raise refusal(what, value, remedy)
    return dict(value)


def choice(value: Any, what: str, options: Iterable[Kind], remedy: str | None = None) -> Kind:
    """One of some options, which are texts or numbers.

    Raises
    ------
    InputError
        Anything else; the message names the options.
    """
    options = list(options)
    for option in options:
        same_kind = isinstance(value, str) == isinstance(option, str)
        if same_kind and not isinstance(value, bool) and np.ndim(value) == 0 and value == option:
            return option
    if remedy:
        raise refusal(what, value, remedy)
    *most, last = map(repr, options)
    listed = f"{', '.join(most)} or {last}" if most else last
    raise InputError(f"{what} {shown(value)} is unknown: use {listed}")


def function(value: Any, what: str, remedy: str) -> Callable:
    """Something that can be called.

    Raises
    ------
    InputError
        Anything else.
    """
    if not callable(value):
        raise refusal(what, value, remedy)
    return value


def instance(value: Any, what: str, kind: type[Kind] | UnionType, remedy: str) -> Kind:
    """An object of a class of this package, or of one of several.

    Raises
    ------
    InputError
        Anything else, the class itself included.
    """
    if not isinstance(value, kind):
        raise refusal(what, value, remedy)
    return value


def items(value: Any, what: str, remedy: str) -> list:
    """What a list, tuple or other iterable holds; a text is none.

    Raises
    ------
    InputError
        Anything that cannot be iterated.
    """
    if isinstance(value, str | bytes) or not isinstance(value, Iterable) or (
            isinstance(value, np.ndarray) and not value.ndim):
        raise refusal(what, value, remedy)
    return list(value)


def path(value: Any, what: str, suffixes: Sequence[str] = ()) -> Path:
    """The path of a file, which need not exist.

    Parameters
    ----------
    what : str
        What the file is, for the message.
    suffixes : sequence of str
        Endings it may have; any by default.

    Raises
    ------
    InputError
        No path, another ending, a folder, or a name that no file can have.
    """
    if not (isinstance(value, str | os.PathLike) and isinstance(os.fspath(value), str)
            and os.fspath(value).strip()):
        raise refusal(what, value, "give the path of a file")
    file = Path(value)
    if suffixes and file.suffix not in suffixes:
        raise InputError(f"{what} {file} must end in {', '.join(suffixes)}")
    try:
        is_folder = S_ISDIR(os.stat(file).st_mode)
    except (FileNotFoundError, NotADirectoryError):     # files to be written: `check_target`
        return file
    except (OSError, ValueError) as error:      # too long, a loop of links, a zero character
        raise InputError(f"{what} {shown(str(file))} cannot be a file ({error}): give another "
                         "path") from error
    if is_folder:
        raise InputError(f"{what} {file} is a folder: give the path of a file")
    return file


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
