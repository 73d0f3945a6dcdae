"""Derivatives of stresses at FE nodes by the states of a run.

The stress at a node of beam elements is that of the fibre with the largest von Mises stress. As a
function of the state it has a kink where another fibre takes over, but the section forces are
smooth, and the stress of each fibre is linear in them. So section forces are differentiated, and
the stress of the deciding fibre follows exactly, however near another one is. Stresses of solids
are smooth themselves; their von Mises stress follows from them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.fem.stress import von_mises
from sebody.gradients.followed import Followed
from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.gradients.sensors import Evaluated, Rows, Sensor, smoothly
from sebody.quantities.inside import FENodes
from sebody.quantities.names import NORM, STRESS, split
from sebody.results.field_quantities import fe_node
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.runs.simulation import Simulation

QUANTITIES = "stress", "von_mises"
ALIKE = 1e-9    # of the largest stress: closer ones are equal but for rounding


class NodeStress:
    """The stress at an FE node, a component of it, or its von Mises stress.

    Where several fibres are stressed most, as by symmetry, the derivative is the mean of theirs:
    that of changes which keep the symmetry.

    Parameters
    ----------
    smooth : Followed or Evaluated
        Section forces of the element ends at the node, or the stress of solids.
    operator : (fibres, 6, components of `smooth`)
        Stresses in the fibres.
    recording : Recording
        Of the recorded states.
    """

    def __init__(self, smooth: Followed | Evaluated, operator: NDArray, recording: Recording,
                 quantity: str):
        self.smooth, self.operator, self.quantity = smooth, operator, quantity
        self.whole, components = split(recording, quantity)
        self.component = components[0] if components else None
        self.t = recording.recorded("t")[:, 0]
        self.stresses = self._fibres(recording)             # (states, fibres, 6)
        self.sizes = von_mises(self.stresses)
        self.deciding = self.sizes.argmax(axis=1)

    def at(self, k: int, event: int) -> Rows:
        """Derivatives in a recorded state."""
        rows, own = self.smooth.at(k, event), self.deciding[k]
        alike = np.flatnonzero(self.sizes[k] >= (1.0 - ALIKE) * self.sizes[k, own])
        apart = np.abs(self.stresses[k, alike] - self.stresses[k, own]).max()
        if not self.whole.endswith("von_mises") and apart > ALIKE * self.sizes[k, own]:
            raise self._not_smooth(k)
        each = [self._by_fibre(k, int(fibre), rows) for fibre in alike]
        return Rows(*(np.mean(parts, axis=0) for parts in zip(*each, strict=True)))

    def values(self, recording: Recording) -> NDArray:
        """The quantity by the fibres that decide in the run, in the same states of another model.

        It is smooth in the parameters of the model.
        """
        stresses = self._fibres(recording)[np.arange(len(self.deciding)), self.deciding]
        if self.whole.endswith("von_mises"):
            return von_mises(stresses)
        if self.component == NORM:
            return np.linalg.norm(stresses, axis=1)
        return stresses if self.component is None else stresses[:, STRESS.index(self.component)]

    def _fibres(self, recording: Recording) -> NDArray:
        """Histories in all fibres at the node, (states, fibres, 6)."""
        if self.smooth.quantity.endswith(".stress"):
            return np.asarray(look_up(recording, self.smooth.quantity), dtype=float)[:, None]
        return fe_node(recording, self.whole.rpartition(".")[0]).fibre_stress

    def _by_fibre(self, k: int, fibre: int, rows: Rows) -> Rows:
        by_stress = self._by_stress(self.stresses[k, fibre], k) @ self.operator[fibre]
        return Rows(*(by_stress @ part for part in rows))

    def _by_stress(self, s: NDArray, k: int) -> NDArray:
        """Derivatives of the quantity by the stress of the fibre, (components, 6)."""
        if self.whole.endswith("von_mises"):
            size = float(von_mises(s))
            if size == 0.0:
                raise self._not_smooth(k)
            mean = s[:3].mean()
            return np.concatenate([1.5 * (s[:3] - mean), 3.0 * s[3:]])[None] / size
        if self.component == NORM:
            size = float(np.linalg.norm(s))
            if size == 0.0:
                raise self._not_smooth(k)
            return s[None] / size
        rows = np.eye(6)
        return rows if self.component is None else rows[[STRESS.index(self.component)]]

    def _not_smooth(self, k: int) -> InputError:
        return InputError(f"quantity {self.quantity!r} has no derivative at t = {self.t[k]:.6g}: "
                          "the stress is zero there, or differs between fibres of a section that "
                          "are stressed alike; give section forces, or another time")


def node_stress(run: Simulation, quantity: str, linear: Linear, history: History
                ) -> NodeStress | None:
    """Sensor of a stress at an FE node; None of other quantities."""
    recording = Recording(run.model, run.numbering, run.system, run.state, history.states, 0.0)
    whole, _ = split(recording, quantity)
    node, _, what = whole.rpartition(".")
    if what not in QUANTITIES or node not in FENodes(recording):
        return None
    operator = fe_node(recording, node).fibres_by_section_forces
    smooth, size = ("stress", 6) if operator is None else ("section_forces", operator.shape[2])
    return NodeStress(smoothly(run, f"{node}.{smooth}", size, linear, history),
                      np.eye(6)[None] if operator is None else operator, recording, quantity)


def history_of(sensor: Sensor, recording: Recording, quantity: str) -> NDArray:
    """History of a quantity in states of a run, as a smooth function of a model's parameters."""
    return (sensor.values(recording) if isinstance(sensor, NodeStress) else
            np.asarray(look_up(recording, quantity), dtype=float))
