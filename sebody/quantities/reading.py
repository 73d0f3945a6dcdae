"""Quantities in compiled code: a tape with what it reads of a state, evaluated there.

Forces of elements, energies and motions of bodies are evaluated by their kernels, as for a result.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.counts import Counts
from sebody.contract.layout import ENERGY as ENERGIES, MOTION as MOTION_ROW, OK, RESIDUAL, VELOCITY
from sebody.contract.read_numbers import ENERGY, FORCE, LOAD, MOTION, NOW, RESIDUE, TOTAL
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import assemble, run_kernels, run_part, set_gravity, set_loads
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.engine.vectors import copy
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to
from sebody.kernels.tapes import play
from sebody.quantities.expressions import Tape

BODY = 6                # numbers of a body in Reading.bodies


class Motions(NamedTuple):
    """Bodies with the same frame and numbers of positions, rotations and unknowns."""

    address: int            # of the kernel
    bodies: list[str]       # their names
    counts: Counts          # that sizes in `layout.MOTION` refer to
    index: NDArray          # (b, stride) index rows
    constants: NDArray      # rows of constants
    scratch: int            # numbers of scratch memory

    @property
    def size(self) -> int:
        """Numbers of a body's motion in a state."""
        return MOTION_ROW.size(self.counts)


@dataclass(frozen=True, eq=False)
class Reading(Arrays):
    """A tape as arrays, and what is evaluated for it.

    ============  ==================================================================================
    inputs        (i, 3) place on the tape, kind of number, its place in a state
    steps         of `Tape.arrays`, as are the next two
    factors       places on the tape of the factors of every product
    weights       of these products
    outputs       (n,) places on the tape
    batches       (b, 3) batches whose forces are read: number, first element, elements
    bodies        (b, BODY) of motions: kernel, stride and width, where index and constants begin,
                  and the numbers of the motion in `moved`
    index         of these bodies
    constants     of these bodies
    needs         (kinds,) one for each kind of numbers that is read
    values        (n,) written: the outputs
    numbers       written: all numbers of the tape; angles continue from what they were before
    moved         written: motions of bodies
    residues      (2,) written: largest residual of constraints, and of their rates
    row, loads    copies of what evaluation changes
    sums          (N,) of forces on coordinates
    frames, work  scratch memory of motions
    ============  ==================================================================================
    """

    inputs: NDArray
    steps: NDArray
    factors: NDArray
    weights: NDArray
    outputs: NDArray
    batches: NDArray
    bodies: NDArray
    index: NDArray
    constants: NDArray
    needs: NDArray
    values: NDArray
    numbers: NDArray
    moved: NDArray
    residues: NDArray
    row: NDArray
    loads: NDArray
    sums: NDArray
    frames: NDArray
    work: NDArray


def reading(tape: Tape, system: System | None = None, state: State | None = None,
            bodies: Sequence[tuple[Motions, int]] = ()) -> Reading:
    """The arrays of a tape.

    Parameters
    ----------
    tape : Tape
    system, state : System and State, optional
        Of the model; none of a tape that reads nothing.
    bodies : sequence of tuple
        Bodies whose motion is read, and where the numbers of each begin.
    """
    inputs = [(place, *key) for key, place in tape.inputs.items()]
    needs = np.zeros(1 + MOTION, dtype=np.int64)
    needs[[kind for kind, _ in tape.inputs]] = 1
    row, loads, sums, frames = (np.zeros(own.size) for own in (
        (state.now, state.loads, state.residual, state.frames) if state else [np.zeros(0)] * 4))
    groups = [group for group, _ in bodies]
    strides = [group.index.shape[1] for group in groups]
    starts = np.cumsum([0, *strides]), np.cumsum([0, *(g.constants.size for g in groups)])
    rows = [(group.address, strides[k], group.counts["n"], starts[0][k], starts[1][k], first)
            for k, (group, first) in enumerate(bodies)]
    numbers = np.zeros(tape.size)
    numbers[0] = 1.0
    return Reading(
        _whole(inputs, 3), *tape.arrays(), np.array(tape.outputs, dtype=np.int64),
        _batches(tape, system), _whole(rows, BODY),
        np.concatenate([group.index.ravel() for group in groups] or [_whole([], 1).ravel()]),
        np.concatenate([group.constants for group in groups] or [np.zeros(0)]),
        needs, np.zeros(len(tape.outputs)), numbers,
        np.zeros(sum(group.size for group in groups)), np.zeros(2), row, loads, sums, frames,
        np.zeros(max((group.scratch for group in groups), default=0)))


