"""Numbers of coordinates, multipliers and power ports of a model."""

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.ports import number_ports
from sebody.assembly.sequence import parents, sequence
from sebody.errors import InputError
from sebody.kernels.loader import element_kernel
from sebody.model.histories import History
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Triplet


class Numbering(NamedTuple):
    """Coordinates: unknowns first, then fixed and prescribed ones, then dependent positions."""

    free: int                           # number of unknowns
    total: int                          # number of coordinates
    triplets: dict[int, int]            # id(triplet) -> first coordinate
    rotations: dict[int, int]           # id(triplet) -> number of its rotation matrix
    modes: dict[str, int]               # superelement -> first modal amplitude
    multipliers: dict[int, int]         # id(constraint) -> first multiplier
    names: list[str]                    # of every coordinate
    dependent: list[Triplet]              # positions at the ends of rigid links
    ports: dict[int, int]               # id(constraint, load, spring, body) -> power port
    port_names: list[str]               # of every power port
    histories: list[History]            # of every power port
    prescribed: list[tuple[int, int, int, float]]   # coordinate, port, 1 for a rotation, factor
    groups: NDArray                     # where the unknowns of each body begin
    forces_at: dict[int, int] = {}      # id(body, constraint or load) -> its first force in State.g
    constants_at: dict[int, int] = {}   # id(body or element) -> its row in System.constants
    memories: dict[int, list[int]] = {} # id(element) -> what it keeps: places in State.frames
    bristles: dict[int, float] = {}     # id(element) -> stiffness of its bristles in the run
    reads: dict[int, list[int]] = {}    # id(element) -> multipliers of a joint that it reads
    jumps: list[list[float]] = []       # of every power port: when accelerations jump with it


def coordinates(numbering: Numbering, triplet: Triplet) -> list[int]:
    """Coordinates of a triplet."""
    first = numbering.triplets[id(triplet)]
    return list(range(first, first + triplet.start.size))


def stretch(numbering: Numbering, triplet: Triplet) -> slice:
    """Coordinates of a triplet, as a slice."""
    first = numbering.triplets[id(triplet)]
    return slice(first, first + triplet.start.size)


def kept_frames(numbering: Numbering) -> int:
    """Length of `State.frames`: frames of the superelements, and what elements keep."""
    return 9 * len(numbering.modes) + sum(map(len, numbering.memories.values()))


def rotational(model: Mechanism, numbering: Numbering) -> NDArray:
    """Which coordinates belong to rotations, (total,) of bool."""
    found = np.zeros(numbering.total, dtype=bool)
    for node in model.nodes.values():
        if node.rotation is not None and id(node.rotation) in numbering.triplets:
            found[coordinates(numbering, node.rotation)] = True
    return found


def placed(model: Mechanism, numbering: Numbering) -> NDArray:
    """Which coordinates belong to positions or rotations, (total,) of bool: no modes, multipliers.
    """
    found = np.zeros(numbering.total, dtype=bool)
    for node in model.nodes.values():
        for triplet in (node.position, node.rotation):
            if triplet is not None and id(triplet) in numbering.triplets:
                found[coordinates(numbering, triplet)] = True
    return found


def number(model: Mechanism) -> Numbering:
    """Number the unknowns body by body; a triplet that bodies share belongs to the last of them.

    The order of the bodies is that of `sequence`. Of the triplets of a body, those that joints and
    springs couple to later bodies come last. Multipliers follow unknowns they act on. An
    elimination in this order meets no zero pivot and fills in little.

    Raises
    ------
    InputError
        A triplet that belongs to no body and is not fixed.
    """
    parts, awaited = sequence(model)
    last = {id(p): k for k, part in enumerate(parts) for p in part.parents}
    coupled = _coupled(model, last)
    order, modes, groups = _Order(model, awaited), {}, []
    for k, part in enumerate(parts):
        groups.append(len(order.names))
        if part.name in model.bodies:
            modes[part.name] = len(order.names)
        order.names.extend(f"mode {mode} of {part.name}" for mode in range(part.modes))
        own = [p for p in part.parents if p.solved and last[id(p)] == k]
        for triplet in sorted(own, key=lambda p: coupled[id(p)]):
            order.place(triplet)
            order.place_multipliers(triplet)
    _refuse_loose(model, last)
    _refuse_idle_drives(model)
    free, used = len(order.names), _used(model)
    for triplet in used:
        if id(triplet) not in order.at and triplet.root is None:
            order.place(triplet, " (fixed)")
    dependent = [t for t in used if t.root is not None]
    for triplet in dependent:
        order.place(triplet)
    matrices = [] if model.planar else [t for t in used if t.rotational]
    rotations = {id(t): k for k, t in enumerate(matrices)}
    ports = number_ports(model, order.at)
    return Numbering(free, len(order.names), order.at, rotations, modes, order.multipliers,
                     order.names, dependent, ports.of, ports.names, ports.histories,
                     ports.prescribed, np.array(groups), jumps=ports.jumps,
                     memories=_memories(model), reads=_reads(model, order.multipliers))


