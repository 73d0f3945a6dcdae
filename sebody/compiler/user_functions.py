"""Functions of users, compiled for the time loop: time functions of loads and drives, and forces.

They are compiled with bounds checks. Where one raises, or gives what is not finite, its result is
NaN: no state that contains it is accepted, and the run stops. The arguments are kept to say why.
"""

import math
import re
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic

from sebody.compiler import choice
from sebody.errors import InputError
from sebody.inputs import shown

HISTORY = types.float64(types.float64)
_floats, _given = types.CPointer(types.float64), types.Array(types.float64, 1, "C", readonly=True)
FORCE = types.void(types.int64, types.float64, _floats, _floats, _floats)
_ARRAYS = types.void(types.float64, _given, _given, types.Array(types.float64, 1, "C"))
CONTROLLER = types.int64(types.float64, _floats, _floats, _floats, _floats)
_written = types.Array(types.float64, 1, "C")
_CONTROL = types.void(types.float64, _given, _written, _written, _given)
FAULT, TIME, OTHERS = range(3)      # of a record: whether there was a fault, its arguments
NO_RECORD = 0                       # its address where none is kept


class UserFunction:
    """A compiled function, and the arguments of its last fault.

    Parameters
    ----------
    function : callable
        As the user wrote it.
    arguments : int
        Numbers it gets, the time included.

    Attributes
    ----------
    read : mapping
        Values from outside that it was compiled with, by name.
    """

    def __init__(self, function: Callable, arguments: int):
        self.function = function
        self.read: Mapping[str, object] = {}
        self.record = np.zeros(1 + arguments)
        self.compiled = None            # by `compile_history` or `compile_force`
        self.alone: Callable            # compiles it without the record, for exports

    @property
    def address(self) -> int:
        """Of the machine code."""
        return self.compiled.address

    @property
    def ctypes(self) -> Callable:
        """The compiled function, to be called from Python."""
        return self.compiled.ctypes

    def forget(self) -> None:
        """Forget the last fault."""
        self.record[FAULT] = 0.0

    def fault(self, since: float) -> str:
        """What the function did at its last fault, and when; empty if it was before a time."""
        if not (self.record[FAULT] and self.record[TIME] >= since):
            return ""
        t, others = float(self.record[TIME]), self.record[OTHERS:].copy()
        others.flags.writeable = False
        force = np.zeros(others.size // 2)
        try:
            with np.errstate(all="ignore"):
                value = (self.function(t, *np.split(others, 2), force) if others.size else
                         self.function(t))
            did = f"gave {shown(force if others.size else value)}"
        except Exception as error:      # whatever the user's function raises
            did = f"raised {type(error).__name__}: {error}"
        return f"{did} at t = {t:.6g}"


@intrinsic
def _floats_at(typingctx, address):
    """Pointer to the numbers at an address."""
    def codegen(context, builder, sig, args):
        return builder.inttoptr(args[0], context.get_value_type(_floats))
    return _floats(address), codegen


def compile_history(function: Callable[[float], float], what: str) -> UserFunction:
    """A function of time as a C function.

    Raises
    ------
    InputError
        Numba cannot compile it; the message begins with `what` it is.
    """
    made = UserFunction(function, 1)
    try:
        returned = choice.way().guarded(_inner(HISTORY, function))

        def compiled(kept):
            def call(t):
                raised, value = returned((t,))
                if raised or not math.isfinite(value):
                    if kept != NO_RECORD:
                        record = carray(_floats_at(kept), 2)
                        record[FAULT], record[TIME] = 1.0, t
                    return math.nan
                return value
            return cfunc(HISTORY)(call)
        _compile(made, compiled)
    except Exception as error:      # Numba does not raise its own exceptions alone
        raise InputError(f"{what} {getattr(function, '__name__', function)!r} cannot be compiled: "
                         f"use only arithmetic, math and numpy in it ({_reason(error)})"
                         ) from error
    return made


def compile_force(name: str, function: Callable[..., None], coordinates: int) -> UserFunction:
    """A user's ``function(t, x, v, force)`` as a C function of pointers.

    Parameters
    ----------
    coordinates : int
        Length of `x`, `v` and `force`.

    Raises
    ------
    InputError
        Numba cannot compile it.
    """
    made = UserFunction(function, 1 + 2 * coordinates)
    try:
        returned = choice.way().guarded(_inner(_ARRAYS, function))

        def compiled(kept):
            def call(n, t, x, v, force):
                motion = carray(x, n), carray(v, n)
                forces = carray(force, n)
                raised, _ = returned((t, motion[0], motion[1], forces))
                for i in range(n):
                    raised |= not math.isfinite(forces[i])
                if raised and kept != NO_RECORD:
                    record = carray(_floats_at(kept), OTHERS + 2 * n)
                    record[FAULT], record[TIME] = 1.0, t
                    for i in range(n):
                        record[OTHERS + i], record[OTHERS + n + i] = motion[0][i], motion[1][i]
                if raised:
                    for i in range(n):
                        forces[i] = math.nan
            return cfunc(FORCE)(call)
        _compile(made, compiled)
    except Exception as error:
        raise InputError(f"user force {name!r} cannot be compiled: write function(t, x, v, force) "
                         "with arithmetic, math and numpy only, which sets entries of force and "
                         f"changes nothing else ({_reason(error)})") from error
    return made


class ControlFunction(UserFunction):
    """A compiled controller, and the arguments of its last fault.

    Parameters
    ----------
    sizes : tuple of int
        Of y, x, u and the parameters.
    """

    def __init__(self, function: Callable, sizes: tuple[int, int, int, int]):
        super().__init__(function, 1 + sum(sizes))
        self.sizes = sizes

    def fault(self, since: float) -> str:
        """What the controller did at its last fault, and when; empty if it was before a time."""
        if not (self.record[FAULT] and self.record[TIME] >= since):
            return ""
        t = float(self.record[TIME])
        inputs = np.split(self.record[OTHERS:].copy(), np.cumsum(self.sizes)[:-1])
        for k in (0, 3):
            inputs[k].flags.writeable = False
        try:
            with np.errstate(all="ignore"):
                self.function(t, *inputs)
            did = f"gave u = {shown(inputs[2])}" if not np.isfinite(inputs[2]).all() else (
                f"gave states {shown(inputs[1])}")
        except Exception as error:      # whatever the user's function raises
            did = f"raised {type(error).__name__}: {error}"
        return f"{did} at t = {t:.6g}"


def compile_controller(name: str, function: Callable[..., None],
                       sizes: tuple[int, int, int, int],
                       shape: str = "t, y, x, u, parameters", written: str = "u and x"
                       ) -> ControlFunction:
    """A user's ``controller(t, y, x, u, parameters)`` as a C function of pointers.

    It returns 1 after a fault: what raises, and outputs or states that are not finite.

    Parameters
    ----------
    sizes : tuple of int
        Of y, x, u and the parameters.
    shape, written : str
        Arguments of the function as its user wrote it, and those it sets, for messages.

    Raises
    ------
    InputError
        Numba cannot compile it.
    """
    made = ControlFunction(function, sizes)
    ny, nx, nu, count = sizes
    total = OTHERS + sum(sizes)
    try:
        returned = choice.way().guarded(_inner(_CONTROL, function))

        def compiled(kept):
            def call(t, y, x, u, parameters):
                motion, states, outputs, numbers = (carray(y, ny), carray(x, nx), carray(u, nu),
                                                    carray(parameters, count))
                if kept != NO_RECORD:       # as they are before the call, which changes x and u
                    record = carray(_floats_at(kept), total)
                    for i in range(ny):
                        record[OTHERS + i] = motion[i]
                    for i in range(nx):
                        record[OTHERS + ny + i] = states[i]
                    for i in range(nu):
                        record[OTHERS + ny + nx + i] = outputs[i]
                    for i in range(count):
                        record[OTHERS + ny + nx + nu + i] = numbers[i]
                raised, _ = returned((t, motion, states, outputs, numbers))
                for i in range(nx):
                    raised |= not math.isfinite(states[i])
                for i in range(nu):
                    raised |= not math.isfinite(outputs[i])
                if raised and kept != NO_RECORD:
                    record = carray(_floats_at(kept), total)
                    record[FAULT], record[TIME] = 1.0, t
                return 1 if raised else 0
            return cfunc(CONTROLLER)(call)
        _compile(made, compiled)
    except Exception as error:
        raise InputError(f"controller {name!r} cannot be compiled: write a function "
                         f"({shape}) with arithmetic, math and numpy only, which sets entries of "
                         f"{written} and changes nothing else ({_reason(error)})") from error
    return made


def _compile(made: UserFunction, compiled: Callable) -> None:
    """Compile a function with its record now, without it where somebody asks."""
    made.compiled = compiled(made.record.ctypes.data)
    made.alone = partial(compiled, NO_RECORD)


def _reason(error: Exception) -> str:
    """What Numba says of a function it cannot compile, on one line."""
    lines = re.sub(r"\x1b\[\d*m", "", str(error)).splitlines()
    said = [line.strip() for line in lines if line.strip() and not line.startswith("Failed in ")]
    place = next((line for line in said if line.startswith("File ")), "")
    first = said[0] if said else type(error).__name__
    return first + (f"; {place.rstrip(':')}" if place and place != first else "")


def _inner(signature, function: Callable) -> Callable:
    return njit(signature, boundscheck=True, no_cpython_wrapper=True)(function)

