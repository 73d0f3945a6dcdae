"""Numbers made of histories on the way, compiled: other threads go on meanwhile."""

import numpy as np

from sebody.compiler.decorators import compiled

MAXIMUM, MINIMUM, RMS, INTEGRAL, FINAL, AT, SOFT_MAXIMUM = range(7)
SEEN, LAST, LENGTH, FOUND = range(4)    # states so far, time of the last, stretch, whether a value
ROUNDED = 1e-12         # of a time that is asked for


@compiled(nogil=True)
def fold(kind, number, norm, t, table, columns, kept, before, largest, facts):
    """Take in the next states of the histories of some runs.

    Parameters
    ----------
    kind : int
        MAXIMUM to SOFT_MAXIMUM; of RMS the integral of squares is kept, of SOFT_MAXIMUM that of
        the powers of the ratios to the largest value so far: powers of large numbers overflow.
    number : float
        Of AT the time, of SOFT_MAXIMUM the power.
    norm : bool
        Of the length of all columns, in place of each.
    t : (n,)
        Times of the states, which are those of all runs.
    table : (n, m, runs)
        Numbers of the states.
    columns : (c,)
        Which of the m numbers are the values.
    kept, before, largest : (c, runs) or (1, runs)
        Is updated: the number so far, the values in the last state, the largest absolute values.
    facts : (4,)
        Is updated: SEEN to FOUND.
    """
    for k in range(t.size):
        first, step = facts[SEEN] == 0.0, t[k] - facts[LAST]
        asked = kind == AT and facts[FOUND] == 0.0 and t[k] >= number * (1.0 - ROUNDED)
        part = 1.0 if first or not asked or t[k] <= number else (number - facts[LAST]) / step
        for c in range(kept.shape[0]):
            for run in range(kept.shape[1]):
                value = (_length(table, k, columns, run) if norm else
                         table[k, columns[c], run])
                last, before[c, run] = before[c, run], value
                if kind == MAXIMUM:
                    if first or value > kept[c, run] or value != value:
                        kept[c, run] = value
                elif kind == MINIMUM:
                    if first or value < kept[c, run] or value != value:
                        kept[c, run] = value
                elif kind == INTEGRAL:
                    kept[c, run] += 0.0 if first else 0.5 * step * (last + value)
                elif kind == RMS:
                    kept[c, run] += 0.0 if first else 0.5 * step * (last * last + value * value)
                elif kind == FINAL:
                    kept[c, run] = value
                elif kind == SOFT_MAXIMUM:
                    kept[c, run], largest[c, run] = _powers(
                        number, kept[c, run], largest[c, run], last, value, 0.0 if first else step)
                elif asked:
                    kept[c, run] = value if part == 1.0 else last + part * (value - last)
        if kind != AT or asked:
            facts[FOUND] = 1.0
        facts[LENGTH] += 0.0 if first else step
        facts[SEEN] += 1.0
        facts[LAST] = t[k]


@compiled
def _powers(number, kept, largest, last, value, step):
    """Of SOFT_MAXIMUM: the integral of the powers, and the largest absolute value."""
    if abs(value) > largest or value != value:
        kept *= (largest / abs(value)) ** number
        largest = abs(value)
    if step > 0.0 and largest > 0.0:
        kept += 0.5 * step * ((abs(last) / largest) ** number + (abs(value) / largest) ** number)
    return kept, largest


@compiled(forceinline=True)
def _length(table, k, columns, run):
    total = 0.0
    for c in range(columns.size):
        value = table[k, columns[c], run]
        total += value * value
    return np.sqrt(total)
