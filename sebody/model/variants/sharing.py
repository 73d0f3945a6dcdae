"""Shared DOF blocks in the place of a joint's equations."""

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, DofBlock, Element, Joint, Node
from sebody.model.sharing import can_share, share
from sebody.model.variants.copying import Variant, checked, copied, fewer

_TOGETHER = ("weld", "prismatic")       # joints whose nodes turn together
_NAMES = {"position": "positions", "rotation": "rotations"}


def shared(model: Mechanism, name: str | None = None) -> Variant:
    """The model with shared or fixed DOF blocks in the place of equations of a joint.

    Positions that equations hold together become one, and rotations of welds and prismatic joints:
    the motion stays the same with fewer unknowns. What the joint passes is found from the balance
    of its nodes, as before under its name.

    Parameters
    ----------
    name : str, optional
        Of the joint; by default all joints are treated so that can be, one after the other.

    Returns
    -------
    Variant

    Raises
    ------
    InputError
        No such joint, or one without equations that sharing replaces.
    """
    checked(model)
    if name is not None:
        inputs.name(name, "name of a joint")
        if name not in (joint.name for joint in model.joints):
            raise unknown("joint", name, (joint.name for joint in model.joints), "the model has",
                          "the model has none")
    possible = can_be_shared(model)
    if not (possible if name is None else any(
            _kinds(model, joint) for joint in model.joints if joint.name == name)):
        if reading := [load.name for load in model.loads if load.pressed_by is not None
                       and load.pressed_by.name == name]:
            raise InputError(f"joint {name!r} keeps its equations, whose forces press "
                             f"{reading[0]!r}: define that with reaction=False and a preload")
        what = "the model has no joint with" if name is None else f"joint {name!r} has no"
        others = f"; of this model {', '.join(possible)} has some" if possible else ""
        raise InputError(f"{what} equations that shared positions or rotations can replace{others}")
    made = copied(model)
    said = [_without_equations(made, joint) for joint in made.joints if name in (None, joint.name)]
    return Variant(made, f"{'; '.join(filter(None, said))}: {fewer(model, made)}")


def _without_equations(model: Mechanism, joint: Joint) -> str:
    """Share what can be shared of a joint; in words."""
    kinds = _kinds(model, joint)
    if not kinds:       # what it joins became held when another joint was treated
        return ""
    for kind in kinds:
        _share(model, joint, kind)
    what = " and ".join(_NAMES[kind] for kind in kinds)
    how = (f"{joint.node.name} and {joint.to.name} share" if _is_free(model, joint.to) else
           f"{joint.node.name} is fixed in")
    return f"{joint.name} takes {joint.multipliers or 'no'} equations, {how} {what}"


def can_be_shared(model: Mechanism) -> list[str]:
    """Names of the joints that `shared` can rid of equations, one after the other."""
    made = copied(model)
    return [joint.name for joint in made.joints if _without_equations(made, joint)]


def _is_free(model: Mechanism, node: Node) -> bool:
    """Tell whether a node is no ground."""
    return model.nodes.get(node.name) is node


def _kinds(model: Mechanism, joint: Joint) -> list[str]:
    """The DOF blocks of its nodes that may become one; none where friction reads the equations.

    Nor of a joint that lets go or locks.
    """
    if joint.name in model.switches or any(load.pressed_by is joint for load in model.loads):
        return []
    return [kind for kind in ("position", "rotation")
            if _replaced(joint, kind) and _can_share(model, joint, kind)]


def _replaced(joint: Joint, kind: str) -> list[Element]:
    """Equations that keep two positions, or two rotations, together."""
    if kind == "position":
        return [c for c in joint.constraints
                if c.kind.removeprefix("planar_").startswith("coincident")]
    return [c for c in joint.constraints if joint.kind in _TOGETHER
            and c.kind in ("parallel", "perpendicular", "planar_aligned")]


def _can_share(model: Mechanism, joint: Joint, kind: str) -> bool:
    one, other = getattr(joint.node, kind), getattr(joint.to, kind)
    if one is other or not all(_keeps_rate(a, b) for a, b in ((one, other), (other, one))):
        return False
    return can_share(one, other) if _is_free(model, joint.to) else one.solved


def _keeps_rate(one: DofBlock, other: DofBlock) -> bool:
    """Tell whether an initial velocity that the user gave stays if the DOF blocks become one."""
    if not one.given or not np.any(one.rate):
        return True
    return other.solved and (not other.given or np.array_equal(one.rate, other.rate))


def _share(model: Mechanism, joint: Joint, kind: str) -> None:
    """Put one DOF block in the place of two, and take the equations away."""
    gone, one, other = _replaced(joint, kind), getattr(joint.node, kind), getattr(joint.to, kind)
    joint.constraints = tuple(c for c in joint.constraints if c not in gone)
    free = _is_free(model, joint.to)
    if free:
        share(model, other, one, kind)
    else:
        one.fixed, one.rate = True, np.zeros_like(one.rate)
    model.connections.append(Connection(kind, joint.node, joint.to if free else None, joint))
