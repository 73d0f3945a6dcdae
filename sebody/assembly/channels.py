"""How the loop reads what sensors measure: places and factors of numbers of a state.

Motion of nodes, amplitudes of modes, angles and rates of joints are sums of few such numbers, or
products with a rotation matrix. What else there is Python has to read, see `engine.control`.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering, record_counts
from sebody.contract.law_row import (
    ALONG,
    ANGLE,
    DOT,
    FLAT_ALONG,
    FLAT_RATE,
    IN_PLANE,
    INTO,
    ITS_RATE,
    OUTSIDE,
    TURNED,
)
from sebody.contract.layout import RECORD
from sebody.engine.control_data import CHANNEL_NUMBERS, CHANNEL_PLACES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import SLIDES, TURNS, DofBlock, Joint, Node, Way

AXES = "xyz"
OF_POSITION = {"position": "q", "velocity": "v", "acceleration": "a"}
OF_ROTATION = {"angular_velocity": "v", "angular_acceleration": "a"}
OF_MODES = {"modes": "q", "mode_rates": "v"}


class Channel(NamedTuple):
    """A row of `Control.channels` and one of `Control.coefficients`."""

    places: NDArray
    numbers: NDArray


def channel(model: Mechanism, numbering: Numbering, quantity: str, axes: str = "") -> Channel:
    """How the loop reads a quantity, perhaps in axes of a node; OUTSIDE where it cannot."""
    made = _Channels(model, numbering)
    return made.in_axes(quantity, model.nodes[axes]) if axes else made.of(quantity)


class _Channels:
    def __init__(self, model: Mechanism, numbering: Numbering):
        self.model, self.numbering = model, numbering
        self.at = RECORD.slices(record_counts(numbering))

    def of(self, quantity: str) -> Channel:
        """The channel of a quantity."""
        owner, _, last = quantity.rpartition(".")
        channel = self._whole(owner, last)
        if channel is None and owner:
            before, _, name = owner.rpartition(".")
            channel = self._component(before, name, last)
        return _made(OUTSIDE) if channel is None else channel

    def in_axes(self, quantity: str, axes: Node) -> Channel:
        """The channel of a component of the motion of a node in the axes of one."""
        owner, _, label = quantity.rpartition(".")
        owner, _, name = owner.rpartition(".")
        node, known = self.model.nodes.get(owner), self._known(axes.rotation)
        if node is None or name not in OF_POSITION or not (known and self._known(node.position)):
            return _made(OUTSIDE)
        x = self._place(OF_POSITION[name], node.position)
        way = np.eye(self.model.dimension)[AXES.index(label)]
        if self.model.planar:
            return _made(IN_PLANE, (self._place("q", axes.rotation), x), (0.0, *way))
        R = self.at["R"].start + 9 * self.numbering.rotations[axes.rotation]
        return _made(INTO, (R, x), (0.0, *way))

    def _whole(self, owner: str, name: str) -> Channel | None:
        """A quantity of one number."""
        node = self.model.nodes.get(owner)
        if node is not None and self.model.planar and name in ("rotation", *OF_ROTATION):
            part = OF_ROTATION.get(name, "q")
            return self._sum(part, node.rotation, np.array([1.0]))
        joints = [one for one in self.model.joints if one.name == owner]
        if len(joints) != 1:
            return None
        joint = joints[0]
        if joint.kind in TURNS and name in ("angle", "rate"):
            return self._turn(joint, name)
        if joint.kind in SLIDES and name in ("displacement", "speed"):
            return self._slide(joint, name)
        return None

    def _component(self, owner: str, name: str, label: str) -> Channel | None:
        """A component of a quantity."""
        if name in OF_MODES and owner in self.model.bodies and label.isdecimal():
            if int(label) >= self.model.bodies[owner].reduced.modes:
                return None
            place = self.at[OF_MODES[name]].start + self.numbering.modes[owner] + int(label)
            return _made(DOT, (place, place), (0.0, 1.0))
        node = self.model.nodes.get(owner)
        axes = AXES[:self.model.dimension]
        if node is None or label not in axes:
            return None
        way = np.eye(len(axes))[axes.index(label)]
        if name in OF_POSITION:
            return self._sum(OF_POSITION[name], node.position, way)
        if name in OF_ROTATION and not self.model.planar and self._known(node.rotation):
            R = self.at["R"].start + 9 * self.numbering.rotations[node.rotation]
            return _made(TURNED, (R, self._place(OF_ROTATION[name], node.rotation)), (0.0, *way))
        return None

    def _turn(self, joint: Joint, name: str) -> Channel | None:
        a, b = joint.node.rotation, joint.to.rotation
        if not self._known(a):
            return None
        part = "q" if name == "angle" else "v"
        if self.model.planar:
            return self._sum(part, a, np.ones(1), b, -np.ones(1))
        e, n, m = joint.axes.columns.T
        if name == "rate":
            return self._sum(part, a, e, b, -e)
        R = self.at["R"].start
        of_b = R + 9 * self.numbering.rotations[b] if self._known(b) else -1
        return _made(ANGLE, (R + 9 * self.numbering.rotations[a], of_b), (0.0, *n, *n, *m))

    def _slide(self, joint: Joint, name: str) -> Channel | None:
        """Of a joint whose axis rests, or turns with a node."""
        carrier, other, way = joint.way
        rests = carrier.rotation.fixed and not carrier.rotation.motions
        if not self._known(other.position):
            return None
        if not rests:
            return self._moving(joint.way, name)
        start = 0.0
        if name == "displacement":
            start = -float(way @ (other.point - carrier.point * self._known(carrier.position)))
        return self._sum("q" if name == "displacement" else "v", other.position, way,
                         carrier.position, -way, start)

    def _moving(self, along: Way, name: str) -> Channel | None:
        """The same of an axis that turns."""
        carrier, other, way = along
        if not (self._known(carrier.position) and self._known(carrier.rotation)):
            return None
        turn = self._place("v", carrier.rotation)
        if self.model.planar:
            kinds, R = (FLAT_ALONG, FLAT_RATE), self._place("q", carrier.rotation)
        else:
            kinds = ALONG, ITS_RATE
            R = self.at["R"].start + 9 * self.numbering.rotations[carrier.rotation]
        places = [self._place(part, node.position) for part in "qv" for node in (other, carrier)]
        if name == "displacement":
            return _made(kinds[0], (R, *places[:2]), (-along.start, *way))
        return _made(kinds[1], (R, *places, turn), (0.0, *way))

    def _sum(self, part: str, one: DofBlock | None, factors: NDArray,
             other: DofBlock | None = None, others: NDArray | None = None, start: float = 0.0
             ) -> Channel | None:
        """``start + factors . x + others . y`` of coordinates of two DOF blocks."""
        if not self._known(one):
            return None
        numbers = np.zeros(CHANNEL_NUMBERS)
        numbers[0], numbers[1:1 + len(factors)] = start, factors
        if others is not None and self._known(other):
            numbers[4:4 + len(others)] = others
        first = self._place(part, one)
        return _made(DOT, (first, self._place(part, other) if self._known(other) else first),
                     numbers)

    def _place(self, part: str, dof_block: DofBlock) -> int:
        return self.at[part].start + self.numbering.dof_blocks[dof_block]

    def _known(self, dof_block: DofBlock | None) -> bool:
        return dof_block is not None and dof_block in self.numbering.dof_blocks


def _made(kind: int, places: tuple[int, ...] = (), numbers: tuple[float, ...] = ()) -> Channel:
    row, constants = np.zeros(1 + CHANNEL_PLACES, dtype=np.int64), np.zeros(CHANNEL_NUMBERS)
    row[0], row[1:1 + len(places)] = kind, places
    constants[:len(numbers)] = numbers
    return Channel(row, constants)
