"""DOF blocks that no joint or load needs, left to follow the others of their body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block, known
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Node, Superelement
from sebody.model.variants.copying import (
    Variant,
    checked,
    copied,
    exchange,
    fewer,
    loads_on,
    placed,
)
from sebody.reduction.body import ReducedBody
from sebody.reduction.condensation import Released, coordinates_of, released

_KINDS = ("position", "rotation")
_SAME = 1e-12           # relative: velocities that are rounding


def drop_triplet(model: Mechanism, name: str, node: Node | str,
                   what: str = "rotation") -> Variant:
    """The model without a position or rotation that a superelement alone has and nothing needs.

    It follows the other boundary coordinates of the body statically; what it moves beyond that
    joins the internal modes, of which as many are kept as before. The frame of the body is that of
    the nodes that are left. Results have no quantities of what is dropped. The body takes the
    kernel of its new layout: where that is the general one it may take longer than before.

    Parameters
    ----------
    name : str
        Of the superelement.
    node : Node or str
        One of its nodes.
    what : {'position', 'rotation'}

    Returns
    -------
    Variant

    Raises
    ------
    InputError
        An unknown superelement or node, a block that something else needs, or a body whose frame
        needs it.
    """
    body, node = placed(model, name), known(model, node)
    inputs.choice(what, "what is dropped", _KINDS)
    own = dof_block(node, what)
    _check_unused(model, body, node, what, own)
    place = body.nodes.index(node)
    made = copied(model)
    old = made.bodies[name]
    try:
        condensed = released(old.reduced, place, what)
    except InputError as error:
        raise InputError(f"superelement {name!r} needs {own.name}: {error}") from error
    nodes = tuple(n for n in old.nodes if n.name != node.name or old.reduced.keeps[place] == "full")
    rates = _rates(old, condensed)
    setattr(made.nodes[node.name], what, None)
    new = exchange(made, old, condensed.body, old.frame, old.inertia, old.stiffening, nodes)
    new.mode_rates = rates
    if all(getattr(made.nodes[node.name], kind) is None for kind in _KINDS):
        del made.nodes[node.name]
    before, after = (_first_frequency(one) for one in (old.reduced, condensed.body))
    ending = ("; stresses that it carried no longer stiffen the body"
              if what == "position" and _stiffens(body, node.name) else "")
    return Variant(made, f"{name} keeps no {what} at {node.name}: {fewer(model, made)}; its "
                         f"first frequency while free is {after:.6g} instead of {before:.6g}"
                         f"{ending}")


def can_be_dropped(model: Mechanism) -> list[tuple[str, str, str]]:
    """Superelement, node and kind of blocks that `drop_triplet` can drop, one after the other.

    Of those of which one must stay, such as the last rotation of a body, the first are listed;
    rotations come first. Positions whose stresses stiffen their body stay.
    """
    candidates = []
    checked(model)
    for what in reversed(_KINDS):
        for body, node in [(one.name, node.name) for one in model.bodies.values()
                           for node in one.nodes]:
            try:
                if what == "position" and _stiffens(model.bodies[body], node):
                    continue
                model = drop_triplet(model, body, node, what).model
            except InputError:
                continue
            candidates.append((body, node, what))
    return candidates


def _check_unused(model: Mechanism, body: Superelement, node: Node, what: str,
                  own: DofBlock) -> None:
    """Refuse a DOF block that anything but the body needs."""
    kept = body.positions if what == "position" else body.rotations
    if not any(t is own for t in kept):
        raise InputError(f"superelement {body.name!r} does not keep {own.name}")
    if not own.solved:
        raise InputError(f"{own.name} is fixed, prescribed or follows another node: it is no "
                         "unknown that could be dropped")
    needed = f"cannot be dropped: {own.name} is needed by"
    for other in model.bodies.values():
        if other is not body and any(t is own for t in (*other.positions, *other.rotations)):
            raise InputError(f"{needed} superelement {other.name!r}")
    acting = loads_on(model, body)
    for element in (*model.rigid_bodies.values(), *model.constraints, *model.loads):
        if element not in acting and any(t is own for t in element.dof_blocks):
            raise InputError(f"{needed} {element.name!r}")
    for one in model.nodes.values():
        if one is not node and getattr(one, what) is own:
            raise InputError(f"{needed} node {one.name!r}, which shares it")
    for block in model.dof_blocks():
        if block.root is not None and any(t is own for t in block.parents()):
            raise InputError(f"{needed} {block.name}, which follows it by a rigid link")
    for load in acting:
        if load.mode is not None:
            raise InputError(f"{load.name!r} acts on a mode of superelement {body.name!r}, whose "
                             f"modes change if {own.name} is dropped")


def _rates(old: Superelement, found: Released) -> NDArray:
    """Initial velocities of the new modes: of what does not follow the new boundary statically."""
    rates = np.concatenate([*(t.rate for t in (*old.positions, *old.rotations)), old.mode_rates])
    held = len(found.bound)
    left = rates - found.basis[:, :held] @ rates[found.bound]
    modes = found.basis[:, held:].T @ old.reduced.mass @ left
    momentum = np.sqrt(rates @ old.reduced.mass @ rates)       # of modes of unit mass
    return np.where(np.abs(modes) > _SAME * momentum, modes, 0.0)


def _stiffens(body: Superelement, node: str) -> bool:
    """Tell whether motions of a position make resultants, stresses that stiffen the body."""
    place = [one.name for one in body.nodes].index(node)
    invariants = body.invariants
    return body.stiffening and invariants is not None and bool(
        invariants.E[coordinates_of(body.reduced, place, "position")].any())


def _first_frequency(body: ReducedBody) -> float:
    """Lowest frequency of the free body, in cycles per unit of time."""
    diagonal = np.diag(body.stiffness)
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, diagonal.max()))
    K, M = (scale[:, None] * one * scale for one in (body.stiffness, body.mass))
    middle = body.coordinates.mean(axis=0)
    vibrations = null_space((M @ (body.rigid_modes_about(middle) / scale[:, None])).T)
    squares = eigh(vibrations.T @ M @ vibrations, vibrations.T @ K @ vibrations, eigvals_only=True)
    return float(1 / (2 * np.pi * np.sqrt(squares[-1])))
