"""The arrays of a state before the first step: the initial configuration, and scratch memory."""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.build import work_size
from sebody.assembly.control import begin
from sebody.assembly.memory_map import frame_numbers
from sebody.contract.counts import LANES, whole_vectors
from sebody.contract.layout import COEFFICIENTS, ENERGIES, FIELD
from sebody.engine.clock import CLOCK, CONTROL
from sebody.engine.growth import new_guard
from sebody.engine.kept_factors import spare
from sebody.engine.newton import SLOWEST
from sebody.engine.offsets import at_cache_lines
from sebody.engine.prediction import FIT, ROWS
from sebody.engine.scalars import record
from sebody.engine.state import EVALUATED, State
from sebody.engine.system import System
from sebody.kernels.rotations import rotate
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts, stretch


def allocate(model: Mechanism, system: System, numbering: Numbering, h: float, dense: bool,
             schedule: NDArray | None = None, logged: int = 0) -> State:
    """The state of a model at t = 0, without accelerations and multipliers.

    Parameters
    ----------
    h : float
        Step of the output grid [time].
    dense : bool
        Whether the loop keeps an inverse of the iteration matrix.
    schedule : (k, 2) ndarray, optional
        End and length of planned steps.
    logged : int
        Steps that `State.step_log` has room for.
    """
    counts = record_counts(numbering)
    n, total, ports = numbering.free, numbering.total, counts["ports"]
    q, v = _start(model, numbering)
    R = _rotations(model, numbering)
    zeros = np.zeros
    amplitudes = 3 * ports + sum(len(one.series.names) for one in numbering.series)
    acting = int(system.at_g[-1] - system.at_g[system.first_power[0]]) + len(system.prescribed)
    acting += len(system.gravity_ports)
    clock, control = _counters(h)
    state = State.of(
        counts,
        aux=zeros(total), changes=zeros(ROWS * total), fitted=zeros(total), fit=zeros(FIT),
        q_start=q.copy(), q_old=q.copy(), R_old=R.copy(), v_old=v.copy(), a_old=zeros(total),
        aux_old=zeros(total), dq=zeros(total), T=_identities(len(R)),
        turns=_turns(system, total),
        loads=zeros(amplitudes), loads_old=zeros(amplitudes), acting=zeros(acting),
        acting_old=zeros(acting), works_old=zeros(ports), powers=zeros(ports),
        powers_old=zeros(ports),
        coefficients=zeros(COEFFICIENTS.size(counts)),
        g=zeros(int(system.at_g[-1])), J=zeros(int(system.at_J[-1])),
        condensed=zeros(int(system.at_J[system.first_joint[0]]) if len(system.internal) else 0),
        rotated_matrix=zeros(int(system.width.max()) ** 2), residual=zeros(total),
        forces=zeros(total), constraint_residuals=zeros(total), shift=zeros(total),
        correction=zeros(whole_vectors(total) + LANES), solution=zeros(system.slot_unknowns.size),
        last_correction=zeros(total), last_change=zeros(total),
        moved=np.ones(len(system.summands)),
        error_weights=zeros(total),
        schedule=zeros((0, 2)) if schedule is None else schedule.copy(),
        step_log=zeros((logged, 3)), expansion=zeros(_expansion_size(system)),
        matrix=zeros(system.rows.size + 1), scale=np.ones(total + LANES), weight=zeros(total),
        inverse=zeros((n, whole_vectors(n)) if dense else (1, 1)),
        spare=spare(system, n, dense),
        regularization=zeros(total), constraint_columns=zeros(system.constraint_columns.size),
        projected=zeros(total), pulled=zeros(total),
        column=zeros(LANES * system.slot_unknowns.size), work=at_cache_lines(work_size(model)),
        energy=zeros(ENERGIES.size(counts)), memory=zeros(int(system.control.memory[0])),
        guard=new_guard(len(model.bodies)),
        clock=clock, control=control)
    state.q[:], state.v[:], state.R[:] = q, v, R
    state.coefficients[FIELD:FIELD + model.dimension] = model.gravity_field
    of_bodies = 9 * len(frame_numbers(model))
    state.frames[:of_bodies] = state.frames_old[:of_bodies] = _identities(of_bodies)
    begin(model, numbering, system.control, state.memory, state.frames)
    state.frames_old[of_bodies:] = state.frames[of_bodies:]
    return state


def _counters(h: float) -> tuple[np.record, np.record]:
    """Clock and control of a run that has not begun, with this step of the output grid."""
    clock, control = record(CLOCK), record(CONTROL)
    clock.step = clock.current_step = clock.aux_step = clock.natural = h
    clock.contraction = SLOWEST
    control.wanted = EVALUATED
    return clock, control


def _start(model: Mechanism, numbering: Numbering) -> tuple[NDArray, NDArray]:
    """Initial values and velocities of all coordinates."""
    q, v = np.zeros((2, numbering.total))
    for dof_block in numbering.dof_blocks:
        at = stretch(numbering, dof_block)
        # of a rotation in space R has it, and q the increment in a step
        q[at] = 0.0 if dof_block in numbering.rotations else dof_block.start
        v[at] = dof_block.rate if dof_block.solved else 0.0
    for body in model.bodies.values():
        first = numbering.modes[body.name]
        v[first:first + body.reduced.modes] = body.mode_rates
    return q, v


def _rotations(model: Mechanism, numbering: Numbering) -> NDArray:
    """Initial rotation matrices, row by row."""
    rotations = _identities(9 * len(numbering.rotations))
    for dof_block in model.dof_blocks():
        if dof_block in numbering.rotations and dof_block.start.any():
            at = 9 * numbering.rotations[dof_block]
            rotate(rotations, at, *dof_block.start, rotations, at)
    return rotations


def _turns(system: System, total: int) -> NDArray:
    """Angle, cosine and sine of all coordinates, of no rotation; none where no links need them."""
    planar = system.dimension[0] == 2 and len(system.links.arms) > 0
    return np.tile([0.0, 1.0, 0.0], total if planar else 0)


def _identities(size: int) -> NDArray:
    """Identity matrices, row by row, of so many numbers."""
    numbers = np.zeros(size)
    numbers.reshape(-1, 9)[:, ::4] = 1.0
    return numbers


def _expansion_size(system: System) -> int:
    """Numbers in `State.expansion`: a 3x3 block, half and wholly expanded element matrices."""
    return 9 + int(max((w * wide + wide * wide for _, w, wide, *_ in system.links.elements),
                       default=0))
