"""Formulas of points on paths: the way, and the force of the path."""

from sebody.model.parts import Element, Joint, OnPath, PathPiece
from sebody.quantities.algebra import dot, minus, scaled, total
from sebody.quantities.balance import balance
from sebody.quantities.expressions import Number, root
from sebody.quantities.numbers import Numbers, Parts


def sliding(of: Parts) -> dict[str, Joint]:
    """Joints whose node stays on a path, by name."""
    return {joint.name: joint for joint in of.model.joints
            if any(one.path is not None for one in joint.constraints)}


def way(of: Numbers, name: str, part: str) -> Number:
    """The way of a node along its path, from the beginning of the path; or the rate of this."""
    own = _on(sliding(of)[name]).way
    assert own is not None
    return of.coordinates(part, own)[0]


def thrust(of: Numbers, name: str) -> Number:
    """Force that pushes a node along its path, from outside: times the rate of the way a power.

    It is that of a drive, a spring or friction along the path, and zero where nothing acts there.
    """
    joint = sliding(of)[name]
    return total(of.force(of.numbering.forces_at[one] + one.firsts[-1])
                 for one in joint.constraints)


def normal_force(of: Numbers, name: str) -> Number:
    """Size of the force on the node, without the part along the path."""
    joint = sliding(of)[name]
    force = balance(of).of_joint(joint, "position")
    along = balance(of).axes(joint)
    tangent = [row[0] for row in along]
    across = minus(force, scaled(dot(force, tangent), tangent))
    return root(dot(across, across))


def power(of: Numbers, name: str) -> Number:
    """Power of the joint on all that it acts on: zero but for what a step leaves of its equations.

    What a drive or spring along the path does is its own power.
    """
    found: list[Number] = []
    for one in sliding(of)[name].constraints:
        first = of.numbering.forces_at[one]
        for place, at in zip(one.attachments, one.firsts, strict=True):
            rates = of.coordinates("v", place.dof_block)
            found += [-1.0 * of.force(first + at + k) * x for k, x in enumerate(rates)]
        places, modes = one.carried
        begin = one.firsts[places] - modes
        found += [-1.0 * of.force(first + begin + k) * of.recorded(
            "v", of.numbering.modes[_piece(one).carrier.name] + k) for k in range(modes)]
    return total(found)


def _on(joint: Joint) -> OnPath:
    path = joint.constraints[0].path
    assert path is not None
    return path


def _piece(one: Element) -> PathPiece:
    assert one.path is not None
    return one.path.here
