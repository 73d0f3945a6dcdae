"""Directions of shafts, and unbalances that turn with them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import chosen_name, direction, dof_block, known
from sebody.model.mechanism import Mechanism
from sebody.model.parts import TURNS, Element, Node, positions, rotations

BEARINGS = "bushing", "bearing"
PARALLEL = 1e-6     # one less the cosine of directions that are the same


def unbalance(model: Mechanism, node: Node | str, mass_times_radius: float, phase: float = 0.0,
              axis: ArrayLike | None = None, name: str | None = None) -> Element:
    """Unbalance at a node: the first moment of mass of what lies beside the axis.

    It is a body of which nothing but ``m r`` is left. Its force on the node is
    ``m r (w^2 e - w' n x e)``, n the axis and e the direction, both of which turn with the node, at
    a varying spin, too; with gravity its weight has the moment ``m r e x g``, and where the node is
    accelerated it pulls likewise.

    Parameters
    ----------
    node : Node or str
        A node on the axis, such as that of a disc.
    mass_times_radius : float
        m r [mass length].
    phase : float
        Angle of e at the start, about the axis, from the first direction across it in the order of
        space: from y of a shaft along x; in a plane from x [rad].
    axis : (3,), optional
        Direction n of the shaft at the start; by default that of the hinges and bearings that the
        model has so far, in the sense in which its largest component is positive. None in a plane.

    Returns
    -------
    Element
        One of the model's rigid bodies, without mass.

    Raises
    ------
    InputError
        A product that is not positive, no direction, or an axis in a plane.
    """
    node = known(model, node)
    for kind in ("position", "rotation"):
        dof_block(node, kind)
    what = f"unbalance at {node.name!r}"
    size = inputs.number(mass_times_radius, f"{what}: mass_times_radius", above=0)
    phase = inputs.number(phase, f"{what}: phase", remedy="give an angle in radians")
    across = _across(model, node, axis, what)
    arm = across @ (np.cos(phase), np.sin(phase))
    moments = ("zz",) if model.planar else ("xx", "yy", "zz", "xy", "yz", "xz")
    name = chosen_name(model, name, f"unbalance at {node.name}")
    made = Element(name, model.kind_of("rigid_body"), positions(node) + rotations(node),
                   {"mass": 0.0, "mc": size * arm, **{f"J_{one}": 0.0 for one in moments}})
    model.rigid_bodies[name] = made
    return made


def is_unbalance(body: Element) -> bool:
    """Tell an unbalance from rigid bodies that have mass."""
    return body.number("mass") == 0.0


def unbalances(model: Mechanism) -> list[Element]:
    """All unbalances of a model."""
    return [body for body in model.rigid_bodies.values() if is_unbalance(body)]


def shaft_axes(along: NDArray) -> NDArray:
    """Axes of a shaft as columns, the third along it: the others across in the order of space."""
    k = int(np.argmax(np.abs(along)))
    first = np.eye(3)[(k + 1) % 3]
    first = first - first @ along * along
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(along, first), along])


def shaft_direction(model: Mechanism, what: str) -> NDArray:
    """The one direction of all hinges, and of all bearings in which something turns freely.

    Raises
    ------
    InputError
        There is none, or there are several.
    """
    found = [joint.axis for joint in model.joints if joint.kind in TURNS]
    found += [axis for load in model.loads if load.kind in BEARINGS
              for axis in [_of_bearing(load)] if axis is not None]
    if not found:
        raise InputError(f"{what}: no hinge or bearing of the model tells the direction of the "
                         "shaft: give axis=, three numbers")
    first = found[0] / np.linalg.norm(found[0])
    if any(abs(first @ one) < (1.0 - PARALLEL) * np.linalg.norm(one) for one in found):
        raise InputError(f"{what}: hinges and bearings of the model have several directions: give "
                         "axis=, three numbers")
    return first * np.sign(first[np.argmax(np.abs(first))])


def _of_bearing(bearing: Element) -> NDArray | None:
    """The axis about which a bearing lets turn freely; none of one that does not tell.

    Where it resists no tilts, the axis along which it resists nothing, if there is one.
    """
    if np.any(bearing.vector("n")):
        return bearing.vector("n")
    turns, ways = (np.add(*(bearing.vector(name) != 0.0 for name in names))
                   for names in (("kt", "ct"), ("k", "c")))
    free = np.flatnonzero(~ways)
    return None if turns.any() or len(free) != 1 else bearing.vector(f"e{free[0] + 1}")


def _across(model: Mechanism, node: Node, axis: ArrayLike | None, what: str) -> NDArray:
    """Two directions across the shaft, as columns."""
    if model.planar:
        if axis is not None:
            raise InputError(f"{what}: a model in a plane has no axis=, leave it out")
        return np.eye(2)
    along = (shaft_direction(model, what) if axis is None else
             direction(model, axis, "unbalance", node))
    return shaft_axes(along)[:, :2]
