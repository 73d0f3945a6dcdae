"""Motions of drives: time functions with two derivatives, of which only the second may jump."""

from collections.abc import Sequence
from dataclasses import replace
from numbers import Number

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.compiler.user_functions import UserFunction
from sebody.model.derivatives import rates_of
from sebody.model.functions import compiled_history
from sebody.model.histories import Source, is_function_with_rates, spline_of
from sebody.model.history_rows import table
from sebody.model.time_functions import MOTION, NEAR, TimeFunction

SAMPLES = (0.137, 0.61, 1.13, 2.71)     # times at which rates given by a user are tested


def motion(source: Source) -> TimeFunction:
    """The motion of a drive, see `history`, less its value at t = 0."""
    return history(source).from_zero()


def history(source: Source) -> TimeFunction:
    """The motion of a drive as it is given: a position and its first two derivatives.

    Parameters
    ----------
    source : table, function, tuple of three functions or ready profile
        A table ``[(t, value), ...]`` becomes a cubic spline, at rest at both ends and outside.
        The rates of a function of time are derived from it by SymPy; three functions are value,
        rate and second rate.

    Raises
    ------
    InputError
        None of these, functions that are not each other's derivatives, a function that cannot be
        compiled or differentiated, a position or rate that jumps.
    """
    if isinstance(source, TimeFunction):
        if len(source.functions) == 1:
            value = source.functions[0]
            rates = (compiled_history(f, MOTION) for f in rates_of(value.function, MOTION))
            source = replace(source, functions=(value, *rates))
        _check_rates(source.functions)
        _refuse_jumps(source)
        return source
    if callable(source):
        source = (source, *rates_of(source, MOTION))
    if is_function_with_rates(source):
        functions = tuple(compiled_history(f, MOTION) for f in source)
        _check_rates(functions)
        return TimeFunction(functions=functions)
    if isinstance(source, Number):
        raise InputError(f"motion of a drive is the constant {inputs.shown(source)}: give a "
                         "table, a function of time or a ready profile, or fix the node")
    times, values = table(source, MOTION)
    if len(times) < 2:
        raise InputError("the motion of a drive has one row: give at least two rows (t, value), "
                         "or fix the node")
    return spline_of(times, values, (0.0, 0.0)).with_corners()


def _refuse_jumps(given: TimeFunction) -> None:
    """Refuse a motion that no body can follow: at corners of its pieces, or those declared."""
    for k, what in enumerate(("position", "rate")):
        for t in given.abrupt(k):
            before, after = (given.at(t * (1.0 + side))[k] for side in (-NEAR, NEAR))
            raise InputError(
                f"motion of a drive: its {what} jumps from {before:.6g} to {after:.6g} at t = "
                f"{t:.6g}, which no body can follow: use rest_to_rest, trapezoidal or a spline; "
                "only at t = 0 may a drive begin with a speed")


def _check_rates(functions: Sequence[UserFunction]) -> None:
    """Refuse a rate that is not the derivative of the function before it."""
    if not functions:
        return
    for k, what in ((0, "second function is not the derivative of the first"),
                    (1, "third function is not the derivative of the second")):
        f, rate = functions[k].ctypes, functions[k + 1].ctypes
        for t in SAMPLES:
            slope = (f(t + 1e-5) - f(t - 1e-5)) / 2e-5
            size = max(abs(slope), abs(rate(t)), abs(f(t)), 1e-300)
            if not abs(slope - rate(t)) < 1e-4 * size:
                raise InputError(f"motion of a drive: the {what}: at t = {t} it is {rate(t):.6g}, "
                                 f"differences give {slope:.6g}")
