"""HHT and generalized-alpha runs: schemes, consistent start, and driving the compiled loop."""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.sparse import csc_matrix, diags_array
from scipy.sparse.linalg import splu

from sebody.analysis.initial_state import Start, acceleration_rates, assembled, start
from sebody.analysis.limits import Watch
from sebody.analysis.tolerance import Tolerance
from sebody.assembly.build import DENSE_LIMIT, build, work_size
from sebody.assembly.numbering import Numbering, turning
from sebody.engine.loop import advance
from sebody.engine.state import (
    ADAPTIVE,
    AUX_STEP,
    CHOSEN,
    CHUNK,
    CLOCKS,
    CONTRACTION,
    CONTROLS,
    CURRENT_STEP,
    DONE,
    FACTOR,
    FAILED,
    FINEST,
    GRID,
    LARGEST_ERROR,
    REASON,
    REASONS,
    RECORDED,
    RENEWED,
    SOLVE,
    STEP,
    TIME,
    WANTED,
    Record,
    Scheme,
    State,
)
from sebody.engine.step import write_record
from sebody.engine.system import System
from sebody.errors import InputError, SimulationError
from sebody.kernels.abi import padded
from sebody.kernels.layout import COEFFICIENTS, ENERGIES, FIELD, LANES
from sebody.model.model import Model
from sebody.results.result import Result

FIRST_STEP = 1e-3       # of the output grid, where nothing is accelerated at the start


def generalized_alpha(rho: float = 0.9, tolerance: float = 1e-8, tangent: str = "consistent",
                      index: int = 3) -> Scheme:
    """Chung and Hulbert's scheme with spectral radius `rho` at infinite frequency.

    Parameters
    ----------
    rho : float
        In [0, 1]; 1 has no numerical damping.
    tolerance : float
        Of the Newton correction left, relative to the increment of the step.
    tangent : {'consistent', 'paper'}
        Iteration matrix: exact, or (31) with (60)-(63).
    index : {3, 2}
        With 3 the constraints hold for positions; with 2, the stabilised form of Gear, Gupta and
        Leimkuhler, for velocities, too, and multipliers are of second order from the start.

    Raises
    ------
    InputError
        Values out of range.
    """
    if not 0.0 <= rho <= 1.0:
        raise InputError(f"rho is {rho}: use a spectral radius between 0 and 1")
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 + alpha_f - alpha_m
    return _scheme(alpha_m, alpha_f, 0.25 * (gamma + 0.5) ** 2, gamma, tolerance, tangent, index)


def hht(alpha: float = -0.05, tolerance: float = 1e-8, tangent: str = "consistent",
        index: int = 3) -> Scheme:
    """Hilber, Hughes and Taylor's scheme, ``alpha`` in [-1/3, 0]; see `generalized_alpha`."""
    if not -1.0 / 3.0 <= alpha <= 0.0:
        raise InputError(f"alpha is {alpha}: HHT needs a value between -1/3 and 0")
    return _scheme(0.0, -alpha, 0.25 * (1 - alpha) ** 2, 0.5 - alpha, tolerance, tangent, index)


def _scheme(alpha_m, alpha_f, beta, gamma, tolerance, tangent, index) -> Scheme:
    if not 0.0 < tolerance < 1.0:
        raise InputError(f"tolerance is {tolerance}: use a number between 0 and 1, such as 1e-8")
    if tangent not in ("consistent", "paper"):
        raise InputError(f"tangent {tangent!r} is unknown: use 'consistent' or 'paper'")
    if index not in (2, 3):
        raise InputError(f"index is {index}: use 3, or 2 for the stabilised form")
    return Scheme(alpha_m, alpha_f, beta, gamma, tolerance, 1.0 if tangent == "consistent" else 0.0,
                  index == 2)


