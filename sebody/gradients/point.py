"""Parameters of a model at other values than those it was built with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.gradients.parameters import Column, Parameter, columns_of
from sebody.model.model import Model
from sebody.parameters.changes import Handle
from sebody.parameters.table import refuse_values


class Point:
    """Numbers of a model as one vector.

    Parameters
    ----------
    model : Model
    names : sequence of str
        As of `gradient`.

    Attributes
    ----------
    columns : list of Column
        Of the model as built.
    base : (p,)
        Values in the model as built: factors count from 1.
    """

    def __init__(self, model: Model, names: Sequence[Parameter]):
        self.model, self.columns = model, columns_of(model, names)
        self.base = np.array([c.handle.base.reshape(-1)[c.component] for c in self.columns],
                             dtype=float)
        self._handles = {c.name: c.handle for c in self.columns}

    @property
    def labels(self) -> list[str]:
        """Labels of the numbers."""
        return [column.label for column in self.columns]

    @contextmanager
    def at(self, x: NDArray) -> Iterator[list[Column]]:
        """The model with these values, as long as the context lasts, and columns about them."""
        values = self._values(x)
        try:
            self._apply(values)
            refuse_values(self.model, values)
            yield [column._replace(handle=self._about(column, values)) for column in self.columns]
        finally:
            self._reset()

    def _values(self, x: NDArray) -> dict[str, NDArray]:
        found = {name: np.array(handle.base, dtype=float)
                 for name, handle in self._handles.items()}
        for column, value in zip(self.columns, x, strict=True):
            found[column.name].reshape(-1)[column.component] = value
        for name, value in found.items():
            self._handles[name].refuse(value[None], name, "; give the optimizer bounds")
        return found

    def _about(self, column: Column, values: dict[str, NDArray]) -> Handle:
        """A handle that counts from these values, and goes back to them."""
        def assign(value: NDArray) -> None:
            self._apply(values | {column.name: value})
        return replace(column.handle, base=values[column.name], set=assign,
                       reset=lambda: self._apply(values))

    def _apply(self, values: dict[str, NDArray]) -> None:
        """Set all parameters: several may change one body."""
        self._reset()
        for name, value in values.items():
            self._handles[name].set(value)

    def _reset(self) -> None:
        for handle in reversed(self._handles.values()):
            handle.reset()
