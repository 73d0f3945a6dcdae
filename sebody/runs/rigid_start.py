"""Velocities with which bodies follow drives that have a speed at the start, without a shock.

A drive that moves one node of a body at once, while the others rest, would strain the body. So
bodies start as rigid ones as far as joints, drives and given velocities let them: of the velocities
without deformation those are taken that change least in the norm of kinetic energy. That nothing
deforms is a constraint, not a matter of masses: a light shaft carries a heavy disc as a heavy one
does. Where something has to deform, deformations are shared by how easily each of them gives.

With masses M, constraints ``G v = g`` and rates of deformation F v the change of velocities solves

    [ M  G^T  F^T ] [ dv ]   [     0    ]
    [ G   0    0  ] [ .. ] = [ g - G v  ]
    [ F   0   -D  ] [ .. ]   [   -F v   ]

with a small diagonal D that lets constraints G prevail over F, again from what this leaves. Factors
are those of a matrix with a small diagonal at G, too: in any order of elimination it has some.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.sparse import bmat, csc_matrix, diags

from sebody.assembly.numbering import placed, rotational
from sebody.basics.vectors import axes_cross
from sebody.engine.evaluate import to_body_axes
from sebody.engine.links import place_dependent
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates, stretch
from sebody.model.parts import DofBlock, Superelement
from sebody.runs.kkt_solver import factors
from sebody.runs.redundancy import part_sizes

YIELDING = 1e-8         # of D, relative to how easily a deformation gives
REGULARIZATION = 1e-12      # at constraints, relative to their strength, and in place of no mass
PASSES = 3              # each leaves YIELDING of a deformation that need not be
REFINED = 6             # corrections of a pass by factors with REGULARIZATION
SETTLED = 1e-15         # change of the last one, relative to the solution
SMALL = 1e-8            # change of a velocity, relative, that is none
HEAVY = 1e20            # added mass, relative, that keeps velocities the user gave
LEAST = 1e-6            # weight of a coordinate without mass, relative to the mean of its kind


def follow_drives(model: Mechanism, system: System, numbering: Numbering, state: State,
                  masses: csc_matrix, rates: NDArray) -> dict[str, float]:
    """Change the free velocities so that flexible bodies follow drives that start from speed.

    Returns the DOF blocks whose velocity changed, and by how much.

    Parameters
    ----------
    masses : (unknowns, unknowns)
        Masses and constraints.
    rates : (multipliers,)
        Of the constraints; their residuals with the velocities as they are.
    """
    if not model.bodies or not _starting_from_speed(model, system, numbering, state):
        return {}
    multipliers, n = np.flatnonzero(system.is_multiplier), numbering.free
    bodies = [_Deformation.of(model, body, numbering, state) for body in model.bodies.values()]
    held = np.zeros(n)
    dof_blocks = [t for t in model.dof_blocks() if t.solved and t in numbering.dof_blocks]
    if given := [c for t in dof_blocks if t.given for c in coordinates(numbering, t)]:
        held[given] = HEAVY * np.abs(masses.diagonal()).max()
    sizes = _sizes(masses, placed(model, numbering) + rotational(model, numbering).astype(int),
                   system)
    giving = np.concatenate([body.rows**2 @ (1.0 / sizes[body.own]) for body in bodies])
    solve = _Saddle(masses, held, _rows(bodies, system, state, n), giving, sizes[:n], system)
    before, demand = state.v.copy(), np.zeros(n)
    demand[multipliers] = -rates
    to_body_axes(system, state.frames, demand, False)
    for _ in range(PASSES):
        answer = np.zeros(numbering.total)
        answer[:n] = solve(demand, -np.concatenate([body.rates(state.v) for body in bodies]))
        answer[multipliers] = demand[multipliers] = 0.0
        to_body_axes(system, state.frames, answer, True)
        state.v[:] += answer
        place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    changes = {t.name: float(np.abs((state.v - before)[coordinates(numbering, t)]).max())
               for t in dof_blocks}
    return {name: change for name, change in changes.items()
            if change > SMALL * np.abs(state.v).max()}


def _starting_from_speed(model: Mechanism, system: System, numbering: Numbering,
                         state: State) -> bool:
    ports = [*system.prescribed[:, 1], *(numbering.ports[c] for c in model.constraints
                                         if c.time_function is not None)]
    return any(state.loads[3 * port + 1] != 0.0 for port in ports)


def _sizes(masses: csc_matrix, kinds: NDArray, system: System) -> NDArray:
    """Inertias that scale coordinates of each kind: positions, rotations, modes.

    All of a kind have that of the largest: light bodies between heavy ones follow from the
    constraints, not from small differences.
    """
    n, inertias = masses.shape[0], np.zeros(kinds.max() + 1)
    moving = np.flatnonzero(system.is_multiplier[:n] == 0.0)
    np.maximum.at(inertias, kinds[moving], part_sizes(masses, system)[moving])
    return np.where(inertias > 0.0, inertias, 1.0)[kinds]


class _Saddle:
    """Solves the system of the module's text.

    Parameters
    ----------
    masses : (n, n)
        M and G, as unknowns are numbered.
    held : (n,)
        Masses added to those of velocities that are given.
    F : (deformations, n)
    giving : (deformations,)
        How easily each deformation gives.
    sizes : (n,)
        See `_sizes`.
    """

    def __init__(self, masses: csc_matrix, held: NDArray, F: csc_matrix, giving: NDArray,
                 sizes: NDArray, system: System):
        n, fixed = masses.shape[0], system.is_multiplier[:masses.shape[0]] > 0.0
        own, sizes = part_sizes(masses, system), sizes.copy()
        strength = masses.power(2) @ np.where(fixed, 0.0, 1.0 / sizes)
        sizes[fixed] = np.where(strength[fixed] > 0.0, strength[fixed], 1.0)
        scale = 1.0 / np.sqrt(np.concatenate([sizes, giving]))
        whole = bmat([[masses, F.T], [F, None]], format="csc") + diags(
            np.concatenate([held, -YIELDING * giving]))
        self._matrix = csc_matrix(diags(scale) @ whole @ diags(scale))
        regularized = REGULARIZATION * np.where(fixed, -1.0, own / sizes)
        self._factors = factors(csc_matrix(
            self._matrix + diags(np.concatenate([regularized, np.zeros(len(giving))]))))
        self._scale, self._n = scale, n

    def __call__(self, right: NDArray, deformation: NDArray) -> NDArray:
        """Changes of velocities, and multipliers."""
        right = self._scale * np.concatenate([right, deformation])
        answer = np.zeros(len(right))
        for _ in range(REFINED):
            changes = self._factors.solve(right - self._matrix @ answer)
            answer += changes
            if np.abs(changes).max() <= SETTLED * np.abs(answer).max():
                break
        return (self._scale * answer)[:self._n]


class _Deformation(NamedTuple):
    """Rates of deformation of a body, as a function of its velocities."""

    rows: NDArray       # (deformations, coordinates of the body) of coordinates in global axes
    own: NDArray        # these coordinates
    unknowns: NDArray   # those its velocities depend on
    places: NDArray     # its velocities by those of the unknowns
    modes: NDArray      # rates of deformation that initial velocities of its modes are

    @classmethod
    def of(cls, model: Mechanism, body: Superelement, numbering: Numbering,
           state: State) -> "_Deformation":
        """That of a superelement where it is."""
        reduced, first = body.reduced, numbering.modes[body.name]
        dof_blocks = (*body.positions, *body.rotations)
        boundary = [c for t in dof_blocks for c in coordinates(numbering, t)]
        inner = np.array([*boundary, *range(first, first + reduced.modes)])
        weights = np.sqrt(_weights(reduced.mass.diagonal(), dof_blocks))
        rows = null_space((weights[:, None] * _rigid(model, dof_blocks, numbering, state,
                                                     len(inner))).T).T * weights
        modes = rows[:, len(inner) - reduced.modes:] @ body.mode_rates
        return cls(rows, inner, *_by_unknowns(model, body, numbering, state), modes)

    def rates(self, v: NDArray) -> NDArray:
        """Rates of deformation beyond those that were given."""
        return self.rows @ v[self.own] - self.modes


def _weights(masses: NDArray, dof_blocks: tuple[DofBlock, ...]) -> NDArray:
    """Masses of a body's coordinates, the same for all axes of a position or rotation.

    What has nearly none gets a part of the mean of its kind: positions, rotations and modes have
    other units.
    """
    kinds = np.full(len(masses), 2)
    weights, row = masses.copy(), 0
    for dof_block in dof_blocks:
        own = slice(row, row + dof_block.start.size)
        kinds[own], weights[own] = dof_block.rotational, masses[own].mean()
        row = own.stop
    for kind in np.unique(kinds):
        own = kinds == kind
        typical = np.abs(weights[own]).mean() or np.abs(masses).mean()
        weights[own] = np.maximum(weights[own], LEAST * typical)
    return weights


def _rigid(model: Mechanism, dof_blocks: tuple[DofBlock, ...], numbering: Numbering, state: State,
           count: int) -> NDArray:
    """Velocities of a body's coordinates in rigid motions of where it is, (count, motions)."""
    d, turns = model.dimension, model.rotation_size
    rates, row = np.zeros((count, d + turns)), 0
    middle = np.mean([state.q[stretch(numbering, t)] for t in dof_blocks if not t.rotational]
                     or [np.zeros(d)], axis=0)
    for dof_block in dof_blocks:
        if dof_block.rotational:
            rates[row:row + turns, d:] = _orientation(model, dof_block, numbering, state).T
        else:
            rates[row:row + d, :d] = np.eye(d)
            rates[row:row + d, d:] = _turned(state.q[stretch(numbering, dof_block)] - middle)
        row += dof_block.start.size
    return rates


