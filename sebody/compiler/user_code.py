"""Functions of users, compiled for the time loop: time functions of loads and drives, and forces.

They are compiled with bounds checks. Where one raises, or gives what is not finite, its result is
NaN: no state that contains it is accepted, and the run stops. The arguments are kept to say why.

Functions of the same code and values, such as ready control laws, share machine code, which gets
the address of the record of faults as a last argument. Each of them is a C function that passes its
own record on, and takes a twentieth of the time to compile.
"""

import math
import re
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import NamedTuple

from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic

from sebody.basics.errors import InputError
from sebody.compiler import choice
from sebody.compiler.user_functions import (
    FAULT,
    OTHERS,
    TIME,
    ControlFunction,
    UserFunction,
)

HISTORY = types.float64(types.float64)
_floats, _given = types.CPointer(types.float64), types.Array(types.float64, 1, "C", readonly=True)
FORCE = types.void(types.int64, types.float64, _floats, _floats, _floats)
_ARRAYS = types.void(types.float64, _given, _given, types.Array(types.float64, 1, "C"))
CONTROLLER = types.int64(types.float64, _floats, _floats, _floats, _floats)
_written = types.Array(types.float64, 1, "C")
_table = types.Array(types.float64, 2, "C")
NO_RECORD = 0                       # its address where none is kept
MOST_SHARED = 128                   # whose machine code is kept for functions to come

# C functions of these arguments, which call another one with one argument more
_PASSING = {
    HISTORY: lambda call, last: lambda t: call(t, last),
    FORCE: lambda call, last: lambda n, t, x, v, force: call(n, t, x, v, force, last),
    CONTROLLER: lambda call, last: lambda t, y, x, u, parameters: call(t, y, x, u, parameters,
                                                                       last)}


