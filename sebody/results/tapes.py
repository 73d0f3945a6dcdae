"""Quantities by name as tapes for compiled code, by the grammar of `naming`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.motions import motions
from sebody.contract.layout import MOTION as ROW, RECORD
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
from sebody.model.numbering import Numbering, record_counts
from sebody.quantities.expressions import Number
from sebody.quantities.inside import FENodes
from sebody.quantities.names import split
from sebody.quantities.reading import Motions, Reading, reading
from sebody.quantities.symbols import Symbols
from sebody.results import nodal
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
        super().__init__(model, numbering, system, state, start)
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

    def is_inside(self, name: str) -> bool:
        """Tell whether a quantity is one of FE nodes: their tapes are long."""
        owner = split(self, name)[0].rpartition(".")[0]
        return owner not in self.model.nodes and owner in FENodes(self)

    @property
    def kinds(self) -> set[int]:
        """Kinds of the numbers that are read, as of `contract.read_numbers`."""
        return {kind for kind, _ in self.tape.inputs}

    @property
    def moving(self) -> list[int]:
        """Numbers of motions of bodies that are read."""
        return [place for kind, place in self.tape.inputs if kind == MOTION]

    @property
    def resting(self) -> list[slice]:
        """Numbers of motions of bodies that do not depend on rates."""
        return [slice(first + own.start, first + own.stop) for group, first in self.bodies.values()
                for name, own in ROW.slices(group.counts).items()
                if name in ("origin", "rotation", "y")]

    def places(self) -> NDArray | None:
        """Places of all outputs in the recorded row, where they are nothing but these."""
        kinds = {place: key for key, place in self.tape.inputs.items()}
        found = [kinds.get(place, (-1, 0)) for place in self.tape.outputs]
        if any(kind != NOW for kind, _ in found):
            return None
        return np.array([place for _, place in found], dtype=np.int64)

    def depends(self) -> NDArray:
        """Dependence of each number that is read, (inputs, 3), as of `contract.read_numbers`.

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
