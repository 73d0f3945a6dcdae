"""Simulations: a consistent initial state, then calls of the compiled loop."""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import splu

from sebody.analysis.allocation import allocate
from sebody.analysis.evaluation import assembled
from sebody.analysis.first_run import prepare
from sebody.analysis.initial_state import acceleration_rates, start
from sebody.analysis.limits import Watch
from sebody.analysis.schemes import generalized_alpha
from sebody.analysis.sparse import SINGULAR
from sebody.analysis.tolerance import Tolerance
from sebody.assembly.build import build
from sebody.assembly.numbering import rotational
from sebody.engine.loop import advance
from sebody.engine.relaxation import RELAXATION, relax
from sebody.engine.state import (
    ADAPTIVE,
    AUX_STEP,
    CHOSEN,
    CHUNK,
    DONE,
    FACTOR,
    FAILED,
    FINEST,
    GRID,
    LARGEST_ERROR,
    REASON,
    REASONS,
    RECORDED,
    RELAXED,
    SOLVE,
    TIME,
    Record,
    Scheme,
)
from sebody.engine.step import write_record
from sebody.errors import InputError, SimulationError
from sebody.model.model import Model
from sebody.results.recording import Start
from sebody.results.result import Result

FIRST_STEP = 1e-3       # of the output grid: first step if nothing is accelerated at the start


