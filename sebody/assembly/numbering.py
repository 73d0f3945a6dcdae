"""Numbers of coordinates, multipliers and power ports of a model."""

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.elimination_order import elimination_order, parents
from sebody.assembly.law_inputs import dependences
from sebody.assembly.memory_map import memory_map
from sebody.assembly.ports import number_ports, series_of
from sebody.basics.errors import InputError
from sebody.model.continuous import complete_law
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates
from sebody.model.parts import DofBlock, Element


def hidden_states(model: Mechanism, numbering: Numbering) -> dict[int, str]:
    """Coordinates whose velocities are states of continuous controllers, and names of these."""
    return {coordinate: f"{load.law.controller}.states.{k}"
            for load in model.loads
            if load.law is not None and load.law.states in numbering.dof_blocks
            for k, coordinate in enumerate(coordinates(numbering, load.law.states))}


def rotational(model: Mechanism, numbering: Numbering) -> NDArray:
    """Coordinates that belong to rotations, (total,) of bool."""
    flags = np.zeros(numbering.total, dtype=bool)
    for node in model.nodes.values():
        if node.rotation is not None and node.rotation in numbering.dof_blocks:
            flags[coordinates(numbering, node.rotation)] = True
    return flags


def placed(model: Mechanism, numbering: Numbering) -> NDArray:
    """Coordinates that belong to positions or rotations, (total,) of bool: no modes, multipliers.

    Ways along paths and lengths of ropes count as positions.
    """
    flags = np.zeros(numbering.total, dtype=bool)
    for way in model.ways():
        flags[coordinates(numbering, way)] = True
    for node in model.nodes.values():
        for dof_block in (node.position, node.rotation):
            if dof_block is not None and dof_block in numbering.dof_blocks:
                flags[coordinates(numbering, dof_block)] = True
    return flags


def number(model: Mechanism) -> Numbering:
    """Number the unknowns body by body; a DOF block that bodies share belongs to the last of them.

    Bodies are in the order of `elimination_order`. Of the blocks of a body, those that joints and
    springs couple to later bodies come last. Multipliers follow unknowns they act on. An
    elimination in this order meets no zero pivot and fills in little.

    Raises
    ------
    InputError
        A DOF block that belongs to no body and is not fixed.
    """
    laws = _complete_laws(model)
    parts, awaited = elimination_order(model)
    last = {p: k for k, part in enumerate(parts) for p in part.parents}
    coupled = _coupled(model, last)
    order, modes, groups = _Order(model, awaited), {}, []
    for k, part in enumerate(parts):
        groups.append(len(order.names))
        if part.name in model.bodies:
            modes[part.name] = len(order.names)
        order.names.extend(f"mode {mode} of {part.name}" for mode in range(part.modes))
        own = [p for p in part.parents if p.solved and last[p] == k]
        for dof_block in sorted(own, key=lambda p: coupled[p]):
            order.place(dof_block)
            order.place_multipliers(dof_block)
    _refuse_loose(model, last)
    _refuse_idle_drives(model)
    free, used = len(order.names), _used(model)
    for dof_block in used:
        if dof_block not in order.at and dof_block.root is None:
            order.place(dof_block, " (fixed)")
    dependent = [t for t in used if t.root is not None]
    for dof_block in dependent:
        order.place(dof_block)
    matrices = [] if model.planar else [t for t in used if t.rotational]
    rotations = {t: k for k, t in enumerate(matrices)}
    ports = number_ports(model, order.at)
    return Numbering(free, len(order.names), order.at, rotations, modes, order.multipliers,
                     order.names, dependent, ports.of, ports.names, ports.time_functions,
                     ports.prescribed, np.array(groups), jumps=ports.jumps, forced=ports.forced,
                     gravity=ports.gravity,
                     series=series_of(model, len(ports.names)),
                     memory_map=memory_map(model, ports.of, laws),
                     reads=_reads(model, order.multipliers))


def _complete_laws(model: Mechanism) -> dict[Element, int]:
    """Let laws of controllers act on what they read, too; how many angles each of them keeps."""
    found = dependences(model, [load for load in model.loads if load.law is not None])
    for law, depends in found.items():
        assert law.law is not None
        complete_law(model, law, model.controllers[law.law.controller], depends.places,
                     depends.modes)
    return {law: depends.angles for law, depends in found.items()}


