"""The order in which bodies are numbered, and what multipliers wait for.

Multipliers follow unknowns they act on, so that no pivot is zero: as a rule all of them. In a
branch of a mechanism those of the body towards its end are enough. Take a body that only one joint
holds, or only one is left when the joints of its own branches are counted out: the equations of
this joint are independent on the body alone, and no other equation that is eliminated earlier acts
on its unknowns there. So the multipliers go with the body where the other one is a hub: those of
many joints on one hub do not wait for it, which would couple every one with every other. In a plain
chain they wait for both bodies: they are fewer than the rotations that they couple.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from sebody.assembly.fill_order import Coupling, order_of_least_fill
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Element, Joint


class Part(NamedTuple):
    """A body as the numbering sees it."""

    name: str
    parents: list[DofBlock]      # that it depends on, each once, those of rotations first
    modes: int


Owners = Mapping[DofBlock, list[int]]     # DOF block -> parts it belongs to


def parents(dof_blocks: Iterable[DofBlock]) -> list[DofBlock]:
    """The DOF blocks that positions and rotations of some DOF blocks depend on."""
    return [p for t in dof_blocks for p in t.parents()]


def elimination_order(model: Mechanism) -> tuple[list[Part], dict[Element, set[DofBlock]]]:
    """Bodies in the order of the elimination, and the DOF blocks that multipliers follow.

    Returns
    -------
    parts : list of Part
    awaited : dict
        Of every constraint the DOF blocks that are numbered before its multipliers.
    """
    parts = [_part(b.name, [*b.rotations, *b.positions], b.reduced.modes)
             for b in model.bodies.values()]
    parts += [_part(e.name, e.dof_blocks[::-1], 0) for e in model.rigid_bodies.values()]
    parts += [_part(e.name, [e.law.states], 0) for e in model.loads
              if e.law is not None and e.law.states in e.dof_blocks]
    parts += [_part(e.name, [e.hidden], 0) for e in model.loads if e.inert]
    owners: dict[DofBlock, list[int]] = {}
    for k, part in enumerate(parts):
        for dof_block in part.parents:
            owners.setdefault(dof_block, []).append(k)
    awaited = _awaited(model, parts, owners)
    if len(parts) < 3:
        return parts, awaited
    bodies = [{p: p.start.size for p in part.parents if p.solved} for part in parts]
    order = order_of_least_fill(bodies, _couplings(model, owners, awaited))
    return [parts[k] for k in order], awaited


def _part(name: str, dof_blocks: Iterable[DofBlock], modes: int) -> Part:
    return Part(name, list(dict.fromkeys(parents(dof_blocks))), modes)


def _couplings(model: Mechanism, owners: Owners,
               awaited: Mapping[Element, set[DofBlock]]) -> list[Coupling]:
    """Couplings of several bodies beside the DOF blocks they share."""
    couplings = []
    for element in (*model.constraints, *model.loads):
        keys = {p: None for p in parents(element.dof_blocks) if p.solved and p in owners}
        if len({k for key in keys for k in owners[key]}) > 1:
            # a DOF block without a body is refused by the numbering, which names it
            known = [key for key in awaited.get(element, ()) if key in owners]
            couplings.append(Coupling(keys, element.multipliers, known))
    return couplings


def _awaited(model: Mechanism, parts: list[Part], owners: Owners) -> dict[Element, set[DofBlock]]:
    """DOF blocks that the multipliers of each constraint follow."""
    ways = {c.way for c in model.constraints}       # which follow the multipliers
    ways |= {load.hidden for load in model.loads if not load.inert}
    awaited = {c: {p for p in parents(c.dof_blocks) if p.solved} - ways for c in model.constraints}
    for c in model.constraints:
        awaited[c.equations] |= awaited[c]
    joints = [joint for joint in model.joints if joint.constraints]
    of_joint = [{k for c in joint.constraints for key in awaited[c]
                 for k in owners.get(key, ())} for joint in joints]
    of_part: list[set[int]] = [set() for _ in parts]
    for number, bodies in enumerate(of_joint):
        for k in bodies:
            of_part[k].add(number)
    hubs = {k for k, held in enumerate(of_part) if len(held) > 2}
    ends = [k for k, held in enumerate(of_part) if len(held) == 1]
    while ends:
        end = ends.pop()
        number = next(iter(of_part[end]), None)     # none where the other end came first
        if number is None or len(of_joint[number]) != 2:
            continue
        side = _side(joints[number], end, owners)
        if side is not None:
            awaited |= side if hubs & of_joint[number] else {}
            for k in of_joint[number]:
                of_part[k].discard(number)
                if len(of_part[k]) == 1:
                    ends.append(k)
    return awaited


def _side(joint: Joint, part: int, owners: Owners) -> dict[Element, set[DofBlock]] | None:
    """The DOF blocks of every equation on one body; None unless all are free and of this one."""
    blocks = {}
    for constraint in joint.constraints:
        bodies = [p for p in parents(constraint.dof_blocks) if part in owners.get(p, ())]
        if not bodies or not all(p.solved and len(owners[p]) == 1 for p in bodies):
            return None
        blocks[constraint] = {p for p in bodies}
    return blocks
