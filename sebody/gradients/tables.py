"""Amplitude of a load, and all values of its table in one go.

A force is the value of its time function times a direction, and the value linear in those of the
table: derivatives of residuals by the table are those by the value, once for all rows, times the
weights of the rows at the time of an event. Of the amplitude the weight is the value itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.assembly.close_rows import Grid, means, stretches
from sebody.gradients.history import History
from sebody.gradients.parameters import Column
from sebody.gradients.slopes import Slope
from sebody.model.history_rows import rows_of
from sebody.model.model import Model
from sebody.model.parts import Element
from sebody.runs.simulation import Simulation

TABLE, AMPLITUDE = ".table", ".amplitude"


class Part(NamedTuple):
    """Derivatives by the value of a time function at some times."""

    residuals: NDArray      # (events, n)
    weights: sparse.csr_array   # (events, rows) of the table's values in this


class OfTable:
    """Derivatives by the values of a table, or by an amplitude as the only one."""

    def __init__(self, parts: Sequence[Part]):
        self.parts = parts

    def slope(self, row: int, objectives: int, n: int) -> Slope:
        """By the value of one row."""
        return Slope(sum(one.weights[:, [row]].toarray() * one.residuals for one in self.parts),
                     np.zeros(n), np.zeros(n), np.zeros(objectives))

    def contracted(self, bars: NDArray) -> NDArray:
        """``sum w . r_p`` by all values, (m, rows), of the weights of a sweep back."""
        return sum(np.einsum("emn,en->me", bars, one.residuals) @ one.weights
                   for one in self.parts)


def port_of(model: Model, run: Simulation, column: Column) -> int | None:
    """The power port of a load whose table or amplitude a column is of; None of anything else."""
    load = _load(model, column)
    if load is None or load.series is not None or (
            column.name.endswith(AMPLITUDE) and not column.handle.base):
        return None
    return run.numbering.ports.get(load)


def _load(model: Model, column: Column) -> Element | None:
    owner = column.name.removesuffix(TABLE).removesuffix(AMPLITUDE)
    return None if owner == column.name else next(
        (one for one in model.loads if one.name == owner), None)


def weights(model: Model, column: Column, grid: Grid | None, history: History, values: NDArray,
            times: NDArray) -> sparse.csr_array:
    """Weights of a parameter's numbers in the value of its load at all events, (events, numbers).

    `values` are those of the load at some times, (events,), before or after jumps as of the events.
    """
    if column.name.endswith(AMPLITUDE):
        return sparse.csr_array(values[:, None] / float(column.handle.base))
    load = _load(model, column)
    assert load is not None and load.time_function is not None
    rows = rows_of(load.time_function.times, load.time_function.pieces)
    assert rows is not None
    t, seen = rows[:, 0], times + history.besides
    found = None if grid is None else stretches(load.time_function, grid)
    if found is None:
        return _interpolation(t, seen, times - seen)
    k = np.maximum(np.searchsorted(found.begins, seen, side="right") - 1, 0)
    held = (found.begins[k] <= seen) & (seen < found.times[k, 0])
    of_level = (found.times[k, 0] <= seen) & (seen < found.times[k, 2])
    of_table = _interpolation(t, np.where(held, found.begins[k], seen),
                              np.where(held, 0.0, times - seen))
    given = means(load.time_function, found)
    levels = (given.weights @ _interpolation(t, given.times, given.later)).tocsr()
    place = 2 * k + (seen >= found.times[k, 1])
    return sparse.csr_array(sparse.diags_array((~of_level).astype(float)) @ of_table
                            + sparse.diags_array(of_level.astype(float)) @ levels[place])


def _interpolation(t: NDArray, times: NDArray, later: NDArray) -> sparse.csr_array:
    """Weights of rows at some times in the values of pieces of these times, read a little later."""
    last, every = len(t) - 1, np.arange(len(times))
    first = np.searchsorted(t, times, side="right") - 1
    inside = (first >= 0) & (first < last)
    others, e, k = every[~inside], every[inside], first[inside]
    part = (times[e] - t[k] + later[e]) / (t[k + 1] - t[k])
    return sparse.csr_array((np.concatenate([np.ones(len(others)), 1.0 - part, part]), (
        np.concatenate([others, e, e]),
        np.concatenate([np.maximum(first[~inside], 0), k, k + 1]))), shape=(len(times), len(t)))