def _batches(tape: Tape, system: System | None) -> NDArray:
    """The elements whose forces are read."""
    found = set()
    for kind, place in tape.inputs:
        if kind == FORCE and system is not None:
            b = int(np.searchsorted(system.at_g, place, side="right")) - 1
            found.add((b, int((place - system.at_g[b]) // system.width[b]), 1))
    return _whole(sorted(found), 3)


def _whole(rows: Sequence, width: int) -> NDArray:
    return np.array(rows, dtype=np.int64).reshape(-1, width)


@compiled
def evaluate(system, state, reading):
    """Set the values of a tape's outputs in the state reached; returns the status of the kernels.

    The state stays as it is. Angles continue from the values of the last evaluation.
    """
    if not _runs_kernels(reading):
        return evaluate_loaded(system, state, reading)
    copy(state.loads, reading.loads)
    set_loads(system, state.frames, state.loads, state.clock.time)
    set_gravity(system, state)
    status = evaluate_loaded(system, state, reading)
    copy(reading.loads, state.loads)
    return status


@compiled
def _runs_kernels(reading):
    for kind in range(NOW + 1, reading.needs.size):
        if reading.needs[kind] == 1:
            return True
    return False


@compiled
def evaluate_loaded(system, state, reading):
    """The same of a state whose loads are those of its time."""
    status = OK
    if _runs_kernels(reading):
        copy(state.now, reading.row)
        status = _run_kernels(system, state, reading)
    for i in range(reading.inputs.shape[0]):
        reading.numbers[reading.inputs[i, 0]] = _number(
            state, reading, reading.inputs[i, 1], reading.inputs[i, 2])
    play(reading.steps, reading.factors, reading.weights, reading.numbers)
    for k in range(reading.values.size):
        reading.values[k] = reading.numbers[reading.outputs[k]]
    return status


@compiled
def _run_kernels(system, state, reading):
    """Evaluate what is read; the state stays as it is."""
    status, needs = OK, reading.needs
    if needs[ENERGY] == 1:
        for i in range(state.energy.size):
            state.energy[i] = 0.0
        status = run_kernels(ENERGIES, 0, system.address.size, system, state)
        copy(reading.row, state.now)
    residues, sums = needs[RESIDUE] == 1, needs[TOTAL] == 1
    for j in range(1, -1, -1):          # forces are those of the last, and of the only call
        if status != OK or not (residues or (sums and j == 0)):
            continue
        status = assemble(RESIDUAL, RESIDUAL if j == 0 else VELOCITY, system, state, reading.sums)
        copy(reading.row, state.now)
        reading.residues[j] = 0.0
        for i in range(system.diagonal.size):
            if system.is_multiplier[i] > 0.0:
                reading.residues[j] = max(reading.residues[j], abs(reading.sums[i]))
    if not (residues or sums):
        for k in range(reading.batches.shape[0]):
            if status == OK:
                status = run_part(RESIDUAL, reading.batches[k, 0], reading.batches[k, 1],
                                  reading.batches[k, 2], system, state, pointer_to(state.work))
        if reading.batches.shape[0] > 0:
            copy(reading.row, state.now)
    if status == OK:
        status = _move(state, reading)
    return status


@compiled
def _move(state, reading):
    """Evaluate motions of bodies; see `sebody.results.motion`."""
    status = OK
    for b in range(reading.bodies.shape[0]):
        status = max(status, move_body(b, state, reading))
    return status


@compiled
def move_body(b, state, reading):
    """Evaluate the motion of one of the bodies."""
    own = at(pointer_to(reading.bodies), BODY * b)
    copy(state.frames, reading.frames)
    work = reading.work
    return call_kernel(
        own[0], RESIDUAL, 1, own[1], own[2],
        Arguments(index=at(pointer_to(reading.index), own[3]),
                  constants=at(pointer_to(reading.constants), own[4]),
                  q=pointer_to(state.q), R=pointer_to(state.R), v=pointer_to(state.v),
                  a=pointer_to(state.a), references=pointer_to(state.frames_old),
                  frames=reading.frames, T=work, loads=work, coefficients=work,
                  forces=at(pointer_to(reading.moved), own[5]), matrices=work, work=work,
                  energies=work))


@compiled
def _number(state, reading, kind, place):
    if kind == NOW:
        return state.now[place]
    if kind == FORCE:
        return state.g[place]
    if kind == TOTAL:
        return reading.sums[place]
    if kind == ENERGY:
        return state.energy[place]
    if kind == RESIDUE:
        return reading.residues[place]
    if kind == LOAD:
        return state.loads[place]
    return reading.moved[place]
