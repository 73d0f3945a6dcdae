"""Nodes that are there already, put at the ends of rigid links."""

import numpy as np

from sebody.errors import InputError
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, Node, Triplet
from sebody.model.sharing import can_share, share


def is_held(position: Triplet) -> bool:
    """Whether a position is fixed, prescribed, or at the end of links that begin at such a one."""
    return position.fixed if position.root is None else position.root.fixed


def hang(model: Mechanism, node: Node, carrier: Node, keep: str) -> None:
    """Put a node at the end of a rigid link, with all that it shares triplets with.

    Parameters
    ----------
    keep : {'full', 'translation', 'rotation'}
        Which of its triplets.

    Raises
    ------
    InputError
        Triplets that are both held, or nodes that are linked already.
    """
    if keep != "rotation" and node.position is not carrier.position:
        _link(model, node, carrier)
    if keep != "translation" and node.rotation is not carrier.rotation:
        if not can_share(node.rotation, carrier.rotation):
            raise InputError(f"the rotations of {node.name} and {carrier.name} are both fixed or "
                             "prescribed: they cannot be those of one rigid body; hold one of them "
                             "by a joint with explicit=True")
        share(model, node.rotation, carrier.rotation, "rotation")
        model.connections.append(Connection("rotation", node, carrier))


def _link(model: Mechanism, node: Node, carrier: Node) -> None:
    if node.position.root is not None:
        _begin_at(model, node.position)
    position, base = node.position, carrier.position
    root = base if base.root is None else base.root
    if root is position or position.root is not None:
        raise InputError(f"{node.name} and {carrier.name} are joined by rigid links already: they "
                         "cannot be nodes of a further rigid body; open the loop by a joint with "
                         "explicit=True")
    arms = (*base.arms, (carrier.rotation, node.point - carrier.point))
    _move_root(model, position, root, arms)
    position.rate, position.given = np.zeros_like(position.rate), False
    model.connections.append(Connection("position", node, carrier))


def _begin_at(model: Mechanism, position: Triplet) -> None:
    """Let links begin at a position that was at the end of some: these are passed backwards."""
    root, arms = position.root, position.arms
    if root.given and not all(rotation.given or rotation.fixed for rotation, _ in arms):
        raise InputError(f"{root.name} has an initial velocity and is on rigid links to a body "
                         "that is made rigid: give the angular velocities there, too, or none")
    position.rate, position.given = root.rate + sum(
        _velocity(rotation.rate, arm) for rotation, arm in arms), root.given
    position.root, position.arms = None, ()
    _move_root(model, root, position, tuple((rotation, -arm) for rotation, arm in reversed(arms)))
    root.rate, root.given = np.zeros_like(root.rate), False


def _velocity(rate: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Velocity of the end of an arm that turns."""
    return rate[0] * np.array([-arm[1], arm[0]]) if len(arm) == 2 else np.cross(rate, arm)


def _move_root(model: Mechanism, old: Triplet, new: Triplet, arms: tuple) -> None:
    """Put a root at the end of links from another one, with all links that begin there."""
    for other in model.triplets():
        if other.root is old:
            other.root, other.arms = new, _shortened((*arms, *other.arms))
    old.root, old.arms = new, arms


def _shortened(arms: tuple) -> tuple:
    """Arms without neighbours that go there and back."""
    found = []
    for rotation, arm in arms:
        if found and found[-1][0] is rotation:
            arm = found.pop()[1] + arm
        found.append((rotation, arm))
    return tuple((rotation, arm) for rotation, arm in found if np.any(arm))
