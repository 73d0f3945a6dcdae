"""Rates of a user's function of time, derived from it by SymPy.

The function is called with a symbol in place of the time, and SymPy's functions in place of those
of `math` and NumPy.
"""

import math
from collections.abc import Callable
from types import FunctionType, ModuleType

import numpy as np

from sebody.basics.errors import InputError
from sebody.model.functions import rebuilt

# names of NumPy that SymPy has others for; all others are the same in both
NAMES = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2",
         "arcsinh": "asinh", "arccosh": "acosh", "arctanh": "atanh", "fabs": "Abs", "abs": "Abs",
         "absolute": "Abs", "power": "Pow", "pow": "Pow", "float64": "sympify"}


def rates_of(function: Callable[[float], float], what: str
             ) -> tuple[Callable[[float], float], Callable[[float], float]]:
    """First and second derivative of a function of time, as Python functions.

    Raises
    ------
    InputError
        SymPy cannot follow what the function does, such as an `if` that depends on the time; the
        message begins with `what` it is.
    """
    import sympy  # takes 0.4 s

    t = sympy.Symbol("t", real=True)
    try:
        value = sympy.sympify(_symbolic(getattr(function, "py_func", function))(t))
        rates = [sympy.diff(value, t, k) for k in (1, 2)]
        if not value.free_symbols <= {t} or any(
                rate.has(sympy.Derivative, sympy.Subs, sympy.DiracDelta) for rate in rates):
            raise TypeError("it has no derivative in closed form")
        return tuple(sympy.lambdify(t, rate, modules="math", cse=True) for rate in rates)
    except Exception as error:      # whatever the user's function does with a symbol
        name = getattr(function, "__name__", function)
        raise InputError(f"{what} {name!r} cannot be differentiated ({error}): use only "
                         "arithmetic, math and numpy in it and no `if` on the time, or give three "
                         "functions (value, rate, second rate), a table, or a ready profile such "
                         "as rest_to_rest or piecewise") from error


def integrals_of(function: Callable[[float], float], what: str
                 ) -> tuple[Callable[[float], float], Callable[[float], float],
                            Callable[[float], float]]:
    """Second and first integral of a function of time, both zero at t = 0, and the function.

    Raises
    ------
    InputError
        SymPy cannot follow what the function does, or finds no integral in closed form; the
        message begins with `what` it is.
    """
    import sympy  # takes 0.4 s
    from sympy.integrals.manualintegrate import manualintegrate

    t = sympy.Symbol("t", real=True)
    found = [sympy.S.Zero] * 2
    try:
        value = sympy.sympify(_symbolic(getattr(function, "py_func", function))(t))
        if not value.free_symbols <= {t}:
            raise TypeError("it depends on more than the time")
        last = value
        for k in (1, 0):
            whole = manualintegrate(sympy.expand(last), t)
            found[k] = last = whole - whole.subs(t, 0)
            if last.has(sympy.Integral) or not last.subs(t, 1).is_finite:
                raise TypeError("it has no integral in closed form")
        return tuple(sympy.lambdify(t, one, modules="math", cse=True) for one in (*found, value))
    except Exception as error:      # whatever the user's function does with a symbol
        name = getattr(function, "__name__", function)
        raise InputError(f"{what} {name!r} cannot be integrated ({error}): give a table of its "
                         "values, or a ready profile such as harmonic or piecewise") from error


class _Symbols:
    """Replaces `math` or NumPy while a function is traced."""

    def __getattr__(self, name: str) -> object:
        import sympy

        return getattr(sympy, NAMES.get(name, name))


def _symbolic(function: Callable) -> Callable:
    """A copy of a function whose mathematics is SymPy's, of the functions it calls, too."""
    return rebuilt(function, _replaced)


def _replaced(value: object) -> object:
    """SymPy's counterpart of a module or function; everything else as it is."""
    if isinstance(value, ModuleType):
        return _Symbols() if value in (math, np) else value
    value = getattr(value, "py_func", value)        # of what Numba has compiled
    if isinstance(value, FunctionType):
        return _symbolic(value)
    name = getattr(value, "__name__", "")
    if callable(value) and value in (getattr(math, name, None), getattr(np, name, None)):
        return getattr(_Symbols(), name)
    return value
