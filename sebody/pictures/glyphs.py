"""Links and signs of a picture: what has no surface of its own."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism
from sebody.model.parts import Joint, Node
from sebody.model.shafts import is_unbalance
from sebody.pictures.wireframe import neighbours

SPRINGS = "spring", "planar_spring", "table_spring", "planar_table_spring"
SLIDING = "slider", "prismatic", "cylindrical", "planar", "path"
ABOUT_Z = np.eye(3)[:, [2, 0, 1]]       # axes whose first direction is z


class Link(NamedTuple):
    """A line between two nodes: a body made of matrices, a rigid link, a distance, a spring."""

    kind: str               # body, rod, distance or spring
    ends: tuple[str, str]
    body: str = ""          # that it is drawn for


class Sign(NamedTuple):
    """A sign at a node: of a joint, drive, support or point mass."""

    kind: str
    name: str
    node: str
    axes: NDArray           # (3, 3) columns
    carrier: str            # node that they turn with


def links(model: Mechanism, nodes: set[str], drawn: set[str]) -> list[Link]:
    """Lines between some `nodes`; `drawn` bodies have a surface."""
    lines = []
    for body in model.bodies.values():
        if body.name not in drawn:
            held = [body.nodes[i] for i in body.reduced.position_nodes]
            lines += [Link("body", (held[i].name, held[j].name), body.name)
                      for i, j in neighbours(np.array([node.point for node in held]))]
    lines += [Link("rod", (c.to.name, c.node.name)) for c in model.connections
              if c.kind == "position" and c.to and not np.array_equal(c.to.point, c.node.point)]
    lines += [Link("distance", (joint.node.name, joint.to.name)) for joint in model.joints
              if joint.kind == "distance"]
    lines += [Link("spring", (load.attachments[0].node.name, load.attachments[1].node.name))
              for load in model.loads if load.kind in SPRINGS]
    return [link for link in dict.fromkeys(lines) if set(link.ends) <= nodes]


def signs(model: Mechanism, nodes: set[str]) -> list[Sign]:
    """Signs at some `nodes`."""
    def on_ground(node: Node) -> bool:
        return model.nodes.get(node.name) is not node

    drawn = [Sign(joint.kind, joint.name, (joint.to if on_ground(joint.node) else joint.node).name,
                  _columns(joint), joint.axes.carrier.name)
             for joint in model.joints if joint.axes is not None]
    drawn += [Sign("path", joint.name, joint.node.name, ABOUT_Z, joint.node.name)
              for joint in model.joints if joint.kind == "path"]
    drawn += [Sign("ground", f"ground of {joint.name}", node.name, ABOUT_Z, node.name)
              for joint in model.joints for node in (joint.node, joint.to) if on_ground(node)
              and joint.kind not in SLIDING]
    for node in model.nodes.values():
        if node.position is not None and node.position.fixed:
            kind = "drive" if node.position.motions else "ground"
            drawn.append(Sign(kind, node.name, node.name, ABOUT_Z, node.name))
    drawn += [Sign("mass", body.name, body.attachments[0].node.name, ABOUT_Z,
                   body.attachments[0].node.name)
              for body in model.rigid_bodies.values()
              if body.kind.endswith("point_mass") or is_unbalance(body)]
    return [sign for sign in drawn if {sign.node, sign.carrier} <= nodes]


def _columns(joint: Joint) -> NDArray:
    """Axes of a joint in space; in a plane that of a hinge is z."""
    columns = joint.axes.columns
    if len(columns) == 3:
        return columns
    if joint.kind not in SLIDING and not any("slide" in c.kind for c in joint.constraints):
        return ABOUT_Z
    axes = np.eye(3)
    axes[:2, :2] = columns
    return axes
