"""Formulas of motions: of nodes, modes and joints, and of what a run keeps."""

from sebody.basics.errors import InputError
from sebody.model.numbering import stretch
from sebody.model.parts import SLIDES, TURNS, DofBlock, Joint
from sebody.quantities.algebra import back, dot, minus, spun, times
from sebody.quantities.expressions import Number, angle
from sebody.quantities.numbers import Numbers, Parts

# names of displacements and rates by the kind of a joint; each is of the same kind as the others
OF_WAYS = ("angle", "displacement", "way"), ("rate", "speed")
OF_JOINTS = ((TURNS, ("angle", "rate")), (SLIDES, ("displacement", "speed")),
             (("path",), ("way", "rate")))


def joints(of: Parts) -> dict[str, Joint]:
    """Joints, and drives by equations."""
    return {joint.name: joint for joint in of.model.joints}


# nodes


def block(of: Parts, name: str, kind: str, quantity: str) -> DofBlock:
    """A DOF block of a node, which must be in the model."""
    found = getattr(of.model.nodes[name], kind)
    if found is None or found not in of.numbering.dof_blocks:
        raise InputError(f"node {name!r} has no {quantity}: the DOF block is not in the model")
    return found


def position(of: Numbers, name: str, part: str, quantity: str) -> list[Number]:
    """Position of a node, or a rate of it."""
    return of.coordinates(part, block(of, name, "position", quantity))


def rotation(of: Numbers, name: str) -> object:
    """Rotation matrix of a node; in a plane the angle."""
    own = block(of, name, "rotation", "rotation")
    return of.coordinates("q", own)[0] if of.model.planar else of.rotation(own)


def angular(of: Numbers, name: str, part: str, quantity: str) -> object:
    """Angular velocity or acceleration in global axes; both are recorded in material ones."""
    own = block(of, name, "rotation", quantity)
    values = of.coordinates(part, own)
    return values[0] if of.model.planar else times(of.rotation(own), values)


def reaction(of: Numbers, name: str, kind: str, quantity: str) -> object:
    """Force or moment of the support of a fixed or prescribed DOF block, in global axes."""
    own = block(of, name, kind, quantity)
    if not own.fixed:
        raise InputError(f"{own.name} is free: only fixed and prescribed nodes have a "
                         "reaction; the force of a joint is <joint>.force")
    first = of.numbering.dof_blocks[own]
    values = [of.total(first + k) for k in range(own.start.size)]
    if own not in of.numbering.rotations:
        return values[0] if own.rotational else values      # in a plane
    return times(of.rotation(own), values)


# modes, and what is kept from step to step


def modes(of: Numbers, name: str, part: str) -> list[Number]:
    """Amplitudes of the internal modes of a superelement, or their rates."""
    if name not in of.model.bodies:
        raise InputError(f"body {name!r} is rigid: it has forces, but no modes")
    first = of.numbering.modes[name]
    return [of.recorded(part, first + k) for k in range(of.model.bodies[name].reduced.modes)]


def kept(of: Numbers, name: str) -> Number:
    """Value that a sensor, a controller or Python gave last."""
    return of.recorded("frames", of.numbering.memory.values[name])


def states(of: Numbers, name: str) -> list[Number]:
    """States of a controller."""
    for load in of.model.loads:
        if load.law is not None and load.law.controller == name:
            own = stretch(of.numbering, load.law.states)
            return [of.recorded("v", k) for k in range(own.start, own.stop)]
    first = of.numbering.memory.states[name]
    return [of.recorded("frames", first + k)
            for k in range(of.model.controllers[name].states.size)]


# joints


def turned(of: Numbers, name: str) -> Number:
    """Angle of a joint's node against the other one, zero at the start; turns count."""
    joint = _of_kind(of, name, TURNS, "angle", "turn")
    if of.model.planar:
        a, b = (of.part("q", node, "rotation") for node in (joint.node, joint.to))
        return a[0] - b[0]
    own, other = (of.rotation(node.rotation) for node in (joint.node, joint.to))
    _, n, m = joint.own_axes.columns.T.tolist()
    seen = back(other, times(own, n))
    return angle(dot(seen, m), dot(seen, n))


def turning(of: Numbers, name: str) -> Number:
    """Rate of this angle."""
    joint = _of_kind(of, name, TURNS, "rate", "turn")
    a, b = (of.part("v", node, "rotation") for node in (joint.node, joint.to))
    if of.model.planar:
        return a[0] - b[0]
    axis = joint.axis.tolist()
    own, other = (of.rotation(node.rotation) for node in (joint.node, joint.to))
    return dot(a, axis) - dot(times(own, axis), times(other, b))


def displacement(of: Numbers, name: str) -> Number:
    """Displacement of a joint's node along its axis from the other one, from the start."""
    joint = _of_kind(of, name, SLIDES, "displacement", "slide")
    carrier, other, direction = joint.way
    along = times(of.rotation(carrier.rotation), direction.tolist())
    gap = minus(*(of.part("q", node, "position") for node in (other, carrier)))
    return dot(along, gap) - joint.way.start


def speed(of: Numbers, name: str) -> Number:
    """Rate of this displacement."""
    joint = _of_kind(of, name, SLIDES, "speed", "slide")
    carrier, other, direction = joint.way
    R, own = of.rotation(carrier.rotation), direction.tolist()
    gap, gap_rate = (minus(*(of.part(part, node, "position") for node in (other, carrier)))
                     for part in "qv")
    turned_with = spun(of.part("v", carrier, "rotation"), own)
    return dot(times(R, own), gap_rate) + dot(times(R, turned_with), gap)


def _of_kind(of: Numbers, name: str, kinds: tuple[str, ...], what: str, does: str) -> Joint:
    joint = joints(of)[name]
    if joint.kind not in kinds:
        own = [other for of_kind, names in OF_JOINTS if joint.kind in of_kind
               for other, same in zip(names, OF_WAYS, strict=True) if what in same]
        raise InputError(f"joint {name!r} is a {joint.kind}, which does not {does} about or along "
                         f"one axis and has no {what}; " + (
                             f"ask for {name}.{own[0]}" if own else
                             f"that is what {', '.join(kinds)} joints do"))
    return joint
