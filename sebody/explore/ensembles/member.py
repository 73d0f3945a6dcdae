"""One run of many: a workspace of a thread, the start of a run, and what is kept of it."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import RECORD_T
from sebody.engine.loop import lead
from sebody.engine.offsets import Offsets
from sebody.engine.scalars import numbers_of, record
from sebody.engine.state import (
    ASKED,
    DONE,
    FACTORS_KEPT,
    FAILED,
    REASONS,
    Record,
    State,
)
from sebody.engine.step import write_record
from sebody.engine.system import System
from sebody.explore.ensembles import beginning
from sebody.explore.ensembles.start_values import Image
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.runs import user_faults
from sebody.runs.aid import Aid, advance
from sebody.runs.outputs import Fold, Form, Output
from sebody.runs.sampling import Sampling
from sebody.runs.simulation import Simulation

MOST_NUMBERS = 2_000_000    # of recorded states at a time in a thread: 16 MB
MOST_STEPS = 1_000_000_000  # in one call of the loop
CHUNK = 0.2                 # seconds in the loop until a thread looks whether it is to stop
Stop = Callable[[], bool]


class Copies:
    """Runs that begin with a copy of all numbers: the arrays of one thread."""

    def __init__(self, image: Image):
        one = image.template
        self.image, self.dense = image, one.dense
        self.floats = image.floats.copy()
        self.system, self.state = arrays_of_run(one.system, one.state, image.offsets,
                                                self.floats)
        self.sampling = Sampling(one.model, one.numbering, self.system, self.state)
        self.aid = Aid.of(self.system, self.state, self.sampling.read_sensors)
        self.model, self.numbering, self.scheme = one.model, one.numbering, one.scheme
        self.given = self._beginning()
        self._record: Record | None = None
        self.none = Record.of(self.state, 0)

    def record(self, rows: int, every: int) -> Record:
        """Room for recorded states, the same for all runs: fresh memory costs as much as a start.
        """
        if self._record is None or self._record.rows.shape[0] != rows:
            self._record = Record.of(self.state, rows, every)
        return self._record

    def begin(self, change: NDArray) -> bool:
        """Begin a run; False if Python's own start is needed.

        Parameters
        ----------
        change : (components,)
            Values of the parameters less those of the model as built.

        Raises
        ------
        InputError
            The initial state cannot be evaluated.
        """
        system, state = self.system, self.state
        beginning.begin(system, state, self.given, change)
        code = advance(self, self.none, 0, 0)
        if code == DONE and self.sampling.begin():      # after its samples
            code = advance(self, self.none, 0, 0)
        if code == FAILED and system.regularized[0]:
            return False        # where constraints contradict each other, and Python can tell which
        if code == FAILED:
            raise InputError("the initial state has no accelerations: "
                             f"{REASONS[int(state.control.reason)]}")
        beginning.end(state, self.given)
        return code == DONE

    @property
    def starts_in_python(self) -> bool:
        """Tell whether starts have Python between them: for row exchanges, or for samples."""
        return bool(self.system.massless[0]) or bool(self.sampling.samples)

    def begin_together(self, changes: NDArray, places: NDArray, lanes: NDArray) -> NDArray:
        """Begin some runs, those that have begun in lanes; returns which these are.

        Parameters
        ----------
        changes : (runs, components)
            As of `begin`.
        places : (k,)
            What members begin with in the buffer of all numbers.
        lanes : (size, members)
            Gets it.
        """
        if self.starts_in_python:
            return self._begin_each(changes, places, lanes)
        codes = beginning.begin_together(self.system, self.state, self.given, changes,
                                         lead(self.scheme), self.dense, places, lanes)
        return codes == DONE

    def _begin_each(self, changes: NDArray, places: NDArray, lanes: NDArray) -> NDArray:
        """The same, run by run."""
        begun = np.zeros(len(changes), dtype=bool)
        for run, change in enumerate(changes):
            try:
                begun[run] = self.begin(change)
            except InputError:      # said where the run is made alone
                continue
            if begun[run]:
                lanes[places, begun.sum() - 1] = self.floats[places]
        return begun

    def _kept_places(self) -> NDArray:
        """Places of what elements keep in `State.frames_old`, in the buffer of all numbers."""
        places = [k for own in self.numbering.memories.values() for k in own]
        first = self.image.offsets.of(self.image.template.state.frames_old).start
        return first + np.array(places, dtype=np.int64)

    def _copied(self) -> NDArray:
        """First and last places of the numbers that runs change, in the buffer of all numbers.

        Neither constants nor the scratch memory of kernels, which are the most.
        """
        one, offsets = self.image.template, self.image.offsets
        left = sorted((own.start, own.stop) for own in map(
            offsets.of, (one.system.constants, one.state.work)))
        ends = [0, *(end for part in left for end in part), offsets.size]
        return np.array(ends, dtype=np.int64).reshape(-1, 2)

    def _beginning(self) -> beginning.Beginning:
        """Beginning of runs; scalars and flags are not in `floats`."""
        lines, state = self.image.lines, self.state
        whole = {name: numbers_of(getattr(state, name)) for name in ("control", "clock", "guard")}
        return beginning.Beginning(
            model=self.image.floats, floats=self.floats, copied=self._copied(),
            restart=np.array([FACTORS_KEPT if self.image.factored else ASKED]),
            slots=lines.slots.astype(np.int64),
            ends=lines.slopes.indptr.astype(np.int64),
            components=lines.slopes.indices.astype(np.int64), slopes=lines.slopes.data,
            kept=self._kept_places(),
            **whole, **{f"{name}_built": own.copy() for name, own in whole.items()})


def arrays_of_run(system: System, state: State, offsets: Offsets, floats: NDArray
                  ) -> tuple[System, State]:
    """System and state of a run, with its numbers in a buffer that gets those given."""
    return (replace(offsets.packed(system, floats), aid=np.zeros_like(system.aid)),
            _with_own_integers(offsets.packed(state, floats)))


def _with_own_integers(state: State) -> State:
    """The same state with scalars and flags of its own: threads write to them."""
    own = {name: value if value.dtype == np.float64 else
           record(value.dtype, numbers_of(value).copy()) if isinstance(value, np.record) else
           value.copy()
           for name, value in ((f, getattr(state, f)) for f in State.__annotations__)}
    return State(**own)


class Course:
    """The steps of a run that has begun, and its outputs.

    Parameters
    ----------
    run : Copies or Simulation
        With system, state, numbering and scheme.
    every : int
        Grid steps between recorded states.
    outputs : mapping
        What is kept.
    forms : mapping
        Of every quantity.
    """

    def __init__(self, run: Copies | Simulation, every: int, outputs: Mapping[str, Output],
                 forms: Mapping[str, Form]):
        self.run, self.every, self.outputs, self.forms = run, every, outputs, forms
        self.folds = {name: Fold(o, forms[o.quantity].shape) for name, o in outputs.items()
                      if o.kind != "history"}
        self.histories: dict[str, list[NDArray]] = {name: [] for name, o in outputs.items()
                                                    if o.kind == "history"}
        self.reason = ""

    def go(self, last: int, stop: Stop) -> bool:
        """Run to a grid step, or until a step fails; False if it was stopped before."""
        run, state = self.run, self.run.state
        rows = max(2, min(last // self.every + 1, MOST_NUMBERS // state.now.size))
        record = run.record(rows, self.every) if isinstance(run, Copies) else Record.of(
            state, rows, self.every)
        state.control.recorded = 0
        write_record(state, record)
        reached, code = 0, DONE
        while reached < last and code == DONE:
            room = rows - int(state.control.recorded)
            reached = min(last, (reached // self.every + room) * self.every)
            code = self._advance(record, reached, stop)
            self.take(record.rows[:state.control.recorded])
            state.control.recorded = 0
        if code == FAILED:
            clock = state.clock
            reason = (user_faults.fault(run.model, clock.time, clock.time + clock.step)
                      or REASONS[int(state.control.reason)])
            self.reason = f"stopped at t = {clock.time:.6g}: {reason}"
        return code in (DONE, FAILED)

    def _advance(self, record: Record, last: int, stop: Stop) -> int:
        chunk = 1000
        while True:
            began = time.perf_counter()
            code = advance(self.run, record, last, chunk)
            if code in (DONE, FAILED) or stop():
                return code
            chunk = max(1, int(chunk * min(8.0, CHUNK / max(time.perf_counter() - began, 1e-9))))
            chunk = min(chunk, MOST_STEPS)

    def take(self, rows: NDArray) -> None:
        """Read the outputs of recorded states."""
        if not len(rows):       # the last steps of a run reach no recorded one
            return
        t, found = rows[:, RECORD_T].copy(), {}
        for name, output in self.outputs.items():
            quantity = output.quantity
            form = self.forms[quantity]
            if form.columns is not None:
                if name in self.folds:
                    self.folds[name].add_columns(t, rows, form.columns)
                else:
                    self.histories[name].append(rows[:, form.columns].reshape(-1, *form.shape))
                continue
            if quantity not in found:
                found[quantity] = look_up(self._recording(rows, quantity), quantity)
            if name in self.folds:
                self.folds[name].add(t, found[quantity])
            else:
                self.histories[name].append(np.array(found[quantity]))

    def _recording(self, rows: NDArray, quantity: str) -> Recording:
        run, kinematic = self.run, self.forms[quantity].kinematic
        return Recording(run.model, run.numbering, None if kinematic else run.system,
                         None if kinematic else run.state, rows, 0.0)

    def write(self, run: int, values: Mapping[str, NDArray]) -> None:
        """Write the outputs to those of all runs, where there are values."""
        for name, fold in self.folds.items():
            if (value := fold.value()) is not None:
                values[name][run] = value
        for name, parts in self.histories.items():
            history = np.concatenate(parts)
            values[name][run, :len(history)] = history
