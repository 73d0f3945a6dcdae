"""Bodies as lines between their nodes, for pictures."""

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism


def lines_of(model: Mechanism) -> list[tuple[str, str]]:
    """Pairs of nodes that lines join: neighbouring nodes of a superelement, ends of a rigid link.

    Lines of no length, and those to the ground, are left out.
    """
    pairs = []
    for body in model.bodies.values():
        nodes = [body.nodes[i] for i in body.reduced.position_nodes]
        pairs += [(nodes[i], nodes[j])
                  for i, j in neighbours(np.array([node.point for node in nodes]))]
    pairs += [(c.to, c.node) for c in model.connections if c.kind == "position" and c.to]
    return [(one.name, other.name) for one, other in pairs
            if {one.name, other.name} <= set(model.nodes)
            and not np.array_equal(one.point, other.point)]


def neighbours(points: NDArray) -> list[tuple[int, int]]:
    """Pairs of points to both of which no third one is nearer than they are to each other.

    These relative neighbours (Toussaint 1980) are next to each other on a line, and along the edges
    of a box.
    """
    count = len(points)
    distances = np.linalg.norm(points[:, None] - points, axis=2)
    others = distances + np.diag(np.full(count, np.inf))    # a point is no third one
    nearest = [np.maximum(others[i], others).min(axis=1) for i in range(count)]
    slack = 1.0 - 1e-9      # equal distances remain equal, whatever rounding makes of them
    return [(i, j) for i in range(count) for j in range(i + 1, count)
            if nearest[i][j] >= slack * distances[i, j]]
