"""Histories of FE nodes inside superelements by name: ``<body>.node<k>.<quantity>``."""

from collections.abc import Iterator

from numpy.typing import NDArray

from sebody.results.field import Field
from sebody.results.recording import Recording

QUANTITIES = ("position", "velocity", "acceleration", "displacement", "stress", "von_mises",
              "section_forces")


class FENodes:
    """Names of all FE nodes of all superelements, without a list of them."""

    def __init__(self, recording: Recording):
        self._bodies = {name: body.body.recovery for name, body in recording.model.bodies.items()
                        if body.body.recovery is not None}

    def __contains__(self, name: str) -> bool:
        body, dot, node = name.rpartition(".node")
        if not dot or body not in self._bodies or not (node.isascii() and node.isdigit()):
            return False
        return str(int(node)) == node and self._bodies[body].has(int(node))

    def __iter__(self) -> Iterator[str]:
        for name, recovery in self._bodies.items():
            yield from (f"{name}.node{recovery.number(place)}"
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


def of_fe_node(quantity: str, recording: Recording, name: str) -> NDArray:
    """History of a quantity of one FE node."""
    body, _, node = name.rpartition(".node")
    return getattr(field_of(recording, body).at(int(node)), quantity)
