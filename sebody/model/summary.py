"""A model as tables: of HTML for notebooks and reports, of text for its summary."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from sebody.basics.tabular import counted, table, text, vector
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Element, Node
from sebody.model.path_shapes import cautions
from sebody.model.shafts import is_unbalance
from sebody.model.ties import untied


class Unknowns(NamedTuple):
    """The number of unknowns of a model, and of what."""

    nodes: int
    modes: int
    equations: int


def unknowns(model: Mechanism) -> Unknowns:
    """Unknowns of a model: coordinates of nodes, amplitudes of modes, multipliers."""
    return Unknowns(sum(t.start.size for t in model.dof_blocks() if t.solved),
                    sum(body.reduced.modes for body in model.bodies.values()),
                    sum(joint.multipliers for joint in model.joints))


def model_tables(model: Mechanism) -> list[tuple[str, str]]:
    """Titles and tables of HTML: bodies, nodes and what their coordinates are, joints, loads."""
    return [(title, table(heads, rows)) for title, heads, rows in _tables(model)]


def summary(model: Mechanism) -> str:
    """A line on a model."""
    parts = ((len(model.bodies), "superelement"), (len(model.rigid_bodies), "rigid body"),
             (len(model.nodes), "node"), (len(model.joints), "joint"),
             (sum(load.law is None for load in model.loads), "load"))
    counts = [counted(count, what) for count, what in parts if count]
    gravity = ", ".join(f"{value:g}" for value in model.gravity_field)
    return (f"{'planar' if model.planar else 'spatial'} model: {', '.join(counts) or 'empty'}"
            + (f"; gravity ({gravity})" if model.gravity_field.any() else "")
            + "".join(f"; {one.name} ({', '.join(f'{x:g}' for x in one.direction)}) times "
                      f"{one.time_function.described()}" for one in model.gravity_courses))


def described(model: Mechanism) -> str:
    """A model in words and tables: what there is to check before a run."""
    nodes, modes, equations = unknowns(model)
    masses = [body.reduced.total_mass for body in model.bodies.values()]
    masses += [body.number("mass") for body in model.rigid_bodies.values()]
    lines = [summary(model),
             f"unknowns  {nodes + modes + equations}: {nodes} of nodes, {modes} of modes, "
             f"{equations} of joint equations",
             f"mass      {sum(masses):.6g}"]
    if loose := [name for group in untied(model) for name in group]:
        lines.append("free      " + ", ".join(loose) + ": not connected to the ground")
    lines += [f"caution   {one}" for path in model.paths.values() for one in cautions(model, path)]
    return "\n\n".join(["\n".join(lines), *(text(*one) for one in _tables(model))])


def _tables(model: Mechanism) -> list[tuple[str, Sequence[str], list[tuple]]]:
    """Titles, heads and rows of the tables that have rows."""
    tables = [("Bodies", ("body", "kind", "mass", "nodes", "formulation"), _bodies(model)),
              ("Nodes", ("node", "point", "position", "rotation", "initial velocity"),
               _nodes(model)),
              ("Joints and drives", ("name", "kind", "of", "to", "equations"), _joints(model)),
              ("Paths", ("path", "on", "length", "knots", "ends"), _paths(model)),
              ("Loads, springs and dampers", ("name", "kind", "on", "course"), _loads(model)),
              ("Sensors", ("name", "quantity", "between samples", "delay", "noise"),
               _sensors(model)),
              ("Controllers", ("name", "from", "to", "period", "delay", "states"),
               _controllers(model))]
    return [one for one in tables if one[2]]


def _sensors(model: Mechanism) -> list[tuple]:
    return [(one.name, one.quantity + f" in axes of {one.axes}" * bool(one.axes),
             f"{one.period:.6g}" if one.period else "", one.delay, f"{one.noise:.6g}")
            for one in model.sensors.values()]


def _controllers(model: Mechanism) -> list[tuple]:
    return [(one.name, ", ".join(one.inputs), ", ".join(one.outputs),
             f"{one.period:.6g}" if one.period else "continuous",
             f"{one.delay:g}", len(one.states)) for one in model.controllers.values()]


def _bodies(model: Mechanism) -> list[tuple]:
    rows = [(body.name, "superelement", f"{body.reduced.total_mass:.6g}", _named(body.nodes),
             f"{len(body.reduced.stiffness)} coordinates ({body.layout}), "
             f"{body.reduced.modes} modes; frame {body.frame}, inertia {body.inertia}"
             + ("; damped" if body.reduced.damping is not None else ""))
            for body in model.bodies.values()]
    return rows + [(body.name, "unbalance" if is_unbalance(body) else _plain(body),
                    f"{body.number('mass'):.6g}",
                    _named({place.node.name: place.node for place in body.attachments}.values()),
                    f"m r {np.linalg.norm(body.vector('mc')):.6g}" if is_unbalance(body) else "")
                   for body in model.rigid_bodies.values()]


def _nodes(model: Mechanism) -> list[tuple]:
    first: dict[DofBlock, str] = {}      # DOF block -> the node it is told of
    return [(node.name, vector(node.point),
             *(_state(first, node, dof_block) for dof_block in (node.position, node.rotation)),
             _rates(node)) for node in model.nodes.values()]


def _rates(node: Node) -> str:
    """Initial velocities that a user gave."""
    given = (("", node.position), ("rotation ", node.rotation))
    return ", ".join(f"{what}{vector(one.rate)}" for what, one in given
                     if one is not None and one.solved and (one.given or one.rate.any()))


def _state(first: dict[DofBlock, str], node: Node, dof_block: DofBlock | None) -> str:
    """Tell whether the coordinates of a node are unknowns, and why not."""
    if dof_block is None:
        return "none"
    owner = first.setdefault(dof_block, node.name)
    if owner != node.name:
        return f"that of {owner}"
    return dof_block.state


def _joints(model: Mechanism) -> list[tuple]:
    nodes, rows = model.nodes, []
    for joint in model.joints:
        on = joint.constraints[0].path if joint.constraints else None
        to = joint.to.name if nodes.get(joint.to.name) is joint.to else "the ground"
        rows.append((joint.name, joint.kind, joint.node.name,
                     to if on is None else on.path.name,
                     str(joint.multipliers) if joint.multipliers else
                     "none: its nodes share coordinates or are fixed"))
        if on is not None and on.way is not None:
            rows += [(motion.name, "drive of the way", joint.name, on.path.name,
                      f"none: {motion.time_function.described()}") for motion in on.way.motions]
    return rows


def _paths(model: Mechanism) -> list[tuple]:
    grounds = set(map(id, model.grounds))
    return [(path.name, ", ".join("the ground" if id(piece.carrier) in grounds else
                                  piece.carrier.name for piece in path.pieces),
             f"{path.length:.6g}", str(sum(len(piece.ways) for piece in path.pieces)),
             ", ".join(dict.fromkeys(path.ends)))
            for path in model.paths.values()]


def _loads(model: Mechanism) -> list[tuple]:
    return [(load.name, _plain(load),
             _named({place.node.name: place.node for place in load.attachments}.values())
             or (load.mode[0] if load.mode else ""),
             load.series.described() if load.series is not None else
             load.time_function.described() if load.time_function and load.function is None else "")
            for load in model.loads if load.law is None]


def _plain(element: Element) -> str:
    return element.kind.removeprefix("planar_").replace("_", " ")


def _named(nodes: Iterable[Node]) -> str:
    return ", ".join(node.name for node in nodes)
