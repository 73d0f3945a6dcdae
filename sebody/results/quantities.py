"""Names of the quantities of a result, looked up in the table of `sebody.quantities.table`."""

from collections.abc import Iterable

from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.spelling import alike
from sebody.quantities.inside import FENodes
from sebody.quantities.table import (
    FE_NODE,
    INSIDE,
    NODE,
    OF_MODEL,
    OPTIONAL,
    OWNERS,
    Owner,
    find,
)
from sebody.results.envelopes import ENVELOPES
from sebody.results.histories import histories
from sebody.results.recording import Recording

ALIKE = 0.75            # ratio of `difflib` from which a name is near another
OF_FIELD = (*INSIDE, "strain", "principal")


def look_up(recording: Recording, name: str) -> NDArray:
    """History of a whole quantity by its full name.

    Names with components are those of `sebody.results.naming`.

    Raises
    ------
    InputError
        A name that nothing has, or a quantity its owner does not have.
    """
    found = find(recording, name)
    if found is None:
        raise unknown_quantity(recording, name)
    quantity, owner = found
    numbers = histories(recording)
    return numbers.whole(quantity.formula(numbers, owner))


def unknown_quantity(recording: Recording, name: str) -> InputError:
    """The exception for a name that nothing has: names that are like it, and what there is."""
    owner, _, quantity = name.rpartition(".")
    model = recording.model
    if owner in model.bodies and quantity in OF_FIELD:
        return _of_field(recording, owner, quantity)
    owners = [one for one in OWNERS if owner in one.names(recording)]
    inside = INSIDE if owner in FENodes(recording) else ()
    near = alike(name, [*names(recording), *(f"{owner}.{q}" for q in inside)], cutoff=ALIKE)
    meant = f"did you mean {' or '.join(map(repr, near))}? " if near else ""
    if owners:
        return InputError(f"{quantity!r} is unknown: {meant}" + "; ".join(
            f"a {one.kind} has {', '.join(one.quantities)}" for one in owners))
    *offers, of_fe_nodes = [one.offer.format(names=_listed(one, recording),
                                             quantities=_enumerated(one.quantities))
                            for one in OWNERS
                            if one.kind not in OPTIONAL or list(one.names(recording))]
    return InputError(f"{name!r} is unknown: {meant}{'; '.join(offers)}; of the model "
                      f"{', '.join(OF_MODEL)}{of_fe_nodes}")


def _of_field(recording: Recording, body: str, quantity: str) -> InputError:
    """The exception for a quantity of FE nodes that is requested for a whole body."""
    recovery = recording.model.bodies[body].reduced.recovery
    if recovery is None:
        return InputError(f"'{body}.{quantity}' is unknown: {body!r} was reduced without the "
                          "shapes of its FE model; reduce it from the FE model, or import it with "
                          "its mesh")
    node = f"{body}.node{recovery.number(0)}"
    return InputError(f"'{body}.{quantity}' is unknown: it is a quantity of FE nodes, such as "
                      f"'{node}.{quantity}'; for all FE nodes at one time use "
                      f"result.field({body!r}).{quantity}(t=...)"
                      + ("; the largest over the run result.field("
                         f"{body!r}).envelope({quantity!r})" if quantity in ENVELOPES else ""))


def names(recording: Recording) -> list[str]:
    """Names of all quantities there are, but those of FE nodes: of the model, then by owner."""
    return list(OF_MODEL) + list(dict.fromkeys(
        f"{owner}.{quantity}" for one in OWNERS if one.kind != FE_NODE
        for owner in one.names(recording)
        for quantity, row in one.quantities.items() if row.has(recording, owner)))


def _listed(one: Owner, recording: Recording) -> str:
    """Names of a kind, where its offer lists them."""
    return ", ".join(one.names(recording) if "{names}" in one.offer else ()) or f"any {one.kind}"


def _enumerated(names: Iterable[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def saved(recording: Recording) -> list[str]:
    """Names of the histories an output file holds."""
    names = ["t"]
    for name in recording.model.nodes:
        names += [f"{name}.{quantity}" for quantity, row in NODE.items()
                  if row.saved and row.has(recording, name)]
    return [*names, "energy.kinetic", "energy.strain", "energy.potential", "energy.external_work",
            "momentum", "angular_momentum"]
