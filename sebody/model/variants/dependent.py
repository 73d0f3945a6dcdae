"""Nodes that are there already, put at the ends of rigid links."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block
from sebody.model.joints import spherical
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import attach
from sebody.model.parts import Connection, DofBlock, Node
from sebody.model.sharing import can_share, share


def is_held(position: DofBlock) -> bool:
    """Tell if a position is fixed, prescribed, or at the end of links that begin at such a one."""
    return position.fixed if position.root is None else position.root.fixed


def start_rate(dof_block: DofBlock) -> NDArray:
    """Initial velocity: of what is prescribed that of its motions, at the end of links by these."""
    if dof_block.root is not None:
        return start_rate(dof_block.root) + sum(
            _velocity(start_rate(rotation), arm) for rotation, arm in dof_block.arms)
    if not dof_block.fixed:
        return dof_block.rate
    return sum((motion.direction * motion.time_function.at(0.0)[1] for motion in dof_block.motions),
               np.zeros_like(dof_block.rate))


def make_dependent(model: Mechanism, node: Node, carrier: Node, keep: str, body: str) -> bool:
    """Put a node at the end of a rigid link, with all that it shares DOF blocks with.

    Where links lead from one to the other already, or both to what is held, the link gets an end of
    its own, which equations keep at the node.

    Parameters
    ----------
    keep : {'full', 'translation', 'rotation'}
        Which of its DOF blocks.
    body : str
        Whose link it is.

    Returns
    -------
    bool
        Whether it takes equations.

    Raises
    ------
    InputError
        Rotations that are both held, or nodes of one rigid body already.
    """
    closed = (keep != "rotation" and node.position is not carrier.position
              and _is_closed(node, carrier))
    if closed:
        _close(model, node, carrier, body)
    elif keep != "rotation" and node.position is not carrier.position:
        _link(model, node, carrier)
    if keep != "translation" and node.rotation is not carrier.rotation:
        own, kept = dof_block(node, "rotation"), dof_block(carrier, "rotation")
        if not can_share(own, kept):
            raise InputError(f"the rotations of {node.name} and {carrier.name} are both fixed or "
                             "prescribed: they cannot be those of one rigid body; hold one of them "
                             "by a joint with explicit=True")
        share(model, own, kept, "rotation")
        model.connections.append(Connection("rotation", node, carrier))
    return closed


def _is_closed(node: Node, carrier: Node) -> bool:
    """Tell whether a further link between two nodes closes a loop of links, the ground included."""
    one, other = (dof_block(n, "position").parents()[0] for n in (node, carrier))
    if one is other and node.rotation is carrier.rotation:
        raise InputError(f"{node.name} and {carrier.name} are joined by rigid links already: they "
                         "cannot be nodes of a further rigid body; open the loop by a joint with "
                         "explicit=True")
    return one is other or (one.fixed and other.fixed)


def _close(model: Mechanism, node: Node, carrier: Node, body: str) -> None:
    """A link with an end of its own, which equations keep at the node."""
    name = f"{node.name} of {body}"
    while name in model.nodes:
        name += "'"
    spherical(model, attach(model, name, node.point, carrier), node, explicit=True)


def _link(model: Mechanism, node: Node, carrier: Node) -> None:
    position = dof_block(node, "position")
    if position.root is not None:
        _begin_at(model, position)
    base = dof_block(carrier, "position")
    root = base if base.root is None else base.root
    arms = (*base.arms, (dof_block(carrier, "rotation"), node.point - carrier.point))
    _move_root(model, position, root, arms)
    position.rate, position.given = np.zeros_like(position.rate), False
    model.connections.append(Connection("position", node, carrier))


def _begin_at(model: Mechanism, position: DofBlock) -> None:
    """Let links begin at a position that was at the end of some: these are passed backwards."""
    root, arms = position.root, position.arms
    assert root is not None
    if root.given and not all(rotation.given or rotation.fixed for rotation, _ in arms):
        raise InputError(f"{root.name} has an initial velocity and is on rigid links to a body "
                         "that is made rigid: give the angular velocities there, too, or none")
    position.rate, position.given = start_rate(position), root.given
    position.root, position.arms = None, ()
    _move_root(model, root, position, tuple((rotation, -arm) for rotation, arm in reversed(arms)))
    root.rate, root.given = np.zeros_like(root.rate), False


def _velocity(rate: NDArray, arm: NDArray) -> NDArray:
    """Velocity of the end of an arm that turns."""
    return rate[0] * np.array([-arm[1], arm[0]]) if len(arm) == 2 else np.cross(rate, arm)


def _move_root(model: Mechanism, old: DofBlock, new: DofBlock, arms: tuple) -> None:
    """Put a root at the end of links from another one, with all links that begin there."""
    for other in model.dof_blocks():
        if other.root is old:
            other.root, other.arms = new, _shortened((*arms, *other.arms))
    old.root, old.arms = new, arms


def _shortened(arms: tuple) -> tuple:
    """Arms without neighbours that go there and back."""
    shortened: list[tuple[DofBlock, NDArray]] = []
    for rotation, arm in arms:
        if shortened and shortened[-1][0] is rotation:
            arm = shortened.pop()[1] + arm
        shortened.append((rotation, arm))
    return tuple((rotation, arm) for rotation, arm in shortened if np.any(arm))
