"""Ropes of a picture: tangents between points and sheaves, and arcs of contact, in each frame.

Where a rope meets and leaves sheaves follows from the angles that its equations keep, as `wraps`.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element
from sebody.model.rope_parts import Rope, RopePlace, Sheave
from sebody.pictures.contact_shapes import across_of
from sebody.pictures.drawn_nodes import DrawnNode
from sebody.pictures.surface import spatial
from sebody.quantities import ropes
from sebody.results.histories import Histories, histories
from sebody.results.result import Result

ARC = 17                # points of an arc of contact


class DrawnRope(NamedTuple):
    """A part of a rope with one tension, as lines from each point to the next."""

    name: str               # of the rope
    points: NDArray         # (frames, points, 3)
    places: list[str]       # (points,) nodes that the points are at
    slack: NDArray          # (frames,) whether it is free of tension


def numbers_of_ropes(model: Mechanism) -> int:
    """Numbers of all points of ropes in a frame, at most."""
    return sum(3 * (ARC + 2) * len(rope.places) for rope in model.ropes.values()) + 6 * len(
        _turning(model))


def drawn_ropes(result: Result, states: NDArray, nodes: Mapping[str, DrawnNode]
                ) -> list[DrawnRope]:
    """Ropes between drawn nodes, in some recorded states, and spokes of sheaves that turn."""
    of = histories(result)
    found = [part for rope in result.model.ropes.values()
             if all(place.node.name in nodes for place in rope.places)
             for part in _parts(of, rope, states, nodes)]
    return found + [_spoke(of, sheave, states, nodes[sheave.node.name])
                    for sheave in _turning(result.model) if sheave.node.name in nodes]


def _turning(model: Mechanism) -> list[Sheave]:
    """Sheaves that turn relative to their nodes."""
    return [sheave for sheave in model.sheaves.values() if sheave.wheel is not None]


def _spoke(of: Histories, sheave: Sheave, states: NDArray, node: DrawnNode) -> DrawnRope:
    """A line from the centre of a sheave to its rim, which turns with it."""
    u, v = across_of(sheave.axis)
    angle = of.whole(ropes.turned(of, sheave.name, "q"))[states][:, None]
    rim = sheave.radius * (np.cos(angle) * u + np.sin(angle) * v)
    points = np.stack([np.zeros_like(rim), rim], axis=1)
    return DrawnRope(sheave.name, _in_space(node, points), 2 * [sheave.node.name],
                     np.zeros(len(states), dtype=bool))


def _parts(of: Histories, rope: Rope, states: NDArray, nodes: Mapping[str, DrawnNode]
           ) -> Iterator[DrawnRope]:
    """The stretches of a rope; an arc between two is drawn with the first."""
    wraps, k = iter(ropes.wraps(of, rope.name)), 0
    for stretch in rope.stretches:
        pieces = []         # places, and (frames, points, 3) from their nodes
        for span in stretch.spans:
            a, b = rope.places[k:k + 2]
            way = 1.0 if span.attachments[0].node is a.node else -1.0
            pieces.append((a, _touched(of, span, a, way, states, np.zeros(1))))
            k += 1
            turned = np.zeros(1)
            if b.sheave is not None and k + 1 < len(rope.places):
                wrap = np.sign(b.radius) * next(wraps)[states]
                turned = wrap[:, None] * np.linspace(0.0, 1.0, ARC)
            pieces.append((b, _touched(of, span, b, way, states, turned)))
        yield DrawnRope(
            rope.name, np.concatenate([_in_space(nodes[place.node.name], points)
                                       for place, points in pieces], axis=1),
            [place.node.name for place, points in pieces for _ in range(points.shape[1])],
            of.whole(ropes.taut(of, stretch))[states] == 0.0)


def _touched(of: Histories, span: Element, place: RopePlace, way: float, states: NDArray,
             turned: NDArray) -> NDArray:
    """Points on a sheave from where a span touches it on, from its node, in axes of the node.

    The rope runs along t there, and touches at ``-r n x t``; further on t has turned about n.
    """
    if place.sheave is None:
        return np.zeros((len(states), 1, 3))
    n = place.normal
    ray = way * spatial(span.vector(f"e1_{'ab'[ropes.end(span, place)]}"))
    angle = (ropes.angle(of, span, place)[states][:, None] + turned)[..., None]
    touched: NDArray = -place.radius * (np.cos(angle) * np.cross(n, ray) - np.sin(angle) * ray)
    return touched


def _in_space(node: DrawnNode, points: NDArray) -> NDArray:
    turned = points
    if node.rotation is not None:
        turned = np.einsum("fij,fpj->fpi", Rotation.from_quat(node.rotation).as_matrix(), points)
    return node.position[:, None] + turned
