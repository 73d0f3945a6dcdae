"""A model as tables of HTML, for notebooks and reports."""

from collections.abc import Iterable, Sequence
from html import escape

from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Triplet

MOST_ROWS = 40          # of a table that is not folded


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table; one of many rows is folded."""
    rows = list(rows)
    head = "".join(f"<th>{escape(one)}</th>" for one in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(one))}</td>" for one in row) + "</tr>"
                   for row in rows)
    text = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    if len(rows) <= MOST_ROWS:
        return text
    return f"<details><summary>{len(rows)} rows</summary>{text}</details>"


def model_tables(model: Mechanism) -> list[tuple[str, str]]:
    """Titles and tables: bodies, nodes and what their coordinates are, joints, loads."""
    found = [("Bodies", table(("body", "kind", "mass", "nodes", "formulation"), _bodies(model))),
             ("Nodes", table(("node", "point", "position", "rotation"), _nodes(model))),
             ("Joints and drives", table(("name", "kind", "of", "to", "equations"),
                                         _joints(model))),
             ("Loads, springs and dampers", table(("name", "kind", "on"), _loads(model)))]
    return [(title, text) for title, text in found if "<td>" in text]


def summary(model: Mechanism) -> str:
    """A line on a model."""
    parts = ((len(model.bodies), "superelement"), (len(model.rigid_bodies), "rigid body"),
             (len(model.nodes), "node"), (len(model.joints), "joint"), (len(model.loads), "load"))
    counted = [f"{count} {what if count == 1 else _plural(what)}" for count, what in parts if count]
    gravity = ", ".join(f"{value:g}" for value in model.gravity_field)
    return (f"{'planar' if model.planar else 'spatial'} model: {', '.join(counted) or 'empty'}"
            + (f"; gravity ({gravity})" if model.gravity_field.any() else ""))


def _plural(what: str) -> str:
    return what[:-1] + "ies" if what.endswith("y") else what + "s"


def _bodies(model: Mechanism) -> list[tuple]:
    found = [(body.name, "superelement", f"{body.body.total_mass:.6g}", _named(body.nodes),
              f"{len(body.body.stiffness)} coordinates ({body.layout}), {body.body.modes} modes; "
              f"frame {body.frame}, inertia {body.inertia}"
              + ("; damped" if body.body.damping is not None else ""))
             for body in model.bodies.values()]
    return found + [(body.name, _plain(body), f"{body.constants['mass']:.6g}",
                     _named({place.node.name: place.node for place in body.places}.values()), "")
                    for body in model.rigid_bodies.values()]


def _nodes(model: Mechanism) -> list[tuple]:
    first: dict[int, str] = {}      # triplet -> the node it is told of
    return [(node.name, "(" + ", ".join(f"{value:.6g}" for value in node.point) + ")",
             *(_state(first, node, triplet) for triplet in (node.position, node.rotation)))
            for node in model.nodes.values()]


def _state(first: dict[int, str], node: Node, triplet: Triplet | None) -> str:
    """Whether the coordinates of a node are unknowns, and why not."""
    if triplet is None:
        return "none"
    owner = first.setdefault(id(triplet), node.name)
    if owner != node.name:
        return f"that of {owner}"
    count = triplet.start.size
    if triplet.root is not None:
        return "follows by a rigid link"
    if triplet.motions:
        return f"prescribed by {', '.join(motion.name for motion in triplet.motions)}"
    if triplet.fixed:
        return "fixed"
    return f"{count} unknown{'s' * (count > 1)}"


def _joints(model: Mechanism) -> list[tuple]:
    nodes = model.nodes
    return [(joint.name, joint.kind, joint.node.name,
             joint.to.name if nodes.get(joint.to.name) is joint.to else "the ground",
             str(joint.multipliers) if joint.multipliers else
             "none: its nodes share coordinates, or they are fixed")
            for joint in model.joints]


def _loads(model: Mechanism) -> list[tuple]:
    return [(load.name, _plain(load),
             _named({place.node.name: place.node for place in load.places}.values())
             or (load.mode[0] if load.mode else "")) for load in model.loads]


def _plain(element: Element) -> str:
    return element.kind.removeprefix("planar_").replace("_", " ")


def _named(nodes: Iterable[Node]) -> str:
    return ", ".join(node.name for node in nodes)
