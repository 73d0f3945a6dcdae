"""Numbers of states that formulas of quantities are made of.

Where they come from is left open: from histories, see `sebody.results.histories`, or as symbols,
see `Symbols`.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from sebody.model.arguments import dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import DofBlock, Node
from sebody.quantities.expressions import Matrix, Number, cosine, sine


class Parts(Protocol):
    """A model and its numbering."""

    model: Mechanism
    numbering: Numbering


class Numbers:
    """Numbers of states of a model; subclasses say where they come from.

    Parameters
    ----------
    model : Mechanism
    numbering : Numbering
    """

    def __init__(self, model: Mechanism, numbering: Numbering):
        self.model, self.numbering = model, numbering
        self.made: dict[str, Any] = {}      # of these numbers, once
        self._ground = {node.rotation for node in model.grounds}

    def recorded(self, part: str, k: int) -> Number:
        """Number k of a part of `layout.RECORD`."""
        raise NotImplementedError

    def started(self, k: int) -> float:
        """Number that was kept at place k of the frames at the start."""
        raise NotImplementedError

    def multiplier(self, k: int) -> Number:
        """Coordinate k, a multiplier; of redundant constraints those of least norm."""
        raise NotImplementedError

    def force(self, k: int) -> Number:
        """Force k of all elements: of the residual."""
        raise NotImplementedError

    def total(self, k: int) -> Number:
        """Sum of these forces on coordinate k."""
        raise NotImplementedError

    def energy(self, k: int) -> Number:
        """Number k of `layout.ENERGIES`."""
        raise NotImplementedError

    def residue(self, k: int) -> Number:
        """Largest residual of constraints, and of their rates."""
        raise NotImplementedError

    def power(self, port: int) -> Number:
        """Power of a port."""
        raise NotImplementedError

    def inside(self, node: str, quantity: str) -> object:
        """A quantity of an FE node inside a body."""
        raise NotImplementedError

    def local(self, body: str) -> list[Number]:
        """Reduced coordinates of a body, relative to its frame."""
        raise NotImplementedError

    def coordinates(self, part: str, block: DofBlock) -> list[Number]:
        """Coordinates of a DOF block, their rates or second rates; of the ground as they stay."""
        if block not in self.numbering.dof_blocks:
            return [float(x) if part == "q" else 0.0 for x in block.start]
        first = self.numbering.dof_blocks[block]
        return [self.recorded(part, first + k) for k in range(block.start.size)]

    def rotation(self, block: DofBlock | None) -> Matrix:
        """Rotation matrix of a block; of none that of no rotation."""
        if block is None or block in self._ground or block not in self.numbering.dof_blocks:
            return np.eye(self.model.dimension).tolist()
        if self.model.planar:
            angle = self.recorded("q", self.numbering.dof_blocks[block])
            c, s = cosine(angle), sine(angle)
            return [[c, -s], [s, c]]
        first = 9 * self.numbering.rotations[block]
        return [[self.recorded("R", first + 3 * i + j) for j in range(3)] for i in range(3)]

    def part(self, part: str, node: Node, kind: str) -> list[Number]:
        """Coordinates of a DOF block that a node must have."""
        return self.coordinates(part, dof_block(node, kind))
