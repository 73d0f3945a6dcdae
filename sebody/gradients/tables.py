"""All values of a load's table in one go.

A force is the value of its time function times a direction, and the value linear in those of the
table: derivatives of residuals by the table are those by the value, once for all rows, times the
weights of the rows at the time of an event.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.gradients.history import History
from sebody.gradients.parameters import Column
from sebody.gradients.slopes import Slope
from sebody.model.history_rows import rows_of
from sebody.model.model import Model
from sebody.runs.simulation import Simulation

TABLE = ".table"


class OfTable(NamedTuple):
    """Derivatives by the values of a table."""

    residuals: NDArray      # (events, n) by the value of the time function
    weights: NDArray        # (events, rows) of the table's values in that

    def slope(self, row: int, objectives: int) -> Slope:
        """By the value of one row."""
        n = self.residuals.shape[1]
        return Slope(self.weights[:, row, None] * self.residuals, np.zeros(n), np.zeros(n),
                     np.zeros(objectives))

    def contracted(self, bars: NDArray) -> NDArray:
        """``sum w . r_p`` by all values, (m, rows), of the weights of a sweep back."""
        return np.einsum("emn,en->me", bars, self.residuals) @ self.weights


def port_of(model: Model, run: Simulation, column: Column) -> int | None:
    """The power port of a load whose table a column is of; None of anything else."""
    owner, dot, _ = column.name.rpartition(TABLE)
    if not dot:
        return None
    load = next(one for one in model.loads if one.name == owner)
    return run.numbering.ports.get(load)


def weights(model: Model, column: Column, history: History) -> NDArray:
    """Weights of the rows of a table in its value at the loads of all events, (events, rows)."""
    load = next(one for one in model.loads if one.name == column.name.rpartition(TABLE)[0])
    rows = rows_of(load.time_function.times, load.time_function.pieces)
    assert rows is not None
    t, last = rows[:, 0], len(rows) - 1
    found = np.zeros((len(history.ends), len(rows)))
    beside = history.ends + history.besides
    first = np.searchsorted(t, beside, side="right") - 1
    for e, (k, time) in enumerate(zip(first, history.ends, strict=True)):
        if k < 0 or k == last:
            found[e, max(k, 0)] = 1.0
            continue
        part = (time - t[k]) / (t[k + 1] - t[k])
        found[e, k], found[e, k + 1] = 1.0 - part, part
    return found
