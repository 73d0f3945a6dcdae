"""Nodes of a picture: where they are in each frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.parts import Node
from sebody.pictures.drawn_bodies import quaternions
from sebody.pictures.surface import spatial
from sebody.results.result import Result


class DrawnNode(NamedTuple):
    """A node with a position."""

    name: str
    position: NDArray       # (frames, 3)
    rotation: NDArray | None        # (frames, 4)


def drawn_nodes(result: Result, states: NDArray) -> dict[str, DrawnNode]:
    """The nodes with a position, those of the ground among them, in some recorded states."""
    return {node.name: drawn for node in (*result.model.nodes.values(), *result.model.grounds)
            if (drawn := _node(result, node, states)) is not None}


def extent(nodes: dict[str, DrawnNode]) -> float:
    """Largest extent of the nodes in any frame; of a single one, of its path."""
    places = np.stack([node.position for node in nodes.values()], axis=1)
    size = np.linalg.norm(np.ptp(places, axis=1), axis=1).max()
    path = np.linalg.norm(np.ptp(places.reshape(-1, 3), axis=0))
    return float(size if size > 0 else path if path > 0 else 1.0)


def _node(result: Result, node: Node, states: NDArray) -> DrawnNode | None:
    if node.position is None:
        return None
    if node.name not in result.model.nodes:         # of the ground
        return DrawnNode(node.name, np.tile(spatial(node.point), (len(states), 1)), None)
    known = result.numbering.dof_blocks
    if node.position not in known:
        return None
    rotated = node.rotation is not None and node.rotation in known
    return DrawnNode(node.name, spatial(result[f"{node.name}.position"][states]),
                     quaternions(result[f"{node.name}.rotation"][states]) if rotated else None)
