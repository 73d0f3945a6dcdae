"""Quantities by name as tapes for compiled code, by the grammar of `naming`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.motions import Motions, motions
from sebody.assembly.numbering import Numbering, record_counts
from sebody.basics.errors import InputError
from sebody.contract.layout import MOTION as ROW
from sebody.contract.layout import RECORD
from sebody.contract.read_numbers import (
    FORCE,
    MOTION,
    NOW,
    OF_A,
    OF_FORCE,
    OF_NOTHING,
    OF_Q,
    OF_R,
    OF_TOTAL,
    OF_V,
    TOTAL,
)
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.quantities.algebra import back, dot
from sebody.quantities.expressions import Number, Tape, root
from sebody.quantities.inside import FENodes
from sebody.quantities.reading import Reading, reading
from sebody.quantities.symbols import NoTape, Symbols
from sebody.quantities.table import find
from sebody.results import naming, nodal
from sebody.results.recording import Recording

MOVES: dict[str | int, int] = {"q": OF_Q, "v": OF_V, "a": OF_A, FORCE: OF_FORCE, TOTAL: OF_TOTAL}


class States(Symbols):
    """Symbols of all quantities of a model, those of FE nodes included.

    Parameters
    ----------
    start : (numbers of `layout.RECORD`,), optional
        The state at the start, where it is the same in all runs.
    """

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State,
                 start: NDArray | None = None):
        super().__init__(model, numbering, system, state, Tape(), start)
        self.recording = Recording(model, numbering, system, state, state.now[None].copy(), 0.0)
        self.bodies: dict[str, tuple[Motions, int]] = {}
        self._moved = 0

    def inside(self, node: str, quantity: str) -> Any:
        return nodal.inside(self, node, quantity)

    def local(self, body: str) -> list[Number]:
        return self.motion(body)["y"]

    def motion(self, body: str) -> dict[str, list[Number]]:
        """Numbers of the motion of a body, by the parts of `layout.MOTION`."""
        if body not in self.bodies:
            group, = motions(self.model, self.numbering, [self.model.bodies[body]])
            self.bodies[body] = group, self._moved
            self._moved += group.size
        group, first = self.bodies[body]
        return {part: [self.tape.read(MOTION, first + k) for k in range(own.start, own.stop)]
                for part, own in ROW.slices(group.counts).items()}

    def of(self, name: str, axes: str = "") -> Any:
        """A quantity, component or group: a number, a vector or a matrix of symbols.

        Parameters
        ----------
        axes : str
            Node in whose axes a component of a vector is given.

        Raises
        ------
        InputError
            A name that nothing has.
        NoTape
            A quantity that compiled code cannot evaluate.
        """
        whole, components = naming.split(self.recording, name)
        value: Any
        if whole in naming.GROUPS:
            value = [self._whole(one) for one in naming.GROUPS[whole]]
        else:
            value = self._whole(whole)
        if axes and shape_of(value) != (self.model.dimension,):
            raise InputError(f"{whole!r} is no vector, which axes turn: leave out axes=")
        if axes:
            value = back(self.rotation(self.model.nodes[axes].rotation), value)
        for component in components:
            value = self._component(whole, value, component)
            whole = f"{whole}.{component}"
        return value

    def put(self, name: str, axes: str = "") -> tuple[int, ...]:
        """Let all numbers of a quantity be the next outputs; its shape in a state."""
        value = self.of(name, axes)
        for number in flat(value):
            self.tape.put(number)
        return shape_of(value)

    def is_inside(self, name: str) -> bool:
        """Whether a quantity is one of FE nodes: their tapes are long."""
        owner = naming.split(self.recording, name)[0].rpartition(".")[0]
        return owner not in self.model.nodes and owner in FENodes(self)

    @property
    def kinds(self) -> set[int]:
        """Kinds of the numbers that are read, as of `contract.read_numbers`."""
        return {kind for kind, _ in self.tape.inputs}

    def places(self) -> NDArray | None:
        """Places of all outputs in the recorded row, where they are nothing but these."""
        kinds = {place: key for key, place in self.tape.inputs.items()}
        found = [kinds.get(place, (-1, 0)) for place in self.tape.outputs]
        if any(kind != NOW for kind, _ in found):
            return None
        return np.array([place for _, place in found], dtype=np.int64)

    def depends(self) -> NDArray:
        """What each number that is read depends on, (inputs, 3), as of `contract.read_numbers`.

        And its place there: of a rotation matrix the first coordinate of its rotation, then the
        entry among all matrices.
        """
        numbering = self.numbering
        slices = RECORD.slices(record_counts(numbering))
        turns = {k: numbering.dof_blocks[block] for block, k in numbering.rotations.items()}
        found = []
        for kind, place in self.tape.inputs:
            part = next((name for name, own in slices.items()
                         if kind == NOW and own.start <= place < own.stop), "")
            k = place - slices[part].start if part else place
            if part == "R":
                found.append((OF_R, turns[k // 9], k))
            else:
                found.append((MOVES.get(part or kind, OF_NOTHING), k, 0))
        return np.array(found, dtype=np.int64).reshape(-1, 3)

    def reading(self) -> Reading:
        """The arrays of the tape."""
        return reading(self.tape, self.system, self.state, list(self.bodies.values()))

    def _whole(self, name: str) -> Any:
        found = find(self, name)
        assert found is not None        # see `naming.split`
        quantity, owner = found
        return quantity.formula(self, owner)

    def _component(self, name: str, value: Any, component: str) -> Any:
        if not isinstance(value, Sequence):
            naming.refuse_component(name, component)
        if component == naming.NORM and shape_of(value) != (3, 3):
            numbers = flat(value)
            return root(dot(numbers, numbers))
        if shape_of(value) == (3, 3) and component in (*naming.AXES, naming.NORM):
            raise NoTape("a rotation vector, which is followed through turns")
        labels = naming.labels_of(shape_of(value), name)
        if shape_of(value) == (3, 3):
            return flat(value)[labels.index(component)] if component in labels else (
                naming.refuse_component(name, component, labels))
        if component not in labels:
            naming.refuse_component(name, component, labels)
        return value[labels.index(component)]


def flat(value: Any) -> list[Number]:
    """All numbers of a number, a vector or a matrix."""
    return [x for one in value for x in flat(one)] if isinstance(value, Sequence) else [value]


def shape_of(value: Any) -> tuple[int, ...]:
    """Shape of a number, a vector or a matrix."""
    if not isinstance(value, Sequence):
        return ()
    return len(value), *(shape_of(value[0]) if value else ())
