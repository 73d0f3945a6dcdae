"""What is kept of a run: histories of quantities, or numbers that are made of them on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.errors import InputError

KINDS = ("maximum", "minimum", "rms", "integral", "final", "at", "soft_maximum", "history")


@dataclass(frozen=True)
class Output:
    """A number made of the history of a quantity.

    Parameters
    ----------
    quantity : str
        As in ``result[quantity]``.
    kind : {'maximum', 'minimum', 'rms', 'integral', 'final', 'at', 'soft_maximum', 'history'}
    time : float, optional
        Of 'at' [time].
    norm : bool
        Of vectors: of their length, in place of each component.
    power : float
        Of 'soft_maximum'.
    """

    quantity: str
    kind: str
    time: float | None = None
    norm: bool = False
    power: float = 20.0

    def __post_init__(self) -> None:
        inputs.name(self.quantity, "quantity of an output")
        inputs.choice(self.kind, "kind of an output", KINDS)
        inputs.flag(self.norm, f"output of {self.quantity}: norm")
        if (self.time is None) == (self.kind == "at"):
            raise inputs.refusal(f"output of {self.quantity}: time", self.time,
                                 "give one of kind 'at', and of no other")
        if self.time is not None:
            inputs.number(self.time, f"output of {self.quantity}: time", least=0)


def maximum(quantity: str, norm: bool = False) -> Output:
    """Largest value over the recorded states; of vectors that of each component, or the length."""
    return Output(quantity, "maximum", norm=norm)


def minimum(quantity: str, norm: bool = False) -> Output:
    """Smallest value over the recorded states."""
    return Output(quantity, "minimum", norm=norm)


def rms(quantity: str, norm: bool = False) -> Output:
    """Root of the mean square over time, by the trapezoidal rule."""
    return Output(quantity, "rms", norm=norm)


def soft_maximum(quantity: str, power: float = 20.0, norm: bool = False) -> Output:
    """Mean of a power of the absolute value over time, and the root of that: ``p`` of a p-norm.

    It has a derivative, which the largest value has not, and comes nearer to the largest absolute
    value from below the larger the power is.
    """
    power = inputs.number(power, "soft_maximum: power", least=2, most=1000)
    return Output(quantity, "soft_maximum", norm=norm, power=power)


def integral(quantity: str, norm: bool = False) -> Output:
    """Integral over time, by the trapezoidal rule."""
    return Output(quantity, "integral", norm=norm)


def final(quantity: str, norm: bool = False) -> Output:
    """Value at the end of the run."""
    return Output(quantity, "final", norm=norm)


def at_time(quantity: str, t: float, norm: bool = False) -> Output:
    """Value at a time, between recorded states linear [time]."""
    return Output(quantity, "at", inputs.number(t, "at_time: t", least=0), norm)


def outputs_of(given: Mapping[str, Output | str], t_end: float) -> dict[str, Output]:
    """Outputs by name, names of quantities standing for histories.

    Raises
    ------
    InputError
        No outputs, something else than an output, or a time after the end.
    """
    remedy = ("give a dict of names and quantities, such as {'tip': 'tip.position'}, or of what "
              "maximum('tip.position') and the like return")
    if not isinstance(given, Mapping) or not given:
        raise inputs.refusal("outputs", given, remedy)
    found = {}
    for name, one in given.items():
        inputs.name(name, "name of an output")
        one = Output(one, "history") if isinstance(one, str) else one
        found[name] = inputs.instance(one, f"output {name!r}", Output, remedy)
        if one.time is not None and one.time > t_end:
            raise InputError(f"output {name!r} is asked for at t = {one.time:g}, and the runs end "
                             f"at {t_end:g}: give an earlier time")
    return found


class Fold:
    """The value of an output of one run, from its recorded states, stretch by stretch."""

    def __init__(self, output: Output):
        self.output = output
        self._kept: NDArray | None = None       # extreme, sum, or value
        self._before: tuple[float, NDArray] | None = None
        self._length = 0.0
        self._largest: NDArray | float = 0.0

    def add(self, t: NDArray, values: NDArray) -> None:
        """Take in the next recorded states, (k,) times and (k, ...) values."""
        if not len(t):
            return
        if self.output.norm:
            values = np.sqrt((values.reshape(len(values), -1) ** 2).sum(axis=1))
        if self._before is not None:
            t = np.concatenate([[self._before[0]], t])
            values = np.concatenate([self._before[1][None], values])
        first = self._before is None
        self._before = t[-1], values[-1].copy()
        getattr(self, "_" + self.output.kind)(t, values, first)

    def value(self) -> NDArray | None:
        """The value; None if there is none, as of a time the run did not reach."""
        if self.output.kind == "rms" and self._kept is not None:
            return np.sqrt(self._kept / self._length) if self._length else np.abs(self._before[1])
        if self.output.kind == "soft_maximum" and self._kept is not None:
            return self._largest * (self._kept / self._length) ** (1 / self.output.power) if (
                self._length) else np.abs(self._before[1])
        return self._kept

    def _maximum(self, t: NDArray, values: NDArray, first: bool) -> None:
        found = values.max(axis=0)
        self._kept = found if first else np.maximum(self._kept, found)

    def _minimum(self, t: NDArray, values: NDArray, first: bool) -> None:
        found = values.min(axis=0)
        self._kept = found if first else np.minimum(self._kept, found)

    def _integral(self, t: NDArray, values: NDArray, first: bool) -> None:
        found = np.tensordot(np.diff(t), values[1:] + values[:-1], axes=(0, 0)) / 2
        self._kept = found if first else self._kept + found

    def _rms(self, t: NDArray, values: NDArray, first: bool) -> None:
        self._length += t[-1] - t[0]
        self._integral(t, values**2, first)

    def _soft_maximum(self, t: NDArray, values: NDArray, first: bool) -> None:
        p, before = self.output.power, self._largest        # powers of large numbers overflow
        self._largest = np.maximum(before, np.abs(values).max(axis=0))
        size = np.where(self._largest > 0, self._largest, 1.0)
        self._length += t[-1] - t[0]
        if not first:
            self._kept = self._kept * (before / size) ** p
        self._integral(t, (np.abs(values) / size) ** p, first)

    def _final(self, t: NDArray, values: NDArray, first: bool) -> None:
        self._kept = values[-1].copy()      # the rows of states are written to again

    def _at(self, t: NDArray, values: NDArray, first: bool) -> None:
        time = self.output.time
        k = int(np.searchsorted(t, time * (1 - 1e-12)))
        if self._kept is not None or k == len(t):
            return
        if k == 0 or t[k] <= time:
            self._kept = values[k].copy()
            return
        part = (time - t[k - 1]) / (t[k] - t[k - 1])
        self._kept = values[k - 1] + part * (values[k] - values[k - 1])
