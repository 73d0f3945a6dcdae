"""Outputs of a run: histories of quantities, or numbers that are made of them on the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.units import Units
from sebody.contract.counts import MEMBERS
from sebody.contract.read_numbers import ENERGY, FORCE, LOAD, NOW, TOTAL
from sebody.quantities.names import split
from sebody.quantities.reading import Reading
from sebody.quantities.symbols import NoTape
from sebody.results.naming import look_up
from sebody.results.nodal import MOTIONS
from sebody.results.recording import Recording
from sebody.results.tapes import States
from sebody.results.units import unit_of_curves
from sebody.runs.folds import FACTS, FOUND, Folds, fold, write_values
from sebody.runs.simulation import Simulation

IN_LANES = {NOW, FORCE, TOTAL, ENERGY, LOAD}    # kinds of numbers that eight members give
# as of `fold`
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

    def size(self, shape: tuple[int, ...]) -> int:
        """The number of values of a quantity of some shape in a state."""
        return 1 if self.norm else prod(shape)

    def unit(self, units: Units) -> str:
        """Its unit in those of a model; empty where the quantity has none that is known."""
        words = unit_of_curves(self.quantity)
        return units.of(f"{words} time" if words and self.kind == "integral" else words)


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


class Room(NamedTuple):
    """Numbers that `fold` keeps of the history of a run."""

    kept: NDArray
    before: NDArray
    largest: NDArray
    facts: NDArray

    @classmethod
    def of(cls, output: Output, shape: tuple[int, ...]) -> Room:
        """Room for an output of a quantity of some shape."""
        kept, before, largest = np.zeros((3, output.size(shape), 1))
        return cls(kept, before, largest, np.zeros(FACTS))


def folds_of(outputs: Sequence[Output], shapes: Sequence[tuple[int, ...]],
             columns: Sequence[NDArray], taped: Sequence[bool], tape: Reading, inputs: NDArray,
             states: int) -> Folds:
    """Room for outputs of all members of a group.

    Parameters
    ----------
    shapes : sequence of tuple
        Of the quantity of each in a state.
    columns : sequence of (c,)
        Which of the recorded numbers its values are, or of the outputs of the tape.
    taped : sequence of bool
        Whether they are the latter.
    tape : Reading
    inputs : (i, 2)
        Places on the tape of numbers that it reads, and their columns of the record.
    states : int
        Most that are recorded at a time.
    """
    kinds, numbers, norms = zip(*map(_asked, outputs), strict=True) if outputs else ((), (), ())
    sizes = [(len(own), output.size(shape))
             for output, shape, own in zip(outputs, shapes, columns, strict=True)]
    ends = np.cumsum([(0, 0), *sizes], axis=0)
    kept, before, largest = np.zeros((3, ends[-1, 1], MEMBERS))
    return Folds(np.array(kinds, np.int64), np.array(numbers, float), np.array(norms, bool), ends,
                 np.concatenate([np.zeros(0, np.int64), *columns]),
                 np.array(taped, dtype=np.int64), inputs, tape.steps, tape.factors, tape.weights,
                 tape.outputs, np.tile(tape.numbers, (MEMBERS, 1)),
                 np.zeros((states, len(tape.outputs), MEMBERS)),
                 kept, before, largest, np.zeros((len(outputs), FACTS)))


class Fold:
    """The value of an output of one run, from its recorded states, stretch by stretch.

    Parameters
    ----------
    shape : tuple of int
        Of the quantity in a state.
    """

    def __init__(self, output: Output, shape: tuple[int, ...]):
        self.output, self.shape = output, () if output.norm else shape
        self._all = np.arange(prod(shape))
        self._room = Room.of(output, shape)

    def add(self, t: NDArray, values: NDArray) -> None:
        """Take in the next recorded states, (k,) times and (k, ...) values."""
        self.add_columns(t, np.ascontiguousarray(values).reshape(len(t), -1), self._all)

    def add_columns(self, t: NDArray, table: NDArray, columns: NDArray) -> None:
        """The same of values that are columns of a table, as of recorded rows."""
        fold(*_asked(self.output), t, table[..., np.newaxis], columns, *self._room)

    def value(self) -> NDArray | None:
        """The value; None if there is none, as of a time the run did not reach."""
        if not self._room.facts[FOUND]:
            return None
        found = np.empty(len(self._room.kept))
        write_values(*_asked(self.output)[:2], *self._room, 0, found)
        return found.reshape(self.shape)


def _asked(output: Output) -> tuple[int, float, bool]:
    """Request to `fold`: kind, number, and whether of the length."""
    number = output.power if output.time is None else output.time
    return KINDS.index(output.kind), number, output.norm


class Form(NamedTuple):
    """Shape and source of a quantity that runs read."""

    shape: tuple[int, ...]      # in a state
    kinematic: bool             # from recorded states alone
    columns: NDArray | None     # of recorded rows, where it is nothing but these
    in_lanes: bool = False      # whether its tape is played for eight members


def forms(simulation: Simulation, outputs: Mapping[str, Output]) -> dict[str, Form]:
    """The form of each quantity.

    Raises
    ------
    InputError
        A quantity that the model does not have.
    """
    return {quantity: _form(simulation, quantity)
            for quantity in {o.quantity for o in outputs.values()}}


def _form(simulation: Simulation, quantity: str) -> Form:
    parts = simulation.model, simulation.numbering, simulation.system, simulation.state
    recording = Recording(*parts, simulation.rows.stretches[0], 0.0)
    whole, _ = split(recording, quantity)
    states = States(*parts)
    if not states.is_inside(quantity):
        try:
            shape = states.put(quantity)
            return Form(shape, states.kinds <= {NOW}, states.places(), states.kinds <= IN_LANES)
        except NoTape:
            pass
    shape = look_up(recording, quantity).shape[1:]
    motion = whole.rpartition(".")[2]
    if states.is_inside(quantity):
        return Form(shape, motion in MOTIONS, None)
    return Form(shape, motion == "rotation", None)      # a rotation vector