class Results(NamedTuple):
    """The form of the array of a controller's results: as it is, or as one or two others.

    Parts of it are made beside the function: arrays that checked functions pass on to others are
    counted, which takes longer than most laws.
    """

    rates: int | None = None                        # as that many, and the others
    rows: int | None = None                         # as a table with so many rows

    def signature(self):
        """The type of the compiled function."""
        given = ((_written, _written) if self.rates is not None else
                 (_table if self.rows is not None else _written,))
        return types.void(types.float64, _given, _written, *given, _given)

    def arguments(self) -> Callable:
        """A compiled function that gives the arguments of the controller as a tuple."""
        rates, rows = self
        if rates is not None:
            def arguments(t, y, x, u, parameters):
                return t, y, x, u[:rates], u[rates:], parameters
        elif rows is not None:
            def arguments(t, y, x, u, parameters):
                return t, y, x, u.reshape(rows, u.size // rows), parameters
        else:
            def arguments(t, y, x, u, parameters):
                return t, y, x, u, parameters
        return njit(arguments)


AS_IT_IS = Results()


@dataclass(frozen=True)
class Source:
    """The code that is compiled of a user's function; equal ones have the same machine code."""

    made_from: Hashable                             # all that the machine code depends on
    function: Callable = field(compare=False)       # as Numba can compile it


@intrinsic
def _floats_at(typingctx, address):
    """Pointer to the numbers at an address."""
    def codegen(context, builder, sig, args):
        return builder.inttoptr(args[0], context.get_value_type(_floats))
    return _floats(address), codegen


def compile_history(source: Source, what: str) -> UserFunction:
    """A function of time as a C function.

    Raises
    ------
    InputError
        Numba cannot compile it; the message begins with `what` it is.
    """
    function = source.function
    made = UserFunction(function, 1)
    try:
        _compile(made, HISTORY, _history, source)
    except Exception as error:      # Numba does not raise its own exceptions alone
        raise InputError(f"{what} {getattr(function, '__name__', function)!r} cannot be compiled: "
                         f"use only arithmetic, math and numpy in it ({_reason(error)})"
                         ) from error
    return made


def _history(function: Callable) -> Callable:
    """A function of time and the address of a record of faults."""
    returned = choice.way().guarded(_inner(HISTORY, function))

    def call(t, kept):
        raised, value = returned((t,))
        if raised or not math.isfinite(value):
            if kept != NO_RECORD:
                record = carray(_floats_at(kept), 2)
                record[FAULT], record[TIME] = 1.0, t
            return math.nan
        return value
    return call


def compile_force(name: str, source: Source, coordinates: int) -> UserFunction:
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
    made = UserFunction(source.function, 1 + 2 * coordinates)
    try:
        _compile(made, FORCE, _force, source)
    except Exception as error:
        raise InputError(f"user force {name!r} cannot be compiled: write function(t, x, v, force) "
                         "with arithmetic, math and numpy only, which sets entries of force and "
                         f"changes nothing else ({_reason(error)})") from error
    return made


def _force(function: Callable) -> Callable:
    """A force of any number of coordinates, with the address of a record of faults."""
    returned = choice.way().guarded(_inner(_ARRAYS, function))

    def call(n, t, x, v, force, kept):
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
    return call


def compile_controller(name: str, source: Source, sizes: tuple[int, int, int, int],
                       shape: str = "t, y, x, u, parameters", written: str = "u and x",
                       results: Results = AS_IT_IS) -> ControlFunction:
    """A user's ``controller(t, y, x, u, parameters)`` as a C function of pointers.

    It returns 1 after a fault: what raises, and outputs or states that are not finite.

    Parameters
    ----------
    sizes : tuple of int
        Of y, x, u and the parameters.
    shape, written : str
        Arguments of the function as its user wrote it, and those it sets, for messages.
    results : Results
        How it is given u.

    Raises
    ------
    InputError
        Numba cannot compile it.
    """
    made = ControlFunction(source.function, sizes, results.rates or 0)
    try:
        _compile(made, CONTROLLER, _controller, source, sizes, results)
    except Exception as error:
        raise InputError(f"controller {name!r} cannot be compiled: write a function "
                         f"({shape}) with arithmetic, math and numpy only, which sets entries of "
                         f"{written} and changes nothing else ({_reason(error)})") from error
    return made


def _controller(function: Callable, sizes: tuple[int, int, int, int], results: Results
                ) -> Callable:
    """A controller of these sizes, with the address of a record of faults."""
    returned = choice.way().guarded(_inner(results.signature(), function))
    arguments = results.arguments()
    ny, nx, nu, count = sizes
    total = OTHERS + sum(sizes)

    def call(t, y, x, u, parameters, kept):
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
        raised, _ = returned(arguments(t, motion, states, outputs, numbers))
        for i in range(nx):
            raised |= not math.isfinite(states[i])
        for i in range(nu):
            raised |= not math.isfinite(outputs[i])
        if raised and kept != NO_RECORD:
            record = carray(_floats_at(kept), total)
            record[FAULT], record[TIME] = 1.0, t
        return 1 if raised else 0
    return call


def _compile(made: UserFunction, signature, written: Callable, *source) -> None:
    """Compile a function with its record now, without it where somebody asks.

    `written` is called with the function to be compiled and, of some, sizes.
    """
    made.shared = _shared(signature, written, *source)
    passed_on = _call_at(made.shared.address, signature.return_type)
    made.compiled = cfunc(signature)(_PASSING[signature](passed_on, made.record.ctypes.data))
    made.alone = partial(_without_record, signature, written, *source)


@lru_cache(MOST_SHARED)
def _shared(signature, written: Callable, source: Source, *sizes):
    """Machine code of all equal functions, with the address of a record as a last argument."""
    return cfunc(signature.return_type(*signature.args, types.int64))(
        written(source.function, *sizes))


def _without_record(signature, written: Callable, source: Source, *sizes):
    return cfunc(signature)(_PASSING[signature](njit(written(source.function, *sizes)), NO_RECORD))


def _call_at(address: int, returned: types.Type) -> Callable:
    """The code that calls the function at an address."""
    @intrinsic
    def call(typingctx, *arguments):
        def codegen(context, builder, sig, args):
            kinds = [context.get_value_type(kind) for kind in arguments]
            function = ir.FunctionType(context.get_value_type(returned), kinds)
            return builder.call(builder.inttoptr(ir.IntType(64)(address), function.as_pointer()),
                                [builder.extract_value(args[0], k) for k in range(len(kinds))])
        return returned(types.StarArgTuple.from_types(arguments)), codegen
    return call


def _reason(error: Exception) -> str:
    """Numba's words on a function that it cannot compile, on one line."""
    lines = re.sub(r"\x1b\[\d*m", "", str(error)).splitlines()
    said = [line.strip() for line in lines if line.strip() and not line.startswith("Failed in ")]
    place = next((line for line in said if line.startswith("File ")), "")
    first = said[0] if said else type(error).__name__
    return first + (f"; {place.rstrip(':')}" if place and place != first else "")


def _inner(signature, function: Callable) -> Callable:
    return njit(signature, boundscheck=True, no_cpython_wrapper=True)(function)

