"""Derivatives of energies and momentum by a state, from forces and products of the elements.

With the forces g of the elements (residuals) and their mass matrix M of a position,

    strain      U_q = g(q, 0, 0) without gravity
    potential   V_q = g(q, 0, 0) - g(q, 0, 0) without gravity
    kinetic     T = v M v / 2:  T_v = M v,  T_q = v M_q v / 2
    momentum    P = r M v:      P_v = M r,  P_q = r M_q v + r_q M v,  r a motion of all positions
                                by one; of angular momentum a rotation about an axis by one, of
                                positions ``e x x``, of rotations in their own axes ``R^T e``

where ``M w = g(q, 0, w) - g(q, 0, 0)``, and ``w M_q v`` is the difference of the products of w with
the stiffness at the accelerations v and none, `sebody.gradients.products`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    COEFFICIENTS,
    KINETIC,
    MOMENT,
    MOMENTUM,
    OK,
    POTENTIAL,
    PREPARE,
    RESIDUAL,
    STRAIN,
    TRANSPOSED,
)
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import run_batches
from sebody.gradients.element_products import ROWS, run_element
from sebody.gradients.laws import keeps
from sebody.gradients.products import turn
from sebody.kernels.loader import element_kernel
from sebody.model.parts import Element, Superelement
from sebody.quantities.symbols import NoTape
from sebody.runs.simulation import Simulation

FIELD = COEFFICIENTS.first("field")
AXES = 3


@dataclass(frozen=True, eq=False)
class EnergyRows(Arrays):
    """Parts of the derivatives of energies.

    ==========  ====================================================================================
    wanted      (energies,) 1 for each of `layout.ENERGIES` whose derivatives are asked for
    massive     (batches,) 1 where elements have mass
    elastic     (batches,) 1 where they have strain energy
    moves       (1 + 6, total) velocities, and motions of all by one along and about the axes
    points      first coordinates of positions
    rows        (2, energies, total) written: derivatives by the motion and its rates
    kept        (3, total) of the state: rates, second rates, then gravity
    loose       (total,) forces at rest; without gravity
    ==========  ====================================================================================
    """

    wanted: NDArray
    massive: NDArray
    elastic: NDArray
    moves: NDArray
    points: NDArray
    rows: NDArray
    kept: NDArray
    loose: NDArray

    @classmethod
    def none(cls) -> EnergyRows:
        """Room for no derivatives."""
        none = np.zeros(0, dtype=np.int64)
        return cls(none, none, none, np.zeros((0, 0)), none, np.zeros((2, 0, 0)),
                   np.zeros((3, 0)), np.zeros(0))


def energy_rows(run: Simulation, places: list[int]) -> EnergyRows:
    """Room for the derivatives of some of `layout.ENERGIES`.

    Raises
    ------
    NoTape
        Strain energy of elements that keep numbers.
    """
    system, total = run.system, run.numbering.total
    wanted = np.zeros(POTENTIAL + 1, dtype=np.int64)
    wanted[places] = 1
    wanted[KINETIC] |= wanted[MOMENT:MOMENT + AXES].any()       # which gives ``M v``
    massive, strained = np.zeros((2, system.address.size), dtype=np.int64)
    for owner, first in run.numbering.forces_at.items():
        b = int(np.searchsorted(system.at_g, first, side="right")) - 1
        if isinstance(owner, Superelement):
            massive[b] = strained[b] = 1
            continue
        massive[b], strained[b] = element_kernel(owner.kind).INERTIAL, elastic(owner)
        if strained[b] and keeps(owner.kind) and wanted[STRAIN]:
            raise NoTape("strain energies of contacts")
    moves, points = np.zeros((1 + 2 * AXES, total)), []
    for block, first in run.numbering.dof_blocks.items():
        if block.rotational:
            if run.model.planar:
                moves[2 * AXES, first] = 1.0
        elif not block.name.endswith(".states"):
            points.append(first)
            for i in range(block.start.size):
                moves[1 + i, first + i] = 1.0
    return EnergyRows(wanted, massive, strained, moves, np.array(points, dtype=np.int64),
                      np.zeros((2, POTENTIAL + 1, total)), np.zeros((3, max(total, AXES))),
                      np.zeros(total))


def elastic(element: Element) -> bool:
    """Tell whether the force of an element at rest is that of its strain energy."""
    bare = element.time_function is None and element.function is None and element.law is None
    return bare and not element.multipliers and not element_kernel(element.kind).INERTIAL


@compiled
def set_energy_rows(system, state, products, energies):
    """Set the derivatives of energies in a state, which stays as it is; a status."""
    kept, c = energies.kept, state.coefficients
    for i in range(state.v.size):
        kept[0, i], kept[1, i] = state.v[i], state.a[i]
        energies.moves[0, i] = state.v[i]
        state.v[i] = state.a[i] = 0.0
    for i in range(AXES):
        kept[2, i] = c[FIELD + i]
    for i in range(energies.rows.shape[1]):
        for j in range(energies.rows.shape[2]):
            energies.rows[0, i, j] = energies.rows[1, i, j] = 0.0
    status = _of_positions(system, state, energies)
    if status == OK:
        status = _of_masses(system, state, products, energies)
    for i in range(state.v.size):
        state.v[i], state.a[i] = kept[0, i], kept[1, i]
    for i in range(AXES):
        c[FIELD + i] = kept[2, i]
    return status


@compiled
def _of_positions(system, state, energies):
    """Strain energy and potential of gravity; gravity is left out from here on."""
    c, rows, status = state.coefficients, energies.rows, OK
    if energies.wanted[POTENTIAL] == 1:
        status = _add_forces(system, state, energies.massive, 1.0, rows[0, POTENTIAL])
    for i in range(AXES):
        c[FIELD + i] = 0.0
    if status == OK and energies.wanted[POTENTIAL] == 1:
        status = _add_forces(system, state, energies.massive, -1.0, rows[0, POTENTIAL])
    if status == OK and energies.wanted[STRAIN] == 1:
        status = _add_forces(system, state, energies.elastic, 1.0, rows[0, STRAIN])
    return status


@compiled
def _of_masses(system, state, products, energies):
    """Kinetic energy and momentum."""
    any_wanted = energies.wanted[KINETIC]
    for i in range(2 * AXES):
        any_wanted |= energies.wanted[MOMENTUM + i]
    if any_wanted == 0:
        return OK
    loose, rows, moves, status = energies.loose, energies.rows, energies.moves, OK
    for i in range(loose.size):
        loose[i] = 0.0
    status = _add_forces(system, state, energies.massive, -1.0, loose)
    _rotate(system, state, energies)
    for m in range(1 + 2 * AXES):
        place = KINETIC if m == 0 else MOMENTUM + m - 1
        if energies.wanted[place] == 1 and status == OK:
            for i in range(loose.size):
                rows[1, place, i] = loose[i]
                state.a[i] = moves[m, i]
            status = _add_forces(system, state, energies.massive, 1.0, rows[1, place])
    for part in range(2):       # at the accelerations v, and at none
        if status != OK:
            return status
        for i in range(loose.size):
            state.a[i] = moves[0, i] if part == 0 else 0.0
        status = _prepare(system, state, products, energies.massive)
        for m in range(1 + 2 * AXES):
            place = KINETIC if m == 0 else MOMENTUM + m - 1
            if energies.wanted[place] == 1:
                factor = (0.5 if m == 0 else 1.0) * (1.0 if part == 0 else -1.0)
                _add_products(system, state, products, energies.massive, moves[m], factor,
                              rows[0, place])
    _add_rotations(system, state, energies)
    return status


@compiled
def _rotate(system, state, energies):
    """Set the motions of all by a rotation about each axis through the origin."""
    moves = energies.moves
    for k in range(AXES):
        one, other = (k + 1) % AXES, (k + 2) % AXES
        if system.dimension[0] == 2 and k < 2:
            continue
        for i in energies.points:
            moves[1 + AXES + k, i + one] = -state.q[i + other]
            moves[1 + AXES + k, i + other] = state.q[i + one]
        for r in range(system.rotation_at.size):
            for i in range(AXES):
                moves[1 + AXES + k, system.rotation_at[r] + i] = state.R[9 * r + 3 * k + i]


@compiled
def _add_rotations(system, state, energies):
    """Add to angular momenta what these motions change with the state, times the momenta."""
    rows, p = energies.rows, energies.rows[1, KINETIC]
    for k in range(AXES):
        place, one, other = MOMENT + k, (k + 1) % AXES, (k + 2) % AXES
        if energies.wanted[place] == 0 or (system.dimension[0] == 2 and k < 2):
            continue
        for i in energies.points:
            rows[0, place, i + one] += p[i + other]
            rows[0, place, i + other] -= p[i + one]
        for r in range(system.rotation_at.size):
            x = system.rotation_at[r]
            for i in range(AXES):
                j, m = (i + 1) % AXES, (i + 2) % AXES
                rows[0, place, x + i] += (p[x + j] * state.R[9 * r + 3 * k + m]
                                          - p[x + m] * state.R[9 * r + 3 * k + j])


@compiled
def _add_forces(system, state, mask, factor, out):
    """Add forces of some batches, times a factor."""
    for b in range(mask.size):
        if mask[b] == 0:
            continue
        status = run_batches(RESIDUAL, b, b + 1, system, state)
        if status != OK:
            return status
        for k in range(system.at_g[b], system.at_g[b] + system.count[b] * system.width[b]):
            out[system.g_unknown[k]] += factor * state.g[k]
    return OK


@compiled
def _prepare(system, state, products, mask):
    """Get the products of some batches ready."""
    element = 0
    for b in range(mask.size):
        for k in range(system.count[b]):
            if mask[b] == 1:
                status = run_element(PREPARE, b, k, products.at_work[element], system, state,
                                     products)
                if status != OK:
                    return status
            element += 1
    return OK


@compiled
def _add_products(system, state, products, mask, w, factor, out):
    """Add the products of weights with the stiffness of some batches, times a factor."""
    vectors, element = products.vectors, 0
    for b in range(mask.size):
        width = system.width[b]
        for k in range(system.count[b]):
            if mask[b] == 1:
                first = system.at_g[b] + k * width
                at_index = system.at_index[b] + k * system.stride[b]
                for i in range(width):
                    vectors[ROWS * first + i] = w[system.g_unknown[first + i]]
                if products.turned[b]:
                    turn(system, state, vectors, ROWS * first, at_index, False)
                run_element(TRANSPOSED, b, k, products.at_work[element], system, state, products)
                row = ROWS * first + width
                if products.turned[b]:
                    turn(system, state, vectors, row, at_index, True)
                for i in range(width):
                    out[system.g_unknown[first + i]] += factor * vectors[row + i]
            element += 1