class Simulation:
    """A run that can be driven piece by piece: ``run_to(t)`` as often as wanted.

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
        Allowed error of a step: steps are chosen, corners of load tables met, and `h` is but the
        output grid, on which the state is interpolated. Errors of many steps add up: see
        `simulate_within` for that of the whole run.

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
        self.system, self.numbering = build(model)
        self.scheme = self._fitting(scheme, tolerance is not None)
        self.dense = self.numbering.free <= DENSE_LIMIT
        self.state = _initial_state(model, self.system, self.numbering, self.h, self.dense)
        self.records: list[Record] = []
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
        self.records.append(first)
        # nothing to do yet: compiles the loop, or reads it from the cache, before time is measured
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
                scale = self.state.scale[:n]
                self.state.correction[:n] = scale * self._factors.solve(
                    scale * self.state.residual[:n])
            self.seconds += time.perf_counter() - began
            if progress and code in (CHUNK, DONE):
                progress(self.time / t_end if t_end else 1.0)
        self.records.append(
            replace(record, rows=record.rows[:self.state.control[RECORDED]]))
        self.watch.look(self, self.records[-1].rows)
        if code == FAILED:
            self.failure = self._explain()
            raise SimulationError(self.failure, self.result())
        return self

    def result(self) -> Result:
        """What has been computed so far."""
        return Result.of(self)

    def _fitting(self, scheme: Scheme | None, variable: bool) -> Scheme:
        """The scheme, by default one that suits the steps and the constraints."""
        constrained = bool(self.numbering.multipliers)
        if scheme is None:
            return generalized_alpha(index=2 if constrained and variable else 3)
        if variable and constrained and not scheme.stabilized:
            raise InputError("with constraints of index 3 errors grow where steps change: give "
                             "generalized_alpha(index=2), or a fixed step")
        return scheme if constrained else scheme._replace(stabilized=False)

    def _choose_steps(self, tolerance: Tolerance) -> None:
        """Steps by their error; the first one is short against what accelerations allow."""
        n, state = self.numbering.free, self.state
        turns = turning(self.model, self.numbering)[:n]
        state.strictness[:n] = 1.0 / tolerance.allowed(self.system.magnitude[:n], turns)
        bend = np.abs(state.a[:n] * state.strictness[:n]).max()
        state.clock[CHOSEN] = min(self.h, 0.1 / np.sqrt(bend)) if bend > 0 else FIRST_STEP * self.h
        state.clock[LARGEST_ERROR] = 0.0
        state.control[ADAPTIVE] = 1

    def _offset_accelerations(self) -> None:
        """Auxiliary accelerations are those of a later time, which multipliers show."""
        scheme, state = self.scheme, self.state
        h = state.clock[CHOSEN] if self.tolerance else self.h
        state.clock[AUX_STEP] = h
        state.aux[:] += (scheme.alpha_m - scheme.alpha_f) * h * acceleration_rates(
            self.system, self.numbering, state, 1e-3 * h)

    def factorize(self) -> None:
        """Factors with exchanges of rows, where elimination in order met a small pivot."""
        scale = diags_array(self.state.scale[:self.numbering.free])
        matrix = csc_matrix(scale @ assembled(self.system, self.state) @ scale)
        self._factors = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.01)

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


def _initial_state(model: Model, system: System, numbering: Numbering, h: float,
                   dense: bool) -> State:
    n, total = numbering.free, numbering.total
    bodies, turns = len(model.bodies), len(numbering.rotations)
    zeros = np.zeros
    q, v = zeros(total), zeros(total)
    for node in (*model.nodes.values(), *model.grounds):
        for triplet in (node.position, node.rotation):
            if triplet is not None and id(triplet) in numbering.triplets:
                first = numbering.triplets[id(triplet)]
                q[first:first + triplet.start.size] = triplet.start
                v[first:first + triplet.start.size] = triplet.rate if triplet.solved else 0.0
    for body in model.bodies.values():
        first = numbering.modes[body.name]
        v[first:first + body.body.modes] = body.mode_rates
    identities = np.tile(np.eye(3).ravel(), max(turns, bodies))
    R, frames = identities[:9 * turns], identities[:9 * bodies]
    items = len(numbering.histories)
    counts = {"items": items, "coordinates": total, "rotations": turns, "bodies": bodies}
    clock, control = zeros(CLOCKS), np.zeros(CONTROLS, dtype=np.int64)
    clock[STEP] = clock[CURRENT_STEP] = clock[AUX_STEP] = h
    clock[CONTRACTION] = 0.95
    control[WANTED] = RENEWED
    coefficients = zeros(COEFFICIENTS.size(counts))
    coefficients[FIELD:FIELD + model.dimension] = model.gravity_field
    state = State.of(
        counts, aux=zeros(total), q_start=q.copy(), q_old=q.copy(), R_old=R.copy(),
        v_old=v.copy(), a_old=zeros(total), aux_old=zeros(total), dq=zeros(total), T=R.copy(),
        loads=zeros(3 * items), loads_old=zeros(3 * items), powers=zeros(items),
        powers_old=zeros(items), coefficients=coefficients,
        g=zeros(int(system.at_g[-1])), J=zeros(int(system.at_J[-1])),
        turned=zeros(int(system.width.max()) ** 2), residual=zeros(total), forces=zeros(total),
        correction=zeros(padded(total) + LANES), solution=zeros(system.slot_unknowns.size),
        last_correction=zeros(total), last_change=zeros(total),
        moved=np.ones(len(system.summands), dtype=bool), gaps=zeros(total), shift=zeros(total),
        strictness=zeros(total), expansion=zeros(9 + int(max(
            (w * wide + wide * wide for _, w, wide, *_ in system.links.elements), default=0))),
        matrix=zeros(system.rows.size + 1),
        scale=np.ones(total + LANES), weight=zeros(total),
        inverse=zeros((n, padded(n)) if dense else (1, 1)),
        column=zeros(LANES * system.slot_unknowns.size), work=zeros(work_size(model)),
        energy=zeros(ENERGIES.size(counts)), clock=clock, control=control)
    state.q[:], state.v[:], state.R[:] = q, v, R
    state.frames[:] = state.frames_old[:] = frames
    return state
