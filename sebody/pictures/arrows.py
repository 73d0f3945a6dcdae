"""Loads as arrows of a picture: forces and torques at nodes, and the resultants of loads on bodies.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.parts import Element
from sebody.pictures.surface import spatial
from sebody.results.histories import histories
from sebody.results.result import Result

KINDS = {"position": "force", "rotation": "torque"}


class Arrow(NamedTuple):
    """A force or torque over time."""

    kind: str               # force or torque
    name: str               # of the load
    at: str                 # node, or body at the origin of whose frame it is
    on_body: bool
    values: NDArray         # (frames, 3) in global axes


def arrows(result: Result, states: NDArray, nodes: set[str], bodies: set[str]) -> list[Arrow]:
    """Arrows of the loads on some nodes and bodies that are drawn; springs have none.

    Those that vanish at all times are left out.
    """
    drawn = []
    for load in result.model.loads:
        if load.kind.endswith(("force", "torque")):
            drawn += _on_nodes(result, load, states, nodes)
        elif load.body is not None and load.body.name in bodies:
            drawn.append(_resultant(result, load, states))
    return [arrow for arrow in drawn if np.any(arrow.values)]


def _on_nodes(result: Result, load: Element, states: NDArray, nodes: set[str]) -> list[Arrow]:
    return [Arrow(KINDS[kind], load.name, node.name, False, _on(result, load, node, kind, states))
            for node, kind in load.attachments if node.name in nodes]


def _resultant(result: Result, load: Element, states: NDArray) -> Arrow:
    """The sum of the forces on the boundary, which is that of the load: see `Model.body_load`."""
    total = sum(_on(result, load, node, kind, states)
                for node, kind in load.attachments if kind == "position")
    return Arrow("force", load.name, load.body.name, True, total)


def _on(result: Result, load: Element, node, kind: str, states: NDArray) -> NDArray:
    values = histories(result).on(load, node, kind)[states]
    if values.shape[1] == 1:                    # a moment in a plane
        return np.pad(values, ((0, 0), (2, 0)))
    return spatial(values)
