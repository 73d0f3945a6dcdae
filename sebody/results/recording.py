"""The data of a run, from which all results are read."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import ENERGIES, FIELD, RECORD
from sebody.engine.scalars import numbers_of
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.gravity_fields import rate_at
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts
from sebody.model.summary import summary
from sebody.results.energy_balance import energy_balance
from sebody.results.least_norm import least_norm
from sebody.results.postprocessing import (
    Forces,
    constraint_residuals,
    energies,
    forces,
    prescribed_powers,
    unit_potentials,
)


class Start(NamedTuple):
    """Changes and findings of a simulation before its first step."""

    changed: dict[str, float]       # DOF blocks whose velocity was solved for, with its change
    redundant: tuple[str, ...]      # joints with constraints that others contain
    shared: tuple[str, ...] = ()    # joints whose multipliers are not unique at the start
    untaken: tuple[str, ...] = ()   # what a start from the state of another model has left out
    lost: float = 0.0       # kinetic energy that fitting the velocities of that state took


class Event(NamedTuple):
    """Parts of a model that let go or lock in a run."""

    time: float
    what: str       # which, and whether they let go or lock
    lost: float     # energy that the impulse takes, and that is kept in what lets go


@dataclass(eq=False, repr=False)
class Recording:
    """A model, its arrays, and the states a run has recorded."""

    model: Mechanism
    numbering: Numbering
    system: System | None           # None if read from a file, which holds what is made from it
    state: State | None             # last state of the run
    rows: NDArray                   # (n, numbers of `layout.RECORD`) recorded states
    seconds: float                  # in the compiled loop
    failure: str = ""
    start: Start | None = None
    warnings: tuple[str, ...] = ()  # of the run, see sebody.runs.limits.watch
    error: float | None = None      # estimate over allowed error: see sebody.runs.accuracy
    stability: str = ""             # of an equilibrium, see `sebody.runs.loading`
    all_seconds: float = 0.0        # including runs that were repeated for accuracy
    events: tuple[Event, ...] = ()  # what let go and locked
    fields: dict[str, Any] = field(default_factory=dict, init=False, repr=False)    # made so far
    numbers: Any = field(default=None, init=False, repr=False)  # see sebody.results.histories

    def __repr__(self) -> str:
        t, kind = self.recorded("t")[:, 0], type(self).__name__
        end = f"t = {t[0]:.6g} to {t[-1]:.6g}" if len(t) else "no states"
        return (f"<{kind} of a {summary(self.model)}: {len(t)} states, {end}"
                + f"; {self.failure}" * bool(self.failure) + ">")

    def recorded(self, name: str) -> NDArray:
        """History of one of the parts of `layout.RECORD`, (n, size)."""
        return self.rows[:, RECORD.slices(record_counts(self.numbering))[name]]

    @property
    def arrays_of_loop(self) -> tuple[System, State]:
        """System and last state of a run in this process; read from a file, there are none."""
        assert self.system is not None and self.state is not None
        return self.system, self.state

    @property
    def gravity(self) -> NDArray:
        """Acceleration of free fall in all recorded states, which an ensemble may vary, (n, D)."""
        count = self.model.dimension
        if self.numbering.gravity:
            fields = [field for _, field in self.numbering.gravity]
            if self.system is not None:
                fields = list(self.system.gravity_fields[:, :count])
            times = self.recorded("t")[:, 0]
            amplitudes = [self.numbering.time_functions[port].values(times)
                          for port, _ in self.numbering.gravity]
            return np.stack(amplitudes, axis=1) @ np.stack(fields)
        constant = (self.model.gravity_field if self.state is None else
                    self.state.coefficients[FIELD:FIELD + count])
        return np.broadcast_to(constant, (len(self.rows), count))

    @cached_property
    def unique_rows(self) -> NDArray:
        """The recorded states with multipliers of least norm, also those of redundant constraints.

        In the states of the loop these contain a part that exerts no force, and jumps.
        """
        if self.system is None or not self.system.regularized[0]:
            return self.rows
        return least_norm(self.model, self.numbering, *self.arrays_of_loop, self.rows)

    @cached_property
    def counters(self) -> NDArray:
        """Steps, iterations and others, in the order of `engine.clock.CONTROL`."""
        return numbers_of(self.arrays_of_loop[1].control).copy()

    @cached_property
    def energies(self) -> NDArray:
        """Energies and momenta of every recorded state, rows of `layout.ENERGIES`."""
        return energies(*self.arrays_of_loop, self.rows)

    def energy_balance(self) -> float:
        """Largest drift of kinetic + strain + potential - work, relative to the energy exchanged.

        Of all recorded states, see `sebody.results.energy_balance`.
        """
        columns = ENERGIES.slices(record_counts(self.numbering))
        kinetic, strain, potential = (self.energies[:, columns[name]][:, 0]
                                      for name in ("kinetic", "strain", "potential"))
        work, t = self.recorded("works").sum(axis=1), self.recorded("t")[:, 0]
        for event in self.events:
            work[t >= event.time] -= event.lost
        return energy_balance(kinetic, strain, potential, work)

    @cached_property
    def forces(self) -> Forces:
        """Forces in every recorded state."""
        return forces(*self.arrays_of_loop, self.unique_rows)

    @cached_property
    def powers(self) -> NDArray:
        """Powers of the power ports in every recorded state, (n, ports)."""
        at = ENERGIES.slices(record_counts(self.numbering))["powers"]
        rows = self.unique_rows
        evaluated = (self.energies if rows is self.rows else
                     energies(*self.arrays_of_loop, rows))
        powers = prescribed_powers(self.arrays_of_loop[0], self.recorded("t")[:, 0],
                                   np.ascontiguousarray(self.recorded("frames")),
                                   self.forces.sums, evaluated[:, at])
        if self.numbering.gravity:
            ports = [port for port, _ in self.numbering.gravity]
            rates = [[rate_at(self.numbering.time_functions[port], t) for port in ports]
                     for t in self.recorded("t")[:, 0]]
            powers[:, ports] = rates * unit_potentials(*self.arrays_of_loop, rows)
        return powers

    @cached_property
    def constraint_residuals(self) -> NDArray:
        """Largest residuals of the constraints and of their rates, (n, 2)."""
        return constraint_residuals(*self.arrays_of_loop, self.rows)


# what is made from arrays and last state, and kept in their place in a file; forces likewise
EVALUATED = "counters", "energies", "powers", "constraint_residuals"
