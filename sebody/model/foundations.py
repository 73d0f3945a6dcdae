"""Foundations: bodies that are held to the ground, with the node of their base."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import known
from sebody.model.bodies import superelement
from sebody.model.joints import fix
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import node as make_node
from sebody.model.parts import Node, Superelement
from sebody.reduction.body import ReducedBody


def foundation(model: Mechanism, name: str, body: ReducedBody, nodes: Iterable[Node | str] | Node |
               str, base: Node | str | None = None, rotation: ArrayLike | None = None
               ) -> Superelement:
    """Place a body that is held to the ground on nodes, and fix its base.

    The frame of the body is on its base and stands still: local coordinates are displacements and
    rotation vectors of the interfaces, on which mass, damping and stiffness act linearly.

    Parameters
    ----------
    body : ReducedBody
        Of `grounded_body`, or of a file that holds one, such as `read_extptfm` reads.
    nodes : iterable of Node or str
        One node for each interface, in its order; the base is not among them.
    base : Node or str, optional
        Node of the base; by default one is made, ``NAME.base``. A base that is not to be fixed, as
        of a machine bed on a vehicle, is placed by `superelement` and welded to its carrier.
    rotation : (3, 3), planar (2, 2), optional
        Rotates vectors from the body's axes to global axes; identity by default.

    Raises
    ------
    InputError
        A body that is not held to the ground, or nodes that do not fit its interfaces.
    """
    inputs.name(name, "name of a foundation")
    body = inputs.instance(body, f"body of foundation {name!r}", ReducedBody,
                           "give a ReducedBody, such as grounded_body returns")
    if body.base is None:
        raise InputError(f"foundation {name!r}: its body is not held to the ground: use "
                         "grounded_body, or place a free body by superelement and fix its nodes")
    given = [nodes] if isinstance(nodes, str | Node) else inputs.items(
        nodes, f"nodes of foundation {name!r}", "give a list of nodes")
    own = [known(model, one) for one in given]
    count = len(body.keeps) - 1
    if len(own) != count:
        raise InputError(f"foundation {name!r} has {count} interface{'s' * (count > 1)} and "
                         f"{len(own)} node{'s' * (len(own) != 1)} "
                         f"{'were' if len(own) != 1 else 'was'} given: give one for each")
    placed = body if rotation is None else body.rotated(rotation)
    if base is None:
        assert placed.base is not None
        interfaces = np.delete(placed.coordinates, placed.base, axis=0)
        shift = np.mean([one.point for one in own], axis=0) - interfaces.mean(axis=0)
        base = make_node(model, f"{name}.base", placed.coordinates[placed.base] + shift)
    base = known(model, base)
    own.insert(body.base, base)
    made = superelement(model, name, placed, own)
    fix(model, base)
    return made
