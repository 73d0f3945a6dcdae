"""Gravity of a model: a uniform field, constant or a function of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files.csv_files import csv_rows
from sebody.model.arguments import named_axis, vector
from sebody.model.histories import time_function
from sebody.model.mechanism import Mechanism
from sebody.model.parts import GravityCourse
from sebody.model.time_functions import TimeFunction

Course: TypeAlias = "ArrayLike | str | Path | Callable[[float], float] | TimeFunction"
AXES = "xyz"
SHORT = 1e-6        # times between which a rate is a difference


def gravity(model: Mechanism, field: ArrayLike | str | Path | Callable[[float], Sequence[float]],
            amplitude: Course | None = None) -> None:
    """Uniform gravity on every body, through its (reduced) mass; constant or a function of time.

    Its potential is ``-g . m x``. Where it changes with time, this supplies energy: the work of
    the source ``gravity`` in results.

    Parameters
    ----------
    field : (3,), planar (2,), name of an axis, table, path of a CSV file, or function
        Acceleration of free fall [length/time^2]. Over time: rows (t, x, y, z), planar (t, x, y),
        linear between them and constant outside, two rows of one time being a jump; or a function
        of time that returns the components; or one number, function, table or profile for each.
    amplitude : float, (n, 2) array_like, path of a CSV file, callable or TimeFunction, optional
        Factor of a constant field over time, as of `force`.

    Raises
    ------
    InputError
        Another number of values than coordinates, values that are not finite, or a function that
        cannot be compiled.

    Examples
    --------
    >>> model.gravity("-z", [(0.0, 0.0), (2.0, 9.81)])       # it begins slowly
    """
    what = "gravity"
    if (courses := _components(model, field, what)) is None:
        constant = vector(model, named_axis(cast(ArrayLike, field), model.dimension, what), what)
        if amplitude is None:
            model.gravity_field, model.gravity_courses = constant, []
            return
        courses = [GravityCourse(what, constant, _course(amplitude, f"{what}: amplitude"))]
    elif amplitude is not None:
        raise InputError(f"{what} has components over time and an amplitude: give a constant field "
                         "with an amplitude, or leave it out")
    model.gravity_field, model.gravity_courses = np.zeros(model.dimension), courses


def gravity_at(model: Mechanism, t: float) -> NDArray:
    """Acceleration of free fall at a time, (D,)."""
    return model.gravity_field + sum(
        (one.direction * one.time_function.at(t)[0] for one in model.gravity_courses),
        np.zeros(model.dimension))


def has_gravity(model: Mechanism) -> bool:
    """Tell whether there is gravity at any time."""
    return bool(model.gravity_field.any() or model.gravity_courses)


def rate_at(course: TimeFunction, t: float) -> float:
    """Rate of an amplitude at a time; of a function by differences, from t = 0 on."""
    if not course.functions:
        return float(course.at(t)[1])
    before, after = max(t - SHORT, 0.0), t + SHORT
    return float((course.at(after)[0] - course.at(before)[0]) / (after - before))


def _components(model: Mechanism, field: Any, what: str) -> list[GravityCourse] | None:
    """Gravity whose components are functions of time; None of a constant vector."""
    count = model.dimension
    if _is_file(field):
        field = csv_rows(Path(field), what, 1 + count)
    if isinstance(field, TimeFunction):
        raise InputError(f"{what} is one profile: give a constant field and the profile as its "
                         "amplitude=, or one for each component")
    given: list[Any]
    if callable(field):
        given = [_component(field, k, count, what) for k in range(count)]
    elif isinstance(field, list | tuple) and len(field) == count and any(
            callable(one) or isinstance(one, TimeFunction) or np.ndim(one) == 2 for one in field):
        given = list(field)
    elif isinstance(field, str):
        return None
    else:
        rows = inputs.reals(field, what, f"give {count} finite numbers")
        if rows.ndim != 2 or len(rows) == 1:
            return None
        if rows.shape[1] != 1 + count:
            raise InputError(f"{what} is a table of {rows.shape[1]} columns: give rows of a time "
                             f"and {count} numbers")
        given = [rows[:, (0, 1 + k)] for k in range(count)]
    made = [GravityCourse(f"{what} along {AXES[k]}", direction,
                          _course(one, f"{what}: component {AXES[k]}"))
            for k, (one, direction) in enumerate(zip(given, np.eye(count), strict=True))]
    return [one for one in made if not _is_zero(one.time_function)]


def _course(given: Any, what: str) -> TimeFunction:
    """A time function of gravity, also from a file."""
    return time_function(csv_rows(Path(given), what, 2) if _is_file(given) else given)


def _is_file(given: Any) -> bool:
    return isinstance(given, PathLike) or isinstance(given, str) and given.endswith(".csv")


def _is_zero(course: TimeFunction) -> bool:
    return not course.functions and not course.waves and not any(map(any, course.pieces))


def _component(function: Callable[[float], Sequence[float]], k: int, count: int, what: str
               ) -> Callable[[float], float]:
    """One component of a function of time."""
    try:
        found = np.shape(function(0.0))
    except Exception as error:
        raise InputError(f"{what} is a function that fails at t = 0, {error}: give a function of "
                         f"time that returns {count} numbers") from error
    if found != (count,):
        raise InputError(f"{what} is a function that returns {inputs.shown(function(0.0))}: let it "
                         f"return {count} numbers")
    compiled = njit(getattr(function, "py_func", function))

    def component(t: float) -> float:
        return compiled(t)[k]
    return component
