"""Time functions of loads and drives: pieces of formulas, or functions of a user.

A time function of pieces is on each interval a polynomial of at most degree five plus a harmonic:
see `TimeFunction`. Loads need the value alone, drives its first two derivatives, too. What users
give is made into one by `sebody.model.histories`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from math import comb, cos, sin

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sebody.compiler.user_code import Source, compile_history
from sebody.compiler.user_functions import UserFunction
from sebody.contract.layout import CLOCK, INPUT
from sebody.model.functions import source

LOAD, MOTION = "time function of a load", "motion of a drive"
COEFFICIENTS = 6        # most of a polynomial
SMALL = 1e-9            # jump of a value or rate, relative to its size, that is rounding
NEAR = 1e-8             # distance at which a function is looked at beside a corner, relative to it
STEEP = 10.0            # a jump exceeds the changes beside it by this factor


@dataclass(frozen=True)
class TimeFunction:
    """A function of time with its first two derivatives.

    From the time t_i on, and until the next one, the value is
    ``sum_k c_k x^k + A sin(w x + p)`` with ``x = t - t_i``; before the first time it is constant.
    """

    times: tuple[float, ...] = (0.0,)
    pieces: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0, 0.0),)     # c_0, c_1, ... of each
    waves: tuple[tuple[float, float, float], ...] = ()      # A, w, p of each; none at all: zeros
    functions: tuple[UserFunction, ...] = ()    # in place of pieces: value and its rates
    corners: tuple[float, ...] = ()     # times at which it is not smooth: variable steps end there
    is_time: bool = False               # the value is the time itself, for functions of time
    is_input: bool = False              # an input: its piece has start, lag and largest rate
    limits: tuple[float, float] | tuple[()] = ()    # least and largest value of an input, if any

    @property
    def addresses(self) -> tuple[int, int, int]:
        """Addresses of the compiled value and its rates, 0 where there is none; CLOCK of time.

        INPUT of an input, whose place is put behind it.
        """
        if self.is_input:
            return INPUT, 0, 0
        if self.is_time:
            return CLOCK, 0, 0
        value, rate, second = (*[f.address for f in self.functions], 0, 0, 0)[:3]
        return value, rate, second

    def at(self, t: float) -> NDArray:
        """Value and two rates at a time, (3,); at the time of a piece those of this piece."""
        if self.is_input:
            return np.array([self.pieces[0][0], 0.0, 0.0])
        if self.functions:
            return np.array([f.ctypes(t) for f in self.functions] + [0.0] * (
                3 - len(self.functions)))
        k = int(np.searchsorted(self.times, t, side="right")) - 1
        return self.of_piece(max(k, 0), t) if k >= 0 else np.array(
            [self.of_piece(0, self.times[0])[0], 0.0, 0.0])

    def values(self, times: NDArray) -> NDArray:
        """Values at some times, (n,)."""
        if self.is_input:
            return np.full(len(times), self.pieces[0][0])
        if self.functions:
            return np.array([self.functions[0].ctypes(t) for t in times])
        return self.after(times, np.zeros((len(times), 1)))[:, 0]

    def after(self, times: NDArray, later: NDArray) -> NDArray:
        """Values of the pieces of some times, (n,), at later ones, (n, k); of no function."""
        starts = np.array(self.times)
        row = np.maximum(np.searchsorted(starts, times, side="right") - 1, 0)
        x = np.maximum((times - starts[row])[:, None] + later, 0.0)
        totals = (self.polynomials()[row][:, None] * x[..., None]**np.arange(COEFFICIENTS)
                  ).sum(axis=-1)
        if self.waves:
            A, w, p = np.array(self.waves)[row].T[..., None]
            totals += A * np.sin(w * x + p)
        return totals

    def polynomials(self) -> NDArray:
        """Coefficients of all pieces, (pieces, COEFFICIENTS)."""
        rows = np.zeros((len(self.pieces), COEFFICIENTS))
        if len(sizes := set(map(len, self.pieces))) == 1:       # as of tables, of thousands
            rows[:, :sizes.pop()] = self.pieces
            return rows
        for row, coefficients in zip(rows, self.pieces, strict=True):
            row[:len(coefficients)] = coefficients
        return rows

    def of_piece(self, k: int, t: float) -> NDArray:
        """Value and two rates of a piece, also outside its interval."""
        x = t - self.times[k]
        values = _with_rates(self.pieces[k], x)
        if self.waves:
            A, w, p = self.waves[k]
            s, c = sin(w * x + p), cos(w * x + p)
            values += A * np.array([s, w * c, -w * w * s])
        return values

    def moved(self, t: float) -> tuple[tuple[float, ...], tuple[float, float, float]]:
        """Coefficients and harmonic of the piece at a time, counted from this time on."""
        k = int(np.searchsorted(self.times, t, side="right")) - 1
        x = t - self.times[k]
        c = [*self.pieces[k], *[0.0] * (COEFFICIENTS - len(self.pieces[k]))]
        A, w, p = self.waves[k] if self.waves else (0.0, 0.0, 0.0)
        return tuple(sum(comb(j, i) * c[j] * x**(j - i) for j in range(i, COEFFICIENTS))
                     for i in range(COEFFICIENTS)), (A, w, p + w * x)

    def described(self) -> str:
        """Description in a few words."""
        if self.is_input:
            return f"input, {self.pieces[0][0]:.6g} at the start"
        if self.functions:
            return f"function {getattr(self.functions[0].function, '__name__', '')}".rstrip()
        if len(self.pieces) == 1 and not self.waves and not any(self.pieces[0][1:]):
            return f"constant {self.pieces[0][0]:.6g}"
        return f"{len(self.pieces)} pieces, t = {self.times[0]:.6g} to {self.times[-1]:.6g}"

    def __repr__(self) -> str:
        return f"<TimeFunction: {self.described()}>"

    def jumps(self) -> list[tuple[float, NDArray, NDArray]]:
        """Times after the start at which value or rates jump, with what they are on both sides.

        What does not jump but for rounding is the same on both sides.
        """
        own = np.array([k for k, t in enumerate(self.times) if t > 0.0], dtype=int)
        if not own.size:
            return []
        t = np.array(self.times)[own]
        after, before = self._at_each(own, t), self._at_each(np.maximum(own - 1, 0), t)
        size = np.maximum(np.abs(after), self._at_each(np.maximum(own - 1, 0), t, sums=True))
        if own[0] == 0:
            before[0], size[0] = [after[0, 0], 0.0, 0.0], np.abs(after[0])
        jump = np.abs(after - before) > SMALL * size
        return [(self.times[own[i]], np.where(jump[i], before[i], after[i]), after[i])
                for i in np.flatnonzero(jump.any(axis=1))]

    def _at_each(self, pieces: NDArray, t: NDArray, sums: bool = False) -> NDArray:
        """Value and two rates of some pieces, each at a time: tables have thousands of them.

        With `sums` the sums of the sizes of what is added up, as it may cancel but for rounding.
        """
        x, coefficients = t - np.array(self.times)[pieces], self.polynomials()[pieces].T
        if sums:
            x, coefficients = np.abs(x), np.abs(coefficients)
        value, rate, half = np.zeros((3, len(t)))
        for c in coefficients[::-1]:
            half = half * x + rate
            rate = rate * x + value
            value = value * x + c
        values = np.stack([value, rate, 2.0 * half], axis=1)
        if self.waves:
            A, w, p = np.array(self.waves)[pieces].T
            s, c = (np.ones_like(x), np.ones_like(x)) if sums else (np.sin(w * x + p),
                                                                    np.cos(w * x + p))
            of_waves = np.stack([A * s, A * w * c, -A * w * w * s], axis=1)
            values += np.abs(of_waves) if sums else of_waves
        return values

    def abrupt(self, rate: int) -> list[float]:
        """Times after the start at which the value jumps (0), or its first or second rate (2)."""
        if not self.functions:
            return [t for t, before, after in self.jumps() if before[rate] != after[rate]]
        return [t for t in self.corners if t > 0.0 and _jumps(self.functions[rate].ctypes, t)]

    def with_corners(self) -> TimeFunction:
        """This time function of pieces, its corners where its value or a rate jumps."""
        return replace(self, corners=tuple(t for t, *_ in self.jumps()))

    def from_zero(self) -> TimeFunction:
        """The same less its value at t = 0."""
        value = self.at(0.0)[0]
        if value == 0.0 or not np.isfinite(value):
            return self
        if self.functions:
            return replace(self, functions=(_less(self.functions[0], value),
                                            *self.functions[1:]))
        return replace(self, pieces=tuple((c[0] - value, *c[1:]) for c in self.pieces))


def _with_rates(coefficients: Sequence[float], x: float) -> NDArray:
    """A polynomial and its first two derivatives: tables have thousands of them."""
    value = rate = half = 0.0
    for c in reversed(coefficients):
        half = half * x + rate
        rate = rate * x + value
        value = value * x + c
    return np.array([value, rate, 2.0 * half])


def same_waves(parts: Sequence[TimeFunction]) -> tuple[tuple[float, float, float], ...]:
    """Harmonics of all pieces of some time functions, zeros where one has none."""
    if not any(part.waves for part in parts):
        return ()
    none = (0.0, 0.0, 0.0)
    return tuple(wave for part in parts
                 for wave, _ in zip_longest(part.waves, part.pieces, fillvalue=none))


def _less(function: UserFunction, value: float) -> UserFunction:
    whole = source(function.function)
    inner = njit(whole.function)

    def less(t):
        return inner(t) - value
    made = compile_history(Source((whole.made_from, value), less), MOTION)
    made.function, made.read = function.function, function.read
    return made


def _jumps(function: Callable[[float], float], t: float) -> bool:
    """Tell whether a function jumps at a time: by more than it changes as near to it."""
    d = NEAR * abs(t)
    values = [function(t + x) for x in (-2.0 * d, -d, d, 2.0 * d)]
    beside = abs(values[1] - values[0]) + abs(values[3] - values[2])
    jump = abs(values[2] - values[1])
    return jump > STEEP * beside + SMALL * max(abs(values[1]), abs(values[2]))
