"""Predefined time functions of drives and loads: they have exact rates and compile nothing.

All but `harmonic` begin at `start` with the value `origin`, keep it before, and keep their last
value afterwards. For drives this is the displacement or angle, which counts from where the model
starts: the value at t = 0 is taken off. A drive may have a speed at t = 0, with which the
simulation starts; later on its speed must not jump.
"""

from __future__ import annotations

from math import copysign, inf, sqrt

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics.errors import InputError
from sebody.basics.inputs import array, items, number, shown
from sebody.model.histories import of_cubics, spline_of
from sebody.model.time_functions import TimeFunction, same_waves

SHORTEST = 1e-9     # time at constant speed, relative to that of the rise, which is left out


def rest_to_rest(distance: float, duration: float, start: float = 0.0,
                 origin: float = 0.0) -> TimeFunction:
    """From rest to rest, smooth in speed and acceleration, by a polynomial of degree five.

    ``origin + distance (10 u^3 - 15 u^4 + 6 u^5)`` with ``u = (t - start) / duration``. The
    largest speed is ``15/8 distance / duration``.

    Raises
    ------
    InputError
        Arguments that are not finite, or no positive duration.
    """
    d, origin = number(distance, "distance"), number(origin, "origin")
    T, start = number(duration, "duration", above=0.0), number(start, "start")
    return TimeFunction((start, start + T),
                   ((origin, 0.0, 0.0, 10.0 * d / T**3, -15.0 * d / T**4, 6.0 * d / T**5),
                    (origin + d,)))


def trapezoidal(distance: float, speed: float, acceleration: float, start: float = 0.0,
                origin: float = 0.0) -> TimeFunction:
    """From rest to rest with a speed that rises, is constant and falls.

    Where the distance is too short for the speed, it falls as soon as it has risen.

    Parameters
    ----------
    distance : float
        From the first to the last position [length] or [rad].
    speed, acceleration : float
        Largest ones, positive; the sign is that of the distance.

    Raises
    ------
    InputError
        Arguments that are not finite, no positive speed and acceleration, or no distance.
    """
    d, origin, start = (number(v, what) for v, what in (
        (distance, "distance"), (origin, "origin"), (start, "start")))
    v = number(speed, "speed", above=0.0)
    a = number(acceleration, "acceleration", above=0.0)
    if d == 0.0:
        raise InputError("distance is 0: give one that is not zero")
    v = min(v, sqrt(a * abs(d)))
    rise, level = v / a, abs(d) / v - v / a
    sign = copysign(1.0, d)
    v, a, way = sign * v, sign * a, 0.5 * sign * a * rise**2
    times = [start, start + rise, start + rise + level, start + 2.0 * rise + level]
    pieces = [(origin, 0.0, 0.5 * a), (origin + way, v), (origin + d - way, v, -0.5 * a),
              (origin + d,)]
    if level < SHORTEST * rise:
        del times[1], pieces[1]
    return TimeFunction(tuple(times), tuple(pieces)).with_corners()


def ramp(rate: float, duration: float = inf, start: float = 0.0,
         origin: float = 0.0) -> TimeFunction:
    """A constant rate for a while, without end by default: ``origin + rate (t - start)``.

    For a drive: a constant speed from t = 0 on, at which the simulation starts.

    Raises
    ------
    InputError
        Arguments that are not finite, or no positive duration.
    """
    r, origin, start = (number(v, what) for v, what in (
        (rate, "rate"), (origin, "origin"), (start, "start")))
    if duration == inf:
        return TimeFunction((start,), ((origin, r),)).with_corners()
    T = number(duration, "duration", above=0.0,
               remedy="give a positive number: ramp(rate=..., duration=...)")
    return TimeFunction((start, start + T), ((origin, r), (origin + r * T,))).with_corners()


def harmonic(amplitude: float, omega: float, phase: float = 0.0, mean: float = 0.0) -> TimeFunction:
    """``mean + amplitude sin(omega t + phase)``, omega the angular frequency [rad/time].

    Raises
    ------
    InputError
        Arguments that are not finite.
    """
    A, w, p, mean = (number(v, what) for v, what in (
        (amplitude, "amplitude"), (omega, "omega"), (phase, "phase"), (mean, "mean")))
    return TimeFunction((0.0,), ((mean,),), ((A, w, p),))


