"""Runs of an ensemble eight at a time: the arrays of a thread, and what its members give."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from sebody.contract.counts import MEMBERS, whole_vectors
from sebody.contract.layout import AT_CONSTANTS, RECORD_T
from sebody.engine.lanes import loop, samples
from sebody.engine.lanes.apart import GAVE_UP, RUNS
from sebody.engine.lanes.arrays import Columns, Scratch, empty, fill, in_lanes, numbers
from sebody.engine.system import System
from sebody.explore.ensembles.apart import address_of_loop, new_apart
from sebody.explore.ensembles.matrices import alone, carried, places, together
from sebody.explore.ensembles.member import Copies, Course, Form
from sebody.explore.ensembles.member_rows import Rows, new_table, with_places
from sebody.explore.ensembles.outputs import Folds, Output
from sebody.explore.ensembles.shared_constants import (
    kernels_of_batches,
    own_parts,
    own_places,
    packed_rows,
    straight_matrices,
    varied_numbers,
)
from sebody.explore.ensembles.start_values import Image
from sebody.kernels.lanes.kernel import address_in_lanes, module_in_lanes
from sebody.kernels.lanes.straight import (
    write_address,
    write_matrix_address,
    write_shared_address,
)

MOST_NUMBERS = 8_000        # of recorded states at a time: they stay in the processor's cache
MOST_STEPS = 20_000         # until a thread looks whether it is to stop: tenths of a second


class Lanes:
    """The arrays of a thread for eight members.

    Parameters
    ----------
    copies : Copies
        Where members begin, one after the other.
    outputs : mapping
        What is kept.
    forms : mapping
        How each quantity is read.
    last : int
        Last step of the grid.

    Attributes
    ----------
    ended : bool
        Whether these were run to their end; False if they were stopped before.
    """

    def __init__(self, copies: Copies, outputs: Mapping[str, Output], forms: Mapping[str, Form],
                 last: int):
        self.copies = copies
        image, one = copies.image, copies.image.template
        buffer = empty(image.offsets.size)
        self._numbers = numbers(buffer)
        self.system = in_lanes(one.system, image.offsets, buffer)
        self._shared, self._pointed = self._write_constants()
        table = new_table(buffer, copies.floats, one.state.energy.size)
        rows = with_places(image, table)
        self.system = _with_kernels(self.system, image, self._shared, rows)
        self.state = in_lanes(one.state, image.offsets, buffer)
        self._scratch = Scratch(frames=empty(one.state.frames.size),
                                T=empty(one.state.T.size), moved=empty(one.state.moved.size),
                                unmoved=empty(one.state.g.size), table=table, kept=rows.kept)
        own = np.concatenate([image.lines.slots.astype(np.int64), carried(image)])
        self._apart, self._runs_apart = new_apart(
            (one.system, one.state), image.offsets, own, self._numbers, self.state,
            address_of_loop(one.system, one.state, copies.scheme))
        self._alone = alone(copies, self._numbers)
        self._together = together(image, self.system, self.state, self._scratch.frames)
        if copies.sampling.samples:
            self._apart.routines[1] = samples.address((self.system, self.state, self._scratch,
                                                       self._alone, self._apart))
        self._places = self._own_places()
        columns = _columns(forms, one.state.now.size)
        self._forms = {name: form if form.columns is None else form._replace(
            columns=np.searchsorted(columns, form.columns)) for name, form in forms.items()}
        self._stretch = max(1, min(last // one.every, MOST_NUMBERS // len(columns)))
        rows = (self._stretch + 1, len(columns))
        self._record = Columns(places=columns, rows=empty(*rows), every=np.array([one.every]))
        self._table, self._rows = numbers(self._record.rows), np.empty(rows)
        self._last, self._every, self._begun = last, one.every, {}
        # scalars by name: looked up once, since a look-up out of a cold cache takes microseconds
        self._reason = self.state.control["reason"]
        self._recorded = _scalar(self.state.control, "recorded")
        self._time = _scalar(self.state.clock, "time")
        self._changes: NDArray          # of the members that have begun
        self._evaluated = not all(form.kinematic for form in forms.values())
        self._folds = {name: Folds(one, forms[one.quantity].shape,
                                   self._forms[one.quantity].columns, MEMBERS)
                       for name, one in outputs.items()
                       if one.kind != "history" and forms[one.quantity].columns is not None}
        self._others = {name: one for name, one in outputs.items() if name not in self._folds}
        self._courses: list[Course] = []
        self.ended = False

    def _write_constants(self) -> tuple[NDArray, list]:
        """Write straight code of all bodies.

        Returns
        -------
        shared : ndarray
            Constants of the model as built, for bodies whose constants members share.
        pointed : list
            What the addresses among these and other constants lead to.
        """
        image = self.copies.image
        first, shared = image.offsets.of(image.template.system.constants), own_parts(image)
        varied, kept, codes = varied_numbers(image), {}, []
        floats = np.where(varied & (image.floats == 0.0), 1.0, image.floats)    # zero in some alone
        numbers_of_all = floats[first].copy()
        for batch, place in packed_rows(image):
            given = floats[place], varied[place], self._numbers[place]
            if batch not in shared:
                codes.append(write_address(*given))
            elif place.start not in kept:       # bodies that are alike have one row
                own = numbers_of_all[place.start - first.start:place.stop - first.start]
                kept[place.start] = write_shared_address(own, *given[1:])
        for place, rows in straight_matrices(image):
            if place.start not in kept:
                own = numbers_of_all[place.start - first.start:place.stop - first.start]
                kept[place.start] = write_matrix_address(
                    own.reshape(-1, whole_vectors(rows))[:, :rows].T, own)
        for place in own_places(image):
            numbers_of_all[place.start - first.start:][:1].view(np.int64)[0] = (
                self._numbers[place].ctypes.data)
        return numbers_of_all, [*codes, *kept.values()]

    def _own_places(self) -> NDArray:
        """Places in the buffer of what members begin with: parameters, and their state."""
        image, state = self.copies.image, self.copies.image.template.state
        return places(image, state.now, state.aux, state.changes, state.fitted, state.fit,
                       state.q_start, state.loads, state.loads_old, state.acting,
                       state.coefficients, state.frames_old, state.q_old, state.aux_old,
                       state.last_correction, state.last_change, state.spare, state.memory)

    def begin(self, changes: NDArray) -> NDArray:
        """Begin some runs, one in a lane; returns which have begun. The others are to be run alone.

        Parameters
        ----------
        changes : (runs, components)
            As of `Copies.begin`, at most as many as there are lanes.
        """
        begun = self.copies.begin_together(changes, self._places, self._numbers)
        self._changes = changes[begun]
        if not self._begun and begun.any():
            self._keep_begun()
        return begun

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
        self._courses = [Course(self.copies, self._every, self._others, self._forms)
                         for _ in range(count if self._others else 0)]
        if count < MEMBERS:         # lanes without a member: another one's numbers
            self._numbers[self._places, count:] = self._numbers[self._places, :1]
        self._begin_samples()
        self._reason[:count], self._reason[count:] = RUNS, GAVE_UP
        every, reached = self._every, 0
        while reached < self._last:
            reached = min(self._last, (reached // every + self._stretch) * every,
                          reached + MOST_STEPS)
            self._recorded[0] = 0
            loop.advance(self.system, state, self._scratch, self._alone, self._together,
                         self._apart, self._record, self.copies.scheme, reached, self.copies.dense)
            gave_up = self._reason[:count] == GAVE_UP
            self._take_outputs((~gave_up).nonzero()[0])
            if reached < self._last and stop():
                break
        self.ended = reached == self._last
        return gave_up

    def _take_outputs(self, members: NDArray) -> None:
        """Take in recorded states: folds of all members together, all else of some members each.

        What folds take in of members that have given up is not asked for.
        """
        table, rows = self._table, self._rows[:self._recorded[0]]
        t = table[:len(rows), 0, 0].copy()
        for folds in self._folds.values():
            folds.add(t, table)
        if self._others:
            for member in members:
                if self._evaluated:         # quantities of elements: with the member's constants
                    self.copies.begin(self._changes[member])
                loop.rows_of(table, member, rows)
                self._courses[member].take(rows)

    def write(self, members: NDArray, runs: NDArray, values: Mapping[str, NDArray]) -> None:
        """Write the outputs of some members that were run last to those of all runs."""
        for name, folds in self._folds.items():
            folds.write(members, runs, values[name])
        if self._others:
            for member, run in zip(members, runs, strict=True):
                self._courses[member].write(run, values)

    def _keep_begun(self) -> None:
        """Keep the scalars and counters of a member that has begun; failed starts have others."""
        self.copies.begin(self._changes[0])
        for name in ("control", "clock", "guard"):
            record = getattr(self.state, name)
            fill(record, getattr(self.copies.state, name))
            own = record.base.view(np.uint8)        # bytes: names one by one take long
            self._begun[name] = own, own.copy()

    def _begin_samples(self) -> None:
        """Give members the arrays that samples are made with: counts, queues, parameters."""
        image, memory = self.copies.image, self.copies.image.template.state.memory
        if self._apart.routines[1]:
            own = image.offsets.of(memory)
            taken = np.concatenate([image.lines.slots, np.arange(own.start, own.stop)])
            self._apart.numbers[:, taken] = self._numbers[taken].T
            self.state.memory[:] = self._apart.numbers[0, own]

    def _begin_records(self) -> None:
        """Set scalars and counters to those of a member that has begun, the same for all."""
        for own, begun in self._begun.values():
            own[...] = begun

    @property
    def time(self) -> float:
        """Time reached."""
        return float(self._time[0])


def _scalar(record: np.record, name: str) -> NDArray:
    """The memory of a scalar that is the same for all members, (1,)."""
    kind, first = record.dtype.fields[name]
    return record.base.view(np.uint8)[first:first + kind.itemsize].view(kind)


def _columns(forms: Mapping[str, Form], count: int) -> NDArray:
    """Which numbers of a state are recorded: all, if a quantity is computed from them."""
    if any(form.columns is None for form in forms.values()):
        return np.arange(count)
    return np.unique(np.concatenate([[RECORD_T], *(form.columns for form in forms.values())]))


def _with_kernels(system: System, image: Image, constants: NDArray, rows: Rows) -> System:
    """A system that calls kernels for lanes; of bodies that share constants, with these."""
    members = {name: getattr(system, name) for name in System.__annotations__}
    members["address"] = np.array([address_in_lanes(module_in_lanes(name), own, matrices)
                                   for name, own, matrices in kernels_of_batches(image)])
    members |= {"index": rows.index, "at_index": rows.at_index, "stride": rows.stride}
    away = (constants.ctypes.data - system.constants.ctypes.data) // constants.itemsize
    for b in own_parts(image):
        first, stride = int(rows.at_index[b]), int(rows.stride[b])
        end = first + stride * int(system.count[b])
        members["index"][first + AT_CONSTANTS:end:stride] += away
    return System(**members)
