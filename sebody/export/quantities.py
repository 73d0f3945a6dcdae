"""Outputs of an exported model in compiled code.

An output is what a channel of a sensor reads, or a sum of products of numbers of the state, of
forces of elements and of energies, which kernels evaluate as they do for a result.
"""

from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.law_row import OUTSIDE
from sebody.contract.layout import ENERGY, OK, RESIDUAL
from sebody.engine.arrays import Arrays
from sebody.engine.control import read_channel
from sebody.engine.evaluate import assemble, run_kernels, set_loads
from sebody.engine.vectors import copy

# what factors of terms are numbers of: 1.0 itself, State.now, State.g, sums of forces, State.energy
ONE, NOW, FORCE, SUM, OF_ENERGY = range(5)
FACTORS = 4
NEEDS_FORCES, NEEDS_ENERGIES = range(2)


@dataclass(frozen=True, eq=False)
class Outputs(Arrays):
    """Outputs of a model.

    ============  ==================================================================================
    channels      (n, 1 + CHANNEL_PLACES) see `engine.control_data`; OUTSIDE for sums of terms
    coefficients  (n, CHANNEL_NUMBERS)
    terms         (m, 1 + 2 FACTORS) output, then of every factor what it is of, and its place
    weights       (m,) of these products
    needs         (2,) whether forces and whether energies are evaluated
    values        (n,) written
    row, loads    copies of what evaluation changes
    sums          (N,) of forces on coordinates
    ============  ==================================================================================
    """

    channels: NDArray
    coefficients: NDArray
    terms: NDArray
    weights: NDArray
    needs: NDArray
    values: NDArray
    row: NDArray
    loads: NDArray
    sums: NDArray


@compiled
def evaluate(system, state, outputs):
    """Set the values of outputs in the state reached; returns the status of the kernels.

    Angles continue from the value of the last evaluation, so that turns are counted.
    """
    values, status = outputs.values, OK
    for k in range(values.size):
        values[k] = read_channel(state.now, outputs.channels[k], outputs.coefficients[k],
                                 values[k])
    if outputs.terms.shape[0] == 0:
        return status
    copy(state.now, outputs.row)
    copy(state.loads, outputs.loads)
    set_loads(system, state.frames, state.loads, state.clock.time)
    if outputs.needs[NEEDS_ENERGIES] == 1:
        for i in range(state.energy.size):
            state.energy[i] = 0.0
        status = run_kernels(ENERGY, 0, system.address.size, system, state)
        copy(outputs.row, state.now)
    if status == OK and outputs.needs[NEEDS_FORCES] == 1:
        status = assemble(RESIDUAL, RESIDUAL, system, state, outputs.sums)
        copy(outputs.row, state.now)
    copy(outputs.loads, state.loads)
    for k in range(values.size):
        if outputs.channels[k, 0] == OUTSIDE:
            values[k] = 0.0
    for i in range(outputs.weights.size):
        value = outputs.weights[i]
        for j in range(FACTORS):
            value *= _factor(state, outputs, outputs.terms[i, 1 + 2 * j],
                             outputs.terms[i, 2 + 2 * j])
        values[outputs.terms[i, 0]] += value
    return status


@compiled
def _factor(state, outputs, kind, place):
    if kind == NOW:
        return state.now[place]
    if kind == FORCE:
        return state.g[place]
    if kind == SUM:
        return outputs.sums[place]
    return state.energy[place] if kind == OF_ENERGY else 1.0
