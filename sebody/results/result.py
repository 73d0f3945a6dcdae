"""Results of a run, by named node: histories, energies, momentum, and the file they go to."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sebody.analysis.initial_state import Start
from sebody.assembly.numbering import Numbering
from sebody.engine.state import CUTS, ITERATIONS, MATRICES, STEPS, State, recorded_parts
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.kernels.layout import POTENTIAL
from sebody.model.model import Model
from sebody.model.parts import Triplet
from sebody.results.files import check_target
from sebody.results.postprocessing import Forces, constraint_residuals, energies, forces

if TYPE_CHECKING:
    from sebody.analysis.simulation import Simulation

NODE_QUANTITIES = ("position", "rotation", "velocity", "angular_velocity", "acceleration",
                   "reaction", "reaction_moment")
SYSTEM_QUANTITIES = {"energy.kinetic": 0, "energy.strain": 1, "momentum": slice(2, 5),
                     "angular_momentum": slice(5, 8), "energy.potential": POTENTIAL}
OUTPUT = "output file", (".npz",)        # what is saved, see `files.check_target`
CONSTRAINTS = ("constraints.position", "constraints.velocity")


@dataclass(eq=False)
class Result:
    """Histories on the output grid; ``result["tip.position"]`` by the rule ``<node>.<quantity>``.

    Quantities of a node: position, velocity, acceleration (n, 3), rotation (n, 3, 3),
    angular_velocity (n, 3), all in global axes; in a plane (n, 2) and (n,); where it is fixed or
    prescribed reaction and reaction_moment. Of the model: energy.kinetic, energy.strain (springs
    included), energy.potential, energy.external_work (n,), momentum and angular_momentum about the
    origin (n, 3), constraints.position and constraints.velocity, the largest residuals (n,).

    Of a superelement ``<body>.modes`` (n, m); of any body ``<body>.forces``, those of neighbours
    and supports on its nodes, inertia balanced: positions in global axes, rotations in those of
    their nodes; of a joint ``<joint>.multipliers``; of a load, damper or drive ``<name>.work``.
    """

    model: Model
    numbering: Numbering
    system: System
    state: State
    rows: NDArray           # recorded states, see `recorded`
    seconds: float
    failure: str = ""
    start: Start | None = None
    error: float | None = None      # estimated, in what is allowed: see sebody.analysis.accuracy
    all_seconds: float = 0.0        # of the runs that led to it, too
    warnings: tuple[str, ...] = ()  # what the run was warned of, see sebody.analysis.limits
    _energies: NDArray | None = field(default=None, repr=False)
    _forces: Forces | None = field(default=None, repr=False)
    _constraints: NDArray | None = field(default=None, repr=False)

    @classmethod
    def of(cls, run: "Simulation") -> "Result":
        """Everything a simulation has recorded so far."""
        rows = np.concatenate([record.rows for record in run.records])
        return cls(run.model, run.numbering, run.system, run.state, rows, run.seconds, run.failure,
                   run.start, warnings=tuple(run.watch.messages))

    def recorded(self, name: str) -> NDArray:
        """History of one of `recorded_parts`, (n, size)."""
        parts = recorded_parts(self.numbering.total, len(self.numbering.rotations),
                                    len(self.model.bodies), len(self.numbering.histories))
        return self.rows[:, parts[name]]

    @property
    def t(self) -> NDArray:
        """Output times [time]."""
        return self.recorded("t")[:, 0]

    @property
    def steps(self) -> int:
        """Accepted steps, cut ones included."""
        return int(self.state.control[STEPS])

    @property
    def cuts(self) -> int:
        """Steps that were cut because Newton's iteration did not converge."""
        return int(self.state.control[CUTS])

    @property
    def matrices(self) -> int:
        """Iteration matrices made."""
        return int(self.state.control[MATRICES])

    @property
    def iterations_per_step(self) -> float:
        """Newton iterations a step."""
        return float(self.state.control[ITERATIONS]) / max(self.steps, 1)

    @property
    def microseconds_per_step(self) -> float:
        """Time in the compiled loop per step."""
        return 1e6 * self.seconds / max(self.steps, 1)

    def __getitem__(self, name: str) -> NDArray:
        """History of a quantity by name; see the class."""
        if name == "t":
            return self.t
        if name == "energy.external_work":
            return self.recorded("works").sum(axis=1)
        if name in SYSTEM_QUANTITIES:
            return self._energy_table()[:, SYSTEM_QUANTITIES[name]]
        if name in CONSTRAINTS:
            return self._residuals()[:, CONSTRAINTS.index(name)]
        owner, _, quantity = name.rpartition(".")
        bodies = self.model.bodies | self.model.rigid_bodies
        if owner in self.model.bodies and quantity == "modes":
            first = self.numbering.modes[owner]
            return self.recorded("q")[:, first:first + self.model.bodies[owner].body.modes]
        if owner in bodies and quantity == "forces":
            return self._of_body(owner)
        if quantity == "work" and owner in self.numbering.item_names:
            return self.recorded("works")[:, self.numbering.item_names.index(owner)]
        if quantity == "multipliers" and any(j.name == owner for j in self.model.joints):
            return self._multipliers(owner)
        if owner not in self.model.nodes:
            raise InputError(
                f"{name!r} is unknown: nodes are {', '.join(self.model.nodes)}; of bodies "
                f"({', '.join(bodies)}) there are modes and forces; of joints multipliers; of "
                f"{', '.join(self.numbering.item_names) or 'loads'} work; of the model t, "
                f"energy.external_work, {', '.join((*CONSTRAINTS, *SYSTEM_QUANTITIES))}")
        if quantity not in NODE_QUANTITIES:
            raise InputError(f"{quantity!r} is unknown: a node has {', '.join(NODE_QUANTITIES)}")
        return self._of_node(owner, quantity)

    def forces(self) -> Forces:
        """Forces in every recorded state, see `sebody.results.postprocessing`; evaluated once."""
        if self._forces is None:
            self._forces = forces(self)
        return self._forces

    def _of_body(self, name: str) -> NDArray:
        """Forces of neighbours and supports on a body's nodes, its inertia balanced."""
        part = (self.model.bodies | self.model.rigid_bodies)[name]
        first = self.numbering.forces_at[id(part)]
        width = (part.body.stiffness.shape[0] if name in self.model.bodies else
                 sum(t.start.size for t in part.triplets))
        return self.forces().elements[:, first:first + width]

    def _multipliers(self, name: str) -> NDArray:
        equations = [c for c in self.model.constraints if c.name == name]
        if not equations:
            raise InputError(f"joint {name!r} takes no equation, so it has no multipliers: what "
                             "it joins is shared or fixed; the force on a fixed node is its "
                             "reaction")
        firsts = [(self.numbering.multipliers[id(c)], c.multipliers) for c in equations]
        rows = [first + k for first, count in firsts for k in range(count)]
        return self.recorded("q")[:, rows]

    def _of_node(self, name: str, quantity: str) -> NDArray:
        node = self.model.nodes[name]
        turning = quantity in ("rotation", "angular_velocity", "reaction_moment")
        triplet = node.rotation if turning else node.position
        if triplet is None or id(triplet) not in self.numbering.triplets:
            raise InputError(f"node {name!r} has no {quantity}: the triplet is not in the model")
        first = self.numbering.triplets[id(triplet)]
        part = slice(first, first + triplet.start.size)
        if quantity.startswith("reaction"):
            return self._reaction(triplet, part)
        if not turning:
            source = {"position": "q", "velocity": "v", "acceleration": "a"}[quantity]
            return self.recorded(source)[:, part]
        v = self.recorded("v")
        if self.model.planar:
            return (self.recorded("q") if quantity == "rotation" else v)[:, first]
        R = self._turned(triplet)
        return R if quantity == "rotation" else np.einsum("nij,nj->ni", R, v[:, part])

    def _turned(self, triplet: Triplet) -> NDArray:
        """Rotation matrices of a rotation in space, (n, 3, 3)."""
        k = self.numbering.rotations[id(triplet)]
        return self.recorded("R")[:, 9 * k:9 * k + 9].reshape(-1, 3, 3)

    def _reaction(self, triplet: Triplet, part: slice) -> NDArray:
        """What the support of a fixed or prescribed triplet exerts, in global axes."""
        if not triplet.fixed:
            raise InputError(f"{triplet.name} is free: only fixed and prescribed nodes have a "
                             "reaction; a joint's force is in its multipliers")
        values = self.forces().sums[:, part]
        if id(triplet) not in self.numbering.rotations:
            return values
        return np.einsum("nij,nj->ni", self._turned(triplet), values)

    def _energy_table(self) -> NDArray:
        if self._energies is None:
            self._energies = energies(self)
        return self._energies

    def _residuals(self) -> NDArray:
        if self._constraints is None:
            self._constraints = constraint_residuals(self)
        return self._constraints

    def energy_balance(self) -> float:
        """Largest drift of kinetic + strain + potential - work, relative to the largest energy."""
        inner = self["energy.kinetic"] + self["energy.strain"]
        total = inner + self["energy.potential"]
        drift = np.abs(total - total[0] - self["energy.external_work"]).max()
        return float(drift / max(np.abs(inner).max(), 1e-300))

    def arrays(self) -> dict[str, NDArray]:
        """All named histories, as they are saved."""
        out = {"t": self.t}
        for name, node in self.model.nodes.items():
            for quantity in NODE_QUANTITIES[:4]:
                turning = quantity in ("rotation", "angular_velocity")
                triplet = node.rotation if turning else node.position
                if triplet is not None and id(triplet) in self.numbering.triplets:
                    out[f"{name}.{quantity}"] = self[f"{name}.{quantity}"]
        for name in ("energy.kinetic", "energy.strain", "energy.potential",
                     "energy.external_work", "momentum", "angular_momentum"):
            out[name] = self[name]
        return out

    def save(self, path: str | Path) -> Path:
        """Write all named histories to an npz file."""
        path = check_target(path, *OUTPUT)
        np.savez_compressed(path, **self.arrays())
        return path

    def summary(self) -> str:
        """A few lines: steps, iterations, time, balances, works, what the start changed."""
        lines = [
            f"unknowns             {self.numbering.free}",
            f"steps                {self.steps} ({self.cuts} cut), to t = {self.t[-1]:.6g}",
            f"iterations per step  {self.iterations_per_step:.2f} "
            f"({self.matrices} iteration matrices)",
            f"time per step        {self.microseconds_per_step:.2f} us in the compiled loop",
            f"energy balance       {self.energy_balance():.2e} of the largest energy",
            f"momentum at the end  {_vector(self['momentum'][-1])}, moment "
            f"{_vector(self['angular_momentum'][-1])}",
        ]
        if self.numbering.multipliers:
            lines.append(f"constraints          off by at most "
                         f"{self['constraints.position'].max():.1e}, their rates by "
                         f"{self['constraints.velocity'].max():.1e}")
        lines += [f"work                 {self.recorded('works')[-1, k]:.6g} by {name}"
                  for k, name in enumerate(self.numbering.item_names)]
        if self.error is not None:
            lines.insert(2, f"error                {self.error:.2f} of the tolerance, estimated; "
                            f"{1e3 * self.all_seconds:.3g} ms with the coarser runs before")
        if self.start and self.start.changed:
            lines.append("solved for           initial velocity of "
                         + ", ".join(f"{name} (by {change:.3g})"
                                     for name, change in self.start.changed.items()))
        if self.start and self.start.redundant:
            lines.append("redundant            constraints of " + ", ".join(self.start.redundant)
                         + ": multipliers are those of least norm")
        lines += [f"WARNING              {message}" for message in self.warnings]
        return "\n".join(lines + ([f"FAILED               {self.failure}"] if self.failure else []))


def _vector(values: NDArray) -> str:
    return "(" + ", ".join(f"{v:.4g}" for v in values) + ")"
