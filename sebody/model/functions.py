"""Functions of users as they can be compiled: with the functions they call and their defaults."""

import math
from collections.abc import Callable, Sequence
from types import CellType, CodeType, FunctionType
from typing import Any

import numpy as np
from numba import njit

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.compiler.user_code import (
    Results,
    Source,
    compile_controller,
    compile_force,
    compile_history,
)
from sebody.compiler.user_functions import UserFunction
from sebody.model.outside import (
    compiled_from,
    defaults,
    is_helper,
    refuse,
    values_read,
)

# of all that users write, whatever options they compile it with
CHECKED: dict[str, Any] = {"boundscheck": True}

# arguments
OF_TIME, FORCE = ("t",), ("t", "x", "v", "force")
CONTROL = "t", "y", "x", "u", "parameters"
LAW = "t", "y", "x", "rates", "u", "parameters"
DERIVATIVES = "t", "y", "x", "derivatives", "parameters"


def compiled_history(function: Callable[[float], float], what: str) -> UserFunction:
    """A function of time, compiled for the time loop.

    Raises
    ------
    InputError
        It has other arguments, reads what may change, or Numba cannot compile it; the message
        begins with `what` it is.
    """
    own = _python(function, what, f"{what} {getattr(function, '__name__', '')!r}", OF_TIME)
    return _remembered(compile_history(source(own), what), own)


def compiled_force(function: Callable[..., None], name: str, coordinates: int) -> UserFunction:
    """A user's ``function(t, x, v, force)``, compiled for the time loop.

    Raises
    ------
    InputError
        As of `compiled_history`.
    """
    own = _python(function, f"user force {name!r}", f"user force {name!r}", FORCE)
    return _remembered(compile_force(name, source(own), coordinates), own)


def compiled_controller(function: Callable[..., None], name: str, sizes: tuple[int, int, int, int]
                        ) -> UserFunction:
    """A controller's ``controller(t, y, x, u, parameters)``, compiled for the time loop.

    `sizes` are those of y, x, u and the parameters.

    Raises
    ------
    InputError
        As of `compiled_history`.
    """
    what = f"controller {name!r}"
    own = _python(function, what, what, CONTROL)
    return _remembered(compile_controller(name, source(own), sizes), own)


def compiled_law(function: Callable[..., None], name: str, sizes: tuple[int, int, int, int]
                 ) -> UserFunction:
    """A continuous ``law(t, y, x, rates, u, parameters)``, compiled for its kernel.

    `sizes` are those of y, x, u and the parameters. The results are rates of x, then u.

    Raises
    ------
    InputError
        As of `compiled_history`.
    """
    what = f"controller {name!r}"
    own, (inputs, states, outputs, count) = _python(function, what, what, LAW), sizes

    def law(t, y, x, u, parameters):
        own(t, y, x, u[:states], u[states:], parameters)
    return _remembered(compile_controller(name, source(own),
                                          (inputs, states, states + outputs, count),
                                          ", ".join(LAW), "rates and u", Results(rates=states)),
                       law)


def compiled_derivatives(function: Callable[..., None], name: str,
                         sizes: tuple[int, int, int, int]) -> UserFunction:
    """Derivatives of a law, ``function(t, y, x, derivatives, parameters)``.

    They are of rates of x, then u, by y, then x: (states + outputs, inputs + states).

    Raises
    ------
    InputError
        As of `compiled_history`.
    """
    what = f"derivatives of controller {name!r}"
    own, (inputs, states, outputs, count) = _python(function, what, what, DERIVATIVES), sizes
    rows, columns = states + outputs, inputs + states

    def derivatives(t, y, x, u, parameters):
        own(t, y, x, u.reshape(rows, columns), parameters)
    return _remembered(compile_controller(name, source(own),
                                          (inputs, states, rows * columns, count),
                                          ", ".join(DERIVATIVES), "derivatives",
                                          Results(rows=rows)), derivatives)


def source(function: Callable) -> Source:
    """Source that is compiled; functions of the same code and values share machine code."""
    return Source(compiled_from(function), compilable(function))


