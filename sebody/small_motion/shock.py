"""Shock spectra of histories of acceleration, and combination of the peaks of modes.

A shock spectrum is the largest response of oscillators ``x'' + 2 zeta omega x' + omega^2 x = -a``
to an acceleration a of their base that is linear between its rows. Every step is exact (N. C. Nigam
and P. C. Jennings, Bulletin of the Seismological Society of America 59, 1969, p. 909).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief

STEP = 0.2          # of omega t, longest: errors of peaks are STEP^4 / 384, 4e-6
MOST = 2_000_000    # steps
BLOCK = 1000        # steps whose coefficients are stored at once
RULES = "SRSS", "CQC"


class ShockSpectrum(NamedTuple):
    """Largest responses of oscillators to a motion of their base; see `shock_spectrum`."""

    frequency: NDArray      # (m,) natural frequencies, undamped [1/time]
    damping: float          # part of critical damping
    acceleration: NDArray   # (m,) largest absolute value of the absolute acceleration
    displacement: NDArray   # (m,) largest absolute value of the displacement against the base

    def __repr__(self) -> str:
        return brief(self)


def shock_spectrum(t: ArrayLike, acceleration: ArrayLike, frequencies: ArrayLike,
                   damping: float = 0.05) -> ShockSpectrum:
    """Shock (response) spectrum of a history of the acceleration of a base.

    Parameters
    ----------
    t : (k,)
        Times, ascending; steps need not be equal.
    acceleration : (k,)
        Acceleration of the base, linear between the times, zero after the last one. At the first
        time oscillators are at rest.
    frequencies : (m,)
        Natural frequencies of oscillators, in cycles per unit of time.
    damping : float
        Part of critical damping, from 0 to below 1.

    Returns
    -------
    ShockSpectrum
        Peaks during the history and after it, with those between the times.

    Raises
    ------
    InputError
        Times that do not ascend, frequencies that are not positive, or too high for so long a
        history.
    """
    t = inputs.vector(t, "t")
    if len(t) < 2 or np.any(np.diff(t) <= 0.0):
        raise inputs.refusal("t", t, "give two times or more, ascending")
    a = inputs.vector(acceleration, "acceleration", len(t))
    f = inputs.vector(frequencies, "frequencies")
    if not len(f) or f.min() <= 0.0:
        raise inputs.refusal("frequencies", f, "give one or more, all positive")
    damping = inputs.number(damping, "damping", least=0.0, below=1.0)
    omega = 2 * np.pi * f
    fine = _refined(t, omega.max())
    state, peaks = np.zeros((2, len(f))), np.zeros((2, len(f)))
    base = np.interp(fine, t, a)
    for first in range(0, len(fine) - 1, BLOCK):
        rows = slice(first, first + BLOCK + 1)
        state = _advance(state, peaks, np.diff(fine[rows])[:, None], base[rows], omega, damping)
    # of a free vibration the largest value is at its start, or within a quarter of a period
    after = int(np.ceil(np.pi / STEP))
    _advance(state, peaks, np.tile(STEP / omega, (after, 1)), np.zeros(after + 1), omega, damping)
    return ShockSpectrum(f, damping, peaks[0], peaks[1])


def _refined(t: NDArray, omega: float) -> NDArray:
    """Times with others between them, no two further apart than an oscillator's steps.

    Raises
    ------
    InputError
        More than `MOST` of them.
    """
    parts = np.ceil(np.diff(t) * omega / STEP)
    if parts.sum() > MOST:
        f = omega / (2 * np.pi)
        raise InputError(f"frequencies reach {f:.6g}, of which the history has "
                         f"{f * (t[-1] - t[0]):.3g} periods: leave out the highest")
    counts = parts.astype(int)
    before = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(counts.sum()) - before) / np.repeat(counts, counts)
    return np.append(np.repeat(t[:-1], counts) + share * np.repeat(np.diff(t), counts), t[-1])


def _advance(state: NDArray, peaks: NDArray, h: NDArray, base: NDArray, omega: NDArray,
             damping: float) -> NDArray:
    """Displacements and velocities after some steps, (2, m); `peaks` grow.

    Parameters
    ----------
    h : (steps, 1 or m)
    base : (steps + 1,)
        Acceleration of the base.
    """
    decay, turning = damping * omega, omega * np.sqrt(1 - damping**2)
    fading = np.exp(-decay * h)
    cosine, sine = fading * np.cos(turning * h), fading * np.sin(turning * h) / turning
    slope, start = np.diff(base)[:, None] / h, base[:-1, None]
    # the particular solution p0 + p1 t, and the free vibration that starts from the rest of it
    p0, p1 = 2 * damping * slope / omega**3 - start / omega**2, -slope / omega**2
    xx, xv = cosine + decay * sine, sine
    vx, vv = -omega**2 * sine, cosine - decay * sine
    x_added = p0 + p1 * h - xx * p0 - xv * p1
    v_added = p1 - vx * p0 - vv * p1
    x, v = np.empty((2, len(h) + 1, len(omega)))
    x[0], v[0] = state
    for k in range(len(h)):
        x[k + 1] = xx[k] * x[k] + xv[k] * v[k] + x_added[k]
        v[k + 1] = vx[k] * x[k] + vv[k] * v[k] + v_added[k]
    absolute = -2 * decay * v - omega**2 * x
    seconds = absolute - base[:, None]      # of the displacement against the base
    rates = -2 * decay * seconds - omega**2 * v
    peaks[0] = np.maximum(peaks[0], _largest(absolute, rates, h))
    peaks[1] = np.maximum(peaks[1], _largest(x, v, h))
    return np.stack([x[-1], v[-1]])


def _largest(y: NDArray, rate: NDArray, h: NDArray) -> NDArray:
    """Largest absolute values, (m,), at steps and between them by Hermite's cubics."""
    a, b = rate[:-1] * h, rate[1:] * h
    rise = y[1:] - y[:-1]
    square, cube = 3 * rise - 2 * a - b, a + b - 2 * rise
    turns = a * b < 0.0
    root = np.sqrt(np.where(turns, square**2 - 3 * a * cube, 0.0))
    below = np.where(turns, np.where(a > 0, root, -root) - square, 1.0)
    at = np.where(turns, a / np.where(below == 0.0, 1.0, below), 0.0)
    between = y[:-1] + at * (a + at * (square + at * cube))
    return np.maximum(np.abs(y).max(axis=0), np.abs(between).max(axis=0))


