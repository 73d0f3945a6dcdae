"""Many runs of one model with other numbers, in threads."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from threading import Lock
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from sebody.assembly.equal_bodies import evaluate_alone
from sebody.basics import inputs, memory
from sebody.basics.errors import InputError
from sebody.basics.progress import showing
from sebody.engine.state import Scheme
from sebody.explore.ensembles.choice import WORTH_IT, why_one_by_one, why_parameters_part
from sebody.explore.ensembles.outcome import Outcome
from sebody.explore.ensembles.start_values import Image
from sebody.explore.ensembles.work import Work, processors
from sebody.model.model import Model
from sebody.model.summary import summary
from sebody.model.variants.copying import copied
from sebody.parameters.changes import Handle
from sebody.parameters.table import PLACES, given, handles, refused
from sebody.reduction.body import ReducedBody
from sebody.results.result import Result
from sebody.runs.fingerprint import whole
from sebody.runs.outputs import Form, Output, forms, outputs_of
from sebody.runs.simulation import Simulation
from sebody.runs.steps import whole_steps
from sebody.runs.user_faults import refuse_changed

Values = ArrayLike | Sequence[ReducedBody]


class Ensemble:
    """Many runs of a model with different numbers: built once, run in threads.

    Parameters
    ----------
    model : Model
        Is copied: what becomes of it later changes nothing here.
    h : float
        Fixed step, also the output grid [time].
    scheme : Scheme, optional
        `generalized_alpha` with rho 0.9 by default.
    output_every : int
        Every so many steps a state is recorded, from which outputs are made.
    start : Result, optional
        State at which all runs start, see `Simulation`: initial positions and rotations cannot be
        varied then.

    Raises
    ------
    InputError
        As `Simulation`.

    Examples
    --------
    >>> ensemble = Ensemble(model, h=0.01)
    >>> outcome = ensemble.run({"motor.amplitude": amplitudes, "beam.stiffness": factors},
    ...                        t_end=3.0, outputs={"tip": maximum("tip.position")})
    >>> outcome["tip"].shape
    (10000, 3)
    """

    def __init__(self, model: Model, h: float, scheme: Scheme | None = None,
                 output_every: int = 1, start: Result | None = None):
        self.model, self.scheme = cast(Model, copied(model)), scheme
        self._template = Simulation(self.model, h, scheme, output_every, start=start)
        if not why_one_by_one(self._template):      # vectors are of runs then, not of bodies
            evaluate_alone(self.model, self._template.system)
        self.h, self.every = self._template.h, self._template.every
        self._lock = Lock()         # the copy is changed for moments
        self._images: dict[tuple[str, ...], Image] = {}

    def __repr__(self) -> str:
        reason = why_one_by_one(self._template)
        how = (f"one by one: {reason}" if reason else
               "eight at a time if they are many and their parameters allow it")
        return f"<Ensemble of a {summary(self.model)}: step {self.h:.6g}; runs {how}>"

    @property
    def identity(self) -> str:
        """Hash of all that runs follow from, the same in every process."""
        return whole(self._template)

    @property
    def parameters(self) -> list[str]:
        """Names of all that can be varied; see `sebody.parameters.table`."""
        return list(handles(self.model))

    def run(self, parameters: Mapping[str, Values], t_end: float,
            outputs: Mapping[str, Output | str], threads: int | None = None,
            progress: Callable[[float], None] | bool | None = None) -> Outcome:
        """Run the model once for each set of values.

        Many runs are made eight at a time where the model allows it, see `repr` of the ensemble and
        ``sebody/explore/ensembles/README.md``. Results do not depend on the number of threads, bit
        for bit, nor on which runs are asked for together; those of few runs, which are made one by
        one, are rounded differently.

        Parameters
        ----------
        parameters : mapping
            Values by name: the first axis of each array counts the runs. ``gravity.y`` is one
            number of a parameter. Without any the model is run once, as it is.
        t_end : float
            End of all runs [time].
        outputs : mapping
            What is kept of each run, by names of your choice: a quantity (its history), or what
            `maximum`, `minimum`, `rms`, `integral`, `final` or `at_time` return.
        threads : int, optional
            By default one for each processor.
        progress : callable or bool, optional
            Called with the part of the runs that is done; True shows a bar, as of `simulate`.

        Raises
        ------
        InputError
            Before the first run: unknown names, arrays of different lengths, values that a body
            cannot have, an unknown quantity, a time that is not a multiple of the step. Runs with
            values that a builder refuses, such as limits that leave no room, fail alone.
        """
        return self._run(parameters, t_end, outputs, threads, progress)

    def part(self, parameters: Mapping[str, Values], t_end: float,
             outputs: Mapping[str, Output | str], runs: int) -> Outcome:
        """Some of the runs of a larger ensemble, in one thread: the same bits as among all.

        Parameters
        ----------
        parameters, t_end, outputs
            As of `run`.
        runs : int
            How many there are in all.

        Raises
        ------
        InputError
            As `run`.
        """
        return self._run(parameters, t_end, outputs, 1, None, runs)

    def _run(self, parameters: Mapping[str, Values], t_end: float,
             outputs: Mapping[str, Output | str], threads: int | None,
             progress: Callable[[float], None] | bool | None, of: int = 0) -> Outcome:
        """Some runs of `of` in all."""
        refuse_changed(self.model)
        threads = inputs.integer(processors() if threads is None else threads, "threads", least=1)
        found, values, runs, last, kept = self._checked(parameters, t_end, outputs)
        read = forms(self._template, kept)
        outcome = self._empty(kept, read, runs, last)
        with self._lock:
            outcome.failures |= refused(self.model, found, values, runs)
        began = time.perf_counter()
        image = self._image(tuple(parameters), found)
        few = (f"fewer than {WORTH_IT} steps in all" if max(runs, of) * last < WORTH_IT else "")
        outcome.why_one_by_one = (few or why_one_by_one(self._template)
                                  or why_parameters_part(image))
        work = Work(self._template, image, values, kept, read, last, outcome, self._lock,
                    not outcome.why_one_by_one)
        with showing(progress) as show:
            work.go(min(threads, max(runs, 1)), show)
        outcome.seconds = time.perf_counter() - began
        return outcome

    def check(self, parameters: Mapping[str, Values], t_end: float,
              outputs: Mapping[str, Output | str]) -> None:
        """Refuse what `run` would refuse, without running anything.

        Raises
        ------
        InputError
            See `run`.
        """
        *_, kept = self._checked(parameters, t_end, outputs)
        forms(self._template, kept)

    def _checked(self, parameters: Mapping[str, Values], t_end: float,
                 outputs: Mapping[str, Output | str]
                 ) -> tuple[dict[str, Handle], dict[str, Any], int, int, dict[str, Output]]:
        """Handles, values, number of runs, last step, outputs."""
        parameters = inputs.mapping(parameters, "parameters",
                                    "give a dict of names and arrays of values")
        found, values, runs = given(self.model, parameters) if parameters else ({}, {}, 1)
        if placing := [name for name in found if self._template.begun and name.endswith(PLACES)]:
            raise InputError(f"{placing[0]} cannot be varied: all runs begin at the start that was "
                             "given; leave it out, or build an ensemble without a start")
        last = whole_steps(inputs.number(t_end, "t_end", above=0), self.h)
        return found, values, runs, last, outputs_of(outputs, last * self.h)

    def _image(self, key: tuple[str, ...], found: dict[str, Handle]) -> Image:
        """Beginnings of runs that vary in these parameters, by the names that were given."""
        with self._lock:
            if key not in self._images:
                self._images[key] = Image(self._template, found)
            return self._images[key]

    def _check_memory(self, outputs: Mapping[str, Output], read: Mapping[str, Form],
                      runs: int, count: int) -> None:
        """Refuse outputs that do not fit, before they are asked for."""
        sizes = {name: 8.0 * runs * (count if one.kind == "history" else 1)
                 * (1 if one.norm else np.prod(read[one.quantity].shape, initial=1.0))
                 for name, one in outputs.items()}
        largest = max(sizes, key=sizes.get)
        memory.check(sum(sizes.values()) + 8.0 * count, f"output {largest!r} of {runs} runs of "
                     f"{count} recorded states, with the others,",
                     "keep a maximum or the like instead of a history, fewer states with "
                     "output_every, or make fewer runs at a time")

    def _empty(self, outputs: Mapping[str, Output], read: Mapping[str, Form],
               runs: int, last: int) -> Outcome:
        count = last // self.every + 1
        self._check_memory(outputs, read, runs, count)
        values = {}
        for name, one in outputs.items():
            shape = () if one.norm else read[one.quantity].shape
            values[name] = np.full((runs, *((count,) if one.kind == "history" else ()), *shape),
                                   np.nan)
        return Outcome(values, np.arange(count) * self.every * self.h, np.full(runs, np.nan))
