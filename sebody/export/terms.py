"""Outputs by name: as channels of sensors, or as sums of products that compiled code evaluates.

How a quantity follows from a state is written once, in `sebody.results`. Here it is asked there in
states in which one number is one and all others are zero, and what is found is compared with the
quantity in a state of random numbers: a quantity that is no such sum is refused.
"""

from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.assembly.channels import channel
from sebody.assembly.numbering import Numbering, record_counts
from sebody.contract.law_row import OUTSIDE
from sebody.contract.layout import ENERGIES, RECORD
from sebody.engine.control_data import CHANNEL_NUMBERS, CHANNEL_PLACES
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.export.quantities import FACTORS, FORCE, NOW, OF_ENERGY, ONE, SUM, Outputs
from sebody.model.control_parts import Sensor
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Joint
from sebody.results import naming
from sebody.results.field_quantities import FENodes
from sebody.results.postprocessing import Forces
from sebody.results.recording import Recording

SEED, SAME = 7, 1e-9    # of the state of random numbers, and how far both may differ in it
NONE = ONE, 0
LOCAL = {"local_force": "force", "local_moment": "moment", "torque": "moment", "thrust": "force"}


class Term(NamedTuple):
    """A product of a weight and some numbers."""

    weight: float
    factors: tuple[tuple[int, int], ...]    # what each is of, and its place


