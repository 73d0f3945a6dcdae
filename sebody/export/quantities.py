"""Outputs of an exported model in compiled code.

An output is what a channel of a sensor reads, a sum of products of numbers, the root of such a sum,
or one of several. Numbers are those of the state, of forces of elements, energies and motions of
bodies, which kernels evaluate as they do for a result, and outputs that came before.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.law_row import OUTSIDE
from sebody.contract.layout import ENERGY, OK, RESIDUAL, VELOCITY
from sebody.engine.arrays import Arrays
from sebody.engine.channels import read_channel
from sebody.engine.evaluate import assemble, run_kernels, set_loads
from sebody.engine.vectors import copy
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to

# what factors of terms are: 1.0 itself, a number of State.now, State.g, sums of forces,
# State.energy, residuals of constraints, State.loads, motions of bodies, an output before;
# cosine and sine of a number of State.now, 1.0 where that is positive, 1.0 where it is below 0.5
(ONE, NOW, FORCE, SUM, OF_ENERGY, RESIDUES, LOAD, MOVED, VALUE, COSINE, SINE, POSITIVE,
 BELOW_HALF) = range(13)
FACTORS = 4
NEEDS_FORCES, NEEDS_ENERGIES, NEEDS_RESIDUES = range(3)
BODY = 6                # numbers of a body in Outputs.bodies


@dataclass(frozen=True, eq=False)
class Outputs(Arrays):
    """Outputs of a model.

    ============  ==================================================================================
    channels      (n, 1 + CHANNEL_PLACES) see `engine.control_data`; OUTSIDE for all others
    coefficients  (n, CHANNEL_NUMBERS)
    terms         (m, 1 + 2 FACTORS) output, then of every factor what it is, and its place; after
                  those of the outputs that are factors
    weights       (m,) of these products
    roots         (k,) outputs that are roots of what their terms make
    choices       (c, 3) output, what is compared, and the value if that is the largest
    bodies        (b, BODY) of motions: kernel, stride and width, where index and constants begin,
                  and the numbers of the motion in `moved`
    index         of these bodies
    constants     of these bodies
    needs         (3,) whether forces, energies and residuals are evaluated
    values        (n,) written
    moved         written: motions of bodies
    residues      (2,) written: largest residual of constraints, and of their rates
    row, loads    copies of what evaluation changes
    sums          (N,) of forces on coordinates
    frames, work  scratch memory of motions
    ============  ==================================================================================
    """

    channels: NDArray
    coefficients: NDArray
    terms: NDArray
    weights: NDArray
    roots: NDArray
    choices: NDArray
    bodies: NDArray
    index: NDArray
    constants: NDArray
    needs: NDArray
    values: NDArray
    moved: NDArray
    residues: NDArray
    row: NDArray
    loads: NDArray
    sums: NDArray
    frames: NDArray
    work: NDArray


@compiled
def evaluate(system, state, outputs):
    """Set the values of outputs in the state reached; returns the status of the kernels.

    Angles continue from the value of the last evaluation, so that turns are counted.
    """
    values, status = outputs.values, OK
    for k in range(values.size):
        values[k] = read_channel(state.now, outputs.channels[k], outputs.coefficients[k],
                                 values[k])
    if outputs.terms.shape[0] > 0:
        copy(state.now, outputs.row)
        copy(state.loads, outputs.loads)
        set_loads(system, state.frames, state.loads, state.clock.time)
        status = _run_kernels(system, state, outputs)
        _add_terms(state, outputs)
        copy(outputs.loads, state.loads)
    for k in outputs.roots:
        values[k] = np.sqrt(max(values[k], 0.0))
    _choose(outputs)
    return status


@compiled
def _run_kernels(system, state, outputs):
    """Evaluate what terms are made of; the state stays as it is."""
    status = OK
    if outputs.needs[NEEDS_ENERGIES] == 1:
        for i in range(state.energy.size):
            state.energy[i] = 0.0
        status = run_kernels(ENERGY, 0, system.address.size, system, state)
        copy(outputs.row, state.now)
    residues, forces = outputs.needs[NEEDS_RESIDUES] == 1, outputs.needs[NEEDS_FORCES] == 1
    for j in range(1, -1, -1):          # forces are those of the last, and of the only call
        if status != OK or not (residues or (forces and j == 0)):
            continue
        status = assemble(RESIDUAL, RESIDUAL if j == 0 else VELOCITY, system, state, outputs.sums)
        copy(outputs.row, state.now)
        outputs.residues[j] = 0.0
        for i in range(system.diagonal.size):
            if system.is_multiplier[i] > 0.0:
                outputs.residues[j] = max(outputs.residues[j], abs(outputs.sums[i]))
    if status == OK:
        status = _move(state, outputs)
    return status


@compiled
def _move(state, outputs):
    """Evaluate motions of bodies; see `sebody.results.motion`."""
    status = OK
    for b in range(outputs.bodies.shape[0]):
        own = at(pointer_to(outputs.bodies), BODY * b)
        copy(state.frames, outputs.frames)
        work = outputs.work
        status = max(status, call_kernel(
            own[0], RESIDUAL, 1, own[1], own[2],
            Arguments(index=at(pointer_to(outputs.index), own[3]),
                      constants=at(pointer_to(outputs.constants), own[4]),
                      q=pointer_to(state.q), R=pointer_to(state.R), v=pointer_to(state.v),
                      a=pointer_to(state.a), references=pointer_to(state.frames_old),
                      frames=outputs.frames, T=work, loads=work, coefficients=work,
                      forces=at(pointer_to(outputs.moved), own[5]), matrices=work, work=work,
                      energies=work)))
    return status


@compiled
def _add_terms(state, outputs):
    values = outputs.values
    for k in range(values.size):
        if outputs.channels[k, 0] == OUTSIDE:
            values[k] = 0.0
    for i in range(outputs.weights.size):
        value = outputs.weights[i]
        for j in range(FACTORS):
            value *= _factor(state, outputs, outputs.terms[i, 1 + 2 * j],
                             outputs.terms[i, 2 + 2 * j])
        values[outputs.terms[i, 0]] += value


@compiled
def _factor(state, outputs, kind, place):
    if kind == FORCE:
        return state.g[place]
    if kind == SUM:
        return outputs.sums[place]
    if kind == OF_ENERGY:
        return state.energy[place]
    if kind == RESIDUES:
        return outputs.residues[place]
    if kind == LOAD:
        return state.loads[place]
    if kind == MOVED:
        return outputs.moved[place]
    if kind == VALUE:
        return outputs.values[place]
    if kind == ONE:
        return 1.0
    x = state.now[place]
    if kind == COSINE:
        return np.cos(x)
    if kind == SINE:
        return np.sin(x)
    if kind == POSITIVE:
        return 1.0 if x > 0.0 else 0.0
    if kind == BELOW_HALF:
        return 1.0 if x < 0.5 else 0.0
    return x


@compiled
def _choose(outputs):
    """Set outputs that are one of several to that with the largest comparison, the first such."""
    largest, last = -np.inf, -1
    for c in range(outputs.choices.shape[0]):
        k, compared = outputs.choices[c, 0], outputs.values[outputs.choices[c, 1]]
        if k != last or compared > largest:
            largest, last = compared, k
            outputs.values[k] = outputs.values[outputs.choices[c, 2]]