def combined(values: ArrayLike, frequencies: ArrayLike, damping: ArrayLike = 0.05,
             rule: str = "SRSS") -> NDArray:
    """Combine the peak responses of modes to one shock or earthquake.

    Parameters
    ----------
    values : (m, ...) array_like
        Peaks of the modes with their signs: participation factor times shape times the value of a
        spectrum.
    frequencies : (m,)
        Natural frequencies.
    damping : float or (m,) array_like
        Parts of critical damping, of all modes or of each.
    rule : {"SRSS", "CQC"}
        Root of the sum of squares, of modes whose frequencies are far apart, or complete quadratic
        combination with the correlations of responses to white noise (A. Der Kiureghian, Earthquake
        Engineering and Structural Dynamics 9, 1981, p. 419).

    Returns
    -------
    (...) ndarray

    Raises
    ------
    InputError
        Sizes that do not fit, frequencies that are not positive, or CQC without damping.
    """
    inputs.choice(rule, "rule", RULES)
    values = inputs.reals(values, "values", "give a row of peaks of each mode")
    if not values.ndim or not values.size or not np.isfinite(values).all():
        raise inputs.refusal("values", values, "give a row of finite peaks of each mode")
    w = inputs.vector(frequencies, "frequencies", len(values))
    if w.min() <= 0.0:
        raise inputs.refusal("frequencies", w, "give positive ones")
    ratios = inputs.reals(damping, "damping", "give parts of critical damping")
    z = (np.full(len(w), inputs.number(damping, "damping", least=0.0)) if not ratios.ndim
         else inputs.vector(damping, "damping", len(w)))
    if z.min() < 0.0:
        raise inputs.refusal("damping", damping, "give parts of critical damping, none negative")
    if rule == "SRSS":
        return np.sqrt(np.sum(values**2, axis=0))
    if z.min() == 0.0:
        raise inputs.refusal("damping", damping, "CQC needs damping of all modes; SRSS has none")
    squares = np.einsum("i...,ij,j...->...", values, _correlation(w, z), values)
    return np.sqrt(np.maximum(squares, 0.0))


def _correlation(w: NDArray, z: NDArray) -> NDArray:
    """Correlations of oscillators' responses to white noise, (m, m), by frequency and damping."""
    zz, ww = np.outer(z, z), np.outer(w, w)
    squares = np.add.outer(w**2, w**2)
    return (8 * np.sqrt(zz * ww) * np.add.outer(z * w, z * w) * ww
            / (np.subtract.outer(w**2, w**2)**2 + 4 * zz * ww * squares
               + 4 * np.add.outer(z**2, z**2) * ww**2))
