"""Time functions of loads and drives in compiled code."""

import math

from sebody.compiler.decorators import compiled

# numbers of a piece: those of its polynomial by ascending powers, then amplitude, angular
# frequency and phase of its harmonic
POLYNOMIAL = 6
AMPLITUDE, OMEGA, PHASE = range(POLYNOMIAL, POLYNOMIAL + 3)
PIECE = POLYNOMIAL + 3
# numbers of a series of loads: port whose amplitude its columns are multiplied by, first time and
# number of its pieces, columns, coefficients of a piece, place of the first coefficient, and of the
# first amplitude in `State.loads`
SERIES = 7


@compiled
def piece_at(times, first, last, t):
    """The last of the pieces `first` to `last` that has begun at t; the first before all begin."""
    i, end = first, last
    while i < end:
        middle = (i + end + 1) // 2
        if times[middle] <= t:
            i = middle
        else:
            end = middle - 1
    return i


@compiled
def time_function_at(times, pieces, first, last, t, beside, out, at):
    """Value and two rates at t of the pieces `first` to `last`; constant before the first.

    At the time of a piece the value and rates are those of this piece: a motion that starts from
    speed has it at once. Pieces are chosen by the time ``t + beside``: of a jump at t a negative
    `beside` gives what is before it.
    """
    i = piece_at(times, first, last, t + beside)
    x = max(t - times[i], 0.0)
    polynomial_at(pieces, i, x, out, at)
    if pieces[i, AMPLITUDE] != 0.0:
        add_harmonic(pieces, i, x, out, at)
    if t + beside < times[first]:
        out[at + 1], out[at + 2] = 0.0, 0.0


@compiled
def set_series(series, times, values, t, beside, loads):
    """Amplitudes of the columns of all series at t, by one search for each; see `time_function_at`.

    Coefficients of a piece are powers of the time since it began, column after column for each.
    """
    for k in range(series.shape[0]):
        port, first, pieces, columns, terms, place, at = (
            series[k, 0], series[k, 1], series[k, 2], series[k, 3], series[k, 4], series[k, 5],
            series[k, 6])
        i = piece_at(times, first, first + pieces - 1, t + beside)
        x = max(t - times[i], 0.0)
        begin = place + (i - first) * columns * terms
        factor = loads[3 * port]
        for c in range(columns):
            total = 0.0
            for power in range(terms - 1, -1, -1):
                total = total * x + values[begin + power * columns + c]
            loads[at + c] = factor * total


@compiled
def polynomial_at(pieces, i, x, out, at):
    """Set the value of a polynomial and its two rates."""
    a, b, c, d, e, f = (pieces[i, 0], pieces[i, 1], pieces[i, 2], pieces[i, 3], pieces[i, 4],
                        pieces[i, 5])
    out[at] = a + x * (b + x * (c + x * (d + x * (e + x * f))))
    out[at + 1] = b + x * (2.0 * c + x * (3.0 * d + x * (4.0 * e + x * 5.0 * f)))
    out[at + 2] = 2.0 * c + x * (6.0 * d + x * (12.0 * e + x * 20.0 * f))


@compiled
def add_harmonic(pieces, i, x, out, at):
    """Add the harmonic of a piece and its two rates."""
    w = pieces[i, OMEGA]
    angle = w * x + pieces[i, PHASE]
    wave = pieces[i, AMPLITUDE] * math.sin(angle)
    out[at] += wave
    out[at + 1] += pieces[i, AMPLITUDE] * w * math.cos(angle)
    out[at + 2] -= w * w * wave
