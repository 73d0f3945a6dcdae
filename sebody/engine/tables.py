"""Histories of loads and drives in compiled code."""

import numpy as np

from sebody.kernels.pipeline import compiled

# numbers of a piece: those of its polynomial by ascending powers, then amplitude, angular
# frequency and phase of its harmonic
POLYNOMIAL = 6
AMPLITUDE, OMEGA, PHASE = range(POLYNOMIAL, POLYNOMIAL + 3)
PIECE = POLYNOMIAL + 3


@compiled
def history_at(times, pieces, first, last, t, out, at):
    """Value and two rates at t of the pieces `first` to `last`; constant before the first.

    At the time of a piece the value and rates are those of this piece: a motion that starts from
    speed has it at once.
    """
    i = first
    while i < last and times[i + 1] <= t:
        i += 1
    x, c = t - times[i], pieces[i]
    if x < 0.0:
        x = 0.0
    value, rate, second = c[POLYNOMIAL - 1], 0.0, 0.0
    for k in range(POLYNOMIAL - 2, -1, -1):         # Horner's scheme
        second = second * x + 2.0 * rate
        rate = rate * x + value
        value = value * x + c[k]
    if c[AMPLITUDE] != 0.0:
        w, angle = c[OMEGA], c[OMEGA] * x + c[PHASE]
        wave = c[AMPLITUDE] * np.sin(angle)
        value += wave
        rate += c[AMPLITUDE] * w * np.cos(angle)
        second -= w * w * wave
    before = 1.0 if t >= times[first] else 0.0
    out[at], out[at + 1], out[at + 2] = value, before * rate, before * second
