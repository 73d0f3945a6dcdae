"""Quantities as sums of products of numbers of a state, of forces and of energies.

How a quantity follows from a state is written once, in `sebody.results`. Here it is asked there in
states in which one number is one and all others are zero, and what is found is compared with the
quantity in states of random numbers.
"""

from bisect import bisect
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.assembly.numbering import Numbering, record_counts
from sebody.contract.layout import ENERGIES, RECORD
from sebody.engine.evaluate import set_loads
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.export.program import Program, Term, product_of
from sebody.export.quantities import (
    BELOW_HALF,
    COSINE,
    FORCE,
    LOAD,
    MOVED,
    NOW,
    OF_ENERGY,
    ONE,
    POSITIVE,
    RESIDUES,
    SINE,
    SUM,
)
from sebody.kernels.loader import element_kernel
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Element, Joint, Superelement
from sebody.results import naming
from sebody.results.contact_quantities import pressing
from sebody.results.motion import evaluated
from sebody.results.postprocessing import Forces, prescribed_powers
from sebody.results.recording import Recording

SEED, SAME = 7, 1e-9    # of states of random numbers, and how far both may differ in them
STATES = 4              # of them
AROUND = 0.3            # how far they are from the start: positions, and angles of rotations [rad]
LOCAL = {"local_force": "force", "local_moment": "moment", "torque": "moment", "thrust": "force"}


