"""Names of the quantities of a result, looked up in the tables of `sebody.results.owners`."""

from collections.abc import Callable, Iterable

from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.spelling import alike
from sebody.results import contact_quantities as contacts
from sebody.results import field_quantities as fields
from sebody.results import force_quantities as forces
from sebody.results import joint_motion
from sebody.results.envelopes import ENVELOPES
from sebody.results.owners import (
    CONTROLLER,
    FE_NODE,
    OF_MODEL,
    OF_NODE,
    OPTIONAL,
    OWNERS,
    PRESSING,
    Owner,
)
from sebody.results.recording import Recording

ALIKE = 0.75            # ratio of `difflib` from which a name is near another
OF_FIELD = (*fields.QUANTITIES, "strain", "principal")
JOINT_MOTION = {"angle": joint_motion.TURNS, "rate": joint_motion.TURNS,
                "displacement": joint_motion.SLIDES, "speed": joint_motion.SLIDES}


def look_up(recording: Recording, name: str) -> NDArray:
    """History of a whole quantity by its full name.

    Names with components are those of `sebody.results.naming`.

    Raises
    ------
    InputError
        A name that nothing has, or a quantity its owner does not have.
    """
    read = find(recording, name)
    if read is None:
        raise unknown_quantity(recording, name)
    return read(recording)


def find(recording: Recording, name: str) -> Callable[[Recording], NDArray] | None:
    """What reads a quantity; None if there is none of this name."""
    if name in OF_MODEL:
        return OF_MODEL[name]
    owner, _, quantity = name.rpartition(".")
    for one in OWNERS:      # names of nodes come first: those of others are long to list
        if quantity in one.quantities and owner in one.names(recording):
            return lambda recording: one.quantities[quantity](recording, owner)
    return None


def unknown_quantity(recording: Recording, name: str) -> InputError:
    """The exception for a name that nothing has: names that are like it, and what there is."""
    owner, _, quantity = name.rpartition(".")
    model = recording.model
    if owner in model.bodies and quantity in OF_FIELD:
        return _of_field(recording, owner, quantity)
    owners = [one for one in OWNERS if owner in one.names(recording)]
    inside = fields.QUANTITIES if owner in fields.FENodes(recording) else ()
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
        for quantity in one.quantities if _has(recording, one.kind, owner, quantity)))


def _listed(one: Owner, recording: Recording) -> str:
    """Names of a kind, where its offer lists them."""
    return ", ".join(one.names(recording) if "{names}" in one.offer else ()) or f"any {one.kind}"


def _enumerated(names: Iterable[str]) -> str:
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def saved(recording: Recording) -> list[str]:
    """Names of the histories an output file holds."""
    names = ["t"]
    for name, node in recording.model.nodes.items():
        for quantity, (rotational, _, kept) in OF_NODE.items():
            dof_block = node.rotation if rotational else node.position
            if kept and dof_block is not None and dof_block in recording.numbering.dof_blocks:
                names.append(f"{name}.{quantity}")
    return [*names, "energy.kinetic", "energy.strain", "energy.potential", "energy.external_work",
            "momentum", "angular_momentum"]


def _has(recording: Recording, kind: str, owner: str, quantity: str) -> bool:
    """Whether an owner of a kind has one of the quantities of this kind."""
    model = recording.model
    place = "rotation" if quantity.endswith("moment") else "position"
    if kind == "node":
        dof_block = getattr(model.nodes[owner], "rotation" if OF_NODE[quantity].rotational else
                          "position")
        return (dof_block is not None and dof_block in recording.numbering.dof_blocks
                and (dof_block.fixed or not quantity.startswith("reaction")))
    if kind == "joint" and quantity in JOINT_MOTION:
        return forces.joints(recording)[owner].kind in JOINT_MOTION[quantity]
    if kind == CONTROLLER:
        return recording.model.controllers[owner].states.size > 0
    if quantity in ("modes", "mode_rates"):
        return owner in model.bodies and model.bodies[owner].reduced.modes > 0
    if kind == "node of a body":
        body, node = forces.nodes_of_bodies(recording)[owner]
        return (node, place) in forces.bodies(recording)[body].attachments
    if quantity == "multipliers":
        return bool(forces.joints(recording)[owner].constraints)
    if kind == "drive":
        return (quantity == "torque") == (forces.driven(forces.drives(recording)[owner])
                                          == "rotation")
    if kind == PRESSING:
        return quantity == "dissipation" or contacts.has(contacts.pressing(recording)[owner],
                                                         quantity)
    if kind == "spring or load":
        return any(kept == place for _, kept in forces.loads(recording)[owner].attachments)
    return True