def _orientation(model: Mechanism, dof_block: DofBlock, numbering: Numbering,
                 state: State) -> NDArray:
    """Matrix from the axes of a rotation's angular velocity to global ones."""
    if model.planar:
        return np.eye(1)
    k = numbering.rotations.get(dof_block)
    return np.eye(3) if k is None else state.R[9 * k:9 * k + 9].reshape(3, 3)


def _turned(arm: NDArray) -> NDArray:
    """Velocity of the end of an arm by its angular velocity."""
    return axes_cross(arm[:, None])[..., 0].T


def _rows(bodies: list[_Deformation], system: System, state: State, n: int) -> csc_matrix:
    """Rates of deformation of all bodies by the unknowns, in the axes these are solved for in."""
    values, columns, counts = [], [], []
    for body in bodies:
        whole = np.zeros(state.q.size)
        for row in body.rows @ body.places:
            whole[:] = 0.0
            whole[body.unknowns] = row
            to_body_axes(system, state.frames, whole, False)
            kept = np.flatnonzero(whole[:n])
            values.append(whole[kept])
            columns.append(kept)
            counts.append(len(kept))
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return csc_matrix((np.concatenate(values), np.concatenate(columns), starts),
                      shape=(n, len(counts))).T.tocsc()


def _by_unknowns(model: Mechanism, body: Superelement, numbering: Numbering,
                 state: State) -> tuple[NDArray, NDArray]:
    """Unknowns, and the velocities of a body's coordinates by theirs.

    Fixed and prescribed coordinates have none; the end of a rigid link follows root and arms.
    """
    column: dict[int, int] = {}     # unknown -> its column
    blocks = []                     # first row, columns, velocities

    def add(row: int, dof_block: DofBlock, block: NDArray) -> None:
        if dof_block.solved:
            columns = [column.setdefault(c, len(column)) for c in coordinates(numbering, dof_block)]
            blocks.append((row, columns, block))

    row = 0
    for dof_block in (*body.positions, *body.rotations):
        size = dof_block.start.size
        if dof_block.root is None:
            add(row, dof_block, np.eye(size))
        else:
            add(row, dof_block.root, np.eye(size))
            for rotation, arm in dof_block.arms:
                R = _orientation(model, rotation, numbering, state)
                if model.planar:
                    c, s = np.cos(angle := state.q[numbering.dof_blocks[rotation]]), np.sin(angle)
                    add(row, rotation, _turned(np.array([[c, -s], [s, c]]) @ arm))
                else:
                    add(row, rotation, _turned(R @ arm) @ R)
        row += size
    modes, first = body.reduced.modes, numbering.modes[body.name]
    columns = [column.setdefault(first + k, len(column)) for k in range(modes)]
    blocks.append((row, columns, np.eye(modes)))
    places = np.zeros((row + modes, len(column)))
    for row, columns, block in blocks:
        places[row:row + len(block), columns] += block
    return np.array(list(column), dtype=int), places