def compilable(function: Callable) -> Callable:
    """A function whose helpers, their helpers, and default arguments Numba can compile."""
    made: dict[int, Callable] = {}

    def compiled(value: object) -> object:
        # of what the user compiles by Numba
        options: dict[str, Any] = getattr(value, "targetoptions", {})
        helper = getattr(value, "py_func", value)
        if not is_helper(helper):
            return value
        if id(helper) not in made:
            made[id(helper)] = helper       # what calls itself is left to Numba's message
            made[id(helper)] = njit(**_without(options, "nopython") | CHECKED)(
                rebuilt(helper, compiled))
        return made[id(helper)]
    copy, values = rebuilt(function, compiled), defaults(function).values()
    return _bound(copy, [compiled(value) for value in values]) if values else copy


def interpretable(function: Callable) -> Callable:
    """A function whose helpers are those of Python, where the user compiles some by Numba."""
    made: dict[int, Callable] = {}

    def interpreted(value: Any) -> Any:
        helper = getattr(value, "py_func", value)
        if not is_helper(helper):
            return value
        if id(helper) not in made:
            made[id(helper)] = helper       # what calls itself is not compiled at all
            copy = made[id(helper)] = rebuilt(helper, interpreted)
            given = {name: interpreted(one) for name, one in (helper.__kwdefaults__ or {}).items()}
            copy.__kwdefaults__ = given or None
            copy.__defaults__ = tuple(map(interpreted, helper.__defaults__ or ())) or None
        return made[id(helper)]
    return interpreted(function)


def rebuilt(function: Callable, replaced: Callable[[object], object]) -> Callable:
    """A copy of a function in which all that it refers to by name is replaced.

    Parameters
    ----------
    replaced : callable
        Replaces a value of a global or enclosing variable.
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


def _python(function: Callable, what: str, named: str, arguments: tuple[str, ...]
            ) -> Callable:
    """A function of a user that is written in Python and has these arguments.

    Messages begin with `what` it is or, of a function, with how it is `named`.
    """
    function = getattr(function, "py_func", function)       # of what the user compiles by Numba
    name = getattr(function, "__name__", "")
    if arguments == OF_TIME and function in (getattr(math, name, None), getattr(np, name, None)):
        return lambda t: function(t)        # such as math.sin
    shape = ", ".join(arguments)
    if not isinstance(function, FunctionType):
        raise inputs.refusal(what, function, f"give a function of ({shape}), made by def or lambda")
    code = function.__code__
    has = code.co_varnames[:code.co_argcount + code.co_kwonlyargcount]
    needed = [one for one in has if one not in defaults(function)]
    if len(needed) != len(arguments) or code.co_argcount < len(needed) or code.co_flags & 12:
        raise InputError(f"{named} has the arguments ({', '.join(has)}): give a function "
                         f"of ({shape}); further arguments need defaults")
    refuse(function, named)
    return function


def _remembered(made: UserFunction, function: Callable) -> UserFunction:
    """Compiled code, with the function as its user wrote it and what it was compiled with."""
    made.function, made.read = function, values_read(function)
    made.interpreted = interpretable(function)
    return made


def _bound(function: Callable, values: Sequence[object]) -> Callable:
    """A function whose default arguments have these values, as one that reads the values."""
    code = function.__code__
    # arguments that are given by keyword alone become the last ones
    code = code.replace(co_argcount=code.co_argcount + code.co_kwonlyargcount,
                        co_kwonlyargcount=0)
    inner = FunctionType(code, function.__globals__, function.__name__, None, function.__closure__)
    names = [f"default_{k}" for k in range(len(values))]
    arguments = list(code.co_varnames[:code.co_argcount - len(values)])
    made: dict[str, Any] = dict(zip(names, values, strict=True)) | {
        "inner": njit(**CHECKED)(inner)}
    exec(f"def bound({', '.join(arguments)}):\n    return inner({', '.join(arguments + names)})",
         made)
    made["bound"].__name__ = function.__name__
    return made["bound"]


def _without(options: dict[str, Any], name: str) -> dict[str, Any]:
    return {key: value for key, value in options.items() if key != name}


def _names(code: CodeType) -> set[str]:
    """Global names that a function uses, those of functions within it included."""
    inner = (c for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*map(_names, inner))
