"""Another number of superelements in a beam."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.beams import beam
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Beam, DofBlock, Node
from sebody.model.variants.copying import Variant, checked, copied, loads_on
from sebody.model.variants.moved_paths import paths_on


def divide(model: Mechanism, name: str, bodies: int, elements: int | None = None,
           **options: Any) -> Variant:
    """The model with a beam of another number of superelements.

    Parameters
    ----------
    name : str
        Of a beam that `Model.beam` has built.
    bodies : int
        Superelements from end to end.
    elements : int, optional
        Finite elements from end to end; as before by default.
    **options
        Arguments of `Model.beam` that are to be others than before, such as ``modes``.

    Returns
    -------
    Variant

    Raises
    ------
    InputError
        No such beam, one whose bodies were changed since or bear loads of their own, a node
        between its ends that something else needs, or elements that cannot be divided so.
    """
    _described(model, name)
    made = copied(model)
    old = _described(made, name)
    between = old.nodes[1:-1]
    nodes, placed = list(made.nodes), list(made.bodies)
    for node in between:
        del made.nodes[node.name]
    for part in old.parts:
        del made.bodies[part.name]
        made.own_names.discard(part.name)
    made.beams.remove(old)
    made.connections = [one for one in made.connections
                        if not any(one.node is node for node in between)]
    elements = old.elements if elements is None else elements
    divided = beam(made, name, (old.nodes[0], old.nodes[-1]), old.section, elements, bodies,
                   **{**old.options, **options})
    new = made.beams[-1]
    _start_like(new, old)
    ends = max(nodes.index(old.nodes[k].name) for k in (0, -1))
    made.nodes = _in_place(made.nodes, nodes, [n.name for n in divided[1:-1]],
                           nodes.index(between[0].name) if between else ends + 1)
    made.bodies = _in_place(made.bodies, placed, [p.name for p in new.parts],
                            placed.index(old.parts[0].name))
    others = [f"{key}={value!r}" for key, value in options.items()
              if value != old.options.get(key)]
    ending = f", with {', '.join(others)}" if others else ""
    return Variant(made, f"{name} has {_counted(new)} instead of {_counted(old)}{ending}")


def _counted(one: Beam) -> str:
    bodies = len(one.parts)
    each = one.elements // bodies
    return (f"{bodies} superelement{'s' * (bodies > 1)} of {each} finite "
            f"element{'s' * (each > 1)}")


def _described(model: Mechanism, name: str) -> Beam:
    """A beam as it was built; refused if it cannot be built anew."""
    inputs.name(name, "name of a beam")
    beams = [one for one in checked(model).beams if one.name == name]
    if len(beams) != 1:
        names = ", ".join(dict.fromkeys(one.name for one in model.beams)) or "no beam"
        raise InputError(f"model.beam has built {len(beams)} beams {name!r}, where one is expected "
                         f"(it has built {names}): divide other bodies by building the model anew, "
                         "with a body for each part")
    beam = beams[0]
    what = f"beam {name!r} cannot be divided anew: "
    for part, body in zip(beam.parts, beam.bodies, strict=True):
        if model.bodies.get(part.name) is not part or part.reduced is not body:
            raise InputError(f"{what}superelement {part.name!r} was changed; divide the beam first")
        if np.any(part.mode_rates):
            raise InputError(f"{what}modes of {part.name!r} have initial velocities")
        for path in paths_on(model, part):
            raise InputError(f"{what}path {path.name!r} goes along superelement {part.name!r}; "
                             "build the model anew with a beam of other parts")
        for load in loads_on(model, part):
            raise InputError(f"{what}{load.name!r} acts on superelement {part.name!r}; apply it to "
                             "nodes")
    used = _used(model, beam)
    for node in beam.nodes[1:-1]:
        if used & {node, node.position, node.rotation} or any(
                t is not None and (t.fixed or t.given) for t in (node.position, node.rotation)):
            raise InputError(f"{what}something else acts on or holds its node {node.name!r}; build "
                             "two beams that meet there")
    return beam


def _used(model: Mechanism, own: Beam) -> set[Node | DofBlock | None]:
    """Nodes and DOF blocks that anything but a beam needs."""
    used: set[Node | DofBlock | None] = set()
    for element in (*model.constraints, *model.loads, *model.rigid_bodies.values()):
        used |= {place.node for place in element.attachments}
    for joint in model.joints:
        used |= {joint.node, joint.to}
    for body in model.bodies.values():
        if body not in own.parts:
            used |= {node for node in body.nodes}
    for one in model.connections:
        used |= {one.node, one.to}
    for dof_block in model.dof_blocks():
        if dof_block.root is not None:
            used |= {parent for parent in dof_block.parents()}
    for node in (*model.nodes.values(), *model.grounds):
        if node not in own.nodes:
            used |= {t for t in (node.position, node.rotation) if t is not None}
    return used


def _start_like(new: Beam, old: Beam) -> None:
    """Start new nodes with the initial velocities there, linear between the nodes before."""
    for node, place in zip(new.nodes[1:-1], new.places[1:-1], strict=True):
        first = int(np.searchsorted(old.places, place, side="right")) - 1
        low, high = old.places[first:first + 2]
        for kind in ("position", "rotation"):
            ends: list[DofBlock] = [getattr(old.nodes[first + i], kind) for i in (0, 1)]
            getattr(node, kind).rate = _between(ends[0].rate, ends[1].rate,
                                                (place - low) / (high - low))


def _between(first: NDArray, last: NDArray, part: float) -> NDArray:
    return (1 - part) * first + part * last


def _in_place(found: dict, order: list[str], new: list[str], at: int) -> dict:
    """Entries in the order of before, the new ones together at a place of this order."""
    names = dict.fromkeys((*order[:at], *new, *order[at:]))
    return {name: found[name] for name in names if name in found}