class Simulation:
    """A run that is computed piece by piece: ``run_to(t)`` as often as wanted.

    Parameters
    ----------
    model : Model
    h : float
        Time step, also the output grid [time].
    scheme : Scheme, optional
        `generalized_alpha` with rho 0.9 by default.
    output_every : int
        Keep every so many steps.
    tolerance : Tolerance, optional
        Allowed error of a step. With a tolerance, step lengths are chosen, steps end at corners of
        load tables, and `h` is only the output grid, on which the state is interpolated. Errors of
        many steps add up: see `simulate_within` for the error of the whole run.

    Attributes
    ----------
    start : Start
        Initial velocities that were solved for, redundant constraints.

    Raises
    ------
    InputError
        Bad step or tolerance, singular mass, contradicting constraints, an initial state that
        violates them, or variable steps with constraints of index 3.
    """

    def __init__(self, model: Model, h: float, scheme: Scheme | None = None,
                 output_every: int = 1, tolerance: Tolerance | None = None):
        if not (np.isfinite(h) and h > 0):
            raise InputError(f"the time step is {h}: give a positive number")
        if output_every != int(output_every) or output_every < 1:
            raise InputError(f"output_every is {output_every}: give a whole number of steps >= 1")
        self.model, self.h, self.every = model, float(h), int(output_every)
        prepare([model])
        self.system, self.numbering = build(model)
        self.scheme = self._fitting(scheme, tolerance is not None)
        self.dense = not self.system.slot_unknowns.size     # no elimination by blocks
        self.state = allocate(model, self.system, self.numbering, self.h, self.dense)
        self.rows: list[NDArray] = []       # recorded states, stretch by stretch
        self.watch = Watch()
        self.watch.start(model.bodies, self.scheme, bool(self.numbering.multipliers))
        self.seconds = 0.0
        self.failure = ""
        self._factors = None
        self.start: Start = start(model, self.system, self.numbering, self.state)
        self.tolerance = tolerance
        if tolerance is not None:
            self._choose_steps(tolerance.check())
        if self.scheme.stabilized:
            self._offset_accelerations()
        first = Record.of(self.state, 1, self.every)
        self.state.control[RECORDED] = 0
        write_record(self.state, first)
        self.rows.append(first.rows)
        # no steps yet: the loop is compiled, or read from the cache, before time is measured
        advance(self.system, self.state, first, self.scheme, 0, 0, self.dense)

    @property
    def time(self) -> float:
        """Time reached."""
        return float(self.state.clock[TIME])

    def run_to(self, t_end: float, progress: Callable[[float], None] | None = None,
               chunk: int = 2000) -> "Simulation":
        """Advance to the grid step nearest to `t_end`.

        Raises
        ------
        SimulationError
            When a step does not converge however small; what was computed is kept, also in the
            error's `result`.
        """
        last = int(round(t_end / self.h)) if np.isfinite(t_end) else -1
        if last < self.state.control[GRID]:
            raise InputError(f"cannot run to t = {t_end} from t = {self.time}: give a later time")
        steps = last // self.every - self.state.control[GRID] // self.every
        record = Record.of(self.state, int(steps), self.every)
        self.state.control[RECORDED] = 0
        code = CHUNK
        while code not in (DONE, FAILED):
            began = time.perf_counter()
            code = advance(self.system, self.state, record, self.scheme, last, chunk, self.dense)
            if code == FACTOR:
                self.factorize()
            elif code == SOLVE:
                n = self.numbering.free
                self.state.correction[:n] = self._solved(self.state.residual[:n])
                if self.state.control[RELAXED]:
                    self.state.correction[:n] -= self._solved(
                        self.state.relaxation[:n] * self.state.correction[:n])
            self.seconds += time.perf_counter() - began
            if progress and code in (CHUNK, DONE):
                progress(self.time / t_end if t_end else 1.0)
        self.rows.append(record.rows[:self.state.control[RECORDED]])
        self.watch.look(self.model, self.numbering, self.rows[-1])
        if code == FAILED:
            self.failure = self._explain()
            raise SimulationError(self.failure, self.result())
        return self

    def result(self) -> Result:
        """The results computed so far."""
        return Result(self.model, self.numbering, self.system, self.state,
                      np.concatenate(self.rows), self.seconds, self.failure, self.start,
                      tuple(self.watch.messages))

    def _fitting(self, scheme: Scheme | None, variable: bool) -> Scheme:
        """The given scheme, or by default one that suits the steps and the constraints."""
        constrained = bool(self.numbering.multipliers)
        if scheme is None:
            return generalized_alpha(index=2 if constrained and variable else 3)
        if variable and constrained and not scheme.stabilized:
            raise InputError("with constraints of index 3 errors grow where steps change: give "
                             "generalized_alpha(index=2), or a fixed step")
        return scheme if constrained else scheme._replace(stabilized=False)

    def _choose_steps(self, tolerance: Tolerance) -> None:
        """Switch on variable steps; the first step is short against the accelerations."""
        n, state = self.numbering.free, self.state
        rotations = rotational(self.model, self.numbering)[:n]
        state.error_weights[:n] = 1.0 / tolerance.allowed(self.system.magnitude[:n], rotations)
        bend = np.abs(state.a[:n] * state.error_weights[:n]).max()
        state.clock[CHOSEN] = min(self.h, 0.1 / np.sqrt(bend)) if bend > 0 else FIRST_STEP * self.h
        state.clock[LARGEST_ERROR] = 0.0
        state.control[ADAPTIVE] = 1

    def _offset_accelerations(self) -> None:
        """Set auxiliary accelerations to those of the later time they belong to.

        Multipliers of the first steps would show the difference.
        """
        scheme, state = self.scheme, self.state
        h = state.clock[CHOSEN] if self.tolerance else self.h
        state.clock[AUX_STEP] = h
        state.aux[:] += (scheme.alpha_m - scheme.alpha_f) * h * acceleration_rates(
            self.system, self.numbering, state, 1e-3 * h)

    def factorize(self) -> None:
        """Factorize with row exchanges, where elimination by blocks met a small pivot."""
        if not self._factorized():
            relax(self.system, self.state, RELAXATION)
            self._factorized()

    def _factorized(self) -> bool:
        """Whether the factors are those of a regular matrix."""
        scale = diags(self.state.scale[:self.numbering.free])
        matrix = csc_matrix(scale @ assembled(self.system, self.state) @ scale)
        try:
            self._factors = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.01)
        except RuntimeError:        # a pivot is exactly zero
            return False
        pivots = np.abs(self._factors.U.diagonal())
        return bool(pivots.min() >= SINGULAR * pivots.max())

    def _solved(self, right: NDArray) -> NDArray:
        scale = self.state.scale[:self.numbering.free]
        return scale * self._factors.solve(scale * right)

    def _explain(self) -> str:
        reason = REASONS[int(self.state.control[REASON])]
        shortest = (self.state.clock[CHOSEN] if self.tolerance else self.h / FINEST)
        remedy = "a larger tolerance" if self.tolerance else "a smaller step"
        return (f"stopped at t = {self.time:.6g}: {reason}, even with the step cut to "
                f"{shortest:.3g}; results up to there are kept. Use {remedy}, "
                "check the loads, or split the body into more superelements")


def simulate(model: Model, h: float, t_end: float, scheme: Scheme | None = None,
             output_every: int = 1, progress: Callable[[float], None] | None = None,
             tolerance: Tolerance | None = None) -> Result:
    """Run a model from 0 to `t_end`; see `Simulation` for the arguments and exceptions."""
    return Simulation(model, h, scheme, output_every, tolerance).run_to(t_end, progress).result()
