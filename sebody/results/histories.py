"""Numbers of recorded states, as histories: formulas of quantities give histories of these."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import RECORD
from sebody.model.numbering import record_counts
from sebody.model.parts import Node
from sebody.quantities.balance import Part, balance
from sebody.quantities.numbers import Numbers
from sebody.results.field_quantities import fe_node
from sebody.results.motion import body_motion
from sebody.results.recording import Recording


class Histories(Numbers):
    """Numbers of the states of a recording, (n,) each.

    Parameters
    ----------
    recording : Recording
    """

    def __init__(self, recording: Recording):
        super().__init__(recording.model, recording.numbering)
        self.recording = recording
        self._slices = RECORD.slices(record_counts(recording.numbering))

    def recorded(self, part: str, k: int) -> NDArray:
        return self.recording.rows[:, self._slices[part].start + k]

    def started(self, k: int) -> float:
        return float(self.recorded("frames", k)[0])

    def multiplier(self, k: int) -> NDArray:
        return self.recording.unique_rows[:, self._slices["q"].start + k]

    def force(self, k: int) -> NDArray:
        return self.recording.forces.elements[:, k]

    def total(self, k: int) -> NDArray:
        return self.recording.forces.sums[:, k]

    def energy(self, k: int) -> NDArray:
        return self.recording.energies[:, k]

    def residue(self, k: int) -> NDArray:
        return self.recording.constraint_residuals[:, k]

    def power(self, port: int) -> NDArray:
        return self.recording.powers[:, port]

    def inside(self, node: str, quantity: str) -> NDArray:
        return getattr(fe_node(self.recording, node), quantity)

    def local(self, body: str) -> list[NDArray]:
        key = f"{body} in its frame"
        if key not in self.made:
            motion = body_motion(self.recording, self.model.bodies[body], slice(None))
            self.made[key] = list(motion.y.T)
        return self.made[key]

    def whole(self, value: Any) -> NDArray:
        """A formula's number, vector or matrix as an array (n, ...)."""
        if isinstance(value, np.ndarray):
            return value
        n = len(self.recording.rows)
        if not isinstance(value, list):
            return np.full(n, value)
        parts = [self.whole(one) for one in value]
        return np.stack(parts, axis=1) if parts else np.zeros((n, 0))

    def on(self, part: Part, node: Node, kind: str) -> NDArray:
        """Force or moment of an element on a node, (n, size)."""
        return self.whole(balance(self).on(part, node, kind))


def histories(recording: Recording) -> Histories:
    """Numbers of the states of a recording, made once."""
    if recording.numbers is None:
        recording.numbers = Histories(recording)
    return recording.numbers
