"""Quantities in compiled code: a tape with what it reads of a state, evaluated there.

Forces of elements, energies and motions of bodies are evaluated by their kernels, as for a result.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.motions import Motions
from sebody.compiler.decorators import compiled
from sebody.contract.layout import ENERGY as ENERGIES
from sebody.contract.layout import OK, RESIDUAL, VELOCITY
from sebody.contract.read_numbers import ENERGY, FORCE, LOAD, MOTION, NOW, RESIDUE, TOTAL
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import assemble, run_kernels, run_part, set_loads
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.engine.vectors import copy
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to
from sebody.quantities.expressions import (
    ANGLE,
    CHOICE,
    COSINE,
    FACTORS,
    INVERSE,
    POSITIVE,
    ROOT,
    SINE,
    SUM,
    Tape,
)

BODY = 6                # numbers of a body in Reading.bodies


@dataclass(frozen=True, eq=False)
class Reading(Arrays):
    """A tape as arrays, and what is evaluated for it.

    ============  ==================================================================================
    inputs        (i, 3) place on the tape, kind of number, its place in a state
    steps         (s, 4) function, place on the tape, first of its products and end of these
    factors       (m, FACTORS) places on the tape of the factors of every product
    weights       (m,) of these products
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
    products = [product for step in tape.steps for product in step.products]
    ends = np.cumsum([0, *(len(step.products) for step in tape.steps)])
    steps = [(step.function, step.place, ends[k], ends[k + 1])
             for k, step in enumerate(tape.steps)]
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
        _whole(inputs, 3), _whole(steps, 4),
        _whole([(*own, *(0,) * (FACTORS - len(own))) for own, _ in products], FACTORS),
        np.array([weight for _, weight in products], dtype=float),
        np.array(tape.outputs, dtype=np.int64), _batches(tape, system), _whole(rows, BODY),
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
        own = at(pointer_to(reading.bodies), BODY * b)
        copy(state.frames, reading.frames)
        work = reading.work
        status = max(status, call_kernel(
            own[0], RESIDUAL, 1, own[1], own[2],
            Arguments(index=at(pointer_to(reading.index), own[3]),
                      constants=at(pointer_to(reading.constants), own[4]),
                      q=pointer_to(state.q), R=pointer_to(state.R), v=pointer_to(state.v),
                      a=pointer_to(state.a), references=pointer_to(state.frames_old),
                      frames=reading.frames, T=work, loads=work, coefficients=work,
                      forces=at(pointer_to(reading.moved), own[5]), matrices=work, work=work,
                      energies=work)))
    return status


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


@compiled
def play(steps, factors, weights, numbers):
    """Compute the numbers of a tape from those that are read."""
    for s in range(steps.shape[0]):
        function, place, first, end = steps[s, 0], steps[s, 1], steps[s, 2], steps[s, 3]
        if function == ANGLE:
            found = np.arctan2(numbers[factors[first, 0]], numbers[factors[first + 1, 0]])
            turns = np.floor((numbers[place] - found) / (2.0 * np.pi) + 0.5)
            numbers[place] = found + 2.0 * np.pi * turns
            continue
        if function == CHOICE:
            numbers[place] = numbers[factors[chosen(factors, first, end, numbers), 1]]
            continue
        x = 0.0
        for i in range(first, end):
            product = weights[i]
            for j in range(FACTORS):
                product *= numbers[factors[i, j]]
            x += product
        if function == SUM:
            numbers[place] = x
        elif function == ROOT:
            numbers[place] = np.sqrt(max(x, 0.0))
        elif function == INVERSE:
            numbers[place] = 1.0 / x
        elif function == COSINE:
            numbers[place] = np.cos(x)
        elif function == SINE:
            numbers[place] = np.sin(x)
        elif function == POSITIVE:
            numbers[place] = 1.0 if x > 0.0 else 0.0


@compiled
def chosen(factors, first, end, numbers):
    """The product of a CHOICE with the largest comparison, the first such."""
    best = first
    for i in range(first + 1, end):
        if numbers[factors[i, 0]] > numbers[factors[best, 0]]:
            best = i
    return best


@compiled
def play_back(steps, factors, weights, numbers, bars):
    """Give bars of the numbers of a tape to those that they follow from, last ones first."""
    for s in range(steps.shape[0] - 1, -1, -1):
        function, place, first, end = steps[s, 0], steps[s, 1], steps[s, 2], steps[s, 3]
        bar = bars[place]
        if bar == 0.0 or function == POSITIVE:
            continue
        if function == ANGLE:
            y, x = factors[first, 0], factors[first + 1, 0]
            square = numbers[x] * numbers[x] + numbers[y] * numbers[y]
            bars[y] += bar * numbers[x] / square
            bars[x] -= bar * numbers[y] / square
            continue
        if function == CHOICE:
            bars[factors[chosen(factors, first, end, numbers), 1]] += bar
            continue
        bar *= _rate(function, numbers[place], steps, factors, weights, numbers, s)
        for i in range(first, end):
            for j in range(FACTORS):
                if factors[i, j] > 0:
                    product = bar * weights[i]
                    for m in range(FACTORS):
                        if m != j:
                            product *= numbers[factors[i, m]]
                    bars[factors[i, j]] += product


@compiled
def play_along(steps, factors, weights, numbers, rates):
    """Rates of the numbers of a tape from those of the numbers that are read."""
    for s in range(steps.shape[0]):
        function, place, first, end = steps[s, 0], steps[s, 1], steps[s, 2], steps[s, 3]
        rate = 0.0
        if function == ANGLE:
            y, x = factors[first, 0], factors[first + 1, 0]
            square = numbers[x] * numbers[x] + numbers[y] * numbers[y]
            rate = (numbers[x] * rates[y] - numbers[y] * rates[x]) / square
        elif function == CHOICE:
            rate = rates[factors[chosen(factors, first, end, numbers), 1]]
        elif function != POSITIVE:
            for i in range(first, end):
                for j in range(FACTORS):
                    product = weights[i] * rates[factors[i, j]]
                    for m in range(FACTORS):
                        if m != j:
                            product *= numbers[factors[i, m]]
                    rate += product
            rate *= _rate(function, numbers[place], steps, factors, weights, numbers, s)
        rates[place] = rate


@compiled
def _rate(function, value, steps, factors, weights, numbers, s):
    """Derivative of the function of a step by its sum of products."""
    if function == ROOT:
        return 0.5 / value
    if function == INVERSE:
        return -value * value
    if function == COSINE or function == SINE:
        x = 0.0
        for i in range(steps[s, 2], steps[s, 3]):
            product = weights[i]
            for j in range(FACTORS):
                product *= numbers[factors[i, j]]
            x += product
        return -np.sin(x) if function == COSINE else np.cos(x)
    return 1.0
