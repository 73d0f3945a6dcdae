"""Threads that take runs one after the other until all are done."""

import os
from collections.abc import Callable, Mapping
from copy import copy
from itertools import count
from threading import Event, Lock, Thread
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.explore.ensembles.member import Copies, Course, Form
from sebody.explore.ensembles.outcome import Outcome
from sebody.explore.ensembles.outputs import Output
from sebody.explore.ensembles.start_values import Image
from sebody.runs.simulation import Simulation

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
    """

    def __init__(self, template: Simulation, image: Image, values: Mapping[str, Any],
                 outputs: Mapping[str, Output], forms: Mapping[str, Form], last: int,
                 outcome: Outcome, lock: Lock):
        self.template, self.image, self.values = template, image, values
        self.outputs, self.forms, self.last, self.outcome = outputs, forms, last, outcome
        self._next, self._stop, self._lock = count(), Event(), lock
        self._done, self._error = 0, None
        self._changes = self._differences() if self.image.linear else None

    def go(self, threads: int, progress: Callable[[float], None] | None) -> None:
        """Do all runs; Ctrl-C ends them, and the outcome says so."""
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
        """Of a thread: take runs until none is left."""
        try:
            copies = Copies(self.image) if self.image.linear else None
            for run in self._next:
                if run >= self.outcome.runs or self._stop.is_set():
                    return
                self._run(run, copies)
                self._done += 1
        except Exception as error:      # of the program: raised by the thread that waits
            self._error = error
            self._stop.set()

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
        for name, value in course.values().items():
            if value is None:
                continue
            place = self.outcome.values[name][run]
            if self.outputs[name].kind == "history":
                place[:len(value)] = value
            else:
                self.outcome.values[name][run] = value

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


def processors() -> int:
    """How many threads pay."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
