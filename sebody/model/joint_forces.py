"""Equations in place of a position that two nodes of a joint share, or that is fixed.

Friction reads the force in a joint as multipliers. A joint of a shared position has none.
"""

from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, DofBlock, Element, Joint, Node, positions

FORCES = ("coincident", "coincident_ground", "on_line")      # their multipliers are forces


def has_forces(joint: Joint) -> bool:
    """Tell whether a joint has multipliers that are its force."""
    return any(c.kind.removeprefix("planar_") in FORCES for c in joint.constraints)


def give_forces(model: Mechanism, joint: Joint) -> None:
    """Give a joint equations for the position it shares or fixes.

    Raises
    ------
    InputError
        The nodes share their position for another reason, too.
    """
    own = [c for c in model.connections if c.joint is joint and c.kind == "position"]
    others = [c for c in model.connections if c.kind == "position" and c not in own]
    node, to = joint.node, joint.to
    remedy = "build it with explicit=True, or give friction a preload and reaction=False"
    if not own:
        raise InputError(f"friction in {joint.name!r}: it has no equations for its force: {remedy}")
    if to in model.grounds:
        held = [c for c in others if c.to is None and c.node.position is node.position]
        if held:
            raise InputError(f"friction in {joint.name!r}: something else holds the position of "
                             f"node {node.name!r}, too: leave that out, or give friction a preload "
                             "and reaction=False")
        dof_block(node, "position").fixed = False
        equation = Element(joint.name, model.kind_of("coincident_ground"), positions(node),
                           {"c": node.point}, model.dimension)
    else:
        side, shared = _side(model, to, node, others), dof_block(to, "position")
        if side is not None and _linked(side, others):      # it keeps the position of its link
            side = _side(model, node, to, others)
            side = None if side is None or _linked(side, others) else side
        if side is None or any(t.root is shared for t in model.dof_blocks()) or shared.fixed:
            raise InputError(f"friction in {joint.name!r}: nodes {node.name!r} and {to.name!r} "
                             f"share their position in more than one way: {remedy}")
        _separate(model, side, shared, f"{side[0].name}.position")
        equation = Element(joint.name, model.kind_of("coincident"), positions(node, to), {},
                           model.dimension)
    joint.constraints = (equation, *joint.constraints)
    model.connections = [c for c in model.connections if c not in own]


def _side(model: Mechanism, start: Node, end: Node, connections: list[Connection]
          ) -> list[Node] | None:
    """Nodes that share the position of `start` without the joint; None if `end` does."""
    reached, left = {start: start}, [start]
    while left:
        one = left.pop()
        for c in connections:
            if c.to is None or one not in (c.node, c.to):
                continue
            other = c.to if one is c.node else c.node
            if other not in reached and other.position is start.position:
                reached[other] = other
                left.append(other)
    return None if end in reached else list(reached.values())


def _linked(side: list[Node], connections: list[Connection]) -> bool:
    """Tell whether one of some nodes is at the end of a rigid link from a node elsewhere."""
    return any(c.to is not None and c.node in side and c.to.position is not c.node.position
               for c in connections)


def _separate(model: Mechanism, side: list[Node], shared: DofBlock, name: str) -> None:
    """Give some nodes a position of their own."""
    own = DofBlock(name, shared.start.copy(), shared.rate.copy(), given=shared.given)
    for node in side:
        node.position = own
    for element in (*model.constraints, *model.loads, *model.rigid_bodies.values()):
        element.dof_blocks = tuple(getattr(node, kind) for node, kind in element.attachments)
