"""Springs that carry the preload of a body: see `sebody.reduction.preload`."""

from sebody.model.mechanism import Mechanism
from sebody.model.nodes import attach
from sebody.model.parts import Node, Superelement
from sebody.model.springs import spring


def add_preload(model: Mechanism, body: Superelement) -> None:
    """Put the springs of a body's preload between its nodes, or points that are tied to these.

    Raises
    ------
    InputError
        A name that is taken.
    """
    preload = body.reduced.preload
    if preload is None:
        return
    points: dict[tuple[int, bytes], Node] = {}
    for k, (nodes, arms, tension) in enumerate(zip(preload.nodes, preload.arms, preload.tension,
                                                   strict=True)):
        ends = []
        for number, arm in zip(nodes, arms, strict=True):
            node = body.nodes[number]
            key = int(number), arm.tobytes()
            if arm.any() and key not in points:
                points[key] = attach(model, f"{body.name} preload point {len(points)}",
                                     node.point + arm, node)
            ends.append(points.get(key, node))
        length = float(((ends[1].point - ends[0].point)**2).sum()**0.5)
        # a line in compression is a spring with twice its length as free length
        spring(model, ends[0], ends[1], stiffness=abs(float(tension)) / length,
               length=0.0 if tension > 0 else 2 * length, name=f"{body.name} preload {k}")
