"""Angles and displacements of joints and their rates, from recorded states."""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import stretch
from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block
from sebody.model.parts import DofBlock, Joint, Node
from sebody.results.force_quantities import joints
from sebody.results.recording import Recording

TURNS, SLIDES = ("revolute", "cylindrical"), ("prismatic", "slider", "cylindrical")


def angle(recording: Recording, name: str) -> NDArray:
    """Angle of a joint's node against the other one, (n,), zero at the start; turns count."""
    joint = _of_kind(recording, name, TURNS, "angle", "turn")
    a, b = (_rotation(recording, node) for node in (joint.node, joint.to))
    if recording.model.planar:
        return a - b
    _, n, m = joint.own_axes.columns.T
    seen = np.einsum("nji,nj->ni", b, a @ n)
    return np.unwrap(np.arctan2(seen @ m, seen @ n))


def rate(recording: Recording, name: str) -> NDArray:
    """Rate of this angle, (n,)."""
    joint = _of_kind(recording, name, TURNS, "rate", "turn")
    a, b = (_part(recording, "v", dof_block(node, "rotation")) for node in (joint.node, joint.to))
    if recording.model.planar:
        return a[:, 0] - b[:, 0]
    axis = joint.axis
    turned = _rotation(recording, joint.node) @ axis
    return a @ axis - np.einsum("ni,nij,nj->n", turned, _rotation(recording, joint.to), b)


def displacement(recording: Recording, name: str) -> NDArray:
    """Displacement of a joint's node along its axis from the other one, (n,), from the start."""
    joint = _of_kind(recording, name, SLIDES, "displacement", "slide")
    axis, gap, _, _ = _way(recording, joint)
    other, carrier, sign = _ends(joint)
    start = sign * joint.axis @ (other.point - carrier.point)
    return sign * np.einsum("ni,ni->n", axis, gap) - start


def speed(recording: Recording, name: str) -> NDArray:
    """Rate of this displacement, (n,)."""
    joint = _of_kind(recording, name, SLIDES, "speed", "slide")
    axis, gap, gap_rate, axis_rate = _way(recording, joint)
    sign = _ends(joint)[2]
    return sign * (np.einsum("ni,ni->n", axis, gap_rate) + np.einsum("ni,ni->n", axis_rate, gap))


def _ends(joint: Joint) -> tuple[Node, Node, float]:
    """The node that slides, the one with the axis, and the sign of the joint's node's motion."""
    carrier = joint.own_axes.carrier
    return (joint.to, carrier, -1.0) if carrier is joint.node else (joint.node, carrier, 1.0)


def _way(recording: Recording, joint: Joint) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Axis, vector between the nodes, and the rates of both."""
    other, carrier, _ = _ends(joint)
    there, here = dof_block(other, "position"), dof_block(carrier, "position")
    gap, gap_rate = (_part(recording, part, there) - _part(recording, part, here) for part in "qv")
    own, spin = joint.axis, _part(recording, "v", dof_block(carrier, "rotation"))
    R = _rotation(recording, carrier)
    if recording.model.planar:
        c, s = np.cos(R), np.sin(R)
        axis = np.stack([c * own[0] - s * own[1], s * own[0] + c * own[1]], axis=1)
        turned = spin * np.stack([-axis[:, 1], axis[:, 0]], axis=1)
    else:
        axis = R @ own
        turned = np.einsum("nij,nj->ni", R, np.cross(spin, own))
    return axis, gap, gap_rate, turned


def _part(recording: Recording, part: str, block: DofBlock) -> NDArray:
    """Coordinates of a DOF block or their rates, (n, size); of the ground as they stay."""
    if block not in recording.numbering.dof_blocks:
        return np.tile(block.start if part == "q" else 0.0 * block.start,
                       (len(recording.rows), 1))
    return recording.recorded(part)[:, stretch(recording.numbering, block)]


def _rotation(recording: Recording, node: Node) -> NDArray:
    """Rotation matrices of a node, (n, 3, 3); in a plane angles."""
    if node.rotation not in recording.numbering.dof_blocks:       # of the ground
        n = len(recording.rows)
        return np.zeros(n) if recording.model.planar else np.tile(np.eye(3), (n, 1, 1))
    if recording.model.planar:
        at = stretch(recording.numbering, dof_block(node, "rotation"))
        return recording.recorded("q")[:, at.start]
    k = recording.numbering.rotations[dof_block(node, "rotation")]
    return recording.recorded("R")[:, 9 * k:9 * k + 9].reshape(-1, 3, 3)


def _of_kind(recording: Recording, name: str, kinds: tuple[str, ...], what: str, does: str
             ) -> Joint:
    joint = joints(recording)[name]
    if joint.kind not in kinds:
        raise InputError(f"joint {name!r} is a {joint.kind}, which does not {does} about or along "
                         f"one axis and has no {what}; that is what {', '.join(kinds)} joints do")
    return joint
