"""Parameters by name, as numbers: columns of a gradient."""

from collections.abc import Sequence
from typing import NamedTuple

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.gradients.designs import Design
from sebody.model.model import Model
from sebody.parameters.changes import Handle
from sebody.parameters.table import parameter


class Column(NamedTuple):
    """A number of a parameter."""

    name: str           # of the parameter
    handle: Handle
    component: int
    label: str          # of the number
    bodies: tuple[str, ...] = ()        # that are made anew

    @property
    def design(self) -> bool:
        """True where bodies are made anew."""
        return bool(self.bodies)


Parameter = str | Design


def columns_of(model: Model, names: Sequence[Parameter]) -> list[Column]:
    """Numbers of parameters, in the order given: ``gravity`` are three, ``gravity.y`` is one.

    Raises
    ------
    InputError
        No names, unknown ones, a number that is given twice, or values that are bodies.
    """
    remedy = "give a list of names such as ['motor.amplitude', 'beam.stiffness']"
    if isinstance(names, str):
        raise inputs.refusal("parameters", names, remedy)
    found: dict[tuple[str, int], Column] = {}
    for given in inputs.items(names, "parameters", remedy):
        for column in _columns(model, given):
            if (column.name, column.component) in found:
                raise InputError(f"parameter {given!r} is given twice: give every name once")
            found[column.name, column.component] = column
    if not found:
        raise InputError(f"parameters are missing: {remedy}")
    return list(found.values())


def columns_at_values(model: Model, names: Sequence[Parameter]) -> list[Column]:
    """The same as `columns_of`, in a model that takes the values of designs.

    Designs give their values themselves, which need not be those the model was built with.
    """
    found = columns_of(model, names)
    designs = {c.name: c.handle for c in found if c.design}
    for of in designs.values():
        of.set(of.base)
    return columns_of(model, names) if designs else found


def _columns(model: Model, given: Parameter) -> list[Column]:
    if isinstance(given, Design):
        of = given.handle(model)
        return [Column(given.name, of, k, given.name if of.base.size == 1 else f"{given.name}[{k}]",
                       tuple(given.bodies)) for k in range(of.base.size)]
    name, of, component = parameter(model, given)
    if of.whole:
        raise InputError(f"parameter {given!r} has whole bodies for values, which have no "
                         "derivative: give stiffness or mass of the body, or a Design")
    if component is None:
        return [Column(name, of, k, name if of.base.ndim == 0 else f"{name}[{k}]")
                for k in range(of.base.size)]
    return [Column(name, of, component, str(given))]
