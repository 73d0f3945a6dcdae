"""Numbers made of histories on the way, compiled: other threads go on meanwhile."""

import numpy as np

from sebody.compiler.decorators import compiled

MAXIMUM, MINIMUM, RMS, INTEGRAL, FINAL, AT, SOFT_MAXIMUM = range(7)
SEEN, LAST, LENGTH, FOUND = range(4)    # states so far, time of the last, stretch, whether a value
ROUNDED = 1e-12         # of a time that is asked for


@compiled(nogil=True)
def fold(kind, number, norm, t, table, columns, kept, before, largest, facts):
    """Take in the next states of a history.

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
        Times of the states.
    table : (n, m)
        Numbers of the states.
    columns : (c,)
        Which of the m numbers are the values.
    kept, before, largest : (c,) or (1,)
        Is updated: the number so far, the values in the last state, the largest absolute values.
    facts : (4,)
        Is updated: SEEN to FOUND.
    """
    for k in range(t.size):
        first, step = facts[SEEN] == 0.0, t[k] - facts[LAST]
        asked = kind == AT and facts[FOUND] == 0.0 and t[k] >= number * (1.0 - ROUNDED)
        for c in range(kept.size):
            value = _length(table, k, columns) if norm else table[k, columns[c]]
            last, before[c] = before[c], value
            if kind == MAXIMUM:
                if first or value > kept[c] or value != value:
                    kept[c] = value
            elif kind == MINIMUM:
                if first or value < kept[c] or value != value:
                    kept[c] = value
            elif kind == INTEGRAL:
                kept[c] += 0.0 if first else 0.5 * step * (last + value)
            elif kind == RMS:
                kept[c] += 0.0 if first else 0.5 * step * (last * last + value * value)
            elif kind == FINAL:
                kept[c] = value
            elif kind == SOFT_MAXIMUM:
                if abs(value) > largest[c] or value != value:
                    kept[c] *= (largest[c] / abs(value)) ** number
                    largest[c] = abs(value)
                if not first and largest[c] > 0.0:
                    kept[c] += 0.5 * step * ((abs(last) / largest[c]) ** number
                                             + (abs(value) / largest[c]) ** number)
            elif asked:
                part = 1.0 if first or t[k] <= number else (number - facts[LAST]) / step
                kept[c] = value if part == 1.0 else last + part * (value - last)
        if kind != AT or asked:
            facts[FOUND] = 1.0
        facts[LENGTH] += 0.0 if first else step
        facts[SEEN] += 1.0
        facts[LAST] = t[k]


@compiled(nogil=True)
def fold_members(kind, number, norm, t, table, columns, rows, members, kept, before, largest,
                 facts):
    """Take in the next states of some members of a group: see `fold`.

    Parameters
    ----------
    table : (n, m, lanes)
        Numbers of the states of all members.
    rows : (n, c)
        Scratch memory.
    members : (k,)
        Which members.
    kept, before, largest, facts : (lanes, ...)
        As of `fold`, of each member.
    """
    own = np.arange(columns.size)
    for member in members:
        for k in range(t.size):
            for c in range(columns.size):
                rows[k, c] = table[k, columns[c], member]
        fold(kind, number, norm, t, rows, own, kept[member], before[member], largest[member],
             facts[member])


@compiled(forceinline=True)
def _length(table, k, columns):
    total = 0.0
    for c in range(columns.size):
        value = table[k, columns[c]]
        total += value * value
    return np.sqrt(total)
