"""Rates of a user's function of time, derived from it by SymPy.

The function is called with a symbol in place of the time, and SymPy's functions in place of those
of `math` and NumPy.
"""

import math
from collections.abc import Callable
from types import CellType, CodeType, FunctionType, ModuleType

import numpy as np

from sebody.errors import InputError

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
        value = sympy.sympify(_symbolic(getattr(function, "py_func", function), {})(t))
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


class _Symbols:
    """What stands for `math` or NumPy while a function is followed."""

    def __getattr__(self, name: str) -> object:
        import sympy

        return getattr(sympy, NAMES.get(name, name))


def _symbolic(function: FunctionType, made: dict[int, FunctionType]) -> FunctionType:
    """A copy of a function whose mathematics is SymPy's, of the functions it calls, too."""
    if id(function) in made:
        return made[id(function)]
    names = _names(function.__code__)
    inner = dict(function.__globals__)
    copy = FunctionType(function.__code__, inner, function.__name__, function.__defaults__,
                        tuple(CellType() for _ in function.__closure__ or ()))
    copy.__kwdefaults__ = function.__kwdefaults__
    made[id(function)] = copy
    for name in names & inner.keys():
        inner[name] = _replaced(inner[name], made)
    for cell, own in zip(copy.__closure__ or (), function.__closure__ or (), strict=True):
        cell.cell_contents = _replaced(own.cell_contents, made)
    return copy


def _names(code: CodeType) -> set[str]:
    """Global names that a function uses, those of functions within it included."""
    inner = (c for c in code.co_consts if isinstance(c, CodeType))
    return set(code.co_names).union(*map(_names, inner))


def _replaced(value: object, made: dict[int, FunctionType]) -> object:
    """SymPy's counterpart of a module or function; everything else as it is."""
    if isinstance(value, ModuleType):
        return _Symbols() if value in (math, np) else value
    value = getattr(value, "py_func", value)        # of what Numba has compiled
    if isinstance(value, FunctionType):
        return _symbolic(value, made)
    name = getattr(value, "__name__", "")
    if callable(value) and value in (getattr(math, name, None), getattr(np, name, None)):
        return getattr(_Symbols(), name)
    return value
