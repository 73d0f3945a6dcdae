"""Fixed and shared DOF blocks: joints without equations."""

import numpy as np

from sebody.basics.errors import InputError
from sebody.basics.inputs import shown
from sebody.model.arguments import dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, DofBlock, Node


def hold(model: Mechanism, node: Node, kind: str) -> DofBlock:
    """Fix a DOF block of a node, which must not be a dependent position."""
    held = dof_block(node, kind)
    if held.root is not None:
        raise InputError(f"{held.name} follows another node by a rigid link: fix or move "
                         f"{held.root.name} and its rotation instead")
    held.fixed = True
    model.connections.append(Connection(kind, node, None, spare=True))
    return held


def can_share(one: DofBlock, other: DofBlock) -> bool:
    """Tell whether two DOF blocks can be one: at most one of them is fixed or follows another node.

    Two that are fixed at one place and not moved are one already. One that follows the other by
    links closes a loop.
    """
    if one is other:
        return True
    if any(t is one or t is other for a in (one, other) if a.root for t in a.parents()):
        return False
    still = [t.fixed and not t.motions for t in (one, other)]
    return all(still) or any(t.solved for t in (one, other))


def share(model: Mechanism, gone: DofBlock, kept: DofBlock, kind: str) -> None:
    """Replace one DOF block by another at every node, joint and load."""
    if gone is kept:
        return
    if not gone.solved:
        gone, kept = kept, gone
    if gone.given and kept.given and not np.array_equal(gone.rate, kept.rate):
        raise InputError(f"{gone.name} is given the initial velocity {shown(gone.rate)} and "
                         f"{kept.name} {shown(kept.rate)}, but a joint makes them one: give both "
                         "the same, or only one")
    if gone.given:
        kept.rate, kept.given = gone.rate, True
    for node in (*model.nodes.values(), *model.grounds):
        if getattr(node, kind) is gone:
            setattr(node, kind, kept)
    for element in (*model.constraints, *model.loads, *model.rigid_bodies.values()):
        element.dof_blocks = tuple(kept if t is gone else t for t in element.dof_blocks)
    for one in model.dof_blocks():
        if one.root is gone:
            one.root, one.arms = kept.root or kept, (*kept.arms, *one.arms)
        one.arms = tuple((kept if r is gone else r, arm) for r, arm in one.arms)
