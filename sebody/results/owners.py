"""What has quantities in a result, and how each is read: two tables.

`OWNERS` has the quantities ``<owner>.<quantity>``, `OF_MODEL` those of the whole model.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import record_counts, stretch
from sebody.basics.errors import InputError
from sebody.contract.layout import ENERGIES
from sebody.model.parts import DofBlock
from sebody.results import contact_quantities as contacts
from sebody.results import field_quantities as fields
from sebody.results import force_quantities as forces
from sebody.results import joint_motion
from sebody.results.recording import Recording

FE_NODE = "node inside a body"
OPTIONAL = PRESSING, SIGNAL, CONTROLLER = (     # told of models that have some
    "contact, stop or friction", "sensor, signal or actuator", "controller")


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