class _Order:
    """Coordinates in the order of their numbers."""

    def __init__(self, model: Mechanism, awaited: dict[int, set[int]]) -> None:
        self.names: list[str] = []
        self.at: dict[int, int] = {}                # id(triplet) -> first coordinate
        self.multipliers: dict[int, int] = {}       # id(constraint) -> first multiplier
        self._awaited = awaited
        self._constraints: dict[int, list[Element]] = defaultdict(list)     # on each triplet
        for constraint in model.constraints:
            for key in awaited[id(constraint)]:
                self._constraints[key].append(constraint)
            if not awaited[id(constraint)]:
                self._place(constraint)

    def place(self, triplet: Triplet, remark: str = "") -> None:
        """Number the coordinates of a triplet."""
        self.at[id(triplet)] = len(self.names)
        self.names.extend(f"{triplet.name}[{k}]{remark}" for k in range(triplet.start.size))

    def place_multipliers(self, triplet: Triplet) -> None:
        """Number the multipliers of constraints for which this triplet was the last to wait for."""
        for constraint in self._constraints[id(triplet)]:
            if self._awaited[id(constraint)] <= self.at.keys():
                self._place(constraint)

    def _place(self, constraint: Element) -> None:
        self.multipliers[id(constraint)] = len(self.names)
        self.names.extend(f"multiplier {j} of {constraint.name}"
                          for j in range(constraint.multipliers))


def _memories(model: Mechanism) -> dict[int, list[int]]:
    """Places, behind the frames of all superelements, of what elements keep."""
    found, first = {}, 9 * len(model.bodies)
    for load in model.loads:
        if count := len(element_kernel(load.kind).MEMORY):
            found[id(load)] = list(range(first, first + count))
            first += count
    return found


def _reads(model: Mechanism, multipliers: dict[int, int]) -> dict[int, list[int]]:
    """Multipliers of the joint whose reaction presses an element."""
    return {id(load): [multipliers[id(c)] + k for c in load.pressed_by.constraints
                       for k in range(c.multipliers)]
            for load in model.loads if load.pressed_by is not None}


def _coupled(model: Mechanism, last: dict[int, int]) -> dict[int, int]:
    """Of every triplet the last body it belongs to or is coupled to by a joint or spring."""
    found = dict(last)
    for element in (*model.constraints, *model.loads):
        keys = [id(p) for p in parents(element.triplets) if id(p) in last]
        if len(keys) > 1:
            latest = max(last[key] for key in keys)
            for key in keys:
                found[key] = max(found[key], latest)
    return found


def _refuse_loose(model: Mechanism, held: dict) -> None:
    for node in model.nodes.values():
        for triplet in (node.position, node.rotation):
            for parent in triplet.parents() if triplet is not None else ():
                if parent.solved and id(parent) not in held:
                    raise InputError(f"{_loose(model, parent, held)} is not connected to "
                                     "anything: attach a body or fix it")
    for load in model.loads:
        borne = parents(load.triplets)
        if borne and load.history is not None and not any(id(p) in held for p in borne):
            raise InputError(f"{load.name}: the load acts on a node without a body: attach one")


def _loose(model: Mechanism, triplet: Triplet, held: dict) -> str:
    """A triplet that belongs to no body; its node where this belongs to none either."""
    name, _, kind = triplet.name.rpartition(".")
    node = model.nodes[name]
    others = [t for t in (node.position, node.rotation) if t is not None and t is not triplet]
    whole = not any(id(t) in held or t.fixed for t in others)
    return f"node {name!r}" if whole else f"the {kind} of node {name!r}"


def _refuse_idle_drives(model: Mechanism) -> None:
    for joint in model.joints:
        if joint.kind != "drive":
            continue
        driven = list({id(t): t for c in joint.constraints for t in parents(c.triplets)}.values())
        if not any(one.solved for one in driven):
            held = [one.name for one in driven if not one.name.startswith("ground.")]
            raise InputError(f"drive {joint.name!r} has nothing to move: {' and '.join(held)} "
                             f"{'are' if len(held) > 1 else 'is'} fixed or prescribed; leave out "
                             "the drive, or what holds them (fix(..., 'position') leaves the "
                             "rotation free)")


def _used(model: Mechanism) -> list[Triplet]:
    """Triplets of nodes and elements, those of the ground included, and their parents."""
    elements = (*model.rigid_bodies.values(), *model.constraints, *model.loads)
    found = [t for n in model.nodes.values() for t in (n.position, n.rotation) if t is not None]
    found += [t for e in elements for t in e.triplets]
    found += parents(found)
    return list({id(t): t for t in found}.values())


def record_counts(numbering: Numbering) -> dict[str, int]:
    """The counts of a model that sizes in `layout.RECORD` and `layout.ENERGIES` refer to."""
    return {"ports": len(numbering.histories), "coordinates": numbering.total,
            "rotations": len(numbering.rotations), "kept": kept_frames(numbering)}
