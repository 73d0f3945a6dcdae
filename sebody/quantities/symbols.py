"""Numbers of a state as symbols of a tape."""

from __future__ import annotations

from bisect import bisect
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering, record_counts
from sebody.contract.layout import ENERGIES, RECORD
from sebody.contract.read_numbers import ENERGY, FORCE, LOAD, NOW, RESIDUE, TOTAL
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.quantities.algebra import total
from sebody.quantities.expressions import Number, Tape
from sebody.quantities.numbers import Numbers


class NoTape(Exception):
    """A quantity that compiled code cannot evaluate, and why."""


class Symbols(Numbers):
    """Numbers as symbols of a tape.

    Parameters
    ----------
    system : System
    state : State
        Of a model, for sizes.
    tape : Tape
    start : (numbers of `layout.RECORD`,), optional
        The state at the start, where it is the same in all runs.
    """

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State,
                 tape: Tape, start: NDArray | None):
        super().__init__(model, numbering)
        self.system, self.state, self.tape, self.start = system, state, tape, start
        self._starts = {name: own.start for name, own in
                        RECORD.slices(record_counts(numbering)).items()}
        self._redundant = bool(system.regularized[0])

    def recorded(self, part: str, k: int) -> Number:
        return self.tape.read(NOW, self._starts[part] + k)

    def started(self, k: int) -> float:
        if self.start is None:
            raise NoTape("what depends on the start")
        return float(self.start[self._starts["frames"] + k])

    def multiplier(self, k: int) -> Number:
        self._refuse_redundant()
        return self.recorded("q", k)

    def force(self, k: int) -> Number:
        if self._redundant and k in self._of_constraints:
            raise NoTape("forces where constraints are redundant")
        return self.tape.read(FORCE, k)

    def total(self, k: int) -> Number:
        self._refuse_redundant()
        if not self.system.links.dependent.shape[0]:
            return total(map(self.force, np.flatnonzero(self.system.g_unknown == k).tolist()))
        return self.tape.read(TOTAL, k)

    def local(self, body: str) -> list[Number]:
        raise NoTape("outputs of bodies")

    def energy(self, k: int) -> Number:
        return self.tape.read(ENERGY, k)

    def residue(self, k: int) -> Number:
        return self.tape.read(RESIDUE, k)

    def power(self, port: int) -> Number:
        prescribed = [
            (int(coordinate), float(factor)) for (coordinate, of_port, _), factor in zip(
                self.system.prescribed, self.system.prescribed_factor, strict=True)
            if of_port == port]
        if not prescribed:
            if self._redundant and port in self._ports_of_constraints:
                raise NoTape("forces where constraints are redundant")
            powers = ENERGIES.slices(record_counts(self.numbering))["powers"]
            return self.energy(powers.start + port)
        rate = self.tape.read(LOAD, 3 * port + 1)
        found: Number = 0.0
        for coordinate, factor in prescribed:
            found = factor * (self.total(coordinate) * rate) + found
        return found

    def _refuse_redundant(self) -> None:
        if self._redundant:
            raise NoTape("forces where constraints are redundant")

    @cached_property
    def _of_constraints(self) -> set[int]:
        numbering, places = self.numbering, set[int]()
        starts = sorted([*numbering.forces_at.values(), self.state.g.size])
        for element in self.model.constraints:
            first = numbering.forces_at[element]
            places |= set(range(first, starts[bisect(starts, first)]))
        return places

    @cached_property
    def _ports_of_constraints(self) -> set[int]:
        names = self.numbering.port_names
        return {names.index(one.name) for one in self.model.constraints if one.name in names}
