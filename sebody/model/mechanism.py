"""The data of a model, and how its parts are found by name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.basics.units import parsed_units
from sebody.model.acting import Switch
from sebody.model.control_parts import Controller, Sensor
from sebody.model.parts import (
    Beam,
    Connection,
    DofBlock,
    Element,
    GravityCourse,
    Joint,
    Motion,
    Node,
    Path,
    Superelement,
)
from sebody.model.plane import Plane
from sebody.model.rope_parts import Rope, Sheave


@dataclass(eq=False, repr=False)
class Mechanism:
    """A mechanism: nodes, superelements, rigid bodies, joints and forces.

    Parameters
    ----------
    planar : bool
        Motion in the x-y plane: positions (x, y) and one angle a node.
    units : str
        Units of all numbers, such as ``mm t N s``, for legends, axes and tables; those of its
        bodies by default.
    """

    planar: bool = False
    units: str = ""
    nodes: dict[str, Node] = field(default_factory=dict, init=False)
    bodies: dict[str, Superelement] = field(default_factory=dict, init=False)
    rigid_bodies: dict[str, Element] = field(default_factory=dict, init=False)
    joints: list[Joint] = field(default_factory=list, init=False)
    loads: list[Element] = field(default_factory=list, init=False)  # springs and dampers, too
    grounds: list[Node] = field(default_factory=list, init=False)   # fixed ends of joints
    connections: list[Connection] = field(default_factory=list, init=False)     # no equations
    beams: list[Beam] = field(default_factory=list, init=False)     # how they were built
    own_names: set[str] = field(default_factory=set, init=False)    # names given by the user
    default_names: Counter[str] = field(default_factory=Counter, init=False)    # how often wanted
    sensors: dict[str, Sensor] = field(default_factory=dict, init=False)
    paths: dict[str, Path] = field(default_factory=dict, init=False)
    sheaves: dict[str, Sheave] = field(default_factory=dict, init=False)
    ropes: dict[str, Rope] = field(default_factory=dict, init=False)
    controllers: dict[str, Controller] = field(default_factory=dict, init=False)
    switches: dict[str, Switch] = field(default_factory=dict, init=False)   # of what lets go, locks
    is_phase: bool = field(default=False, init=False)   # of a run: what acts does not change
    gravity_field: NDArray = field(init=False)      # that is constant
    gravity_courses: list[GravityCourse] = field(default_factory=list, init=False)
    plane: Plane | None = field(default=None, init=False)   # of a planar model made from a spatial

    def __post_init__(self) -> None:
        self.planar = inputs.flag(self.planar, "planar")
        self.units = str(parsed_units(self.units, "units of the model") or "")
        self.gravity_field = np.zeros(self.dimension)

    @property
    def dimension(self) -> int:
        """Coordinates of a position."""
        return 2 if self.planar else 3

    @property
    def rotation_size(self) -> int:
        """Coordinates of a rotation."""
        return 1 if self.planar else 3

    @property
    def constraints(self) -> list[Element]:
        """The equations of all joints and drives."""
        return [c for joint in self.joints for c in joint.constraints]

    def kind_of(self, name: str) -> str:
        """Kind of an element in this model's dimension: planar elements have their own kernels.

        Those of the way along a path are the same in both.
        """
        return "planar_" + name if self.planar and not name.startswith("way_") else name

    def dof_blocks(self) -> list[DofBlock]:
        """All DOF blocks, each once."""
        return list(dict.fromkeys(t for n in (*self.nodes.values(), *self.grounds)
                                  for t in (n.position, n.rotation) if t is not None)) + self.ways()

    def ways(self) -> list[DofBlock]:
        """Unknowns on no node: ways of points on paths, lengths of ropes, angles of sheaves."""
        found = [c.way for c in self.constraints if c.way is not None]
        found += [rope.winch for rope in self.ropes.values() if rope.winch is not None]
        found += [load.hidden for load in self.loads if load.hidden is not None]
        return list(dict.fromkeys(found))

    def size(self) -> float:
        """Characteristic length of the model, at least one unit of length."""
        return max([1.0, *(np.abs(n.point).max() for n in self.nodes.values())])

    def elements(self) -> Iterator[Superelement | Element | Joint | Motion]:
        """Everything with a name but the nodes: bodies, joints, loads, springs and drives."""
        own: list[Superelement | Element | Joint | Motion] = [
            *self.bodies.values(), *self.rigid_bodies.values(), *self.joints, *self.loads]
        yield from own
        for dof_block in self.dof_blocks():
            yield from dof_block.motions

    def element(self, name: str) -> Superelement | Element | Joint | Motion:
        """A body, joint, load, spring or drive by its name.

        Raises
        ------
        InputError
            Nothing, or more than one thing, has this name.
        """
        named = [e for e in self.elements() if e.name == name]
        if len(named) == 1:
            return named[0]
        if named:
            raise InputError(f"{len(named)} elements are called {name!r}: build them with name= to "
                             "tell them apart")
        raise unknown("element", name, (e.name for e in self.elements()), "the model has",
                      "the model has none")
