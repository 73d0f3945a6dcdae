"""Numbers of a state as symbols of a tape."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import ENERGIES, RECORD
from sebody.contract.read_numbers import ENERGY, FORCE, LOAD, NOW, RESIDUE, TOTAL
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts
from sebody.quantities.algebra import back, dot, total
from sebody.quantities.expressions import Number, Tape, root
from sebody.quantities.names import AXES, GROUPS, NORM, labels_of, refuse_component, split
from sebody.quantities.numbers import Numbers
from sebody.quantities.table import find


class NoTape(Exception):
    """A quantity that compiled code cannot evaluate, and why."""


class Recorded(Numbers):
    """Numbers of the recorded row as symbols of a tape; what follows from others has none."""

    def __init__(self, model: Mechanism, numbering: Numbering):
        super().__init__(model, numbering)
        self.tape = Tape()
        self.parts = RECORD.slices(record_counts(numbering))

    def recorded(self, part: str, k: int) -> Number:
        return self.tape.read(NOW, self.parts[part].start + k)

    def started(self, k: int) -> float:
        raise NoTape("what depends on the start")

    def multiplier(self, k: int) -> Number:
        raise NoTape("a force")

    def force(self, k: int) -> Number:
        raise NoTape("a force")

    def total(self, k: int) -> Number:
        raise NoTape("a force")

    def energy(self, k: int) -> Number:
        raise NoTape("an energy or momentum")

    def residue(self, k: int) -> Number:
        raise NoTape("a residual of constraints")

    def power(self, port: int) -> Number:
        raise NoTape("a power")

    def inside(self, node: str, quantity: str) -> Any:
        raise NoTape("quantities of FE nodes")

    def local(self, body: str) -> list[Number]:
        raise NoTape("outputs of bodies")

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
        whole, components = split(self, name)
        value: Any
        if whole in GROUPS:
            value = [self._whole(one) for one in GROUPS[whole]]
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

    def _whole(self, name: str) -> Any:
        found = find(self, name)
        assert found is not None        # see `split`
        quantity, owner = found
        return quantity.formula(self, owner)

    def _component(self, name: str, value: Any, component: str) -> Any:
        if not isinstance(value, Sequence):
            refuse_component(name, component)
        if component == NORM and shape_of(value) != (3, 3):
            numbers = flat(value)
            return root(dot(numbers, numbers))
        if shape_of(value) == (3, 3) and component in (*AXES, NORM):
            raise NoTape("a rotation vector, which is followed through turns")
        labels = labels_of(shape_of(value), name)
        if shape_of(value) == (3, 3):
            return flat(value)[labels.index(component)] if component in labels else (
                refuse_component(name, component, labels))
        if component not in labels:
            refuse_component(name, component, labels)
        return value[labels.index(component)]


class Symbols(Recorded):
    """Numbers of the recorded row, forces, energies, loads and powers as symbols of a tape.

    Parameters
    ----------
    system : System
    state : State
        Of a model, for sizes.
    start : (numbers of `layout.RECORD`,), optional
        The state at the start, where it is the same in all runs.
    """

    def __init__(self, model: Mechanism, numbering: Numbering, system: System, state: State,
                 start: NDArray | None):
        super().__init__(model, numbering)
        self.system, self.state, self.start = system, state, start
        self._redundant = bool(system.regularized[0])

    def started(self, k: int) -> float:
        if self.start is None:
            raise NoTape("what depends on the start")
        return float(self.start[self.parts["frames"].start + k])

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

    def energy(self, k: int) -> Number:
        return self.tape.read(ENERGY, k)

    def residue(self, k: int) -> Number:
        return self.tape.read(RESIDUE, k)

    def power(self, port: int) -> Number:
        if any(port == one for one, _ in self.numbering.gravity):
            raise NoTape("powers of gravity that changes with time")
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


def flat(value: Any) -> list[Number]:
    """All numbers of a number, a vector or a matrix."""
    return [x for one in value for x in flat(one)] if isinstance(value, Sequence) else [value]


def shape_of(value: Any) -> tuple[int, ...]:
    """Shape of a number, a vector or a matrix."""
    if not isinstance(value, Sequence):
        return ()
    return len(value), *(shape_of(value[0]) if value else ())
