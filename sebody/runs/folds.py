"""Numbers made of histories on the way, compiled: other threads go on meanwhile."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.layout import RECORD_T
from sebody.engine.arrays import Arrays
from sebody.kernels.tapes import play

MAXIMUM, MINIMUM, RMS, INTEGRAL, FINAL, AT, SOFT_MAXIMUM = range(7)
SEEN, LAST, LENGTH, FOUND = range(4)    # states so far, time of the last, stretch, whether a value
FACTS = FOUND + 1
ROUNDED = 1e-12         # of a time that is asked for


@dataclass(frozen=True, eq=False)
class Folds(Arrays):
    """All outputs of the members of a group.

    ==================  ============================================================================
    kinds, numbers,     (n,) of each output, as of `fold`
    norms
    ends                (n + 1, 2) where its columns and its values begin
    columns             of all: of recorded numbers or, where `taped` is one, of the tape's outputs
    taped               (n,)
    inputs              (i, 2) numbers that a tape reads: place on it, and column of the record
    steps, factors,     of the tape, see `quantities.reading`
    weights, outputs
    tapes               (members, numbers) its numbers
    made                (states, outputs, members) what it gives
    kept, before,       (values, members) as of `fold`
    largest
    facts               (n, 4)
    ==================  ============================================================================
    """

    kinds: NDArray
    numbers: NDArray
    norms: NDArray
    ends: NDArray
    columns: NDArray
    taped: NDArray
    inputs: NDArray
    steps: NDArray
    factors: NDArray
    weights: NDArray
    outputs: NDArray
    tapes: NDArray
    made: NDArray
    kept: NDArray
    before: NDArray
    largest: NDArray
    facts: NDArray


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
    """Numbers kept for SOFT_MAXIMUM: the integral of the powers, and the largest absolute value."""
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


@compiled(nogil=True)
def write_values(kind, power, kept, before, largest, facts, run, values):
    """Write the values of one run, (c,), from what `fold` keeps."""
    length = facts[LENGTH]
    for c in range(kept.shape[0]):
        if kind != RMS and kind != SOFT_MAXIMUM:
            values[c] = kept[c, run]
        elif length == 0.0:
            values[c] = abs(before[c, run])
        elif kind == RMS:
            values[c] = np.sqrt(kept[c, run] / length)
        else:
            values[c] = largest[c, run] * (kept[c, run] / length) ** (1.0 / power)


@compiled
def forget(folds):
    """Forget what was taken in."""
    for c in range(folds.kept.shape[0]):
        for run in range(folds.kept.shape[1]):
            folds.kept[c, run] = folds.before[c, run] = folds.largest[c, run] = 0.0
    for o in range(folds.facts.shape[0]):
        for k in range(folds.facts.shape[1]):
            folds.facts[o, k] = 0.0
    for member in range(folds.tapes.shape[0]):
        for k in range(1, folds.tapes.shape[1]):
            folds.tapes[member, k] = 0.0


@compiled
def fold_all(folds, count, table):
    """Take in the first states of a table, (states, numbers, members)."""
    t = np.empty(count)
    for k in range(count):
        t[k] = table[k, RECORD_T, 0]
    if folds.outputs.size > 0:
        _play(folds, count, table)
    for o in range(folds.kinds.size):
        if folds.taped[o] == 1:
            _fold_one(folds, o, t, folds.made)
        else:
            _fold_one(folds, o, t, table)


@compiled
def _fold_one(folds, o, t, table):
    """Take in the states of an output."""
    columns = folds.columns[folds.ends[o, 0]:folds.ends[o + 1, 0]]
    first, end = folds.ends[o, 1], folds.ends[o + 1, 1]
    fold(folds.kinds[o], folds.numbers[o], folds.norms[o], t, table, columns,
         folds.kept[first:end], folds.before[first:end], folds.largest[first:end], folds.facts[o])


@compiled
def _play(folds, count, table):
    """Play the tape in the first states of a table, of every member."""
    for k in range(count):
        for member in range(folds.tapes.shape[0]):
            numbers = folds.tapes[member]
            for i in range(folds.inputs.shape[0]):
                numbers[folds.inputs[i, 0]] = table[k, folds.inputs[i, 1], member]
            play(folds.steps, folds.factors, folds.weights, numbers)
            for n in range(folds.outputs.size):
                folds.made[k, n, member] = numbers[folds.outputs[n]]


@compiled(nogil=True)
def write_all(folds, member, values):
    """Write the values of all outputs of a member, (values,), where there are any."""
    for o in range(folds.kinds.size):
        if folds.facts[o, FOUND] != 0.0:
            first, end = folds.ends[o, 1], folds.ends[o + 1, 1]
            write_values(folds.kinds[o], folds.numbers[o], folds.kept[first:end],
                         folds.before[first:end], folds.largest[first:end], folds.facts[o],
                         member, values[first:end])
