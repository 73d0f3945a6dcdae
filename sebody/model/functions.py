"""Functions of users as they can be compiled: with the functions they call."""

from collections.abc import Callable
from types import CellType, CodeType, FunctionType

from numba import njit

from sebody.errors import InputError

OF_TIME, OF_MOTION = 1, 4       # arguments: t; t, x, v, force


def rebuilt(function: FunctionType, replaced: Callable[[object], object]) -> FunctionType:
    """A copy of a function in which all that it refers to by name is replaced.

    Parameters
    ----------
    replaced : callable
        What stands for a value of a global or enclosing variable.
    """
    inner = dict(function.__globals__)
    copy = FunctionType(function.__code__, inner, function.__name__, function.__defaults__,
                        tuple(CellType() for _ in function.__closure__ or ()))
    copy.__kwdefaults__ = function.__kwdefaults__
    for name in _names(function.__code__) & inner.keys():
        inner[name] = replaced(inner[name])
    for cell, own in zip(copy.__closure__ or (), function.__closure__ or (), strict=True):
        cell.cell_contents = replaced(own.cell_contents)
    return copy


def with_compiled_helpers(function: Callable) -> Callable:
    """A function whose plain helpers, and theirs, are handed to Numba; unchanged if it has none."""
    if not isinstance(function, FunctionType) or not any(
            isinstance(one, FunctionType) for one in _used(function)):
        return function
    made: dict[int, Callable] = {}

    def compiled(value: object) -> object:
        if not isinstance(value, FunctionType):
            return value
        if id(value) not in made:
            made[id(value)] = value         # what calls itself is left to Numba's message
            made[id(value)] = njit(rebuilt(value, compiled))
        return made[id(value)]
    return rebuilt(function, compiled)


def with_bound_defaults(function: Callable, arguments: int, what: str) -> Callable:
    """A function of the first so many of its arguments; further ones keep their defaults.

    Raises
    ------
    InputError
        A further argument without a default, or one that only a keyword can set, which Numba does
        not know; the message begins with `what` it is.
    """
    own = getattr(function, "py_func", function)
    if not isinstance(own, FunctionType):
        return function
    names, count = own.__code__.co_varnames, own.__code__.co_argcount
    further, kept = names[arguments:count], own.__defaults__ or ()
    refused = f"{what} {own.__name__!r} cannot be compiled: its argument "
    if own.__code__.co_kwonlyargcount:
        raise InputError(f"{refused}{names[count]!r} comes after a *, which Numba does not know: "
                         "leave out the *")
    if len(further) > len(kept):
        raise InputError(f"{refused}{further[0]!r} gets no value: give it a default, as in "
                         "lambda t, F=F: F * t, or leave it out")
    if not further:
        return function
    kept, inner = kept[-len(further):], njit(function)

    def of_time(t):
        return inner(t, *kept)

    def of_motion(t, x, v, force):
        inner(t, x, v, force, *kept)
    made = of_time if arguments == OF_TIME else of_motion
    made.__name__ = own.__name__
    return made


def _used(function: FunctionType) -> list[object]:
    """What a function refers to by name."""
    outer = function.__globals__
    return [*(outer[name] for name in _names(function.__code__) & outer.keys()),
            *(cell.cell_contents for cell in function.__closure__ or ())]


def _names(code: CodeType) -> set[str]:
    """Global names that a function uses, those of functions within it included."""
    inner = (c for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*map(_names, inner))
