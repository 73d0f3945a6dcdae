"""Forces, moments and powers of bodies, joints, drives and loads: how each is read by name."""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import record_counts
from sebody.basics.errors import InputError
from sebody.contract.layout import RECORD
from sebody.model.parts import Element, Joint, Motion, Node, Superelement
from sebody.results.recording import Recording


def bodies(recording: Recording) -> dict[str, Superelement | Element]:
    """Superelements and rigid bodies by name."""
    return recording.model.bodies | recording.model.rigid_bodies


def nodes_of_bodies(recording: Recording) -> dict[str, tuple[str, Node]]:
    """Body and node by ``<body>.<node>``."""
    return {f"{name}.{place.node.name}": (name, place.node)
            for name, body in bodies(recording).items() for place in body.attachments}


def joints(recording: Recording) -> dict[str, Joint]:
    """Joints, and drives by equations."""
    return {joint.name: joint for joint in recording.model.joints}


def drives(recording: Recording) -> dict[str, Joint | Motion]:
    """Drives by equations, and prescribed motions."""
    by_name: dict[str, Joint | Motion] = {name: joint for name, joint in joints(recording).items()
                                          if joint.time_function is not None}
    return by_name | {motion.name: motion for dof_block in recording.model.dof_blocks()
                      for motion in dof_block.motions}


def loads(recording: Recording) -> dict[str, Element]:
    """Loads, springs and dampers on nodes."""
    return {load.name: load for load in recording.model.loads
            if load.attachments and load.law is None}


def of_body(recording: Recording, name: str) -> NDArray:
    """Forces of everything else on a body: of its places, then on its modes, (n, coordinates)."""
    body = bodies(recording)[name]
    first = recording.numbering.forces_at[body]
    modes = body.reduced.modes if isinstance(body, Superelement) else 0
    size = sum(t.start.size for t in (getattr(*place) for place in body.attachments))
    return np.hstack([
        *(-recording.balance.on(body, *place) for place in body.attachments),
        recording.forces.elements[:, first + size:first + size + modes]])


def at_node(kind: str, recording: Recording, name: str) -> NDArray:
    """Force or moment of everything else on a body at one of its nodes."""
    body, node = nodes_of_bodies(recording)[name]
    return _flat(recording, kind, -recording.balance.on(bodies(recording)[body], node, kind))


def of_joint(kind: str, recording: Recording, name: str) -> NDArray:
    """Force or moment of a joint on its node, in global axes."""
    return _flat(recording, kind, recording.balance.of_joint(joints(recording)[name], kind))


def in_joint_axes(kind: str, recording: Recording, name: str) -> NDArray:
    """The same in the axes of the joint."""
    joint, values = joints(recording)[name], of_joint(kind, recording, name)
    if values.ndim == 1:
        return values
    return np.einsum("nji,nj->ni", recording.balance.axes(joint), values)


def of_load(kind: str, recording: Recording, name: str) -> NDArray:
    """Force or moment of a load or spring on its node, the first if it has several."""
    load = loads(recording)[name]
    if load.point is not None:          # minus that on the node of the surface; it has no moment
        node = load.attachments[-1].node
        return _flat(recording, kind, -recording.balance.on(load, node, kind)
                     * (kind == "position"))
    return _flat(recording, kind, recording.balance.on(load, load.attachments[0].node, kind))


def effort(what: str, recording: Recording, name: str) -> NDArray:
    """Thrust or torque of a drive along or about its axis, (n,): times the rate it is the power."""
    drive = drives(recording)[name]
    kind = "rotation" if what == "torque" else "position"
    if kind != driven(drive):
        other = "thrust" if what == "torque" else "torque"
        raise InputError(f"drive {name!r} moves a {driven(drive)}: ask for {name}.{other}")
    if isinstance(drive, Joint):
        values = recording.balance.of_joint(drive, kind)
        if kind == "position":       # it pushes the other node along the axis
            return -np.einsum("ni,ni->n", values, recording.balance.axes(drive)[:, :, 0])
        return values[:, 0] if recording.model.planar else np.einsum(
            "ni,ni->n", values, recording.balance.axes(drive)[:, :, 0])
    dof_block = getattr(*drive.place)
    first = recording.numbering.dof_blocks[dof_block]
    return recording.forces.sums[:, first:first + dof_block.start.size] @ drive.direction


def multipliers(recording: Recording, name: str) -> NDArray:
    """Multipliers of the equations of a joint, (n, m)."""
    equations = joints(recording)[name].constraints
    if not equations:
        raise InputError(f"joint {name!r} has no equations and so no multipliers, since its nodes "
                         "share coordinates or are fixed; the force on a fixed node is its "
                         f"reaction, the force of the joint is {name}.force")
    firsts = [(recording.numbering.multipliers[c], c.multipliers) for c in equations]
    q = recording.unique_rows[:, RECORD.slices(record_counts(recording.numbering))["q"]]
    return q[:, [first + k for first, count in firsts for k in range(count)]]


def work(recording: Recording, name: str) -> NDArray:
    """Work of a power port, (n,)."""
    return recording.recorded("works")[:, recording.numbering.port_names.index(name)]


def power(recording: Recording, name: str) -> NDArray:
    """Power of a power port, (n,)."""
    return recording.powers[:, recording.numbering.port_names.index(name)]


def driven(drive: Joint | Motion) -> str:
    """Whether a drive moves a position or a rotation."""
    if isinstance(drive, Motion):
        return drive.place.kind
    return drive.constraints[0].attachments[0].kind


def _flat(recording: Recording, kind: str, values: NDArray) -> NDArray:
    """Moments in a plane are numbers."""
    return values[:, 0] if recording.model.planar and kind == "rotation" else values
