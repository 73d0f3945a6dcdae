"""Parts of a model that may be inside a superelement, and the model without those outside.

Springs, dampers, joints, rigid parts, stops, contacts and friction may. Supports of interfaces and
loads on them belong to the model that the body is put in; everything else is refused by name.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sebody.assembly.elimination_order import parents
from sebody.basics.errors import InputError
from sebody.contract.names import IN_PLANE
from sebody.explore.assemblies.wanted import Interfaces
from sebody.model.gravity_fields import has_gravity
from sebody.model.model import Model
from sebody.model.parts import DofBlock, Element, Joint
from sebody.model.path_joints import PATH
from sebody.model.variants.copying import copied

PASSIVE = ("spring", "torsion_spring", "table_", "bushing", "gear_play", "distance_stop",
           "slide_stop", "turn_stop", "friction_", "point_on_", "sphere_on_", "body_contact_")
OUTER = ("force", "torque", "follower_force", "follower_torque")
RIGID = ("rigid_body", "point_mass")


class Freed(NamedTuple):
    """A copy of a model without what is outside, and what was left out, in words."""

    model: Model
    left_out: tuple[str, ...]


def refuse_outsiders(model: Model, interfaces: Interfaces) -> None:
    """Refuse what a superelement cannot have inside.

    Raises
    ------
    InputError
        Controllers, actuators, drives, joints on paths, loads on inner nodes, or supports of inner
        nodes.
    """
    if model.controllers:
        raise InputError(f"controller {next(iter(model.controllers))!r} cannot be inside a "
                         "superelement: take it out and control the body from outside")
    if not model.bodies and not model.rigid_bodies:
        raise InputError("the model has no bodies: there is nothing to reduce")
    held = set(interfaces.blocks(model))
    for joint in model.joints:
        if joint.kind == PATH:
            raise InputError(f"joint {joint.name!r} slides along a path and cannot be inside a "
                             "superelement: reduce the model without it, and build it anew on the "
                             "superelement")
        if joint.kind == "drive" and not _supports(model, joint, held):
            raise InputError(f"drive {joint.name!r} at node {joint.node.name!r} cannot be inside a "
                             "superelement: weld what it drives, or make the node an interface")
    for load in model.loads:
        _refuse_load(load, held)
    for node in model.nodes.values():
        for block in (node.position, node.rotation):
            if block is not None and block.fixed and block not in held:
                what = "driven" if block.motions else "fixed"
                raise InputError(f"{block.name} is {what}, and node {node.name!r} is no interface: "
                                 "a superelement is free. Make the node an interface, or take out "
                                 "what holds it")


def _refuse_load(load: Element, held: set[DofBlock]) -> None:
    kind = load.kind.removeprefix(IN_PLANE)
    where = " and ".join(dict.fromkeys(repr(one.node.name) for one in load.attachments))
    at = f" at node {where}" * bool(where)
    if kind.startswith(PASSIVE):
        return
    if kind in OUTER:
        if inner := [t for t in parents(load.dof_blocks) if t not in held]:
            raise InputError(f"{kind.replace('_', ' ')} {load.name!r} acts on {inner[0].name}, "
                             "inside the superelement: make the node an interface, or leave the "
                             "load out")
        return
    raise InputError(f"{kind.replace('_', ' ')} {load.name!r}{at} cannot be inside a superelement, "
                     "which has springs, dampers, stops, contacts and friction that sticks: leave "
                     "it out, and add it to the model that the body is put in")


def without_gravity(model: Model) -> Model:
    """A copy without gravity: the body bears its own where it is put."""
    made: Model = copied(model)     # type: ignore[assignment]
    made.gravity_field, made.gravity_courses = np.zeros(model.dimension), []
    return made


def freed(model: Model, interfaces: Interfaces) -> Freed:
    """A copy whose interfaces are free: without their supports, and without loads on them."""
    made = without_gravity(model)
    held = set(interfaces.blocks(made))
    supports = [joint for joint in made.joints if _supports(made, joint, held)]
    loads = [load for load in made.loads if load.kind.removeprefix(IN_PLANE) in OUTER]
    left_out = ["gravity, which the body bears itself"] * has_gravity(model)
    left_out += [f"{joint.kind} {joint.name!r}" for joint in supports]
    left_out += [f"{load.kind.removeprefix(IN_PLANE).replace('_', ' ')} {load.name!r}"
                 for load in loads]
    left_out += [f"what {'drives' if block.motions else 'fixes'} {block.name}"
                 for block in dict.fromkeys(interfaces.blocks(made)) if block.fixed]
    made.joints = [joint for joint in made.joints if joint not in supports]
    made.connections = [one for one in made.connections
                        if one.to is not None and one.joint not in supports]
    made.loads = [load for load in made.loads if load not in loads]
    for block in held:
        block.fixed, block.motions = False, []
    for block in made.dof_blocks():
        block.rate, block.given = np.zeros_like(block.rate), False
    for body in made.bodies.values():
        body.mode_rates = np.zeros_like(body.mode_rates)
    return Freed(made, tuple(left_out))


def _supports(model: Model, joint: Joint, held: set[DofBlock]) -> bool:
    """Tell if a joint holds interfaces alone, to the ground; one between interfaces is inside."""
    ends = [block for one in joint.constraints for block in one.dof_blocks]
    return joint.to in model.grounds and all(t in held or t.fixed for t in parents(ends))