class Terms:
    """Sums of products that are quantities of a model."""

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State):
        self.model, self.numbering, self.system, self.state = model, numbering, system, state
        counts = record_counts(numbering)
        self._parts = RECORD.slices(counts)
        sizes = state.now.size, state.g.size, state.residual.size, ENERGIES.size(counts), 2
        self._kinds = [(kind, k) for kind, size in zip(
            (NOW, FORCE, SUM, OF_ENERGY, RESIDUES), sizes, strict=True) for k in range(size)]
        self._ends = np.cumsum(sizes)[:-1]
        rest = np.zeros(len(self._kinds))
        R = self._parts["R"]
        rest[R] = np.tile(np.eye(3).ravel(), (R.stop - R.start) // 9)
        self._rest, self.states = rest, self._random_states()
        self.numbers = self._numbers()
        self._turned = self._of_rotations()

    def _random_states(self) -> NDArray:
        """The start, then states of random numbers around it, (1 + STATES, numbers)."""
        random, start = np.random.default_rng(SEED), self.state.now
        numbers = random.uniform(-1.0, 1.0, (1 + STATES, len(self._kinds)))
        q, R = self._parts["q"], self._parts["R"]
        numbers[:, q] = start[q] + AROUND * numbers[:, q]
        for row in numbers:
            turns = Rotation.from_rotvec(random.uniform(-AROUND, AROUND, ((R.stop - R.start) // 9,
                                                                          3))).as_matrix()
            row[R] = (start[R].reshape(-1, 3, 3) @ turns).ravel()
        for name in ("frames", "frames_old"):       # of bodies: rotations
            first = self._parts[name].start
            own = slice(first, first + 9 * len(self.model.bodies))
            numbers[:, own] = start[own]
        numbers[0, :start.size] = start
        return numbers

    def _numbers(self) -> dict[int, NDArray]:
        """Numbers of every kind in these states, but of motions and of other outputs."""
        rows, elements, sums, energies, residues = np.split(self.states, self._ends, axis=1)
        loads = np.zeros((len(rows), self.state.loads.size))
        for row, own in zip(rows, loads, strict=True):
            set_loads(self.system, np.ascontiguousarray(row[self._parts["frames"]]), own,
                      float(row[self._parts["t"]][0]))
        return {ONE: np.ones((len(rows), 1)), NOW: rows, FORCE: elements, SUM: sums,
                OF_ENERGY: energies, RESIDUES: residues, LOAD: loads}

    def numbers_of(self, program: Program) -> dict[int, NDArray]:
        """The same with the motions of bodies that a program asks for."""
        rows, counts = np.ascontiguousarray(self.numbers[NOW]), record_counts(self.numbering)
        motions = [evaluated(group, rows, counts)[0].reshape(len(rows), -1)
                   for group, _ in program.bodies.values()]
        return self.numbers | {MOVED: np.hstack([np.zeros((len(rows), 0)), *motions])}

    def recording(self) -> Recording:
        """The state at the start."""
        return Recording(self.model, self.numbering, self.system, self.state,
                         self.state.now[None].copy(), 0.0)

    def values(self, name: str, sources: NDArray) -> NDArray:
        """A quantity in states, (n,), of given forces, energies and residuals."""
        rows, elements, sums, energies, residues = np.split(sources, self._ends, axis=1)
        recording = Recording(self.model, self.numbering, self.system, self.state, rows, 0.0)
        powers = prescribed_powers(
            self.system, rows[:, self._parts["t"]][:, 0],
            np.ascontiguousarray(rows[:, self._parts["frames"]]), sums,
            energies[:, ENERGIES.slices(record_counts(self.numbering))["powers"]])
        vars(recording).update(unique_rows=rows, forces=Forces(elements, sums), energies=energies,
                               powers=powers, constraint_residuals=residues)
        return naming.look_up(recording, name)

    @cached_property
    def shared(self) -> set[tuple[int, int]]:
        """Numbers that are not unique where constraints are redundant."""
        numbering, q = self.numbering, self._parts["q"].start
        powers = ENERGIES.slices(record_counts(numbering))["powers"].start
        numbers = {(SUM, k) for k in range(self.state.residual.size)}
        numbers |= {(NOW, q + int(k)) for k in np.flatnonzero(self.system.is_multiplier)}
        starts = sorted([*numbering.forces_at.values(), self.state.g.size])
        for element in self.model.constraints:
            if element.name in numbering.port_names:
                numbers.add((OF_ENERGY, powers + numbering.port_names.index(element.name)))
            first = numbering.forces_at[element]
            numbers |= {(FORCE, k) for k in range(first, starts[bisect(starts, first)])}
        return numbers

    def found(self, name: str) -> list[Term] | None:
        """A quantity as a sum of products; None if it is none."""
        for made in (self._of_contact, self._of_motion, self._linear, self._with_rotations,
                     self._in_joint_axes):
            terms = made(name)
            if terms is not None and self._same(name, terms):
                return terms
        return None

    def _of_contact(self, name: str) -> list[Term] | None:
        """Whether friction sticks, and what it has dissipated."""
        owner, _, quantity = name.rpartition(".")
        element = pressing(self.recording()).get(owner)
        if element is None or quantity not in ("sticks", "dissipation"):
            return None
        memory, places = element_kernel(element.kind).MEMORY, self.numbering.memories[element]
        at = {part: self._parts["frames"].start + int(place)
              for part, place in zip(memory, places, strict=True)}
        if quantity == "sticks":
            return [Term(1.0, ((POSITIVE, at["normal"]), (BELOW_HALF, at["slid"])))]
        port = self.numbering.port_names.index(owner)
        terms = [Term(-1.0, ((NOW, self._parts["works"].start + port),))]
        bent = [part for part in memory if part.startswith("bent")]
        if bent and self.numbering.bristles:
            half = 0.5 * self.numbering.bristles[element]
            for part in bent:
                terms += [Term(-half, ((NOW, at[part]), (NOW, at[part]))),
                          Term(float(half * self.state.now[at[part]]**2))]
        return terms

    def _of_motion(self, name: str) -> list[Term] | None:
        """Power of a prescribed motion."""
        owner, _, quantity = name.rpartition(".")
        if quantity != "power" or owner not in self.numbering.port_names:
            return None
        port = self.numbering.port_names.index(owner)
        return [Term(float(factor), ((SUM, int(coordinate)), (LOAD, 3 * port + 1)))
                for (coordinate, of_port, _), factor in zip(
                    self.system.prescribed, self.system.prescribed_factor, strict=True)
                if of_port == port] or None

    def _linear(self, name: str) -> list[Term] | None:
        """Weights of numbers, from one state for each of them."""
        sources = self._rest + np.vstack([np.zeros(self._rest.size), np.eye(self._rest.size)])
        values = self.values(name, sources)
        if values.ndim != 1:
            return None
        weights = values[1:] - values[0]
        constant = values[0] - weights @ self._rest
        terms = [Term(float(weights[k]), (self._kinds[k],)) for k in np.flatnonzero(weights)]
        return terms + [Term(float(constant), ())] * bool(constant)

    def _with_rotations(self, name: str) -> list[Term] | None:
        """The same with moments, which elements give in axes that turn with nodes."""
        terms = []
        for weight, factors in self._linear(name) or ():
            turned = self._turned.get(factors[0]) if factors else None
            if turned is None:
                terms.append(Term(weight, factors))
                continue
            matrix, first, axis = turned
            terms += [Term(weight, ((NOW, matrix + 3 * axis + k), (factors[0][0], first + k)))
                      for k in range(3)]
        return terms

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
        terms = []
        for i, label in enumerate("xyz"[:self.model.dimension]):
            of_joint = self._with_rotations(f"{joint_name}.{LOCAL[quantity]}.{label}")
            along = self._along(joint, i, axis)
            if of_joint is None or along is None:
                return None
            terms += [Term(sign * a.weight * b.weight, (*a.factors, *b.factors))
                      for a, b in product(along, of_joint)]
        return terms

    def _along(self, joint: Joint, i: int, axis: int) -> list[Term] | None:
        """Component i of an axis of a joint."""
        assert joint.axes is not None
        block, columns = joint.axes.carrier.rotation, joint.axes.columns
        if block is None or block not in self.numbering.dof_blocks:
            return [Term(float(columns[i, axis]), ())]
        if self.model.planar:
            return self._along_in_plane(self._parts["q"].start + self.numbering.dof_blocks[block],
                                        columns[:, axis], i)
        first = self._matrix(block) + 3 * i
        return [Term(float(columns[k, axis]), ((NOW, first + k),)) for k in range(3)
                if columns[k, axis] != 0.0]

    @staticmethod
    def _along_in_plane(angle: int, column: NDArray, i: int) -> list[Term]:
        """Component i of a direction that turns by an angle."""
        x, y = (float(v) for v in column)
        return [Term(weight, ((kind, angle),)) for weight, kind in (
            ((x, COSINE), (-y, SINE)) if i == 0 else ((x, SINE), (y, COSINE))) if weight]

    def _same(self, name: str, terms: list[Term]) -> bool:
        """Whether a sum is the quantity in all states, the start included."""
        products = np.array([product_of(term, self.numbers) for term in terms]).reshape(
            -1, len(self.states))
        return self.agree(name, products.sum(axis=0), np.abs(products).sum(axis=0))

    def agree(self, name: str, found: NDArray, size: NDArray | float = 1.0) -> bool:
        """Whether values are those of a quantity in all states."""
        own = self.values(name, self.states)
        return bool(np.all(np.abs(found - own) <= SAME * np.maximum(
            1.0, np.maximum(size, np.abs(own)))))

    def _matrix(self, block: DofBlock) -> int:
        return self._parts["R"].start + 9 * self.numbering.rotations[block]

    def _of_rotations(self) -> dict[tuple[int, int], tuple[int, int, int]]:
        """Of moments in axes of nodes: where the rotation matrix and the moment begin, the axis."""
        if self.model.planar:
            return {}
        weights = {}
        numbering, model = self.numbering, self.model
        parts: list[Element | Superelement] = [
            *model.bodies.values(), *model.rigid_bodies.values(), *model.constraints, *model.loads]
        for part in parts:
            first = numbering.forces_at[part]
            for place in part.attachments:
                block = getattr(place.node, place.kind)
                if block in numbering.rotations:
                    for k in range(3):
                        weights[FORCE, first + k] = self._matrix(block), first, k
                first += block.start.size
        for block in numbering.rotations:
            first = numbering.dof_blocks[block]
            for k in range(3):
                weights[SUM, first + k] = self._matrix(block), first, k
        return weights
