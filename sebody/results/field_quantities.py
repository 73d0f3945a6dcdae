"""Histories of FE nodes inside superelements by name: ``<body>.node<k>.<quantity>``."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.reduction.recovery import Recovery
from sebody.results.field import Field
from sebody.results.field_point import FieldPoint
from sebody.results.recording import Recording

QUANTITIES = ("position", "velocity", "acceleration", "displacement", "stress", "von_mises",
              "section_forces")


class FENodes:
    """Names of all FE nodes of all superelements, without a list of them.

    Nodes are named by their labels in the FE program, or by their numbers if they have none.
    """

    def __init__(self, recording: Recording):
        self._bodies = {name: body.reduced.recovery for name, body in recording.model.bodies.items()
                        if body.reduced.recovery is not None}

    def __contains__(self, name: str) -> bool:
        body, dot, node = name.rpartition(".node")
        if not dot or body not in self._bodies or not (node.isascii() and node.isdigit()):
            return False
        return str(int(node)) == node and number_of(self._bodies[body], int(node)) is not None

    def __iter__(self) -> Iterator[str]:
        for name, recovery in self._bodies.items():
            yield from (f"{name}.node{recovery.called(place)}"
                        for place in range(len(recovery.coordinates)))


def field_of(recording: Recording, name: str) -> Field:
    """The field of a superelement, made once.

    Raises
    ------
    InputError
        See `Field`.
    """
    if name not in recording.fields:
        recording.fields[name] = Field(recording, name)
    return recording.fields[name]


def fe_node(recording: Recording, name: str) -> FieldPoint:
    """An FE node by its name ``<body>.node<k>``, one that there is."""
    body, _, node = name.rpartition(".node")
    field = field_of(recording, body)
    recovery = recording.model.bodies[body].reduced.recovery
    assert recovery is not None     # see `Field`
    number = number_of(recovery, int(node))
    assert number is not None       # names of nodes there are not were refused
    return field.at(number)


def of_fe_node(quantity: str, recording: Recording, name: str) -> NDArray:
    """History of a quantity of one FE node."""
    return getattr(fe_node(recording, name), quantity)


def number_of(recovery: Recovery, node: int) -> int | None:
    """Number in the FE model of a node by its label, or number if it has none; None for no node."""
    if recovery.labels is None:
        return node if recovery.has(node) else None
    numbers = np.flatnonzero(recovery.labels == node)
    return recovery.number(int(numbers[0])) if len(numbers) else None
