"""Histories of FE nodes inside superelements by name: ``<body>.node<k>.<quantity>``."""

from sebody.quantities.inside import number_of
from sebody.results.field import Field
from sebody.results.field_point import FieldPoint
from sebody.results.recording import Recording


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