def spline(rows: ArrayLike, rates: tuple[float, float] = (0.0, 0.0)) -> TimeFunction:
    """A table as a cubic spline, or with its rates.

    Parameters
    ----------
    rows : (n, 2) or (n, 3), n >= 2
        Time and value, or time, value and rate; times ascending.
    rates : (2,)
        At the ends of the table where the rows have none.

    Raises
    ------
    InputError
        Other shapes, numbers that are not finite, times that do not increase.
    """
    remedy = "give at least two rows (t, value) or (t, value, rate)"
    rows = items(rows, "table", remedy)
    width = 3 if len(rows) and np.size(rows[0]) == 3 else 2
    table = array(rows, "table", (None, width), remedy=remedy)
    if len(table) < 2:
        raise InputError(f"table is {shown(rows)}: {remedy}")
    if (np.diff(table[:, 0]) <= 0).any():
        raise InputError("times of a table must increase: sort the rows and merge equal times")
    if width == 2:
        ends = array(rates, "rates", (2,))
        times, values = table.T
        return spline_of(times, values, (ends[0], ends[1])).with_corners()
    from scipy.interpolate import CubicHermiteSpline  # takes 0.2 s to import

    return of_cubics(table[:, 0], CubicHermiteSpline(*table.T).c, table[-1, 1]).with_corners()


def piecewise(*parts: tuple[float, TimeFunction | float]) -> TimeFunction:
    """Profiles one after the other: from each time on the one beside it, or a constant number.

    ``piecewise((0, rest_to_rest(2.0, 1.0)), (3, rest_to_rest(-2.0, 1.0, start=3, origin=2.0)))``
    goes there and back. All of them count the same time. Before the first time the value is that
    which it begins with.

    Raises
    ------
    InputError
        No parts, times that do not increase, a compiled function.
    """
    what = "parts of a piecewise function"
    if not parts:
        raise InputError(f"{what} are missing: give pairs (time, profile)")
    times, profiles = [], []
    for part in parts:
        pair = items(part, "part of a piecewise function", "give a pair (time, profile)")
        if len(pair) != 2:
            raise InputError(f"part of a piecewise function is {shown(part)}: give a pair (time, "
                             "profile)")
        times.append(number(pair[0], "time of a part"))
        profiles.append(_profile(pair[1]))
    if (np.diff(times) <= 0).any():
        raise InputError(f"times of {what} must increase: they are {shown(times)}")
    cut = [_between(profile, *interval) for profile, *interval in zip(
        profiles, times, [*times[1:], inf], strict=True)]
    return TimeFunction(tuple(t for part in cut for t in part.times),
                   tuple(piece for part in cut for piece in part.pieces),
                   same_waves(cut)).with_corners()


def _profile(given: object) -> TimeFunction:
    if isinstance(given, TimeFunction):
        if given.functions:
            raise InputError("part of a piecewise function is a compiled function: give a ready "
                             "profile or a number")
        return given
    return TimeFunction((0.0,), ((number(given, "part of a piecewise function",
                                    remedy="give a ready profile or a number"),),))


def _between(profile: TimeFunction, first: float, last: float) -> TimeFunction:
    """The pieces of a profile in an interval, the first one moved to where this begins."""
    if first < profile.times[0]:
        constant = TimeFunction((first,), ((profile.at(first)[0],),))
        rest = _between(profile, profile.times[0], last)
        parts = [constant, rest] if profile.times[0] < last else [constant]
        return TimeFunction(sum((p.times for p in parts), ()), sum((p.pieces for p in parts), ()),
                       same_waves(parts))
    k = int(np.searchsorted(profile.times, first, side="right")) - 1
    moved, wave = profile.moved(first)
    end = int(np.searchsorted(profile.times, last, side="left"))
    waves: tuple[tuple[float, float, float], ...] = ()
    if profile.waves:
        waves = (wave, *profile.waves[k + 1:end])
    return TimeFunction((first, *profile.times[k + 1:end]), (moved, *profile.pieces[k + 1:end]),
                        waves)
