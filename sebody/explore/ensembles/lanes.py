"""Runs of an ensemble eight at a time: the arrays of a thread, and what its members give."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from sebody.contract.counts import whole_vectors
from sebody.contract.layout import AT_CONSTANTS, RECORD_T
from sebody.contract.read_numbers import NOW
from sebody.engine.lanes import loop, samples
from sebody.engine.lanes.apart import GAVE_UP
from sebody.engine.lanes.arrays import Columns, Scratch, empty, fill, in_lanes, numbers
from sebody.engine.loop import lead
from sebody.engine.system import System
from sebody.explore.ensembles import groups
from sebody.explore.ensembles.apart import RECORDS, address_of_loop, new_apart
from sebody.explore.ensembles.groups import Groups, make, new_groups, run_on
from sebody.explore.ensembles.matrices import carried, of_matrices, places, together
from sebody.explore.ensembles.member import Copies, Course
from sebody.explore.ensembles.member_rows import Rows, new_table, with_places
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
from sebody.results.tapes import States
from sebody.runs.folds import Folds, write_all
from sebody.runs.outputs import Form, Output, folds_of

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
    """

    def __init__(self, copies: Copies, outputs: Mapping[str, Output], forms: Mapping[str, Form],
                 last: int):
        self.copies, self._last, self._reached = copies, last, 0
        image = copies.image
        buffer = empty(image.offsets.size)
        self._numbers = numbers(buffer)
        self._set_outputs(outputs, forms)
        self._groups, self._kept_alive = self._new_groups(buffer)
        self._reason = self._groups.state.control["reason"]     # looked up once: it takes long
        self._rows = np.empty((len(self._record.rows), len(self._columns)))
        self._has_begun = False         # a member: then its scalars are known
        self._changes: NDArray          # of the members that have begun
        self._courses: list[Course] = []

    def _set_outputs(self, outputs: Mapping[str, Output], forms: Mapping[str, Form]) -> None:
        """Tell outputs that are folds of recorded numbers, or of what a tape gives, from others."""
        one = self.copies.image.template
        folded = {name: o for name, o in outputs.items()
                  if o.kind != "history" and (forms[o.quantity].columns is not None
                                              or forms[o.quantity].in_lanes)}
        self._folded, self._others = folded, {
            name: o for name, o in outputs.items() if name not in folded}
        self._forms, self._evaluated = forms, not all(
            forms[o.quantity].kinematic for o in self._others.values())
        states, self._tape_columns = States(one.model, one.numbering, one.system, one.state), {}
        for o in folded.values():
            if forms[o.quantity].columns is None and o.quantity not in self._tape_columns:
                first = len(states.tape.outputs)
                states.put(o.quantity)
                self._tape_columns[o.quantity] = np.arange(first, len(states.tape.outputs))
        self._tape, count = states.reading(), one.state.now.size
        reads = self._tape.inputs
        self._read_now = reads[reads[:, 1] == NOW]
        self._read_else = reads[reads[:, 1] != NOW]
        own = [form.columns for form in forms.values() if form.columns is not None]
        self._columns = np.arange(count) if self._others else np.unique(np.concatenate(
            [[RECORD_T], self._read_now[:, 2], *own]))

    def _new_groups(self, buffer: NDArray) -> tuple[Groups, list]:
        """The arrays of all members, and what else their addresses lead to."""
        copies, image, one = self.copies, self.copies.image, self.copies.image.template
        system = in_lanes(one.system, image.offsets, buffer)
        shared, pointed = self._write_constants()
        table = new_table(buffer, copies.floats, one.state.energy.size)
        rows = with_places(image, table)
        system = _with_kernels(system, image, shared, rows)
        state = in_lanes(one.state, image.offsets, buffer)
        scratch = Scratch(frames=empty(one.state.frames.size), T=empty(one.state.T.size),
                          unmoved=empty(one.state.g.size),
                          table=table, kept=rows.kept)
        own = np.concatenate([image.lines.slots.astype(np.int64), carried(image)])
        apart, self._aid, runs_apart = new_apart(
            (one.system, one.state), image.offsets, own, self._numbers, state,
            address_of_loop(one.system, one.state, copies.scheme), of_matrices(image))
        self._record = record = self._new_record()
        if copies.sampling.samples:
            apart.routines[1] = samples.address((system, state, scratch, apart))
        given_to_loop = (system, state, scratch,
                         together(image, system, state, scratch.frames), apart, record)
        found = new_groups(groups.address_of_loop(given_to_loop, copies.scheme), given_to_loop,
                           (copies.system, copies.state, copies.given), self._own_places(),
                           self._new_folds())
        return found, [shared, pointed, runs_apart]

    def _new_record(self) -> Columns:
        """Room for recorded states."""
        one, tape = self.copies.image.template, self._tape
        every, width = one.every, len(self._columns) + len(self._read_else)
        stretch = max(1, min(self._last // every, MOST_NUMBERS // width))
        return Columns(
            places=self._columns, rows=empty(stretch + 1, width), every=np.array([every]),
            evaluated=np.ascontiguousarray(self._read_else[:, 1:]), batches=tape.batches,
            needs=tape.needs,
            shown=np.arange(one.state.now.size) if len(self._read_else) else self._columns,
            loads=empty(one.state.loads.size))

    def _new_folds(self) -> Folds:
        """Room for what outputs are made of."""
        outputs = list(self._folded.values())
        read = [self._forms[one.quantity] for one in outputs]
        columns = [self._tape_columns[one.quantity] if form.columns is None else
                   np.searchsorted(self._columns, form.columns)
                   for one, form in zip(outputs, read, strict=True)]
        now = np.searchsorted(self._columns, self._read_now[:, 2])
        further = len(self._columns) + np.arange(len(self._read_else))
        inputs = np.column_stack([np.concatenate([self._read_now, self._read_else])[:, 0],
                                  np.concatenate([now, further])])
        return folds_of(outputs, [form.shape for form in read], columns,
                        [form.columns is None for form in read], self._tape,
                        np.ascontiguousarray(inputs), len(self._record.rows))

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

    @property
    def at_once(self) -> int:
        """The number of groups that `make` makes in one call; 1 if `begin` and `run` do."""
        waits = (self._others or self.copies.starts_in_python or not self._has_begun)
        return 1 if waits else max(1, MOST_STEPS // self._last)

    def make(self, changes: NDArray, runs: NDArray, values: Mapping[str, NDArray]) -> NDArray:
        """Make runs in groups of eight, one group after the other, and write their outputs.

        Returns
        -------
        (runs,) bools
            Which are made. The others are to be run alone.
        """
        copies, made = self.copies, np.zeros(len(runs), dtype=bool)
        found = self._no_values(len(runs))
        make(self._groups, changes, copies.scheme, lead(copies.scheme), copies.dense, self._last,
             found, made)
        self._aid.check()
        self._write_folded(found[made], runs[made], values)
        self._reached = self._last
        return made

    def begin(self, changes: NDArray) -> NDArray:
        """Begin some runs, one in a lane; returns which have begun. The others are to be run alone.

        Parameters
        ----------
        changes : (runs, components)
            As of `Copies.begin`, at most as many as there are lanes.
        """
        begun = self.copies.begin_together(changes, self._groups.places, self._numbers)
        self._changes = changes[begun]
        if not self._has_begun and begun.any():
            self._keep_begun()
        return begun

    def run(self, stop: Callable[[], bool]) -> NDArray:
        """Run the members that have begun to their end, and take in their outputs.

        Returns
        -------
        ndarray
            Which of them gave up, (members,): they are to be run alone.
        """
        copies, count = self.copies, len(self._changes)
        self._courses = [Course(copies, copies.image.template.every, self._others, self._forms)
                         for _ in range(count if self._others else 0)]
        self._begin_samples()
        reached = 0
        while reached < self._last:
            reached = run_on(self._groups, count, copies.scheme, copies.dense, reached,
                             min(self._last, reached + MOST_STEPS))
            self._aid.check()
            gave_up = self._reason[:count] == GAVE_UP
            if self._others:
                self._take_others((~gave_up).nonzero()[0])
            if reached < self._last and stop():
                break
        self._reached = reached
        return gave_up

    def _take_others(self, members: NDArray) -> None:
        """Take in recorded states of some members, for outputs that are no folds of them."""
        rows = self._rows[:self._groups.state.control.recorded]
        for member in members:
            if self._evaluated:         # quantities of elements: with the member's constants
                self.copies.begin(self._changes[member])
            loop.rows_of(self._groups.table, member, rows)
            self._courses[member].take(rows)

    def write(self, members: NDArray, runs: NDArray, values: Mapping[str, NDArray]) -> None:
        """Write the outputs of some members that were run last to those of all runs."""
        found = self._no_values(len(members))
        for member, own in zip(members, found, strict=True):
            write_all(self._groups.folds, member, own)
        self._write_folded(found, runs, values)
        if self._others:
            for member, run in zip(members, runs, strict=True):
                self._courses[member].write(run, values)

    def _no_values(self, runs: int) -> NDArray:
        """Outputs that are folds, of runs that have none yet."""
        return np.full((runs, len(self._groups.folds.kept)), np.nan)

    def _write_folded(self, found: NDArray, runs: NDArray, values: Mapping[str, NDArray]) -> None:
        """Write outputs that are folds, (runs, values), to those of all runs."""
        ends = self._groups.folds.ends[:, 1]
        for name, first, end in zip(self._folded, ends, ends[1:], strict=False):
            values[name][runs] = found[:, first:end].reshape(len(runs), *values[name].shape[1:])

    def _keep_begun(self) -> None:
        """Keep the scalars and counters of a member that has begun; failed starts have others."""
        self.copies.begin(self._changes[0])
        for name in RECORDS:
            fill(getattr(self._groups.state, name), getattr(self.copies.state, name))
        self._groups.begun[:] = np.concatenate([getattr(self._groups, name) for name in RECORDS])
        self._has_begun = True

    def _begin_samples(self) -> None:
        """Give members the arrays that samples are made with: counts, queues, parameters."""
        image, memory = self.copies.image, self.copies.image.template.state.memory
        apart = self._groups.apart
        if apart.routines[1]:
            own = image.offsets.of(memory)
            taken = np.concatenate([image.lines.slots, np.arange(own.start, own.stop)])
            apart.numbers[:, taken] = self._numbers[taken].T
            self._groups.state.memory[:] = apart.numbers[0, own]

    @property
    def ended(self) -> bool:
        """Tell if the runs that were made last were made to their end, and not stopped before."""
        return self._reached == self._last

    @property
    def time(self) -> float:
        """Time that the runs reached that were made last."""
        return float(self._reached * self._groups.state.clock.step)


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
