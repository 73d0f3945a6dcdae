"""A rigid body in the place of a superelement."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model import bodies, loads
from sebody.model.arguments import dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Superelement
from sebody.model.variants.copying import Variant, copied, load_name, loads_on, placed
from sebody.model.variants.dependent import is_held, make_dependent, start_rate
from sebody.model.variants.moved_paths import refuse_paths
from sebody.model.variants.moved_points import on_rigid_body
from sebody.reduction.body import ReducedBody
from sebody.reduction.summary import place

_SAME = 1e-9    # relative difference of velocities and places that is rounding


def rigid(model: Mechanism, name: str) -> Variant:
    """The model with a rigid body in the place of a superelement.

    Mass, centre of mass and inertia are those of the reduced mass. One boundary node carries the
    body, the others hang on it by rigid links; it is the one whose position is fixed, prescribed or
    linked to such a one, if there is one. A link that closes a loop of rigid links, as the last one
    of a four-bar, has an end of its own that equations keep at the node. Forces on internal modes
    are left out, they do no work; loads on the body become their resultants on the carrying node.

    Parameters
    ----------
    name : str
        Of the superelement, and then of the rigid body.

    Returns
    -------
    Variant

    Raises
    ------
    InputError
        An unknown superelement, one without inertial coupling with the base that holds it,
        positions of two boundary nodes that are both fixed, no node with
        position and rotation, or initial velocities that are not those of a rigid body.
    """
    if placed(model, name).reduced.rests:
        raise InputError(f"superelement {name!r} is held to the ground without inertial coupling "
                         "with its base: its mass as a rigid body is unknown")
    refuse_paths(model, placed(model, name), "rigid")
    made = copied(model)
    body = made.bodies.pop(name)
    made.own_names.discard(name)
    carrier = _carrier(body)
    _check_rates(body, carrier)
    followers = [node for node in body.nodes if node is not carrier]
    closed = [node.name for node, keep in zip(body.nodes, body.reduced.keeps, strict=True)
              if node is not carrier and make_dependent(made, node, carrier, keep, name)]
    mass, inertia, centre = rigid_constants(body.reduced)
    offset = carrier.point - body.reduced.coordinates[body.nodes.index(carrier)]
    bodies.rigid_body(made, name, carrier, mass, inertia, centre + offset)
    left = _replace_loads(made, body, carrier)
    links = (f", with {', '.join(node.name for node in followers)} on rigid links"
             if followers else "")
    ending = f", held at {', '.join(closed)} by equations" if closed else ""
    ending += f"; {', '.join(left)} left out" if left else ""
    where = place(_shown(centre + offset, made.size()))
    return Variant(made, f"{name} is rigid: mass {mass:.4g}, centre of mass {where}, on node "
                         f"{carrier.name}{links}{ending}")


def _shown(point: NDArray, size: float) -> NDArray:
    """A point whose coordinates are zero where they are rounding."""
    return np.where(np.abs(point) < _SAME * size, 0.0, point)


def rigid_constants(body: ReducedBody) -> tuple[float, NDArray | float, NDArray]:
    """Mass, inertia about the centre of mass, and this centre in the body's axes."""
    turning = body.rigid_modes_about(body.centre_of_mass)[:, body.coordinates.shape[1]:]
    J = turning.T @ body.mass @ turning
    return body.total_mass, float(J[0, 0]) if body.planar else J, body.centre_of_mass


def _carrier(body: Superelement) -> Node:
    """The node that the others follow by rigid links."""
    what = f"superelement {body.name!r} cannot be made rigid"
    own = list(zip(body.nodes, body.reduced.keeps, strict=True))
    held = {node.position: node for node, keep in own
            if keep != "rotation" and is_held(dof_block(node, "position"))}.values()
    still = [node for node in held if dof_block(node, "position").fixed]
    if len(still) > 1:
        raise InputError(f"{what}: the positions of {still[0].name} and {still[1].name} are both "
                         "fixed or prescribed; hold one of them by a joint with explicit=True")
    still = still or list(held)
    full = [node for node, keep in own
            if keep == "full" and (not still or any(node.position is n.position for n in still))]
    if not full:
        raise InputError(f"{what}: it does not keep both position and rotation at "
                         + (f"{still[0].name}, which is held" if still else "any node")
                         + "; reduce it with 'full' there")
    return full[0]


def _check_rates(body: Superelement, carrier: Node) -> None:
    """Refuse initial velocities that the carrier and a rigid motion do not give."""
    linear, angular = (start_rate(dof_block(carrier, kind)) for kind in ("position", "rotation"))
    for node, keep in zip(body.nodes, body.reduced.keeps, strict=True):
        arm = node.point - carrier.point
        spin = (angular[0] * np.array([-arm[1], arm[0]]) if body.reduced.planar else
                np.cross(angular, arm))
        for kind, rate, other in (("position", linear + spin, "rotation"),
                                  ("rotation", angular, "translation")):
            block = getattr(node, kind)
            if keep != other and block.given and np.abs(block.rate - rate).max() > (
                    _SAME * np.abs([*block.rate, *rate]).max()):
                raise InputError(
                    f"superelement {body.name!r} cannot be made rigid: the initial velocity of "
                    f"{block.name} is not that of a rigid motion with {carrier.name}; give that of "
                    f"{carrier.name}, or use model.rigid_velocity")


def _replace_loads(model: Mechanism, body: Superelement, carrier: Node) -> list[str]:
    """Put resultants in the place of loads on the body; names of what does no work."""
    own, before = loads_on(model, body), model.loads
    model.loads = []
    for load in before:
        if load not in own:
            model.loads.append(load)
        elif load.body is body:
            _add_resultant(model, load, carrier)
        elif load.point is not None:
            model.loads.append(on_rigid_body(model, load, carrier))
    return [load.name for load in own if load.mode is not None]


def _add_resultant(model: Mechanism, load: Element, carrier: Node) -> None:
    """Force and moment of a load on its body, which turn with the carrying node."""
    assert load.body is not None
    body, size = load.body.reduced, model.dimension
    at = body.coordinates[load.body.nodes.index(carrier)]
    total = body.rigid_modes_about(at).T @ body.loads[load_name(load)]
    model.own_names.discard(load.name)
    loads.force(model, carrier, total[:size], load.time_function, follower=True, name=load.name)
    loads.torque(model, carrier, total[size:], load.time_function, follower=True,
                 name=f"{load.name} (moment)")
