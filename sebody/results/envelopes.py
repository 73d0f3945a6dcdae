"""Largest values over time at every FE node of a superelement."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief
from sebody.fem.stress import principal, von_mises
from sebody.quantities.names import ENVELOPED
from sebody.results.field_states import FieldStates

AT_ONCE = 64        # states whose displacements are computed together


class Envelope(NamedTuple):
    """Largest values over time, and the largest of all."""

    value: NDArray      # (nodes,)
    t: NDArray          # (nodes,) when [time]
    largest: float
    node: int           # where, its number in the FE model
    time: float         # and when

    def __repr__(self) -> str:
        return brief(self)


def envelope(field: FieldStates, quantity: str, static: bool,
             reference: str | None = None) -> Envelope:
    """Envelope of one of `ENVELOPES`, computed by blocks of states; see `Field.envelope`.

    Raises
    ------
    InputError
        Another quantity, a reference of another one than displacements, or a body whose FE model
        has no stress operator.
    """
    inputs.flag(static, "static")
    read = ENVELOPES[inputs.choice(quantity, "quantity of an envelope", ENVELOPES)]
    if reference is not None:
        if quantity != "displacement":
            raise InputError(f"reference is {reference!r}, but {quantity} has none: leave it out, "
                             "only displacements have a reference")
        read = _displacement(reference)
    value, step = np.full(field.count, -np.inf), np.zeros(field.count, dtype=int)
    sign = -1.0 if quantity == "smallest_principal" else 1.0
    at_once = field.stresses(static).states_at_once if read in _OF_STRESS else AT_ONCE
    for first in range(0, len(field.t), at_once):
        states = np.arange(first, min(first + at_once, len(field.t)))
        largest = sign * read(field, states, static)
        best = np.nan_to_num(largest, nan=-np.inf).argmax(axis=0)
        highest = largest[best, np.arange(field.count)]
        larger = highest > value
        value[larger], step[larger] = highest[larger], states[best[larger]]
    known = np.isfinite(value)
    node = int(np.argmax(np.where(known, value, -np.inf)))
    return Envelope(np.where(known, sign * value, np.nan), field.t[step],
                    float(sign * value[node]), field.number(node), float(field.t[step[node]]))


def _lengths(name: str) -> Callable[[FieldStates, NDArray, bool], NDArray]:
    return lambda field, states, static: np.linalg.norm(getattr(field, name)(states), axis=2)


def _displacement(reference: str) -> Callable[[FieldStates, NDArray, bool], NDArray]:
    return lambda field, states, static: np.linalg.norm(
        field.displacements(states, reference=reference), axis=2)


def _von_mises(field: FieldStates, states: NDArray, static: bool) -> NDArray:
    return von_mises(field.stresses(static).at_nodes(states))


def _largest(field: FieldStates, states: NDArray, static: bool) -> NDArray:
    return principal(field.stresses(static).at_nodes(states))[..., 2]


def _smallest(field: FieldStates, states: NDArray, static: bool) -> NDArray:
    return principal(field.stresses(static).at_nodes(states))[..., 0]


_OF_STRESS = _von_mises, _largest, _smallest
# functions of a field and states, (states, nodes), by the quantity
ENVELOPES = dict(zip(ENVELOPED, (
    *_OF_STRESS, *map(_lengths, ("displacements", "velocities", "accelerations"))), strict=True))
