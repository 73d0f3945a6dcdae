"""Bodies that are not connected to the ground."""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Element, Superelement


def untied(model: Mechanism) -> list[list[str]]:
    """Names of the bodies that are not connected to the ground, connected ones in one list.

    Ties are fixed and prescribed positions, joints, springs and forces of users on positions, and
    nodes that bodies share.
    """
    bodies: dict[str, Superelement | Element] = {**model.bodies, **model.rigid_bodies}
    places: dict[DofBlock, int] = {}     # number of each DOF block
    pairs = []
    elements: list[Superelement | Element] = [*bodies.values(), *model.constraints, *model.loads]
    for element in elements:
        numbers = [places.setdefault(one, len(places)) for one in _tied(element)]
        pairs += [(numbers[0], number) for number in numbers]
    held = {t for t in model.dof_blocks() if t.fixed and not t.rotational}
    holding = [c for joint in model.joints if model.nodes.get(joint.to.name) is not joint.to
               for c in joint.constraints]
    holding += [load for load in model.loads if load.function is not None]  # perhaps supports
    held |= {one for element in holding for one in _tied(element)}
    rows, columns = np.array(pairs, dtype=int).reshape(-1, 2).T
    links = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(places), len(places)))
    groups = connected_components(links, directed=False)[1]
    grounded = {groups[places[key]] for key in held if key in places}
    bodies_by_group: dict[int, list[str]] = {}
    for name, body in bodies.items():
        if (group := groups[places[_tied(body)[0]]]) not in grounded:
            bodies_by_group.setdefault(group, []).append(name)
    return list(bodies_by_group.values())


def _tied(element: Superelement | Element) -> list[DofBlock]:
    """DOF blocks that an element ties together; none if it acts on rotations alone."""
    dof_blocks = ((*element.positions, *element.rotations) if isinstance(element, Superelement) else
                element.dof_blocks)
    if all(one.rotational for one in dof_blocks):
        return []
    return [parent for one in dof_blocks for parent in one.parents()]
