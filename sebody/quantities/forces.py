"""Formulas of forces, moments and powers of bodies, joints, drives and loads."""

from sebody.basics.errors import InputError
from sebody.model.parts import COUPLING, Element, Joint, Motion, Node, Superelement
from sebody.quantities.algebra import back, dot, scaled
from sebody.quantities.balance import balance
from sebody.quantities.expressions import Number
from sebody.quantities.motion import joints
from sebody.quantities.numbers import Numbers, Parts


def bodies(of: Parts) -> dict[str, Superelement | Element]:
    """Superelements and rigid bodies by name."""
    return of.model.bodies | of.model.rigid_bodies


def nodes_of_bodies(of: Parts) -> dict[str, tuple[str, Node]]:
    """Body and node by ``<body>.<node>``."""
    return {f"{name}.{place.node.name}": (name, place.node)
            for name, body in bodies(of).items() for place in body.attachments}


def drives(of: Parts) -> dict[str, Joint | Motion]:
    """Drives by equations, and prescribed motions."""
    by_name: dict[str, Joint | Motion] = {name: joint for name, joint in joints(of).items()
                                          if joint.time_function is not None}
    return by_name | {motion.name: motion for dof_block in of.model.dof_blocks()
                      for motion in dof_block.motions}


def loads(of: Parts) -> dict[str, Element]:
    """Loads, springs and dampers on nodes, not on the ways of points along paths."""
    return {load.name: load for load in of.model.loads
            if load.attachments and load.law is None and load.path is None
            and load.attachments[0].node.point.size}


def of_body(of: Numbers, name: str) -> list[Number]:
    """Forces of everything else on a body: of its places, then on its modes."""
    body = bodies(of)[name]
    first = of.numbering.forces_at[body]
    modes = body.reduced.modes if isinstance(body, Superelement) else 0
    size = sum(t.start.size for t in (getattr(*place) for place in body.attachments))
    on_places = [-x for place in body.attachments for x in balance(of).on(body, *place)]
    return on_places + [of.force(first + size + k) for k in range(modes)]


def at_node(of: Numbers, name: str, kind: str) -> object:
    """Force or moment of everything else on a body at one of its nodes."""
    body, node = nodes_of_bodies(of)[name]
    return _flat(of, kind, scaled(-1.0, balance(of).on(bodies(of)[body], node, kind)))


def of_joint(of: Numbers, name: str, kind: str) -> object:
    """Force or moment of a joint on its node, in global axes."""
    return _flat(of, kind, balance(of).of_joint(joints(of)[name], kind))


def in_joint_axes(of: Numbers, name: str, kind: str) -> object:
    """The same in the axes of the joint."""
    joint = joints(of)[name]
    values = balance(of).of_joint(joint, kind)
    if len(values) == 1:
        return values[0]
    return back(balance(of).axes(joint), values)


def of_load(of: Numbers, name: str, kind: str) -> object:
    """Force or moment of a load or spring on its node, the first if it has several.

    Of what acts in a joint that on `node` of the joint.
    """
    load = loads(of)[name]
    if load.point is not None:          # minus that on the node of the surface; it has no moment
        node, factor = load.attachments[-1].node, -1.0 * (kind == "position")
    else:
        node, factor = _first(of, load), 1.0
    return _flat(of, kind, scaled(factor, balance(of).on(load, node, kind)))


def effort(of: Numbers, name: str, what: str) -> Number:
    """Thrust or torque of a drive along or about its axis: times the rate it is the power."""
    drive = drives(of)[name]
    kind = "rotation" if what == "torque" else "position"
    if kind != driven(drive):
        other = "thrust" if what == "torque" else "torque"
        raise InputError(f"drive {name!r} moves a {driven(drive)}: ask for {name}.{other}")
    if isinstance(drive, Joint):
        values = balance(of).of_joint(drive, kind)
        if kind == "rotation" and of.model.planar:
            return values[0]
        along = dot(values, [row[0] for row in balance(of).axes(drive)])
        return _onwards(drive) * along if kind == "position" else along
    dof_block = getattr(*drive.place)
    first = of.numbering.dof_blocks[dof_block]
    return dot([of.total(first + k) for k in range(dof_block.start.size)],
               drive.direction.tolist())


def couplings(of: Parts) -> dict[str, Joint]:
    """Couplings of joints without elasticity, by name."""
    return {name: joint for name, joint in joints(of).items() if joint.kind == COUPLING}


def coupled(coupling: Joint) -> str:
    """Kind of the first coordinate of a coupling: position or rotation."""
    return coupling.constraints[0].attachments[0].kind


def on_first(of: Numbers, name: str, what: str) -> Number:
    """Thrust or torque on the first coordinate of a coupling: times its rate it is the power.

    Its equation has this coordinate with the factor 1.
    """
    kind = "rotation" if what == "torque" else "position"
    coupling = couplings(of)[name]
    if kind != coupled(coupling):
        other = "thrust" if what == "torque" else "torque"
        raise InputError(f"coupling {name!r} is of a {coupled(coupling)}: ask for {name}.{other}")
    return -of.multiplier(of.numbering.multipliers[coupling.constraints[0]])


def _first(of: Parts, load: Element) -> Node:
    """The node whose force and moment are those of a load: the first, in a joint its `node`.

    Along a way the node with the axis comes first, which of a slider is the other one.
    """
    first, *others = (place.node for place in load.attachments)
    if "slide" in load.kind and any(one.kind == "slider" and one.to is first
                                    and one.node is others[0] for one in of.model.joints):
        return others[0]
    return first


def _onwards(drive: Joint) -> float:
    """Sign of the force along the axis, on the drive's node, that moves its way onwards.

    Its equation gives the way of its second node along a direction. (Of results that older versions
    have saved it is the way of the other node.)
    """
    one = drive.constraints[0]
    sign = 1.0 if one.vector("e") @ drive.axis > 0.0 else -1.0
    return sign if one.attachments[1].node is drive.node else -sign


def multipliers(of: Numbers, name: str) -> list[Number]:
    """Multipliers of the equations of a joint."""
    equations = joints(of)[name].constraints
    if not equations:
        raise InputError(f"joint {name!r} has no equations and so no multipliers, since its nodes "
                         "share coordinates or are fixed; the force on a fixed node is its "
                         f"reaction, the force of the joint is {name}.force")
    return [of.multiplier(of.numbering.multipliers[c] + k)
            for c in equations for k in range(c.multipliers)]


def work(of: Numbers, name: str) -> Number:
    """Work of a power port."""
    return of.recorded("works", of.numbering.port_names.index(name))


def power(of: Numbers, name: str) -> Number:
    """Power of a power port."""
    return of.power(of.numbering.port_names.index(name))


def driven(drive: Joint | Motion) -> str:
    """Kind of DOF block that a drive moves: position or rotation."""
    if isinstance(drive, Motion):
        return drive.place.kind
    return drive.constraints[0].attachments[0].kind


def _flat(of: Numbers, kind: str, values: list[Number]) -> object:
    """Moments in a plane are numbers."""
    return values[0] if of.model.planar and kind == "rotation" else values
