"""Bodies, nodes, links, signs and loads as the page of an animation reads them.

Lengths are relative to the characteristic length, places from its middle.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.pictures.blocks import Blocks
from sebody.pictures.drawn_bodies import DrawnBody
from sebody.pictures.scene import Scenery
from sebody.results.references import Welded, together
from sebody.results.result import Result

COLOUR = 12             # bits of a stress
SEEN = 1e-5             # of the model's extent: smaller steps of a place are not seen


class Measure(NamedTuple):
    """The characteristic length of a model, and its middle."""

    size: float
    middle: NDArray

    def places(self, points: NDArray) -> NDArray:
        return (points - self.middle) / self.size


def bodies(blocks: Blocks, drawn: Scenery, measure: Measure, stress: float) -> list[dict]:
    """Surfaces and motions of the bodies; stresses in parts of the largest one."""
    number = {name: k for k, name in enumerate(drawn.nodes)}
    return [_body(blocks, body, measure, stress, number) for body in drawn.bodies]


def _body(blocks: Blocks, body: DrawnBody, measure: Measure, stress: float,
          number: dict[str, int]) -> dict:
    surface, modes, size = body.surface, body.amplitudes.shape[1], measure.size
    turning = modes and np.any(surface.turns)
    # rows: components of stations, all x before all y before all z; columns: amplitudes
    moves, turns = (shapes.transpose(2, 1, 0).reshape(3 * len(surface.points), modes)
                    for shapes in (surface.moves / size, surface.turns))
    weights = surface.weights
    skin = not np.any(surface.offsets)
    return {
        "name": body.name, "modes": modes,
        "points": blocks.values(surface.points.T.reshape(-1, 1) / size, SEEN / 10),
        "moves": blocks.values(moves), "turns": blocks.values(turns) if turning else None,
        "starts": blocks.indices(weights.indptr), "stations": blocks.indices(weights.indices),
        "weights": blocks.values(weights.data[:, None]),
        "offsets": None if skin else blocks.values(surface.offsets.T.reshape(-1, 1) / size),
        "triangles": blocks.indices(surface.triangles),
        "edges": blocks.indices(surface.edges),
        "features": blocks.indices(surface.features),
        "labels": None if body.rigid else blocks.indices(body.labels),
        "origin": blocks.values(measure.places(body.origin), SEEN),
        "rotation": blocks.values(body.rotation),
        "amplitudes": blocks.values(body.amplitudes),
        "thickness": 0.0 if skin else 2 * float(
            np.median(np.linalg.norm(surface.offsets, axis=1))) / size,
        "rigid": body.rigid, "start": measure.places(body.start).tolist(),
        "held": [{"node": number[node.name], "point": (node.point / size).tolist(),
                  "position": node.position, "rotation": node.rotation, "full": node.full}
                 for node in body.nodes],
        "reference": _reference([number[name] for name in body.reference]),
        "stress": None if body.stress is None else blocks.values(body.stress / stress, bits=COLOUR),
        "stride": body.stride}


def _reference(nodes: list[int]) -> int | list[int] | None:
    """The node that displacements are measured from, or the two of a chord."""
    return nodes if len(nodes) > 1 else nodes[0] if nodes else None


def nodes(blocks: Blocks, result: Result, drawn: Scenery, measure: Measure) -> list[dict]:
    """Nodes, with the numbers of those at one place and of those that move as one."""
    model = result.model
    grounds = {node.name for node in model.grounds} - set(model.nodes)
    sets, clusters = together(model), Welded(model).clusters()
    return [{"name": node.name, "ground": node.name in grounds,
             "set": sets[node.name].number, "fixed": sets[node.name].fixed,
             "cluster": clusters[node.name],
             "position": blocks.values(measure.places(node.position), SEEN),
             "rotation": None if node.rotation is None else blocks.values(node.rotation)}
            for node in drawn.nodes.values()]


def contacts(blocks: Blocks, drawn: Scenery, measure: Measure) -> list[dict]:
    """Contact surfaces; points from the node that carries them, on the ground from the middle."""
    number = {name: k for k, name in enumerate(drawn.nodes)}
    surfaces = []
    for one in drawn.contacts:
        points = one.shape.points
        points = measure.places(points) if one.node is None else points / measure.size
        surfaces.append({"name": one.name, "kind": one.kind,
                         "node": None if one.node is None else number[one.node],
                         "points": blocks.values(points, SEEN / 10),
                         "lines": blocks.indices(one.shape.lines),
                         "triangles": blocks.indices(one.shape.triangles)})
    return surfaces


def ropes(blocks: Blocks, drawn: Scenery, measure: Measure) -> list[dict]:
    """Points of ropes in each frame, and the node that each of them is at."""
    number = {name: k for k, name in enumerate(drawn.nodes)}
    return [{"name": rope.name, "nodes": [number[name] for name in rope.places],
             "points": blocks.values(measure.places(rope.points).reshape(len(drawn.t), -1), SEEN),
             "slack": blocks.values(1.0 * rope.slack[:, None])} for rope in drawn.ropes]


def marks(blocks: Blocks, drawn: Scenery) -> dict:
    """Links, signs, and loads in parts of the largest of their kind."""
    number = {name: k for k, name in enumerate(drawn.nodes)}
    body = {one.name: k for k, one in enumerate(drawn.bodies)}
    largest = {kind: max((float(np.linalg.norm(arrow.values, axis=1).max())
                          for arrow in drawn.arrows if arrow.kind == kind), default=0.0)
               for kind in ("force", "torque")}
    weight = float(np.linalg.norm(drawn.gravity))
    return {
        "links": [{"kind": link.kind, "ends": [number[name] for name in link.ends]}
                  for link in drawn.links],
        "signs": [{"kind": sign.kind, "name": sign.name, "node": number[sign.node],
                   "carrier": number[sign.carrier], "axes": sign.axes.T.tolist()}
                  for sign in drawn.signs],
        "arrows": [{"kind": arrow.kind, "name": arrow.name, "largest": largest[arrow.kind],
                    "node": None if arrow.on_body else number[arrow.at],
                    "body": body[arrow.at] if arrow.on_body else None,
                    "values": blocks.values(arrow.values / largest[arrow.kind])}
                   for arrow in drawn.arrows],
        "gravity": (drawn.gravity / weight).tolist() if weight > 0 else None, "weight": weight}
