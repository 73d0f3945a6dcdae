"""Names of the quantities of a result, and how each is read: two tables.

``<owner>.<quantity>`` is looked up in `OWNERS`; quantities of the whole model are in `OF_MODEL`.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import record_counts, stretch
from sebody.contract.layout import ENERGIES
from sebody.errors import InputError
from sebody.model.parts import DofBlock
from sebody.results import contact_quantities as contacts
from sebody.results import field_quantities as fields
from sebody.results import force_quantities as forces
from sebody.results import joint_motion
from sebody.results.envelopes import ENVELOPES
from sebody.results.recording import Recording
from sebody.spelling import alike

FE_NODE = "node inside a body"
OPTIONAL = PRESSING, SIGNAL, CONTROLLER = (     # told of models that have some
    "contact, stop or friction", "sensor, signal or actuator", "controller")
ALIKE = 0.75            # ratio of `difflib` from which a name is near another
OF_FIELD = (*fields.QUANTITIES, "strain", "principal")


class NodeQuantity(NamedTuple):
    """A history of one of the two DOF blocks of a node."""

    rotational: bool        # of the rotation, else of the position
    read: Callable[[Recording, DofBlock, slice], NDArray]    # slice of its coordinates
    saved: bool = True      # part of the output file


class Owner(NamedTuple):
    """A kind of named parts of a model, and their recorded quantities."""

    kind: str
    offer: str              # text for the message about an unknown name
    names: Callable[[Recording], Iterable[str]]
    quantities: Mapping[str, Callable[[Recording, str], NDArray]]


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


# the model


def _energy(name: str, recording: Recording) -> NDArray:
    values = ENERGIES.slices(record_counts(recording.numbering))[name]
    part = recording.energies[:, values]
    return part if values.stop - values.start > 1 else part[:, 0]


OF_MODEL: dict[str, Callable[[Recording], NDArray]] = {
    "t": lambda recording: recording.recorded("t")[:, 0],
    "energy.external_work": lambda recording: recording.recorded("works").sum(axis=1),
    "constraints.position": lambda recording: recording.constraint_residuals[:, 0],
    "constraints.velocity": lambda recording: recording.constraint_residuals[:, 1],
    "energy.kinetic": partial(_energy, "kinetic"),
    "energy.strain": partial(_energy, "strain"),
    "momentum": partial(_energy, "momentum"),
    "angular_momentum": partial(_energy, "moment"),
    "energy.potential": partial(_energy, "potential"),
}


# nodes


def _coordinates(part: str, recording: Recording, dof_block: DofBlock, at: slice) -> NDArray:
    return recording.recorded(part)[:, at]


def _rotation(recording: Recording, dof_block: DofBlock, at: slice) -> NDArray:
    """Rotation matrices, (n, 3, 3); in a plane angles."""
    if recording.model.planar:
        return recording.recorded("q")[:, at.start]
    k = recording.numbering.rotations[dof_block]
    return recording.recorded("R")[:, 9 * k:9 * k + 9].reshape(-1, 3, 3)


def _angular(part: str, recording: Recording, dof_block: DofBlock, at: slice) -> NDArray:
    """Angular velocity or acceleration in global axes; both are recorded in material ones."""
    values = recording.recorded(part)
    if recording.model.planar:
        return values[:, at.start]
    return np.einsum("nij,nj->ni", _rotation(recording, dof_block, at), values[:, at])


def _reaction(recording: Recording, dof_block: DofBlock, at: slice) -> NDArray:
    """Force or moment of the support of a fixed or prescribed DOF block, in global axes."""
    if not dof_block.fixed:
        raise InputError(f"{dof_block.name} is free: only fixed and prescribed nodes have a "
                         "reaction; the force of a joint is <joint>.force")
    values = recording.forces.sums[:, at]
    if dof_block not in recording.numbering.rotations:
        return values[:, 0] if dof_block.rotational else values       # in a plane
    return np.einsum("nij,nj->ni", _rotation(recording, dof_block, at), values)


def _of_node(quantity: str, recording: Recording, name: str) -> NDArray:
    node, numbering = recording.model.nodes[name], recording.numbering
    rotational, read, _ = OF_NODE[quantity]
    dof_block = node.rotation if rotational else node.position
    if dof_block is None or dof_block not in numbering.dof_blocks:
        raise InputError(f"node {name!r} has no {quantity}: the DOF block is not in the model")
    first = numbering.dof_blocks[dof_block]
    return read(recording, dof_block, slice(first, first + dof_block.start.size))


OF_NODE = {
    "position": NodeQuantity(False, partial(_coordinates, "q")),
    "rotation": NodeQuantity(True, _rotation),
    "velocity": NodeQuantity(False, partial(_coordinates, "v")),
    "angular_velocity": NodeQuantity(True, partial(_angular, "v")),
    "acceleration": NodeQuantity(False, partial(_coordinates, "a"), saved=False),
    "angular_acceleration": NodeQuantity(True, partial(_angular, "a"), saved=False),
    "reaction": NodeQuantity(False, _reaction, saved=False),
    "reaction_moment": NodeQuantity(True, _reaction, saved=False),
}


# bodies, joints, power ports


def _modes(part: str, recording: Recording, name: str) -> NDArray:
    if name not in recording.model.bodies:
        raise InputError(f"body {name!r} is rigid: it has forces, but no modes")
    first = recording.numbering.modes[name]
    return recording.recorded(part)[:, first:first + recording.model.bodies[name].reduced.modes]


def _kept(recording: Recording, name: str) -> NDArray:
    """What a sensor, a controller or Python gave last, (n,)."""
    return recording.recorded("frames")[:, recording.numbering.memory.values[name]]


def _states(recording: Recording, name: str) -> NDArray:
    """States of a controller, (n, states)."""
    for load in recording.model.loads:
        if load.law is not None and load.law.controller == name:
            own = stretch(recording.numbering, load.law.states)
            return recording.recorded("v")[:, own]
    first = recording.numbering.memory.states[name]
    size = recording.model.controllers[name].states.size
    return recording.recorded("frames")[:, first:first + size]


OWNERS = (
    Owner("node", "nodes are {names}", lambda recording: recording.model.nodes,
          {name: partial(_of_node, name) for name in OF_NODE}),
    Owner("body", "of bodies ({names}) there are {quantities}", forces.bodies,
          {"modes": partial(_modes, "q"), "mode_rates": partial(_modes, "v"),
           "forces": forces.of_body}),
    Owner("node of a body", "of <body>.<node> {quantities}", forces.nodes_of_bodies,
          {"force": partial(forces.at_node, "position"),
           "moment": partial(forces.at_node, "rotation")}),
    Owner("joint", "of joints {quantities}", forces.joints,
          {"multipliers": forces.multipliers,
           "force": partial(forces.of_joint, "position"),
           "moment": partial(forces.of_joint, "rotation"),
           "local_force": partial(forces.in_joint_axes, "position"),
           "local_moment": partial(forces.in_joint_axes, "rotation"),
           "angle": joint_motion.angle, "rate": joint_motion.rate,
           "displacement": joint_motion.displacement, "speed": joint_motion.speed}),
    Owner("drive", "of drives {quantities}", forces.drives,
          {"torque": partial(forces.effort, "torque"),
           "thrust": partial(forces.effort, "thrust")}),
    Owner("spring or load", "of springs and loads {quantities}", forces.loads,
          {"force": partial(forces.of_load, "position"),
           "moment": partial(forces.of_load, "rotation")}),
    Owner(PRESSING, "of contacts, stops and friction {quantities}",
          contacts.pressing,
          {"normal_force": contacts.normal_force, "gap": contacts.gap, "sticks": contacts.sticks,
           "dissipation": contacts.dissipation}),
    Owner("source of work", "of {names} {quantities}",
          lambda recording: recording.numbering.port_names,
          {"work": forces.work, "power": forces.power}),
    Owner(SIGNAL, "of sensors, signals and actuators {quantities}",
          lambda recording: recording.numbering.memory.values, {"value": _kept}),
    Owner(CONTROLLER, "of controllers {quantities}",
          lambda recording: recording.model.controllers, {"states": _states}),
    # the last one: its names are too many to be searched for names like another
    Owner(FE_NODE, "; of FE nodes, <body>.node<k>, {quantities}", fields.FENodes,
          {name: partial(fields.of_fe_node, name) for name in fields.QUANTITIES}),
)


JOINT_MOTION = {"angle": joint_motion.TURNS, "rate": joint_motion.TURNS,
                "displacement": joint_motion.SLIDES, "speed": joint_motion.SLIDES}


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
