"""Derivatives of powers of elements by a state, from their forces and products.

An element with a port has, with the rates v of its unknowns, zero for multipliers, the power

    P = -f v,   P_q = -K^T v,   P_v = -f - C^T v

of the force f that no energy holds. It is the whole force g of loads and drives. Springs and
stops have strain energy, too, whose force is that at rest: ``f = g(q, v) - g(q, 0)``, so that
their K is the difference of those at the rates v and none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.layout import ENERGY, OK, POWERS, PREPARE, TRANSPOSED
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import run_part
from sebody.gradients.element_products import ROWS, run_element
from sebody.gradients.energy_rows import elastic
from sebody.gradients.laws import keeps
from sebody.gradients.products import turn
from sebody.kernels.abi import pointer_to
from sebody.model.parts import Superelement
from sebody.quantities.symbols import NoTape
from sebody.runs.simulation import Simulation

AT_BATCH, AT_ELEMENT, AT_WORK, AT_STRAIN = range(4)     # numbers of a row of PowerRows.elements


@dataclass(frozen=True, eq=False)
class PowerRows(Arrays):
    """Derivatives of powers.

    ==========  ====================================================================================
    places      (p,) of the powers in `layout.ENERGIES`
    elements    (p, 4) of each the batch, its number there, where its scratch memory of products
                begins, and 1 if it has strain energy
    rows        (2, p, total) written: derivatives by the motion and its rates
    kept        (total,) rates of the state
    ==========  ====================================================================================
    """

    places: NDArray
    elements: NDArray
    rows: NDArray
    kept: NDArray


def power_rows(run: Simulation, places: list[int]) -> PowerRows:
    """Room for the derivatives of some powers, by their places in `layout.ENERGIES`.

    Raises
    ------
    NoTape
        Elements whose strain energy depends on what they keep.
    """
    system, numbering = run.system, run.numbering
    owners = {POWERS + port: owner for owner, port in numbering.ports.items()}
    before = np.concatenate([[0], np.cumsum(system.count)])
    elements = []
    for place in places:
        owner = owners[place]
        assert not isinstance(owner, Superelement)      # see `followed.Smooth`
        first = numbering.forces_at[owner]
        b = int(np.searchsorted(system.at_g, first, side="right")) - 1
        k = int((first - system.at_g[b]) // system.width[b])
        if elastic(owner) and keeps(owner.kind):
            raise NoTape("powers of contacts")
        elements.append((b, k, before[b] + k, elastic(owner)))
    return PowerRows(np.array(places, dtype=np.int64),
                     np.array(elements, dtype=np.int64).reshape(-1, 4),
                     np.zeros((2, len(places), numbering.total)), np.zeros(numbering.total))


@compiled
def set_power_rows(system, state, products, powers):
    """Set the derivatives of powers in a state, which stays as it is; a status."""
    status, kept = OK, powers.kept
    for i in range(kept.size):
        kept[i] = state.v[i]
    for p in range(powers.places.size):
        b, k = powers.elements[p, AT_BATCH], powers.elements[p, AT_ELEMENT]
        first, rows = system.at_g[b] + k * system.width[b], powers.rows
        for i in range(kept.size):
            rows[0, p, i] = rows[1, p, i] = 0.0
        status = max(status, run_part(ENERGY, b, k, 1, system, state, pointer_to(state.work)))
        for i in range(first, first + system.width[b]):
            x = system.g_unknown[i]
            rows[1, p, x] -= state.g[i] * (1.0 - system.is_multiplier[x])
        status = max(status, _add_products(system, state, products, powers, p, -1.0))
        if powers.elements[p, AT_STRAIN] == 1:
            for i in range(kept.size):
                state.v[i] = 0.0
            status = max(status, _add_products(system, state, products, powers, p, 1.0))
            for i in range(kept.size):
                state.v[i] = kept[i]
    return status


@compiled
def _add_products(system, state, products, powers, p, factor):
    """Add products of the rates of an element with its stiffness; with its damping if negative."""
    b, k, vectors = powers.elements[p, AT_BATCH], powers.elements[p, AT_ELEMENT], products.vectors
    at_work, width = products.at_work[powers.elements[p, AT_WORK]], system.width[b]
    status = run_element(PREPARE, b, k, at_work, system, state, products)
    first, at_index = system.at_g[b] + k * width, system.at_index[b] + k * system.stride[b]
    for i in range(width):
        x = system.g_unknown[first + i]
        vectors[ROWS * first + i] = powers.kept[x] * (1.0 - system.is_multiplier[x])
    if products.turned[b]:
        turn(system, state, vectors, ROWS * first, at_index, False)
    status = max(status, run_element(TRANSPOSED, b, k, at_work, system, state, products))
    for part in range(2 if factor < 0.0 else 1):
        row = ROWS * first + (1 + part) * width
        if products.turned[b]:
            turn(system, state, vectors, row, at_index, True)
        for i in range(width):
            powers.rows[part, p, system.g_unknown[first + i]] += factor * vectors[row + i]
    return status
