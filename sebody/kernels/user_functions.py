"""Functions of users, compiled for the time loop: histories of loads and drives, and forces."""

from collections.abc import Callable

from numba import carray, cfunc, njit, types
from numba.core.ccallback import CFunc
from numba.core.errors import NumbaError

from sebody.errors import InputError

HISTORY = types.float64(types.float64)
_floats = types.CPointer(types.float64)
FORCE = types.void(types.int64, types.float64, _floats, _floats, _floats)


def compile_history(function: Callable[[float], float], what: str) -> CFunc:
    """A function of time as a C function.

    Raises
    ------
    InputError
        Numba cannot compile it; the message begins with `what` it is.
    """
    try:
        return cfunc(HISTORY)(function)
    except (NumbaError, TypeError, AttributeError) as error:
        raise InputError(f"{what} {getattr(function, '__name__', function)!r} cannot be compiled: "
                         f"use only arithmetic, math and numpy in it, and one argument, the time "
                         f"({error})") from error


def compile_force(name: str, function: Callable[..., None]) -> CFunc:
    """A user's ``function(t, x, v, force)`` as a C function of pointers.

    Raises
    ------
    InputError
        Numba cannot compile it.
    """
    try:
        inner = njit(function)

        def call(n, t, x, v, force):
            inner(t, carray(x, n), carray(v, n), carray(force, n))
        return cfunc(FORCE)(call)
    except (NumbaError, TypeError) as error:
        raise InputError(f"user force {name!r} cannot be compiled: write function(t, x, v, force) "
                         f"with arithmetic, math and numpy only ({error})") from error