class Quantities:
    """What compiled code evaluates of a model."""

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State):
        self.model, self.numbering, self.system, self.state = model, numbering, system, state
        counts = record_counts(numbering)
        self._parts = RECORD.slices(counts)
        sizes = state.now.size, state.g.size, state.residual.size, ENERGIES.size(counts)
        self._kinds = [(kind, k) for kind, size in zip((NOW, FORCE, SUM, OF_ENERGY), sizes,
                                                       strict=True) for k in range(size)]
        self._ends = np.cumsum(sizes)[:-1]
        rest = np.zeros(len(self._kinds))
        R = self._parts["R"]
        rest[R] = np.tile(np.eye(3).ravel(), (R.stop - R.start) // 9)
        random = np.random.default_rng(SEED).uniform(-1.0, 1.0, rest.size)
        random[R] = Rotation.random((R.stop - R.start) // 9, random_state=SEED).as_matrix().ravel()
        self._rest, self._random = rest, random
        self._turned = self._of_rotations()

    def names(self, names: Iterable[str]) -> list[str]:
        """Names of numbers: of a vector those of its components.

        Raises
        ------
        InputError
            A name that nothing has.
        """
        found = []
        for name in names:
            values = naming.look_up(self._now(), name)
            found += [name + "." * bool(label) + label
                      for label in naming.component_names(values, name)]
        return found

    def made(self, names: list[str], sensors: list[Sensor]) -> Outputs:
        """Outputs of some numbers, then of what sensors measure.

        Raises
        ------
        InputError
            A quantity that compiled code cannot evaluate.
        """
        asked = [(name, "") for name in names] + [(s.quantity, s.axes) for s in sensors]
        channels = [channel(self.model, self.numbering, *one) for one in asked]
        terms = [(k, term) for k, (name, axes) in enumerate(asked)
                 if channels[k].places[0] == OUTSIDE for term in self._terms(name, axes)]
        kinds = {kind for _, term in terms for kind, _ in term.factors}
        rows = [(k, *(n for factor in (term.factors + (NONE,) * FACTORS)[:FACTORS] for n in factor))
                for k, term in terms]
        return _outputs(
            np.array([one.places for one in channels], dtype=np.int64),
            np.array([one.numbers for one in channels], dtype=float),
            np.array(rows, dtype=np.int64), np.array([term.weight for _, term in terms]),
            [int(bool(kinds & {FORCE, SUM})), int(OF_ENERGY in kinds)], self.state)

    def _now(self) -> Recording:
        return Recording(self.model, self.numbering, self.system, self.state,
                         self.state.now[None].copy(), 0.0)

    def _values(self, name: str, sources: NDArray) -> NDArray:
        """A quantity in states, (n,), of given forces and energies."""
        rows, elements, sums, energies = np.split(sources, self._ends, axis=1)
        recording = Recording(self.model, self.numbering, self.system, self.state, rows, 0.0)
        powers = ENERGIES.slices(record_counts(self.numbering))["powers"]
        vars(recording).update(unique_rows=rows, forces=Forces(elements, sums), energies=energies,
                               powers=energies[:, powers])
        return naming.look_up(recording, name)

    def _terms(self, name: str, axes: str) -> list[Term]:
        """A quantity as a sum of products.

        Raises
        ------
        InputError
            It is none.
        """
        owner, _, _ = name.rpartition(".")
        prescribed = {self.numbering.port_names[k] for k in self.system.prescribed[:, 1]}
        refused = (axes or self._inside(name) or self.system.regularized[0] and "force" in name
                   or name.endswith(".power") and owner in prescribed)
        for made in () if refused else (self._linear, self._with_rotations, self._in_joint_axes):
            found = made(name)
            if found is not None and self._same(name, found):
                return found
        raise InputError(
            f"output {name!r} cannot be compiled: motion of nodes and modes, angles of joints, "
            "forces and moments of joints, loads and supports, works, energies, sensors and "
            "signals can, unless constraints are redundant; quantities of FE nodes cannot")

    def _linear(self, name: str) -> list[Term] | None:
        """Weights of numbers, from one state for each of them."""
        sources = self._rest + np.vstack([np.zeros(self._rest.size), np.eye(self._rest.size)])
        values = self._values(name, sources)
        if values.ndim != 1:
            return None
        weights = values[1:] - values[0]
        constant = values[0] - weights @ self._rest
        found = [Term(float(weights[k]), (self._kinds[k],)) for k in np.flatnonzero(weights)]
        return found + [Term(float(constant), ())] * bool(constant)

    def _inside(self, name: str) -> bool:
        """Whether it is a quantity of an FE node."""
        recording = self._now()
        owner = naming.split(recording, name)[0].rpartition(".")[0]
        return owner not in self.model.nodes and owner in FENodes(recording)

    def _with_rotations(self, name: str) -> list[Term] | None:
        """The same with moments, which elements give in axes that turn with nodes."""
        found = []
        for weight, factors in self._linear(name) or ():
            turned = self._turned.get(factors[0]) if factors else None
            if turned is None:
                found.append(Term(weight, factors))
                continue
            matrix, first, axis = turned
            found += [Term(weight, ((NOW, matrix + 3 * axis + k), (factors[0][0], first + k)))
                      for k in range(3)]
        return found

    def _in_joint_axes(self, name: str) -> list[Term] | None:
        """Forces and moments of joints along their axes, those of drives included."""
        owner, _, last = name.rpartition(".")
        whole, axis = ((owner, "xyz".index(last)) if last in "xyz"[:self.model.dimension] else
                       (name, 0))
        joint_name, _, quantity = whole.rpartition(".")
        joint = next((one for one in self.model.joints if one.name == joint_name), None)
        if joint is None or joint.axes is None or quantity not in LOCAL:
            return None
        sign = -1.0 if quantity == "thrust" else 1.0
        found = []
        for i, label in enumerate("xyz"[:self.model.dimension]):
            of_joint = self._with_rotations(f"{joint_name}.{LOCAL[quantity]}.{label}")
            along = self._along(joint, i, axis)
            if of_joint is None or along is None:
                return None
            found += [Term(sign * a.weight * b.weight, (*a.factors, *b.factors))
                      for a, b in product(along, of_joint)]
        return found

    def _along(self, joint: Joint, i: int, axis: int) -> list[Term] | None:
        """Component i of an axis of a joint."""
        assert joint.axes is not None
        block, columns = joint.axes.carrier.rotation, joint.axes.columns
        if block is None or block not in self.numbering.dof_blocks:
            return [Term(float(columns[i, axis]), ())]
        if self.model.planar:
            return None
        first = self._matrix(block) + 3 * i
        return [Term(float(columns[k, axis]), ((NOW, first + k),)) for k in range(3)
                if columns[k, axis] != 0.0]

    def _same(self, name: str, terms: list[Term]) -> bool:
        """Whether a sum is the quantity in a state of random numbers."""
        places = {kind: k for k, kind in enumerate(self._kinds)}
        products = [term.weight * np.prod([self._random[places[one]] for one in term.factors])
                    for term in terms]
        value = self._values(name, self._random[None])[0]
        return bool(abs(sum(products) - value) <= SAME * max(1.0, np.abs(products).sum()))

    def _matrix(self, block: DofBlock) -> int:
        return self._parts["R"].start + 9 * self.numbering.rotations[block]

    def _of_rotations(self) -> dict[tuple[int, int], tuple[int, int, int]]:
        """Of moments in axes of nodes: where the rotation matrix and the moment begin, the axis."""
        if self.model.planar:
            return {}
        found = {}
        numbering, model = self.numbering, self.model
        for part in (*model.bodies.values(), *model.rigid_bodies.values(), *model.constraints,
                     *model.loads):
            first = numbering.forces_at[part]
            for place in part.attachments:
                block = getattr(place.node, place.kind)
                if block in numbering.rotations:
                    for k in range(3):
                        found[FORCE, first + k] = self._matrix(block), first, k
                first += block.start.size
        for block in numbering.rotations:
            first = numbering.dof_blocks[block]
            for k in range(3):
                found[SUM, first + k] = self._matrix(block), first, k
        return found


def no_outputs() -> Outputs:
    """Outputs of nothing, for their types."""
    return _outputs(np.zeros((0, 1 + CHANNEL_PLACES), dtype=np.int64),
                    np.zeros((0, CHANNEL_NUMBERS)), np.zeros(0, dtype=np.int64), np.zeros(0),
                    [0, 0], None)


def _outputs(channels: NDArray, coefficients: NDArray, terms: NDArray, weights: NDArray,
             needs: list[int], state: State | None) -> Outputs:
    row, loads, sums = ((state.now, state.loads, state.residual) if state else [np.zeros(0)] * 3)
    return Outputs(channels.reshape(-1, 1 + CHANNEL_PLACES),
                   coefficients.reshape(-1, CHANNEL_NUMBERS),
                   terms.reshape(-1, 1 + 2 * FACTORS), weights.astype(float), np.array(needs),
                   np.zeros(len(channels)), np.zeros(row.size), np.zeros(loads.size),
                   np.zeros(sums.size))
