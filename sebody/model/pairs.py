"""Two nodes that a joint, drive or spring acts on."""

import numpy as np

from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block, known
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import ground
from sebody.model.parts import Node

NEAR = 1e-9     # of the size of the model: nodes of a joint coincide
GROUND = "ground"


def pair(model: Mechanism, node: Node | str, to: Node | str | None, what: str,
         kinds: tuple[str, ...] = ("position", "rotation")) -> tuple[Node, Node]:
    """Both nodes of a joint; the ground is a fixed node at the place of the first."""
    a = known(model, node)
    other = None if on_ground(model, to) else to
    b = ground(model, a) if other is None else known(model, other)
    if a is b:
        raise InputError(f"{what}: node {a.name!r} is joined to itself: give two nodes")
    for kind in kinds:
        dof_block(a, kind)
        dof_block(b, kind)
    return a, b


def on_ground(model: Mechanism, to: Node | str | None) -> bool:
    """Tell whether the other node is the ground: none is given, or a name that no node has."""
    return to is None or (isinstance(to, str) and to == GROUND and to not in model.nodes)


def check_together(model: Mechanism, a: Node, b: Node, what: str) -> None:
    """Refuse nodes that do not coincide."""
    if np.abs(b.point - a.point).max() > NEAR * model.size():
        apart = "" if what != "weld" else (
            ", or hold what is apart by attach, or rigid_body(..., centre=)")
        raise InputError(f"{what}: nodes {a.name!r} and {b.name!r} do not coincide: give both the "
                         f"same point{apart}")
