"""Threads that take runs one after the other until all are done."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from copy import copy
from threading import Event, Lock, Thread
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.counts import MEMBERS
from sebody.explore.ensembles.member import Copies, Course
from sebody.explore.ensembles.outcome import Outcome
from sebody.explore.ensembles.shared_constants import kernels_of_batches
from sebody.explore.ensembles.start_values import Image
from sebody.runs.outputs import Form, Output
from sebody.runs.simulation import Simulation

if TYPE_CHECKING:
    from sebody.explore.ensembles.lanes import Lanes

SHARES = 4      # at least so many are left for each thread when one takes groups
LOOK = 0.05     # seconds between looks at the threads, for progress and Ctrl-C
INTERRUPTED = "interrupted before its end"


class Work:
    """The runs of an ensemble, and where their results go.

    Parameters
    ----------
    template : Simulation
        Of the model as built.
    image : Image
        What runs begin with, and the parameters that vary.
    values : mapping
        Of the parameters, for all runs.
    outputs : mapping
        What is kept.
    forms : mapping
        How each quantity is read.
    last : int
        Last step of the grid.
    outcome : Outcome
        Is filled.
    lock : Lock
        Held while the model is changed.
    in_lanes : bool
        Whether runs are made eight at a time.
    """

    def __init__(self, template: Simulation, image: Image, values: Mapping[str, Any],
                 outputs: Mapping[str, Output], forms: Mapping[str, Form], last: int,
                 outcome: Outcome, lock: Lock, in_lanes: bool = False):
        self.template, self.image, self.values = template, image, values
        self.outputs, self.forms, self.last, self.outcome = outputs, forms, last, outcome
        self._stop, self._lock = Event(), lock
        self._done, self._error = 0, None
        self._changes = self._differences() if self.image.linear else None
        order = alike(self._changes, MEMBERS) if in_lanes else np.arange(outcome.runs)
        self._order = order[~np.isin(order, list(outcome.failures))]    # others are refused
        self._in_lanes, self._taken, self._threads = in_lanes, 0, 1

    def go(self, threads: int, progress: Callable[[float], None] | None) -> None:
        """Do all runs; Ctrl-C ends them, and the outcome says so."""
        if self._in_lanes:
            from sebody.explore.ensembles.compiling import prepare

            prepare(kernels_of_batches(self.image))
        self._threads = threads
        workers = [Thread(target=self._work, daemon=True)
                   for _ in range(threads if self.outcome.runs > 1 else 0)]
        try:
            if not workers:
                self._work()
            for worker in workers:
                worker.start()
            while any(worker.is_alive() for worker in workers):
                workers[0].join(LOOK) if workers[0].is_alive() else workers.pop(0)
                if progress:
                    progress(self._done / max(self.outcome.runs, 1))
        except KeyboardInterrupt:
            self.outcome.interrupted = True
        finally:
            self._stop.set()
            for worker in workers:
                worker.join()
        if self._error is not None:
            raise self._error
        if progress and not self.outcome.interrupted:
            progress(1.0)
        for run in np.flatnonzero(np.isnan(self.outcome.reached)):
            self.outcome.failures.setdefault(int(run), INTERRUPTED)

    def _work(self) -> None:
        """Take runs until none is left, in a thread."""
        try:
            copies = Copies(self.image) if self.image.linear else None
            lanes = self._lanes(copies)
            while len(runs := self._next_runs(lanes)):
                if self._stop.is_set():
                    return
                for run in self._run_in_lanes(runs, lanes) if lanes else runs.tolist():
                    self._run(run, copies)
                    self._done += 1
        except Exception as error:      # of the program: raised by the thread that waits
            self._error = error
            self._stop.set()

    def _next_runs(self, lanes: Lanes | None) -> NDArray:
        """Runs that no thread has taken yet; none if all are taken.

        In lanes these are several groups, at the end fewer and fewer: threads end together.
        """
        with self._lock:
            first, size = self._taken, MEMBERS if lanes else 1
            shares = (len(self._order) - first) // (SHARES * self._threads * size)
            self._taken += size * max(1, min(shares, lanes.at_once if lanes else 1))
            return self._order[first:self._taken]

    def _lanes(self, copies: Copies | None) -> Lanes | None:
        """The arrays of a thread for runs that are made eight at a time."""
        if not self._in_lanes:
            return None
        from sebody.explore.ensembles.lanes import Lanes  # imports the lanes themselves

        with self._lock:        # straight code is compiled by one thread
            return Lanes(copies, self.outputs, self.forms, self.last)

    def _run_in_lanes(self, runs: NDArray, lanes: Lanes) -> list[int]:
        """Make some runs eight at a time; returns those that are to be made alone."""
        made = (lanes.make(self._changes[runs], runs, self.outcome.values)
                if lanes.at_once > 1 else self._run_group(runs, lanes))
        done = runs[made]
        self.outcome.reached[done] = lanes.time
        if not lanes.ended:
            self.outcome.failures |= dict.fromkeys(done.tolist(), INTERRUPTED)
        with self._lock:
            self.outcome.in_lanes += len(done)
            self._done += len(done)
        return runs[~made].tolist()

    def _run_group(self, runs: NDArray, lanes: Lanes) -> NDArray:
        """Make a group, with Python where it is needed; returns which runs are made."""
        made = lanes.begin(self._changes[runs])
        begun = made.nonzero()[0]
        if len(begun):
            gave_up = lanes.run(self._stop.is_set)
            lanes.write((~gave_up).nonzero()[0], runs[begun[~gave_up]], self.outcome.values)
            made[begun[gave_up]] = False
        return made

    def _run(self, run: int, copies: Copies | None) -> None:
        try:
            begun = self._begun(run, copies)
            course = Course(begun, self.template.every, self.outputs, self.forms)
            ended = course.go(self.last, self._stop.is_set)
        except InputError as error:     # of this run: an initial state that joints do not allow
            self.outcome.failures[run] = str(error)
            return
        if not ended or course.reason:
            self.outcome.failures[run] = course.reason or INTERRUPTED
        self.outcome.reached[run] = begun.state.clock.time
        course.write(run, self.outcome.values)

    def _begun(self, run: int, copies: Copies | None) -> Copies | Simulation:
        """A run at its start: from a copy of all numbers, or of the model built anew."""
        if copies is not None and copies.begin(self._changes[run]):
            return copies
        one = self.template
        with self._lock:        # the model is changed for a moment
            try:
                for name, handle in self.image.handles.items():
                    handle.set(self.values[name][run])
                made = Simulation(one.model, one.h, one.scheme, one.every, start=one.begun)
                made.model = copy(one.model)
            finally:
                for handle in reversed(self.image.handles.values()):
                    handle.reset()
        return made

    def _differences(self) -> NDArray:
        """Values less those of the model as built, (runs, components)."""
        return np.hstack([(self.values[name] - handle.base).reshape(self.outcome.runs, -1)
                          for name, handle in self.image.handles.items()])


def alike(changes: NDArray, count: int) -> NDArray:
    """Runs in an order in which groups of some number have parameters close to each other.

    Those that are alike need about as many iterations in a step, and matrices at the same times.
    By the two parameters that vary most: stripes of the first are put in order by the second.

    Parameters
    ----------
    changes : (runs, components)
        Values of the parameters less those of the model as built.
    """
    runs, spread = len(changes), np.ptp(changes, axis=0)
    first, second = (np.argsort(-spread, kind="stable").tolist() * 2)[:2]
    order = np.argsort(changes[:, first], kind="stable")
    stripes = max(1, round(np.sqrt(runs / count)))
    ordered = [order[part[np.argsort(changes[order[part], second], kind="stable")]]
               for part in np.array_split(np.arange(runs), stripes)]
    return np.concatenate(ordered)


def processors() -> int:
    """The number of threads that pays."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
