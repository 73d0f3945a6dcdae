"""Quantities that are to be kept: histories of results by name, and frequencies of small motion."""

import re
import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError, LimitWarning, SimulationError
from sebody.explore.advice.inside import Places
from sebody.explore.advice.measures import Measure
from sebody.explore.advice.steady import steady_frequencies
from sebody.model.mechanism import Mechanism
from sebody.model.model import Model
from sebody.quantities.names import split
from sebody.results.naming import component_of
from sebody.results.result import Result
from sebody.runs.simulation import Simulation

FREQUENCY = re.compile(r"frequency ([1-9]\d*)")
RIGID = 1e-5        # of the highest frequency: below, motions are rigid


class Values(NamedTuple):
    """The quantities of one run: histories (n, ...) and frequencies, numbers."""

    histories: list[NDArray]
    frequencies: list[float]
    measures: tuple[Measure, ...] = ()


def parted(values: Values) -> list[Values]:
    """Each quantity by itself: histories in their order, then frequencies."""
    return [*(Values([one], [], (measure,)) for one, measure in zip(
        values.histories, values.measures, strict=True)),
        *(Values([], [omega], ()) for omega in values.frequencies)]


class Quantities:
    """Names of quantities.

    Parameters
    ----------
    names : str or iterable of str
        As a result has them, and ``frequency 1``, the lowest one above zero of small motion about
        the equilibrium at the start or the steady rotation, and so on.

    Raises
    ------
    InputError
        No names.
    """

    def __init__(self, names: object):
        given = [names] if isinstance(names, str) else inputs.items(
            names, "quantities", "give names of quantities")
        if not given:
            raise InputError("quantities: none is given; give names of quantities")
        for name in given:
            if inputs.name(name, "name of a quantity") == "t":
                raise InputError("quantity 't' is the time, which all models keep: name a "
                                 "position, a force or the like")
        self.names = list(given)
        numbers = [FREQUENCY.fullmatch(name) for name in given]
        self.measures = tuple(Measure.of(n) for n, number in zip(given, numbers, strict=True)
                              if number is None)
        self.histories = [one.name for one in self.measures]
        self.places = Places(Mechanism(), [])
        self.numbers = [int(number[1]) for number in numbers if number]

    @property
    def owners(self) -> set[str]:
        """Names of nodes and bodies that the quantities name, and parts of these names."""
        names = set()
        for name in self.histories:
            parts = name.split(".")
            names |= {*parts[:-1], *(".".join(parts[:k]) for k in range(1, len(parts)))}
        return names

    def check(self, model: Model, h: float) -> None:
        """Refuse quantities that a model does not have, by its state at the start.

        Those inside beams are known by their places from here on.

        Raises
        ------
        InputError
            A quantity does not exist, or the model cannot be started.
        """
        self.places = Places(model, self.histories)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", LimitWarning)
            self.of(Simulation(model, h).result(), h)

    def of(self, result: Result, h: float, grid: float = 0.0,
           frequencies: list[float] | None = None) -> Values:
        """The quantities of a run that was recorded with a step.

        Parameters
        ----------
        frequencies : list of float, optional
            Known ones, which the run shares with another.

        Raises
        ------
        InputError
            A quantity does not exist.
        """
        histories = [self.places.history(result, name, history_in_space) for name in self.histories]
        return Values([measure.filtered(history, h, grid) for measure, history in zip(
            self.measures, histories, strict=True)],
            frequencies if frequencies is not None else self._frequencies(result), self.measures)

    def wholes(self, result: Result) -> list[str]:
        """The quantities that the histories are components of, or they themselves."""
        return [split(result, self.places.names(result.model, name)[0])[0]
                for name in self.histories]

    def _frequencies(self, result: Result) -> list[float]:
        if not self.numbers:
            return []
        try:
            omega = steady_frequencies(result)
        except (InputError, SimulationError) as reason:
            raise InputError(f"quantity {f'frequency {self.numbers[0]}'!r}: {reason}") from reason
        flexible = omega[omega > RIGID * omega.max(initial=0.0)]
        if max(self.numbers) > len(flexible):
            raise InputError(f"quantity 'frequency {max(self.numbers)}' does not exist: the model "
                             f"has {len(flexible)} frequencies above zero")
        return [float(flexible[k - 1]) for k in self.numbers]


def history_in_space(result: Result, name: str) -> NDArray:
    """A history as the spatial model has it that a planar one was made of."""
    plane = result.model.plane
    if plane is None:
        return np.asarray(result[name])
    whole, components = split(result, name)
    history = plane.to_space(whole, result[whole])
    for component in components:
        history = component_of(whole, history, component)
        whole = f"{whole}.{component}"
    return history


class Worst(NamedTuple):
    """The largest relative difference of two runs: of which quantity, and at which row."""

    error: float
    quantity: str
    row: int | None = None
    size: float = 1.0       # of the quantity, that the error is relative to
    kind: str = ""          # of the measure: what of the history counts


def compared(one: Values, other: Values, sizes: list[float], stride: tuple[int, int]) -> Worst:
    """Compare two runs; each history is taken with its stride.

    Raises
    ------
    InputError
        A history has other components.
    """
    errors = [Worst(abs(a / b - 1.0), "a frequency", size=b)
              for a, b in zip(one.frequencies, other.frequencies, strict=True)]
    for measure, a, b, size in zip(one.measures, one.histories, other.histories, sizes,
                                   strict=True):
        if a.shape[1:] != b.shape[1:]:
            raise InputError("a quantity has other components")
        off, row = measure.difference(a[::stride[0]], b[::stride[1]])
        errors.append(Worst(off / size, measure.name, row, size, measure.words))
    return max(errors, key=lambda worst: worst.error)


def difference(one: Values, other: Values, sizes: list[float], stride: tuple[int, int]) -> float:
    """Largest relative difference of two runs, see `compared`."""
    return compared(one, other, sizes, stride).error


def sizes_of(values: Values) -> list[float]:
    """Sizes that differences of each history are relative to."""
    return [one.size(history) for one, history in zip(values.measures, values.histories,
                                                      strict=True)]
