"""Simulations: a consistent initial state, then calls of the compiled loop."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import nullcontext

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.allocation import allocate
from sebody.assembly.build import build, reads_tangents
from sebody.assembly.close_rows import Grid
from sebody.basics import inputs
from sebody.basics.errors import InputError, Interrupted, SimulationError
from sebody.basics.progress import showing
from sebody.engine.routines import addresses
from sebody.engine.state import ASKED, CHUNK, DONE, FAILED, Record, Scheme, State
from sebody.engine.system import System
from sebody.model.bushings import refuse_tables
from sebody.model.control_order import misspelt
from sebody.model.model import Model
from sebody.model.summary import summary
from sebody.results.recording import Start
from sebody.results.result import Result
from sebody.runs import user_faults
from sebody.runs.aid import Aid, advance
from sebody.runs.failures import explained, of_start
from sebody.runs.first_run import prepare
from sebody.runs.given_start import energy_lost, take
from sebody.runs.initial_state import begin, hold
from sebody.runs.initial_velocities import refuse_contradicted
from sebody.runs.limits.rope_contact import off_sheaves
from sebody.runs.limits.watch import Watch
from sebody.runs.planning import Plan, StepLog
from sebody.runs.pulses import divided, unseen, untold
from sebody.runs.recorded_rows import RecordedRows
from sebody.runs.sampling import Sampling
from sebody.runs.schemes import checked, fitting
from sebody.runs.start_remarks import kicks, start_remarks
from sebody.runs.steps import MOST_STEPS, OFF_GRID, last_step
from sebody.runs.teeth import Gears, teeth_remarks
from sebody.runs.threads import IN_ORDER, TOO_SMALL, checked_threads, helping, worth_help
from sebody.runs.tolerance import UNSIZED, Tolerance, given
from sebody.runs.variable_steps import FIRST_STEP, begin_steps, natural_step

LOOK = 0.2              # seconds in the loop until it returns to Python, which sees Ctrl-C then
FIRST_CHUNK = 1         # steps before the first return
GROWTH = 8.0            # largest factor from one chunk of steps to the next
FEW = 64                # most steps of a short piece of a run


class Simulation:
    """A run that is computed piece by piece: ``run_to(t)`` as often as wanted.

    Parameters
    ----------
    model : Model
    h : float
        Time step, also the output grid [time].
    scheme : Scheme, optional
        `generalized_alpha` with rho 0.9 by default; of index 2 where joints are on paths.
    output_every : int
        Keep every so many steps.
    tolerance : Tolerance, optional
        Allowed error of a step. With a tolerance, step lengths are chosen, steps end at corners of
        load tables, and `h` is only the output grid, on which the state is interpolated. Errors of
        many steps add up: see `simulate_within` for the error of the whole run.
    start : Result, optional
        State to start from in place of the model as built: of an `equilibrium`, at which nothing
        rings, or the end of a run. Initial velocities that the model gives stay. Of another model
        what has the same names is taken over, and velocities that joints of this one do not allow
        are changed by the impulse that conserves momentum; `summary` lists what was not taken over.
    threads : int
        Threads that share the steps of a large model, at most as many as there are free cores.
        Results are the same for any number of them, bit for bit. Models with less than 1000
        unknowns are too small to share: a warning says so.
    plan : Plan, optional
        Of the steps of a run with a tolerance, from one over the same time: see `simulate`. By
        default they are chosen one by one, by their errors.

    Attributes
    ----------
    log : StepLog
        Steps of a run whose plan says to log them.
    begun : Result or None
        The state that was given to start from.
    start : Start
        Initial velocities that were solved for, redundant constraints.
    held : bool
        Whether friction holds something at rest at the start.

    Raises
    ------
    InputError
        Bad step or tolerance, functions that read what has changed since they were compiled,
        singular mass, contradicting constraints, an initial state that
        violates them, or variable steps with constraints of index 3.
    """

    gives_loads_to_steps = True     # see `sebody.assembly.close_rows`

    def __init__(self, model: Model, h: float, scheme: Scheme | None = None,
                 output_every: int = 1, tolerance: Tolerance | None = None,
                 start: Result | None = None, threads: int = 1, plan: Plan | None = None):
        self.model = inputs.instance(model, "model", Model, "give a sebody.Model")
        self.h = inputs.number(h, "the time step", above=0)
        self.every = inputs.integer(output_every, "output_every", least=1, most=int(MOST_STEPS),
                                    remedy="give a whole number of steps >= 1")
        if scheme is not None:
            checked(scheme)
        tolerance = given(tolerance)
        threads = checked_threads(threads)
        user_faults.refuse_changed(model)
        if self.gives_loads_to_steps:
            refuse_tables(model)
        prepare([model])
        self.grid = Grid(self.h, tolerance is None) if self.gives_loads_to_steps else None
        self.system, self.numbering = build(model, threads, self.grid)
        self.scheme = fitting(scheme, bool(self.numbering.multipliers), tolerance is not None,
                              bool(model.ways()))
        self.dense = not self.system.slot_unknowns.size     # no elimination by blocks
        self.plan, self.log = plan or Plan(), StepLog()
        self.state = allocate(model, self.system, self.numbering, self.h, self.dense,
                              self.plan.steps, self.plan.logged)
        self.rows = RecordedRows(self.state, self.every)
        self.watch = Watch()
        self.watch.start(model.bodies, self.scheme, bool(self.numbering.multipliers))
        for name, message in misspelt(model).items():
            self.watch.say(f"signal {name}", message)
        if threads > 1 and not self.system.shared.mail.size:
            self.watch.say("threads", (IN_ORDER if reads_tangents(model) else TOO_SMALL).format(
                threads, self.numbering.free))
        self.seconds = 0.0
        self.failure = ""
        self.sampling = Sampling(model, self.numbering, self.system, self.state)
        self.aid = Aid.of(self.system, self.state, self.sampling.read_sensors)
        user_faults.forget(model)
        self.begun, self.tolerance = start, tolerance
        self._unjudged = any("teeth" in load.tuned for load in model.loads)
        self._begin()
        self.rows.begin()

    def _begin(self) -> None:
        """Find the initial state: velocities, accelerations, what sticks, the first step."""
        model, numbering, state = self.model, self.numbering, self.state
        if self.tolerance is not None:
            state.clock.natural = natural_step(model, self.h, self.tolerance, self.plan)
        untaken = () if self.begun is None else take(model, numbering, state, self.begun)
        before = state.v.copy()
        self.start: Start = begin(model, self.system, numbering, state)
        if untaken:
            self.start = self.start._replace(
                untaken=untaken, lost=energy_lost(self.system, numbering, state, before))
        refuse_contradicted(model, numbering, state)
        if self.begun is None:
            for key, message in start_remarks(model, numbering, state).items():
                self.watch.say(key, message)
        self._accelerate()
        self.held = hold(model, self.system, numbering, state, self._accelerate_again)
        if self.tolerance is not None and not begin_steps(
                model, self.system, numbering, state, self.h, self.tolerance, self.plan):
            self.watch.say("unsized", UNSIZED)
        self.sampling.check(self.h, self.tolerance is None)
        if self.sampling.begin():
            self._accelerate()
        if self.begun is None:
            for key, message in kicks(model, self.sampling.read).items():
                self.watch.say(key, message)

    def _judge_teeth(self) -> None:
        """Say once what teeth do to vibrations whose stiffness was not given."""
        if self._unjudged:
            gears = Gears(self.model, self.numbering, self.system, self.state)
            for key, message in teeth_remarks(gears).items():
                self.watch.say(key, message)
        self._unjudged = False

    def __repr__(self) -> str:
        return (f"<Simulation of a {summary(self.model)}: {self.numbering.free} unknowns, step "
                f"{self.h:.6g}, t = {self.time:.6g}>")

    @property
    def arrays_of_loop(self) -> tuple[System, State]:
        """System and state, as `Result` has them."""
        return self.system, self.state

    @property
    def time(self) -> float:
        """Time reached."""
        return float(self.state.clock["time"])

    def run_to(self, t_end: float,
               progress: Callable[[float], None] | bool | None = None) -> Simulation:
        """Advance to the grid step nearest to `t_end`.

        Parameters
        ----------
        progress : callable or bool, optional
            Called several times a second with the part of the run that is done. What it raises
            stops the run between two steps; a later call continues from there. True shows a bar on
            a terminal or in a notebook once the run takes longer than a second.

        Raises
        ------
        InputError
            A time that is past, or a function of a load or drive that reads a value which has
            changed since it was compiled.
        SimulationError
            When a step does not converge however small; what was computed is kept, also in the
            error's `result`.
        Interrupted
            Ctrl-C, or a `KeyboardInterrupt` of `progress`; what was computed is kept likewise.
        """
        if not self._unjudged and progress is None and self._piece(t_end):
            return self
        last = self.last_step(t_end)
        self._look_before(t_end)
        record = self.rows.record_until(last)
        self.sampling.stop_at(t_end)
        code = CHUNK
        try:
            with showing(progress, t_end) as show, helping(self.system, self.state):
                code = self._advance(record, last, t_end, show)
        except KeyboardInterrupt:
            pass                        # the rows come first
        finally:
            self.rows.keep(record)
        self._look_after(code == FAILED, code != DONE)
        return self

    def last_step(self, t_end: float) -> int:
        """The grid step nearest to a time; the run says it if the time is off the grid.

        Raises
        ------
        InputError
            A time that is past.
        """
        last = last_step(t_end, self.h, self.time, int(self.state.control.grid))
        if abs(t_end / self.h - last) > OFF_GRID:
            self.watch.say("end", f"t = {t_end:.9g} is not a multiple of the step {self.h:.9g}: "
                           f"the run ends at t = {last * self.h:.9g}")
        return last

    def _look_before(self, t_end: float) -> None:
        """Refuse functions that have changed, and say what steps up to a time will not see."""
        self.flush()
        user_faults.refuse_changed(self.model)
        self._judge_teeth()
        if self.state.control.adaptive == 0:
            for name, message in unseen(self.numbering, self.h, self.time, t_end):
                self.watch.say(f"peak {name}", message)
            for name, message in divided(self.numbering, self.h, self.time, t_end):
                self.watch.say(f"rows {name}", message)
            for name, message in untold(self.numbering, self.h, self.time, t_end):
                self.watch.say(f"jump {name}", message)

    def _look_after(self, failed: bool, stopped: bool) -> None:
        """Look whether limits are exceeded in what was recorded last; raise what ended the run."""
        self.watch.look(self.model, self.numbering, self.rows.stretches[-1])
        if failed:
            self.failure = explained(self.model, self.system, self.state, self.numbering)
            raise SimulationError(self.failure, self.result())
        if stopped:
            result = self.result()
            result.failure = f"interrupted at t = {self.time:.6g}: results up to this time are kept"
            raise Interrupted(result.failure, result)

    def set_input(self, name: str, value: float) -> None:
        """Set the input of an actuator; it holds from the time reached until it is set again.

        As where a controller sets it, accelerations are solved for anew when the run goes on.

        Raises
        ------
        InputError
            No actuator of this name, or no finite number.
        """
        if self.sampling.set_input(name, value):
            self.state.control["restart"] = ASKED
            self.rows.jump()

    def read(self, name: str) -> float | NDArray:
        """A quantity in the state reached, or what a sensor gave last.

        Motion of nodes and modes, sensors and signals take about a microsecond, what has a formula
        less than ten, anything else about a millisecond.

        Raises
        ------
        InputError
            A name that nothing has.
        """
        return self.sampling.read(name)

    def _piece(self, t_end: float) -> bool:
        """Run a few steps, as a loop in Python does between samples; False if that is not enough.

        Rows go to one buffer for many pieces. What users are told of is looked at when it is full,
        or when anything else is asked for.
        """
        state, steps = self.state, t_end / self.h if type(t_end) is float else np.nan
        if not (self.sampling.has_inputs and steps < MOST_STEPS):
            return False
        control, last = state.control, round(steps)
        count = last - control["grid"]
        if not 0 < count <= FEW or abs(steps - last) > OFF_GRID:
            return False
        if self.sampling.needs_looks or self.plan.logged:
            return False
        if (buffer := self.rows.buffer(count + 1)) is None:
            return False
        self.sampling.stop_at(t_end)
        helped = helping(self.system, state) if worth_help(self.system, count) else nullcontext()
        began = time.perf_counter()
        with helped:
            code = advance(self, buffer, last, FEW + 1)
        self.seconds += time.perf_counter() - began
        return code == DONE

    def flush(self) -> None:
        """Put what short pieces recorded into `rows`, and look whether limits are exceeded."""
        if self.rows.flush():
            self.watch.look(self.model, self.numbering, self.rows.stretches[-1])

    def _advance(self, record: Record, last: int, t_end: float,
                 progress: Callable[[float], None] | None) -> int:
        """Call the loop until it is done or fails, in chunks of steps that take about `LOOK`."""
        code, chunk = CHUNK, FIRST_CHUNK
        while code not in (DONE, FAILED):
            began = time.perf_counter()
            code = advance(self, record, last, chunk)
            if self.plan.logged:
                self.log.take(self.state)
            took = time.perf_counter() - began
            self.seconds += took
            chunk = max(1, int(chunk * min(GROWTH, LOOK / max(took, 1e-9))))
            if self.plan.logged:
                chunk = min(chunk, self.plan.logged - 1)
            if progress and code != FAILED:
                progress(1.0 if code == DONE else min(self.time / t_end, 1.0))
        return code

    def result(self) -> Result:
        """The results computed so far."""
        self.flush()
        results = Result(self.model, self.numbering, self.system, self.state,
                         self.rows.all(), self.seconds, self.failure, self.start)
        if self.plan.seconds:
            results.all_seconds = self.plan.seconds + self.seconds
        for key, message in off_sheaves(results).items():
            self.watch.say(key, message)
        results.warnings = (self.watch.judge(results) if results.steps else
                            tuple(self.watch.messages))
        return results

    def _accelerate_again(self) -> None:
        """Solve for them once more, after a change of what elements keep."""
        self.state.control.restart = ASKED
        self._accelerate()

    def _accelerate(self) -> None:
        """Solve for the accelerations and multipliers of the start, by the loop without a step.

        So the loop is compiled, or read from the cache, before time is measured.
        """
        state = self.state
        self.system.routines[:] = addresses(self.system, state)
        if self.tolerance is not None:
            state.clock.current_step = FIRST_STEP * self.h     # so far ahead it looks
        code = advance(self, self.rows.none(), 0, 0)
        if code == FAILED and (did := user_faults.fault(self.model, 0.0)):
            raise InputError(f"the run cannot begin: {did}")
        if code == FAILED:
            raise InputError(of_start(self.system, state, self.numbering))
        state.control.matrices = 0
        state.aux_old[:] = state.aux


class Standstill(Simulation):
    """The start of a model that no steps follow: its loads are as they were given at any time.

    Attributes
    ----------
    held_unknowns : (k,)
        Unknowns that stay where they are in the search of an equilibrium.
    """

    gives_loads_to_steps = False
    held_unknowns: NDArray = np.zeros(0, dtype=np.int64)