class _Order:
    """Coordinates in the order of their numbers."""

    def __init__(self, model: Mechanism, awaited: dict[Element, set[DofBlock]]) -> None:
        self.names: list[str] = []
        self.at: dict[DofBlock, int] = {}            # DOF block -> first coordinate
        self.multipliers: dict[Element, int] = {}   # constraint -> first multiplier
        self._awaited = awaited
        self._constraints: dict[DofBlock, list[Element]] = defaultdict(list)     # on each DOF block
        self._ways = {c: c.way for c in model.constraints
                      if c.way is not None and c.shares is None and c.way.solved}
        self._rubbing = {load.hidden: load for load in model.loads
                         if load.hidden is not None and not load.inert}
        self._sharing = [c for c in model.constraints if c.shares is not None]
        for constraint in model.constraints:
            if constraint.shares is not None:
                continue
            for key in awaited[constraint]:
                self._constraints[key].append(constraint)
            if not awaited[constraint]:
                self._place(constraint)

    def place(self, dof_block: DofBlock, remark: str = "") -> None:
        """Number the coordinates of a DOF block."""
        self.at[dof_block] = len(self.names)
        self.names.extend(f"{dof_block.name}[{k}]{remark}" for k in range(dof_block.start.size))

    def place_multipliers(self, dof_block: DofBlock) -> None:
        """Number the multipliers of constraints for which this block was the last to wait for."""
        for constraint in self._constraints[dof_block]:
            if self._awaited[constraint] <= self.at.keys():
                self._place(constraint)

    def _place(self, constraint: Element) -> None:
        way = self._ways.get(constraint)
        if way is not None and not any(_moves(constraint, p) for p in self._awaited[constraint]):
            self.place(way)
        self.multipliers[constraint] = len(self.names)
        self.names.extend(f"multiplier {j} of {constraint.name}"
                          for j in range(constraint.multipliers))
        for one in self._sharing:
            if one.shares is constraint:
                self.multipliers[one] = self.multipliers[constraint]
        if way and way not in self.at and all(      # behind all of them: no mass for a pivot
                c in self.multipliers for c, one in self._ways.items() if one is way):
            self.place(way)
        for block in [one for one, load in self._rubbing.items()
                      if set(load.read) <= self.multipliers.keys()]:
            del self._rubbing[block]
            self.place(block)


def _moves(constraint: Element, dof_block: DofBlock) -> bool:
    """Tell whether an equation sees what moves; turns of sheaves change no length of a rope."""
    return not (dof_block.rotational and constraint.kind.endswith("rope"))


def _reads(model: Mechanism, multipliers: dict[Element, int]) -> dict[Element, list[int]]:
    """Multipliers of the joint whose reaction presses an element."""
    return {load: [multipliers[c] + k for c in load.read for k in range(c.multipliers)]
            for load in model.loads if load.pressed_by is not None}


def _coupled(model: Mechanism, last: dict[DofBlock, int]) -> dict[DofBlock, int]:
    """Last body that each DOF block belongs to or is coupled to by a joint or spring."""
    last_bodies = dict(last)
    for element in (*model.constraints, *model.loads):
        keys = [p for p in parents(element.dof_blocks) if p in last]
        if len(keys) > 1:
            latest = max(last[key] for key in keys)
            for key in keys:
                last_bodies[key] = max(last_bodies[key], latest)
    return last_bodies


def _refuse_loose(model: Mechanism, held: dict) -> None:
    for node in model.nodes.values():
        for dof_block in (node.position, node.rotation):
            for parent in dof_block.parents() if dof_block is not None else ():
                if parent.solved and parent not in held:
                    raise InputError(f"{_loose(model, parent, held)} is not connected to "
                                     "anything: attach a body or fix it")
    ways = set(model.ways())        # their points are on paths
    for load in model.loads:
        borne = [one for one in parents(load.dof_blocks) if one not in ways]
        if borne and load.time_function is not None and not any(p in held for p in borne):
            raise InputError(f"{load.name}: the load acts on a node without a body: attach one")


def _loose(model: Mechanism, dof_block: DofBlock, held: dict) -> str:
    """A DOF block that belongs to no body; its node where this belongs to none either."""
    name, _, kind = dof_block.name.rpartition(".")
    node = model.nodes[name]
    others = [t for t in (node.position, node.rotation) if t is not None and t is not dof_block]
    whole = not any(t in held or t.fixed for t in others)
    return f"node {name!r}" if whole else f"the {kind} of node {name!r}"


def _refuse_idle_drives(model: Mechanism) -> None:
    for joint in model.joints:
        if joint.kind != "drive":
            continue
        driven = list(dict.fromkeys(t for c in joint.constraints for t in parents(c.dof_blocks)))
        if not any(one.solved for one in driven):
            held = [one.name for one in driven if not one.name.startswith("ground.")]
            raise InputError(f"drive {joint.name!r} has nothing to move: {' and '.join(held)} "
                             f"{'are' if len(held) > 1 else 'is'} fixed or prescribed; leave out "
                             "the drive, or what holds them (fix(..., 'position') leaves the "
                             "rotation free)")


def _used(model: Mechanism) -> list[DofBlock]:
    """DOF blocks of nodes and elements, those of the ground included, and their parents."""
    elements = (*model.rigid_bodies.values(), *model.constraints, *model.loads)
    blocks = [t for n in model.nodes.values() for t in (n.position, n.rotation) if t is not None]
    blocks += [t for e in elements for t in e.dof_blocks]
    blocks += parents(blocks)
    return list(dict.fromkeys(blocks))
