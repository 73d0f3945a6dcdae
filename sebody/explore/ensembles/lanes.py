"""Runs of an ensemble eight at a time: the arrays of a thread, and what its members give."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.contracts import counts_of
from sebody.contract.counts import MEMBERS
from sebody.contract.layout import AT_CONSTANTS, AT_FRAME, RECORD_T, Row
from sebody.engine.lanes import loop
from sebody.engine.lanes.arrays import Columns, Scratch, empty, fill, in_lanes, numbers
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.explore.ensembles.member import Copies, Course, Form
from sebody.explore.ensembles.outputs import Folds, Output
from sebody.kernels.lanes.kernel import address_in_lanes
from sebody.kernels.lanes.straight import write_address
from sebody.kernels.loader import load

MOST_NUMBERS = 8_000        # of recorded states at a time: they stay in the processor's cache
MOST_STEPS = 20_000         # until a thread looks whether it is to stop: tenths of a second
ALONE = 1.0         # reason of a lane without a member


class Lanes:
    """The arrays of a thread for eight members.

    Parameters
    ----------
    copies : Copies
        Where members begin, one after the other.
    kernels : sequence of str
        Names of the model's kernels.
    outputs : mapping
        What is kept.
    forms : mapping
        How each quantity is read.
    last : int
        Last step of the grid.

    Attributes
    ----------
    courses : list of Course
        Outputs of the members that were run last.
    ended : bool
        Whether these were run to their end; False if they were stopped before.
    """

    def __init__(self, copies: Copies, kernels: Sequence[str], outputs: Mapping[str, Output],
                 forms: Mapping[str, Form], last: int):
        self.copies = copies
        image, one = copies.image, copies.image.template
        buffer = empty(image.offsets.size)
        self._numbers = numbers(buffer)
        self.system = _with_addresses(in_lanes(one.system, image.offsets, buffer), kernels)
        self._write_straight_code()
        self.state = in_lanes(one.state, image.offsets, buffer)
        n = len(one.system.diagonal)
        frames = one.state.frames.size
        self._scratch = Scratch(g=empty(one.state.g.size), frames=empty(frames),
                                found=empty(frames), T=empty(one.state.T.size),
                                J=empty(int(one.system.at_J[one.system.first_joint[0]])),
                                dense=empty(n, n))
        self._places = self._own_places()
        columns = _columns(forms, one.state.now.size)
        self._forms = {name: form if form.columns is None else form._replace(
            columns=np.searchsorted(columns, form.columns)) for name, form in forms.items()}
        self._stretch = max(1, min(last // one.every, MOST_NUMBERS // len(columns)))
        rows = (self._stretch + 1, len(columns))
        self._record = Columns(places=columns, rows=empty(*rows), every=np.array([one.every]))
        self._rows = np.empty(rows)
        self._last, self._begun = last, {}
        self._outputs, self._changes = outputs, []
        self._evaluated = not all(form.kinematic for form in forms.values())
        self._folds = {name: Folds(one, forms[one.quantity].shape,
                                   self._forms[one.quantity].columns, MEMBERS)
                       for name, one in outputs.items()
                       if one.kind != "history" and forms[one.quantity].columns is not None}
        self.courses, self.ended = [], False

    def _write_straight_code(self) -> None:
        """Straight code for the packed matrices among the constants of bodies."""
        image = self.copies.image
        bodies, system = list(image.template.model.bodies.values()), image.template.system
        constants = image.offsets.of(system.constants).start
        floats = image.floats.copy()
        slots = image.lines.slots           # not zero in some members
        floats[slots] = np.where(floats[slots] == 0.0, 1.0, floats[slots])
        for index in _index_rows(system):
            body, first = bodies[index[AT_FRAME]], constants + index[AT_CONSTANTS]
            counts, row = counts_of(body), Row("constants", load(body.kernel).CONSTANTS)
            places = row.slices(counts)
            for part in row.parts:
                if part.packed and part.size(counts):
                    own = slice(first + places[part.name].start, first + places[part.name].stop)
                    write_address(floats[own], self._numbers[own])

    def _own_places(self) -> NDArray:
        """Places in the buffer of what members begin with: parameters, and their state."""
        image, state = self.copies.image, self.copies.image.template.state
        begun = (image.offsets.of(part) for part in (
            state.now, state.aux, state.changes, state.fitted, state.fit, state.q_start,
            state.loads, state.loads_old, state.acting, state.coefficients, state.frames_old,
            state.q_old, state.aux_old))
        return np.unique(np.concatenate([image.lines.slots.astype(np.int64),
                                         *(np.arange(part.start, part.stop) for part in begun)]))

    def begin(self, change: NDArray) -> bool:
        """Begin a run in the next free lane; False if it is to be run alone.

        Parameters
        ----------
        change : (components,)
            As of `Copies.begin`.
        """
        try:
            begun = self.copies.begin(change)
        except InputError:      # told where it is run alone
            return False
        if begun:
            if not self._begun:
                self._keep_begun()
            self._take(len(self._changes))
            self._changes.append(change)
        return begun

    def _take(self, member: int) -> None:
        """Give a lane the numbers of the run that `copies` has begun."""
        loop.take_member(self.copies.floats, self._places, member, self._numbers)

    def run(self, stop: Callable[[], bool]) -> NDArray:
        """Run the members that have begun to their end, and take in their outputs.

        Returns
        -------
        ndarray
            Which of them gave up, (members,): they are to be run alone.
        """
        state, count = self.state, len(self._changes)
        self._begin_records()
        for folds in self._folds.values():
            folds.begin()
        self.courses = [Course(self.copies, int(self._record.every[0]), self._outputs, self._forms,
                               {name: folds.members[member] for name, folds in self._folds.items()})
                        for member in range(count)]
        for member in range(count, MEMBERS):        # lanes without a member: another one's numbers
            self._take(member)
        state.control["reason"] = np.where(np.arange(MEMBERS) < count, 0.0, ALONE)
        every, reached = int(self._record.every[0]), 0
        while reached < self._last:
            reached = min(self._last, (reached // every + self._stretch) * every,
                          reached + MOST_STEPS)
            state.control["recorded"] = 0
            loop.advance(self.system, state, self._scratch, self._record, self.copies.scheme,
                         reached)
            self._take_outputs(np.flatnonzero(state.control["reason"][:count] == 0.0))
            if reached < self._last and stop():
                break
        self.ended = reached == self._last
        self._changes.clear()
        return state.control["reason"][:count] != 0.0

    def _take_outputs(self, members: NDArray) -> None:
        """Take in recorded states: folds of all members together, all else of each."""
        table, rows = numbers(self._record.rows), self._rows[:self.state.control["recorded"]]
        t = table[:len(rows), 0, 0].copy()
        for folds in self._folds.values():
            folds.add(t, table, members)
        if len(self._folds) < len(self._outputs):
            for member in members:
                if self._evaluated:         # quantities of elements: with the member's constants
                    self.copies.begin(self._changes[member])
                loop.rows_of(table, member, rows)
                self.courses[member].take(rows)

    def _keep_begun(self) -> None:
        """Keep the scalars and counters of the member that has begun; failed starts have others."""
        for name in ("control", "clock", "guard"):
            record = getattr(self.state, name)
            fill(record, getattr(self.copies.state, name))
            self._begun[name] = record.base.copy()

    def _begin_records(self) -> None:
        """Set scalars and counters to those of a member that has begun, the same for all."""
        for name, begun in self._begun.items():
            getattr(self.state, name).base[...] = begun

    @property
    def time(self) -> float:
        """Time reached."""
        return float(self.state.clock["time"])


def _columns(forms: Mapping[str, Form], count: int) -> NDArray:
    """Which numbers of a state are recorded: all, if a quantity is computed from them."""
    if any(form.columns is None for form in forms.values()):
        return np.arange(count)
    return np.unique(np.concatenate([[RECORD_T], *(form.columns for form in forms.values())]))


def _index_rows(system: System) -> Iterator[NDArray]:
    """The index rows of all superelements."""
    for b in range(int(system.first_joint[0])):
        rows = system.index[system.at_index[b]:system.at_index[b + 1]]
        yield from rows.reshape(system.count[b], -1)


def _with_addresses(system: System, kernels: Sequence[str]) -> System:
    """A system that calls kernels for lanes."""
    modules = [load(name) for name in kernels]
    addresses = {module.kernel.address: address_in_lanes(module) for module in modules}
    members = {name: getattr(system, name) for name in System.__annotations__}
    members["address"] = np.array([addresses[a] for a in system.address.tolist()])
    return System(**members)
