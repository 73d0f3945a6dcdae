"""Rows of recorded states of a run, stretch by stretch; short pieces of a run share a buffer."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sebody.basics import memory
from sebody.contract.layout import RECORD_T
from sebody.engine.state import Record, State
from sebody.engine.step import write_record

BUFFERED = 1024         # rows of the buffer


class RecordedRows:
    """The rows where the loop writes accepted states.

    Parameters
    ----------
    state : State
    every : int
        Grid steps between records.

    Attributes
    ----------
    stretches : list of NDArray
        Rows that are recorded, one array for each call of `record_until`; the buffer's come with
        `flush`.
    """

    def __init__(self, state: State, every: int):
        self.stretches: list[NDArray] = []
        self._state, self._every = state, every
        self._buffer: Record | None = None
        self._jumped = False    # at the state recorded last, by an input that was set since

    def begin(self) -> None:
        """Record the state at the start."""
        first = self.none(1)
        self._state.control.recorded = 0
        write_record(self._state, first)
        self.stretches.append(first.rows)

    def none(self, count: int = 0) -> Record:
        """A record without rows, with room for some."""
        return Record.of(self._state, count, self._every)

    def record_until(self, last: int) -> Record:
        """An empty record for the states up to a step of the grid."""
        self._forget_jumped()
        control = self._state.control
        count = last // self._every - int(control.grid) // self._every + int(control.due)
        memory.check(8.0 * count * self._state.now.size, f"a record of {count} states",
                     "keep fewer with output_every, or give an earlier t_end")
        control.recorded = 0
        return self.none(count)

    def keep(self, record: Record) -> None:
        """Append what the loop has written into a record."""
        self.stretches.append(record.rows[:self._state.control.recorded])

    def buffer(self, count: int) -> Record | None:
        """The buffer, where it has room for so many more rows."""
        control = self._state.control
        if self._buffer is None:
            self._forget_jumped()
            self._buffer = self.none(BUFFERED)
            control.recorded = 0
        elif control["recorded"] + count > BUFFERED:
            return None
        elif self._jumped:
            control["recorded"] -= 1
            control["due"], self._jumped = 1, False
        return self._buffer

    def flush(self) -> bool:
        """Append the rows in the buffer; whether there was a buffer."""
        if self._buffer is None:
            return False
        self.keep(self._buffer)
        self._buffer = None
        return True

    def jump(self) -> None:
        """An input jumps in the state reached: if that is recorded, it will be recorded anew."""
        rows = self.stretches[-1] if self._buffer is None else self._buffer.rows[
            :self._state.control["recorded"]]
        self._jumped = len(rows) > 0 and rows[-1, RECORD_T] == self._state.clock["time"]

    def all(self) -> NDArray:
        """All rows that are not in the buffer."""
        return np.concatenate(self.stretches)

    def _forget_jumped(self) -> None:
        if self._jumped:
            self.stretches[-1] = self.stretches[-1][:-1]
            self._state.control.due, self._jumped = 1, False
